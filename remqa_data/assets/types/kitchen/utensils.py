"""Knives, forks, spoons, ladles, spatulas: flat on the table, handle towards the front."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts.turnery import Station, rod
from remqa_data.geometry.types import F64

SILVER = Material("metal", "gray", (0.78, 0.79, 0.81), gloss=0.7)
BLADE = Material("metal", "gray", (0.70, 0.72, 0.74), gloss=0.75)
NYLON = paint("black", gloss=0.2, rgb=(0.15, 0.15, 0.16))
Curve = Sequence[tuple[float, float]]
"""(fraction of the length, fraction of the height) points of a bent handle."""
HANDLES = (
    paint("black", gloss=0.3),
    paint("white", gloss=0.4),
    paint("red", gloss=0.3),
    paint("blue", gloss=0.3),
    paint("green", gloss=0.3),
    materials.OAK,
    materials.WALNUT,
)


def butter_knife(b: Builder) -> None:
    """A table knife with a blunt blade: all steel; waisted, brass or white; spreader; coloured handle."""
    p = Posed(b, flat=True)
    handle = b.pick(b.by_variant(((SILVER,), (materials.BRASS, HANDLES[1]), HANDLES[5:], HANDLES[:5])))
    joint = -p.d / 2 + p.d * b.by_variant((0.48, 0.46, 0.50, 0.45))
    tip, w = p.d / 2, p.w
    edge = b.by_variant(
        (
            [
                (0.0, -0.22),
                (0.04, -0.5),
                (0.75, -0.5),
                (0.92, -0.34),
                (1.0, 0.05),
                (0.97, 0.30),
                (0.85, 0.32),
                (0.0, 0.26),
            ],
            [
                (0.0, -0.20),
                (0.10, -0.36),
                (0.5, -0.48),
                (0.85, -0.42),
                (1.0, 0.1),
                (0.93, 0.34),
                (0.5, 0.26),
                (0.0, 0.22),
            ],
            [
                (0.0, -0.2),
                (0.12, -0.26),
                (0.3, -0.5),
                (0.8, -0.5),
                (1.0, -0.1),
                (1.0, 0.2),
                (0.8, 0.5),
                (0.3, 0.5),
                (0.12, 0.26),
                (0.0, 0.2),
            ],
            [(0.0, -0.2), (0.06, -0.45), (0.8, -0.5), (1.0, 0.24), (0.0, 0.24)],
        )
    )
    outline = [(x * w, joint + (tip - joint) * y) for y, x in edge]
    _blade(p, outline, 0.0018, p.h * 0.45)
    thin, wide = b.by_variant(((0.42, 0.72), (0.34, 0.80), (0.55, 0.70), (0.60, 0.74)))
    _grip(p, -p.d / 2, joint + 0.006, (wide * w, thin * w), p.h, handle)
    p.rest(1.0, 1.0)
    b.looks_like(BLADE if handle is SILVER else handle)


def knife(b: Builder) -> None:
    """A kitchen knife: chef's; santoku; cleaver-like nakiri; serrated bread knife."""
    p = Posed(b, flat=True)
    handle = b.pick(b.by_variant((HANDLES[:1], HANDLES[5:], HANDLES[5:], HANDLES[:4])))
    joint = -p.d / 2 + p.d * 0.37
    tip, w = p.d / 2, p.w
    spine = 0.5 if b.variant != 3 else 0.38
    edge = b.by_variant(
        (
            [(0.0, -0.5), (0.35, -0.48), (0.65, -0.32), (0.87, 0.02), (1.0, 0.42), (0.8, 0.48), (0.4, 0.5), (0.0, 0.5)],
            [
                (0.0, -0.5),
                (0.7, -0.48),
                (0.92, -0.36),
                (1.0, -0.22),
                (0.97, 0.1),
                (0.86, 0.38),
                (0.74, 0.5),
                (0.0, 0.5),
            ],
            [(0.0, -0.5), (0.95, -0.5), (1.0, -0.40), (1.0, 0.44), (0.98, 0.5), (0.0, 0.5)],
            [
                *((y, x) for i in range(12) for y, x in ((i / 13, -0.40), (i / 13 + 0.04, -0.5))),
                (0.96, -0.35),
                (1.0, 0.1),
                (0.97, spine),
                (0.0, spine),
            ],
        )
    )
    outline = [(x * w, joint + (tip - joint) * y) for y, x in edge]
    _blade(p, outline, 0.0025, p.h / 2)
    wide = 0.52 * w
    x = spine * w - wide * 0.62
    _grip(p, -p.d / 2, joint + 0.004, (wide, wide * 0.85), p.h, handle, x=x)
    bolster = primitives.rounded_box((wide * 0.9, 0.012, p.h * 0.8), 0.002, 1)
    p.add(bolster, SILVER, (x, joint, p.h / 2))
    for t in (0.25, 0.5, 0.75):
        y = -p.d / 2 + t * (joint + p.d / 2)
        p.add(primitives.cylinder(0.0035, p.h + 0.0006, sections=8), SILVER, (x, y, p.h / 2))
    p.rest(1.0, 1.0)
    b.looks_like(BLADE)


