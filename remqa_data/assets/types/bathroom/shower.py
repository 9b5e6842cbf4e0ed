"""What makes a shower: curtains, glass doors, fixed glass, and the shower itself."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.geometry.types import Rect

METALS = (materials.CHROME, materials.CHROME, materials.CHROME, materials.BLACK_METAL, materials.BRASS)
PANE_M = 0.01
"""Thickness of the glass."""
WIDE_M = 0.35
"""A glass box that is larger than this both ways is a corner of two panes; a door that thick is bent."""
SHEEN = Material("glass", "white", (0.95, 0.98, 0.98), gloss=0.4)


def shower_curtain(b: Builder) -> None:
    """A curtain in folds that slide together along a rail: plain, striped, with a coloured hem, or patterned."""
    cloth = _curtain_cloth(b)
    hem = b.by_variant((cloth, cloth, b.pick(materials.FABRICS), cloth))
    metal = b.pick(METALS)
    with b.quarter_turned(b.w < 0.8 * b.d):
        rail = 0.012
        b.cylinder(rail, b.w, (0, 0, b.h - rail), metal, axis="x", sections=10, solid=False)
        folds = 4
        pitch = b.w / folds
        for i in range(folds):
            slide = (folds - 1 - i) * 0.86 * pitch
            x = (i - (folds - 1) / 2) * pitch
            with b.link(f"fold {i}", "prismatic", axis="x", upper=max(slide, 0.001)):
                _fold(b, cloth, hem, x, pitch, b.d / 2, b.h - 0.07, i)
                b.add(
                    primitives.revolve(_RING, 10).scaled((0.03, 0.03, 0.03)).pointed("x"),
                    metal,
                    (x, 0, b.h - rail - 0.012),
                )
                b.solid((pitch, 0.5 * b.d, b.h - 0.07), (x, 0, (b.h - 0.07) / 2))
    b.looks_like(cloth)


_RING = [(0.75, -0.12), (1.0, -0.12), (1.0, 0.12), (0.75, 0.12), (0.75, -0.12)]


def _curtain_cloth(b: Builder) -> Material:
    plain = b.pick(materials.FABRICS)
    white = materials.fabric("white", rgb=(0.92, 0.92, 0.90))
    shades = {"blue": (0.42, 0.58, 0.75), "green": (0.50, 0.68, 0.54), "red": (0.80, 0.42, 0.40)}
    color = b.pick(tuple(shades))
    striped = Material("fabric", color, shades[color], "wallpaper_stripe", 0.2)
    damask = Material("fabric", plain.color, plain.rgb, "wallpaper_damask", 0.4)
    return b.by_variant((plain, striped, white, damask))


def _fold(
    b: Builder, cloth: Material, hem: Material, x: float, pitch: float, reach: float, top: float, index: int
) -> None:
    """One wave of the cloth, from front to back and to the front again, deeper towards the floor."""
    t = np.linspace(0, 1, 13)
    swing = (1.0, 0.5, 0.8, 0.35)[index % 4]
    wave = 1 - (1 + swing) * np.sin(np.pi * t) ** 2
    bands = ((0.0, 0.14), (0.14, top)) if hem is not cloth else ((0.0, top),)
    for (low, high), material in zip(bands, (hem, cloth) if len(bands) == 2 else (cloth,), strict=True):
        z = np.linspace(low, high, 2 if high - low < 0.2 else 5)
        share = 0.25 + 0.75 * np.sqrt(np.clip((top - z) / top, 0, 1))
        depth = np.outer(share, wave) * (reach - 0.004)
        across, up = np.meshgrid(x + (t - 0.5) * pitch, z)
        across = across + 0.1 * pitch * np.outer(np.sin(3 * z / top), np.sin(2 * np.pi * t))
        # `sheet` thickens along its z, so the cloth is laid flat, made, and stood up again.
        mesh = primitives.sheet(across, up, -depth, 0.006).turned(primitives.turn("x", 90))
        b.add(mesh, material)


def shower_door(b: Builder) -> None:
    """A glass door on a hinge: framed, frameless, black grid, or frosted in the middle."""
    metal = (
        materials.BLACK_METAL if b.variant == 2 else b.pick((materials.CHROME, materials.BRASS, materials.WHITE_METAL))
    )
    with b.quarter_turned(b.w < b.d):
        bent = b.d > WIDE_M
        reach = min(0.3 * b.d, 0.03)
        y = 0.0 if not bent else b.d / 2 - 0.03
        with b.link("door", "revolute", axis="-z", upper=float(np.radians(95)), origin=(-b.w / 2, y, 0)):
            if bent:
                _bent_pane(b, metal)
            else:
                _pane(b, (-b.w / 2, 0, b.w / 2, b.h), y, metal, b.d - 2 * reach)
                b.solid((b.w, b.d - 2 * reach, b.h), (0, y, b.h / 2))
                x = b.w / 2 - 0.07
                for side in (-1, 1):
                    _bar(b, metal, (x, side * (b.d / 2 - 0.008), 0.5 * b.h), min(0.5, 0.25 * b.h))
            for z in (0.12 * b.h, 0.88 * b.h):
                b.box((0.05, min(0.03, 0.7 * b.d), 0.07), (-b.w / 2 + 0.025, y, z), metal, radius=0.003, solid=False)
    b.looks_like(materials.CLEAR_GLASS if b.variant != 3 else materials.FROSTED_GLASS)


def shower_glass(b: Builder) -> None:
    """Fixed shower glass, a pane or a corner of two in front and right: framed, frameless, grid, or frosted."""
    metal = (
        materials.BLACK_METAL if b.variant == 2 else b.pick((materials.CHROME, materials.BRASS, materials.WHITE_METAL))
    )
    if min(b.w, b.d) < WIDE_M:
        with b.quarter_turned(b.w < b.d):
            _wall_of_panes(b, -b.w / 2, b.w / 2, 0.0, metal, min(b.d, 0.06))
            if b.d > 0.06:
                b.box((b.w, b.d, 0.02), (0, 0, 0.01), metal)
    else:
        thick = 0.05
        _wall_of_panes(b, -b.w / 2, b.w / 2, -b.d / 2 + thick / 2, metal, thick)
        with b.quarter_turned():  # along the right side: x runs towards the back there
            _wall_of_panes(b, -b.w / 2 + thick, b.w / 2, -b.d / 2 + thick / 2, metal, thick)
    b.looks_like(materials.CLEAR_GLASS if b.variant != 3 else materials.FROSTED_GLASS)


def shower_head(b: Builder) -> None:
    """A shower: rain head on a riser or slide bar, round or square, some with a tray; a short box holds an arm."""
    metal = b.pick(METALS)
    wall = b.d / 2
    if b.h < 0.5:
        _arm(b, metal, wall, 0.6 * b.h)
        return
    pipe = 0.012
    x = 0.0
    rain = b.w > 0.2
    bar_y = wall - 0.06
    top = b.h - 0.02 if rain else b.h - 0.004
    low = 0.12 * b.h
    if b.variant == 3:
        b.box((1.8 * pipe, 1.8 * pipe, top - low), (x, bar_y, (top + low) / 2), metal, radius=0.003)
    else:
        b.cylinder(pipe, top - low, (x, bar_y, (top + low) / 2), metal, sections=10)
    if b.variant == 2:
        b.box((min(0.2, b.w), 0.09, 0.008), (x, bar_y - 0.03, 0.36 * b.h), materials.CLEAR_GLASS, radius=0.003)
    for z in (low + 0.02, top - (0.35 if rain else 0.03)):
        b.cylinder(0.008, 0.06, (x, wall - 0.03, z), metal, axis="y", sections=8, solid=False)
        b.cylinder(0.026, 0.012, (x, wall - 0.006, z), metal, axis="y", sections=14, solid=False)
    if rain:
        _rain_head(b, metal, bar_y, top, pipe)
        _mixer(b, metal, bar_y, low)
    _hand_shower(b, metal, bar_y, low, rain)
    b.looks_like(metal)


def _rain_head(b: Builder, metal: Material, y: float, top: float, pipe: float) -> None:
    """A wide head under a bent arm."""
    size = min(b.w, b.d - 0.02)
    front = -b.d / 2 + size / 2
    path = [
        (0, y, top - 0.06),
        (0, y - 0.012, top - 0.02),
        (0, y - 0.05, top),
        (0, front + 0.02, top),
        (0, front, top - 0.02),
        (0, front, top - 0.05),
    ]
    b.add(primitives.tube(np.array(path), pipe, 8), metal)
    z = top - 0.06
    stretch = (b.w / size, 1.0, 1.0)
    if b.variant in (1, 3):
        b.box((b.w, size, 0.014), (0, front, z), metal, radius=0.004)
        b.box((0.9 * b.w, 0.9 * size, 0.004), (0, front, z - 0.008), materials.GRAY_PLASTIC, solid=False)
    else:
        r = size / 2
        disc = [(0, -0.008), (r, -0.008), (r, 0), (0.9 * r, 0.008), (0.25 * r, 0.02), (0, 0.022)]
        b.add(primitives.revolve(disc, 24).scaled(stretch), metal, (0, front, z), solid=True)
        face = primitives.cylinder(0.86 * r, 0.003, sections=20).scaled(stretch)
        b.add(face, materials.GRAY_PLASTIC, (0, front, z - 0.0095))


def _mixer(b: Builder, metal: Material, y: float, z: float) -> None:
    """A thermostat bar with a knob at each end."""
    half = min(0.14, 0.42 * b.w)
    b.cylinder(0.022, 2 * half, (0, y, z), metal, axis="x", sections=14)
    for side in (-1, 1):
        b.cylinder(
            0.028,
            0.04,
            (side * half, y, z),
            materials.BLACK_PLASTIC if b.variant > 1 else metal,
            axis="x",
            sections=14,
            solid=False,
        )
        b.cylinder(0.026, 0.04, (side * half * 0.5, b.d / 2 - 0.02, z), metal, axis="y", sections=12, solid=False)


def _hand_shower(b: Builder, metal: Material, y: float, low: float, rain: bool) -> None:
    """A hand shower on a slider, and its hose in a loop down to the water."""
    z = 0.55 * b.h if rain else 0.8 * b.h
    radius = min(0.055, 0.46 * b.w)
    b.box((0.05, 0.05, 0.05), (0, y - 0.012, z), metal, radius=0.01, segments=2, solid=False)
    tip_y = -b.d / 2 + 0.045 if not rain else y - 0.12
    grip = [(0, y - 0.01, z - 0.10), (0, y - 0.05, z), (0, tip_y + 0.03, z + 0.11)]
    b.add(primitives.tube(np.array(grip), (0.011, 0.014, 0.018), 8), metal)
    tilt = primitives.turn("x", 35)
    if b.variant in (1, 3):
        head = primitives.rounded_box((2 * radius, 1.5 * radius, 0.02), 0.006, 1)
        face = primitives.box((1.6 * radius, 1.2 * radius, 0.003)).moved((0, 0, -0.0105))
    else:
        head = primitives.revolve([(0, -0.01), (radius, -0.01), (radius, 0), (0.5 * radius, 0.016), (0, 0.02)], 16)
        face = primitives.cylinder(0.8 * radius, 0.003, sections=14).moved((0, 0, -0.0105))
    at = (0.0, tip_y + 0.01, z + 0.12)
    b.add(head.turned(tilt), metal, at)
    b.add(face.turned(tilt), materials.GRAY_PLASTIC, at)
    start, end = z - 0.10, low
    pull = 0.012 - float(np.sqrt(start * end))  # so that the loop just reaches the bottom
    side = min(0.3, 0.9 * b.w) * (1 if b.variant % 2 == 0 else -1)
    t = np.linspace(0, 1, 15)
    hang = (1 - t) ** 2 * start + 2 * t * (1 - t) * pull + t**2 * end
    hose = np.column_stack([2 * t * (1 - t) * side, np.full(15, y - 0.02), np.maximum(hang, 0.008)])
    b.add(
        primitives.tube(hose, 0.008, 6),
        materials.STEEL if metal is not materials.BLACK_METAL else materials.BLACK_METAL,
    )
    if not rain:
        b.cylinder(0.02, 0.07, (0, b.d / 2 - 0.04, low), metal, axis="y", sections=12, solid=False)


def _arm(b: Builder, metal: Material, wall: float, z: float) -> None:
    radius = min(0.4 * b.w, 0.3 * b.d, 0.45 * b.h, 0.1)
    path = [(0, wall, z), (0, 0.4 * wall, b.h - 0.012), (0, -wall + radius, b.h - 0.012), (0, -wall + radius, 0.03)]
    b.add(primitives.tube(np.array(path), 0.011, 8), metal)
    b.cylinder(b.w / 2, 0.012, (0, wall - 0.006, z), metal, axis="y", sections=16, solid=False)
    head = [(0, 0), (radius, 0), (radius, 0.01), (0.3 * radius, 0.05), (0, 0.05)]
    b.add(primitives.revolve(head, 18), metal, (0, -wall + radius, 0), solid=True)
    b.looks_like(metal)


def _wall_of_panes(b: Builder, x0: float, x1: float, y: float, metal: Material, thick: float) -> None:
    """Panes side by side, none wider than 1.3 m."""
    count = max(1, int(np.ceil((x1 - x0) / 1.3)))
    edges = np.linspace(x0, x1, count + 1)
    for left, right in pairwise(edges):
        _pane(b, (float(left), 0, float(right), b.h), y, metal, thick)
    b.solid((x1 - x0, thick, b.h), ((x0 + x1) / 2, y, b.h / 2))


def _pane(b: Builder, rect: Rect, y: float, metal: Material, thick: float) -> None:
    """One pane with its frame, or with clamps at its corners; `rect` is x0, z0, x1, z1."""
    x0, z0, x1, z1 = rect
    x, z, w, h = (x0 + x1) / 2, (z0 + z1) / 2, x1 - x0, z1 - z0
    deep = max(min(thick, 0.06), 0.008)
    pane = min(PANE_M, 0.6 * deep)
    if b.variant == 1:
        frame = 0.0
        for side in (-1, 1):
            for end in (-1, 1):
                at = (x + side * (w / 2 - 0.024), y, z + end * (h / 2 - 0.034))
                b.box((0.05, deep, 0.07), at, metal, radius=0.004, solid=False)
    else:
        frame = b.by_variant((0.035, 0.0, 0.03, 0.022))
        for side in (-1, 1):
            b.box((frame, deep, h), (x + side * (w - frame) / 2, y, z), metal, solid=False)
            b.box((w - 2 * frame, deep, frame), (x, y, z + side * (h - frame) / 2), metal, solid=False)
    w, h = w - 2 * frame, h - 2 * frame
    if b.variant == 3:  # frosted, clear above and below
        band, edge = 0.62 * h, 0.19 * h
        b.box((w, pane, band), (x, y, z), materials.FROSTED_GLASS, solid=False)
        for side in (-1, 1):
            b.box((w, pane, edge), (x, y, z + side * (band + edge) / 2), materials.CLEAR_GLASS, solid=False)
        return
    b.box((w, pane, h), (x, y, z), materials.CLEAR_GLASS, solid=False)
    for face in (-1, 1):
        _sheen(b, x, z, w, h, y + face * (pane / 2 + 0.0008))
    if b.variant == 2:
        for k in (-0.25, 0.0, 0.25):
            b.box((w, 0.7 * deep, 0.02), (x, y, z + k * h), metal, solid=False)
        b.box((0.02, 0.6 * deep, h), (x, y, z), metal, solid=False)


def _sheen(b: Builder, x: float, z: float, width: float, height: float, y: float) -> None:
    """Two slanting light streaks that make a pane read as glass."""
    slant = 0.5 * min(width, height)
    for at, broad in ((-0.12, 0.11), (0.10, 0.04)):
        low, high = (at - 0.2) * width, (at + 0.2) * width
        outline = [
            (low, -0.5 * slant),
            (low + broad * width, -0.5 * slant),
            (high + broad * width, 0.5 * slant),
            (high, 0.5 * slant),
        ]
        streak = primitives.prism(outline, 0.0008).turned(primitives.turn("x", 90))
        b.add(streak, SHEEN, (x, y, z + 0.18 * height))


def _bent_pane(b: Builder, metal: Material) -> None:
    """A pane bent round to the front, as on a quarter-round shower."""
    t = np.linspace(0, np.pi, 13)
    deep = b.d - 0.05
    for z0, z1, thick, material in (
        (0.0, 0.04, 0.04, metal),
        (0.04, b.h - 0.04, PANE_M, materials.CLEAR_GLASS),
        (b.h - 0.04, b.h, 0.04, metal),
    ):
        points = []
        for offset in (0.02 + thick / 2, 0.02 - thick / 2 + 0.0):
            points.append(
                np.column_stack(
                    [-np.cos(t) * (b.w / 2 - 0.02 + offset - 0.02), b.d / 2 - 0.03 - np.sin(t) * (deep + offset - 0.02)]
                )
            )
        b.add(primitives.prism(np.vstack([points[0], points[1][::-1]]), z1 - z0), material, (0, 0, (z0 + z1) / 2))
    for side in (-1, 1):
        b.box((0.04, 0.05, b.h), (side * (b.w / 2 - 0.02), b.d / 2 - 0.025, b.h / 2), metal, solid=False)
    b.solid((b.w, 0.3 * b.d, b.h), (0, -0.2 * b.d, b.h / 2))
    _bar(b, metal, (0.36 * b.w, -0.34 * b.d, 0.5 * b.h), 0.3)


def _bar(b: Builder, metal: Material, at: tuple[float, float, float], length: float) -> None:
    """A vertical bar handle centred at a point, with two feet towards y = 0."""
    x, y, z = at
    b.cylinder(0.008, length, at, metal, sections=8, solid=False)
    for sign in (-1, 1):
        b.cylinder(
            0.006, abs(y) + 0.001, (x, y / 2, z + sign * 0.42 * length), metal, axis="y", sections=6, solid=False
        )


KINDS = {
    "ShowerCurtain": Kind(shower_curtain),
    "ShowerDoor": Kind(shower_door),
    "ShowerGlass": Kind(shower_glass),
    "ShowerHead": Kind(shower_head),
}
