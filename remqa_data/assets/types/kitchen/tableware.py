"""Mugs, cups, plates, bowls: what one drinks and eats from."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import ceramic, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.turnery import Piece, Profile, loop, radius_at, rounded, turned, turned_vessel

CREAM = ceramic("beige", (0.93, 0.88, 0.77))
STONEWARE = Material("ceramic", "beige", (0.77, 0.66, 0.52), gloss=0.1)
ENAMELS = tuple(
    Material("metal", color, rgb, gloss=0.55)
    for color, rgb in (
        ("red", (0.72, 0.16, 0.14)),
        ("blue", (0.18, 0.34, 0.55)),
        ("green", (0.30, 0.50, 0.42)),
        ("orange", (0.88, 0.45, 0.15)),
        ("white", (0.93, 0.93, 0.90)),
    )
)
TINTED_GLASSES = (
    materials.CLEAR_GLASS,
    Material("glass", "green", (0.55, 0.74, 0.60), gloss=0.7),
    Material("glass", "orange", (0.85, 0.62, 0.34), gloss=0.7),
    Material("glass", "purple", (0.60, 0.52, 0.74), gloss=0.7),
)


def mug(b: Builder) -> None:
    """A mug with a handle at +x: straight; bellied; flared with an unglazed foot; enamelled with a coloured rim."""
    with b.quarter_turned(b.d > b.w):
        _mug(b)


def cup(b: Builder) -> None:
    """A cup without a handle: glass tumbler; paper cup with a sleeve; goblet on a stem; ridged plastic cup."""
    r, h = min(b.w, b.d) / 2, b.h
    b.by_variant((_tumbler, _paper_cup, _goblet, _plastic_cup))(b, r, h)


def plate(b: Builder) -> None:
    """A plate: white with a rim line; with a broad coloured rim; stoneware with a raised edge; rounded square."""
    r, h = min(b.w, b.d) / 2, b.h
    color = b.pick(materials.CERAMICS[1:])
    body = b.by_variant(
        (
            materials.WHITE_CERAMIC,
            materials.WHITE_CERAMIC,
            b.pick((STONEWARE, *materials.CERAMICS[1:4])),
            b.pick((CREAM, color)),
        )
    )
    rim = b.by_variant((color, color, materials.tinted(body, 0.65), materials.tinted(body, 0.85)))
    well, slope_to, line = b.by_variant(
        ((0.60, 0.68, 0.93), (0.58, 0.65, 0.72), (0.86, 0.94, 0.955), (0.66, 0.74, 0.965))
    )
    floor = min(0.006, 0.35 * h)
    slope_z = (floor + h) / 2
    edge, edge_z, line_z = 0.975, *(float(np.interp(t, (slope_to, 1.0), (slope_z, h))) for t in (0.975, line))
    below: Profile = [(0.0, 0.0), (0.58 * r, 0.0), (0.62 * r, 0.002), (0.985 * r, h - 0.004), (r, h - 0.002)]
    above: Profile = [(slope_to * r, slope_z), (well * r, floor), (0.0, floor)]
    turned(
        b,
        [
            (body, below),
            (body if b.variant == 1 else rim, [(0.995 * r, h), (edge * r, edge_z)]),
            (rim, [(line * r, line_z)]),
            (body, above),
        ],
        sections=28,
        power=b.by_variant((2, 2, 2, 5)),
    )
    b.hollow([*below, (0.995 * r, h), *above], floor=floor, boxes=b.by_variant((8, 8, 8, 4)))
    b.space("top", (1.2 * r, 1.2 * r, 0.15), (0, 0, floor + 0.075))
    b.looks_like(color if b.variant == 1 else body)


def bowl(b: Builder) -> None:
    """A bowl: half a sphere on a foot; wide with a flat rim; wooden salad bowl; noodle bowl with a band."""
    r, h = min(b.w, b.d) / 2, b.h
    glaze = b.pick(
        (materials.OAK, materials.WALNUT, materials.CHERRY) if b.variant == 2 else (*materials.CERAMICS, CREAM)
    )
    other = b.pick([c for c in (*materials.CERAMICS, STONEWARE) if c.color != glaze.color])
    lining = b.by_variant((materials.WHITE_CERAMIC, glaze, materials.tinted(glaze, 1.15), materials.WHITE_CERAMIC))
    shape = b.by_variant(
        (
            [(0.42, 0.06), (0.76, 0.13), (0.95, 0.45), (1.0, 0.9), (1.0, 1.0)],
            [(0.40, 0.06), (0.64, 0.10), (0.76, 0.55), (0.80, 0.82), (0.84, 0.90), (0.98, 0.95), (1.0, 1.0)],
            [(0.55, 0.0), (0.80, 0.08), (0.97, 0.42), (1.02, 0.80), (0.96, 1.0)],
            [(0.42, 0.12), (0.62, 0.20), (0.80, 0.55), (0.92, 0.80), (0.95, 0.86), (1.0, 1.0)],
        )
    )
    side = [(p * r, z * h) for p, z in shape]
    foot: Profile = [(0.0, 0.0), (side[0][0], 0.0)]
    bend = rounded(side[:-1])
    pieces: list[Piece] = [
        (other if b.variant == 3 else glaze, [*foot, *bend[:2]]),
        (glaze, bend[2:]),
        (other if b.variant in (0, 3) else glaze, side[-1:]),
    ]
    turned_vessel(b, pieces, lining, wall=b.by_variant((0.004, 0.004, 0.008, 0.004)), floor=0.10 * h + 0.003, steps=3)
    b.looks_like(glaze)


def _mug(b: Builder) -> None:
    glaze = b.pick(ENAMELS if b.variant == 3 else materials.CERAMICS)
    contrast = ENAMELS[1] if glaze.color in ("white", "red") else materials.WHITE_METAL
    foot, lip, lining = b.by_variant(
        ((glaze, glaze, glaze), (glaze, glaze, CREAM), (STONEWARE, glaze, glaze), (glaze, contrast, ENAMELS[4]))
    )
    shape = b.by_variant(
        (
            [(0.94, 0.0), (1.0, 0.06), (1.0, 0.3), (1.0, 0.94), (0.98, 1.0)],
            [(0.62, 0.0), (0.74, 0.04), (0.94, 0.25), (1.0, 0.48), (0.92, 0.76), (0.85, 0.93), (0.87, 1.0)],
            [(0.62, 0.0), (0.68, 0.04), (0.80, 0.36), (0.90, 0.70), (0.99, 0.96), (1.0, 1.0)],
            [(0.90, 0.0), (0.94, 0.04), (0.94, 0.35), (0.94, 0.93), (1.0, 0.95), (1.0, 1.0)],
        )
    )
    radius = min(b.d / 2, b.w * 0.42)
    side = [(r * radius, z * b.h) for r, z in shape]
    x = radius - b.w / 2
    pieces: list[Piece] = [(foot, [(0, 0), *side[:3]]), (glaze, side[3:-2]), (lip, side[-2:])]
    turned_vessel(b, pieces, lining, (x, 0, 0), wall=0.004, floor=0.008, sections=18)
    low, high = b.by_variant(((0.2, 0.82), (0.22, 0.76), (0.24, 0.86), (0.2, 0.84)))
    grip = [(x + radius_at(side, z * b.h) - 0.003, 0.0, z * b.h) for z in (low, high)]
    reach = b.w / 2 - 0.0055 - (grip[0][0] + grip[1][0]) / 2
    path = loop(grip[0], grip[1], (reach, 0, 0), power=b.by_variant((2.0, 2.0, 2.6, 4.0)))
    b.add(primitives.tube(path, 0.0055), glaze)
    b.solid((reach, 0.011, (high - low) * b.h), ((b.w - reach) / 2, 0, (low + high) / 2 * b.h))
    b.looks_like(glaze)


def _tumbler(b: Builder, r: float, h: float) -> None:
    glass = b.pick(TINTED_GLASSES)
    thick = [(0.0, 0.0), (0.74 * r, 0.0), (0.78 * r, 0.004), (0.80 * r, 0.12 * h)]
    pieces: list[Piece] = [
        (materials.tinted(glass, 0.78), thick),
        (glass, [(0.97 * r, 0.88 * h)]),
        (materials.tinted(glass, 1.15), [(0.99 * r, 0.97 * h), (r, h)]),
    ]
    turned_vessel(b, pieces, materials.tinted(glass, 1.1), wall=0.0035, floor=0.10 * h)
    b.looks_like(glass)


def _paper_cup(b: Builder, r: float, h: float) -> None:
    kraft = paint("brown", "paper", 0.05, (0.72, 0.55, 0.38))
    paper, sleeve = b.pick(
        (
            (materials.PAPER, materials.CARDBOARD),
            (materials.PAPER, paint("green", "paper", 0.05, (0.16, 0.38, 0.26))),
            (kraft, materials.PAPER),
            (materials.PAPER, paint("brown", "paper", 0.05, (0.36, 0.23, 0.15))),
        )
    )
    pieces: list[Piece] = [
        (paper, [(0.0, 0.006), (0.66 * r, 0.006), (0.66 * r, 0.0), (0.68 * r, 0.0), (0.76 * r, 0.28 * h)]),
        (sleeve, [(0.785 * r, 0.28 * h), (0.90 * r, 0.70 * h), (0.875 * r, 0.70 * h)]),
        (paper, [(0.95 * r, 0.945 * h), (0.99 * r, 0.95 * h), (r, 0.975 * h), (0.98 * r, h)]),
    ]
    turned_vessel(b, pieces, materials.PAPER, wall=0.003, floor=0.012)
    b.looks_like(paper)


def _goblet(b: Builder, r: float, h: float) -> None:
    glass = b.pick((*TINTED_GLASSES, materials.BRASS, materials.STEEL))
    stem, up = max(0.004, 0.09 * r), 0.40 * h
    foot = rounded([(0.70 * r, 0.0), (0.66 * r, 0.010), (stem, 0.05 * h), (stem, up), (0.5 * r, up + 0.03 * h)])
    side = rounded([(0.5 * r, up + 0.03 * h), (0.98 * r, up + 0.14 * h), (1.03 * r, up + 0.34 * h), (0.86 * r, h)])
    pieces: list[Piece] = [(glass, [(0.0, 0.0), *foot, *side])]
    turned_vessel(b, pieces, glass, wall=0.003, floor=up + 0.04 * h, sections=14, steps=3)


def _plastic_cup(b: Builder, r: float, h: float) -> None:
    plastic = b.pick([paint(color, gloss=0.35) for color in ("red", "blue", "green", "yellow")])
    ridges = [(0.70, 0.0), (0.79, 0.34), (0.82, 0.34), (0.89, 0.70), (0.92, 0.70)]
    pieces: list[Piece] = [
        (plastic, [(0.0, 0.0), *((p * r, z * h) for p, z in ridges), (0.965 * r, 0.95 * h)]),
        (materials.WHITE_PLASTIC, [(r, 0.955 * h), (r, 0.985 * h), (0.98 * r, h)]),
    ]
    turned_vessel(b, pieces, materials.WHITE_PLASTIC, wall=0.003, floor=0.012)
    b.looks_like(plastic)


KINDS = {"Mug": Kind(mug), "Cup": Kind(cup), "Plate": Kind(plate), "Bowl": Kind(bowl)}
