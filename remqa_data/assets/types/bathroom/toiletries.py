"""Small things of a bathroom: soap, brushes and bottles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Points2
from remqa_data.assets.parts import forms
from remqa_data.assets.types.bathroom import tissue
from remqa_data.geometry.types import F64

SOAPS = tuple(
    Material("soap", color, rgb, gloss=0.25)
    for color, rgb in (
        ("white", (0.95, 0.94, 0.90)),
        ("pink", (0.90, 0.66, 0.70)),
        ("green", (0.60, 0.77, 0.56)),
        ("yellow", (0.92, 0.81, 0.46)),
        ("blue", (0.56, 0.72, 0.83)),
        ("orange", (0.91, 0.63, 0.36)),
    )
)
RUBBERS = (
    materials.RUBBER,
    Material("rubber", "red", (0.64, 0.20, 0.15)),
    Material("rubber", "orange", (0.80, 0.42, 0.20)),
    Material("rubber", "blue", (0.24, 0.38, 0.60)),
)
SPOUT_COLORS = tuple(materials.paint(color) for color in ("white", "red", "black", "blue", "green"))


def soap_bar(b: Builder) -> None:
    """A bar of soap: a rounded block with a stamped frame, an oval, a waisted bar, or a cut block with swirls."""
    soap = b.pick(SOAPS)
    with b.quarter_turned(b.d > b.w):
        mark = materials.tinted(soap, 0.80)
        if b.variant == 3:
            veined = replace(soap, texture="marble", repeat_m=0.09)
            b.box((b.w, b.d, b.h), (0, 0, b.h / 2), veined, radius=0.0015, solid=False)
        else:
            power = b.by_variant((5.0, 2.3, 3.6))
            t = np.array([-1.0, -0.94, -0.75, -0.35, 0.35, 0.75, 0.94, 1.0])
            plan = primitives.ellipse(b.w, b.d, 24, power)
            if b.variant == 2:
                plan[:, 1] *= 0.70 + 0.30 * np.sin(np.pi * np.abs(plan[:, 0] / b.w)) ** 2 * 1.4
                plan[:, 1] *= b.d / np.ptp(plan[:, 1])
            rings = [np.column_stack([plan * (1 - 0.24 * abs(s) ** 5), np.full(24, b.h * (s + 1) / 2)]) for s in t]
            b.add(primitives.loft(rings), soap)
        _stamp(b, mark)
        b.solid((0.9 * b.w, 0.85 * b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(soap)


def spray_bottle(b: Builder) -> None:
    """A spray bottle with a trigger, its nozzle at the front: oval, waisted, conical or with square shoulders."""
    body = b.pick(tissue.PRINTS)
    head = b.pick([color for color in SPOUT_COLORS if color.color != body.color])
    deep, top = 0.72 * b.d, 0.66 * b.h
    y = b.d / 2 - deep / 2
    neck = min(0.36 * b.w, 0.016)
    heights = (0.0, 0.02, 0.25, 0.45, 0.62, 0.78, 0.90, 0.96)
    girths = b.by_variant(
        (
            (0.94, 1.0, 1.0, 1.0, 0.97, 0.82, 0.50, 0.34),
            (0.92, 0.98, 1.0, 0.86, 0.74, 0.84, 0.62, 0.34),
            (0.96, 1.0, 0.92, 0.82, 0.70, 0.55, 0.40, 0.34),
            (0.97, 1.0, 1.0, 1.0, 1.0, 1.0, 0.60, 0.34),
        )
    )
    power = b.by_variant((2.6, 3.0, 2.4, 6.0))
    rings = []
    for share, girth in zip(heights, girths, strict=True):
        plan = primitives.ellipse(b.w * max(girth, 0.8 if share < 0.8 else 0.66), deep * girth, 16, power)
        rings.append(np.column_stack([plan[:, 0], plan[:, 1] + y, np.full(16, share * top)]))
    b.add(primitives.loft(rings), body)
    b.solid((b.w, deep, 0.85 * top), (0, y, 0.425 * top))
    stack = np.array(rings)
    for low, high, swell, material in (
        (0.10, 0.45, 1.02, tissue.TISSUE),
        (0.20, 0.36, 1.04, materials.tinted(body, 0.6)),
    ):
        b.add(primitives.loft(_girdle(stack, low * top, high * top, swell, y), capped=False), material)
    b.cylinder(neck * 1.25, 0.055 * b.h, (0, y, top - 0.005 * b.h), head, sections=14, solid=False)
    _spray_head(b, y, top, head)
    b.looks_like(body)


def scrub_brush(b: Builder) -> None:
    """A toilet brush in its holder: closed with a lid, square and open, a steel cylinder, or a bowl."""
    pot = b.pick(
        b.by_variant(
            (
                tissue.PRINTS[:4],
                (materials.WHITE_PLASTIC, materials.GRAY_PLASTIC),
                (materials.STEEL, materials.BLACK_METAL),
                materials.CERAMICS,
            )
        )
    )
    grip = b.pick((materials.WHITE_PLASTIC, materials.STEEL)) if b.variant != 2 else pot
    height = b.by_variant((0.40, 0.34, 0.56, 0.30)) * b.h
    half = min(b.w, b.d) / 2
    t = 0.05
    if b.variant == 1:
        b.shell((b.w, b.d, height), (0, 0, height / 2), 0.005, pot, open_side="z", radius=0.002)
    else:
        shape = b.by_variant(
            (
                ((0.86, 0), (1.0, 0.06), (0.92, 0.5), (0.72, 0.9), (0.66, 1.0)),
                (),
                ((0.96, 0), (1.0, 0.02), (1.0, 0.98), (0.96, 1.0)),
                ((0.6, 0), (0.82, 0.12), (0.96, 0.32), (1.0, 0.5), (0.96, 0.7), (0.87, 0.87), (0.74, 1.0)),
            )
        )
        outside = [(0.0, 0.0), *((r, z * height) for r, z in shape)]
        inside = [(max(r - t, 0.3), z * height) for r, z in shape[::-2] if z > 0.4] + [(0.0, 0.05 * height)]
        _lathe(b, outside + inside, pot)
        b.solid((1.4 * half, 1.4 * half, height), (0, 0, height / 2))
    if b.variant == 2:
        _lathe(b, [(0.0, height), (0.99, height), (0.99, height + 0.008), (0.0, height + 0.014)], grip)
    elif b.variant == 0:
        _lathe(
            b,
            [(0.0, height), (0.62, height), (0.60, height + 0.012), (0.2, height + 0.022), (0.0, height + 0.022)],
            grip,
        )
    else:
        _bristles(b, 0.55, 0.12 * height, height + 0.045)
    stick = 0.0075 / half
    rod = [
        (0.0, height * 0.5),
        (stick, height * 0.5),
        (stick, 0.80 * b.h),
        (1.9 * stick, 0.84 * b.h),
        (1.7 * stick, 0.96 * b.h),
        (stick, b.h),
        (0.0, b.h),
    ]
    _lathe(b, rod, grip, 10)
    b.solid((0.016, 0.016, b.h - height), (0, 0, (b.h + height) / 2))
    b.looks_like(pot)


def plunger(b: Builder) -> None:
    """A plunger: a bell, a flanged cup, bellows, or a flat cup with a ball on the stick."""
    rubber = b.pick(RUBBERS)
    stick = b.pick((materials.PINE, materials.OAK, materials.WHITE_WOOD)) if b.variant != 2 else materials.WHITE_PLASTIC
    half = min(b.w, b.d) / 2
    cups: tuple[list[tuple[float, float]], ...] = (
        [(0.92, 0), (1.0, 0.01), (0.98, 0.06), (0.86, 0.15), (0.60, 0.21), (0.30, 0.235), (0.24, 0.30)],
        [(0.50, 0), (0.60, 0.005), (0.62, 0.05), (1.0, 0.07), (0.99, 0.10), (0.84, 0.18), (0.42, 0.23), (0.24, 0.30)],
        [
            (0.9, 0),
            (1.0, 0.03),
            (0.82, 0.06),
            (1.0, 0.09),
            (0.80, 0.12),
            (0.92, 0.15),
            (0.66, 0.18),
            (0.74, 0.21),
            (0.3, 0.24),
            (0.24, 0.30),
        ],
        [(0.96, 0), (1.0, 0.008), (1.0, 0.03), (0.78, 0.10), (0.36, 0.13), (0.25, 0.15), (0.24, 0.22)],
    )
    cup = [(r, z * b.h) for r, z in b.by_variant(cups)]
    hollow = [(0.0, cup[-2][1] * 0.6), (0.55 * cup[0][0], cup[-2][1] * 0.5), (cup[0][0] - 0.07, 0.0)]
    _lathe(b, [*hollow, *cup, (0.0, cup[-1][1])], rubber)
    r = 0.012 / half
    end = (
        [(2.1 * r, b.h - 0.04), (2.6 * r, b.h - 0.022), (2.0 * r, b.h - 0.006)]
        if b.variant == 3
        else [(r, b.h - 0.008)]
    )
    _lathe(b, [(r, 0.2 * b.h), (r, b.h - 0.045), *end, (0.5 * r, b.h), (0.0, b.h)], stick, 10)
    if b.variant == 2:
        _lathe(
            b, [(r, 0.72 * b.h), (1.7 * r, 0.74 * b.h), (1.7 * r, b.h - 0.006), (1.2 * r, b.h), (0, b.h)], rubber, 10
        )
    wide = 2 * half * 0.8
    b.solid((wide, wide, 0.12 * b.h), (0, 0, 0.06 * b.h))
    b.solid((0.026, 0.026, 0.88 * b.h), (0, 0, 0.56 * b.h))
    b.looks_like(rubber)


def _lathe(b: Builder, profile: Points2, material: Material, sections: int = 20) -> None:
    """Draw a turned shape whose radii are given as fractions of half of the box's width."""
    b.add(primitives.revolve(profile, sections).scaled((b.w / 2, b.d / 2, 1.0)), material, grain="z")


