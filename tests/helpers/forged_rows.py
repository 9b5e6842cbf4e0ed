"""Datasets with a forged row and checksums that fit: what a stranger can put into a Parquet file.

Most cases follow from the schema, so that a new column is forged too: every value is null, every number is not finite or
far off, every text long, unknown or no text at all, every list empty, short or long. The others lie about rooms and images.
"""

from __future__ import annotations

import json
import shutil
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from remqa_data.storage.manifest import MANIFEST, load_manifest
from remqa_data.storage.shards import file_info
from remqa_data.tables.fields import Array, Leaf, ListOf, Struct
from remqa_data.tables.images import StoredImage
from remqa_data.tables.schema import TABLES, table_spec

Change = Callable[[Any], Any]
"""Gives another value for the one that is stored."""


@dataclass(frozen=True)
class Forgery:
    """A lie about one value of the first row of a table's test split (of the column of all rows, if it says so).

    `path` leads to the value: names of fields, and 0 for the first item of a list.
    """

    table: str
    path: tuple[str | int, ...]
    what: str
    change: Change

    @property
    def name(self) -> str:
        return f"{self.table}.{'.'.join(map(str, self.path))}: {self.what}"


def forge(root: Path, out: Path, forgery: Forgery) -> Path:
    """A copy of a dataset with one forged row."""
    shutil.copytree(root, out)
    manifest = load_manifest(out)
    split = "test" if "test" in manifest.splits(forgery.table) else manifest.splits(forgery.table)[-1]
    info = manifest.files_of(forgery.table, split)[0]
    data = pq.read_table(out / info.path)
    column = str(forgery.path[0])
    values = data[column].to_pylist()
    values[0] = _changed(values[0], forgery.path[1:], forgery.change)
    place = data.schema.get_field_index(column)
    data = data.set_column(place, data.schema.field(column), pa.array(values, data.schema.field(column).type))
    pq.write_table(data, out / info.path, row_group_size=table_spec(forgery.table).row_group_rows)
    new = file_info(out / info.path, info.path, info.table, info.split)
    files = tuple(new if file.path == info.path else file for file in manifest.files)
    (out / MANIFEST).write_text(json.dumps(asdict(replace(manifest, files=files))))
    return out


def _changed(value: Any, path: tuple[str | int, ...], change: Change) -> Any:
    if not path:
        return change(value)
    first, rest = path[0], path[1:]
    if isinstance(value, dict):
        return value | {first: _changed(value[first], rest, change)}
    assert isinstance(first, int), value
    return [_changed(item, rest, change) if place == first else item for place, item in enumerate(value)]


def forgeries() -> list[Forgery]:
    """All of them."""
    return [*schema_forgeries(), *room_forgeries(), *image_forgeries()]


def schema_forgeries() -> Iterator[Forgery]:
    """Lies about each column and nested field, by what its type is."""
    for table, spec in TABLES.items():
        yield from _of_struct(table, spec.record, ())


def _of_struct(table: str, record: Struct, path: tuple[str | int, ...]) -> Iterator[Forgery]:
    for member in record.members:
        inner = (*path, member.name)
        if not member.is_optional:
            yield Forgery(table, inner, "null", lambda _: None)
        if not member.is_optional or len(path) == 0:
            yield from _of_node(table, member.node, inner)


def _of_node(table: str, node: Leaf | Array | ListOf | Struct, path: tuple[str | int, ...]) -> Iterator[Forgery]:
    if isinstance(node, Struct):
        if node.record is not StoredImage:
            yield from _of_struct(table, node, path)
        else:
            yield Forgery(table, (*path, "bytes"), "null", lambda _: None)
            yield Forgery(table, (*path, "bytes"), "empty", lambda _: b"")
    elif isinstance(node, Leaf):
        for what, value in _lies_about(node.type):
            yield Forgery(table, path, what, lambda _, value=value: value)
    else:
        yield from _of_list(table, node, path)


def _of_list(table: str, node: Array | ListOf, path: tuple[str | int, ...]) -> Iterator[Forgery]:
    yield Forgery(table, path, "empty", lambda _: [])
    yield Forgery(table, path, "a null in it", lambda items: [None, *(items or [])[1:]])
    if isinstance(node, ListOf) and node.length is not None:
        yield Forgery(table, path, "one short", lambda items: (items or [0] * node.length)[1:])
        yield Forgery(table, path, "a nan or a huge number", lambda items: [_far(node.item), *(items or [0] * 4)[1:]])
    else:
        yield Forgery(table, path, "100,000 items", lambda items: (items or [])[:1] * 100_000)
        if isinstance(node, ListOf) and isinstance(node.item, Leaf):
            yield Forgery(table, path, "an unknown id", lambda items: ["nobody|9", *(items or [])[1:]])


