"""Numbers in the text of robot formats."""

from __future__ import annotations

import math
from collections.abc import Iterable

from remqa_data.geometry.types import F64, Vec3


def spaced(numbers: Iterable[float]) -> str:
    """Numbers with nine digits, a space between them.

    >>> spaced((0.5, -1.0, 1 / 3))
    '0.5 -1 0.333333333'
    """
    return " ".join(f"{float(number):.9g}" for number in numbers)


def roll_pitch_yaw(rotation: F64) -> Vec3:
    """Angles about the fixed axes x, y and z, in this order and in radians, of a (3, 3) rotation: URDF's `rpy`."""
    level = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = math.atan2(-rotation[2, 0], level)
    if level < 1e-9:  # it points straight up or down: roll and yaw are about one axis
        return math.atan2(-rotation[1, 2], rotation[1, 1]), pitch, 0.0
    return math.atan2(rotation[2, 1], rotation[2, 2]), pitch, math.atan2(rotation[1, 0], rotation[0, 0])
