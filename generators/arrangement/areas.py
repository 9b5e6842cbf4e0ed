"""Flat pieces of room on which hidden things lie: rectangles with a height, and the spots in them.

An area is given while everything is closed, in the room: its middle at the bottom, a turn about the vertical, and half
its sides. Points of an area are given in its own frame, with the origin at its middle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.boxes import corners
from remqa_data.geometry.rotations import about_z
from remqa_data.geometry.types import F64, Vec3


@dataclass(frozen=True)
class Spot:
    """Room for one hidden thing: the middle of its bottom, and the free radius and height there; metres."""

    position: Vec3
    radius_m: float
    height_m: float


@dataclass(frozen=True)
class Area:
    """A rectangle on which hidden things lie, all of it in sight after the manipulation.

    Attributes
    ----------
    centre : tuple of float
        Middle of its bottom in the room, metres.
    yaw_deg : float
        Turn of its sides, counter-clockwise.
    half : tuple of float
        Half its sides along its own x and y, metres.
    height_m : float
        Free height above it.
    link : int
        Which link of the object carries what lies there along.
    seen_from_m : float
        How far above the bottom a thing must reach to be seen from the goal.
    """

    centre: Vec3
    yaw_deg: float
    half: tuple[float, float]
    height_m: float
    link: int = 0
    seen_from_m: float = 0.0

    def to_room(self, points: npt.ArrayLike) -> F64:
        """(n, 3) points of the area's frame in the room."""
        local = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        return np.asarray(arithmetic.turned(local, about_z(self.yaw_deg)) + self.centre)

    @property
    def corners(self) -> F64:
        """(8, 3) corners in the room of what lies over the area, up to its height."""
        x, y = self.half
        return self.to_room(corners([(-x, -y, 0.0), (x, y, self.height_m)]))

    def lattice(self, pitch_m: float) -> F64:
        """(nx, ny, 2) x and y of a lattice over the area, in its frame; its outermost points lie on the edges."""
        nx, ny = (max(2, round(2 * h / pitch_m) + 1) for h in self.half)
        x, y = np.linspace(-self.half[0], self.half[0], nx), np.linspace(-self.half[1], self.half[1], ny)
        return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)

    def part(self, low: npt.ArrayLike, high: npt.ArrayLike, seen_from_m: float = 0.0) -> Area:
        """The part between two corners given in the area's frame."""
        (x0, y0), (x1, y1) = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        x, y, z = self.to_room([(x0 + x1) / 2, (y0 + y1) / 2, 0.0])[0]
        half = (float(x1 - x0) / 2, float(y1 - y0) / 2)
        return Area((float(x), float(y), float(z)), self.yaw_deg, half, self.height_m, self.link, seen_from_m)

    def capacity(self, size: Vec3, gap_m: float) -> int:
        """How many things of a size stand on the area in rows, all turned the same way; 0 if one is too high.

        >>> Area((0, 0, 0), 0, (0.2, 0.15), 0.1).capacity((0.12, 0.28, 0.05), 0.01)
        3
        """
        if size[2] > self.height_m:
            return 0
        width, depth = 2 * self.half[0] + gap_m, 2 * self.half[1] + gap_m
        across = math.floor(width / (size[0] + gap_m)) * math.floor(depth / (size[1] + gap_m))
        along = math.floor(width / (size[1] + gap_m)) * math.floor(depth / (size[0] + gap_m))
        return max(across, along)

    def spots(self, side_m: float) -> list[Spot]:
        """Spots that share the area evenly, each about a side long; at least one."""
        nx, ny = (max(1, math.floor(2 * h / side_m)) for h in self.half)
        x = (np.arange(nx) + 0.5) / nx * 2 * self.half[0] - self.half[0]
        y = (np.arange(ny) + 0.5) / ny * 2 * self.half[1] - self.half[1]
        radius = min(self.half[0] / nx, self.half[1] / ny)
        points = self.to_room([(a, b, 0.0) for b in y for a in x])
        return [Spot((float(p[0]), float(p[1]), float(p[2])), radius, self.height_m) for p in points]


def largest_rectangle(mask: npt.NDArray[np.bool_]) -> tuple[int, int, int, int] | None:
    """Row and column of the first, and of the last, cell of the largest rectangle of true cells; None if all are false.

    >>> largest_rectangle(np.array([[0, 1, 1], [1, 1, 1]], dtype=bool))
    (0, 1, 1, 2)
    """
    rows, columns = mask.shape
    full = np.zeros((rows + 1, columns), dtype=np.int64)
    np.cumsum(mask, axis=0, out=full[1:])
    top, bottom = np.triu_indices(rows)
    heights = bottom - top + 1
    is_full = full[bottom + 1] - full[top] == heights[:, None]
    width = np.zeros(len(top), dtype=np.int64)
    best, found = 0, None
    for column in range(columns):  # of each band of rows at once, how many full columns end here
        width = np.where(is_full[:, column], width + 1, 0)
        size = heights * width
        at = int(size.argmax())
        if size[at] > best:
            best, found = int(size[at]), (int(top[at]), column - int(width[at]) + 1, int(bottom[at]), column)
    return found
