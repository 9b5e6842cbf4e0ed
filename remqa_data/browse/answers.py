"""What agents answered, from the files that they handed in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from remqa_data.errors import SubmissionError
from remqa_data.evaluation.scoring.ground_truth import truth_of
from remqa_data.evaluation.scoring.scoring import places_of
from remqa_data.evaluation.submission.reader import Submission, open_submission
from remqa_data.evaluation.submission.tracks import TRACKS
from remqa_data.metrics import is_right_answer
from remqa_data.sim.agent.actions import DONE


@dataclass(frozen=True)
class AgentAnswers:
    """A submission.

    Attributes
    ----------
    agent : str
        The name that it gives itself.
    track, split : str
    by_question : mapping of str to dict
        By question id, the row that was handed in.
    """

    agent: str
    track: str
    split: str
    by_question: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class GivenAnswer:
    """What one agent made of one question.

    Attributes
    ----------
    agent : str
    answer, manipulation : str or None
        None where nothing was handed in, or the track does not ask for it.
    steps : int or None
        Actions of its walk but Done.
    is_right : bool or None
        Whether it gave the dataset's answer; None if it gave none.
    """

    agent: str
    answer: str | None
    manipulation: str | None
    steps: int | None
    is_right: bool | None


def read_answers(paths: Sequence[Path], root: Path) -> tuple[AgentAnswers, ...]:
    """Read submissions about questions of a dataset; what `remqa-eval` refuses is refused.

    Parameters
    ----------
    paths : sequence of Path
        The files, .jsonl or .parquet.
    root : Path
        Folder of the dataset.

    Raises
    ------
    SubmissionError
        If a file is none, is about referring expressions or another dataset, or has a row that cannot be scored.
    DatasetError
        If the dataset has no such split.
    """
    return tuple(_read(open_submission(path), root) for path in paths)


def given_answers(agents: Sequence[AgentAnswers], question_id: str, answer: str) -> list[GivenAnswer]:
    """What each agent made of a question; only of those that handed in something for it."""
    found = []
    for agent in agents:
        row = agent.by_question.get(question_id)
        if row is not None:
            said, walk = row.get("answer"), row.get("actions")
            found.append(
                GivenAnswer(
                    agent.agent,
                    said,
                    row.get("manipulation"),
                    None if walk is None else sum(action != DONE for action in walk),
                    None if said is None else bool(is_right_answer([said], [answer])[0]),
                )
            )
    return found


def _read(submission: Submission, root: Path) -> AgentAnswers:
    header = submission.header
    column = TRACKS[header.track].id_column
    if column != "question_id":
        reason = f"track {header.track} is about referring expressions; browse shows answers to questions"
        raise SubmissionError(submission.path, "", reason)
    truth = truth_of(submission, root)
    answered = np.zeros(len(truth.ids), dtype=np.bool_)
    rows: dict[str, Mapping[str, Any]] = {}
    for batch in submission.batches(replay=True, max_rows=len(truth.ids)):
        answered[places_of(submission, truth, batch, answered)] = True
        rows.update((row[column], row) for row in batch.rows.to_pylist())
    return AgentAnswers(header.agent, header.track, header.split, rows)
