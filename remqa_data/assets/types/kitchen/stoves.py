"""What is on a stove: burners that pots stand on, and knobs. The stove itself is part of the counter."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.forms import draw_fitted
from remqa_data.geometry.types import F64

CAST_IRON = Material("metal", "black", (0.14, 0.14, 0.15), gloss=0.3)


def stove_burner(b: Builder) -> None:
    """A burner: square gas grate, electric coil, solid hotplate, round gas grate; on a glass hob a flat ring."""
    radius = min(b.w, b.d) / 2
    stretch = (b.w / (2 * radius), b.d / (2 * radius), 1.0)
    if b.h < 0.012:
        _hob_zone(b, radius, stretch)
    elif b.variant in (0, 3):
        _gas_burner(b, radius, stretch)
    elif b.variant == 1:
        _coil(b, radius, stretch)
    else:
        lip, h = 0.9 * radius, b.h
        rim = [(0, 0), (radius, 0), (radius, 0.4 * h), (0.95 * radius, 0.55 * h), (0.9 * radius, 0.4 * h), (0, 0.4 * h)]
        plate = [
            (0, 0.4 * h),
            (lip, 0.4 * h),
            (lip, 0.9 * h),
            (lip - 0.004, h),
            (0.3 * lip, h),
            (0.28 * lip, 0.9 * h),
            (0, 0.9 * h),
        ]
        b.add(primitives.revolve(rim, 28).scaled(stretch), materials.STEEL)
        b.add(primitives.revolve(plate, 28).scaled(stretch), CAST_IRON)
        b.cylinder(0.12 * radius, 0.08 * h, (0, 0, 0.94 * h), materials.paint("red"), sections=12, solid=False)
        b.looks_like(CAST_IRON)
    b.solid((0.9 * b.w, 0.9 * b.d, b.h), (0, 0, b.h / 2))
    b.space("burner", (b.w, b.d, 0.4), (0, 0, b.h + 0.2))


def _hob_zone(b: Builder, radius: float, stretch: tuple[float, float, float]) -> None:
    mark = b.by_variant(
        (materials.WHITE_PLASTIC, materials.paint("red"), materials.GRAY_PLASTIC, materials.paint("orange"))
    )
    skin = 0.0008
    disc = [(0, 0), (radius, 0), (radius, b.h - skin), (0, b.h - skin)]
    b.add(primitives.revolve(disc, 32).scaled(stretch), materials.DARK_GLASS)
    for outer in b.by_variant(((0.97,), (0.97, 0.62), (0.97, 0.90), (0.97, 0.66, 0.36))):
        line = [
            (outer * radius - 0.004, b.h - skin),
            (outer * radius, b.h - skin),
            (outer * radius, b.h),
            (outer * radius - 0.004, b.h),
        ]
        b.add(primitives.revolve([*line, line[0]], 32).scaled(stretch), mark)
    if b.variant == 2:
        for size in ((0.5 * radius, 0.004, skin), (0.004, 0.5 * radius, skin)):
            b.box(size, (0, 0, b.h - skin / 2), mark, solid=False)
    b.looks_like(materials.DARK_GLASS)


def _gas_burner(b: Builder, radius: float, stretch: tuple[float, float, float]) -> None:
    """Cap and crown in the middle, under a grate of bars whose top is what pots stand on."""
    crown = materials.BRASS if b.variant == 3 else materials.STEEL
    bar = 0.009
    thick = min(bar, 0.4 * b.h)
    z = b.h - thick / 2
    cap = 0.40 * radius
    b.cylinder(1.25 * cap, 0.3 * b.h, (0, 0, 0.15 * b.h), crown, sections=20, solid=False)
    b.cylinder(cap, 0.25 * b.h, (0, 0, 0.42 * b.h), CAST_IRON, sections=20, solid=False)
    if b.variant == 0:
        for sign in (-1, 1):
            b.box((b.w, bar, thick), (0, sign * (b.d - bar) / 2, z), CAST_IRON, solid=False)
            b.box((bar, b.d - 2 * bar, thick), (sign * (b.w - bar) / 2, 0, z), CAST_IRON, solid=False)
            b.box((0.36 * b.w, bar, thick), (sign * (0.32 * b.w - bar / 2), 0, z), CAST_IRON, solid=False)
            b.box((bar, 0.36 * b.d, thick), (0, sign * (0.32 * b.d - bar / 2), z), CAST_IRON, solid=False)
            for other in (-1, 1):
                at = (sign * (b.w / 2 - bar), other * (b.d / 2 - bar), (b.h - thick) / 2)
                b.box((bar, bar, b.h - thick), at, CAST_IRON, solid=False)
    else:
        ring = [
            (radius - bar, b.h - thick),
            (radius, b.h - thick),
            (radius, b.h),
            (radius - bar, b.h),
            (radius - bar, b.h - thick),
        ]
        b.add(primitives.revolve(ring, 24).scaled(stretch), CAST_IRON)
        for angle in range(0, 360, 60):
            turn = primitives.turn("z", angle)
            finger = primitives.box((0.62 * radius, bar, thick)).moved((0.62 * radius, 0, z)).turned(turn)
            leg = primitives.box((bar, bar, b.h - thick)).moved((radius - bar, 0, (b.h - thick) / 2)).turned(turn)
            b.add(primitives.joined([finger, leg]).scaled(stretch), CAST_IRON)
    b.looks_like(CAST_IRON)


def _coil(b: Builder, radius: float, stretch: tuple[float, float, float]) -> None:
    pan = [
        (0, 0),
        (0.9 * radius, 0),
        (radius, 0.5 * b.h),
        (0.95 * radius, 0.5 * b.h),
        (0.8 * radius, 0.12 * b.h),
        (0, 0.1 * b.h),
    ]
    b.add(primitives.revolve(pan, 20).scaled(stretch), materials.CHROME)
    t = 0.095 * radius
    for at in (0.86, 0.58, 0.3):
        r = at * radius
        turn = [(r - t, 0.5 * b.h), (r + t, 0.5 * b.h), (r + t, 0.85 * b.h), (r, b.h), (r - t, 0.85 * b.h)]
        b.add(primitives.revolve([*turn, turn[0]], 18).scaled(stretch), CAST_IRON)
    for sign in (-1, 1):
        b.box(
            (1.8 * radius, 0.004, 0.2 * b.h),
            (0, 0, 0.4 * b.h),
            materials.CHROME,
            solid=False,
            rotation=primitives.turn("z", sign * 45),
        )
    b.looks_like(CAST_IRON)


def stove_knob(b: Builder) -> None:
    """A knob of a stove with a grip bar, a skirt and pointer, lobes, or a steel ring; tilted as far as its box says."""
    body = b.by_variant(
        (
            materials.BLACK_PLASTIC,
            b.pick(materials.PLASTICS),
            materials.CHROME,
            b.pick((materials.BLACK_PLASTIC, materials.WHITE_PLASTIC)),
        )
    )
    with b.quarter_turned(b.w < 0.8 * min(b.d, b.h)):
        tilt, long = _knob_tilt(b.w, b.d, b.h)
        lean = primitives.turn("x", 90 - tilt)
        parts = [(mesh.turned(lean), material) for mesh, material in _knob_parts(b, body, b.w / 2, long)]
        draw_fitted(b, parts, (-b.w / 2, -b.d / 2, 0), (b.w / 2, b.d / 2, b.h))
        b.solid((0.8 * b.w, 0.8 * b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(body)


def _knob_tilt(width: float, depth: float, height: float) -> tuple[float, float]:
    """Elevation of the knob's axis in degrees and its length, so that the tilted disc of a width fills a box."""
    best = (np.inf, 0.0, 0.03)
    for degrees in range(0, 91, 3):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        long = float(np.clip((depth * c + height * s - 2 * width * s * c), 0.012, 0.09))
        miss = 0.5 * max(long - 0.045, 0.0) + abs(long * c + width * s - depth) + abs(long * s + width * c - height)
        best = min(best, (miss, float(degrees), long))
    return best[1], best[2]