def fork(b: Builder) -> None:
    """A table fork with four tines: plain; slender; three tines; coloured handle."""
    p = Posed(b, flat=True)
    metal = b.pick((materials.BRASS, materials.COPPER)) if b.variant == 1 else SILVER
    tines, wide = b.by_variant(((4, 0.62), (4, 0.50), (3, 0.70), (4, 0.66)))
    curve = ((0.0, 0.15), (0.25, 0.55), (0.52, 1.0), (0.64, 0.55), (0.78, 0.0), (1.0, 0.5))
    _curved_handle(b, p, metal, wide, curve[:4])
    w, root, tip = p.w, -p.d / 2 + 0.74 * p.d, p.d / 2
    palm = [(root - 0.14 * p.d, 0.30 * w), (root - 0.07 * p.d, 0.85 * w), (root, w)]
    p.add(rod([(y, width, 0.0025, _rise(p, curve, y)) for y, width in palm], 6), metal)
    thick = w / (tines * 1.7 - 0.7)
    for i in range(tines):
        x = (w - thick) * (i / (tines - 1) - 0.5)
        ends = [
            (y, thick * s, 0.0022, _rise(p, curve, y))
            for y, s in ((root - 0.004, 1.0), (root + 0.6 * (tip - root), 0.9), (tip, 0.3))
        ]
        p.add(rod(ends, 4), metal, (x, 0, 0))
    p.rest(1.0, 1.0)


def spoon(b: Builder) -> None:
    """A spoon: table spoon; slender; wooden; coloured handle."""
    p = Posed(b, flat=True)
    metal = b.by_variant((SILVER, b.pick((materials.BRASS, materials.COPPER)), b.pick(HANDLES[5:]), SILVER))
    length = min(b.by_variant((1.55, 1.75, 1.3, 1.5)) * p.w, 0.45 * p.d)
    depth = min(0.6 * p.h, 0.012)
    curve = ((0.0, 0.15), (0.25, 0.55), (0.52, 1.0), (1.03 - length / p.d, depth / p.h))
    _curved_handle(b, p, metal, b.by_variant((0.46, 0.36, 0.30, 0.40)), curve)
    _dish(p, (p.w, length), (0.0, (p.d - length) / 2), depth, metal, egg=b.by_variant((0.14, 0.2, 0.0, 0.12)))
    p.rest(1.0, 1.0)


