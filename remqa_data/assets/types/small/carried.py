"""Cards, discs and keys: small things that one carries."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, BRASS, CHROME, STEEL, WHITE_PLASTIC, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts import forms
from remqa_data.geometry.types import F64, Vec3

INK = Material("paper", "black", (0.12, 0.12, 0.13))
KEY_METALS = (CHROME, BRASS, STEEL)
DISC = Material("plastic", "gray", (0.82, 0.84, 0.88), gloss=0.7)


def credit_card(b: Builder) -> None:
    """A bank card: with a chip and rings, back up with its stripe, with a diagonal band, or dark with gold."""
    with b.quarter_turned(b.d > b.w):
        w, d, h = b.w, b.d, b.h
        color = b.by_variant(
            (
                b.pick(("blue", "red", "purple")),
                b.pick(("white", "gray", "beige")),
                b.pick(("green", "orange", "pink")),
                "black",
            )
        )
        base = paint(color, gloss=0.4)
        top = h - 0.0006
        b.add(primitives.prism(primitives.rounded_rect(w, d, 0.06 * w, 4), top), base, (0, 0, top / 2), solid=True)
        low, high = top + 0.0003, h
        accent = b.by_variant((materials.tinted(base, 1.35), INK, paint("white"), BRASS))
        if b.variant == 1:
            b.panel((w, 0.22 * d), (0, 0.24 * d, low), INK, facing="z")
            b.panel((0.6 * w, 0.14 * d), (-0.12 * w, -0.04 * d, low), materials.PAPER, facing="z")
            for i in range(4):
                b.panel((0.52 * w, 0.008 * d), (-0.12 * w, (-0.09 + 0.035 * i) * d, high), paint("blue"), facing="z")
            b.panel((0.13 * w, 0.14 * d), (0.30 * w, -0.04 * d, low), WHITE_PLASTIC, facing="z")
            for y, wide in ((-0.26, 0.8), (-0.32, 0.7), (-0.38, 0.5)):
                b.panel((wide * w, 0.02 * d), (-0.05 * w, y * d, low), materials.tinted(base, 0.6), facing="z")
        else:
            if b.variant == 2:
                band = [(-0.1 * w, -d / 2), (0.25 * w, -d / 2), (0.42 * w, d / 2), (0.07 * w, d / 2)]
                b.add(primitives.prism(band, 0.0003), accent, (0, 0, top))
            b.box((0.14 * w, 0.17 * d, 0.0004), (-0.32 * w, 0.08 * d, high - 0.0002), BRASS, solid=False)
            for y in (0.04, 0.12):
                b.panel(
                    (0.14 * w, 0.012 * d), (-0.32 * w, y * d, high + 0.0001), materials.tinted(BRASS, 0.6), facing="z"
                )
            ink = BRASS if b.variant == 3 else CHROME if b.variant == 0 else INK
            for i in range(4):
                b.panel((0.16 * w, 0.09 * d), ((-0.32 + 0.2 * i) * w, -0.15 * d, low), ink, facing="z")
                for gap in (-1, 0, 1):
                    b.panel(
                        (0.006 * w, 0.09 * d), ((-0.32 + 0.2 * i + 0.04 * gap) * w, -0.15 * d, high), base, facing="z"
                    )
            b.panel((0.42 * w, 0.05 * d), (-0.19 * w, -0.36 * d, low), ink, facing="z")
            b.panel((0.34 * w, 0.08 * d), (-0.22 * w, 0.36 * d, low), ink, facing="z")
            _card_mark(b, (0.33 * w, 0.28 * d, low), 0.13 * d)
    b.looks_like(base)


def cd(b: Builder) -> None:
    """A compact disc: shiny, with a printed label, in a paper sleeve with a window, or in a flat case."""
    board = Posed(b, flat=True)
    w, d, h = board.w, board.d, board.h
    label = paint(b.pick(("red", "blue", "green", "yellow", "orange", "purple")), gloss=0.3)
    sleeve = b.by_variant((None, None, materials.PAPER, paint("black", gloss=0.5)))
    low, wide = 0.0, 1.0
    if sleeve is not None:
        low, wide = 0.5 * h, 0.84
        board.add(primitives.box((w, d, low)), sleeve, (0, 0, low / 2))
        if b.variant == 3:
            board.add(
                primitives.box((0.10 * w, d, h - low)), materials.tinted(sleeve, 1.8), (-0.45 * w, 0, (h + low) / 2)
            )
            for x, y, sx, sy in ((0.05, 0.48, 0.9, 0.04), (0.05, -0.48, 0.9, 0.04), (0.48, 0, 0.04, 1.0)):
                board.add(
                    primitives.box((sx * w, sy * d, h - low)), materials.CLEAR_GLASS, (x * w, y * d, (h + low) / 2)
                )
        else:
            for x, y, sx, sy in (
                (-0.46, 0, 0.08, 1),
                (0.46, 0, 0.08, 1),
                (0, -0.46, 0.84, 0.08),
                (0, 0.46, 0.84, 0.08),
            ):
                board.add(primitives.box((sx * w, sy * d, h - low)), sleeve, (x * w, y * d, (h + low) / 2))
    x = 0.05 * w if b.variant == 3 else 0.0
    radius, hole = wide / 2, 0.125 * wide / 2
    top = h - 0.0008
    stretch = (w, d, 1.0)
    ring = [(hole, 0), (radius, 0), (radius, top - low), (hole, top - low), (hole, 0)]
    board.add(primitives.revolve(ring, 28).scaled(stretch), DISC, (x, 0, low))
    shine = primitives.disc(radius * 0.97, hole * 2.4, 28).scaled(stretch)
    board.add(shine, materials.picture("cd", "gray", "plastic"), (x, 0, top + 0.0003))
    if b.variant in (1, 3):
        printed = primitives.disc(radius * 0.93, hole * 2.6, 28).scaled(stretch)
        board.add(printed, label, (x, 0, top + 0.0006))
        board.add(primitives.box((0.4 * wide * w, 0.07 * d, 0.0002)), WHITE_PLASTIC, (x, 0.28 * wide * d, h - 0.0001))
        board.add(primitives.box((0.5 * wide * w, 0.03 * d, 0.0002)), INK, (x, -0.26 * wide * d, h - 0.0001))
        board.add(primitives.box((0.3 * wide * w, 0.03 * d, 0.0002)), INK, (x, -0.33 * wide * d, h - 0.0001))
    board.solid((w, d, h), (0, 0, h / 2))
    b.looks_like(sleeve or (label if b.variant == 1 else DISC))


def key_chain(b: Builder) -> None:
    """Keys on a ring: with a leather tag, a round tag, a car key, or a braided cord."""
    with b.quarter_turned(b.d > b.w):
        w, d, h = b.w, b.d, b.h
        rod = min(0.0016, 0.22 * h)
        radius = min(0.34 * d, 0.016)
        x0 = -0.08 * w
        ring = forms.ring(radius, rod, 20, 5)
        b.add(ring, CHROME, (x0, 0, max(rod, 0.5 * h)))
        count = b.by_variant((3, 2, 2, 3))
        bow = min(0.022, 0.5 * d)
        start = x0 + radius - 0.3 * bow
        long = w / 2 - start
        steep = min(40.0, float(np.degrees(np.arctan((d / 2 - bow * 0.2) / long))))
        thick = min(0.0025, 0.9 * h / count)
        for i, angle in enumerate(np.linspace(-steep, steep, count) if count > 1 else (0.0,)):
            outline = _key_outline(long / float(np.cos(np.radians(angle))), bow, i)
            hole = np.array([0.32 * bow, 0]) + primitives.ellipse(0.34 * bow, 0.34 * bow, 8)
            z = thick / 2 + i * (h - thick) / max(count - 1, 1)
            key = primitives.prism(outline, thick, [hole]).turned(primitives.turn("z", float(angle)))
            b.add(key, KEY_METALS[(i + b.variant) % 3], (start, 0, z))
        tag = _key_tag(b, x0 - radius, h)
        b.solid((0.9 * w, 0.7 * d, h), (0, 0, h / 2))
    b.looks_like(tag)


def _card_mark(b: Builder, at: Vec3, radius: float) -> None:
    x, y, z = at
    if b.variant == 0:
        b.add(primitives.disc(radius, sections=16), paint("white"), (x - 0.6 * radius, y, z))
        b.add(primitives.disc(radius, 0.7 * radius, 16), paint("yellow"), (x + 0.6 * radius, y, z + 0.0003))
    elif b.variant == 2:
        b.add(primitives.disc(radius, sections=5), INK, at)
    else:
        for k in (0.4, 0.7, 1.0):
            wave = np.vstack(
                [
                    primitives.arc((0, 0), k * radius, -45, 45, 5),
                    primitives.arc((0, 0), (k - 0.14) * radius, 45, -45, 5),
                ]
            )
            b.add(primitives.prism(wave, 0.0004), BRASS, (x - 0.5 * radius, y, z))


def _key_outline(long: float, bow: float, cut: int) -> F64:
    """A key along +x, its bow at the start: round, eight- or six-sided, with teeth on one side."""
    t = np.linspace(0.32, 2 * np.pi - 0.32, (12, 8, 6)[cut % 3])
    head = np.column_stack([bow / 2 + bow / 2 * np.cos(t), bow / 2 * np.sin(t)])
    blade = 0.14 * bow
    teeth = []
    for i in range(4):
        x = long * (0.96 - 0.09 * i)
        deep = blade * (1.0, 0.35, 0.8, 0.5)[(i + cut) % 4]
        teeth += [(x, -deep), (x - 0.04 * long, -blade * 1.6)]
    return np.vstack([head, [(long * 0.6, -blade), *reversed(teeth), (long, 0.0), (0.96 * long, blade)]])


def _key_tag(b: Builder, x: float, height: float) -> Material:
    """What hangs on the ring's other side, from x to the left edge; returns its material."""
    long = x + b.w / 2
    wide = min(0.7 * b.d, 0.032, 0.8 * long)
    z = height / 2
    middle = x - long / 2
    shade = paint(b.pick(("red", "blue", "green", "yellow", "orange", "pink")), gloss=0.4)
    if b.variant == 0:
        leather = b.pick(materials.LEATHERS)
        outline = primitives.rounded_rect(0.86 * long, wide, 0.3 * wide, 3) - [0.07 * long, 0]
        b.add(primitives.prism(outline, height), leather, (middle, 0, z))
        b.add(primitives.disc(0.1 * wide, sections=10), CHROME, (x - 0.24 * long, 0, height + 0.0003))
        b.box((0.22 * long, 0.006, 0.5 * height), (x - 0.06 * long, 0, z), leather, solid=False)
        return leather
    if b.variant == 1:
        around = min(long * 0.84, 0.9 * b.d)
        tag = primitives.cylinder(0.5, height, sections=20).scaled((max(around, 0.84 * long), around, 1.0))
        b.add(tag, shade, (x - 0.58 * long, 0, z))
        b.add(primitives.disc(0.36 * around, 0.28 * around, 18), WHITE_PLASTIC, (x - 0.58 * long, 0, height + 0.0004))
        b.box((0.24 * long, 0.004, 0.4 * height), (x - 0.08 * long, 0, z), CHROME, solid=False)
        return shade
    if b.variant == 2:
        outline = primitives.rounded_rect(0.84 * long, wide, 0.42 * wide, 4) - [0.08 * long, 0]
        b.add(primitives.prism(outline, height), BLACK_PLASTIC, (middle, 0, z))
        for dx, color in ((-0.26, "red"), (-0.06, "gray"), (0.14, "gray")):
            b.box(
                (0.13 * long, 0.5 * wide, 0.0006), (middle + dx * long, 0, height + 0.0003), paint(color), solid=False
            )
        b.box((0.22 * long, 0.006, 0.5 * height), (x - 0.06 * long, 0, z), CHROME, solid=False)
        return BLACK_PLASTIC
    for side in (-1, 1):
        t = np.linspace(0, 1, 9)
        path = np.column_stack([x - 0.9 * long * t, side * 0.10 * wide * np.cos(t * 5 * np.pi), np.full(9, z)])
        b.add(primitives.tube(path, min(0.003, 0.45 * height), 4), shade)
    b.add(
        primitives.ellipsoid((0.26 * long, min(0.8 * b.d, 0.26 * long), height), 8, 5),
        shade,
        (-b.w / 2 + 0.13 * long, 0, z),
    )
    return shade


KINDS = {"CD": Kind(cd), "CreditCard": Kind(credit_card), "KeyChain": Kind(key_chain)}
