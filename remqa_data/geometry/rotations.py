"""Rotations as 3x3 matrices and as unit quaternions (x, y, z, w)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from remqa_data.geometry import arithmetic

if TYPE_CHECKING:
    from remqa_data.geometry.types import F64  # the assets need these rotations themselves


def quaternion_of(rotation: F64) -> tuple[float, float, float, float]:
    """Unit quaternion (x, y, z, w) of a 3x3 rotation matrix (Shepperd's method)."""
    m = np.asarray(rotation, float)
    trace = float(m[0, 0] + m[1, 1] + m[2, 2])
    picks = np.array([m[0, 0], m[1, 1], m[2, 2], trace])
    k = int(picks.argmax())
    q = np.empty(4)
    if k == 3:
        q[3] = 1 + trace
        q[:3] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q[k] = 1 - trace + 2 * m[k, k]
        q[i], q[j], q[3] = m[i, k] + m[k, i], m[j, k] + m[k, j], m[j, i] - m[i, j]
    q /= arithmetic.length(q)
    return float(q[0]), float(q[1]), float(q[2]), float(q[3])


def snapped_quaternion(quaternion: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """The unit quaternion nearest to one with snapped components; the same for two that differ by rounding."""
    q = arithmetic.snapped(quaternion)
    x, y, z, w = (q / arithmetic.length(q)).tolist()
    return x, y, z, w


def about_z(degrees: float) -> F64:
    """3x3 rotation about the vertical, counter-clockwise; exact for quarter turns."""
    sine, cosine = (float(value) for value in arithmetic.sin_cos_deg(degrees))
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def degrees_apart(one: float, other: float) -> float:
    """The angle between two headings in degrees, 0 to 180.

    >>> degrees_apart(350.0, 20.0)
    30.0
    """
    return abs((one - other + 180.0) % 360.0 - 180.0)


def rotation_of(quaternion: tuple[float, float, float, float]) -> F64:
    """3x3 rotation matrix of a unit quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def steps_of(rotation: F64, step: float) -> F64:
    """(n, 3, 3) rotations from none at all to a (3, 3) one, the short way round; their quaternions are at most a step apart.

    >>> steps_of(about_z(90.0), 0.5).round(3)[:, 1, 0].tolist()
    [0.0, 0.707, 1.0]
    """
    end = np.array(quaternion_of(rotation))
    start = np.array([0.0, 0.0, 0.0, 1.0 if end[3] >= 0.0 else -1.0])
    count = math.ceil(float(arithmetic.length(end - start)) / step) + 1
    between = start + np.linspace(0.0, 1.0, max(count, 2))[:, None] * (end - start)
    x, y, z, w = (between / arithmetic.length(between)[:, None]).T.tolist()
    return np.stack([rotation_of(quaternion) for quaternion in zip(x, y, z, w, strict=True)])
