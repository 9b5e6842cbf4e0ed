"""The walk through an arrangement: what each frame adds to the graph and to the map."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np

from remqa_data.browse.dataset import BrowsedDataset, Place, RoomKey
from remqa_data.browse.pictures import plan_picture
from remqa_data.browse.room_map import RoomMap, Standing
from remqa_data.errors import RemqaError
from remqa_data.mapping.semantic_map import VOXEL_M, VoxelMap
from remqa_data.scene import Scene
from remqa_data.sim.metadata import AgentState
from remqa_data.tables.images import decode_depth, decode_instances

WALKS_KEPT = 4


@dataclass(frozen=True)
class WalkedFrame:
    """A frame of a walk.

    Attributes
    ----------
    id : str
    standing : Standing
        Where it was taken, on the map.
    seen : int
        Objects that it shows.
    nodes : tuple of str
        Ids of the objects that it adds to the graph.
    edges : tuple of (str, str, str)
        What else it adds: source, relation, target.
    all_nodes, all_edges : int
        What the graph has after it.
    """

    id: str
    standing: Standing
    seen: int
    nodes: tuple[str, ...]
    edges: tuple[tuple[str, str, str], ...]
    all_nodes: int
    all_edges: int


class Walks:
    """The walks of a dataset; what was worked out is kept for a few of them."""

    def __init__(self, dataset: BrowsedDataset) -> None:
        self._dataset = dataset
        self.frames = lru_cache(maxsize=WALKS_KEPT)(self._frames)
        self._growing = lru_cache(maxsize=WALKS_KEPT)(partial(_GrowingMap, dataset))

    def map_after(self, key: RoomKey, number: int) -> bytes | None:
        """The map after a frame of a walk as a PNG, made again from the stored depth.

        None if there is no such frame, or the stored room is of another version.
        """
        try:
            return self._growing(key).after(number)
        except RemqaError:
            return None

    def _frames(self, key: RoomKey, frame: RoomMap) -> tuple[WalkedFrame, ...]:
        found: list[WalkedFrame] = []
        nodes = edges = 0
        for row in self._dataset.walk(key):
            nodes, edges = nodes + len(row["added_nodes"]), edges + len(row["added_edges"])
            added = tuple((edge["source"], edge["relation"], edge["target"]) for edge in row["added_edges"])
            standing = frame.standing(row["agent"])
            new = tuple(row["added_nodes"])
            found.append(WalkedFrame(row["frame_id"], standing, len(row["objects"]), new, added, nodes, edges))
        return tuple(found)


class _GrowingMap:
    """The map of one walk, as far as it was asked for."""

    def __init__(self, dataset: BrowsedDataset, key: RoomKey) -> None:
        self._dataset = dataset
        self._places = dataset.walk_places.get(key, [])
        self._rows = dataset.walk(key)
        self._pictures: list[bytes] = []
        room = dataset.room(key)
        voxel_m = VOXEL_M if room is None else room.voxel_m
        self._voxels = VoxelMap.of_scene(Scene.from_json(dataset.scene_json(key), key.scene), voxel_m)

    def after(self, number: int) -> bytes | None:
        if number >= len(self._places):
            return None
        for step in range(len(self._pictures), number + 1):
            self._look(self._rows[step], self._places[step])
            self._pictures.append(plan_picture(self._voxels.plan()))
        return self._pictures[number]

    def _look(self, row: dict[str, Any], place: Place) -> None:
        depth, instances = self._dataset.walk_pictures(place, ["depth", "instances"])
        x, y, z = row["agent"]["position"]
        agent = AgentState((x, y, z), row["agent"]["yaw_deg"], row["agent"]["horizon_deg"])
        image, numbers = decode_depth(depth), decode_instances(instances).astype(np.int32) - 1
        types = [seen["type"] for seen in row["objects"]]
        self._voxels.add(image, numbers, types, agent.pose().camera_above(z, image.shape[0]))
