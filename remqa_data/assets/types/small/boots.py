"""Pairs of boots."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import RUBBER, SHADOW_GAP, paint
from remqa_data.assets.mesh import primitives
from remqa_data.geometry.types import F64

LINING = paint("gray", "fabric", 0.0, (0.20, 0.19, 0.18))
SHOE = paint("brown", "rubber", 0.3, (0.30, 0.20, 0.14))
FUR = materials.fabric("white", "carpet", 0.08, (0.93, 0.90, 0.84))
YELLOW_LACE = paint("yellow", "fabric", 0.0, (0.85, 0.70, 0.35))

_CORNERS = 14
_HEIGHTS = np.array([0.0, 0.07, 0.13, 0.18, 0.25, 0.33, 0.6, 1.0])
"""Where a boot's outline is given, as fractions of its height: sole, toes, instep, ankle, shaft."""


def boots(b: Builder) -> None:
    """A pair of boots: rubber wellingtons, leather with a heel, laced with a thick sole, or lined with fur."""
    upper = b.by_variant(
        (
            paint(b.pick(("green", "yellow", "red", "blue")), "rubber", 0.5),
            b.pick(materials.LEATHERS[:2]),
            b.pick(materials.LEATHERS[:2]),
            b.pick(materials.FABRICS[1:3]),
        )
    )
    for side in (-1, 1):
        x = side * 0.255 * b.w
        (_wellington, _riding_boot, _laced_boot, _winter_boot)[b.variant](b, x, upper)
        b.solid((0.42 * b.w, 0.95 * b.d, 0.25 * b.h), (x, 0, 0.125 * b.h))
        b.solid((0.40 * b.w, 0.62 * b.d, 0.75 * b.h), (x, 0.17 * b.d, 0.625 * b.h))
    b.looks_like(upper)


def _wellington(b: Builder, x: float, upper: Material) -> None:
    boot = _Boot(b, x, toe=2.3, shaft=0.66, flare=1.08)
    boot.sole(0.05, RUBBER)
    boot.skin(0.04, 0.98, upper)
    pale = materials.tinted(upper, 1.35)
    boot.band(0.16, 0.19, pale)
    boot.band(0.93, 1.0, pale)
    boot.mouth()


def _riding_boot(b: Builder, x: float, upper: Material) -> None:
    boot = _Boot(b, x, toe=1.7, shaft=0.58, flare=1.16)
    boot.sole(0.035, materials.WALNUT)
    heel = (0.30 * b.w, 0.26 * b.d, 0.075 * b.h)
    b.box(heel, (x, 0.34 * b.d, heel[2] / 2), materials.WALNUT, radius=0.004, solid=False)
    boot.skin(0.03, 1.0, upper)
    for z in (0.24, 0.88):
        boot.band(z, z + 0.025, materials.tinted(upper, 0.6))
        outside = boot.outline(z)[:, 0]
        at = float(outside.max() if x > 0 else outside.min())
        b.box(
            (0.010, 0.12 * b.d, 0.034 * b.h),
            (at, boot.outline(z)[:, 1].mean(), (z + 0.0125) * b.h),
            materials.BRASS,
            solid=False,
        )
    boot.mouth()


