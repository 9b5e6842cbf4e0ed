"""How much of its box a thing fills, as seen from above and from its sides: key rings and forks show few pixels."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from remqa_data.assets import AssetSpec, build, variant_count
from remqa_data.generators.arrangement.hiding_rules import hidden_size
from remqa_data.opencv import cv2

RASTER_PX = 64
MAX_VARIANTS = 3
"""Shapes of a type that are looked at."""


@lru_cache(maxsize=256)
def fill_ratios(type_: str) -> tuple[float, float]:
    """Share of its box's top that a thing of a type fills, and the least share of the box's four sides.

    The least over the first three shapes of the type.
    """
    top, side = 1.0, 1.0
    for variant in range(min(MAX_VARIANTS, variant_count(type_))):
        asset = build(AssetSpec(type_, hidden_size(type_), variant))
        low, high = asset.bounds()
        images = {axes: np.zeros((RASTER_PX, RASTER_PX), dtype=np.uint8) for axes in ((0, 1), (0, 2), (1, 2))}
        for link in asset.links:
            for surface in link.surfaces:
                unit = (surface.vertices - low) / np.maximum(high - low, 1e-6) * (RASTER_PX - 1)
                for axes, image in images.items():
                    for triangle in np.round(unit[:, axes]).astype(np.int32)[surface.faces]:
                        cv2.fillConvexPoly(image, triangle, 1)
        shares = {axes: float(image.mean()) for axes, image in images.items()}
        top = min(top, shares[(0, 1)])
        side = min(side, shares[(0, 2)], shares[(1, 2)])
    return top, side
