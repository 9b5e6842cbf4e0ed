"""A memory of a room that an agent makes itself: from colour, depth and poses, with the detector's view of them.

It is a `WalkMemory` like that which the simulator's labels give: voxels with labels, a plan, and a graph of objects, so whoever
plans on the one plans on the other. Geometry is as exact as depth is; labels and objects are what the detector believes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import torch

from remqa_data.agents.knowledge.detected import Things, seen_in
from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.memory import Look, WalkMemory
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.agents.networks.threads import one_thread
from remqa_data.geometry.types import F64, I32, Rect
from remqa_data.mapping.semantic_map import MARGIN_M, SemanticPlan, VoxelMap
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.navigation.grid import Cell

LEAST_VOTES = 0.5
"""An object that got fewer votes for its type is not believed in."""
GROWN_M = 1.0
"""Where something is seen outside the map, that grows by so much more."""
BLIND_M = 0.5
"""Around its feet an agent does not see the floor."""
SPARSE_PX = 8
"""Of so many pixels across and down one is enough to know where the walls are."""
CEILING_M = 2.6
"""Above the floor; what is higher is not mapped."""


@dataclass(frozen=True, eq=False)
class Labelled:
    """A look, and what the detector says that its pixels show."""

    look: Look
    labels: I32


class RoomMap:
    """What is known of a room after some looks.

    Parameters
    ----------
    detector : Detector
        Trained.
    types : sequence of str
        What it knows.
    body : Embodiment
        The agent's own.
    floor_z : float
        Height of the floor, metres.
    """

    def __init__(self, detector: Detector, types: tuple[str, ...], body: Embodiment, floor_z: float) -> None:
        self._detector, self._body, self._floor_z = detector, body, floor_z
        self._types = types
        self.things = Things(types)
        self._looks: list[Labelled] = []
        self._voxels: VoxelMap | None = None
        self._votes: dict[ObjectMetadata, float] = {}

    def add(self, look: Look) -> None:
        """Look at something, and remember it."""
        with one_thread():
            seen = self._detector.vote(torch.from_numpy(look.rgb).permute(2, 0, 1)[None])
            (peaks,), (cells,) = seen.peaks, seen.cells
        self.things.add(seen_in(peaks.boxes, peaks.votes, cells, STRIDE, look.depth, look.camera))
        labels = np.kron(cells - 1, np.ones((STRIDE, STRIDE), dtype=np.int64))
        height, width = look.depth.shape
        self._remember(Labelled(look, labels[:height, :width].astype(np.int32)))

    def add_shape(self, look: Look) -> None:
        """Remember where something is, and not what it is: that takes a tenth of the time."""
        self._remember(Labelled(look, np.full(look.depth.shape, -1, dtype=np.int32)))

    def memory(self, been: Iterable[Cell] = ()) -> WalkMemory:
        """What is remembered now.

        Parameters
        ----------
        been : iterable of Cell
            Where the agent has stood: that ground is free, and so is what is at its feet, which it does not see.
        """
        assert self._voxels is not None, "something was looked at"
        plan = self._voxels.plan()
        known, occupied = plan.known.copy(), plan.occupied.copy()
        for cell in been:
            known[_columns_around(plan, self._body, cell, BLIND_M)] = True
            occupied[_columns_around(plan, self._body, cell, self._body.radius_m)] = False
        self._votes = self.things.records(LEAST_VOTES)
        return WalkMemory(
            SceneGraph.from_objects(self._votes),
            self._voxels.labels()[0],
            replace(plan, known=known, occupied=occupied),
            self._body,
        )

    def votes(self, instance: Instance) -> float:
        """How many votes an object of the last memory had got for its type; 0 for what only the voxels have."""
        return max((votes for record, votes in self._votes.items() if record.box == instance.box), default=0.0)

    def _remember(self, new_one: Labelled) -> None:
        """Put a look into the map; all of them again where it lies outside."""
        self._looks.append(new_one)
        depth, camera = new_one.look.depth, new_one.look.camera
        points = camera.unproject(depth)[::SPARSE_PX, ::SPARSE_PX][depth[::SPARSE_PX, ::SPARSE_PX] > 0]
        wanted = _bounds_with(points, None if self._voxels is None else self._voxels.bounds)
        new = [new_one]
        if self._voxels is None or wanted != self._voxels.bounds:
            self._voxels, new = VoxelMap(wanted, self._floor_z, CEILING_M), self._looks
        for one in new:
            self._voxels.add(one.look.depth, one.labels, self._types, one.look.camera)


def _bounds_with(points: F64, bounds: Rect | None) -> Rect:
    """Bounds that have some points in them; the same where they have them already."""
    if not len(points):
        return bounds or (-GROWN_M, -GROWN_M, GROWN_M, GROWN_M)
    (x0, y0), (x1, y1) = points[:, :2].min(axis=0).tolist(), points[:, :2].max(axis=0).tolist()
    if bounds is None:
        return x0 - GROWN_M, y0 - GROWN_M, x1 + GROWN_M, y1 + GROWN_M
    low = [b if v >= b - MARGIN_M else v - GROWN_M for v, b in zip((x0, y0), bounds[:2], strict=True)]
    high = [b if v <= b + MARGIN_M else v + GROWN_M for v, b in zip((x1, y1), bounds[2:], strict=True)]
    return low[0], low[1], high[0], high[1]


def _columns_around(plan: SemanticPlan, body: Embodiment, cell: Cell, radius_m: float) -> tuple[slice, slice]:
    """The columns of a plan that are so near to a cell, in a square."""
    spans = []
    for middle, first, count in zip(body.centre_of(cell), plan.corner, plan.labels.shape, strict=True):
        low, high = (round((middle + way) / plan.voxel_m) - first for way in (-radius_m, radius_m))
        spans.append(slice(min(max(low, 0), count), min(max(high, 0), count)))
    return spans[0], spans[1]
