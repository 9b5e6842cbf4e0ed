"""Forged datasets: one lie each, told so that every checksum, count, card and croissant.json agrees with it.

Most follow from the tables: each column of each table loses its value, takes another row's, and is off by as little as can
be; rows are deleted, doubled, swapped, moved and invented. The rest are told by hand: what lies around the tables.
"""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow as pa

from remqa_data.storage.card import CARD, CROISSANT, write_card
from remqa_data.storage.manifest import MANIFEST, Manifest, config_hash, load_manifest, write_manifest
from remqa_data.storage.shards import Shard, ShardWriter, file_info
from remqa_data.tables.schema import TABLES, table_spec

Values = dict[str, Any]


@dataclass(frozen=True)
class Forgery:
    """A lie.

    Attributes
    ----------
    what : str
        Which table or file it is in.
    name : str
        What it is, unique.
    tell : callable
        Tells it in a copy of a dataset.
    """

    what: str
    name: str
    tell: Callable[[Copy], None]


class Copy:
    """A copy of a dataset, to be forged: shards are changed by rows, and all that depends on them follows."""

    def __init__(self, root: Path, out: Path) -> None:
        self.root = Path(shutil.copytree(root, out))

    def rows(self, table: str) -> list[Values]:
        """The rows of a table as plain values."""
        (file,) = load_manifest(self.root).files_of(table)
        return list(Shard(self.root / file.path, table).read().to_pylist())

    def store(self, table: str, rows: list[Values]) -> None:
        """Replace the rows of a table; whatever Parquet takes."""
        (file,) = load_manifest(self.root).files_of(table)
        with ShardWriter(self.root / file.path, table) as writer:
            writer.write_table(pa.Table.from_pylist(rows, schema=table_spec(table).schema))
        self.seal()

    def seal(self, change: Callable[[Manifest], Manifest] = lambda manifest: manifest) -> None:
        """Make manifest, card and croissant.json fit the files, or what the manifest is changed to."""
        manifest = load_manifest(self.root)
        files = tuple(file_info(self.root / f.path, f.path, f.table, f.split) for f in manifest.files)
        told = change(replace(manifest, files=files))
        write_card(self.root, told)
        write_manifest(self.root, told)

    def edit(self, name: str, old: str, new: str) -> None:
        """Change a text file in one place."""
        path = self.root / name
        text = path.read_text()
        assert old in text, f"{name} has no {old!r}"
        path.write_text(text.replace(old, new, 1))


def forgeries() -> Iterator[Forgery]:
    """All of them."""
    for table in TABLES:
        for column in table_spec(table).schema.names:
            for how, change in (("null", _null), ("of another row", _other), ("off by little", _nudged)):
                yield Forgery(table, f"{table}.{column} {how}", _column_lie(table, column, change))
        for how, reorder in ROW_LIES.items():
            yield Forgery(table, f"{table}: {how}", _rows_lie(table, reorder))
    for table, name, tell in ROW_VALUE_LIES:
        yield Forgery(table, name, _first_row_lie(table, tell))
    for name, change in MANIFEST_LIES.items():
        yield Forgery(MANIFEST, name, lambda copy, change=change: copy.seal(change))
    for name, edit in MANIFEST_TEXT_LIES.items():
        yield Forgery(MANIFEST, name, _json_lie(MANIFEST, edit))
    for old, new in CARD_LIES:
        yield Forgery(CARD, f"card: {old.strip()[:30]!r} becomes {new.strip()[:40]!r}", _text_lie(CARD, old, new))
    for name, edit in CROISSANT_LIES.items():
        yield Forgery(CROISSANT, name, _json_lie(CROISSANT, edit))
    for name, tell in FOLDER_LIES.items():
        yield Forgery("folder", name, tell)


# ---- columns


def _column_lie(table: str, column: str, change: Callable[[list[Values], str], Any]) -> Callable[[Copy], None]:
    def tell(copy: Copy) -> None:
        rows = copy.rows(table)
        at = next((i for i, row in enumerate(rows) if row[column] not in (None, [])), 0)
        before = deepcopy(rows[at][column])
        rows[at][column] = change(rows[at:] + rows[:at], column)
        assert repr(rows[at][column]) != repr(before), f"{table}.{column}: this is no lie"
        copy.store(table, rows)

    return tell


