"""Where the hand can touch an object."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np

from remqa_data.assets.core.model import Link
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64
from remqa_data.sim.arm.postures import ArmBase
from remqa_data.sim.arm.search import HandGoals
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.physics.world import World

SPREAD = (0.0, -0.45, 0.45, -0.9, 0.9)
"""Where on a side of a box points are taken, as a share of half its length."""
MESH_GRID_M = 0.015
"""Of the corners of a mesh that lie in the same cube of this size, one is taken."""
GAP_SHARE = 0.75
"""The hand's middle stays this share of its ball's radius off the surface: the ball reaches in, the fingers do not."""


class Targets:
    """Places for the hand at the objects of a world.

    Parameters
    ----------
    world : World
        Its objects may move; their shapes stay, and are read once.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._shapes: dict[str, list[_Shape]] = {}

    def goals(self, base: ArmBase, object_id: str, hand_radius_m: float) -> HandGoals:
        """Where the hand's ball touches an object, those places first that are nearest to the arm's best shoulder.

        The surface is as it is now, so it follows open doors: points spread over the collision boxes, which have large
        sides, touched at right angles; and corners of the visible mesh, which has leaves and handles, touched from the
        side of the shoulder, from above, and from between the two.
        """
        poses = self._world.link_poses(object_id)
        if object_id not in self._shapes:
            self._shapes[object_id] = [_shape(link) for link in self._world.assets[object_id].links]
        placed = [_placed(shape, pose) for shape, pose in zip(self._shapes[object_id], poses, strict=True)]
        points, inwards, corners = (np.vstack(arrays) for arrays in zip(*placed, strict=True))
        level = _unit(corners - best_shoulders(base, corners))
        down = np.broadcast_to([0.0, 0.0, -1.0], level.shape)
        axes = np.vstack([inwards, level, down, _unit(level + down)])
        hand = np.vstack([points, corners, corners, corners]) - axes * (GAP_SHARE * hand_radius_m)
        reach = arithmetic.length(hand - best_shoulders(base, hand))
        order = np.argsort(np.round(reach, 6), kind="stable")[: np.count_nonzero(reach <= AGENT.reach_m)]
        return HandGoals(hand[order], axes[order])


def best_shoulders(base: ArmBase, points: F64) -> F64:
    """(n, 3) places in the room where the shoulder is nearest to (n, 3) points: turned to them, and at their height.

    The distance from there is `grid.reach_distance`, but for points above the agent's own base.
    """
    shoulders = np.empty_like(points)
    shoulders[:, :2] = points[:, :2] - [base.x, base.y]
    shoulders[:, :2] *= AGENT.shoulder_ahead_m / np.maximum(arithmetic.length(shoulders[:, :2])[:, None], 1e-9)
    shoulders[:, :2] += [base.x, base.y]
    shoulders[:, 2] = np.clip(points[:, 2], base.floor_z + AGENT.shoulder_low_m, base.floor_z + AGENT.shoulder_high_m)
    return shoulders


class _Shape(NamedTuple):
    """Points on the boxes of a link (n, 3), the directions into the boxes there (n, 3), corners of its mesh (m, 3)."""

    points: F64
    inwards: F64
    corners: F64


def _shape(link: Link) -> _Shape:
    points, inwards = [np.empty((0, 3))], [np.empty((0, 3))]
    for box in link.boxes:
        rotation = rotation_of(box.quaternion)
        points.append(arithmetic.turned(_CUBE * np.asarray(box.size) / 2, rotation) + box.centre)
        inwards.append(arithmetic.turned(-_CUBE_NORMALS, rotation))
    vertices = np.vstack([np.empty((0, 3)), *(surface.vertices for surface in link.surfaces)])
    _, kept = np.unique(np.round(vertices / MESH_GRID_M), axis=0, return_index=True)
    return _Shape(np.vstack(points), np.vstack(inwards), vertices[kept])


def _placed(shape: _Shape, pose: F64) -> _Shape:
    inwards = arithmetic.turned(shape.inwards, pose[:3, :3])
    return _Shape(arithmetic.moved(shape.points, pose), inwards, arithmetic.moved(shape.corners, pose))


def _unit(vectors: F64) -> F64:
    return np.asarray(vectors / np.maximum(arithmetic.length(vectors)[:, None], 1e-9))


def _faces() -> Iterator[tuple[F64, F64]]:
    """Points spread over the faces of the cube from -1 to 1, (n, 3), and their outward normals, (n, 3)."""
    grid = np.array(sorted(product(SPREAD, SPREAD), key=lambda at: (math.hypot(*at), at)))
    for axis, sign in product(range(3), (-1.0, 1.0)):
        points = np.insert(grid, axis, sign, axis=1)
        normals = np.zeros_like(points)
        normals[:, axis] = sign
        yield points, normals


_CUBE, _CUBE_NORMALS = (np.vstack(arrays) for arrays in zip(*_faces(), strict=True))
