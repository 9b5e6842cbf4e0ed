"""Whether a thing is of the colour that its word says: measured on its surfaces, with their textures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache, lru_cache

import numpy as np

from remqa_data.assets.core.model import Asset, Link, Material
from remqa_data.assets.looks.materials import COLORS
from remqa_data.assets.looks.textures import texture
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

MIXED = "mixed"
"""The word for what is of no one colour; phrases do not use it."""
LEAST_SHARE = 0.5
"""So much of the surface is of the colour."""
MAIN_SHARE = 0.2
"""A colour of this share of the surface is one of a thing's main colours."""
AS_NEAR = 6.0
"""A colour that is farther from the measured one by no more than this (CIE76) than the nearest may be said as well."""


def color_word(links: Sequence[Link], said: str) -> str:
    """The word that is said of a thing's colour, or `MIXED` if less than half of the thing looks like it."""
    total = like = 0.0
    for material, area in _areas(links):
        total += area
        like += area if said in colors_of(material) else 0.0
    return said if like >= LEAST_SHARE * total else MIXED


@cache
def colors_of(material: Material) -> frozenset[str]:
    """The words for the colour that a material shows: the nearest one, and those as near.

    >>> sorted(colors_of(Material("glass", "blue", (0.74, 0.85, 0.88))))
    ['white']
    """
    seen = _seen(material)
    apart = {word: float(arithmetic.length(seen - _lab(color))) for word, color in COLORS.items()}
    nearest = min(apart.values())
    return frozenset(word for word, distance in apart.items() if distance <= nearest + AS_NEAR)


def color_distance(one: Asset, other: Asset) -> float:
    """How far the nearest two of the colours of two things are apart, of each those of a good part of its surface (CIE76)."""
    return min(float(arithmetic.length(a - b)) for a in _main_colors(one) for b in _main_colors(other))


@lru_cache(maxsize=1024)
def _main_colors(asset: Asset) -> list[F64]:
    """CIELAB colours of the materials that make a good part of a thing's surface; of the largest one if none does."""
    areas: dict[Material, float] = {}
    for material, area in _areas(asset.links):
        areas[material] = areas.get(material, 0.0) + area
    least = min(MAIN_SHARE * sum(areas.values()), max(areas.values()))
    return [_seen(material) for material, area in areas.items() if area >= least]


def _areas(links: Sequence[Link]) -> Iterator[tuple[Material, float]]:
    """The material of each surface, and twice its area in square metres."""
    for surface in (surface for link in links for surface in link.surfaces):
        a, b, c = (surface.vertices[surface.faces[:, i]].astype(np.float64) for i in range(3))
        yield surface.material, float(arithmetic.length(np.cross(b - a, c - a)).sum())


@cache
def _seen(material: Material) -> F64:
    """CIELAB colour of a material, with its texture."""
    rgb = np.array(material.rgb)
    if material.texture is not None:
        rgb = rgb * texture(material.texture)[..., :3].reshape(-1, 3).mean(axis=0) / 255.0
    return _lab((float(rgb[0]), float(rgb[1]), float(rgb[2])))


@cache
def _lab(srgb: Vec3) -> F64:
    """CIELAB coordinates under D65 of an sRGB colour, 0..1; after IEC 61966-2-1 and CIE 15."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in srgb]
    rows = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
    white = (0.9505, 1.0, 1.089)
    x, y, z = (sum(a * c for a, c in zip(row, linear, strict=True)) / w for row, w in zip(rows, white, strict=True))
    f, g, h = (t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116 for t in (x, y, z))
    return np.array([116 * g - 16, 500 * (f - g), 200 * (g - h)])
