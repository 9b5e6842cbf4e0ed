"""Bottles that stand: of water, oil, milk, wine and soap."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.turnery import Profile, radius_at, rounded, sticker, turned

OIL_LABEL, SOAP_LABEL, HONEY_LABEL = (materials.picture(f"label_{i}") for i in (1, 2, 3))
ACCENTS = tuple(paint(color, "paper", 0.1) for color in ("red", "blue", "green", "black", "orange"))
AMBER = Material("glass", "orange", (0.70, 0.40, 0.14), gloss=0.7)
CORK = Material("cork", "brown", (0.72, 0.54, 0.36))
WINE_GLASSES = (
    Material("glass", "green", (0.09, 0.22, 0.12), gloss=0.8),
    Material("glass", "black", (0.10, 0.10, 0.09), gloss=0.8),
    Material("glass", "green", (0.36, 0.44, 0.18), gloss=0.8),
    Material("glass", "brown", (0.27, 0.14, 0.07), gloss=0.8),
    Material("glass", "pink", (0.86, 0.52, 0.50), gloss=0.8),
)
SOAPS = tuple(
    paint(color, gloss=0.5, rgb=rgb)
    for color, rgb in (
        ("pink", (0.90, 0.62, 0.68)),
        ("blue", (0.45, 0.66, 0.84)),
        ("green", (0.52, 0.76, 0.50)),
        ("orange", (0.93, 0.65, 0.32)),
        ("white", (0.94, 0.94, 0.93)),
        ("purple", (0.62, 0.52, 0.76)),
    )
)


def bottle(b: Builder) -> None:
    """A bottle: plastic water bottle; square honey bottle with a stopper; oil bottle with a pourer; milk bottle."""
    b.by_variant((_water_bottle, _honey_bottle, _oil_bottle, _milk_bottle))(b, min(b.w, b.d) / 2, b.h)


def wine_bottle(b: Builder) -> None:
    """A wine bottle with foil and label: high shoulders; sloping shoulders; slender; sparkling with a broad cork."""
    r, h = min(b.w, b.d) / 2, b.h
    glass = b.pick(WINE_GLASSES)
    foil = b.pick([paint(color, "metal", 0.5) for color in ("red", "black", "white")] + [materials.BRASS])
    if b.variant == 3:
        foil = b.pick((materials.BRASS, materials.CHROME))
    shoulder = b.by_variant(
        (
            [(1.0, 0.60), (0.98, 0.66), (0.42, 0.72), (0.36, 0.80)],
            [(1.0, 0.46), (0.96, 0.56), (0.50, 0.68), (0.36, 0.80)],
            [(0.98, 0.40), (0.86, 0.56), (0.44, 0.72), (0.35, 0.82)],
            [(1.0, 0.44), (0.96, 0.54), (0.52, 0.66), (0.42, 0.74)],
        )
    )
    low, high = b.by_variant(((0.14, 0.46), (0.12, 0.40), (0.12, 0.36), (0.14, 0.38)))
    cap = [(0.38, 0.80), (0.37, 0.965), (0.41, 0.97), (0.41, 0.985), (0.36, 1.0), (0.0, 1.0)]
    cork = [(0.46, 0.74), (0.42, 0.90), (0.47, 0.91), (0.40, 0.93), (0.50, 0.98), (0.40, 1.0), (0.0, 1.0)]
    top = _scaled(cork if b.variant == 3 else cap, r, h)
    side = [(0.985 * r, 0.02 * h), *rounded(_scaled(shoulder, r, h)), (shoulder[-1][0] * r, top[0][1])]
    turned(b, [(glass, [(0.0, 0.0), (0.92 * r, 0.0), *side]), (foil, top)], sections=18)
    _paper_label(b, side, low * h, high * h, share=0.45)
    if b.variant == 1:
        _paper_label(b, side, 0.62 * h, 0.67 * h, share=0.35)
    elif b.variant == 2:
        sticker(b, foil, [(radius_at(side, z * h), z * h) for z in (0.40, 0.42)], share=1.0, sections=18)
    _bottle_solids(b, r, h, 0.65)
    b.looks_like(glass)


def soap_bottle(b: Builder) -> None:
    """A soap bottle: round with a pump; oval dish soap with a cap; square glass with a pump; waisted with a pump."""
    r, h = b.w / 2, b.h
    glassy = (materials.BROWN_GLASS, materials.WHITE_CERAMIC, AMBER, materials.BLACK_PLASTIC)
    soap = b.pick(glassy if b.variant == 2 else SOAPS)
    shape = b.by_variant(
        (
            [(0.90, 0.0), (1.0, 0.03), (1.0, 0.56), (0.92, 0.64), (0.42, 0.68)],
            [(0.84, 0.0), (0.94, 0.03), (1.0, 0.30), (0.86, 0.55), (0.92, 0.68), (0.60, 0.82), (0.30, 0.84)],
            [(0.96, 0.0), (1.0, 0.02), (1.0, 0.60), (0.94, 0.64), (0.36, 0.66)],
            [(0.92, 0.0), (1.0, 0.05), (0.98, 0.18), (0.74, 0.40), (0.84, 0.55), (0.70, 0.64), (0.40, 0.68)],
        )
    )
    body = rounded(_scaled(shape, r, h))
    neck = float(body[-1][1])
    plan = (1.0, b.d / b.w)
    power = b.by_variant((2.0, 2.0, 5.0, 2.0))
    turned(b, [(soap, [(0.0, 0.0), *body, (0.0, neck)])], sections=16, power=power, stretch=plan)
    low, high = b.by_variant(((0.12, 0.48), (0.12, 0.44), (0.14, 0.50), (0.08, 0.28)))
    heights = np.linspace(low, high, 5) * h
    label = [(radius_at(body, z), float(z)) for z in heights]
    sticker(b, SOAP_LABEL, label, share=b.by_variant((0.4, 0.36, 0.24, 0.4)), sections=16, power=power, stretch=plan)
    bright = (materials.WHITE_PLASTIC, paint("red"), paint("blue"), materials.WHITE_PLASTIC)
    if b.variant == 1:
        width = 0.34 * r
        cap = [(width, neck), (width, 0.94 * h), (0.42 * width, 0.955 * h), (0.36 * width, h), (0.0, h)]
        turned(b, [(b.pick(bright), [(0.0, neck), *cap])], sections=14)
    else:
        _pump(b, neck, b.pick((materials.BLACK_PLASTIC, materials.CHROME) if b.variant == 2 else bright))
    b.solid((1.5 * r, 0.75 * b.d, neck), (0, 0, neck / 2))
    b.solid((0.4 * r, 0.4 * r, h - neck), (0, 0, (neck + h) / 2))
    b.looks_like(soap)


def _water_bottle(b: Builder, r: float, h: float) -> None:
    tints = ((0.45, 0.70, 0.52), (0.40, 0.62, 0.84))
    water = b.pick(
        (materials.CLEAR_GLASS, *(paint(c, gloss=0.5, rgb=t) for c, t in zip(("green", "blue"), tints, strict=True)))
    )
    cap = b.pick([paint(color) for color in ("blue", "red", "white", "green")])
    ribs = [(p, z + dz) for z in (0.14, 0.24) for p, dz in ((1.0, 0.0), (0.93, 0.025), (1.0, 0.05))]
    low = _scaled([(0.0, 0.0), (0.85, 0.0), (0.98, 0.03), *ribs, (0.97, 0.36), (0.97, 0.60)], r, h)
    shoulder = rounded(_scaled([(1.0, 0.64), (0.98, 0.72), (0.70, 0.82), (0.32, 0.86), (0.30, 0.91)], r, h))
    lid = _scaled([(0.38, 0.91), (0.38, 0.99), (0.33, 1.0), (0.0, 1.0)], r, h)
    turned(b, [(water, [*low, *shoulder]), (cap, lid)], sections=16)
    _paper_label(b, low, 0.37 * h, 0.59 * h, share=1.0)
    _bottle_solids(b, r, h, 0.75)
    b.looks_like(water)


def _honey_bottle(b: Builder, r: float, h: float) -> None:
    drink = b.pick((AMBER, materials.BROWN_GLASS, Material("glass", "yellow", (0.86, 0.66, 0.20), gloss=0.7)))
    base = _scaled([(0.0, 0.0), (0.93, 0.0), (0.98, 0.03)], r, h)
    side = rounded(_scaled([(1.0, 0.08), (1.0, 0.58), (0.95, 0.66), (0.34, 0.69), (0.27, 0.76)], r, h))
    turned(b, [(materials.tinted(drink, 0.75), base), (drink, [*side, (0.27 * r, 0.86 * h)])], power=6.0)
    sticker(b, HONEY_LABEL, [(r, 0.14 * h), (r, 0.46 * h)], share=0.2, power=6.0)
    collar = _scaled([(0.0, 0.85), (0.36, 0.85), (0.36, 0.89), (0.28, 0.90)], r, h)
    stopper = _scaled([(0.44, 0.91), (0.44, 0.985), (0.38, 1.0), (0.0, 1.0)], r, h)
    turned(b, [(materials.BLACK_PLASTIC, collar), (b.pick((CORK, materials.BLACK_PLASTIC)), stopper)], sections=14)
    _bottle_solids(b, r, h, 0.68)
    b.looks_like(drink)


def _oil_bottle(b: Builder, r: float, h: float) -> None:
    glass = b.pick((materials.GREEN_GLASS, Material("glass", "yellow", (0.76, 0.66, 0.20), gloss=0.7)))
    side = _scaled([(1.0, 0.05), (1.0, 0.48), (0.90, 0.60), (0.36, 0.70), (0.24, 0.78), (0.22, 0.86)], r, h)
    top = _scaled([(0.28, 0.86), (0.28, 0.91), (0.12, 0.915), (0.07, 0.94)], r, h)
    turned(
        b,
        [(glass, [(0.0, 0.0), (0.94 * r, 0.0), *rounded(side)]), (materials.BLACK_PLASTIC, [*top, (0.0, 0.94 * h)])],
        sections=18,
    )
    path = [(0.0, 0.0, 0.93 * h), (0.0, 0.0, 0.955 * h), (0.08 * r, 0.0, 0.975 * h), (0.34 * r, 0.0, 0.998 * h)]
    b.add(primitives.tube(path, [0.06 * r, 0.06 * r, 0.055 * r, 0.045 * r], 6), materials.CHROME)
    sticker(b, OIL_LABEL, [(r, 0.12 * h), (r, 0.44 * h)], share=0.45, sections=18)
    _bottle_solids(b, r, h, 0.6)
    b.looks_like(glass)


def _milk_bottle(b: Builder, r: float, h: float) -> None:
    drink = b.pick(
        (
            materials.WHITE_CERAMIC,
            paint("pink", "glass", 0.6),
            paint("orange", "glass", 0.6),
        )
    )
    glass = materials.CLEAR_GLASS
    side = _scaled([(1.0, 0.04), (1.0, 0.50), (0.92, 0.62), (0.52, 0.72), (0.46, 0.80)], r, h)
    rim = _scaled([(0.46, 0.84), (0.54, 0.86), (0.54, 0.92)], r, h)
    lid = _scaled([(0.57, 0.92), (0.59, 0.985), (0.54, 1.0), (0.0, 1.0)], r, h)
    foil = b.pick((materials.CHROME, materials.BRASS, paint("red", "metal"), paint("blue", "metal")))
    turned(b, [(drink, [(0.0, 0.0), (0.95 * r, 0.0), *rounded(side)]), (glass, rim), (foil, lid)], sections=18)
    _bottle_solids(b, r, h, 0.65)
    b.looks_like(drink)


def _paper_label(b: Builder, side: Profile, low: float, high: float, share: float) -> None:
    """A paper label with coloured stripes between two heights of a body."""
    accent = b.pick(ACCENTS)
    for material, start, end, lift in (
        (materials.PAPER, 0.0, 1.0, 0.0),
        (accent, 0.0, 0.12, 0.0004),
        (accent, 0.52, 0.84, 0.0004),
        (materials.BRASS, 0.30, 0.34, 0.0004),
    ):
        heights = [low + t * (high - low) for t in (start, end)]
        band = [(radius_at(side, z) + lift, z) for z in heights]
        sticker(b, material, band, share=share, sections=18)


def _pump(b: Builder, neck: float, material: Material) -> None:
    """A pump above a neck: collar, stem, and a head with a nozzle towards -y."""
    h, size = b.h, 0.5 * min(b.w, b.d)
    collar = max(0.011, 0.42 * size)
    rise = h - neck
    turned(
        b,
        [
            (
                material,
                [
                    (0.0, neck),
                    (collar, neck),
                    (collar, neck + 0.30 * rise),
                    (0.6 * collar, neck + 0.34 * rise),
                    (0.30 * collar, neck + 0.36 * rise),
                    (0.30 * collar, neck + 0.80 * rise),
                ],
            )
        ],
        sections=12,
    )
    top = neck + 0.76 * rise
    thick = (h - top) / 2
    b.add(primitives.cylinder(1.1 * collar, 2 * thick, 0.9 * collar, 12), material, (0, 0, h - thick))
    out, z = -b.d / 2, h - 1.1 * thick
    nozzle = [(0, 0, z), (0, 0.80 * out, z), (0, 0.94 * out, z - 0.4 * thick), (0, out + 0.002, z - 1.8 * thick)]
    b.add(primitives.tube(nozzle, [0.8 * thick, 0.7 * thick, 0.6 * thick, 0.5 * thick], 6), material)


def _bottle_solids(b: Builder, r: float, h: float, shoulder: float) -> None:
    b.solid((1.5 * r, 1.5 * r, shoulder * h), (0, 0, shoulder * h / 2))
    b.solid((0.6 * r, 0.6 * r, (1 - shoulder) * h), (0, 0, (1 + shoulder) * h / 2))


def _scaled(profile: Profile, r: float, h: float) -> list[tuple[float, float]]:
    return [(float(p) * r, float(z) * h) for p, z in profile]


KINDS = {"Bottle": Kind(bottle), "WineBottle": Kind(wine_bottle), "SoapBottle": Kind(soap_bottle)}
