"""What the hand holds, as ways of the arm look at it: balls that go along with the hand."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.world import World

BALL_M = 0.025
"""Greatest radius of a ball."""
MARGIN_M = 0.005
"""Balls are so much smaller than what they stand for, so that it may slide along what it touches."""
LEAST_M = 0.001


class Load(NamedTuple):
    """Balls around the hand, which keep where they are to it.

    Attributes
    ----------
    offsets : (n, 3) array
        Their middles from the hand's, along the room's axes, metres.
    radii : (n,) array
        Metres.
    """

    offsets: F64
    radii: F64

    @property
    def reach_m(self) -> float:
        """How far from the hand's middle it reaches."""
        return float((arithmetic.length(self.offsets) + self.radii).max(initial=0.0))


NOTHING = Load(np.zeros((0, 3)), np.zeros(0))


def load_of(world: World, states: Mapping[str, ObjectState], hand: Vec3) -> Load:
    """The balls of some objects where they are held, by their ids, around a hand in the room, metres."""
    offsets, radii = [NOTHING.offsets], [NOTHING.radii]
    for object_id, state in states.items():
        asset = world.assets[object_id]
        for link, pose in zip(asset.links, state.link_poses(asset), strict=True):
            for box in link.boxes:
                local, radius = _balls_in(box.size)
                turned = arithmetic.turned(local, rotation_of(box.quaternion)) + box.centre
                offsets.append(arithmetic.moved(turned, pose) - hand)
                radii.append(np.full(len(local), radius))
    return Load(np.concatenate(offsets), np.concatenate(radii))


@lru_cache(maxsize=256)
def _balls_in(size: Vec3) -> tuple[F64, float]:
    """(n, 3) middles of the balls along the faces of a box around the origin, and their radius."""
    radius = min(*(side / 2 for side in size), BALL_M)
    rows = [_along(side / 2 - radius) for side in size]
    grid = [
        point
        for point in itertools.product(*rows)
        if any(abs(x) >= abs(row[-1]) - 1e-12 for x, row in zip(point, rows, strict=True))
    ]
    return np.array(grid), max(radius - MARGIN_M, LEAST_M)


def _along(reach: float) -> list[float]:
    """Places from -reach to reach, a ball's radius apart."""
    count = math.ceil(2 * reach / BALL_M) + 1
    return np.linspace(-reach, reach, count).tolist() if count > 1 else [0.0]