def _far(node: Any) -> float | int:
    return float("nan") if pa.types.is_floating(node.type) else 2**31 - 1


def _lies_about(kind: pa.DataType) -> list[tuple[str, Any]]:
    if pa.types.is_floating(kind):
        return [("nan", float("nan")), ("-inf", float("-inf")), ("1e300", 1e300), ("-1e6", -1e6)]
    if pa.types.is_integer(kind):
        least, most = (-(2**63), 2**63 - 1) if kind == pa.int64() else (-(2**31), 2**31 - 1)
        return [("the least", least), ("the most", most)]
    if pa.types.is_boolean(kind):
        return []
    return [
        ("empty", ""),
        ("unknown", "nobody|9"),
        ("control characters", "\x1b[2J\x07\u202e"),
        ("10 MB", "x" * 10_000_000),
        ("deep brackets", "[" * 4000),
    ]


def _room(what: str, change: Change) -> Forgery:
    return Forgery("scenes", ("scene_json",), what, lambda text: json.dumps(change(json.loads(text))))


def _object(what: str, **fields: Any) -> Forgery:
    return _room(what, lambda room: room | {"objects": [room["objects"][0] | fields, *room["objects"][1:]]})


def _asset(what: str, **fields: Any) -> Forgery:
    return _room(
        what,
        lambda room: (
            room
            | {"objects": [room["objects"][0] | {"asset": room["objects"][0]["asset"] | fields}, *room["objects"][1:]]}
        ),
    )


def _many(room: dict[str, Any], count: int, **asset: Any) -> dict[str, Any]:
    first = room["objects"][0]
    more = [first | {"id": f"More|{i}", "asset": first["asset"] | {"seed": i} | asset} for i in range(count)]
    return room | {"objects": [*room["objects"], *more]}


def room_forgeries() -> Iterator[Forgery]:
    """Rooms that cannot be, or that ask for more than any machine has."""
    nan, inf = float("nan"), float("inf")
    yield Forgery("scenes", ("scene_json",), "not JSON", lambda _: "{")
    yield Forgery("scenes", ("scene_json",), "a list", lambda _: "[]")
    yield Forgery("scenes", ("scene_json",), "no objects", lambda text: json.dumps(json.loads(text) | {"objects": []}))
    for what, bounds in (
        ("bounds of 10 km", [-5000, -5000, 5000, 5000]),
        ("bounds of 31 m", [0, 0, 31, 31]),
        ("bounds the wrong way round", [3, 3, -3, -3]),
        ("bounds of a point", [0, 0, 0, 0]),
        ("nan bounds", [nan] * 4),
        ("inf bounds", [0, 0, inf, inf]),
        ("bounds far off", [1e9, 1e9, 1e9 + 5, 1e9 + 5]),
        ("three bounds", [0, 0, 1]),
    ):
        yield _room(what, lambda room, bounds=bounds: room | {"bounds": bounds})
    for what, fields in (
        ("height of 1e12", {"height": 1e12}),
        ("height of 0", {"height": 0}),
        ("floor at nan", {"floor_z": nan}),
        ("a hundred thousand lights", {"lights": [[0, 0, 2]] * 100_000}),
        ("a light at inf", {"lights": [[inf, 0, 2]]}),
        ("no lights", {"lights": []}),
        ("no structure", {"structure": []}),
        ("another version", {"format_version": 99}),
        ("a name of 1 MB", {"name": "x" * 1_000_000}),
    ):
        yield _room(what, lambda room, fields=fields: room | fields)
    for what, fields in (
        ("a box of nan", {"box": [nan] * 6}),
        ("a box of 1e9 m", {"box": [-1e9, -1e9, 0, 1e9, 1e9, 1]}),
        ("a box inside out", {"box": [1, 1, 1, 0, 0, 0]}),
    ):
        yield _room(what, lambda room, f=fields: room | {"structure": [room["structure"][0] | f, *room["structure"]]})
    for what, finish in (
        ("an unknown texture", {"texture": "nobody"}),
        ("a texture repeated at 0 m", {"texture": "wood", "repeat_m": 0}),
        ("a colour of nan", {"rgb": [nan, 0, 0]}),
        ("a gloss of 1e30", {"gloss": 1e30}),
        ("a mirror that shows twice what is there", {"mirror": 2.0}),
    ):
        yield _room(
            what,
            lambda room, f=finish: (
                room
                | {
                    "structure": [
                        room["structure"][0] | {"finish": room["structure"][0]["finish"] | f},
                        *room["structure"],
                    ]
                }
            ),
        )
    yield _room("3,000 objects", lambda room: _many(room, 3000))
    yield _room("200 shelving units of 30 m", lambda room: _many(room, 200, type="ShelvingUnit", size=[30, 30, 30]))
    yield _room("200 light switches of 12 m", lambda room: _many(room, 200, type="LightSwitch", size=[12, 12, 8]))
    yield _room("20,000 pieces of the building", lambda room: room | {"structure": room["structure"][:1] * 20_000})
    yield _room("the same id twice", lambda room: room | {"objects": room["objects"] + room["objects"][:1]})
    yield _object("an object far off", position=[1e6, 0, 0])
    yield _object("an object at nan", position=[nan, 0, 0])
    yield _object("an object turned by nothing", quaternion=[0, 0, 0, 0])
    yield _object("an object turned by nan", quaternion=[nan, 0, 0, 1])
    yield _object("openness of 1000", openness=1000)
    yield _object("unknown parents", parents=["nobody|9"])
    yield _object("its own parent", parents=["Floor"] * 1000)
    yield _object("an id of null", id=None)
    yield _asset("an unknown type", type="Nobody")
    yield _asset("a size of 0", size=[0, 0, 0])
    yield _asset("a negative size", size=[-1, 1, 1])
    yield _asset("a size of nan", size=[nan, 1, 1])
    yield _asset("a size of 1e9", size=[1e9, 1, 1])
    yield _asset("a size of 1e-12", size=[1e-12] * 3)
    yield _asset("a bathtub of 2 mm", type="Bathtub", size=[0.002] * 3)
    yield _asset("a painting of 2 mm", type="Painting", size=[0.002] * 3)
    yield _asset("a variant of 2**70", variant=2**70)
    yield _asset("a negative variant", variant=-1)
    yield _asset("a seed of 2**70", seed=2**70)
    yield _asset("a negative seed", seed=-5)
    yield _asset("100,000 levels", levels=[0.1] * 100_000)
    yield _asset("nan levels", levels=[nan])
    yield _asset("levels of a shelf out of it", type="ShelvingUnit", size=[1, 0.4, 1.5], levels=[-9, 9])
    yield _asset("pockets of nan", type="Dresser", pockets=[[nan] * 6])
    yield _asset("a footprint of nothing", type="CounterTop", footprint=[[0, 0, 0, 0]])


