"""The Gymnasium environment `remqa_data/CachedRemqa-v0`: navigation over cached views.

Importing `remqa_data.env.cached` registers it:

>>> import gymnasium, remqa_data.env.cached
>>> "remqa_data/CachedRemqa-v0" in gymnasium.registry
True

docs/AGENTS.md tells how to make a cache.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env.arguments import check_counts, check_flags, check_render_mode
from remqa_data.env.cached.tasks import CachedTasks
from remqa_data.env.cached.walk import ACTIONS, Walk, action_number
from remqa_data.env.environment import pose_space, question_space, tokens_space, type_numbers, wanted_episode
from remqa_data.env.record import reward_of
from remqa_data.errors import ActionError, DatasetError
from remqa_data.tables.rows import configuration_name

ENV_ID = "remqa_data/CachedRemqa-v0"


class CachedRemqaEnv(gymnasium.Env[dict[str, Any], Any]):
    """An agent that sees and walks to what a question is about, and says when it is there.

    It is `RemqaEnv` with cached views: a walk goes through the same poses and frames, is refused the same steps in the same
    words, and is measured alike.

    Parameters
    ----------
    root : path
        Folder of a finished dataset, whose questions are the episodes.
    views : path
        Its cache, made by `remqa-data cache`.
    split : str
        Of the dataset.
    question_ids : sequence of str, optional
        Only these questions; by default all whose room is cached.
    max_steps : int
        An episode is truncated after so many steps.
    features : bool
        Whether to observe the cached features, too.
    copy : bool
        Whether observations are the agent's own, as Gymnasium wants it. Without, they are views of memory that must not be
        written to: frames and features are mapped files, of which only what is looked at is read.
    vocabulary : Vocabulary, optional
        For the question's tokens; by default that of the dataset's train split.
    render_mode : None
        There are no pictures from outside.

    Notes
    -----
    Actions are `remqa_data.env.cached.walk.ACTIONS`, by number or name: there is no manipulation and no answer. "Done" ends
    the episode. Its reward is 1 if the agent has navigated to the target (S_N), which is what `RemqaEnv` gives to an agent
    that then answers rightly; all other rewards are 0.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    def __init__(
        self,
        root: str | os.PathLike[str],
        views: str | os.PathLike[str],
        split: str = "train",
        *,
        question_ids: Sequence[str] | None = None,
        max_steps: int = 250,
        features: bool = False,
        copy: bool = True,
        vocabulary: Vocabulary | None = None,
        render_mode: str | None = None,
    ) -> None:
        check_render_mode(render_mode)
        check_counts(max_steps=max_steps)
        check_flags(features=features, copy=copy)
        self.tasks = CachedTasks(root, views, split, question_ids, vocabulary)
        self.walk = Walk(self.tasks, max_steps)
        self._has_features, self._copies, self.render_mode = features, copy, render_mode
        self.action_space = spaces.Discrete(len(ACTIONS))
        self.observation_space = observation_space(self.tasks, features)

    @property
    def episode_ids(self) -> tuple[str, ...]:
        """What `reset` can choose from: ids of questions."""
        return self.tasks.ids

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode; `options={"episode": id}` chooses which. If this fails, there is none.

        The same seed draws the same as in `RemqaEnv`, if all rooms that the split asks about are cached.

        Raises
        ------
        ActionError
            For an option that there is not.
        UnknownNameError
            If there is no such episode.
        """
        self.walk.is_over = True  # until there is all that an episode takes
        super().reset(seed=seed)
        info = begin(self.walk, self.tasks, self.np_random, options)
        task = self.walk.task
        self._told = {
            "question": self.tasks.question(task),
            "target": np.int64(type_numbers()[task.target_type]),
        }
        self._tokens = self.tasks.tokens(task)
        return self._observe(), info

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Do one action.

        `info["success"]` and `info["error"]` say what came of it. At the end `info` also holds the measures.

        Raises
        ------
        ActionError
            If it is no action, or the episode has not begun or is over.
        """
        walk = self.walk
        if walk.is_over:
            raise ActionError("there is no episode going on: call reset")
        number = action_number(action)
        error = walk.act(number)
        terminated, truncated = walk.ended(number)
        info = {"action": ACTIONS[number], "success": not error, "error": error, "privileged": False}
        reward = 0.0
        if walk.is_over:
            info |= walk.measures(number)
            reward = reward_of(info, terminated)
        return self._observe(), reward, terminated, truncated, info

    def close(self) -> None:
        """There are no steps any more until `reset`."""
        self.walk.is_over = True

    def _observe(self) -> dict[str, Any]:
        room, state = self.walk.room, self.walk.state
        arrays = {"rgb": room.frame(state), "pose": room.poses[state], "question_tokens": self._tokens}
        if self._has_features:
            arrays["features"] = room.features[state]  # type: ignore[index]
        return {**self._told, **({name: array.copy() for name, array in arrays.items()} if self._copies else arrays)}


def begin(
    walk: Walk, tasks: CachedTasks, rng: np.random.Generator, options: dict[str, Any] | None = None
) -> dict[str, Any]:
    """Begin the episode that the options choose, or one that is drawn; what `reset` says of it."""
    name = wanted_episode(tasks.ids, rng, options)
    walk.begin(name)
    place = configuration_name(walk.task.scene, walk.task.configuration)
    return {"scene": place, "episode_id": name, "privileged": False}


def observation_space(tasks: CachedTasks, features: bool) -> spaces.Dict:
    """What is observed.

    Raises
    ------
    DatasetError
        If features are asked for, and the cache has none.
    """
    size = tasks.views.size_px
    entries: dict[str, spaces.Space[Any]] = {
        "rgb": spaces.Box(0, 255, (size, size, 3), np.uint8),
        "pose": pose_space(),
        "question": question_space(),
        "question_tokens": tokens_space(tasks.vocabulary),
        "target": spaces.Discrete(len(type_numbers()) + 1),
    }
    if features:
        stored = tasks.room(tasks.task(tasks.ids[0])).features
        if stored is None:
            raise DatasetError(f"{tasks.views.folder} has no features; add some with remqa-data cache --features")
        largest = float(np.finfo(np.float16).max)
        entries["features"] = spaces.Box(-largest, largest, stored.shape[1:], np.float16)
    return spaces.Dict(entries)


def register() -> None:
    """Make `gymnasium.make("remqa_data/CachedRemqa-v0", ...)` and `make_vec` work."""
    if ENV_ID not in gymnasium.registry:
        gymnasium.register(
            ENV_ID,
            entry_point="remqa_data.env.cached:CachedRemqaEnv",
            vector_entry_point="remqa_data.env.cached:CachedRemqaVectorEnv",
        )


register()
