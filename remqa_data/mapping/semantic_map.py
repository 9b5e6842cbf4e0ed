"""What the agent remembers of a room: 5 cm voxels with an object type each, and a plan of the room drawn from them.

`VoxelMap` grows frame by frame from depth and object images. `VoxelMap.plan` reduces it to a `SemanticPlan`: what lies
where as seen from above, what blocks the agent, and what has been seen at all. `SemanticPlan.navigation_grid` gives the
cells on which the agent can stand by that knowledge, as the same `ReachableGrid` that the simulator gives.

Voxels are numbered from the world's origin in x and y and from the floor in z: voxel (i, j, k) begins at
(i * 0.05, j * 0.05) metres, and layer 0 lies on the floor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import networkx as nx
import numpy as np

from remqa_data.errors import NoPathError, VoxelError
from remqa_data.geometry.types import F32, F64, I16, I32, Flags, Rect
from remqa_data.mapping.voxel_votes import elect, vote
from remqa_data.scene import Scene
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.render.camera import AnyCamera

VOXEL_M = 0.05
STRUCTURE = "structure"
"""Name of label 0: walls, ceiling and built-in furniture, which are not objects."""
UNKNOWN = -1
"""Label of voxels in which nothing has been seen: air, or never looked at."""
MARGIN_M = 0.25
"""What is farther than this outside the inner faces of the outer walls (the view from a window) is not remembered."""
FLOOR_SLACK_M = 0.002
"""Layer 0 begins this far below the floor, so that rounding never splits the floor between two layers; depth in whole
millimetres, as stored frames have it, is off by less."""


@dataclass(frozen=True, eq=False)
class SparseVoxels:
    """The voxels of a map in which something was seen, for storage.

    Attributes
    ----------
    coordinates : (n, 3) int16, (i, j, k) of each voxel, sorted.
    labels : (n,) int16, index into `names`.
    names : tuple of str, "structure" and then the types that were seen, sorted.
    """

    coordinates: I16
    labels: I16
    names: tuple[str, ...]


class VoxelMap:
    """Voxel memory of a room.

    Parameters
    ----------
    bounds : Rect
        Inner faces of the outer walls: x0, y0, x1, y1 in metres.
    floor_z, height : float
        Height of the floor, and from there to the ceiling, in metres.
    voxel_m : float
        Side of a voxel.

    Notes
    -----
    Every pixel votes for its type in the voxel that it shows, and a voxel's label is what most pixels voted for; of
    equal votes an object wins against the structure, then the name that comes first in the alphabet. So the labels do
    not depend on the order of the frames.

    Nothing is forgotten: after a door has been opened, its voxels are remembered both where it was and where it is.
    """

    def __init__(self, bounds: Rect, floor_z: float, height: float, voxel_m: float = VOXEL_M) -> None:
        self.bounds, self.floor_z, self.height, self.voxel_m = bounds, floor_z, height, voxel_m
        low = [math.floor((v - MARGIN_M) / voxel_m) for v in bounds[:2]]
        high = [math.ceil((v + MARGIN_M) / voxel_m) for v in bounds[2:]]
        self.corner = (low[0], low[1])
        self.shape = (high[0] - low[0], high[1] - low[1], math.ceil(height / voxel_m) + 1)
        self._type_ids: dict[str, int] = {STRUCTURE: 0}
        self._first = np.full(math.prod(self.shape), -1, dtype=np.int32)
        self._entries = np.empty((1 << 16, 3), dtype=np.int32)
        self._used = 0

    @classmethod
    def of_scene(cls, scene: Scene, voxel_m: float = VOXEL_M) -> VoxelMap:
        """An empty map of a scene."""
        return cls(scene.bounds, scene.floor_z, scene.height, voxel_m)

    def add(self, depth: F32, objects: I32, types: Sequence[str], camera: AnyCamera) -> None:
        """Remember a frame.

        Parameters
        ----------
        depth : (h, w) float32
            Metres along the camera's forward axis; 0 where nothing is seen.
        objects : (h, w) int32
            Object index of each pixel, -1 for the structure.
        types : sequence of str
            Type of each object, in the order that the indices mean.
        camera : AnyCamera
            From where the frame was taken; its width and height are those of the images.

        Raises
        ------
        VoxelError
            If the images and the camera differ in size, or an index has no type.
        """
        view = camera.view()
        if depth.shape != (view.height, view.width) or objects.shape != depth.shape:
            msg = f"depth is {depth.shape}, objects {objects.shape}, but the camera's image {(view.height, view.width)}"
            raise VoxelError(msg)
        if objects.size and not -1 <= objects.min() <= objects.max() < len(types):
            msg = f"object indices run from {objects.min()} to {objects.max()}, but there are {len(types)} types"
            raise VoxelError(msg)
        ids = [self._type_ids.setdefault(name, len(self._type_ids)) for name in types]
        self._reserve(depth.size)
        self._used = vote(
            np.ascontiguousarray(depth, dtype=np.float32),
            np.ascontiguousarray(objects, dtype=np.int32),
            np.array([*ids, 0], dtype=np.int32),  # the last one answers for -1
            view,
            np.array([*self.corner, self.floor_z / self.voxel_m - FLOOR_SLACK_M / self.voxel_m]),
            1.0 / self.voxel_m,
            np.array(self.shape, dtype=np.int64),
            self._first,
            self._entries,
            self._used,
        )

    def labels(self) -> tuple[I16, tuple[str, ...]]:
        """The map as it is now.

        Returns
        -------
        labels : (nx, ny, nz) int16
            Index of each voxel's name, -1 where nothing was seen; entry (0, 0, 0) is voxel (*corner, 0).
        names : tuple of str
            "structure", then the types that some voxel is labelled with, sorted.
        """
        order = [STRUCTURE, *sorted(name for name in self._type_ids if name != STRUCTURE)]
        rank = np.array([order.index(name) for name in self._type_ids], dtype=np.int16)
        elected = np.asarray(elect(self._first, self._entries, rank))
        is_kept = np.bincount(elected[elected != UNKNOWN], minlength=len(order)) > 0
        is_kept[0] = True
        # The last entry answers for UNKNOWN, -1.
        renumbered = np.array([*(np.cumsum(is_kept) - 1), UNKNOWN], dtype=np.int16)
        names = tuple(name for name, kept in zip(order, is_kept, strict=True) if kept)
        return renumbered[elected].reshape(self.shape), names

    def to_sparse(self) -> SparseVoxels:
        """The labels for storage."""
        labels, names = self.labels()
        is_seen = labels != UNKNOWN
        coordinates = np.argwhere(is_seen) + np.array([*self.corner, 0])
        return SparseVoxels(coordinates.astype(np.int16), labels[is_seen], names)

    @classmethod
    def from_sparse(
        cls, sparse: SparseVoxels, bounds: Rect, floor_z: float, height: float, voxel_m: float = VOXEL_M
    ) -> VoxelMap:
        """The map of what `to_sparse` gave, with one vote in each voxel.

        Raises
        ------
        VoxelError
            If a voxel lies outside the room, occurs twice, or has a label without a name.
        """
        voxels = cls(bounds, floor_z, height, voxel_m)
        count = len(sparse.coordinates)
        if sparse.coordinates.shape != (count, 3) or sparse.labels.shape != (count,):
            raise VoxelError(f"{sparse.coordinates.shape} coordinates with {sparse.labels.shape} labels")
        places = sparse.coordinates.astype(np.int64) - np.array([*voxels.corner, 0])
        outside = np.flatnonzero(np.any((places < 0) | (places >= voxels.shape), axis=1))
        if len(outside):
            msg = f"voxel {outside[0]} at {sparse.coordinates[outside[0]].tolist()} is outside the room {bounds}"
            raise VoxelError(msg)
        nameless = np.flatnonzero((sparse.labels < 0) | (sparse.labels >= len(sparse.names)))
        if len(nameless):
            msg = f"voxel {nameless[0]} has label {sparse.labels[nameless[0]]}, but there are {len(sparse.names)} names"
            raise VoxelError(msg)
        flat = np.ravel_multi_index((places[:, 0], places[:, 1], places[:, 2]), voxels.shape)
        if len(np.unique(flat)) != count:
            raise VoxelError("a voxel occurs twice")
        ids = [voxels._type_ids.setdefault(name, len(voxels._type_ids)) for name in sparse.names]
        voxels._reserve(count)
        voxels._first[flat] = np.arange(count)
        voxels._entries[:count, 0] = np.array(ids, dtype=np.int32)[sparse.labels]
        voxels._entries[:count, 1:] = 1, -1
        voxels._used = count
        return voxels

    def plan(self, height_m: float = AGENT.height_m) -> SemanticPlan:
        """The room from above: in each column what is highest below a height (metres above floor), and what blocks."""
        labels, names = self.labels()
        low = max(round(AGENT.step_over_m / self.voxel_m), 1)  # the floor's own voxels block nobody
        high = round(AGENT.height_m / self.voxel_m)
        below = labels[:, :, : round(height_m / self.voxel_m)]
        highest = below.shape[2] - 1 - np.argmax(below[:, :, ::-1] != UNKNOWN, axis=2)
        top = np.take_along_axis(below, highest[:, :, None], axis=2)[:, :, 0]
        is_ground_seen = np.any(labels[:, :, :low] != UNKNOWN, axis=2)
        is_occupied = np.any(labels[:, :, low:high] != UNKNOWN, axis=2)
        return SemanticPlan(
            top, is_occupied, is_ground_seen | is_occupied, self.corner, self.voxel_m, self.floor_z, names
        )

    def _reserve(self, count: int) -> None:
        """Make room for some more entries."""
        if self._used + count > len(self._entries):
            grown = np.empty((2 * (self._used + count), 3), dtype=np.int32)
            grown[: self._used] = self._entries[: self._used]
            self._entries = grown


@dataclass(frozen=True, eq=False)
class SemanticPlan:
    """A room from above, as far as it is known. Entry (a, b) of each array is the column `corner` + (a, b).

    Attributes
    ----------
    labels : (nx, ny) int16, index into `names` of what is highest in each column, -1 where nothing was seen.
    occupied : (nx, ny) bool, whether something is between ankle and head height (0.05 to 1.8 m) there.
    known : (nx, ny) bool, whether the ground, or something that blocks, was seen there.
    corner : (int, int), column of entry (0, 0); column (i, j) begins at (i, j) * voxel_m metres in the room.
    """

    labels: I16
    occupied: Flags
    known: Flags
    corner: tuple[int, int]
    voxel_m: float
    floor_z: float
    names: tuple[str, ...]

    def navigation_grid(self, near: Cell | None = None) -> ReachableGrid:
        """Where the agent can stand by what it knows; unknown ground is not free.

        Parameters
        ----------
        near : Cell, optional
            The part of the floor that contains this cell is the grid, or that contains the free cell nearest to it; by
            default the largest part.
        """
        low = np.array(self.corner) * self.voxel_m
        high = low + np.array(self.labels.shape) * self.voxel_m
        first, last = np.ceil(low / AGENT.step_m).astype(int), np.floor(high / AGENT.step_m).astype(int)
        across, along = np.meshgrid(np.arange(first[0], last[0] + 1), np.arange(first[1], last[1] + 1), indexing="ij")
        free = self._is_clear(np.stack([across, along], axis=-1) * AGENT.step_m)
        graph: nx.Graph[Cell] = nx.Graph()
        graph.add_nodes_from((int(i), int(j)) for i, j in np.argwhere(free) + first)
        for step in ((1, 0), (0, 1)):
            pairs = free[: free.shape[0] - step[0], : free.shape[1] - step[1]] & free[step[0] :, step[1] :]
            starts = np.argwhere(pairs) + first
            between = (starts[:, None] + np.array([0.25, 0.5, 0.75])[:, None] * step) * AGENT.step_m
            for i, j in starts[np.all(self._is_clear(between), axis=1)]:
                graph.add_edge((int(i), int(j)), (int(i) + step[0], int(j) + step[1]))
        parts = sorted((sorted(part) for part in nx.connected_components(graph)), key=lambda part: (-len(part), part))
        if not parts:
            return ReachableGrid((), nx.Graph(), (), self.floor_z)
        main = parts[0]
        if near is not None:
            main = min(parts, key=lambda part: min(math.dist(cell, near) for cell in part))
        sizes = tuple(len(part) for part in parts if part is not main)
        return ReachableGrid(tuple(main), nx.Graph(graph.subgraph(main)), sizes, self.floor_z)

    def _is_clear(self, points: F64) -> Flags:
        """(...) whether the agent could stand at each of (..., 2) points, metres."""
        reach = math.ceil(AGENT.radius_m / self.voxel_m)
        blocked = np.pad(self.occupied | ~self.known, reach + 1, constant_values=True)
        shifted = np.asarray(points, dtype=np.float64) / self.voxel_m - self.corner
        home = np.floor(shifted).astype(np.int64)
        clear = np.ones(home.shape[:-1], dtype=np.bool_)
        limit = (AGENT.radius_m / self.voxel_m) ** 2
        for a in range(-reach - 1, reach + 1):
            for b in range(-reach - 1, reach + 1):
                column = np.clip(home + np.array([a, b]), -reach - 1, np.array(self.labels.shape) + reach)
                # An obstacle is somewhere in its column: its middle is the best guess.
                distance = np.sum((column + 0.5 - shifted) ** 2, axis=-1)
                is_blocked = blocked[column[..., 0] + reach + 1, column[..., 1] + reach + 1]
                clear &= ~(is_blocked & (distance <= limit))
        return clear


def shortest_path(grid: ReachableGrid, start: Cell, goal: Cell) -> list[Cell]:
    """Cells of a shortest way from one cell to another, both included.

    Raises
    ------
    NoPathError
        If one of them is not in the grid, whose cells are all connected.
    """
    for cell in (start, goal):
        if cell not in grid.graph:
            raise NoPathError(f"no way from {start} to {goal}: {cell} is not a reachable cell of the grid")
    return list(nx.shortest_path(grid.graph, start, goal))
