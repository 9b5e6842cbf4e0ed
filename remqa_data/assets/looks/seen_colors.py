"""Whether a thing is of the colour that its word says: measured on its surfaces, with their textures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache, lru_cache

import numpy as np

from remqa_data.assets.core.model import Asset, Link, Material, Space
from remqa_data.assets.looks.materials import COLORS
from remqa_data.assets.looks.textures import texture
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

MIXED = "mixed"
"""The word for what is of no one colour; phrases do not use it."""
LEAST_SHARE = 0.5
"""So much of the surface is of the colour."""
WALL_M = 0.02
"""The bottom of a space is no farther from it than this."""
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


def mean_color(asset: Asset) -> F64:
    """(3,) CIELAB colour of a thing without light, on average over its surface."""
    return _averaged(_areas(asset.links))


@lru_cache(maxsize=1024)
def inner_colors(asset: Asset) -> list[F64]:
    """(3,) CIELAB colours of the bottoms of a thing's enclosed spaces without light; of the whole thing if it has none."""
    bottoms = (list(_bottom(asset.links[space.link], space)) for space in asset.spaces if space.enclosed)
    return [_averaged(parts) for parts in bottoms if parts] or [mean_color(asset)]


def _averaged(parts: Iterable[tuple[Material, float]]) -> F64:
    colors, areas = zip(*((_seen(material), area) for material, area in parts), strict=True)
    return np.asarray((np.array(colors) * np.array(areas)[:, None]).sum(axis=0) / max(sum(areas), 1e-12))


def _bottom(link: Link, space: Space) -> Iterator[tuple[Material, float]]:
    """The material of each surface, and twice its area, as far as it is the bottom of a space."""
    low, high = np.array(space.box[:3]), np.array(space.box[3:])
    high[2] = low[2]
    for surface in link.surfaces:
        corners = surface.vertices[surface.faces].astype(np.float64)
        middles = corners.mean(axis=1)
        up = arithmetic.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
        is_near = ((middles > low - WALL_M) & (middles < high + WALL_M)).all(axis=1)
        area = float(up[is_near & (up > 0)].sum())
        if area > 0:
            yield surface.material, area


def _areas(links: Sequence[Link]) -> Iterator[tuple[Material, float]]:
    """The material of each surface, and twice its area in square metres."""
    for surface in (surface for link in links for surface in link.surfaces):
        a, b, c = surface.vertices.astype(np.float64)[surface.faces.T]
        yield surface.material, float(arithmetic.length(arithmetic.cross(b - a, c - a)).sum())


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