def _null(rows: list[Values], column: str) -> None:
    return None


def _other(rows: list[Values], column: str) -> Any:
    """The value of another row; of a column that is everywhere the same, another that is well-formed."""
    own = repr(rows[0][column])
    found = next((row[column] for row in rows if repr(row[column]) != own), None)
    if found is not None:
        return deepcopy(found)
    return SAME_EVERYWHERE[column] if column in SAME_EVERYWHERE else nudged(nudged(rows[0][column]))


SAME_EVERYWHERE: Values = {
    "scene": "FloorPlan4",
    "room_type": "bathroom",
    "split": "train",
    "seed": 1,
    "embodiment": {"camera_height_m": 1.576, "fov_deg": 90.0, "step_m": 0.25, "reach_m": 99.0},
}


def _nudged(rows: list[Values], column: str) -> Any:
    return nudged(rows[0][column])


def nudged(value: Any) -> Any:
    """A value that is off by as little as can be."""
    match value:
        case bool():
            return not value
        case int():
            return value + 1
        case float():
            return math.nextafter(value, math.inf)
        case str():
            return value[:-1] + ("x" if value[-1] != "x" else "y")
        case bytes():
            return value[: len(value) // 2] + bytes([value[len(value) // 2] ^ 1]) + value[len(value) // 2 + 1 :]
        case list() if value:
            return [*value[:-1], nudged(value[-1])]
        case dict():
            name = next(key for key, inner in value.items() if inner is not None)
            return {**value, name: nudged(value[name])}
    raise AssertionError(f"no way to change {value!r}")


# ---- rows


def _rows_lie(table: str, reorder: Callable[[list[Values]], list[Values]]) -> Callable[[Copy], None]:
    return lambda copy: copy.store(table, reorder(copy.rows(table)))


ROW_LIES: dict[str, Callable[[list[Values]], list[Values]]] = {
    "the first row is deleted": lambda rows: rows[1:],
    "the last row is deleted": lambda rows: rows[:-1],
    "a row in the middle is deleted": lambda rows: rows[: len(rows) // 2] + rows[len(rows) // 2 + 1 :],
    "half of the rows are deleted": lambda rows: rows[: len(rows) // 2],
    "a row is doubled": lambda rows: [rows[0], *rows],
    "a row is put in the place of another": lambda rows: [rows[1], *rows[1:]],
    "two rows are swapped": lambda rows: [rows[1], rows[0], *rows[2:]],
    "the rows are reversed": lambda rows: rows[::-1],
}


def _first_row_lie(table: str, change: Callable[[Values], None]) -> Callable[[Copy], None]:
    def tell(copy: Copy) -> None:
        rows = copy.rows(table)
        change(rows[0])
        copy.store(table, rows)

    return tell


def png(value: int, size: int = 150) -> bytes:
    """A plain 16-bit PNG."""
    return bytes(cv2.imencode(".png", np.full((size, size), value, np.uint16))[1])


def black_jpeg(size: int) -> bytes:
    """A black picture."""
    return bytes(cv2.imencode(".jpg", np.zeros((size, size, 3), np.uint8))[1])


def _put(*path: str | int, value: Any) -> Callable[[Values], None]:
    """Sets a value that lies deep in a row."""

    def change(row: Values) -> None:
        inner: Any = row
        for step in path[:-1]:
            inner = inner[step]
        inner[path[-1]] = value(inner[path[-1]]) if callable(value) else value

    return change


def _scene(edit: Callable[[Any], Any]) -> Callable[[Values], None]:
    """Changes the stored room."""

    def change(row: Values) -> None:
        scene = json.loads(row["scene_json"])
        edit(scene)
        row["scene_json"] = json.dumps(scene, separators=(",", ":"))

    return change


ROW_VALUE_LIES: list[tuple[str, str, Callable[[Values], None]]] = [
    ("frames", "frames: a black picture", _put("rgb", "bytes", value=black_jpeg(150))),
    ("frames", "frames: a text as picture", _put("rgb", "bytes", value=b"a mug")),
    ("frames", "frames: a picture without bytes", _put("rgb", "bytes", value=None)),
    ("frames", "frames: an empty picture", _put("rgb", "bytes", value=b"")),
    ("frames", "frames: a depth of nothing", _put("depth", "bytes", value=png(0))),
    ("frames", "frames: instances of one object", _put("instances", "bytes", value=png(1))),
    ("frames", "frames: a picture of another size", _put("depth", "bytes", value=png(0, 3000))),
    ("frames", "frames: a picture with a name from outside", _put("rgb", "path", value="../../secret.jpg")),
    ("frames", "frames: the agent a step further", _put("agent", "position", 0, value=lambda x: x + 0.25)),
    ("frames", "frames: the agent half a step further", _put("agent", "position", 0, value=lambda x: x + 0.125)),
    ("frames", "frames: the agent turned", _put("agent", "yaw_deg", value=lambda yaw: (yaw + 90) % 360)),
    ("frames", "frames: the agent nowhere", _put("agent", "position", 0, value=math.nan)),
    ("frames", "frames: the camera tilted", _put("agent", "horizon_deg", value=lambda horizon: 30 - horizon)),
    ("frames", "frames: a box moved by a pixel", _put("objects", 0, "box_2d", 0, value=lambda x: x + 1)),
    ("frames", "frames: a box of three numbers", _put("objects", 0, "box_2d", value=[0, 0, 1])),
    ("frames", "frames: a pixel more", _put("objects", 0, "pixels", value=lambda n: n + 1)),
    ("frames", "frames: another id", _put("objects", 0, "id", value="Unicorn|1")),
    ("frames", "frames: another type", _put("objects", 0, "type", value="Mug")),
    ("frames", "frames: another colour", _put("objects", 0, "color", value="purple")),
    ("frames", "frames: an object opened", _put("objects", 0, "openness", value=0.5)),
    ("frames", "frames: an object picked up", _put("objects", 0, "is_picked_up", value=True)),
    ("frames", "frames: no visible objects", _put("objects", value=[])),
    ("frames", "frames: an edge turned around", _put("added_edges", 0, "relation", value="under")),
    ("frames", "frames: minus zero", _put("agent", "horizon_deg", value=lambda x: -x if x == 0 else x + 1e-9)),
    ("scenes", "scenes: an arm of 99 m", _put("embodiment", "reach_m", value=99.0)),
    ("scenes", "scenes: a camera a hair higher", _put("embodiment", "camera_height_m", value=1.5760001)),
    ("scenes", "scenes: a field of view of 91 degrees", _put("embodiment", "fov_deg", value=91.0)),
    ("scenes", "scenes: steps of 0.5 m", _put("embodiment", "step_m", value=0.5)),
    ("scenes", "scenes: an object moved by 2 cm", _scene(lambda s: s["objects"][1]["position"].__setitem__(0, 0.02))),
    ("scenes", "scenes: an object that physics moves", _scene(lambda s: s["objects"][1].update(is_fixed=False))),
    ("scenes", "scenes: an object without parents", _scene(lambda s: s["objects"][-1].update(parents=[]))),
    ("scenes", "scenes: an object removed", _scene(lambda s: s["objects"].pop())),
    ("scenes", "scenes: an object twice", _scene(lambda s: s["objects"].append(s["objects"][0]))),
    ("scenes", "scenes: a lamp moved", _scene(lambda s: s["lights"][0].__setitem__(0, s["lights"][0][0] + 0.1))),
    ("scenes", "scenes: a wall removed", _scene(lambda s: s["structure"].pop())),
    ("scenes", "scenes: a higher ceiling", _scene(lambda s: s.update(height=s["height"] + 0.01))),
    ("scenes", "scenes: a room of 10 km", _scene(lambda s: s.update(bounds=[0, 0, 10000, 10000]))),
    ("scenes", "scenes: a room of nan", _put("scene_json", value='{"name": NaN}')),
    ("scenes", "scenes: another room", _scene(lambda s: s.update(name="FloorPlan4"))),
    ("scenes", "scenes: a room with a key more", _scene(lambda s: s.update(owner="me"))),
    ("scenes", "scenes: the room as no JSON", _put("scene_json", value="{")),
    ("scenes", "scenes: spaces in the room's JSON", _put("scene_json", value=lambda text: text + "\n")),
    ("scenes", "scenes: a graph without edges", _put("graph_edges", value=[])),
    ("scenes", "scenes: a graph without a node", _put("graph_nodes", value=lambda nodes: nodes[1:])),
    ("scenes", "scenes: an edge turned around", _put("graph_edges", 0, "relation", value="under")),
    ("scenes", "scenes: a map without voxels", _put("semantic_map", "voxels", value=[])),
    (
        "scenes",
        "scenes: a voxel of another type",
        _put("semantic_map", "voxels", 0, "label", value=lambda n: 1 - min(n, 1)),
    ),
    ("scenes", "scenes: a type of voxels renamed", _put("semantic_map", "labels", 1, value="Unicorn")),
    ("scenes", "scenes: an empty plan", _put("map_2d", "bytes", value=png(0))),
    ("scenes", "scenes: a cell less to stand on", _put("navigation_cells", value=lambda cells: cells[1:])),
    ("scenes", "scenes: objects in another order", _put("objects", value=lambda objects: objects[::-1])),
    ("scenes", "scenes: an object's box a hair wider", _put("objects", 0, "box", 3, value=lambda x: x + 1e-9)),
    ("expressions", "expressions: nonsense", _put("text", value="the unicorn on the moon")),
    ("expressions", "expressions: a phrase without end", _put("text", value="the mug on " * 20000 + "the table")),
    ("expressions", "expressions: a program that counts", _put("program", value='[["filter_type", "Mug"], ["count"]]')),
    ("expressions", "expressions: a program that is a number", _put("program", value="5")),
    ("expressions", "expressions: a program without end", _put("program", value="[" * 100000)),
    ("expressions", "expressions: a box moved by a pixel", _put("box_2d", 0, value=lambda x: x + 1)),
    ("expressions", "expressions: a box of nothing", _put("box_2d", value=[0, 0, 0, 0])),
    ("questions", "questions: the answer turned", _put("answer", value=lambda a: "no" if a == "yes" else "yes")),
    ("questions", "questions: an answer that is none", _put("answer", value="maybe")),
    ("questions", "questions: a black start", _put("start_rgb", "bytes", value=black_jpeg(300))),
    ("questions", "questions: a text as picture", _put("end_rgb", "bytes", value=b"a mug")),
    ("questions", "questions: no action", _put("actions", value=[])),
    ("questions", "questions: a detour", _put("actions", value=lambda a: ["RotateLeft", "RotateRight", *a])),
    ("questions", "questions: an action after the end", _put("actions", value=lambda a: [*a, "MoveAhead"])),
    ("questions", "questions: an agent that teleports", _put("actions", value=lambda a: ["Teleport 0 0 0", *a])),
    ("questions", "questions: no goal", _put("goal_poses", value=[])),
    ("questions", "questions: a goal less", _put("goal_poses", value=lambda goals: goals[:-1])),
    ("questions", "questions: a goal twice", _put("goal_poses", value=lambda goals: [*goals, goals[0]])),
    ("questions", "questions: asked with a capital", _put("question", value=lambda text: text.upper())),
    ("questions", "questions: a step less", _put("path_steps", value=lambda n: n - 1)),
    ("questions", "questions: a path a hair longer", _put("path_length_m", value=lambda x: x + 1e-9)),
    ("questions", "questions: an endless path", _put("path_length_m", value=math.inf)),
    ("questions", "questions: objects in another order", _put("object_ids", value=lambda ids: ids[::-1])),
    ("questions", "questions: a start that is nowhere", _put("initial_pose", "position", 0, value=-50.0)),
]


# ---- manifest


def _with_config(**changes: Any) -> Callable[[Manifest], Manifest]:
    """Another configuration, and its hash."""

    def change(manifest: Manifest) -> Manifest:
        config = {**manifest.config, **changes}
        return replace(manifest, config=config, config_sha256=config_hash(config))

    return change


def _with_file(**changes: Any) -> Callable[[Manifest], Manifest]:
    """The first file told of otherwise."""
    return lambda m: replace(m, files=(replace(m.files[0], **changes), *m.files[1:]))


MANIFEST_LIES: dict[str, Callable[[Manifest], Manifest]] = {
    "manifest: another seed": lambda m: replace(m, seed=1),
    "manifest: another seed, in the configuration too": lambda m: _with_config(seed=1)(replace(m, seed=1)),
    "manifest: another hash": lambda m: replace(m, config_sha256="0" * 64),
    "manifest: an empty configuration": lambda m: replace(m, config={}, config_sha256=config_hash({})),
    "manifest: a configuration of more rooms": _with_config(scenes=["FloorPlan27", "FloorPlan28"]),
    "manifest: a configuration of another room": _with_config(scenes=["FloorPlan28"]),
    "manifest: a configuration of a million rooms": _with_config(scenes=1_000_000, layouts="sampled"),
    "manifest: a configuration of sampled rooms": _with_config(scenes=1, layouts="sampled"),
    "manifest: more arrangements": _with_config(configurations=5),
    "manifest: more spare groups": _with_config(spare_groups={"EXISTENCE": 2, "COUNTING": 1, "SPATIAL": 1}),
    "manifest: pictures as PNG": _with_config(image={"size_px": 150, "rgb_format": "png"}),
    "manifest: pictures of another size": _with_config(image={"size_px": 151, "rgb_format": "jpeg"}),
    "manifest: pictures of 4096 pixels": _with_config(image={"size_px": 4096, "rgb_format": "jpeg"}),
    "manifest: a configuration with a key more": lambda m: _with_config(owner="me")(m),
    "manifest: more questions asked for": _with_config(
        questions={
            "train": {"EXISTENCE": 0, "COUNTING": 0, "SPATIAL": 0},
            "test": {"EXISTENCE": 8, "COUNTING": 4, "SPATIAL": 4},
        }
    ),
    "manifest: more frames asked for": lambda m: _with_config(walk={**m.config["walk"], "frames_per_configuration": 5})(
        m
    ),
    "manifest: fewer headings": lambda m: _with_config(walk={**m.config["walk"], "headings_deg": [0, 90]})(m),
    "manifest: more cells": lambda m: _with_config(walk={**m.config["walk"], "cells_per_frame": 8.0})(m),
    "manifest: another version": lambda m: replace(m, versions={**m.versions, "numpy": "1.99.0"}),
    "manifest: another version of the package": lambda m: replace(m, versions={**m.versions, "remqa-data": "9.0"}),
    "manifest: another version of Arrow": lambda m: replace(m, versions={**m.versions, "pyarrow": "16.0.0"}),
    "manifest: another Python": lambda m: replace(m, versions={**m.versions, "python": "3.99.0"}),
    "manifest: a version that is none": lambda m: replace(m, versions={**m.versions, "numba": "<b>new</b>"}),
    "manifest: no versions": lambda m: replace(m, versions={}),
    "manifest: a version more": lambda m: replace(m, versions={**m.versions, "torch": "2.0"}),
    "manifest: no questions": lambda m: replace(m, questions={}),
    "manifest: a question more": lambda m: replace(
        m, questions={"test": {**m.questions["test"], "SPATIAL": m.questions["test"]["SPATIAL"] + 1}}
    ),
    "manifest: questions of another split": lambda m: replace(m, questions={"train": m.questions["test"]}),
    "manifest: more refused": lambda m: replace(m, refused={**m.refused, "necessary": 7}),
    "manifest: fewer than none refused": lambda m: replace(m, refused={"necessary": -1}),
    "manifest: another format": lambda m: replace(m, format_version=m.format_version - 1),
    "manifest: a file dropped": lambda m: replace(m, files=m.files[1:]),
    "manifest: the last file dropped": lambda m: replace(m, files=m.files[:-1]),
    "manifest: no files": lambda m: replace(m, files=()),
    "manifest: files reordered": lambda m: replace(m, files=m.files[::-1]),
    "manifest: a file twice": lambda m: replace(m, files=(*m.files, m.files[0])),
    "manifest: a path with ..": _with_file(path="scenes/../../other/test-00000-of-00001.parquet"),
    "manifest: a path upwards": _with_file(path="../scenes/test-00000-of-00001.parquet"),
    "manifest: an absolute path": _with_file(path="/etc/passwd"),
    "manifest: a path of Windows": _with_file(path="scenes\\test-00000-of-00001.parquet"),
    "manifest: a path of another machine": _with_file(path="s3://bucket/scenes/test-00000-of-00001.parquet"),
    "manifest: an empty path": _with_file(path=""),
    "manifest: a path with a line end": _with_file(path="scenes/test-00000-of-00001.parquet\n"),
    "manifest: a hidden path": _with_file(path="scenes/.test-00000-of-00001.parquet"),
    "manifest: another table": _with_file(table="frames"),
    "manifest: an unknown table": _with_file(table="answers"),
    "manifest: another split": _with_file(split="train"),
    "manifest: an unknown split": _with_file(split="../test"),
    "manifest: more rows": _with_file(rows=1000),
    "manifest: fewer than no rows": _with_file(rows=-4),
    "manifest: more bytes": _with_file(bytes=1),
    "manifest: another checksum": _with_file(sha256="0" * 64),
    "manifest: a checksum that is a path": _with_file(sha256="../../../../tmp/shard"),
}

Edit = Callable[[Any], Any]

MANIFEST_TEXT_LIES: dict[str, Edit] = {
    "manifest: a key more": lambda m: m.update(owner="me"),
    "manifest: a key of a file more": lambda m: m["files"][0].update(url="https://example.org/scenes.parquet"),
    "manifest: a key less": lambda m: m.pop("refused"),
    "manifest: the seed as text": lambda m: m.update(seed="0"),
    "manifest: no configuration": lambda m: m.update(config=None),
    "manifest: how many configurations as text": lambda m: m["config"].update(configurations="4"),
    "manifest: keys in another order": lambda m: [m.update({key: m.pop(key)}) for key in sorted(m)],
}

CROISSANT_LIES: dict[str, Edit] = {
    "croissant: another licence": lambda c: c.update(license="https://example.org/mine"),
    "croissant: another name": lambda c: c.update(name="mine"),
    "croissant: another checksum": lambda c: c["distribution"][0].update(sha256="0" * 64),
    "croissant: a file from elsewhere": lambda c: c["distribution"][0].update(
        contentUrl="https://example.org/a.parquet"
    ),
    "croissant: a file dropped": lambda c: c["distribution"].pop(0),
    "croissant: another size": lambda c: c["distribution"][0].update(contentSize="1 B"),
    "croissant: a glob of all": lambda c: c["distribution"][-1].update(includes="**/*.parquet"),
    "croissant: a table dropped": lambda c: c["recordSet"].pop(),
    "croissant: a column dropped": lambda c: c["recordSet"][0]["field"].pop(),
    "croissant: a description changed": lambda c: c["recordSet"][0]["field"][0].update(description="the answer"),
    "croissant: a type changed": lambda c: c["recordSet"][0]["field"][0].update(dataType="sc:Integer"),
    "croissant: a key more": lambda c: c.update(url="https://example.org"),
}

CARD_LIES: list[tuple[str, str]] = [
    ("license: apache-2.0", "license: mit"),
    ("path: questions/test-*.parquet", "path: '**/*.parquet'"),
    ("path: frames/test-*.parquet", "path: https://example.org/frames.parquet"),
    ("split: test", "split: train"),
    ("- config_name: scenes\n", "- config_name: answers\n"),
    ("  default: true\n", ""),
    ("| 12 |", "| 13 |"),
    ("| 16 |", "| 17 |"),
    ("Every answer was verified in the simulator.", "No answer was verified."),
    ("import pandas, datasets", "import pandas, datasets, os; os.remove('x')"),
    ("Seed 0;", "Seed 1;"),
    ("Configuration ", "Configuration 0"),
    ("Apache-2.0.", "All rights reserved."),
    ("## Fields", "## Fields\n\nThe answer is always yes.\n"),
]


def _json_lie(name: str, edit: Edit) -> Callable[[Copy], None]:
    def tell(copy: Copy) -> None:
        path = copy.root / name
        data = json.loads(path.read_text())
        edit(data)
        path.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n")

    return tell


def _text_lie(name: str, old: str, new: str) -> Callable[[Copy], None]:
    return lambda copy: copy.edit(name, old, new)


# ---- the folder


def _extra(path: str, source: str | None = None) -> Callable[[Copy], None]:
    def tell(copy: Copy) -> None:
        target = copy.root / path
        target.parent.mkdir(parents=True, exist_ok=True)
        if source is None:
            target.write_text("print('hello')\n")
        else:
            shutil.copy(copy.root / source, target)

    return tell


def _rewritten(table: str, change: Callable[[pa.Table], pa.Table], **options: Any) -> Callable[[Copy], None]:
    """A shard written by another hand: same rows, other row groups or other words about the columns."""
    import pyarrow.parquet as pq

    def tell(copy: Copy) -> None:
        (file,) = load_manifest(copy.root).files_of(table)
        data = pq.read_table(copy.root / file.path)
        pq.write_table(change(data), copy.root / file.path, **options)
        copy.seal()

    return tell


def _with_footer(table: str, change: Callable[[bytes], bytes]) -> Callable[[Copy], None]:
    """The same pages, and after them other bytes: what filters of rows go by; of the same length, as its length follows."""

    def tell(copy: Copy) -> None:
        (file,) = load_manifest(copy.root).files_of(table)
        path = copy.root / file.path
        data = path.read_bytes()
        start = len(data) - 8 - int.from_bytes(data[-8:-4], "little")
        changed = change(data[start:-8])
        assert changed != data[start:-8]
        path.write_bytes(data[:start] + changed + data[-8:])
        copy.seal()

    return tell


FOLDER_LIES: dict[str, Callable[[Copy], None]] = {
    "folder: a shard that nobody declared": _extra(
        "questions/test-00001-of-00001.parquet", "questions/test-00000-of-00001.parquet"
    ),
    "folder: a shard of another split": _extra("frames/train-extra.parquet", "frames/test-00000-of-00001.parquet"),
    "folder: a link to a shard": lambda copy: (copy.root / "questions" / "test-00001-of-00001.parquet").symlink_to(
        "test-00000-of-00001.parquet"
    ),
    "folder: a script": _extra("remqa.py"),
    "folder: a text among shards": _extra("scenes/notes.txt"),
    "folder: a table that nobody declared": _extra("answers/test-00000-of-00001.parquet"),
    "folder: no card": lambda copy: (copy.root / CARD).unlink(),
    "folder: no croissant.json": lambda copy: (copy.root / CROISSANT).unlink(),
    "folder: no manifest": lambda copy: (copy.root / MANIFEST).unlink(),
    "folder: a shard missing": lambda copy: (copy.root / "frames/test-00000-of-00001.parquet").unlink(),
    "folder: an empty shard": lambda copy: (copy.root / "frames/test-00000-of-00001.parquet").write_bytes(b""),
    "folder: other descriptions of columns": _rewritten("questions", lambda t: t.replace_schema_metadata(None)),
    "folder: one row group": _rewritten("frames", lambda table: table, row_group_size=1000),
    "folder: a column less": _rewritten("questions", lambda table: table.drop_columns(["group"])),
    "folder: a column more": _rewritten("questions", lambda t: t.append_column("hint", t["answer"])),
    "folder: columns in another order": _rewritten("scenes", lambda t: t.select(t.schema.names[::-1])),
    "folder: statistics of another room": _with_footer(
        "questions", lambda footer: footer.replace(b"FloorPlan27", b"FloorPlan26")
    ),
    "folder: bytes of no column": _with_footer("expressions", lambda footer: b"hidden" + footer),
}