def ladle(b: Builder) -> None:
    """A soup ladle: steel with a hook; black nylon; steel with a wooden handle; coloured."""
    p = Posed(b, flat=True)
    color = b.pick(HANDLES[2:5])
    dish = b.by_variant((SILVER, NYLON, SILVER, color))
    grip = b.by_variant((SILVER, NYLON, b.pick(HANDLES[5:]), color))
    r = p.w / 2
    deep = min(p.h, 1.0 * r) if p.h > 0.6 * r else p.h
    y = p.d / 2 - r
    t = np.linspace(-np.pi / 2, -0.05, 5)
    curve = np.column_stack([np.cos(t), 1 + np.sin(t)])
    outside = [(0.0, 0.0), *((c * r, s * deep) for c, s in curve[1:])]
    inside = [(c * (r - 0.0025), 0.0025 + s * (deep - 0.0025)) for c, s in curve[:0:-1]]
    p.add(primitives.revolve([*outside, *inside, (0.0, 0.0025)], 16), dish, (0, y, 0))
    end = -p.d / 2
    start, top = y - r, 0.95 * deep
    span = start - end
    thick = 0.005
    line = [
        (start + 0.003, 0.014, top - 0.004),
        (start - 0.10 * span, 0.010, p.h - thick / 2),
    ]
    line += [
        (end + 0.5 * span, 0.010, 0.62 * p.h),
        (end + 0.38 * span, 0.012, 0.5 * p.h),
        (end + 0.1 * span, 0.018, 0.016),
        (end + 0.002, 0.016, 0.008),
    ]
    cut = 6 if b.variant in (0, 1) else 4
    p.add(rod([(a, wide, thick, z) for a, wide, z in line[:cut]][::-1], 6), dish if cut == 6 else SILVER)
    if cut == 4:
        p.add(rod([(a, wide * 1.15, thick * 2.2, max(z, thick * 1.2)) for a, wide, z in line[2:]][::-1]), grip)
    hole = primitives.cylinder(0.004, thick * 2.2 + 0.001, sections=8).turned(primitives.turn("x", 6))
    p.add(hole, materials.SHADOW_GAP, (0, end + 0.014, 0.0115))
    p.solid((1.2 * r, 1.2 * r, deep), (0, y, deep / 2))
    p.solid((0.018, span, 0.02), (0, (start + end) / 2, min(0.5 * p.h, 0.02)))
    b.looks_like(dish)


def spatula(b: Builder) -> None:
    """A spatula to turn food with: slotted nylon; steel with a wooden handle; wooden; silicone scraper."""
    p = Posed(b, flat=True)
    wood = b.pick(HANDLES[5:])
    blade = b.by_variant((NYLON, BLADE, wood, b.pick(HANDLES[1:5])))
    grip = b.by_variant((b.pick((NYLON, *HANDLES[2:4])), wood, wood, b.pick((wood, SILVER))))
    w, tip = p.w, p.d / 2
    root = tip - b.by_variant((0.33, 0.36, 0.36, 0.34)) * p.d
    thin = b.by_variant((0.003, 0.0018, 0.006, 0.007))
    edge = b.by_variant(
        (
            [(0.0, 0.16), (0.10, 0.40), (0.95, 0.5), (1.0, 0.46)],
            [(0.0, 0.20), (0.06, 0.46), (0.97, 0.5), (1.0, 0.46)],
            [(0.0, 0.14), (0.25, 0.34), (0.55, 0.48), (0.8, 0.5), (0.95, 0.42), (1.0, 0.2)],
            [(0.0, 0.30), (0.08, 0.48), (0.70, 0.5), (0.92, 0.44), (1.0, 0.26)],
        )
    )
    half = [(x * w, root + (tip - root) * y) for y, x in edge]
    outline = half + [(-x, y) for x, y in half[::-1]]
    if b.variant == 3:  # one corner is square
        outline[-len(half) :] = [(-0.5 * w, tip), (-0.5 * w, root + 0.01), (-0.30 * w, root)]
    slots = b.by_variant((4, 3, 0, 0))
    holes: list[F64] = []
    for i in range(slots):
        x = (i - (slots - 1) / 2) * 0.20 * w
        long = b.by_variant((0.52, 0.64, 0, 0)) * (tip - root)
        middle = root + 0.58 * (tip - root)
        holes.append(primitives.rounded_rect(0.075 * w, long, 0.03 * w, 2) + np.array([x, middle]))
    p.add(primitives.prism(outline, thin, holes), blade, (0, 0, thin / 2), grain="y")
    end = -p.d / 2
    span = root - end
    thick = min(0.012, 0.8 * p.h)
    up = p.h - thick / 2
    neck: list[Station] = [
        (root + 0.02, 0.016, 0.003, thin / 2 + 0.0015),
        (root - 0.06 * span, 0.012, 0.005, 0.35 * up + thin / 2),
        (root - 0.28 * span, 0.010, 0.006, up),
        (end + 0.55 * span, 0.010, 0.007, up),
    ]
    stem = grip if b.variant == 2 else NYLON if b.variant == 0 else SILVER
    p.add(rod(neck[::-1], 6), stem, grain="y")
    wide = 0.020
    handle = [
        (end, 0.6 * wide, 0.7 * thick, up),
        (end + 0.05 * span, wide, thick, up),
        (end + 0.4 * span, 0.9 * wide, thick, up),
    ]
    handle += [(end + 0.56 * span, 0.012, 0.8 * thick, up)]
    p.add(rod(handle), grip, grain="y")
    p.add(
        primitives.cylinder(0.004, thick * 0.96 + 0.001, sections=8), materials.SHADOW_GAP, (0, end + 0.07 * span, up)
    )
    p.solid((w, tip - root, thin), (0, (tip + root) / 2, thin / 2))
    p.solid((wide, 0.7 * span, p.h), (0, end + 0.35 * span, p.h / 2))
    b.looks_like(blade)


