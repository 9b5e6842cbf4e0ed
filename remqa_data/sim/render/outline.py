"""Where on the image is a face? Its bounds, and where each row of pixels meets its sides."""

from __future__ import annotations

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32
from remqa_data.sim.render.camera import NEAR_M

_SIDE_SLACK = 1e-9
_FAR_AWAY = 1e30


@exact
def face_bounds(
    image: F32, a: int, b: int, c: int, skip_back: bool, pinhole: bool, half_width: float, half_height: float
) -> tuple[float, float, float, float]:
    """Least and greatest x and y of what the image shows of a face, in pixels from the image centre.

    Least > greatest where it cannot be seen.
    """
    depth_a, depth_b, depth_c = image[2, a], image[2, b], image[2, c]
    if pinhole and min(depth_a, min(depth_b, depth_c)) < NEAR_M:
        if max(depth_a, max(depth_b, depth_c)) < NEAR_M:
            return 1.0, -1.0, 1.0, -1.0
        return _clipped_bounds(image, a, b, c, half_width, half_height)
    xa, ya, xb, yb, xc, yc = image[3, a], image[4, a], image[3, b], image[4, b], image[3, c], image[4, c]
    # y points down, so a face that is counter-clockwise to the viewer has a negative area here.
    if skip_back and (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya) >= 0.0:
        return 1.0, -1.0, 1.0, -1.0
    return (
        max(min(xa, min(xb, xc)), -half_width),
        min(max(xa, max(xb, xc)), half_width),
        max(min(ya, min(yb, yc)), -half_height),
        min(max(ya, max(yb, yc)), half_height),
    )


@exact
def _clipped_bounds(
    image: F32, a: int, b: int, c: int, half_width: float, half_height: float
) -> tuple[float, float, float, float]:
    """Bounds of the part of a face that lies behind the near plane, as seen from the eye."""
    x_least, x_most, y_least, y_most = _FAR_AWAY, -_FAR_AWAY, _FAR_AWAY, -_FAR_AWAY
    start, end, other = a, b, c
    for _ in range(3):
        from_near, to_near = image[2, start] - NEAR_M, image[2, end] - NEAR_M
        if from_near >= 0.0:
            x, y = np.float64(image[3, start]), np.float64(image[4, start])
            x_least, x_most, y_least, y_most = min(x_least, x), max(x_most, x), min(y_least, y), max(y_most, y)
        if (from_near >= 0.0) != (to_near >= 0.0):
            t = from_near / (from_near - to_near)
            x = (image[0, start] + t * (image[0, end] - image[0, start])) / NEAR_M
            y = (image[1, start] + t * (image[1, end] - image[1, start])) / NEAR_M
            x_least, x_most, y_least, y_most = min(x_least, x), max(x_most, x), min(y_least, y), max(y_most, y)
        start, end, other = end, other, start
    # Rounding grows with the division by the near distance.
    size = max(max(abs(x_least), abs(x_most)), max(abs(y_least), abs(y_most)))
    slack = 1e-5 * (half_width + half_height + min(size, 1e6))
    return (
        max(x_least - slack, -half_width),
        min(x_most + slack, half_width),
        max(y_least - slack, -half_height),
        min(y_most + slack, half_height),
    )


@exact
def side(slope: float, down: float, constant: float) -> tuple[float, float, float, float]:
    """Where a row meets the half plane slope * x + down * y + constant >= 0.

    Least x and its change with y, then greatest x and its change with y; one of the two is infinite. Widened by more
    than rounding. For a horizontal side see `rows_of_side`.
    """
    if slope > 0.0:
        return -constant / slope - _SIDE_SLACK, -down / slope, _FAR_AWAY, 0.0
    if slope < 0.0:
        return -_FAR_AWAY, 0.0, -constant / slope + _SIDE_SLACK, -down / slope
    return -_FAR_AWAY, 0.0, _FAR_AWAY, 0.0


@exact
def rows_of_side(slope: float, down: float, constant: float) -> tuple[float, float]:
    """Least and greatest y where the half plane slope * x + down * y + constant >= 0 is met, if it is horizontal."""
    if slope != 0.0:
        return -_FAR_AWAY, _FAR_AWAY
    if down > 0.0:
        return -constant / down - _SIDE_SLACK, _FAR_AWAY
    if down < 0.0:
        return -_FAR_AWAY, -constant / down + _SIDE_SLACK
    return (-_FAR_AWAY, _FAR_AWAY) if constant >= 0.0 else (_FAR_AWAY, -_FAR_AWAY)
