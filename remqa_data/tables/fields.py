"""From annotations to Arrow: what type a field of a typed record has, and the way there and back.

`node_of` reads an annotation into a small tree of `Leaf`, `Array`, `ListOf` and `Struct`. Each knows its Arrow type,
makes an Arrow array from a list of values, and makes the values from the array again, column by column.
"""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.errors import SchemaError, one_line


@dataclass(frozen=True)
class Column:
    """What a field means.

    Attributes
    ----------
    description : str
        One sentence.
    unit : str, optional
        Such as "m", "deg", "px".
    frame : str, optional
        Frame of the coordinates: "world", "image", "grid" or "voxels".
    arrow : str, optional
        Arrow type where it is not the usual one for the Python type, such as "int64" or "large_string"; of an array,
        that of its numbers.
    columns : tuple of str
        For an (n, k) array: the names of its k columns; it is stored as a list of structs.
    within : tuple of float, optional
        Least and greatest number, where they are not the usual ones of its unit (`row_checks.number_range`).
    most : int, optional
        Bytes of a text or items of a list, where they are not the usual ones of `remqa_data.limits`.
    """

    description: str
    unit: str | None = None
    frame: str | None = None
    arrow: str | None = None
    columns: tuple[str, ...] = ()
    within: tuple[float, float] | None = None
    most: int | None = None

    def metadata(self) -> dict[str, str]:
        """The documentation, as Arrow stores it with a field."""
        texts = {"description": self.description, "unit": self.unit, "frame": self.frame}
        return {key: text for key, text in texts.items() if text is not None}


@dataclass(frozen=True)
class Leaf:
    """A string, number, truth value or bytes; of the allowed texts, if there are any."""

    type: pa.DataType
    allowed: tuple[str, ...] = ()

    def to_arrow(self, values: Sequence[Any], where: str) -> pa.Array:
        """An Arrow array of the values."""
        if pa.types.is_integer(self.type):  # Arrow would cut 2.5 down to 2
            for value in values:
                if value is not None and not isinstance(value, int | np.integer):
                    raise SchemaError(f"{where}: expected a whole number, not {value!r:.60}")
        try:
            array = pa.array(values, self.type)
        except (pa.ArrowException, TypeError, ValueError) as error:
            raise SchemaError(f"{where}: {one_line(error)}") from None
        if pa.types.is_floating(self.type) and not pc.all(pc.is_finite(array), min_count=0).as_py():
            raise SchemaError(f"{where}: a number that is not finite")
        if self.allowed and (unknown := set(values) - {*self.allowed, None}):
            raise SchemaError(f"{where}: {min(unknown)!r} is none of {', '.join(self.allowed)}")
        return array

    def from_arrow(self, array: pa.Array) -> list[Any]:
        """The values of an Arrow array."""
        return list(array.to_pylist())


@dataclass(frozen=True)
class Array:
    """An (n, k) numpy array with k named columns, stored as a list of structs."""

    columns: tuple[str, ...]
    item: pa.DataType

    @property
    def type(self) -> pa.DataType:
        """Arrow type."""
        return pa.list_(pa.struct([(name, self.item) for name in self.columns]))

    def to_arrow(self, values: Sequence[Any], where: str) -> pa.Array:
        """An Arrow array of the arrays."""
        dtype = np.dtype(self.item.to_pandas_dtype())
        for value in values:
            if not (isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == len(self.columns)):
                raise SchemaError(f"{where}: expected an (n, {len(self.columns)}) array")
            if value.dtype != dtype:
                raise SchemaError(f"{where}: expected {dtype}, not {value.dtype}")
        rows = np.concatenate([np.empty((0, len(self.columns)), dtype), *values])
        names = [pa.field(name, self.item) for name in self.columns]
        flat = pa.StructArray.from_arrays([pa.array(np.ascontiguousarray(c)) for c in rows.T], fields=names)
        return pa.ListArray.from_arrays(_offsets(len(value) for value in values), flat, type=self.type)

    def from_arrow(self, array: pa.Array) -> list[Any]:
        """The arrays of an Arrow array."""
        flat = array.flatten()
        rows = np.stack([flat.field(name).to_numpy(zero_copy_only=False) for name in self.columns], axis=1)
        ends = np.cumsum(pc.list_value_length(array).to_numpy(zero_copy_only=False))
        return np.split(rows, ends[:-1]) if len(array) else []


@dataclass(frozen=True)
class ListOf:
    """A tuple, of a fixed length if it has one."""

    item: Node
    length: int | None = None

    @property
    def type(self) -> pa.DataType:
        """Arrow type."""
        return pa.list_(self.item.type)

    def to_arrow(self, values: Sequence[Any], where: str) -> pa.Array:
        """An Arrow array of the tuples; None is null."""
        for value in values:
            if value is not None and (isinstance(value, str) or not isinstance(value, Sequence)):
                raise SchemaError(f"{where}: expected a tuple, not {value!r:.60}")
            if value is not None and self.length is not None and len(value) != self.length:
                raise SchemaError(f"{where}: expected {self.length} values, not {len(value)}")
        flat = [item for value in values if value is not None for item in value]
        if any(item is None for item in flat):
            raise SchemaError(f"{where}: None in a list")
        nulls = pa.array([value is None for value in values], pa.bool_())
        offsets = _offsets(0 if value is None else len(value) for value in values)
        return pa.ListArray.from_arrays(offsets, self.item.to_arrow(flat, where), type=self.type, mask=nulls)

    def from_arrow(self, array: pa.Array) -> list[Any]:
        """The tuples of an Arrow array."""
        flat = self.item.from_arrow(array.flatten())
        values: list[Any] = []
        start = 0
        for length in pc.list_value_length(array).to_pylist():
            values.append(None if length is None else tuple(flat[start : start + length]))
            start += length or 0
        return values


