"""From where things are seen: agent poses on the grid and what a camera there shows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from remqa_data.catalog import types_with
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.geometry.types import F64, I32
from remqa_data.sim.navigation.embodiment import AGENT, Embodiment
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.render.camera import Camera

if TYPE_CHECKING:
    from remqa_data.sim.physics.world import World
    from remqa_data.sim.render.view import WorldView

HEADINGS_DEG = (0, 90, 180, 270)
HORIZONS_DEG = (-30, 0, 30, 60)
MIN_PIXELS = 50
"""An object is visible in a 300 x 300 frame when at least this many pixels are its own."""
FRAME_PX = 300
FRONT_POINTS, SURFACE_POINTS = 5, 4
"""Along each side of the lattice of points on an object's front, and of that on each side of its box."""
Pose = tuple[float, float, float, float]
"""x, y in metres, yaw_deg, horizon_deg."""


@dataclass(frozen=True, order=True)
class AgentPose:
    """Where the agent is and looks: a grid cell, a heading (degrees counter-clockwise from +x), a horizon, its posture."""

    cell: Cell
    yaw_deg: int
    horizon_deg: int = 0
    is_standing: bool = True

    @classmethod
    def nearest(
        cls,
        x: float,
        y: float,
        yaw_deg: float,
        horizon_deg: float,
        is_standing: bool = True,
        body: Embodiment = AGENT,
    ) -> AgentPose:
        """The pose of the grid that is nearest to where a body is and looks, in metres and degrees."""
        return cls(body.cell_at(x, y), round(yaw_deg) % 360, round(horizon_deg), is_standing)

    def camera(self, grid: ReachableGrid, size_px: int = FRAME_PX) -> Camera:
        """The agent's camera there."""
        return self.camera_above(grid.floor_z, size_px, grid.body)

    def camera_above(self, floor_z: float, size_px: int = FRAME_PX, body: Embodiment = AGENT) -> Camera:
        """The camera of a body that stands there on a floor of some height."""
        eye = (*body.centre_of(self.cell), floor_z + body.eye_height_m(self.is_standing))
        return Camera(eye, float(self.yaw_deg), float(self.horizon_deg), body.fov_deg, size_px, size_px)


def pixel_counts(image: I32, objects: int) -> npt.NDArray[np.int64]:
    """(objects,) number of pixels of each object in an image of object indices, -1 for none."""
    return np.bincount(image.ravel() + 1, minlength=objects + 1)[1:]


def facing_poses(
    grid: ReachableGrid, cells: Iterable[Cell], point: F64, *, is_standing: bool = True
) -> Iterator[AgentPose]:
    """Poses at some cells that look towards a point: nearest cells first, then the heading and horizon nearest to it."""
    x, y, z = (float(v) for v in point)
    height = grid.body.eye_height_m(is_standing)
    for cell in sorted(cells, key=lambda c: (math.dist(grid.position(c), (x, y)), c)):
        px, py = grid.position(cell)
        yaw = math.degrees(arithmetic.arctan2(y - py, x - px)) % 360
        down = math.degrees(arithmetic.arctan2(grid.floor_z + height - z, max(math.dist((px, py), (x, y)), 1e-6)))
        headings = sorted(HEADINGS_DEG, key=lambda h: (degrees_apart(h, yaw), h))[:2]
        for horizon in sorted(HORIZONS_DEG, key=lambda h: (abs(h - down), h))[:2]:
            for heading in headings:
                yield AgentPose(cell, heading, horizon, is_standing)


def surface_points(world: World, object_id: str) -> F64:
    """(n, 3) points spread over the sides and the top of an object's box in the room."""
    low, high = world.box(object_id)
    spread = np.linspace(-0.9, 0.9, SURFACE_POINTS)
    a, b = (axis.ravel() for axis in np.meshgrid(spread, spread))
    one = np.ones_like(a)
    faces = [(a, b, one), (one, a, b), (-one, a, b), (a, one, b), (a, -one, b)]
    unit = np.vstack([np.column_stack(face) for face in faces])
    return np.asarray((low + high) / 2 + unit * (high - low) / 2)


def front_points(view: WorldView, object_id: str) -> F64:
    """(n, 3) points spread over the front of an object, and over its top where it opens upwards, in the room."""
    state = view.world.state(object_id)
    half = np.array(view.world.assets[object_id].spec.size) / 2
    spread = np.linspace(-0.9, 0.9, FRONT_POINTS)
    a, b = (axis.ravel() for axis in np.meshgrid(spread, spread))
    front = np.column_stack([a, -np.ones_like(a), b])
    top = np.column_stack([a, b, np.ones_like(a)])
    opens_up = view.world.type_of(object_id) in OPENS_UPWARDS
    local = (np.vstack([front, top]) if opens_up else front) * half
    return arithmetic.moved(local, state.matrix())


OPENS_UPWARDS = types_with("opens_upwards")
