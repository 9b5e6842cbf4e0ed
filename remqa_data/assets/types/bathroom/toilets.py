"""Toilets: a real bowl, a seat, a hinged lid, and a cistern or a ledge to put things on."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.geometry.types import F64

WATER = Material("glass", "blue", (0.66, 0.80, 0.86), gloss=0.9)
LEDGE_M = 0.75
"""A wider box has a wall-to-wall ledge instead of a cistern."""
SHELF = 0.60
"""Height of the water as a share of the rim's: a film over a flat floor, as in a washout toilet; things rest on it."""


def toilet(b: Builder) -> None:
    """A toilet: rounded close-coupled, skirted and square, with a wooden seat, or before a boxed-in ledge."""
    glaze = materials.WHITE_CERAMIC
    seat = b.by_variant(
        (
            materials.WHITE_PLASTIC,
            materials.WHITE_PLASTIC,
            b.pick((materials.OAK, materials.WALNUT)),
            b.pick((materials.BLACK_PLASTIC, materials.WHITE_PLASTIC)),
        )
    )
    ledge = b.w > LEDGE_M or b.variant == 3
    width = min(0.78 * b.w, 0.46)
    back_d = min(0.24 * b.d, 0.26)
    rim_z = min(0.44 * b.h, 0.46)
    back_y = b.d / 2 - back_d
    length = b.d - back_d + 0.02
    power = b.by_variant((2.0, 3.2, 2.0, 2.5))
    shape = _Bowl(width, length, (back_y + 0.02 - b.d / 2) / 2, power)
    if ledge:
        _ledge(b, back_d)
    else:
        _cistern(b, glaze, back_d, rim_z)
    hinge_y = back_y - min(0.13, 0.16 * b.d)
    _bowl(b, shape, rim_z, hinge_y - 0.05, glaze)
    lid_z = rim_z + 0.022
    front = shape.front
    deck = back_y + 0.03 - (hinge_y - 0.04)
    b.box((0.8 * width, deck, 0.05), (0, back_y + 0.03 - deck / 2, rim_z - 0.026), glaze, radius=0.012, segments=2)
    ring = shape.outline(1.0, hinge_y + 0.005)
    hole = shape.outline(0.66, hinge_y - 0.06)
    b.add(primitives.prism(ring, 0.018, [hole]), seat, (0, 0, rim_z + 0.011))
    for x in (-0.09, 0.09):
        b.cylinder(
            0.014, 0.05, (x * width / 0.4, hinge_y + 0.012, lid_z), materials.CHROME, axis="x", sections=10, solid=False
        )
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(95)), origin=(0, hinge_y, lid_z)):
        b.add(primitives.prism(shape.outline(1.01, hinge_y), 0.016), seat, (0, 0, lid_z + 0.009))
        b.solid((0.9 * width, hinge_y - front, 0.016), (0, (hinge_y + front) / 2, lid_z + 0.009))
    b.looks_like(glaze)


class _Bowl:
    """The plan of the bowl: an ellipse or rounder rectangle of a width and length around a centre."""

    def __init__(self, width: float, length: float, y: float, power: float) -> None:
        self.width, self.length, self.y, self.power = width, length, y, power

    @property
    def front(self) -> float:
        return self.y - self.length / 2

    def outline(self, scale: float, back: float | None = None) -> F64:
        """(28, 2) points of the plan, scaled about its centre and cut off at `back`."""
        points: F64 = primitives.ellipse(self.width * scale, self.length * scale, 28, self.power) + np.array(
            [0.0, self.y]
        )
        if back is not None:
            points[:, 1] = np.minimum(points[:, 1], back)
        return points

    def ring(self, scale: float, z: float, shift: float = 0.0, back: float | None = None) -> F64:
        """(28, 3) points at a height."""
        points = self.outline(scale, None if back is None else back - shift) + np.array([0.0, shift])
        return np.column_stack([points, np.full(28, z)])


