"""What a submission did with one question, as commands for the environment: to film it, or to look at it step by step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from remqa_data.env.actions import Command, Shares
from remqa_data.errors import SubmissionError, UnknownNameError
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.evaluation.submission.tracks import TRACKS
from remqa_data.sim.agent.actions import DONE, parse_action, parse_actions
from remqa_data.sim.navigation.viewpoints import FRAME_PX
from remqa_data.storage.manifest import load_manifest


def submitted_commands(path: Path, root: Path, question_id: str) -> list[Command]:
    """The walk, the manipulation with the box that was pointed at, and the answer; what was not submitted is left out.

    Parameters
    ----------
    path : path
        A submission to a track in which agents walk.
    root : path
        The dataset.
    question_id : str
        Which question.

    Raises
    ------
    SubmissionError
        If it is no submission, is about another dataset or split, or has no walks, or a row cannot be read.
    UnknownNameError
        If it has no such question; names the nearest.
    """
    submission, manifest = open_submission(path), load_manifest(root)
    header = submission.header
    if not TRACKS[header.track].walks:
        raise SubmissionError(path, submission.header_place("track"), f"in track {header.track!r} nobody walks")
    submission.check(dataset=dataset_sha256(manifest), splits=manifest.splits(TRACKS[header.track].table))
    known: list[str] = []
    for batch in submission.batches(replay=True, max_rows=sum(manifest.questions.get(header.split, {}).values())):
        ids = batch.rows.column("question_id").to_pylist()
        if question_id in ids:
            return _commands(batch.rows.slice(ids.index(question_id), 1).to_pylist()[0])
        known += ids
    raise UnknownNameError("question", question_id, known)


def _commands(row: Mapping[str, Any]) -> list[Command]:
    commands = [Command(action) for action in parse_actions(row["actions"]) if action.name != DONE]
    box = _shares(row.get("box"))
    if row.get("manipulation") is not None:
        commands.append(Command(parse_action(row["manipulation"]), box=box))
    if row.get("answer") is not None:
        commands.append(Command(answer=row["answer"], box=None if row.get("manipulation") is not None else box))
    return commands


def _shares(box: Sequence[float] | None) -> Shares | None:
    if box is None:
        return None
    x1, y1, x2, y2 = (min(side / FRAME_PX, 1.0) for side in box)  # a box may go beyond the view
    return x1, y1, x2, y2
