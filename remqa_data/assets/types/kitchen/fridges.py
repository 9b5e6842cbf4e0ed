"""Fridges: a lit cabinet with glass shelves behind one, two or three doors."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import enamel, materials

TWO_DOORS_M = 0.9
"""A fridge of this width has two doors."""


def fridge(b: Builder) -> None:
    """A fridge: freezer at the bottom, freezer on top, French doors over a drawer, or one tall rounded retro door.

    A wide one has two doors side by side; of a single door, even seeds have the hinge on the left, odd ones on the right.
    """
    body = b.pick(enamel.RETRO if b.variant == 3 else enamel.BODIES)
    metal = materials.CHROME if b.variant == 3 or body is materials.BLACK_METAL else b.pick(materials.METALS[:2])
    reach, thick, kick = 0.045, 0.06, 0.05
    door_y = -b.d / 2 + reach + thick / 2
    front = -b.d / 2 + reach + thick + 0.006
    deep = b.d / 2 - front
    middle = (b.d / 2 + front) / 2
    b.shell((b.w, deep, b.h - kick), (0, middle, (b.h + kick) / 2), 0.03, body)
    b.box((b.w - 0.04, deep - 0.04, kick), (0, middle, kick / 2), materials.SHADOW_GAP)
    split = _fridge_split(b, kick)
    zones = {"fridge": (kick, b.h)}
    if b.variant in (0, 2):
        zones = {"freezer": (kick, split), "fridge": (split, b.h)}
    elif b.variant == 1:
        zones = {"fridge": (kick, split), "freezer": (split, b.h)}
    for name, (low, high) in zones.items():
        drawer = name == "freezer" and b.variant == 2 and all(level > split for level in b.spec.levels)
        floor, top = low + (0.035 if low == kick else 0.015), high - (0.035 if high == b.h else 0.015)
        liner = (b.w - 0.062, deep - 0.031, top - floor + 0.006)
        at = (0.0, middle - 0.0155, (top + floor) / 2)
        b.shell(liner, at, 0.006, enamel.LINER)
        if high < b.h:
            b.box((b.w - 0.062, deep - 0.032, 0.022), (0, middle - 0.015, high), enamel.LINER)
        if drawer:
            _freezer_drawer(b, body, metal, (low, high), (floor, top), door_y, front, thick)
            continue
        _fridge_shelves(b, name, floor, top, front)
        sides = (
            ((-1, -b.w / 2, 0.0), (1, 0.0, b.w / 2))
            if b.variant == 2 or b.w >= TWO_DOORS_M
            else ((1 if b.spec.seed % 2 else -1, -b.w / 2, b.w / 2),)
        )
        if (
            len(sides) == 2
        ):  # a mullion behind the gap between the doors and their rounded edges, where one would look in
            wide = 0.014 + 2 * _edge_radius(b)
            at = (0.0, front - 0.003, (low + high) / 2)
            b.box((wide, 0.004, high - low), at, materials.BLACK_PLASTIC, solid=False)
        for side, x0, x1 in sides:
            _fridge_door(
                b, f"{name} door {side}", body, metal, side, (x0, x1, low + 0.003, high - 0.003), door_y, thick
            )
    b.looks_like(body)


def _edge_radius(b: Builder) -> float:
    """Of the edges of doors, metres."""
    return 0.028 if b.variant == 3 else 0.008


def _fridge_split(b: Builder, kick: float) -> float:
    """Height of the wall between fridge and freezer: near the usual place, but nothing recorded stands in its way."""
    usual = b.h * b.by_variant((0.36, 0.70, 0.30, 0.5))
    levels = b.spec.levels
    options = [usual, *(level - 0.022 for level in levels), *(level + 0.34 for level in levels)]
    clear = [z for z in options if kick + 0.25 < z < b.h - 0.3]
    clear = [z for z in clear if all(not z - 0.33 < level < z + 0.021 for level in levels)]
    low = [z for z in clear if all(level > z for level in levels)] if b.variant == 2 else []
    return min(low or clear or [usual], key=lambda z: abs(z - usual))


def _fridge_shelves(b: Builder, name: str, floor: float, top: float, front: float) -> None:
    levels: list[float] = []
    for level in sorted(b.spec.levels):
        lowest = levels[-1] + 0.03 if levels else floor + 0.02
        if lowest < level < top - 0.08:
            levels.append(level)
    marks = [floor + 0.003, *levels, top]
    for low, high in pairwise(marks):
        room = 0.70 if levels else 0.5
        extra = int((high - low) / 0.34) - 1 if high - low > room else 0
        levels += [low + (high - low) * (i + 1) / (extra + 1) for i in range(extra)]
    y0, y1 = front + 0.11, b.d / 2 - 0.037
    width = b.w - 0.075
    ordered = [floor + 0.003, *sorted(levels)]
    for i, level in enumerate(ordered):
        above = ordered[i + 1] - 0.012 if i + 1 < len(ordered) else top - 0.003
        if i > 0:
            b.box((width, y1 - y0, 0.007), (0, (y0 + y1) / 2, level - 0.0035), materials.CLEAR_GLASS)
            b.box((width, 0.012, 0.018), (0, y0 - 0.006, level - 0.008), materials.WHITE_PLASTIC, solid=False)
        if above - level > 0.08:
            b.space(
                f"{name} shelf {i}",
                (width - 0.02, y1 - y0 - 0.02, above - level),
                (0, (y0 + y1) / 2, (level + above) / 2),
                enclosed=True,
            )


def _fridge_door(
    b: Builder,
    name: str,
    body: Material,
    metal: Material,
    side: int,
    extent: tuple[float, float, float, float],
    y: float,
    thick: float,
) -> None:
    """A door with a lining and racks inside; `side` is where its hinge is (-1 left, 1 right).

    It turns about its outer corner, so that it stays before its own fridge. Two doors need more of a gap between them.
    """
    x0, x1, z0, z1 = extent
    gap = 0.004 if x1 - x0 > 0.9 * b.w else 0.009
    x, z, width, height = (x0 + x1) / 2, (z0 + z1) / 2, x1 - x0 - gap, z1 - z0
    back, front = y + thick / 2, y - thick / 2
    origin = (x + side * width / 2, front, z)
    with b.link(name, "revolute", axis="z" if side > 0 else "-z", upper=float(np.radians(105)), origin=origin):
        b.box((width, thick, height), (x, y, z), body, radius=_edge_radius(b), segments=2)
        b.box((width - 0.085, 0.016, height - 0.085), (x, back + 0.008, z), enamel.LINER, solid=False)
        for rack in np.arange(z0 + 0.12, z1 - 0.2, max(0.3, height / 4)):
            b.shell(
                (width - 0.12, 0.085, 0.08),
                (x, back + 0.0585, float(rack) + 0.04),
                0.005,
                materials.CLEAR_GLASS,
                open_side="z",
            )
        grip = x - side * (width / 2 - 0.045)
        if b.variant == 3:
            b.box((0.035, 0.012, 0.16), (grip, front - 0.006, z0 + 0.52 * height), metal, radius=0.005, solid=False)
            b.box(
                (0.16, 0.016, 0.026),
                (grip + side * 0.06, front - 0.034, z0 + 0.52 * height),
                metal,
                radius=0.008,
                solid=False,
            )
            b.box((0.02, 0.03, 0.02), (grip, front - 0.02, z0 + 0.52 * height), metal, solid=False)
            b.box((0.2, 0.006, 0.035), (x, front - 0.003, z1 - 0.16), metal, radius=0.002, solid=False)
        else:
            length = min(0.62, 0.6 * height)
            low = z0 < 0.1 or (b.variant == 1 and z1 < b.h - 0.1)
            at = z1 - 0.06 - length / 2 if low else z0 + 0.06 + length / 2
            if b.variant == 1:  # a flat bar
                b.box((0.026, 0.012, length), (grip, front - 0.039, at), metal, radius=0.004, segments=2, solid=False)
                for end in (-0.4, 0.4):
                    b.box((0.018, 0.036, 0.03), (grip, front - 0.017, at + end * length), metal, solid=False)
            else:
                b.handle((grip, front, at), length, metal, axis="z", reach=0.045, radius=0.009)
        if b.variant == 2 and side < 0:  # water dispenser
            b.box(
                (0.17, 0.004, 0.30),
                (x - 0.01, front - 0.002, z + 0.04),
                materials.BLACK_PLASTIC,
                radius=0.001,
                solid=False,
            )
            b.box((0.13, 0.004, 0.03), (x - 0.01, front - 0.005, z + 0.16), enamel.DISPLAY, solid=False)
            b.box((0.13, 0.02, 0.012), (x - 0.01, front - 0.012, z - 0.08), materials.STEEL, solid=False)


def _freezer_drawer(
    b: Builder,
    body: Material,
    metal: Material,
    outside: tuple[float, float],
    inside: tuple[float, float],
    y: float,
    front: float,
    thick: float,
) -> None:
    low, high = outside
    floor, top = inside
    with b.link("freezer drawer", "prismatic", axis="-y", upper=0.62 * b.d):
        b.box((b.w - 0.004, thick, high - low - 0.006), (0, y, (low + high) / 2), body, radius=0.008, segments=2)
        b.handle((0, y - thick / 2, high - 0.07), min(0.7, 0.7 * b.w), metal, reach=0.045, radius=0.009)
        tall = 0.7 * (top - floor)
        deep = b.d / 2 - 0.06 - front
        b.shell(
            (b.w - 0.09, deep, tall),
            (0, front + deep / 2, floor + 0.012 + tall / 2),
            0.006,
            enamel.LINER,
            open_side="z",
        )
        size = (b.w - 0.11, deep - 0.02, top - floor - 0.02)
        b.space("freezer drawer", size, (0, front + deep / 2, floor + 0.018 + size[2] / 2), enclosed=True)


KINDS = {"Fridge": Kind(fridge)}
