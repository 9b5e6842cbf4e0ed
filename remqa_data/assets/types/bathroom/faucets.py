"""Faucets of kitchens, washbasins and baths: their parts follow from the box, their looks from the variant."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.geometry.types import F64

FINISHES = (
    materials.CHROME,
    materials.CHROME,
    materials.CHROME,
    materials.BLACK_METAL,
    materials.BRASS,
    materials.COPPER,
)
WIDE_M = 0.13
"""From this width on there is a handle on either side of the spout."""


def faucet(b: Builder) -> None:
    """A faucet: round, square, with a spring and spray head, or vintage with cross handles; high arc or low spout."""
    metal = b.pick(FINISHES)
    wide = b.w >= WIDE_M
    high = b.h > 0.7 * b.d and b.h > 0.15
    pipe = min(0.014, 0.2 * b.w, 0.12 * b.h)
    foot = min(2.2 * pipe, 0.5 * b.w, 0.2 * b.d)
    y = b.d / 2 - foot
    _column(b, metal, pipe, foot, y, high)
    if high:
        _arc(b, metal, pipe, y)
    else:
        _low_spout(b, metal, pipe, y, lever=not wide)
    if wide:
        for side in (-1, 1):
            _side_handle(b, metal, side, pipe, y, foot)
    elif high:
        _column_lever(b, metal, pipe, foot, y)
    if b.w < 0.34:
        base = primitives.rounded_rect(b.w, 2 * foot, (0.2 if b.variant == 1 else 0.99) * min(foot, b.w / 2), 3)
        b.add(primitives.prism(base, 0.012), metal, (0, y, 0.006), solid=True)
    b.solid((2 * pipe, 2 * pipe, b.h), (0, y, b.h / 2))
    b.looks_like(metal)


def _column(b: Builder, metal: Material, pipe: float, foot: float, y: float, high: bool) -> None:
    top = 0.30 * b.h if high else 0.55 * b.h
    if b.variant == 1:
        b.box((2 * foot, 2 * foot, 0.008), (0, y, 0.004), metal, radius=0.002, solid=False)
        b.box((3.2 * pipe, 3.2 * pipe, top), (0, y, top / 2), metal, radius=0.002, solid=False)
        return
    if b.variant == 3:
        bell = [
            (0, 0),
            (foot, 0),
            (foot, 0.05 * top),
            (0.75 * foot, 0.12 * top),
            (0.6 * foot, 0.35 * top),
            (0.85 * foot, 0.6 * top),
        ]
        shape = [*bell, (0.8 * foot, 0.75 * top), (pipe, top), (0, top)]
    else:
        shape = [
            (0, 0),
            (foot, 0),
            (foot, 0.008),
            (1.6 * pipe, 0.016),
            (1.6 * pipe, top - 0.004),
            (1.4 * pipe, top),
            (0, top),
        ]
    b.add(primitives.revolve(shape, 16), metal, (0, y, 0))


def _arc(b: Builder, metal: Material, pipe: float, y: float) -> None:
    """A high spout that comes down again at the front."""
    tip = -b.d / 2 + pipe * 1.5
    low = 0.52 * b.h
    if b.variant == 1:
        thick = 2.2 * pipe
        b.box((thick, thick, b.h), (0, y, b.h / 2), metal, radius=0.002, solid=False)
        length = y + b.d / 2
        b.box((thick, length, thick), (0, y - length / 2, b.h - thick / 2), metal, radius=0.002, solid=False)
        b.box((thick, thick, b.h - low), (0, -b.d / 2 + thick / 2, (b.h + low) / 2), metal, radius=0.002, solid=False)
        return
    radius = (y - tip) / 2
    rise = min(radius, 0.4 * b.h)
    t = np.radians(np.linspace(0, 180, 11))
    bend = np.column_stack([np.zeros(11), (y + tip) / 2 + radius * np.cos(t), b.h - pipe - rise + rise * np.sin(t)])
    path: F64 = np.vstack([[0, y, 0.02], bend, [0, tip, min(low, b.h - pipe - rise - 0.005)]])
    b.add(primitives.tube(path, pipe, 8), metal)
    end = float(path[-1, 2])
    if b.variant == 2:
        b.cylinder(
            1.5 * pipe,
            0.22 * b.h,
            (0, tip, end + 0.02 * b.h),
            materials.BLACK_PLASTIC,
            top_radius=1.3 * pipe,
            sections=12,
            solid=False,
        )
        for z in np.linspace(0.36 * b.h, b.h - pipe - rise, 7):
            b.cylinder(1.35 * pipe, 0.006, (0, y, float(z)), metal, sections=8, solid=False)
    else:
        b.cylinder(1.35 * pipe, 0.02, (0, tip, end + 0.008), metal, sections=12, solid=False)


def _low_spout(b: Builder, metal: Material, pipe: float, y: float, *, lever: bool) -> None:
    """A spout straight to the front, with a lever on top of the column unless there are handles at the sides."""
    base = 0.46 * b.h if lever else 0.62 * b.h
    if b.variant == 1 or b.variant == 2:
        width = min(b.w, 0.05) * (1.0 if b.variant == 1 else 0.8)
        thick = min(0.02, 0.16 * b.h)
        length = y + b.d / 2
        b.box(
            (width, length, thick),
            (0, y - length / 2, base),
            metal,
            radius=0.003 if b.variant == 1 else 0.009,
            segments=2,
            solid=False,
        )
        b.box(
            (0.7 * width, 0.014, 0.01),
            (0, -b.d / 2 + 0.012, base - thick / 2 - 0.004),
            materials.SHADOW_GAP,
            solid=False,
        )
    else:
        lift = 0.14 * b.h
        u = np.linspace(0, 1, 8)
        run = -b.d / 2 + pipe - y
        path = np.column_stack([np.zeros(8), y + run * u, base + lift * np.sin(np.pi * u) - 0.10 * b.h * u])
        path = np.vstack([path, path[-1] + np.array([0, 0, -0.12 * b.h])])
        b.add(primitives.tube(path, (np.linspace(1.3, 1.0, 9) * pipe).tolist(), 8), metal)
    neck = 0.9 * b.h if lever else b.h
    tall = neck - 0.5 * b.h
    top = 1.1 * pipe if lever else 0.7 * pipe
    if b.variant == 1:
        b.box((2.6 * pipe, 2.6 * pipe, tall), (0, y, neck - tall / 2), metal, radius=0.002, solid=False)
    else:
        b.cylinder(1.5 * pipe, tall, (0, y, neck - tall / 2), metal, top_radius=top, sections=14, solid=False)
    if lever:
        thick = min(0.012, 0.12 * b.h)
        grip = (min(0.03, b.w), 0.5 * b.d, thick)
        b.box(grip, (0, y - 0.16 * b.d, b.h - thick / 2), metal, radius=0.004, solid=False)


def _side_handle(b: Builder, metal: Material, side: int, pipe: float, y: float, foot: float) -> None:
    """A handle beside the spout: lever, bar, knob or cross."""
    reach = min(0.05, 0.2 * b.w)
    x = side * (b.w / 2 - reach)
    top = min(0.075, 0.62 * b.h)
    stem = min(0.55 * foot, 0.7 * reach)
    b.cylinder(min(foot, reach), 0.01, (x, y, 0.005), metal, sections=14, solid=False)
    b.cylinder(stem, top - 0.008, (x, y, (top - 0.008) / 2), metal, top_radius=0.8 * stem, sections=12)
    z = top - 0.005
    if b.variant == 3:
        white = materials.WHITE_CERAMIC
        b.cylinder(0.3 * stem, 2 * reach, (x, y, z), metal, axis="x", sections=8, solid=False)
        b.cylinder(0.3 * stem, 2 * min(reach, foot), (x, y, z), metal, axis="y", sections=8, solid=False)
        b.cylinder(0.7 * stem, 0.008, (x, y, z + 0.008), white, sections=12, solid=False)
    elif b.variant == 2:
        r = min(reach, foot)
        knob = primitives.revolve([(0, 0), (0.8 * r, 0), (r, 0.012), (0.9 * r, 0.024), (0, 0.028)], 14)
        x = side * (b.w / 2 - r)
        b.add(knob, metal, (x, y, z - 0.004))
    elif b.variant == 1:
        b.box(
            (reach + stem, 1.6 * stem, 0.012), (x + side * (reach - stem) / 2, y, z), metal, radius=0.002, solid=False
        )
    else:
        path = [
            (x - side * stem, y, z),
            (x + side * 0.4 * reach, y - 0.4 * reach, z + 0.006),
            (x + side * (reach - 0.007), y - reach, z + 0.012),
        ]
        b.add(primitives.tube(np.array(path), (0.7 * stem, 0.5 * stem, 0.007), 8), metal)


def _column_lever(b: Builder, metal: Material, pipe: float, foot: float, y: float) -> None:
    """A small lever at the right of the column of a narrow faucet with a high spout."""
    z = 0.24 * b.h
    x = min(1.4 * pipe, b.w / 2 - 0.004)
    b.cylinder(0.6 * pipe, max(b.w / 2 - x, 0.004), ((x + b.w / 2) / 2, y, z), metal, axis="x", sections=8, solid=False)
    lever = (min(0.012, 0.3 * b.w), 0.5 * foot, 0.18 * b.h)
    b.box(lever, (b.w / 2 - lever[0] / 2, y, z + 0.08 * b.h), metal, radius=0.003, solid=False)


KINDS = {"Faucet": Kind(faucet)}
