"""What the walk through a configuration has left in an agent's memory: the scene graph and the semantic map.

As in the paper, an agent has walked through the room before it is asked anything: through the same arrangement of its
things, with everything closed and in its place. It remembers what the frames of that walk show, labelled by the simulator:
the graph of the objects that were seen, and the voxels. What the simulator knows beside that (all objects, the cells on
which one can stand, the questions' targets, goals and answers) is in columns that are not read here.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import DatasetError
from remqa_data.geometry.types import F32, F64, I16, U8, Flags
from remqa_data.mapping.semantic_map import FLOOR_SLACK_M, MARGIN_M, SemanticPlan, VoxelMap
from remqa_data.scene_graph.graph import GraphUpdate, SceneGraph, without_frame
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.render.camera import Camera
from remqa_data.storage.shards import read_table
from remqa_data.tables.images import decode_depth, decode_rgb
from remqa_data.tables.map_columns import sparse_voxels
from remqa_data.tables.rows import SemanticMap, configuration_name
from remqa_data.tables.schema import table_spec

SCENE_COLUMNS = ("scene", "configuration", "semantic_map", "embodiment")
FRAME_COLUMNS = ("scene", "configuration", "index", "objects", "added_nodes", "added_edges")
"""All that is read of a dataset for an agent's memory."""

T = TypeVar("T")


class Look(NamedTuple):
    """What an agent sees from somewhere.

    Attributes
    ----------
    rgb : (h, w, 3) uint8
    depth : (h, w) float32
        Metres along the camera's forward axis, 0 where nothing is.
    camera : Camera
    """

    rgb: U8
    depth: F32
    camera: Camera


@dataclass(frozen=True, eq=False)
class WalkMemory:
    """What an agent remembers of a room.

    Attributes
    ----------
    graph : SceneGraph
        The objects that the walk has seen, and their relations.
    labels : (nx, ny, nz) int16
        The semantic map in 3D: for each voxel an index into `plan.names`, -1 where nothing was seen. Entry (0, 0, 0) is voxel
        (*plan.corner, 0), which begins at that many voxels in x and y, on the floor.
    plan : SemanticPlan
        The semantic map in 2D, and where the agent can stand by it.
    body : Embodiment
        The agent's own.
    looks : callable, optional
        Gives what the walk has seen, frame by frame, for who makes a map of it himself.
    """

    graph: SceneGraph
    labels: I16
    plan: SemanticPlan
    body: Embodiment
    looks: Callable[[], Iterator[Look]] | None = None

    def corner_of(self, voxels: npt.ArrayLike) -> F64:
        """(..., 3) where voxels, (..., 3) indices of `labels`, begin in the room, metres."""
        return np.asarray(voxels) * self.plan.voxel_m + self._origin

    def at(self, flags: Flags, points: F64) -> Flags:
        """(...) what (nx, ny, nz) flags of voxels say at (..., 3) points of the room, metres; False outside the map."""
        voxels = np.floor((points - self._origin) / self.plan.voxel_m).astype(np.int64)
        is_inside = np.all((voxels >= 0) & (voxels < flags.shape), axis=-1)
        i, j, k = np.moveaxis(np.where(is_inside[..., None], voxels, 0), -1, 0)
        return np.asarray(is_inside & flags[i, j, k])

    @property
    def _origin(self) -> F64:
        voxel_m = self.plan.voxel_m
        return np.array([*(v * voxel_m for v in self.plan.corner), self.plan.floor_z - FLOOR_SLACK_M])

    @classmethod
    def of_walk(
        cls, graph: SceneGraph, stored: SemanticMap, body: Embodiment, where: str = "semantic map"
    ) -> WalkMemory:
        """The memory of a graph and a stored map; `where` is for error messages.

        Raises
        ------
        DatasetError
            If the walk has seen nothing.
        """
        if not len(stored.voxels):
            raise DatasetError(f"{where}: the walk has seen nothing")
        voxel_m, (_, _, floor_z) = stored.voxel_m, stored.origin
        low, high = stored.voxels[:, :3].min(axis=0), stored.voxels[:, :3].max(axis=0) + 1
        x0, y0 = (float(edge) * voxel_m + MARGIN_M for edge in low[:2])
        x1, y1 = (float(edge) * voxel_m - MARGIN_M for edge in high[:2])
        voxels = VoxelMap.from_sparse(
            sparse_voxels(stored), (x0, y0, x1, y1), floor_z, float(high[2]) * voxel_m, voxel_m
        )
        return cls(graph, voxels.labels()[0], voxels.plan(), body)


