"""Squares that are cut out of views: what is looked at when it is known where the target is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.opencv import cv2

SIDE_PX = 192
"""Of the square that an answerer sees, if its configuration does not say another."""

AROUND, LEAST_PX = 1.5, 120.0
"""It shows so many times the target's box, and at least so many pixels of the view."""


def window(box: Sequence[float] | npt.NDArray[np.floating] | None, size: tuple[int, int]) -> tuple[float, float, float]:
    """Middle and side in pixels of the square that is looked at, for a box x1, y1, x2, y2 in a picture of a (height, width).

    Without a box it is the whole picture.
    """
    height, width = size
    if box is None:
        return width / 2, height / 2, float(max(size))
    x1, y1, x2, y2 = box
    side = min(max(AROUND * max(x2 - x1, y2 - y1), LEAST_PX), float(max(size)))
    x, y = ((low + high) / 2 for low, high in ((x1, x2), (y1, y2)))
    return (
        float(np.clip(x, side / 2, width - side / 2)),
        float(np.clip(y, side / 2, height - side / 2)),
        float(side),
    )


def cut(
    picture: np.ndarray, place: tuple[float, float, float], side_px: int = SIDE_PX, *, mirrored: bool = False
) -> np.ndarray:
    """The square of a picture, (h, w, 3) colours or (h, w) numbers, as (side_px, side_px, ...)."""
    x, y, side = place
    zoom = side_px / side
    across = -zoom if mirrored else zoom
    matrix = np.array([[across, 0.0, side_px / 2 - across * x], [0.0, zoom, side_px / 2 - zoom * y]])
    # Networks that come with the package have learnt from this, where it shrinks, too: `warpAffine` averages no areas.
    how = cv2.INTER_LINEAR if picture.ndim == 3 else cv2.INTER_NEAREST
    return cv2.warpAffine(picture, matrix, (side_px, side_px), flags=how)