def _bowl(b: Builder, shape: _Bowl, top: float, hollow_back: float, glaze: Material) -> None:
    back = 0.14 * shape.length
    profile: tuple[tuple[float, float, float], ...]
    if b.variant in (1, 3):  # skirted down to the floor
        profile = ((0.86, 0.0, 0.3), (0.88, 0.3, 0.2), (0.95, 0.75, 0.05), (1.0, 0.93, 0.0), (1.0, 1.0, 0.0))
    else:
        profile = (
            (0.72, 0.0, 0.9),
            (0.66, 0.06, 0.9),
            (0.56, 0.3, 0.9),
            (0.66, 0.52, 0.6),
            (0.90, 0.8, 0.12),
            (1.0, 0.94, 0.0),
            (1.0, 1.0, 0.0),
        )
    rings = [shape.ring(scale, z * top, shift * back) for scale, z, shift in profile]
    b.add(primitives.loft(rings, capped=False), glaze)
    water = SHELF * top
    inside = ((0.02, SHELF - 0.004), (0.57, SHELF - 0.004), (0.63, 0.66), (0.69, 0.8), (0.72, 0.92), (0.72, 1.0))
    hollow = [shape.ring(scale, z * top, 0.2 * back * (1 - z) / 0.5, hollow_back)[::-1] for scale, z in inside]
    b.add(primitives.loft(hollow, capped=False), glaze)
    b.add(primitives.loft([rings[-1], hollow[-1][::-1]], capped=False), glaze)
    middle = shape.y + 0.16 * back
    film = shape.outline(0.58, hollow_back - 0.16 * back) + np.array([0.0, 0.16 * back])
    b.add(primitives.prism(film, 0.003), WATER, (0, 0, water - 0.0018))
    w, long, y, deep = shape.width, shape.length, shape.y, top - water
    b.solid((0.6 * w, 0.9 * long, water), (0, y, water / 2))
    wall = 0.2  # of the bowl's width and length, so that things stay over the flat floor
    for side in (-1, 1):
        b.solid((wall * w, 0.8 * long, deep), (side * (0.5 - wall / 2) * w, y, top - deep / 2))
        b.solid((0.6 * w, wall * long, deep), (0, y + side * (0.5 - wall / 2) * long, top - deep / 2))
    b.space("bowl", (0.4 * w, 0.38 * long, deep), (0, middle, top - deep / 2), enclosed=True)


def _cistern(b: Builder, glaze: Material, deep: float, rim_z: float) -> None:
    low = 0.86 * rim_z
    lid = 0.035
    y = b.d / 2 - deep / 2
    soft = b.by_variant((0.035, 0.008, 0.02, 0.02))
    width = b.w - 0.03
    b.box((width, deep - 0.016, b.h - lid - low), (0, y + 0.004, (b.h - lid + low) / 2), glaze, radius=soft, segments=3)
    b.box((b.w, deep, lid), (0, y, b.h - lid / 2), glaze, radius=min(soft, 0.014), segments=2)
    b.box((0.42 * b.w, deep - 0.02, low + 0.03), (0, y + 0.005, (low + 0.03) / 2), glaze, radius=0.02, segments=2)
    if b.variant == 2:
        b.box((b.w - 0.012, deep - 0.006, 0.018), (0, y + 0.001, b.h - lid - 0.012), glaze, radius=0.006, solid=False)
        arm = [
            (-0.36 * b.w, y - deep / 2 + 0.014, b.h - 0.11),
            (-0.36 * b.w, y - deep / 2 - 0.02, b.h - 0.11),
            (-0.2 * b.w, y - deep / 2 - 0.024, b.h - 0.118),
        ]
        b.add(primitives.tube(np.array(arm), (0.013, 0.009, 0.007), 8), materials.CHROME)
        b.space("cistern", (b.w - 0.02, deep - 0.01, 0.4), (0, y, b.h + 0.2))
        return
    button = b.by_variant((0.024, 0.03, 0.024, 0.024))
    b.cylinder(button, 0.006, (0, y, b.h - 0.001), materials.CHROME, sections=16, solid=False)
    b.space("cistern", (b.w - 0.02, deep - 0.01, 0.4), (0, y, b.h + 0.2))


def _ledge(b: Builder, deep: float) -> None:
    """A boxed-in cistern from wall to wall, with a board on top and a flush plate in front."""
    front = b.pick(
        (
            materials.WHITE_WOOD,
            materials.GRAY_WOOD,
            Material("ceramic", "white", (0.92, 0.93, 0.93), "tile", 0.4, 0.3),
            Material("ceramic", "gray", (0.60, 0.64, 0.66), "tile", 0.4, 0.3),
        )
    )
    board = b.pick((materials.OAK, materials.WALNUT, materials.WHITE_WOOD))
    y, top = b.d / 2 - deep / 2, 0.025
    b.box((b.w - 0.01, deep - 0.015, b.h - top), (0, y + 0.0075, (b.h - top) / 2), front)
    b.box((b.w, deep, top), (0, y, b.h - top / 2), board, radius=0.004)
    face = b.d / 2 - deep + 0.015
    z = 0.80 * b.h
    b.box((0.22, 0.008, 0.14), (0, face - 0.004, z), materials.CHROME, radius=0.003, solid=False)
    for x in (-0.045, 0.045):
        b.box((0.07, 0.004, 0.09), (x, face - 0.01, z), materials.WHITE_PLASTIC, radius=0.001, solid=False)
    b.space("ledge", (b.w - 0.02, deep - 0.01, 0.4), (0, y, b.h + 0.2))


KINDS = {"Toilet": Kind(toilet)}
