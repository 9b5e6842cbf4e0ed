"""Beds for people and for dogs."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts import forms
from remqa_data.geometry.types import Vec3

FREE_ABOVE_M = 0.5
LOFT_FROM_M = 1.2
"""A mattress higher than this belongs to a loft bed."""
CANOPY_FROM_M = 0.95
"""Posts that rise this far above the mattress carry a canopy's rails."""

SHEET = materials.fabric("white", rgb=(0.95, 0.95, 0.93))
BLANKETS = (
    *materials.FABRICS,
    materials.fabric("white", "knit", 0.3),
    materials.fabric("purple", "knit", 0.3, (0.52, 0.42, 0.60)),
    materials.fabric("blue", "wallpaper_stripe", 0.5, (0.62, 0.71, 0.84)),
    materials.fabric("pink", "wallpaper_damask", 0.6, (0.90, 0.72, 0.74)),
    materials.fabric("green", "wallpaper_damask", 0.6, (0.66, 0.76, 0.62)),
)


def bed(b: Builder) -> None:
    """A bed: panelled wood, padded headboard, metal bars, or a low platform; high ones are loft or canopy beds."""
    rest = b.level(min(max(b.h - 0.34, 0.4), 0.6 * b.h) if b.h < 1.4 else 0.38 * b.h, 0.3, b.h - 0.03)
    wood = b.pick((*materials.WOODS, materials.WHITE_WOOD, materials.GRAY_WOOD))
    thick = min(0.24, 0.5 * rest)
    loft = rest > LOFT_FROM_M
    frame = _loft(b, rest, thick, wood) if loft else _bed_frame(b, rest, thick, wood)
    _mattress(b, rest, thick, frame)
    if not loft and b.h - rest > CANOPY_FROM_M:
        _canopy(b, wood)
    inside = (b.w - 0.14, b.d - 0.18, FREE_ABOVE_M)
    b.space("mattress", inside, (0, 0, rest + FREE_ABOVE_M / 2))


OVAL_PLAN = ((0.95, 0.45), (0.45, 0.95), (0.75, 0.75))
"""Shares of width and depth of boxes that together are about an oval, whose corners are free to walk on."""


def dog_bed(b: Builder) -> None:
    """A dog bed: round bolster, rectangle with a low front, flat mat, or a wicker basket with a cushion."""
    cloth = b.pick((*materials.FABRICS, materials.fabric("beige", "knit", 0.2)))
    inner = b.pick(
        (
            materials.fabric("beige", "towel", 0.2),
            materials.fabric("white", "towel", 0.2),
            materials.fabric("gray", "towel", 0.2),
        )
    )
    if b.variant == 0:
        floor = b.level(0.42 * b.h, 0.2 * b.h, 0.7 * b.h)
        b.add(forms.ring(0.5, 0.18, 28, 10).scaled((b.w, b.d, b.h / 0.18)), cloth, (0, 0, b.h / 2))
        _wall_boxes(b, 0.15)
    elif b.variant == 1:
        floor = b.level(0.38 * b.h, 0.2 * b.h, 0.7 * b.h)
        r = min(0.5 * b.h, 0.16 * b.d)
        base = primitives.prism(primitives.rounded_rect(b.w - 1.5 * r, b.d - 1.2 * r, 0.14), 0.3 * b.h)
        b.add(base, cloth, (0, 0, 0.15 * b.h))
        turn = np.radians(np.linspace(-62, 242, 25))
        cs = np.column_stack([np.cos(turn), np.sin(turn)])
        rim = np.sign(cs) * np.abs(cs) ** 0.5 * [b.w / 2 - r, b.d / 2 - r]
        path = np.column_stack([rim, np.zeros(25)])
        b.add(primitives.tube(path, r, 10).scaled((1, 1, 0.5 * b.h / r)), cloth, (0, 0, 0.5 * b.h))
        for x, y, _ in (path[0], path[-1]):
            b.add(primitives.ellipsoid((2 * r, 2 * r, b.h), 12, 8), cloth, (float(x), float(y), b.h / 2))
        b.box(
            (0.6 * b.w, 1.4 * r, 0.5 * b.h),
            (0, r - b.d / 2 + 0.005, 0.25 * b.h),
            cloth,
            radius=0.4 * r,
            segments=2,
            solid=False,
        )
        _wall_boxes(b, 0.15, front=False)
    elif b.variant == 2:
        floor = 0.98 * b.h  # a mat has no hollow
        b.box((b.w, b.d, 0.98 * b.h), (0, 0, 0.49 * b.h), cloth, radius=0.46 * b.h, segments=3, solid=False)
        b.box((0.86 * b.w, 0.86 * b.d, 0.4 * b.h), (0, 0, 0.8 * b.h), inner, radius=0.19 * b.h, segments=2, solid=False)
    else:
        floor = b.level(0.5 * b.h, 0.2 * b.h, 0.75 * b.h)
        rim = primitives.ellipse(b.w, b.d, 28, 3.0)
        hole = primitives.ellipse(b.w - 0.09, b.d - 0.09, 28, 3.0)
        wall = primitives.prism(rim, 1.0, [hole])
        dip = np.where(
            wall.vertices[:, 1] < -0.3 * b.d, np.clip((np.abs(wall.vertices[:, 0]) / b.w - 0.12) / 0.2, 0, 1), 1.0
        )
        wall.vertices[:, 2] = (wall.vertices[:, 2] + 0.5) * b.h * (0.62 + 0.38 * dip)
        b.add(wall, materials.WICKER)
        _wall_boxes(b, 0.05, front=False)
    if b.variant != 2:
        pad = primitives.ellipse(b.w * 0.8, b.d * 0.8, 24, 2.0 if b.variant == 0 else 4.0)
        tall = floor - 0.02
        rings = [
            np.column_stack([f * pad, np.full(24, z)])
            for f, z in ((1, 0.02), (1, 0.6 * tall), (0.94, 0.9 * tall + 0.01), (0.8, floor))
        ]
        b.add(primitives.loft(rings), inner)
    plan = OVAL_PLAN if b.variant in (0, 3) else ((0.95, 0.95),)
    for across, along in plan:
        b.solid((across * b.w, along * b.d, floor), (0, 0, floor / 2))
    _paw(
        b, (0, 0, floor + (0.041 * b.h if b.variant == 2 else 0.0)), 0.15 * min(b.w, b.d), materials.tinted(cloth, 0.6)
    )
    b.looks_like(materials.WICKER if b.variant == 3 else cloth)
    b.space("cushion", (0.66 * b.w, 0.66 * b.d, FREE_ABOVE_M), (0, 0, floor + FREE_ABOVE_M / 2))


