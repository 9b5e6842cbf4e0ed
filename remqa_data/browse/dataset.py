"""A finished dataset, for looking about in it: a light index in memory, and every picture read from its file when asked for."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pandas as pd
import pyarrow as pa

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import DatasetError
from remqa_data.geometry.types import I16
from remqa_data.mapping.semantic_map import UNKNOWN, SemanticPlan
from remqa_data.scene_graph.relations import Edge
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.storage.manifest import Manifest, load_manifest, question_splits
from remqa_data.tables.images import StoredImage
from remqa_data.tables.map_columns import plan_labels
from remqa_data.tables.schema import table_spec

INDEX = [
    *(
        "question_id",
        "kind",
        "question",
        "expression",
        "answer",
        "program",
        "scene",
        "room_type",
        "configuration",
        "split",
    ),
    *("group", "target_type", "answer_type", "manipulation", "path_length_m", "path_steps"),
]
"""Columns of all questions, which lists, filters and statistics are made of."""
ROOM = [
    *("scene", "room_type", "split", "configuration", "objects", "graph_nodes", "graph_edges", "navigation_cells"),
    *("semantic_map.labels", "semantic_map.corner", "semantic_map.voxel_m"),
]
"""All that a page shows of a room; the voxels are many, and their picture is enough."""
FRAME = ["frame_id", "index", "agent", "objects", "added_nodes", "added_edges"]
ROOMS_KEPT = 8
K = TypeVar("K")
V = TypeVar("V")


class Place(NamedTuple):
    """Where a row is: in which split of its table, and in which place there, from 0."""

    split: str
    row: int


class RoomKey(NamedTuple):
    """One arrangement of one room."""

    scene: str
    configuration: int

    @property
    def slug(self) -> str:
        """As part of an address."""
        return slug(f"{self.scene}-c{self.configuration}")


@dataclass(frozen=True, eq=False)
class Arrangement:
    """One arrangement of a room, and what its walk has found.

    Attributes
    ----------
    key : RoomKey
    room_type, split : str
    objects : tuple of ObjectMetadata
        All of them, as they are.
    nodes : tuple of str
        Ids of those that the walk has found.
    edges : tuple of Edge
        Of the graph after the walk.
    cells : tuple of (int, int)
        Where the agent can stand.
    plan_labels : (nx, ny) int16
        What is highest in each voxel column, -1 where nothing was seen.
    labels : tuple of str
        What they mean.
    corner : (int, int)
        The voxel column of entry (0, 0).
    voxel_m : float
    """

    key: RoomKey
    room_type: str
    split: str
    objects: tuple[ObjectMetadata, ...]
    nodes: tuple[str, ...]
    edges: tuple[Edge, ...]
    cells: tuple[tuple[int, int], ...]
    plan_labels: I16
    labels: tuple[str, ...]
    corner: tuple[int, int]
    voxel_m: float

    @property
    def plan(self) -> SemanticPlan:
        """The stored map, as far as a picture of it needs."""
        seen = self.plan_labels >= 0
        return SemanticPlan(self.plan_labels, seen, seen, self.corner, self.voxel_m, 0.0, self.labels)


class BrowsedDataset:
    """A finished dataset to look about in.

    Parameters
    ----------
    root : Path
        Its folder.

    Raises
    ------
    DatasetError
        If there is no finished dataset, or, once it is looked up, a question or room is there twice.
    DamagedShardError
        If a file cannot be read.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.manifest: Manifest = load_manifest(root)
        self._readers: dict[tuple[str, str], SplitReader] = {}
        self._room = lru_cache(maxsize=ROOMS_KEPT)(self._read_room)

    @cached_property
    def index(self) -> pa.Table:
        """All questions without their pictures, split by split; the columns `INDEX`."""
        splits = question_splits(self.root, self.manifest)
        return pa.concat_tables([self._reader("questions", split).columns(INDEX) for split in splits]).combine_chunks()

    @cached_property
    def frame(self) -> pd.DataFrame:
        """The same for pandas."""
        table: pd.DataFrame = self.index.to_pandas()
        return table

    @cached_property
    def rows(self) -> dict[str, int]:
        """By slug, which row of the index a question is."""
        names = self.index["question_id"].to_pylist()
        return self._once("question", ((slug(name), row) for row, name in enumerate(names)))

    @cached_property
    def groups(self) -> dict[str, list[int]]:
        """By name of a group, the rows of its questions."""
        found: dict[str, list[int]] = {}
        for row, name in enumerate(self.index["group"].to_pylist()):
            found.setdefault(name, []).append(row)
        return found

    @cached_property
    def room_places(self) -> dict[RoomKey, Place]:
        """Where the arrangements of all rooms are."""
        return self._once(
            "room",
            (
                (RoomKey(scene, configuration), Place(split, row))
                for split in self.manifest.splits("scenes")
                for row, (scene, configuration) in enumerate(self._keys("scenes", split))
            ),
        )

    @cached_property
    def walk_places(self) -> dict[RoomKey, list[Place]]:
        """Where the frames of the walk through each arrangement are, in order."""
        found: dict[RoomKey, list[Place]] = {}
        for split in self.manifest.splits("frames"):
            for row, (scene, configuration) in enumerate(self._keys("frames", split)):
                found.setdefault(RoomKey(scene, configuration), []).append(Place(split, row))
        return found

    def brief(self, row: int) -> dict[str, Any]:
        """A row of the index."""
        return dict(self.index.slice(row, 1).to_pylist()[0])

    def question(self, row: int) -> dict[str, Any]:
        """All of a question but its pictures."""
        place, spec = self._place(row), table_spec("questions")
        names = [name for name in spec.schema.names if name not in spec.image_columns]
        return self._reader("questions", place.split).rows([place.row], names)[0]

    def question_pictures(self, row: int, names: Sequence[str]) -> list[bytes]:
        """Encoded pictures of a question, such as of the column `start_rgb`."""
        place = self._place(row)
        return [bytes(image) for image in self._reader("questions", place.split).images(place.row, names)]

    def room(self, key: RoomKey) -> Arrangement | None:
        """An arrangement of a room; None if the dataset has not got it."""
        return self._room(key) if key in self.room_places else None

    def scene_json(self, key: RoomKey) -> str:
        """The room as the simulator reads it."""
        place = self.room_places[key]
        return str(self._reader("scenes", place.split).rows([place.row], ["scene_json"])[0]["scene_json"])

    def walk(self, key: RoomKey) -> list[dict[str, Any]]:
        """The frames of the walk through an arrangement without their pictures."""
        places = self.walk_places.get(key, [])
        if not places:
            return []
        return self._reader("frames", places[0].split).rows([place.row for place in places], FRAME)

    def walk_pictures(self, place: Place, names: Sequence[str]) -> list[bytes]:
        """Encoded pictures of a frame of a walk."""
        return [bytes(image) for image in self._reader("frames", place.split).images(place.row, names)]

    def _read_room(self, key: RoomKey) -> Arrangement:
        place = self.room_places[key]
        reader = self._reader("scenes", place.split)
        (row,) = reader.rows([place.row], ROOM)
        (map_2d,) = reader.images(place.row, ["map_2d"])
        stored = row["semantic_map"]
        labels = plan_labels(StoredImage(bytes(map_2d)))
        return Arrangement(
            key,
            row["room_type"],
            row["split"],
            tuple(ObjectMetadata(**record | {"box": tuple(record["box"])}) for record in row["objects"]),
            tuple(row["graph_nodes"]),
            tuple(Edge(**edge) for edge in row["graph_edges"]),
            tuple((cell["i"], cell["j"]) for cell in row["navigation_cells"]),
            np.where(labels < len(stored["labels"]), labels, UNKNOWN).astype(np.int16),
            tuple(stored["labels"]),
            (stored["corner"][0], stored["corner"][1]),
            stored["voxel_m"],
        )

    def _once(self, what: str, found: Iterable[tuple[K, V]]) -> dict[K, V]:
        """By name; what has the name of another is refused, as it could not be shown."""
        by_name: dict[K, V] = {}
        for name, value in found:
            if by_name.setdefault(name, value) is not value:
                shown = name.slug if isinstance(name, RoomKey) else name
                raise DatasetError(f"{self.root}: {what} {shown} is there twice; see remqa-data verify")
        return by_name

    def _place(self, row: int) -> Place:
        for split in self.manifest.splits("questions"):
            count = len(self._reader("questions", split))
            if row < count:
                return Place(split, row)
            row -= count
        raise IndexError(row)

    def _keys(self, table: str, split: str) -> list[tuple[str, int]]:
        columns = self._reader(table, split).columns(["scene", "configuration"])
        return list(zip(columns["scene"].to_pylist(), columns["configuration"].to_pylist(), strict=True))

    def _reader(self, table: str, split: str) -> SplitReader:
        if (table, split) not in self._readers:
            self._readers[table, split] = SplitReader(self.root, table, split)
        return self._readers[table, split]


def slug(name: str) -> str:
    """A name as part of an address and of a file's name; what no such name can be gets another.

    >>> slug("FloorPlan1-COUNTING-00-c2")
    'FloorPlan1-COUNTING-00-c2'
    >>> slug("../etc/passwd").startswith("x-")
    True
    """
    if re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,99}", name):
        return name
    return "x-" + hashlib.sha256(name.encode()).hexdigest()[:20]
