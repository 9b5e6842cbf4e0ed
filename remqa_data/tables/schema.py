"""Arrow schemas of the four tables, and typed rows <-> Arrow.

The types follow from the annotations of the classes in `remqa_data.tables.rows`: str is string, int is int32, float is
float64, a tuple is a list, a dataclass or named tuple is a struct. Every field carries its description, unit and frame
as Arrow metadata, and the schema carries Hugging Face's features, so that `datasets.load_dataset("parquet", ...)`
decodes images. All fields are nullable, because Hugging Face reads no others; that a field has a value is checked in
`to_table`.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeVar

import pyarrow as pa

from remqa_data.errors import SchemaError, UnknownNameError
from remqa_data.tables.fields import Node, Struct, struct_of
from remqa_data.tables.images import StoredImage
from remqa_data.tables.rows import SHARED_FIELDS, ExpressionRow, FrameRow, QuestionRow, Row, SceneRow

R = TypeVar("R", SceneRow, FrameRow, ExpressionRow, QuestionRow)
TableName = Literal["scenes", "frames", "expressions", "questions"]
FEATURES_KEY = b"huggingface"
IMAGE_TYPE = pa.struct([("bytes", pa.binary()), ("path", pa.string())])


@dataclass(frozen=True)
class TableSpec:
    """A table.

    Attributes
    ----------
    name : str
        Also the name of its folder.
    row_type : type
        Class of its rows.
    description : str
        One sentence.
    row_group_rows : int
        Rows of one row group, which is what a reader must read to get at one row: few where rows hold images.
    record : Struct
        The fields of its rows.
    """

    name: TableName
    row_type: type[Row]
    description: str
    row_group_rows: int
    record: Struct

    @cached_property
    def schema(self) -> pa.Schema:
        """Arrow schema, with the documentation of every field and Hugging Face's features."""
        features = {member.name: _feature(member.node) for member in self.record.members}
        about = {FEATURES_KEY: json.dumps({"info": {"features": features}}).encode()}
        return pa.schema([member.field for member in self.record.members], metadata=about)

    @property
    def image_columns(self) -> tuple[str, ...]:
        """Names of the columns that hold images."""
        return tuple(m.name for m in self.record.members if _is_image(m.node))


@dataclass(frozen=True)
class FieldDoc:
    """Documentation of one column or nested field, for people.

    Attributes
    ----------
    path : str
        Such as "agent.yaw_deg" or, within a list of structs, "objects[].id".
    type : str
        Arrow type; "image" for an image.
    description, unit, frame : str
        Unit and frame are empty where there are none.
    """

    path: str
    type: str
    description: str
    unit: str
    frame: str


def table_spec(name: str) -> TableSpec:
    """The table with a name.

    Raises
    ------
    UnknownNameError
        With the nearest names.
    """
    if name not in TABLES:
        raise UnknownNameError("table", name, TABLES)
    return TABLES[name]


def table_of(row_type: type[Row]) -> TableSpec:
    """The table that holds rows of a class."""
    return next(spec for spec in TABLES.values() if spec.row_type is row_type)


def to_table(row_type: type[R], rows: Sequence[R]) -> pa.Table:
    """Typed rows as an Arrow table with the table's schema.

    Raises
    ------
    SchemaError
        Naming the table, the row, the field and what is wrong with it.
    """
    spec = table_of(row_type)
    try:
        return _to_table(spec, rows)
    except SchemaError as error:
        for number, row in enumerate(rows):
            try:
                _to_table(spec, [row])
            except SchemaError as found:
                raise SchemaError(f"{spec.name}: row {number}: {found}") from None
        raise SchemaError(f"{spec.name}: {error}") from None


def to_rows(row_type: type[R], data: pa.Table) -> list[R]:
    """The typed rows of an Arrow table, the inverse of `to_table`.

    Raises
    ------
    SchemaError
        If the table's columns are not those of the row type.
    """
    spec = table_of(row_type)
    check_schema(spec.name, data.schema)
    return [
        row for batch in data.combine_chunks().to_batches() for row in spec.record.from_arrow(batch.to_struct_array())
    ]


def check_schema(name: str, schema: pa.Schema) -> None:
    """Raise a SchemaError that names the first column that is missing, too many or of another type."""
    expected = table_spec(name).schema
    for field in expected:
        found = schema.field(field.name) if field.name in schema.names else None
        if found is None or found.type != field.type:
            has = "is missing" if found is None else f"is {found.type}"
            raise SchemaError(f"{name}: column {field.name} {has}; expected {field.type}")
    if schema.names != expected.names:
        extra = [column for column in schema.names if column not in expected.names]
        msg = f"unknown column {extra[0]}" if extra else f"columns are not in the order {', '.join(expected.names)}"
        raise SchemaError(f"{name}: {msg}")


def field_docs(schema: pa.Schema) -> list[FieldDoc]:
    """Documentation of all columns of a table and of the fields nested in them, from the schema's metadata."""
    return [doc for field in schema for doc in _docs(field, field.name)]


def _to_table(spec: TableSpec, rows: Sequence[Row]) -> pa.Table:
    array = spec.record.to_arrow(rows, "")
    return pa.Table.from_arrays(array.flatten(), schema=spec.schema)


def _is_image(node: Node) -> bool:
    return isinstance(node, Struct) and node.record is StoredImage


def _feature(node: Node) -> Any:
    """Hugging Face's feature as JSON; a list is [feature], which versions before and after 4 read alike."""
    if _is_image(node):
        return {"_type": "Image"}
    return _feature_of(node.type)


def _feature_of(kind: pa.DataType) -> Any:
    if pa.types.is_struct(kind):
        return {field.name: _feature_of(field.type) for field in kind}
    if pa.types.is_list(kind):
        return [_feature_of(kind.value_type)]
    return {"dtype": {"double": "float64"}.get(str(kind), str(kind)), "_type": "Value"}


def _docs(field: pa.Field, path: str) -> list[FieldDoc]:
    about = {key.decode(): text.decode() for key, text in (field.metadata or {}).items()}
    kind, item = field.type, field.type.value_type if pa.types.is_list(field.type) else field.type
    nested = item if pa.types.is_struct(item) and item != IMAGE_TYPE else []
    nested = [child for child in nested if child.metadata]  # the columns of an array are told of in its own description
    name = "image" if kind == IMAGE_TYPE else f"list<{_short(item)}>" if item is not kind else _short(kind)
    own = FieldDoc(path, name, about.get("description", ""), about.get("unit", ""), about.get("frame", ""))
    inside = f"{path}[]" if item is not kind else path
    return [own, *(doc for child in nested for doc in _docs(child, f"{inside}.{child.name}"))]


def _short(kind: pa.DataType) -> str:
    if pa.types.is_struct(kind):
        return "struct"
    return {"double": "float64"}.get(str(kind), str(kind))


def _table(name: TableName, row_type: type[Row], description: str, row_group_rows: int) -> TableSpec:
    return TableSpec(name, row_type, description, row_group_rows, struct_of(row_type, SHARED_FIELDS))


TABLES: dict[str, TableSpec] = {
    spec.name: spec
    for spec in (
        _table("scenes", SceneRow, "One row per configuration of a room: its ground truth, graph and maps.", 1),
        _table("frames", FrameRow, "One row per frame of a breadth-first walk through a configuration.", 4),
        _table("expressions", ExpressionRow, "One row per referring expression in a frame.", 1024),
        _table(
            "questions",
            QuestionRow,
            "One row per question, with the views before (I_start) and after (I_end) the manipulation.",
            4,
        ),
    )
}
"""By name, in the order in which they are written."""
