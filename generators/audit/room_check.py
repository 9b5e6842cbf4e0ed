"""One room of a dataset: its rows are read, made again from the configuration, and checked in freshly loaded worlds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from remqa_data.errors import RemqaError, one_line
from remqa_data.generators.audit.expressions import expression_failures
from remqa_data.generators.audit.failures import Failure
from remqa_data.generators.audit.frames import frame_failures, size_failures
from remqa_data.generators.audit.remade import remade_failures
from remqa_data.generators.audit.truths import CheckedRoom
from remqa_data.generators.scene_plan import Job
from remqa_data.storage.shards import Shard
from remqa_data.tables.rows import ExpressionRow, FrameRow, QuestionRow, Row, SceneRow, configuration_name
from remqa_data.tables.schema import R, to_rows

Piece = tuple[Path, tuple[int, ...]]
"""A shard and row groups in it."""
Pieces = Mapping[str, tuple[Piece, ...]]
"""By table, where the rows of a room lie."""


@dataclass(frozen=True)
class RoomCheck:
    """What to check of one room.

    Attributes
    ----------
    scene : str
        The room.
    question_ids : frozenset of str
        Questions to replay.
    pieces : mapping
        Where its rows lie.
    job : Job, optional
        What generation was told of it, if all its rows are to be made again and compared.
    """

    scene: str
    question_ids: frozenset[str]
    pieces: Pieces
    job: Job | None = None


@dataclass(frozen=True)
class Found:
    """What came of a check.

    Attributes
    ----------
    failures : tuple of Failure
        What does not hold.
    rows : mapping of str to int
        By table, how many rows were worked out anew and compared; of questions, how many were replayed.
    refused : mapping of str to int
        By reason, what was refused while the room was made again.
    """

    failures: tuple[Failure, ...]
    rows: Mapping[str, int]
    refused: Mapping[str, int]


@dataclass(frozen=True)
class RoomRows:
    """The rows of one room, in their order."""

    scenes: tuple[SceneRow, ...]
    frames: tuple[FrameRow, ...]
    expressions: tuple[ExpressionRow, ...]
    questions: tuple[QuestionRow, ...]

    def by_table(self) -> dict[str, tuple[Row, ...]]:
        """By the name of the table."""
        return {
            "scenes": self.scenes,
            "frames": self.frames,
            "expressions": self.expressions,
            "questions": self.questions,
        }


def check_room(check: RoomCheck) -> Found:
    """Check one room."""
    try:
        rows = _read(check)
    except RemqaError as error:
        return Found((Failure(check.scene, "consistent", one_line(error)),), {}, {})
    if check.job is None:
        return Found(tuple(_configurations(check, rows)), {"questions": len(check.question_ids)}, {})
    wrong_sizes = tuple(size_failures(rows.frames, check.job.config.image.size_px))
    if wrong_sizes:  # to draw them all in another size may take very long
        return Found(wrong_sizes, {}, {})
    unlike, refused = remade_failures(check.job, rows.by_table())
    failures = (*unlike, *_configurations(check, rows))
    compared = {table: len(own) for table, own in rows.by_table().items()}
    return Found(failures, compared | {"questions": len(check.question_ids)}, refused)


def _configurations(check: RoomCheck, rows: RoomRows) -> Iterator[Failure]:
    """What does not hold in the stored configurations of the room."""
    asked = [question for question in rows.questions if question.question_id in check.question_ids]
    known = {row.configuration for row in rows.scenes}
    for question in asked:
        if question.configuration not in known:
            reason = f"there is no configuration {question.configuration} of {check.scene}"
            yield Failure(question.question_id, "consistent", reason)
    for row in rows.scenes:
        own = [question for question in asked if question.configuration == row.configuration]
        if not own and check.job is None:
            continue
        try:
            room = CheckedRoom(row)
        except RemqaError as error:
            wheres = [question.question_id for question in own] or [configuration_name(row.scene, row.configuration)]
            yield from (Failure(where, "consistent", one_line(error)) for where in wheres)
            continue
        yield from room.failures()
        if check.job is not None:
            frames = [frame for frame in rows.frames if frame.configuration == row.configuration]
            said = [expression for expression in rows.expressions if expression.configuration == row.configuration]
            yield from frame_failures(room, frames, check.job.config)
            yield from expression_failures(room, frames, said)
        for question in own:
            yield from room.question_failures(question)


def _read(check: RoomCheck) -> RoomRows:
    is_whole = check.job is not None
    return RoomRows(
        scenes=tuple(_rows(SceneRow, check, "scenes")),
        frames=tuple(_rows(FrameRow, check, "frames")) if is_whole else (),
        expressions=tuple(_rows(ExpressionRow, check, "expressions")) if is_whole else (),
        questions=tuple(_rows(QuestionRow, check, "questions")),
    )


def _rows(row_type: type[R], check: RoomCheck, table: str) -> Iterator[R]:
    for path, groups in check.pieces.get(table, ()):
        data = Shard(path, table).read(groups)
        own = data.filter([scene == check.scene for scene in data["scene"].to_pylist()])
        yield from to_rows(row_type, own)
