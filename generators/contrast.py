"""How clearly something stands out from what surrounds it in a picture."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

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
    kernel = np.ones((2 * RING_PX + 1, 2 * RING_PX + 1), dtype=np.uint8)
    ring = cv2.dilate(mask.astype(np.uint8), kernel).astype(bool) & ~mask
    if not (mask.any() and ring.any()):
        return float("inf")
    lab = cv2.cvtColor(rgb.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2LAB)
    return round(float(np.linalg.norm(lab[mask].mean(axis=0) - lab[ring].mean(axis=0))), 3)