def _bed_frame(b: Builder, rest: float, thick: float, wood: Material) -> Material:
    """Headboard, side rails, legs and footboard; returns the material that names the frame."""
    head = b.h if b.h - rest < CANOPY_FROM_M else rest + 0.6
    deck = rest - thick
    y = b.d / 2
    rail = min(0.2, 0.6 * deck + 0.06)
    if b.variant == 1:
        cloth = b.pick((*materials.FABRICS, *materials.LEATHERS[:3]))
        b.legs((b.w - 0.06, b.d - 0.06, 0.1), materials.BLACK_METAL, thickness=0.05, taper=0.7)
        b.box((b.w, b.d - 0.02, deck + 0.02), (0, -0.01, deck / 2 + 0.06), cloth, radius=0.03, segments=2)
        b.box((b.w, 0.1, head - 0.05), (0, y - 0.05, (head + 0.05) / 2), cloth, radius=0.03, segments=2)
        _tufts(b, rest, head, y - 0.1, cloth)
        return cloth
    if b.variant == 2:
        metal = b.pick((materials.BLACK_METAL, materials.WHITE_METAL, materials.BRASS))
        for end, top in ((1, head), (-1, min(rest + 0.12, head))):
            _bars(b, end * (y - 0.025), top, deck, metal)
        for side in (-1, 1):
            b.box((0.03, b.d - 0.06, 0.05), (side * (b.w / 2 - 0.025), 0, deck), metal)
        b.box((b.w - 0.06, b.d - 0.06, 0.03), (0, 0, deck - 0.015), materials.BLACK_METAL)
        return metal
    low_platform = b.variant == 3
    post = 0.06
    if low_platform:
        plinth = 0.55 * deck
        b.box((b.w - 0.3, b.d - 0.3, plinth), (0, 0, plinth / 2), materials.tinted(wood, 0.5))
        b.box((b.w, b.d, deck - plinth + 0.03), (0, 0, (deck + plinth + 0.03) / 2), wood, radius=0.008)
        planks = max(2, round((head - deck) / 0.22))
        for i in range(planks):
            tall = (head - deck - 0.03) / planks
            b.box((b.w, 0.04, tall - 0.008), (0, y - 0.02, deck + 0.03 + (i + 0.5) * tall + 0.004), wood, radius=0.006)
        return wood
    for x in (-1, 1):
        for end, top in ((1, head), (-1, min(rest + 0.05, head))):
            b.box((post, post, top), (x * (b.w - post) / 2, end * (y - post / 2), top / 2), wood, radius=0.008)
        b.box((0.03, b.d - post, rail), (x * (b.w / 2 - 0.03), 0, deck + 0.04 - rail / 2), wood)
    b.box((b.w - 0.08, b.d - 0.08, 0.03), (0, 0, deck - 0.015), wood)
    for end, top in ((1, head - 0.02), (-1, min(rest, head - 0.04))):
        low = deck + 0.04 - rail
        b.box((b.w - 2 * post + 0.01, 0.03, top - low), (0, end * (y - post / 2), (top + low) / 2), wood)
        b.box((b.w - 2 * post + 0.01, 0.05, 0.05), (0, end * (y - post / 2), top - 0.02), wood, radius=0.008)
        panels = 3 if b.w > 1.3 else 2
        for i in range(panels):
            wide = (b.w - 2 * post) / panels
            tall = min(top - rest - 0.02, 0.5) if end > 0 else top - low - 0.1
            if tall > 0.06:
                at = ((i - (panels - 1) / 2) * wide, end * (y - post / 2) - 0.018, top - 0.06 - tall / 2)
                b.box((wide - 0.07, 0.012, tall - 0.03), at, wood, radius=0.005, solid=False)
    return wood


