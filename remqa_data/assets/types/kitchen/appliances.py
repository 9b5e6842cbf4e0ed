"""Microwave and toaster; fridges, coffee machines and stoves have modules of their own."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.looks import enamel, materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.geometry.types import F64

FOUR_SLOTS_M = 0.27
"""Toasters wider than this have two pairs of slots."""


def microwave(b: Builder) -> None:
    """A microwave: keypad and bar handle, two dials, retro with the dials below, or all black glass with touch keys."""
    body = b.pick(enamel.RETRO if b.variant == 2 else enamel.BODIES)
    metal = b.pick(materials.METALS[:2]) if body is not materials.BLACK_METAL else materials.STEEL
    reach = 0.004 if b.variant == 3 else 0.035
    thick, feet = 0.032, 0.014
    tall = b.h - feet
    face = -b.d / 2 + reach
    side = 0.0 if b.variant == 2 else b.w * b.by_variant((0.25, 0.24, 0.0, 0.2))
    strip = tall * 0.2 if b.variant == 2 else 0.0
    x, width = -side / 2, b.w - side
    low = feet + strip
    soft = 0.02 if b.variant == 2 else 0.004
    y0, y1 = face + thick + 0.002, b.d / 2
    deep, middle = y1 - y0, (y0 + y1) / 2
    wall = 0.02
    b.shell((width, deep, b.h - low), (x, middle, (b.h + low) / 2), wall, body)
    cavity = (width - 2 * wall, deep - wall, b.h - low - 2 * wall)
    b.shell(cavity, (x, middle - wall / 2, (b.h + low) / 2), 0.003, enamel.LINER)
    floor = low + wall + 0.003
    plate = min(cavity[0], cavity[1]) / 2 - 0.012
    b.cylinder(plate, 0.006, (x, middle - wall / 2, floor + 0.008), materials.CLEAR_GLASS, sections=24)
    b.cylinder(0.03, 0.005, (x, middle - wall / 2, floor + 0.0025), materials.GRAY_PLASTIC, sections=8, solid=False)
    free = b.h - wall - 0.005 - floor - 0.011
    b.space("inside", (1.3 * plate, 1.3 * plate, free), (x, middle - wall / 2, floor + 0.011 + free / 2), enclosed=True)
    b.box((b.w - 0.08, b.d - reach - 0.06, feet), (0, (face + y1) / 2, feet / 2), materials.RUBBER)
    if side:
        panel = materials.BLACK_PLASTIC if b.variant != 1 else body
        b.box((side, b.d / 2 - face, tall), (b.w / 2 - side / 2, (face + y1) / 2, feet + tall / 2), body, radius=soft)
        b.box(
            (side - 0.012, 0.004, tall - 0.02), (b.w / 2 - side / 2, face - 0.001, feet + tall / 2), panel, solid=False
        )
        _microwave_controls(b, b.w / 2 - side / 2, side, face - 0.003, feet, tall)
    else:
        b.box((b.w, b.d / 2 - face, strip), (0, (face + y1) / 2, feet + strip / 2), body, radius=0.012, segments=2)
        for sx in (-0.36, 0.36):
            _dial(b, sx * b.w, feet + strip / 2, face, strip * 0.36)
        b.box((0.12, 0.004, strip * 0.5), (0, face - 0.001, feet + strip / 2), materials.BLACK_PLASTIC, solid=False)
        b.box((0.07, 0.002, strip * 0.22), (0, face - 0.0035, feet + strip / 2), enamel.DISPLAY, solid=False)
    with b.link("door", "revolute", axis="-z", upper=float(np.radians(108)), origin=(-b.w / 2, face + thick, b.h / 2)):
        high = b.h - low - 0.003
        z = low + 0.002 + high / 2
        b.box((width - 0.003, thick, high), (x, face + thick / 2, z), body, radius=soft, segments=2)
        glass = (width - 0.012, high - 0.012) if b.variant == 3 else (0.74 * width, 0.68 * high)
        shift = -0.02 if b.variant in (0, 1) else 0.0
        b.box(
            (glass[0], 0.004, glass[1]), (x + shift, face - 0.001, z), materials.DARK_GLASS, radius=0.001, solid=False
        )
        b.box((0.8 * width, 0.004, 0.76 * high), (x, face + thick + 0.0005, z), materials.DARK_GLASS, solid=False)
        if b.variant == 2:
            b.handle((0, face, b.h - 0.032), 0.6 * b.w, materials.CHROME, reach=reach, radius=0.008)
        elif b.variant < 2:
            b.handle((x + width / 2 - 0.03, face, z), 0.78 * high, metal, axis="z", reach=reach, radius=0.008)
    b.space("top", (b.w - 0.04, 0.8 * b.d, 0.4), (0, middle, b.h + 0.2))
    b.looks_like(materials.DARK_GLASS if b.variant == 3 and body is materials.BLACK_METAL else body)


def _microwave_controls(b: Builder, x: float, side: float, face: float, feet: float, tall: float) -> None:
    if b.variant == 1:
        for z in (0.68, 0.32):
            _dial(b, x, feet + z * tall, face, min(0.3 * side, 0.042))
        return
    b.box((side * 0.74, 0.003, tall * 0.13), (x, face - 0.0015, feet + tall * 0.86), materials.DARK_GLASS, solid=False)
    b.box((side * 0.44, 0.002, tall * 0.06), (x, face - 0.004, feet + tall * 0.86), enamel.DISPLAY, solid=False)
    key = materials.GRAY_PLASTIC
    for row in range(5):
        for column in (-1, 0, 1):
            at = (x + column * side * 0.25, face - 0.0015, feet + tall * (0.7 - 0.115 * row))
            b.box((side * 0.19, 0.003, tall * 0.065), at, key, solid=False)
    b.box((side * 0.72, 0.003, tall * 0.07), (x, face - 0.0015, feet + tall * 0.09), materials.STEEL, solid=False)


def _dial(b: Builder, x: float, z: float, face: float, radius: float) -> None:
    b.cylinder(radius, 0.022, (x, face - 0.011, z), materials.CHROME, axis="y", top_radius=radius * 0.9, solid=False)
    b.box((0.004, 0.004, radius * 0.9), (x, face - 0.0235, z + radius * 0.4), materials.BLACK_PLASTIC, solid=False)


def toaster(b: Builder) -> None:
    """A toaster with open slots: round-shouldered, boxy steel, soft plastic on a chrome base, or tapered."""
    retro, plain = b.pick(enamel.RETRO), b.pick((materials.WHITE_PLASTIC, materials.BLACK_PLASTIC))
    body = b.by_variant((retro, materials.STEEL, plain, retro))
    reach, foot = 0.03, 0.014
    long, y = b.d - reach, reach / 2
    corner = b.by_variant((0.05, 0.012, 0.06, 0.03))
    taper = b.by_variant((1.0, 1.0, 0.97, 0.86))
    shoulder = min(b.by_variant((0.055, 0.012, 0.03, 0.04)), 0.3 * b.w)
    turns = np.radians(np.linspace(0, 80, 6))
    rings = []
    for z, inset in [
        (foot, 0.0),
        *((b.h - 0.004 - shoulder * (1 - np.sin(a)), shoulder * (1 - np.cos(a))) for a in turns),
    ]:
        narrow = 1 - (1 - taper) * (z - foot) / (b.h - foot)
        size = (narrow * b.w - 2 * inset, narrow * long - 2 * inset)
        ring = primitives.rounded_rect(*size, max(corner - 0.6 * inset, 0.008), 3)
        rings.append(np.column_stack([ring, np.full(len(ring), z)]))
    b.add(primitives.loft(rings, capped=False), body, (0, y, 0))
    base = primitives.rounded_rect(b.w - 0.012, long - 0.012, corner, 3)
    trim = materials.CHROME if b.variant == 2 else materials.BLACK_PLASTIC
    b.add(primitives.prism(base, foot), trim, (0, y, foot / 2), solid=True)
    _slots(b, rings[-1][:, :2], y, long, foot)
    end = y - long / 2 * (1 - (1 - taper) * 0.5) - 0.001
    for x in (-b.w / 4, b.w / 4) if b.w > FOUR_SLOTS_M else (0.0,):
        b.box((0.008, 0.004, 0.5 * b.h), (x, end, 0.56 * b.h), materials.SHADOW_GAP, solid=False)
        lever, at = (0.05, reach - 0.002, 0.016), (x, -b.d / 2 + reach / 2, 0.74 * b.h)
        b.box(lever, at, materials.BLACK_PLASTIC, radius=0.006, solid=False)
        b.knob((x, end, 0.22 * b.h), 0.016, materials.CHROME, reach=0.018)
    if b.variant == 3:
        for x in (-0.2, 0.2):
            b.cylinder(
                0.009, 0.006, (x * b.w, end - 0.002, 0.22 * b.h), materials.CHROME, axis="y", sections=10, solid=False
            )
    b.looks_like(body)


def _slots(b: Builder, top: F64, y: float, long: float, foot: float) -> None:
    """The plate on top, dark slots below it that reach down to a floor, and the toaster's collision boxes."""
    count = 4 if b.w > FOUR_SLOTS_M else 2
    half, length = float(top[:, 0].max()), 1.68 * float(top[:, 1].max())
    width = min(0.034, 0.8 * half / count)
    xs = [(2 * i + 1 - count) * half / count for i in range(count)]
    holes = [primitives.rounded_rect(width, length, 0.008, 2) + np.array([x, 0.0]) for x in xs]
    floor, plate = 0.062, 0.01
    b.add(
        primitives.prism(top, plate, holes),
        materials.STEEL if b.variant != 1 else materials.CHROME,
        (0, y, b.h - plate / 2),
    )
    deep = b.h - plate - floor
    b.add(primitives.prism(0.99 * top, deep, holes), materials.SHADOW_GAP, (0, y, floor + deep / 2))
    b.box((2 * half - 0.03, 0.8 * long, floor - foot), (0, y, (floor + foot) / 2), materials.SHADOW_GAP)
    pockets = [(x - width / 2, y - length / 2, floor, x + width / 2, y + length / 2, b.h + 1) for x in xs]
    hull = (-0.46 * b.w, y - 0.46 * long, floor, 0.46 * b.w, y + 0.46 * long, b.h)
    for x0, y0, z0, x1, y1, z1 in solid_around(hull, pockets):
        b.solid((x1 - x0, y1 - y0, z1 - z0), ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2))
    for i, x in enumerate(xs):
        b.space(f"slot {i}", (width, length, b.h + 0.02 - floor), (x, y, (b.h + 0.02 + floor) / 2))


KINDS = {
    "Microwave": Kind(microwave),
    "Toaster": Kind(toaster),
}
