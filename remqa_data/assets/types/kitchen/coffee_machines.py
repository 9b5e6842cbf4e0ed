"""Coffee machines: one function a design, each with a tray on which a mug stands."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives

COFFEE = Material("glass", "brown", (0.16, 0.08, 0.04), gloss=0.7)
SPLIT_M = 0.36
"""Machines wider than this have two stations side by side."""


def coffee_machine(b: Builder) -> None:
    """A coffee machine: capsule machine, drip machine with a jug, steel espresso machine, bean-to-cup machine."""
    b.by_variant((_capsule_machine, _drip_machine, _espresso_machine, _bean_machine))(b)


def _capsule_machine(b: Builder) -> None:
    """A rounded column whose head hangs over the tray, with a chrome lever and a water tank."""
    body = b.pick((*materials.PLASTICS[:4],))
    tray = _tray_level(b)
    aside = b.w > SPLIT_M  # the tank stands beside a narrow machine, and behind one that is wide
    tank_w = 0.26 * b.w if aside else 0.8 * b.w
    width = b.w - tank_w - 0.004 if aside else b.w
    x = b.w / 2 - width / 2
    back = b.d / 2 if aside else b.d * 0.32
    column = 0.42 * b.d
    b.box(
        (width, b.d / 2 + back, tray - 0.008),
        (x, (back - b.d / 2) / 2, (tray - 0.008) / 2),
        body,
        radius=0.014,
        segments=2,
    )
    _grille(b, x, 0.78 * width, -b.d / 2 + 0.02, back - column - 0.01, tray)
    b.box((0.92 * width, column, 0.93 * b.h), (x, back - column / 2, 0.465 * b.h), body, radius=0.04, segments=3)
    head_z, head_h = 0.80 * b.h, 0.30 * b.h
    head_d = 0.86 * (b.d / 2 + back)
    b.box((0.98 * width, head_d, head_h), (x, back - head_d / 2, head_z), body, radius=0.06, segments=3)
    front = back - head_d
    b.box(
        (0.5 * width, 0.008, 0.08),
        (x, front - 0.001, head_z - 0.01),
        materials.BLACK_PLASTIC,
        radius=0.003,
        solid=False,
    )
    _spout(b, x, front + 0.09, head_z - head_h / 2)
    reach = min(0.36 * width, 0.12)
    low = head_z + 0.2 * head_h
    lever = [
        (x - reach, front + 0.12, low),
        (x - reach, front + 0.05, b.h - 0.012),
        (x + reach, front + 0.05, b.h - 0.012),
        (x + reach, front + 0.12, low),
    ]
    b.add(primitives.tube(np.array(lever), 0.011, 8), materials.CHROME)
    tank = (tank_w, 0.6 * b.d, 0.72 * b.h) if aside else (tank_w, b.d / 2 - back + 0.02, 0.78 * b.h)
    at = (
        (-b.w / 2 + tank_w / 2, 0.16 * b.d, tank[2] / 2 + 0.012)
        if aside
        else (0, b.d / 2 - tank[1] / 2, tank[2] / 2 + 0.012)
    )
    b.box(tank, at, materials.CLEAR_GLASS, radius=0.02, segments=2)
    b.box(
        (tank[0] + 0.004, tank[1] + 0.002, 0.02),
        (at[0], at[1] - 0.001, at[2] + tank[2] / 2 + 0.008),
        body,
        radius=0.006,
        solid=False,
    )
    foot_y = at[1] if aside else 0.0
    b.box((0.96 * b.w, 0.5 * b.d, 0.012), (0, foot_y + 0.03 * b.d, 0.006), materials.BLACK_PLASTIC, solid=False)
    _mug_space(b, x, 0.7 * width, -b.d / 2 + 0.02, back - column - 0.005, tray, head_z - head_h / 2 - 0.03)
    b.looks_like(body)


def _drip_machine(b: Builder) -> None:
    """A drip machine: tank behind, filter head above, glass jug on a hotplate; a wide one has a tray for a mug too."""
    body = b.pick((materials.PLASTICS[1], materials.PLASTICS[0], materials.STEEL, materials.PLASTICS[2]))
    trim = materials.STEEL if body is not materials.STEEL else materials.BLACK_PLASTIC
    tray = _tray_level(b)
    tower = 0.34 * b.d
    y = b.d / 2 - tower / 2
    head = 0.27 * b.h
    b.box((b.w, b.d, tray - 0.008), (0, 0, (tray - 0.008) / 2), body, radius=0.012, segments=2)
    b.box((b.w - 0.004, tower, b.h - tray - 0.02), (0, y, (b.h + tray) / 2 - 0.02), body, radius=0.012, segments=2)
    b.box((b.w, 0.86 * b.d, head), (0, 0.07 * b.d, b.h - head / 2 - 0.012), body, radius=0.022, segments=2)
    b.box((0.9 * b.w, 0.7 * b.d, 0.014), (0, 0.09 * b.d, b.h - 0.007), trim, radius=0.005, solid=False)
    front = -0.36 * b.d
    b.box((0.84 * b.w, 0.006, 0.3 * head), (0, front - 0.002, b.h - 0.42 * head), trim, radius=0.002, solid=False)
    b.box((0.22 * b.w, 0.004, 0.16 * head), (0, front - 0.006, b.h - 0.42 * head), materials.DARK_GLASS, solid=False)
    for sx in (-0.3, 0.3):
        b.knob((sx * b.w, front - 0.004, b.h - 0.42 * head), 0.016, materials.BLACK_PLASTIC, reach=0.016)
    under = b.h - head - 0.012
    back = b.d / 2 - tower
    two = b.w > SPLIT_M
    jug_x = -b.w / 4 if two else 0.0
    room = min(b.w / 2 if two else b.w, back + b.d / 2) - 0.01
    if two or not b.spec.levels:
        _jug(b, (jug_x, (back - b.d / 2) / 2 + 0.01, tray), min(room / 2 - 0.012, 0.085), under - tray - 0.012)
    mug_x = b.w / 4 if two else 0.0
    if two or b.spec.levels:
        _grille(b, mug_x, 0.8 * room, -b.d / 2 + 0.02, back - 0.01, tray)
        _spout(b, mug_x, (back - b.d / 2) / 2, under)
        _mug_space(b, mug_x, 0.8 * room, -b.d / 2 + 0.01, back - 0.005, tray, under - 0.03)
    b.space("top", (0.85 * b.w, 0.65 * b.d, 0.3), (0, 0.09 * b.d, b.h + 0.15))
    b.looks_like(body)


def _espresso_machine(b: Builder) -> None:
    """A boxy machine with a group head, portafilter, steam wand, gauge, and a rail for cups on top."""
    body = b.pick(
        (
            materials.STEEL,
            materials.BLACK_METAL,
            materials.paint("red", "metal", 0.5),
            materials.paint("beige", "metal", 0.5),
        )
    )
    tray = _tray_level(b)
    deep, top = 0.5 * b.d, b.h - 0.035
    y = b.d / 2 - deep / 2
    b.box((b.w, b.d, tray - 0.008), (0, 0, (tray - 0.008) / 2), body, radius=0.006)
    b.box((b.w, deep, top - tray + 0.008), (0, y, (top + tray - 0.008) / 2), body, radius=0.006)
    hang = 0.30 * b.d
    low = tray + 0.52 * (top - tray)
    face = -b.d / 2 + 0.2 * b.d
    b.box((b.w, hang, top - low), (0, face + hang / 2, (top + low) / 2), body, radius=0.006)
    b.box(
        (0.92 * b.w, 0.004, 0.55 * (top - low)),
        (0, face - 0.001, low + 0.62 * (top - low)),
        materials.STEEL if body is not materials.STEEL else materials.BLACK_METAL,
        radius=0.001,
        solid=False,
    )
    _grille(b, 0, 0.84 * b.w, -b.d / 2 + 0.02, b.d / 2 - deep - 0.01, tray)
    panel_z = low + 0.62 * (top - low)
    gauge = min(0.032, 0.2 * (top - low))
    b.cylinder(gauge, 0.012, (-0.28 * b.w, face - 0.009, panel_z), materials.CHROME, axis="y", solid=False)
    b.cylinder(
        0.82 * gauge, 0.002, (-0.28 * b.w, face - 0.016, panel_z), materials.WHITE_PLASTIC, axis="y", solid=False
    )
    b.box(
        (0.003, 0.002, 0.7 * gauge),
        (-0.28 * b.w, face - 0.0175, panel_z + 0.25 * gauge),
        materials.paint("red"),
        solid=False,
    )
    for sx in (0.06, 0.2, 0.34):
        b.cylinder(
            0.014, 0.012, (sx * b.w, face - 0.009, panel_z), materials.CHROME, axis="y", sections=12, solid=False
        )
    group = (face + 0.11 * b.d, low)
    x = -0.12 * b.w
    b.cylinder(0.042, 0.04, (x, group[0], low - 0.016), materials.CHROME, solid=False)
    b.cylinder(0.036, 0.026, (x, group[0], low - 0.046), materials.CHROME, solid=False)
    grip = [(x, group[0] - 0.03, low - 0.046), (x, group[0] - 0.06, low - 0.046), (x, -b.d / 2 + 0.004, low - 0.062)]
    b.add(primitives.tube(np.array(grip), (0.008, 0.013, 0.017), 8), materials.BLACK_PLASTIC)
    for sx in (-0.014, 0.014):
        b.cylinder(0.006, 0.02, (x + sx, group[0], low - 0.066), materials.CHROME, sections=8, solid=False)
    wand_x = 0.34 * b.w
    wand = [
        (wand_x, group[0], low + 0.01),
        (wand_x, group[0] - 0.03, low - 0.03),
        (wand_x + 0.015, group[0] - 0.05, tray + 0.05),
    ]
    b.add(primitives.tube(np.array(wand), 0.006, 8), materials.CHROME)
    w, y0, y1 = 0.46 * b.w, face + 0.02, b.d / 2 - 0.02
    corners = [(-w, y0), (w, y0), (w, y1), (-w, y1), (-w, y0)]
    b.add(primitives.tube(np.array([(px, py, b.h - 0.005) for px, py in corners]), 0.005, 6), materials.CHROME)
    for px, py in corners[:4]:
        b.cylinder(
            0.005, b.h - 0.005 - top, (px, py, (b.h - 0.005 + top) / 2), materials.CHROME, sections=6, solid=False
        )
    b.space("cup rail", (2 * w - 0.03, y1 - y0 - 0.03, 0.25), (0, (y0 + y1) / 2, top + 0.125))
    _mug_space(b, 0, 0.6 * b.w, -b.d / 2 + 0.02, b.d / 2 - deep - 0.005, tray, low - 0.08)
    b.looks_like(body)


def _bean_machine(b: Builder) -> None:
    """A tall smooth box with a lit niche, twin spout, display, and a smoked bean hopper on top."""
    body = b.pick((materials.BLACK_PLASTIC, materials.STEEL, materials.WHITE_PLASTIC))
    face = materials.DARK_GLASS if body is not materials.BLACK_PLASTIC else materials.STEEL
    tray = _tray_level(b)
    top = b.h - 0.045
    niche = 0.56 * b.w
    high = tray + 0.46 * (top - tray)
    back = b.d / 2 - 0.5 * b.d
    cheek = (b.w - niche) / 2
    lip = 0.09 * b.d  # the drip tray stands out in front of the body
    y0 = -b.d / 2 + lip
    deep, middle = b.d - lip, lip / 2
    b.box((b.w, deep, top - high), (0, middle, (top + high) / 2), body, radius=0.012, segments=2)
    for sx in (-1.0, 1.0):
        b.box((cheek, deep, high), (sx * (b.w - cheek) / 2, middle, high / 2), body, radius=0.012, segments=2)
    b.box((niche + 0.01, b.d / 2 - back, high), (0, (b.d / 2 + back) / 2, high / 2), materials.BLACK_PLASTIC)
    b.box(
        (niche - 0.004, back + b.d / 2, tray - 0.008), (0, (back - b.d / 2) / 2, (tray - 0.008) / 2), body, radius=0.006
    )
    _grille(b, 0, niche - 0.03, -b.d / 2 + 0.015, back - 0.005, tray)
    b.box(
        (0.9 * b.w, 0.006, 0.62 * (top - high)),
        (0, y0 - 0.002, high + 0.58 * (top - high)),
        face,
        radius=0.002,
        solid=False,
    )
    screen = (0.0, y0 - 0.006, high + 0.66 * (top - high))
    b.box(
        (0.26 * b.w, 0.004, 0.28 * (top - high)),
        screen,
        Material("glass", "blue", (0.25, 0.5, 0.7), glow=0.6),
        solid=False,
    )
    for sx in (-0.36, -0.24, 0.24, 0.36):
        at = (sx * b.w, y0 - 0.007, screen[2])
        b.cylinder(0.014, 0.006, at, materials.CHROME, axis="y", sections=10, solid=False)
    b.box(
        (0.3 * niche, 0.07, 0.11 * b.h), (0, y0 + 0.045, high - 0.055 * b.h), materials.STEEL, radius=0.012, solid=False
    )
    for sx in (-0.02, 0.02):
        b.cylinder(
            0.008, 0.022, (sx, y0 + 0.03, high - 0.11 * b.h - 0.009), materials.BLACK_PLASTIC, sections=8, solid=False
        )
    hopper = Material("plastic", "black", (0.24, 0.17, 0.12), gloss=0.6)
    b.box((0.72 * b.w, 0.5 * b.d, 0.05), (0, 0.14 * b.d, top + 0.018), hopper, radius=0.012, segments=2, solid=False)
    b.box((0.2 * b.w, 0.03, 0.008), (0, 0.14 * b.d, b.h - 0.004), materials.CHROME, radius=0.003, solid=False)
    _mug_space(b, 0, niche - 0.02, -b.d / 2 + 0.01, back - 0.005, tray, high - 0.11 * b.h - 0.025)
    b.looks_like(body)


def _tray_level(b: Builder) -> float:
    return b.level(0.055, 0.03, 0.2 * b.h)


def _grille(b: Builder, x: float, width: float, y0: float, y1: float, level: float) -> None:
    """The drip tray: bars over a dark pan, their tops at a level."""
    b.box((width, y1 - y0, 0.006), (x, (y0 + y1) / 2, level - 0.006), materials.SHADOW_GAP)
    count = max(4, round((y1 - y0) / 0.022))
    for y in np.linspace(y0 + 0.004, y1 - 0.004, count):
        b.box((width, 0.006, 0.004), (x, float(y), level - 0.002), materials.STEEL, solid=False)
    b.solid((width, y1 - y0, 0.004), (x, (y0 + y1) / 2, level - 0.002))


def _spout(b: Builder, x: float, y: float, z: float) -> None:
    b.cylinder(0.012, 0.034, (x, y, z - 0.013), materials.BLACK_PLASTIC, top_radius=0.028, sections=12, solid=False)


def _mug_space(b: Builder, x: float, width: float, y0: float, y1: float, low: float, high: float) -> None:
    b.space("tray", (width, y1 - y0, high - low), (x, (y0 + y1) / 2, (low + high) / 2))


def _jug(b: Builder, at: tuple[float, float, float], radius: float, height: float) -> None:
    """A glass jug of coffee, its handle to the front."""
    x, y, z = at
    b.cylinder(0.9 * radius, 0.008, (x, y, z), materials.BLACK_METAL, sections=20, solid=False)
    h = height - 0.01
    coffee = [(0, 0), (0.86 * radius, 0), (radius, 0.22 * h), (0.99 * radius, 0.46 * h)]
    glass = [(0.99 * radius, 0.46 * h), (0.8 * radius, 0.74 * h), (0.62 * radius, 0.88 * h), (0.62 * radius, 0.9 * h)]
    b.add(primitives.revolve(coffee, 20), COFFEE, (x, y, z + 0.006))
    b.add(primitives.revolve(glass, 20), materials.CLEAR_GLASS, (x, y, z + 0.006))
    b.cylinder(0.64 * radius, 0.1 * h, (x, y, z + 0.006 + 0.95 * h), materials.BLACK_PLASTIC, sections=20, solid=False)
    grip = [
        (0, -0.6 * radius, 0.9 * h),
        (0, -1.3 * radius, 0.86 * h),
        (0, -1.42 * radius, 0.5 * h),
        (0, -1.0 * radius, 0.22 * h),
    ]
    b.add(primitives.tube(np.array(grip), 0.009, 6), materials.BLACK_PLASTIC, (x, y, z + 0.006))
    b.solid((1.6 * radius, 1.6 * radius, h), (x, y, z + h / 2))


KINDS = {"CoffeeMachine": Kind(coffee_machine)}