def _knob_parts(b: Builder, body: Material, r: float, long: float) -> list[tuple[primitives.Mesh, Material]]:
    """The knob along z, its foot at -long / 2."""
    low, high = -long / 2, long / 2
    mark = materials.WHITE_PLASTIC if body.color != "white" else materials.paint("red")
    line = primitives.box((0.1 * r, 0.55 * r, 0.001))
    if b.variant == 0:
        disc = primitives.revolve(
            [(0, low), (r, low), (r, low + 0.3 * long), (0.9 * r, low + 0.45 * long), (0, low + 0.45 * long)], 24
        )
        bar = primitives.rounded_box((0.42 * r, 1.7 * r, 0.55 * long), 0.1 * r, 1).moved((0, 0, high - 0.275 * long))
        return [(disc, body), (bar, body), (line.moved((0, 0.5 * r, high + 0.0003)), mark)]
    if b.variant == 1:
        grip = [
            (0, low),
            (r, low),
            (r, low + 0.15 * long),
            (0.72 * r, low + 0.3 * long),
            (0.66 * r, high - 0.05 * long),
            (0.6 * r, high),
            (0, high),
        ]
        return [(primitives.revolve(grip, 24), body), (line.moved((0, 0.3 * r, high + 0.0003)), mark)]
    if b.variant == 2:
        t = np.radians(np.arange(0, 360, 10))
        lobes: F64 = np.column_stack([np.cos(t), np.sin(t)]) * (0.8 + 0.06 * np.cos(6 * t))[:, None] * r
        skirt = primitives.cylinder(r, 0.25 * long, sections=24).moved((0, 0, low + 0.125 * long))
        return [
            (skirt, materials.BLACK_PLASTIC),
            (primitives.prism(lobes, 0.75 * long).moved((0, 0, high - 0.375 * long)), body),
            (line.moved((0, 0.45 * r, high + 0.0003)), materials.paint("red")),
        ]
    ring = primitives.cylinder(r, 0.3 * long, sections=24).moved((0, 0, low + 0.15 * long))
    drum = primitives.revolve(
        [(0, low), (0.84 * r, low), (0.8 * r, high - 0.08 * long), (0.7 * r, high), (0, high)], 24
    )
    return [(ring, materials.CHROME), (drum, body), (line.moved((0, 0.4 * r, high + 0.0003)), mark)]


KINDS = {"StoveBurner": Kind(stove_burner), "StoveKnob": Kind(stove_knob)}
