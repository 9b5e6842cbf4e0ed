"""Where the inside of what is opened should show, by what the agent remembers, and where it does show."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.outlook import OPENS_FORWARD, SLIDE_SHARE, SLIDES_OUT, Outlook, hiding_voxels, in_view
from remqa_data.agents.knowledge.sight import seen_within
from remqa_data.geometry.types import F32, F64, Flags
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.viewpoints import facing_poses
from remqa_data.sim.render.camera import Camera

WALL_M = 0.03
"""So far within the box the inside begins; a door is no thicker."""
POINTS = 5
"""Along each side of the inside as many points are looked for."""
NEAREST_M = 0.6
"""From nearer than this things show no larger, as far as poses are compared."""


@dataclass(frozen=True, eq=False)
class Inside:
    """The space in which things are that come to light, and the side from which one looks into it.

    Attributes
    ----------
    low, high : (3,) float64
        Its corners, metres. Of what slides out, where it is then.
    axis, sign : int
        The open side looks along so much of this axis: a door's to the front, a drawer's upwards.
    """

    low: F64
    high: F64
    axis: int
    sign: int

    @classmethod
    def of(cls, instance: Instance) -> Inside | None:
        """The inside of an object; None for what does not open into the room, or has no known front."""
        if instance.type not in OPENS_FORWARD or instance.facing_deg is None:
            return None
        quarter = round(instance.facing_deg / 90) % 4
        axis, sign = quarter % 2, 1 if quarter < 2 else -1
        low, high = np.array(instance.box[:3]), np.array(instance.box[3:])
        slides = instance.type in SLIDES_OUT
        if slides:
            way = sign * SLIDE_SHARE * (high[axis] - low[axis])
            low[axis] += way
            high[axis] += way
        wall = np.minimum(WALL_M, (high - low) / 4)
        return cls(low + wall, high - wall, *((2, 1) if slides else (axis, sign)))

    @property
    def points(self) -> F64:
        """(POINTS ** 3, 3) points spread over it."""
        steps = [np.linspace(a, b, POINTS + 2)[1:-1] for a, b in zip(self.low, self.high, strict=True)]
        return np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)

    def shows_to(self, eye: F64, points: F64) -> Flags:
        """(n,) which of (n, 3) points within an eye sees through the open side."""
        edge = float((self.high if self.sign > 0 else self.low)[self.axis])
        before = self.sign * (float(eye[self.axis]) - edge)
        if before <= 0:
            return np.zeros(len(points), dtype=np.bool_)
        depth = self.sign * (edge - points[:, self.axis])
        through = eye + (points - eye) * (before / (before + depth))[:, None]
        others = [axis for axis in range(3) if axis != self.axis]
        return np.asarray(np.all((through >= self.low)[:, others] & (through <= self.high)[:, others], axis=1))

    def seen(self, depth: F32, camera: Camera) -> Flags:
        """(h, w) which pixels of a depth image, metres along the camera's forward axis, lie within."""
        return seen_within(self.low, self.high, depth, camera)


def looks_inside(
    inside: Inside, instance: Instance, memory: WalkMemory, grid: ReachableGrid, cells: Iterable[Cell]
) -> list[Outlook]:
    """For each cell the poses that look towards an inside, and what they should see of it, the more the nearer they are."""
    points, hiding = inside.points, hiding_voxels(instance, memory)
    found = []
    for pose in facing_poses(grid, cells, points.mean(axis=0)):
        camera = pose.camera(grid)
        eye = np.array(camera.position)
        is_seen = inside.shows_to(eye, points)
        is_seen[is_seen] = in_view(camera, points[is_seen], memory, hiding)
        far = max(math.dist(eye, points.mean(axis=0)), NEAREST_M)
        found.append(Outlook(pose, float(is_seen.mean()) * (NEAREST_M / far) ** 2))
    return found