def _stamp(b: Builder, mark: Material) -> None:
    """A line stamped around the top of a soap and a short one in its middle."""
    line = b.by_variant((0.58, 0.60, 0.46))
    plan: F64 = primitives.ellipse(line * b.w, line * b.d * 0.96, 16, b.by_variant((5.0, 2.2, 3.0)))
    b.add(primitives.prism(plan, 0.0012, [plan * 0.9]), mark, (0, 0, b.h))
    for y, length in ((-0.06, 0.26), (0.08, 0.16)):
        b.box((length * b.w, 0.045 * b.d, 0.0012), (0, y * b.d, b.h), mark, solid=False)


def _girdle(rings: F64, low: float, high: float, swell: float, y: float) -> F64:
    """The part between two heights of a stack of rings, a little larger: a label around a bottle."""
    levels = rings[:, 0, 2]
    wanted = [low, *levels[(levels > low) & (levels < high)].tolist(), high]
    flat = rings.reshape(len(rings), -1)
    cut = np.array([[np.interp(z, levels, column) for column in flat.T] for z in wanted]).reshape(len(wanted), -1, 3)
    middle = np.array([0.0, y, 0.0])
    return np.asarray((cut - middle) * [swell, 1 + (swell - 1) * 0.4, 1.0] + middle)