def _tufts(b: Builder, low: float, high: float, y: float, cloth: Material) -> None:
    """Buttons on a padded headboard, or channels where only a little of it shows."""
    rows = min(4, int((high - low - 0.06) / 0.14))
    columns = max(3, round(b.w / 0.24))
    button = primitives.ellipsoid((0.03, 0.03, 0.014), 6, 3).pointed("-y")
    for i in range(rows):
        for j in range(columns - i % 2):
            x = (j - (columns - 1 - i % 2) / 2) * 0.92 * b.w / columns
            b.add(button, materials.tinted(cloth, 0.7), (x, y - 0.002, high - 0.1 - 0.14 * i))


def _bars(b: Builder, y: float, top: float, deck: float, metal: Material) -> None:
    """One end of a metal bed: two posts, two rails, upright bars and knobs."""
    r = 0.02
    knob = min(0.03, 0.3 * top)
    for x in (-1, 1):
        b.cylinder(r, top - knob, (x * (b.w / 2 - 0.025), y, (top - knob) / 2), metal, sections=10)
        b.add(primitives.ellipsoid((0.05, 0.05, 0.05), 10, 6), metal, (x * (b.w / 2 - 0.025), y, top - 0.025))
    high = top - knob - 0.04
    low = min(deck + 0.02, high - 0.05)
    for z in (low, high):
        b.cylinder(0.014, b.w - 0.05, (0, y, z), metal, axis="x", sections=8)
    count = max(4, round(b.w / 0.16))
    for i in range(1, count):
        at = (i / count - 0.5) * (b.w - 0.05)
        b.cylinder(0.008, high - low, (at, y, (high + low) / 2), metal, sections=6, solid=False)
    b.solid((b.w, 0.04, high), (0, y, high / 2))


def _loft(b: Builder, rest: float, thick: float, wood: Material) -> Material:
    """A high bed on posts with guard rails; its ladder leans on the foot end or, in odd variants, on the left side."""
    metal = b.pick((materials.BLACK_METAL, materials.WHITE_METAL))
    frame = metal if b.variant > 1 else wood
    post, deck = (0.045 if b.variant > 1 else 0.07), rest - thick
    guards = ((deck - 0.02, 0.14), (b.h - 0.03, 0.06), (0.25 * deck, 0.06))
    for x in (-1, 1):
        for end in (-1, 1):
            b.box((post, post, b.h), (x * (b.w - post) / 2, end * (b.d - post) / 2, b.h / 2), frame, radius=0.006)
        for z, tall in guards[:2]:
            b.box((0.03, b.d - post, tall), (x * (b.w / 2 - 0.035), 0, z), frame)
    for end in (-1, 1):
        for z, tall in guards:
            b.box((b.w - post, 0.03, tall), (0, end * (b.d / 2 - 0.035), z), frame)
    b.box((b.w - 0.06, b.d - 0.06, 0.03), (0, 0, deck - 0.015), frame)
    steps = int(deck / 0.26)
    sideways = b.variant % 2 == 1
    for i in range(1, steps + 1):
        z = i * deck / (steps + 0.5)
        b.box(*_ladder_part(b, (0.4, 0.03, 0.03), 0.0, z, sideways=sideways), frame)
    for u in (-0.2, 0.2):
        b.box(*_ladder_part(b, (0.035, 0.03, b.h), u, b.h / 2, sideways=sideways), frame)
    return frame