_IMAGES = ("rgb", "depth")
_DECODERS: tuple[Callable[[memoryview], Any], ...] = (decode_rgb, decode_depth)


class WalkMemories:
    """The memories of all walks of a split, made when they are asked for.

    Parameters
    ----------
    root : path
        Folder of a finished dataset.
    split : str
        "train" or "test".

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or has no such split.
    """

    def __init__(self, root: str | os.PathLike[str], split: str) -> None:
        self.root, self.split = Path(root), split
        self._scenes = read_table(root, "scenes", split, SCENE_COLUMNS)
        self._frames = read_table(root, "frames", split, FRAME_COLUMNS)

    def memory(self, scene: str, configuration: int) -> WalkMemory:
        """The memory of the walk through one configuration of a room.

        Raises
        ------
        DatasetError
            If the dataset has no such walk.
        """
        where = f"{self.root}: {configuration_name(scene, configuration)}"
        rows = _records("scenes", _of(self._scenes, scene, configuration), SCENE_COLUMNS)
        frames = _records("frames", _of(self._frames, scene, configuration), FRAME_COLUMNS)
        if not rows or not frames:
            raise DatasetError(f"{where}: there is no walk through it")
        row = rows[0]
        body = Embodiment.of_dataset(**vars(row["embodiment"]))
        memory = WalkMemory.of_walk(graph_of_walk(frames), row["semantic_map"], body, where)
        return replace(memory, looks=partial(self._looks, scene, configuration, body))

    def _looks(self, scene: str, configuration: int, body: Embodiment) -> Iterator[Look]:
        """The frames of a walk: what was seen, and from where."""
        reader = SplitReader(self.root, "frames", self.split)
        columns = reader.columns(["scene", "configuration", "agent"])
        is_wanted = pc.and_(pc.equal(columns["scene"], scene), pc.equal(columns["configuration"], configuration))
        for row in np.flatnonzero(is_wanted.to_numpy(zero_copy_only=False)).tolist():
            agent = columns["agent"][row].as_py()
            rgb, depth = (decode(image) for decode, image in zip(_DECODERS, reader.images(row, _IMAGES), strict=True))
            x, y, z = agent["position"]
            eye = (x, y, z + body.camera_height_m)
            size = depth.shape[0]
            yield Look(rgb, depth, Camera(eye, agent["yaw_deg"], agent["horizon_deg"], body.fov_deg, size, size))


def graph_of_walk(frames: Sequence[Mapping[str, Any]]) -> SceneGraph:
    """The scene graph that grew along the frames of a walk, which have the fields of `FrameRow` that are named above."""
    updates = []
    for frame in sorted(frames, key=lambda frame: int(frame["index"])):
        seen = {record.id: record for record in frame["objects"]}
        nodes = tuple(without_frame(seen[name]) for name in frame["added_nodes"])
        updates.append(GraphUpdate(nodes, tuple(frame["added_edges"])))
    return SceneGraph.replay(updates)


def _of(table: pa.Table, scene: str, configuration: int) -> pa.Table:
    is_wanted = pc.and_(pc.equal(table["scene"], scene), pc.equal(table["configuration"], configuration))
    return table.filter(is_wanted)


def _records(name: str, table: pa.Table, columns: Sequence[str]) -> list[dict[str, Any]]:
    """Some columns of some rows, each value of the type that the table's row class has."""
    if not table.num_rows:
        return []
    members = {member.name: member for member in table_spec(name).record.members}
    arrays = table.combine_chunks()
    read = [members[column].node.from_arrow(pa.concat_arrays(arrays[column].chunks)) for column in columns]
    return [dict(zip(columns, values, strict=True)) for values in zip(*read, strict=True)]
