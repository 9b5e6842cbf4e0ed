"""Where one object of a world is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from remqa_data.assets.core.model import Asset
from remqa_data.errors import ActionError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import quaternion_of, rotation_of
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Quaternion

UNIT_SLACK = 1e-6
"""The length of a quaternion differs from 1 by so much at most."""


def finite_vector(vector: Sequence[float], what: str) -> Vec3:
    """Three finite numbers; ActionError, which says what they are, if it is something else."""
    numbers = tuple(map(float, vector))
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise ActionError(f"{what} is {vector!r:.80}: give three finite numbers")
    x, y, z = numbers
    return x, y, z


@dataclass(frozen=True)
class ObjectState:
    """Where one object is: pose of the centre of its closed box, openness, and whether physics moves it."""

    position: Vec3
    quaternion: Quaternion
    openness: float
    is_fixed: bool

    def elsewhere(self, position: Vec3, quaternion: Quaternion | None = None) -> ObjectState:
        """The state of the same object somewhere else, and turned as it is, or otherwise.

        Raises
        ------
        ActionError
            If a number is not finite, or the quaternion not a unit one: it would stretch the mesh, and not what collides.
        """
        x, y, z = map(float, position)
        turn = quaternion or self.quaternion
        if not all(map(math.isfinite, (x, y, z))) or not abs(math.hypot(*turn) - 1.0) <= UNIT_SLACK:
            msg = f"no pose: position {position!r:.80}, quaternion {turn!r:.80}; give finite numbers and a unit quaternion"
            raise ActionError(msg)
        return replace(self, position=(x, y, z), quaternion=turn)

    def moved(self, motion: F64) -> ObjectState:
        """The state of the same object after a (4, 4) motion in the world."""
        x, y, z = arithmetic.moved(self.position, motion).tolist()
        quaternion = self.quaternion
        if not np.allclose(motion[:3, :3], np.eye(3), rtol=0, atol=1e-12):
            quaternion = quaternion_of(arithmetic.product(motion[:3, :3], rotation_of(self.quaternion)))
        return replace(self, position=(x, y, z), quaternion=quaternion)

    def matrix(self) -> F64:
        """(4, 4) pose, asset frame to world frame."""
        pose = np.eye(4)
        pose[:3, :3] = rotation_of(self.quaternion)
        pose[:3, 3] = self.position
        return pose

    def link_poses(self, asset: Asset) -> F64:
        """(links, 4, 4) poses of the links of an object of that asset, link frame to world frame."""
        return arithmetic.product(self.matrix(), asset.link_poses(self.openness))