def _ladder_part(b: Builder, size: Vec3, u: float, z: float, *, sideways: bool) -> tuple[Vec3, Vec3]:
    """Size and place of a ladder's part, `u` metres along the foot end or the left side."""
    along, out, tall = size
    if sideways:
        return (out, along, tall), (out / 2 - b.w / 2, u - 0.2 * b.d, z)
    return (along, out, tall), (u, out / 2 - b.d / 2, z)


def _mattress(b: Builder, rest: float, thick: float, frame: Material) -> None:
    """Mattress with sheet, and a blanket with its edge folded back over three quarters of it."""
    side = 0.05
    width, length = b.w - 2 * side, b.d - 0.15
    b.box((width, length, thick), (0, 0, rest - thick / 2), SHEET, radius=0.05, segments=2, solid=False)
    b.solid((width, length, thick), (0, 0, rest - thick / 2))
    cover = b.pick([blanket for blanket in BLANKETS if blanket.color != frame.color])
    lining = b.pick([SHEET, materials.tinted(cover, 1.25)])
    drop = min(thick, 0.22)
    reach = length * b.between(0.62, 0.74)
    y = -length / 2 + reach / 2 - 0.012
    b.box((width + 0.03, reach, drop), (0, y, rest + 0.008 - drop / 2), cover, radius=0.06, segments=3, solid=False)
    fold = min(0.26, 0.14 * length)
    at = (0, y + reach / 2 - fold / 2 + 0.01, rest + 0.014 - 0.9 * drop / 2)
    b.box((width + 0.04, fold, 0.9 * drop), at, lining, radius=0.06, segments=3, solid=False)
    b.looks_like(cover)


def _canopy(b: Builder, wood: Material) -> None:
    """Four posts to the top of the box, with rails and a gathered curtain at each post."""
    post, drape = 0.05, 0.09
    curtain = b.pick((SHEET, materials.FABRICS[0], materials.FABRICS[2]))
    for x in (-1, 1):
        for end in (-1, 1):
            b.box((post, post, b.h), (x * (b.w - post) / 2, end * (b.d - post) / 2, b.h / 2), wood, radius=0.008)
            for i in range(3):  # folds
                at = (x * (b.w / 2 - 0.03), end * (b.d / 2 - 0.09 - i * 0.07), 0.56 * b.h)
                b.box((0.05, drape, 0.84 * b.h), at, curtain, radius=0.024, solid=False)
        b.box((post, b.d - 2 * post, 0.05), (x * (b.w - post) / 2, 0, b.h - 0.025), wood)
    for end in (-1, 1):
        b.box((b.w - 2 * post, post, 0.05), (0, end * (b.d - post) / 2, b.h - 0.025), wood)


def _wall_boxes(b: Builder, share: float, *, front: bool = True) -> None:
    """Collision boxes of a bolster that is a share of the size thick; `front` says whether it goes all round."""
    for x in (-1, 1):
        b.solid((share * b.w, 0.45 * b.d, 0.9 * b.h), (x * b.w * (1 - share) / 2, 0, 0.45 * b.h))
    for y in (-1, 1) if front else (1,):
        b.solid((0.45 * b.w, share * b.d, 0.9 * b.h), (0, y * b.d * (1 - share) / 2, 0.45 * b.h))


def _paw(b: Builder, at: Vec3, size: float, cloth: Material) -> None:
    """A paw print that lies on a cushion."""
    toes = [(-0.75, 0.25, 0.3), (-0.28, 0.7, 0.32), (0.28, 0.7, 0.32), (0.75, 0.25, 0.3)]
    for x, y, r in (*toes, (0.0, -0.25, 0.55)):
        disc = primitives.prism(primitives.ellipse(2 * r * size, 2 * r * size * 0.85, 14), 0.006)
        b.add(disc, cloth, (at[0] + x * size, at[1] + y * size, at[2]))


KINDS = {"Bed": Kind(bed), "DogBed": Kind(dog_bed)}