def _spray_head(b: Builder, y: float, top: float, head: Material) -> None:
    width = 0.72 * b.w
    rear, front = y + 0.30 * b.d, -b.d / 2
    low = top + 0.02 * b.h
    shell = [
        (y - 0.12 * b.d, low),
        (y + 0.12 * b.d, low),
        (y + 0.14 * b.d, low + 0.10 * b.h),
        (rear, b.h * 0.90),
        (rear - 0.02 * b.d, b.h * 0.95),
        (y - 0.05 * b.d, b.h),
        (front + 0.16 * b.d, b.h * 0.985),
        (front + 0.10 * b.d, b.h * 0.965),
        (front + 0.10 * b.d, b.h * 0.89),
        (y - 0.14 * b.d, b.h * 0.86),
    ]
    b.add(forms.side_cut(shell, width), head)
    accent = materials.tinted(head, 0.7)
    b.box((0.6 * width, 0.1 * b.d, 0.055 * b.h), (0, front + 0.05 * b.d, 0.927 * b.h), accent, solid=False)
    trigger = [
        (front + 0.22 * b.d, 0.875 * b.h),
        (front + 0.33 * b.d, 0.865 * b.h),
        (front + 0.24 * b.d, 0.79 * b.h),
        (front + 0.20 * b.d, 0.70 * b.h),
        (front + 0.13 * b.d, 0.70 * b.h),
        (front + 0.16 * b.d, 0.79 * b.h),
    ]
    b.add(forms.side_cut(trigger, 0.42 * b.w), accent)
    b.solid((width, 0.7 * b.d, 0.14 * b.h), (0, y - 0.1 * b.d, 0.92 * b.h))


def _bristles(b: Builder, radius: float, low: float, high: float) -> None:
    """A round brush head: rings of bristles, wide in the middle."""
    z = np.linspace(low, high, 9)
    r = radius * np.array([0.3, 0.85, 1.0, 0.9, 1.0, 0.9, 1.0, 0.85, 0.3])
    profile = [(0.0, low), *zip(r.tolist(), z.tolist(), strict=True), (0.0, high)]
    _lathe(b, profile, Material("plastic", "white", (0.95, 0.95, 0.95), "carpet", 0.05), 14)


KINDS = {
    "SoapBar": Kind(soap_bar),
    "SprayBottle": Kind(spray_bottle),
    "ScrubBrush": Kind(scrub_brush),
    "Plunger": Kind(plunger),
}
