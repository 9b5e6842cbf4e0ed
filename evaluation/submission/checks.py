"""What the values of a submission must be, besides their types: one function for each column, over whole batches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.errors import ActionError
from remqa_data.evaluation.submission.tracks import WORDS
from remqa_data.geometry.types import I64, Flags
from remqa_data.limits import MAX_ACTIONS, MAX_COORDINATE, MAX_PX, MAX_TEXT
from remqa_data.sim.agent.actions import DONE, MANIPULATION, parse_action
from remqa_data.tables.row_checks import Problem


def find_problem(batch: pa.RecordBatch) -> Problem | None:
    """The first column's first value that must not be, or None; the batch has the types of `tracks.COLUMNS`."""
    for name in batch.schema.names:
        problem = _CHECKS[name](name, batch.column(name))
        if problem is not None:
            return problem
    return None


def _id(name: str, values: pa.Array) -> Problem | None:
    return _null(name, values) or _text(name, values)


def _text(name: str, values: pa.Array) -> Problem | None:
    too_long = pc.greater(pc.utf8_length(values), MAX_TEXT)
    return _first(too_long, name, f"more than {MAX_TEXT} characters")


def _actions(name: str, values: pa.Array) -> Problem | None:
    problem = _null(name, values)
    problem = problem or _first(pc.greater(pc.list_value_length(values), MAX_ACTIONS), name, "too many actions")
    if problem is not None:
        return problem
    words, rows = values.flatten(), _parents(values)
    unknown = _flags(pc.invert(pc.is_in(words, value_set=pa.array(WORDS))))
    if unknown.any():
        return _element(name, values, rows, int(np.flatnonzero(unknown)[0]), words)
    # A word after Done is one whose predecessor, in the same row, is Done.
    done = _flags(pc.equal(words, DONE))
    late = np.flatnonzero(done[:-1] & (rows[1:] == rows[:-1]))
    return Problem(int(rows[late[0]]), name, f"an action after {DONE}") if len(late) else None


def _manipulation(name: str, values: pa.Array) -> Problem | None:
    problem = _text(name, values)
    if problem is not None:
        return problem
    for row, text in enumerate(values.to_pylist()):
        if text is not None:
            try:
                is_one = parse_action(text).name in MANIPULATION and text.split() == text.split(" ")
            except ActionError as error:
                return Problem(row, name, str(error))
            if not is_one:
                return Problem(row, name, "not a manipulation")
    return None


def _box(name: str, values: pa.Array) -> Problem | None:
    problem = _first(pc.not_equal(pc.list_value_length(values), 4), name, "not four numbers")
    problem = problem or _numbers(name, values)
    if problem is not None:
        return problem
    rows = _parents(values)[::4]
    boxes = values.flatten().to_numpy(zero_copy_only=False).reshape(-1, 4)
    for wrong, reason in (
        ((boxes < 0).any(axis=1), "a negative coordinate"),
        ((boxes > MAX_PX).any(axis=1), f"a coordinate above {MAX_PX}"),
        ((boxes[:, 2:] < boxes[:, :2]).any(axis=1), "x2 < x1 or y2 < y1"),
    ):
        if wrong.any():
            return Problem(int(rows[wrong.argmax()]), name, reason)
    return None


def _poses(name: str, values: pa.Array) -> Problem | None:
    problem = _null(name, values)
    lengths = pc.list_value_length(values)
    problem = problem or _first(pc.equal(lengths, 0), name, "no pose")
    problem = problem or _first(pc.greater(lengths, MAX_ACTIONS + 1), name, "too many poses")
    if problem is not None:
        return problem
    poses, rows = values.flatten(), _parents(values)
    inner = _null(name, poses) or _first(pc.not_equal(pc.list_value_length(poses), 4), name, "not four numbers")
    inner = inner or _numbers(name, poses)
    if inner is not None:
        return Problem(int(rows[inner.row]), name, f"a pose: {inner.reason}")
    numbers = poses.flatten().to_numpy(zero_copy_only=False)
    far = np.abs(numbers) > MAX_COORDINATE
    return Problem(int(rows[far.argmax() // 4]), name, f"a number beyond {MAX_COORDINATE}") if far.any() else None


_CHECKS: dict[str, Callable[[str, pa.Array], Problem | None]] = {
    "question_id": _id,
    "expression_id": _id,
    "actions": _actions,
    "poses": _poses,
    "target_box": _box,
    "box": _box,
    "manipulation": _manipulation,
    "answer": _text,
}


def _null(name: str, values: pa.Array) -> Problem | None:
    return _first(pc.is_null(values), name, "null")


def _numbers(name: str, lists: pa.Array) -> Problem | None:
    """A number in lists of numbers that is none, or not finite."""
    numbers = lists.flatten()
    wrong = ~_flags(pc.is_finite(numbers))
    return _element(name, lists, _parents(lists), int(wrong.argmax()), numbers) if wrong.any() else None


def _element(name: str, lists: pa.Array, rows: I64, flat: int, elements: pa.Array) -> Problem:
    """The problem of one element of a list: it should not be what it is."""
    place = flat - int(np.searchsorted(rows, rows[flat]))
    shown = str(elements[flat].as_py())
    return Problem(int(rows[flat]), f"{name}[{place}]", repr(shown[:40] + "..." * (len(shown) > 40)))


def _first(flags: pa.Array, name: str, reason: str) -> Problem | None:
    """A problem with the first row that has a flag; a null has none."""
    set_ = _flags(flags)
    return Problem(int(set_.argmax()), name, reason) if set_.any() else None


def _flags(values: pa.Array) -> Flags:
    return np.asarray(pc.fill_null(values, False).to_numpy(zero_copy_only=False), dtype=bool)


def _parents(lists: pa.Array) -> I64:
    """Row of each element that `flatten` gives: a null has none, though Arrow may keep room for some."""
    lengths = pc.fill_null(pc.list_value_length(lists), 0).to_numpy(zero_copy_only=False)
    return np.repeat(np.arange(len(lists), dtype=np.int64), lengths)
