"""The questions of a split whose rooms are cached, and what an agent is told of them."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env.arguments import check_vocabulary, chosen_questions, folder
from remqa_data.env.environment import question_tokens, shown_question
from remqa_data.errors import DatasetError, UnknownNameError
from remqa_data.tables.rows import configuration_name
from remqa_data.views.reader import RoomViews, Views
from remqa_data.views.tasks import NavigationTask, navigation_tasks


class CachedTasks:
    """What there is to play.

    Parameters
    ----------
    root : path
        A finished dataset.
    views : path
        Its cache.
    split : str
        Of the dataset.
    question_ids : sequence of str, optional
        Only these; by default all whose room is cached.
    vocabulary : Vocabulary, optional
        For the question's tokens; by default that of the dataset's train split.

    Raises
    ------
    DatasetError
        If it is a cache of another dataset, is not finished, or has none of these rooms.
    UnknownNameError
        If the split has no such question.
    ActionError
        As of `remqa_data.env.arguments`.
    """

    def __init__(
        self,
        root: str | os.PathLike[str],
        views: str | os.PathLike[str],
        split: str,
        question_ids: Sequence[str] | None = None,
        vocabulary: Vocabulary | None = None,
    ) -> None:
        chosen = chosen_questions(question_ids)
        check_vocabulary(vocabulary)
        dataset = folder(root)
        self.views = Views(views, dataset)
        self.vocabulary = vocabulary or Vocabulary.from_dataset(dataset)
        self._tasks = {task.question_id: task for task in navigation_tasks(dataset, split)}
        if chosen is not None:
            self._tasks = {name: self.task(name) for name in chosen}
            for name, task in self._tasks.items():
                if not self.views.has(task.scene, task.configuration):
                    raise DatasetError(
                        f"{views} has no {_place(task)}, which {name} is about; add it with remqa-data cache"
                    )
        self.ids = tuple(n for n, task in self._tasks.items() if self.views.has(task.scene, task.configuration))
        if not self.ids:
            raise DatasetError(f"{views} has no room that split {split} asks about; add some with remqa-data cache")
        self._tokens: dict[str, npt.NDArray[np.int64]] = {}

    def task(self, name: str) -> NavigationTask:
        """The task of a question.

        Raises
        ------
        UnknownNameError
            If the split has no such question, or it is none of the chosen ones.
        """
        if name not in self._tasks:
            raise UnknownNameError("question", name, self._tasks)
        return self._tasks[name]

    def room(self, task: NavigationTask) -> RoomViews:
        """Where a task is done."""
        return self.views.room(task.scene, task.configuration)

    def start(self, task: NavigationTask, room: RoomViews) -> int:
        """The state in which an episode begins.

        Raises
        ------
        DatasetError
            If the room has no such state.
        """
        state = room.states.number(*task.start)
        if state is None or not room.is_reachable[state]:
            raise DatasetError(
                f"question {task.question_id}, field initial_pose: {task.start} cannot be reached in {_place(task)} with "
                "this version of remqa-data; generate the dataset again"
            )
        return state

    def question(self, task: NavigationTask) -> str:
        """The question as it is observed."""
        return shown_question(task.question)

    def tokens(self, task: NavigationTask) -> npt.NDArray[np.int64]:
        """Its words as numbers; read-only."""
        if task.question_id not in self._tokens:
            tokens = question_tokens(self.vocabulary, task.question)
            tokens.flags.writeable = False
            self._tokens[task.question_id] = tokens
        return self._tokens[task.question_id]


def _place(task: NavigationTask) -> str:
    return configuration_name(task.scene, task.configuration)