def bare_png(width: int, height: int) -> bytes:
    """A whole PNG file of black pixels: a few bytes in the file, width x height in memory."""
    packed = zlib.compressobj(9)
    row = bytes(1 + (width + 7) // 8)
    data = b"".join(packed.compress(row) for _ in range(height)) + packed.flush()
    header = struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", data), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)) for kind, body in chunks
    )


def bare_jpeg(width: int, height: int) -> bytes:
    """A JPEG file that is nothing but the size it claims."""
    return b"\xff\xd8\xff\xff\xc0" + struct.pack(">HBHHB", 8, 8, height, width, 1) + bytes(40) + b"\xff\xd9"


IMAGES: tuple[tuple[str, Callable[[], bytes]], ...] = (
    ("a PNG of 30,000 x 30,000", lambda: bare_png(30_000, 30_000)),
    ("a PNG of 2**31 x 1", lambda: b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", 2**31, 1) + bytes(50)),
    ("a PNG of 0 x 0", lambda: bare_png(1, 1)[:16] + bytes(8) + bare_png(1, 1)[24:]),
    ("a PNG cut off", lambda: bare_png(300, 300)[:40]),
    ("a PNG of one bit", lambda: bare_png(300, 300)),
    ("a JPEG of 60,000 x 60,000", lambda: bare_jpeg(60_000, 60_000)),
    ("a JPEG of markers", lambda: b"\xff\xd8" + b"\xff" * 100_000),
    ("a BMP", lambda: b"BM" + struct.pack("<IHHIIiiHHIIiiII", 54, 0, 0, 54, 40, 9000, 9000, 1, 24, 0, 0, 1, 1, 0, 0)),
    ("a text", lambda: b"<svg onload='alert(1)'/>"),
)


def image_forgeries() -> Iterator[Forgery]:
    """Images that are none, or larger than any memory."""
    for table, spec in TABLES.items():
        for column in spec.image_columns:
            for what, image in IMAGES:
                yield Forgery(table, (column, "bytes"), what, lambda _, image=image: image())
