"""Frames: a profile swept around a shape on a wall, and the flat plate that it holds. Shapes lie in x and z."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Axis, Mesh
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

Outline = Callable[[float], F64]
"""Maps an inset in metres to the (n, 2) points (x, z) of a shape drawn smaller by it on all sides."""


def rectangle(width: float, height: float) -> Outline:
    """A rectangle with sharp corners."""
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    return lambda inset: corners * [width - 2 * inset, height - 2 * inset]


def rounded(width: float, height: float, radius: float) -> Outline:
    """A rectangle with round corners."""
    return lambda inset: primitives.rounded_rect(width - 2 * inset, height - 2 * inset, max(radius - inset, 0.004), 6)


def oval(width: float, height: float) -> Outline:
    """An ellipse."""
    return lambda inset: primitives.ellipse(width - 2 * inset, height - 2 * inset, 32)


def moulding(shape: Outline, profile: Sequence[tuple[float, float]]) -> list[tuple[Mesh, Axis]]:
    """A frame: a profile of (inset, y) points swept around a shape, from the back over the front to the inside.

    Returns
    -------
    list of (Mesh, Axis)
        Each part with the direction of its grain: a rectangle's level and upright sides are parts of their own.
    """
    rings = [np.column_stack([p[:, 0], np.full(len(p), y), p[:, 1]]) for p, y in ((shape(i), y) for i, y in profile)]
    if len(rings[0]) != 4:
        return [(primitives.joined([_band(low, high, slice(None)) for low, high in pairwise(rings)]), "x")]
    sides: tuple[tuple[int, Axis], ...] = ((0, "x"), (1, "z"))
    return [
        (primitives.joined([_band(low, high, slice(start, None, 2)) for low, high in pairwise(rings)]), grain)
        for start, grain in sides
    ]


def plate(points: F64, y: float, *, border: float = 0.0, crop: float = 0.0) -> Mesh:
    """A flat sheet over a convex outline of (x, z) points, facing -y, with a picture stretched once over it.

    Parameters
    ----------
    border : float
        Share of the picture to cut off at each edge.
    crop : float
        How a square picture gets a longer shape: 0 stretches it, 1 cuts off what is too much, between does both.
    """
    n = len(points)
    vertices = np.column_stack([points[:, 0], np.full(n, y), points[:, 1]])
    low, high = points.min(axis=0), points.max(axis=0)
    size = high - low
    shown = (1 - 2 * border) * (size / size.max()) ** crop
    uv = 0.5 + ((points - low) / size - 0.5) * shown * [1, -1]
    fan = np.arange(1, n - 1)
    faces = np.column_stack([np.zeros(n - 2, dtype=np.int64), fan, fan + 1])
    return Mesh(vertices, np.tile([0.0, -1.0, 0.0], (n, 1)), faces, uv)


def _band(lower: F64, upper: F64, sides: slice) -> Mesh:
    """Some of the quads between two rings that run counter-clockwise as seen from the front; round where they are."""
    following_l, following_u = np.roll(lower, -1, axis=0), np.roll(upper, -1, axis=0)
    along = following_l - lower + following_u - upper
    flat = arithmetic.cross(along, upper - lower + following_u - following_l)
    flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-12)
    before = np.roll(flat, 1, axis=0)
    smooth = (np.sum(flat * before, axis=1) > 0.8)[:, None]
    start = np.where(smooth, flat + before, flat)
    end = np.roll(np.where(smooth, flat + before, before), -1, axis=0)
    normals = np.vstack([start[sides], end[sides], end[sides], start[sides]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    corners = [ring[sides] for ring in (lower, following_l, following_u, upper)]
    n = len(corners[0])
    i = np.arange(n)
    faces = np.vstack([np.column_stack([i, i + n, i + 2 * n]), np.column_stack([i, i + 2 * n, i + 3 * n])])
    return Mesh(np.vstack(corners), normals, faces)
