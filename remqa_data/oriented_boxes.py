"""Intersection over union of turned 3D boxes. Pure numpy; `remqa_data.geometry` has the faster one for boxes that are not.

A box is its centre, its size along its own axes and its rotation: metres, world frame.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from remqa_data.assets.model import F64, Vec3

TOLERANCE = 1e-9
"""Metres within which two faces lie in one plane."""


@dataclass(frozen=True, eq=False)
class OrientedBox:
    """A turned box.

    Attributes
    ----------
    centre, size : tuple of float
        Metres.
    rotation : (3, 3) array
        Columns are the directions of the box's own axes.
    """

    centre: Vec3
    size: Vec3
    rotation: F64

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return float(np.prod(self.size))

    def faces(self) -> Iterator[tuple[F64, F64, float]]:
        """Of each face: its (4, 3) corners counter-clockwise from outside, its normal n and its n . p."""
        half = np.asarray(self.size) / 2
        for axis in range(3):
            for sign in (-1.0, 1.0):
                u, v = (axis + 1) % 3, (axis + 2) % 3
                corners = np.zeros((4, 3))
                corners[:, axis] = sign * half[axis]
                corners[:, u] = half[u] * np.array([-1, 1, 1, -1])
                corners[:, v] = half[v] * np.array([-1, -1, 1, 1])
                normal = sign * self.rotation[:, axis]
                points = corners[:: int(sign)] @ self.rotation.T + self.centre
                yield points, normal, float(normal @ points[0])


def oriented_iou(a: OrientedBox, b: OrientedBox) -> float:
    """Intersection over union, 0 to 1; 0 if either box has no volume.

    Notes
    -----
    The surface of the intersection is what of each box's faces lies in the other box (Sutherland and Hodgman 1974); its
    volume follows from the divergence theorem.
    """
    if min(*a.size, *b.size) <= 0:
        return 0.0
    # About a point between the boxes, so that coordinates far from the origin cost no precision.
    origin = (np.asarray(a.centre) + np.asarray(b.centre)) / 2
    shared = max(_flux(a, b, origin, is_first=True) + _flux(b, a, origin, is_first=False), 0.0) / 3
    return min(shared / (a.volume + b.volume - shared), 1.0)


def _flux(box: OrientedBox, other: OrientedBox, origin: F64, *, is_first: bool) -> float:
    """Integral of n . p over the part of a box's surface in another box; where faces coincide, only the first's count."""
    flux = 0.0
    for corners, normal, _ in box.faces():
        polygon = corners
        for _, outward, offset in other.faces():
            is_same = bool(np.abs(corners @ outward - offset).max() < TOLERANCE) and normal @ outward > 0
            if is_same and not is_first:
                polygon = polygon[:0]
            polygon = polygon if is_same else _clipped(polygon, outward, offset)
        if len(polygon) >= 3:
            fan = np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0]).sum(axis=0) / 2
            flux += float(fan @ (polygon[0] - origin))
    return flux


def _clipped(polygon: F64, normal: F64, offset: float) -> F64:
    """The part of a convex polygon with n . p <= offset."""
    kept = []
    distances = polygon @ normal - offset
    for i in range(len(polygon)):
        here, before = distances[i], distances[i - 1]
        if (here > 0) != (before > 0):
            kept.append(polygon[i - 1] + (polygon[i] - polygon[i - 1]) * (before / (before - here)))
        if here <= 0:
            kept.append(polygon[i])
    return np.array(kept).reshape(-1, 3)
