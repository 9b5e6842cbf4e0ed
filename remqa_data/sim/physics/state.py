"""Where one object of a world is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from remqa_data.assets.core.model import Asset
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Quaternion


@dataclass(frozen=True)
class ObjectState:
    """Where one object is: pose of the centre of its closed box, openness, and whether physics moves it."""

    position: Vec3
    quaternion: Quaternion
    openness: float
    is_fixed: bool

    def matrix(self) -> F64:
        """(4, 4) pose, asset frame to world frame."""
        pose = np.eye(4)
        pose[:3, :3] = rotation_of(self.quaternion)
        pose[:3, 3] = self.position
        return pose

    def link_poses(self, asset: Asset) -> F64:
        """(links, 4, 4) poses of the links of an object of that asset, link frame to world frame."""
        return arithmetic.product(self.matrix(), asset.link_poses(self.openness))
