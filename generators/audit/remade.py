"""A room made again from the configuration, and compared with its stored rows bit for bit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pyarrow as pa

from remqa_data.errors import RemqaError, one_line
from remqa_data.generators.audit.failures import Failure
from remqa_data.generators.scene_job import make_room
from remqa_data.generators.scene_plan import Job
from remqa_data.tables.rows import ExpressionRow, FrameRow, QuestionRow, Row, SceneRow, configuration_name
from remqa_data.tables.schema import TABLES, to_table

Stored = Mapping[str, Sequence[Row]]
"""Rows of a room by table, in order."""


def remade_failures(job: Job, stored: Stored) -> tuple[list[Failure], dict[str, int]]:
    """What is stored and is not what the configuration makes; and what was refused while the room was made.

    Parameters
    ----------
    job : Job
        The room, as generation was told of it.
    stored : mapping
        Its rows.
    """
    try:
        made, report = make_room(job)
    except RemqaError as error:
        return [Failure(job.scene, "reproducible", f"the room cannot be made again: {one_line(error)}")], {}
    failures = [failure for table in TABLES for failure in _table_failures(job, table, stored[table], made[table])]
    return failures, dict(report["refused"])


def row_name(row: Row) -> str:
    """How a row is called."""
    match row:
        case SceneRow():
            return configuration_name(row.scene, row.configuration)
        case FrameRow():
            return row.frame_id
        case ExpressionRow():
            return row.expression_id
        case QuestionRow():
            return row.question_id


def _table_failures(job: Job, table: str, stored: Sequence[Row], made: Sequence[Row]) -> Iterator[Failure]:
    names, expected = [row_name(row) for row in stored], [row_name(row) for row in made]
    if names != expected:
        odd = sorted(set(names) ^ set(expected))
        reason = (
            f"{table} are not those that the configuration makes, in their order: {', '.join(odd[:3]) or 'reordered'}"
        )
        yield Failure(job.scene, "complete", reason)
    by_name = {row_name(row): row for row in made}
    pairs = [(row, by_name[name]) for name, row in zip(names, stored, strict=True) if name in by_name]
    for row, wrong in _different(table, pairs):
        yield Failure(row_name(row), "reproducible", f"{', '.join(wrong)}: not what the configuration makes")


def _different(table: str, pairs: Sequence[tuple[Row, Row]]) -> Iterator[tuple[Row, list[str]]]:
    """The stored rows that differ from the made ones, were it in a single bit, and in which columns.

    All are compared at once, and halves of them only where they differ: to make columns of one row takes as long as of many.
    """
    stored, made = _as_bytes(table, [pair[0] for pair in pairs]), _as_bytes(table, [pair[1] for pair in pairs])
    wrong = [column for column in stored if stored[column] != made[column]]
    if wrong and len(pairs) > 1:
        middle = len(pairs) // 2
        yield from _different(table, pairs[:middle])
        yield from _different(table, pairs[middle:])
    elif wrong:
        yield pairs[0][0], wrong


def _as_bytes(table: str, rows: Sequence[Row]) -> dict[str, bytes]:
    row_type: Any = TABLES[table].row_type
    data = to_table(row_type, rows).combine_chunks()
    batches = {name: pa.record_batch([data[name].chunk(0)], names=[name]) for name in data.schema.names}
    return {name: batch.serialize().to_pybytes() for name, batch in batches.items()}