def _laced_boot(b: Builder, x: float, upper: Material) -> None:
    boot = _Boot(b, x, toe=2.4, shaft=0.60, flare=1.04)
    boot.sole(0.075, RUBBER)
    boot.skin(0.06, 0.98, upper)
    boot.band(0.94, 1.0, materials.tinted(upper, 0.55))
    boot.mouth()
    lace = materials.PAPER if upper.color == "black" else YELLOW_LACE
    for i in range(12):
        z = 0.32 + 0.10 * (i // 2)
        front = float(boot.outline(z)[:, 1].min())
        slant = primitives.turn("y", 24 if i % 2 else -24)
        b.box((0.17 * b.w, 0.008, 0.012 * b.h), (x, front - 0.001, z * b.h), lace, rotation=slant, solid=False)


def _winter_boot(b: Builder, x: float, upper: Material) -> None:
    boot = _Boot(b, x, toe=2.5, shaft=0.66, flare=1.06)
    boot.sole(0.05, SHADOW_GAP)
    boot.skin(0.04, 0.22, SHOE, grow=1.03)
    boot.skin(0.20, 0.97, upper)
    for z in (0.45, 0.65):
        boot.band(z, z + 0.03, SHOE)
    boot.band(0.86, 1.0, FUR, puff_m=0.012)
    boot.mouth()


class _Boot:
    """One boot with its toes to the front, skinned between outlines at several heights.

    Parameters
    ----------
    b : Builder
        Where to draw.
    x : float
        Middle of the boot in metres.
    toe : float
        How square the toes are: 2 is an ellipse.
    shaft, flare : float
        Depth of the shaft at the ankle as a fraction of the foot's length, and how much wider it is at the top.
    """

    def __init__(self, b: Builder, x: float, *, toe: float, shaft: float, flare: float) -> None:
        self._b, self._x = b, x
        deep = np.array([0.98, 1.0, 0.96, 0.85, shaft * 1.08, shaft, shaft * 1.04, shaft * flare]) * b.d
        wide = np.array([0.92, 1.0, 0.98, 0.93, 0.84, 0.82, 0.87, 0.94 * flare]) * 0.45 * b.w
        rings = []
        for i, z in enumerate(_HEIGHTS):
            plan = primitives.ellipse(min(wide[i], 0.49 * b.w), deep[i], _CORNERS, toe if z < 0.2 else 2.2)
            heel = (b.d - deep[i]) / 2
            rings.append(np.column_stack([plan[:, 0] + x, plan[:, 1] + heel, np.full(_CORNERS, z * b.h)]))
        self._rings = np.array(rings)

    def outline(self, z: float) -> F64:
        """Points around the boot at a fraction of its height, (corners, 3)."""
        i = int(np.clip(np.searchsorted(_HEIGHTS, z) - 1, 0, len(_HEIGHTS) - 2))
        t = (z - _HEIGHTS[i]) / (_HEIGHTS[i + 1] - _HEIGHTS[i])
        return np.asarray(self._rings[i] * (1 - t) + self._rings[i + 1] * t)

    def sole(self, height: float, material: Material) -> None:
        """The sole, up to a fraction of the height."""
        plan = primitives.ellipse(0.45 * self._b.w, self._b.d, _CORNERS, 2.6)
        self._b.add(primitives.prism(plan, height * self._b.h), material, (self._x, 0, height * self._b.h / 2))

    def skin(self, low: float, high: float, material: Material, grow: float = 1.0) -> None:
        """The boot's surface between two fractions of its height."""
        cut = np.unique(np.clip(_HEIGHTS, low, high))
        rings = np.stack([self.outline(float(z)) for z in cut])
        centre = rings.mean(axis=1, keepdims=True)
        self._b.add(primitives.loft((rings - centre) * [grow, grow, 1.0] + centre), material)

    def band(self, low: float, high: float, material: Material, puff_m: float = 0.002) -> None:
        """A strip around the boot that stands out by `puff_m`."""
        rings = []
        for t, puff in ((0.0, 0.3), (0.3, 1.0), (0.7, 1.0), (1.0, 0.3)):
            ring = self.outline(low + t * (high - low))
            centre = ring.mean(axis=0)
            grow = 1 + puff_m * puff / float(np.linalg.norm(ring - centre, axis=1).mean())
            rings.append((ring - centre) * [grow, grow, 1.0] + centre)
        self._b.add(primitives.loft(rings), material)

    def mouth(self) -> None:
        """The dark opening on top."""
        ring = self.outline(1.0)
        centre = ring.mean(axis=0)
        size = np.ptp(ring, axis=0) * 0.88
        opening = primitives.disc(0.5, sections=_CORNERS).scaled((size[0], size[1], 1.0))
        self._b.add(opening, LINING, (float(centre[0]), float(centre[1]), self._b.h + 0.0006))


KINDS = {"Boots": Kind(boots)}