@dataclass(frozen=True)
class Member:
    """A field of a record."""

    name: str
    node: Node
    column: Column
    is_optional: bool

    @property
    def field(self) -> pa.Field:
        """Arrow field, with the documentation."""
        return pa.field(self.name, self.node.type, metadata=self.column.metadata())

    def to_arrow(self, records: Sequence[Any], where: str) -> pa.Array:
        """An Arrow array of this field of some records."""
        values = [getattr(record, self.name) for record in records]
        path = f"{where}.{self.name}" if where else self.name
        if not self.is_optional and any(value is None for value in values):
            raise SchemaError(f"{path}: None, but it must have a value")
        return self.node.to_arrow(values, path)


@dataclass(frozen=True)
class Struct:
    """A dataclass or named tuple."""

    record: type
    members: tuple[Member, ...]

    @cached_property
    def type(self) -> pa.DataType:
        """Arrow type."""
        return pa.struct([member.field for member in self.members])

    def to_arrow(self, values: Sequence[Any], where: str) -> pa.Array:
        """An Arrow array of the records; a plain tuple stands for a named one."""
        if issubclass(self.record, tuple):
            values = [self.record(*value) if type(value) is tuple else value for value in values]
        for value in values:
            if not isinstance(value, self.record):
                raise SchemaError(f"{where}: expected {self.record.__name__}, not {type(value).__name__}")
        arrays = [member.to_arrow(values, where) for member in self.members]
        return pa.StructArray.from_arrays(arrays, fields=list(self.type))

    def from_arrow(self, array: pa.Array) -> list[Any]:
        """The records of an Arrow array."""
        names = [member.name for member in self.members]
        columns = [member.node.from_arrow(array.field(member.name)) for member in self.members]
        # By name: a field may be keyword-only.
        return [self.record(**dict(zip(names, values, strict=True))) for values in zip(*columns, strict=True)]


Node = Leaf | Array | ListOf | Struct
Documentation = Mapping[type, Mapping[str, Column]]


def struct_of(record: type, documentation: Documentation) -> Struct:
    """The node of a dataclass or named tuple.

    Parameters
    ----------
    record : type
        Its fields are annotated with `Annotated[type, Column(...)]`, or documented in `documentation`.
    documentation : mapping
        By class, the columns of records that are annotated with plain types; a class has those of its bases too.

    Raises
    ------
    SchemaError
        For a field without documentation or with a type that is not supported.
    """
    hints = get_type_hints(record, include_extras=True)
    names = [f.name for f in dataclasses.fields(record)] if dataclasses.is_dataclass(record) else record._fields  # type: ignore[attr-defined]
    shared: dict[str, Column] = {}
    for base in reversed(record.__mro__):
        shared.update(documentation.get(base, {}))
    members = []
    for name in names:
        hint, column = hints[name], shared.get(name)
        if get_origin(hint) is Annotated:
            hint, column = get_args(hint)
        if column is None:
            raise SchemaError(f"{record.__name__}.{name} has no description; add a Column")
        choices = get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)
        inner = [choice for choice in choices if choice is not type(None)]
        node = node_of(inner[0], column, documentation)
        if len(inner) != 1 or (len(choices) == 2 and isinstance(node, Struct | Array)):
            raise SchemaError(f"{record.__name__}.{name}: {hint} has no Arrow type here")
        members.append(Member(name, node, column, is_optional=len(choices) == 2))
    return Struct(record, tuple(members))


def node_of(hint: Any, column: Column, documentation: Documentation) -> Node:
    """The node of an annotation, see `struct_of`."""
    if column.columns:  # said by the Column alone: what `NDArray[...]` is at run time differs between releases of numpy
        if column.arrow is None:
            raise SchemaError(f"an array with the columns {', '.join(column.columns)} needs an Arrow type")
        return Array(column.columns, pa.type_for_alias(column.arrow))
    if column.arrow is not None:
        return Leaf(pa.type_for_alias(column.arrow))
    if hint in _LEAVES:
        return Leaf(_LEAVES[hint])
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Literal:
        return Leaf(pa.string(), inner)
    if origin is tuple:
        length = None if inner[-1] is Ellipsis else len(inner)
        return ListOf(node_of(inner[0], column, documentation), length)
    if isinstance(hint, type) and (dataclasses.is_dataclass(hint) or hasattr(hint, "_fields")):
        return struct_of(hint, documentation)
    raise SchemaError(f"{hint} has no Arrow type here")


_LEAVES: dict[Any, pa.DataType] = {
    str: pa.string(),
    int: pa.int32(),
    float: pa.float64(),
    bool: pa.bool_(),
    bytes: pa.binary(),
}


def _offsets(lengths: Iterable[int]) -> pa.Array:
    return pa.array(np.concatenate([[0], np.cumsum(np.fromiter(lengths, dtype=np.int64))]).astype(np.int32))