def _blade(p: Posed, outline: list[tuple[float, float]], thickness: float, z: float) -> None:
    p.add(primitives.prism(outline, thickness), BLADE, (0, 0, z))


def _grip(
    p: Posed,
    start: float,
    end: float,
    widths: tuple[float, float],
    thickness: float,
    material: Material,
    x: float = 0.0,
) -> None:
    """A handle along y, wide at its end and narrower at the blade, as thick as the box."""
    wide, narrow = widths
    span, z = end - start, p.h / 2
    stations = [
        (0.0, 0.7 * wide, 0.7),
        (0.04, wide, 0.95),
        (0.25, wide, 1.0),
        (0.7, narrow, 1.0),
        (0.97, narrow, 0.9),
        (1.0, 0.9 * narrow, 0.7),
    ]
    p.add(
        rod([(start + t * span, w, h * thickness, z) for t, w, h in stations], 8, 3.5), material, (x, 0, 0), grain="y"
    )


def _rise(p: Posed, curve: Curve, y: float) -> float:
    """Height in metres of the middle of a fork or spoon at y."""
    t, up = zip(*curve, strict=True)
    return float(np.interp((y + p.d / 2) / p.d, t, up)) * (p.h - 0.003) + 0.0015


def _curved_handle(b: Builder, p: Posed, metal: Material, wide: float, curve: Curve) -> None:
    """The handle of a fork or spoon up to the end of its curve; in variant 3 with coloured scales."""
    narrow, thick = (0.009, 0.006) if metal.substance == "wooden" else (0.0055, 0.0028)
    shape = [(0.0, 0.6 * wide), (0.02, 0.92 * wide), (0.10, wide), (0.35, 0.55 * wide)]
    stations = [(t, max(s * p.w, narrow)) for t, s in shape] + [(0.52, narrow), (curve[-1][0], narrow * 1.3)]
    placed = [(t * p.d - p.d / 2, w, thick) for t, w in stations]
    p.add(rod([(y, w, h, _rise(p, curve, y)) for y, w, h in placed], 6), metal, grain="y")
    if b.variant == 3:
        color = b.pick(HANDLES)
        scales = [(y, w * 1.1, 0.007, _rise(p, curve, y) + 0.001) for y, w, _ in placed[:5]]
        p.add(rod(scales), color, grain="y")
        b.looks_like(color)


def _dish(
    p: Posed, size: tuple[float, float], at: tuple[float, float], depth: float, metal: Material, egg: float
) -> None:
    """The bowl of a spoon: an oval hollow, narrower towards its tip."""
    t = np.linspace(-1, 1, 7)
    u, v = np.meshgrid(t, t, indexing="ij")
    x, y = u * np.sqrt(1 - v**2 / 2), v * np.sqrt(1 - u**2 / 2)
    sag = 1 - (x**2 + y**2) ** 1.2
    narrowed: F64 = x * (1 - egg * (y + 1) / 2 * 1.4)
    mesh: Mesh = primitives.sheet(narrowed * size[0] / 2, y * size[1] / 2, 0.0012 + depth * (1 - sag), 0.0016)
    p.add(mesh, metal, (at[0], at[1], 0.0))


KINDS = {
    "ButterKnife": Kind(butter_knife),
    "Knife": Kind(knife),
    "Fork": Kind(fork),
    "Spoon": Kind(spoon),
    "Ladle": Kind(ladle),
    "Spatula": Kind(spatula),
}
