"""How clearly something stands out from what surrounds it in a picture."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import U8
from remqa_data.opencv import cv2

RING_PX = 4
"""Surroundings are the pixels so near to it."""


def contrast_de(rgb: U8, mask: npt.NDArray[np.bool_]) -> float:
    """Difference between the mean colours of some pixels and of those around them, in CIELAB (Delta E 1976).

    Infinite where there is nothing around them.

    >>> picture = np.zeros((20, 20, 3), dtype=np.uint8)
    >>> mask = np.zeros((20, 20), dtype=bool)
    >>> mask[5:9, 5:9] = True
    >>> picture[mask] = 255
    >>> contrast_de(picture, mask)  # from black to white
    100.0
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return float("inf")
    around = tuple(slice(max(at[0] - RING_PX, 0), at[-1] + RING_PX + 1) for at in (rows, columns))
    rgb, mask = rgb[around], mask[around]
    kernel = np.ones((2 * RING_PX + 1, 2 * RING_PX + 1), dtype=np.uint8)
    ring = cv2.dilate(mask.astype(np.uint8), kernel).astype(bool) & ~mask
    if not ring.any():
        return float("inf")
    # OpenCV converts bytes with whole numbers, the same on every processor; its L goes from 0 to 255.
    lab = cv2.cvtColor(rgb, cv2.COLOR_RGB2LAB).astype(np.int64)
    inside, around = (lab[pixels].sum(axis=0) / np.count_nonzero(pixels) for pixels in (mask, ring))
    return float(arithmetic.length((inside - around) * (100 / 255, 1.0, 1.0)))
