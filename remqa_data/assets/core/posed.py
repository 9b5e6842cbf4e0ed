"""Drawing things whose longest side may lie along any axis: cutlery in a drawer, a potato on its side."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.mesh.primitives import AXES, Axis, Mesh
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3


class Posed:
    """A drawing board whose y axis is the longest side of the box, wherever that lies.

    It is drawn on like a `Builder`: x and y centred, z from 0 to h.

    Parameters
    ----------
    b : Builder
        Where the drawing goes.
    flat : bool
        Whether z shall be the shortest side. Otherwise z stays up as long as the longest side lies.
    upright : bool
        Whether z, and not y, shall be the longest side.
    slack : float
        How much longer than its usual side another side of the box must be before the thing is turned.

    Attributes
    ----------
    w, d, h : float
        Size along the board's axes in metres.
    stands : bool
        Whether the longest side, along which it is drawn, points up in the box.
    """

    def __init__(self, b: Builder, *, flat: bool = False, upright: bool = False, slack: float = 1.04) -> None:
        size = (b.w, b.d, b.h)
        main = _longest(size, prefer=2 if upright else 1, slack=slack)
        other = (1 if main != 1 else 2) if upright else (2 if main != 2 else 1)
        if flat:
            other = min((i for i in range(3) if i != main), key=lambda i: (size[i], -i))
        columns = np.zeros((3, 3))
        y, z = (other, main) if upright else (main, other)
        columns[y, 1] = 1.0
        columns[z, 2] = 1.0 if z == 2 else -1.0  # what does not point up points to the front or the left
        columns[:, 0] = arithmetic.cross(columns[:, 1], columns[:, 2])
        self._b, self._rotation = b, columns
        self.stands = main == 2
        self._main = main
        self._drawn: list[F64] = []
        self.w, self.d, self.h = (float(v) for v in np.abs(columns.T) @ np.asarray(size))

    def add(self, mesh: Mesh, material: Material, at: Vec3 = (0, 0, 0), *, grain: Axis | None = None) -> None:
        """Draw a mesh."""
        x, y, z = at
        lifted = mesh.moved((x, y, z - self.h / 2)).turned(self._rotation)
        self._drawn += [lifted.vertices.min(axis=0), lifted.vertices.max(axis=0)]
        self._b.add(lifted, material, (0, 0, self._b.h / 2), grain=None if grain is None else self._axis(grain))

    def solid(self, size: Vec3, at: Vec3) -> None:
        """An invisible box for physics only."""
        x, y, z = at
        centre = self._rotation @ [x, y, z - self.h / 2] + [0, 0, self._b.h / 2]
        extent = np.abs(self._rotation @ np.asarray(size))
        self._b.solid(
            (float(extent[0]), float(extent[1]), float(extent[2])),
            (float(centre[0]), float(centre[1]), float(centre[2])),
        )

    def rest(self, across: float = 0.7, along: float = 0.7) -> None:
        """A box for physics, as high as all that is drawn; its plan is a share of it, across and along the length."""
        low, high = np.min(self._drawn, axis=0), np.max(self._drawn, axis=0)
        share = np.full(3, across)
        share[self._main], share[2] = along, 1.0
        size, centre = (high - low) * share, (high + low) / 2 + [0, 0, self._b.h / 2]
        self._b.solid(
            (float(size[0]), float(size[1]), float(size[2])), (float(centre[0]), float(centre[1]), float(centre[2]))
        )

    def _axis(self, axis: Axis) -> Axis:
        names: tuple[Axis, ...] = ("x", "y", "z")
        return names[int(np.argmax(np.abs(self._rotation @ AXES[axis])))]


def _longest(size: Vec3, prefer: int, slack: float) -> int:
    """The longest axis, or the preferred one if no other is longer by more than a factor."""
    longest = int(np.argmax(size))
    return prefer if size[prefer] * slack >= size[longest] else longest
