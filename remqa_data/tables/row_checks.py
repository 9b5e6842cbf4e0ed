"""What stored values must be besides their Arrow types: the one check of everything that is read from a table.

It works on whole Arrow columns, and asks of them what `fields` asks of rows before they are written (no nulls, lists of
the right length, finite numbers, known words), and that they keep to `remqa_data.limits`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data import limits
from remqa_data.tables.fields import Array, Column, Leaf, ListOf, Member, Struct


@dataclass(frozen=True)
class Problem:
    """What is wrong with one value.

    Attributes
    ----------
    row : int
        In what was checked, from 0.
    field : str
        Such as "objects[].box", or "actions[3]".
    reason : str
    """

    row: int
    field: str
    reason: str


def find_problem(record: Struct, data: pa.Table) -> Problem | None:
    """The first column's first value that must not be, or None.

    Parameters
    ----------
    record : Struct
        The fields of the table.
    data : pyarrow.Table
        Some of its rows, with some of its columns; of a struct there may be only some fields.
    """
    for member in _members(record, data.schema.names):
        start = 0
        for chunk in data.column(member.name).chunks:
            found = _member_problem(member, chunk, "")
            if found is not None:
                return _first_problem(member, chunk, start)
            start += len(chunk)
    return None


_Found = tuple[str, str]
"""Field and reason."""


def _first_problem(member: Member, array: pa.Array, start: int) -> Problem:
    """Of an array that has a problem, its first row that has one, by halving."""
    while len(array) > 1:
        half = len(array) // 2
        if _member_problem(member, array[:half], "") is not None:
            array = array[:half]
        else:
            array, start = array[half:], start + half
    found = _member_problem(member, array, "")
    assert found is not None, "a half of what has a problem has one"
    return Problem(start, *found)


def _members(record: Struct, names: Sequence[str]) -> list[Member]:
    return [member for member in record.members if member.name in names]


def _member_problem(member: Member, array: pa.Array, path: str) -> _Found | None:
    path = f"{path}.{member.name}" if path else member.name
    if array.null_count and not member.is_optional:
        return path, "null"
    return _problem(member.node, member.column, array.drop_null() if array.null_count else array, path)


def _problem(node: Leaf | Array | ListOf | Struct, column: Column, array: pa.Array, path: str) -> _Found | None:
    """What is wrong with values of which none is null."""
    if isinstance(node, Leaf):
        return _leaf_problem(node, column, array, path)
    if isinstance(node, Array):
        return _array_problem(node, column, array, path)
    if isinstance(node, ListOf):
        return _list_problem(node, column, array, path)
    for member in _members(node, [field.name for field in array.type]):
        found = _member_problem(member, array.field(member.name), path)
        if found is not None:
            return found
    return None


def _list_problem(node: ListOf, column: Column, array: pa.Array, path: str) -> _Found | None:
    if node.length is not None:
        wrong = pc.any(pc.not_equal(pc.list_value_length(array), node.length), min_count=0).as_py()
        if wrong:
            return path, f"a list of another length; expected {node.length} values"
    else:
        most = column.most or limits.MOST_ITEMS
        longest = pc.max(pc.list_value_length(array)).as_py() or 0
        if longest > most:
            return path, f"a list of {longest:,}; at most {most:,} are read"
    items = array.flatten()
    return (f"{path}[]", "null") if items.null_count else _problem(node.item, column, items, f"{path}[]")


def _array_problem(node: Array, column: Column, array: pa.Array, path: str) -> _Found | None:
    most = column.most or limits.MOST_ITEMS
    longest = pc.max(pc.list_value_length(array)).as_py() or 0
    if longest > most:
        return path, f"a list of {longest:,}; at most {most:,} are read"
    items = array.flatten()
    if items.null_count:
        return f"{path}[]", "null"
    for name in node.columns:
        if items.field(name).null_count:
            return f"{path}[].{name}", "null"
    return None


def _leaf_problem(node: Leaf, column: Column, array: pa.Array, path: str) -> _Found | None:
    if pa.types.is_boolean(node.type) or not len(array):
        return None
    if pa.types.is_integer(node.type) or pa.types.is_floating(node.type):
        return _number_problem(node, column, array, path)
    if node.allowed:
        unknown = array.filter(pc.invert(pc.is_in(array, value_set=pa.array(node.allowed, node.type))))
        return (path, f"none of {', '.join(node.allowed)}") if len(unknown) else None
    most = column.most or (limits.MOST_IMAGE_BYTES if pa.types.is_binary(node.type) else limits.MOST_TEXT_BYTES)
    longest = pc.max(pc.binary_length(array)).as_py()
    if longest > most:
        return path, f"{longest:,} bytes; at most {most:,} are read"
    if not pa.types.is_binary(node.type):
        try:
            array.validate(full=True)
        except pa.ArrowInvalid:
            return path, "a text that is no UTF-8"
    return None


def _number_problem(node: Leaf, column: Column, array: pa.Array, path: str) -> _Found | None:
    low, high = number_range(column, is_whole=pa.types.is_integer(node.type))
    numbers = array.to_numpy(zero_copy_only=False)
    if low <= numbers.min() and numbers.max() <= high:  # neither holds where there is a nan
        return None
    wrong = numbers[~((numbers >= low) & (numbers <= high))]
    return path, f"{np.asarray(wrong)[0]:g}; expected {low:g} to {high:g}"


_RANGES: dict[str | None, tuple[float, float]] = {
    "m": (-limits.MOST_FAR_M, limits.MOST_FAR_M),
    "deg": (-720.0, 720.0),
    "px": (0, limits.MOST_IMAGE_PX**2),
    "grid": (-4 * limits.MOST_FAR_M, 4 * limits.MOST_FAR_M),
    "voxels": (-(2**15), 2**15 - 1),
}


def number_range(column: Column, *, is_whole: bool) -> tuple[float, float]:
    """Least and greatest number that a column may hold: its own, else that of its unit or frame.

    Whole numbers without a unit count something, so they are not negative; other numbers without one are shares.

    >>> number_range(Column("Height.", "m"), is_whole=False)
    (-1000.0, 1000.0)
    >>> number_range(Column("How far open."), is_whole=False)
    (0.0, 1.0)
    """
    if column.within is not None:
        return column.within
    usual = (0, math.inf) if is_whole else (0.0, 1.0)
    return _RANGES.get(column.unit) or _RANGES.get(column.frame) or usual
