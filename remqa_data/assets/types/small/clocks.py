"""Clocks and watches."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, DARK_GLASS, SHADOW_GAP, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.types.small.electronics import (
    CHARCOAL,
    GRAPHITE,
    LED_COLORS,
    PALE_BUTTON,
    PLASTIC_CASES,
    SILVER,
    app_screen,
)
from remqa_data.geometry.types import Vec3

_SEGMENTS = {
    "0": "abcdef", "1": "bc", "2": "abged", "3": "abgcd", "4": "fgbc",
    "5": "afgcd", "6": "afgedc", "7": "abc", "8": "abcdefg", "9": "abcdfg",
}  # fmt: skip
_SEGMENT_PLACES = {
    "a": (0, 1, True), "b": (1, 0.5, False), "c": (1, -0.5, False), "d": (0, -1, True),
    "e": (-1, -0.5, False), "f": (-1, 0.5, False), "g": (0, 0, True),
}  # fmt: skip


def alarm_clock(b: Builder) -> None:
    """An alarm clock: round with two bells, a box with lit digits, flip cards, or a wooden arch with a dial."""
    (_twin_bell_clock, _digital_clock, _flip_clock, _arched_clock)[b.variant](b)


def watch(b: Builder) -> None:
    """A wristwatch lying on its closed strap: leather and round, square and digital, steel, or with a colour screen."""
    strap = b.by_variant((b.pick(materials.LEATHERS), BLACK_PLASTIC, SILVER, b.pick(PLASTIC_CASES[1:])))
    case = b.by_variant((b.pick((SILVER, materials.BRASS)), CHARCOAL, SILVER, GRAPHITE))
    thick = min(0.010, 0.3 * b.h)
    band = 0.0025
    across = b.by_variant((0.5, 0.62, 0.56, 0.56)) * b.d
    loop_h = b.h - 0.5 * thick
    if b.variant == 2:
        _bracelet(b, across, loop_h)
    else:
        outer, inner = (primitives.ellipse(b.w - 2 * t, loop_h - 2 * t, 20, 2.5) for t in (0.0, band))
        b.add(primitives.prism(outer, across, [inner]).pointed("-y"), strap, (0, 0, loop_h / 2))
    b.box((0.012, across * 1.15, 2 * band), (0.12 * b.w, 0, band), case, solid=False)
    wide, z = min(0.9 * b.d, 0.62 * b.w), b.h - thick / 2
    if b.variant in (0, 2):
        b.cylinder(wide / 2, thick * 0.9, (0, 0, z - thick * 0.05), case, sections=20, solid=False)
        b.add(primitives.disc(wide * 0.42, sections=20), materials.picture("clock_face"), (0, 0, b.h))
        b.add(
            primitives.revolve([(wide * 0.42, 0), (wide * 0.5, 0), (wide * 0.43, thick * 0.1)], 20),
            case,
            (0, 0, b.h - thick * 0.1),
        )
    else:
        b.box((wide * 0.86, wide, thick), (0, 0, z), case, radius=min(0.003, 0.3 * thick), segments=2, solid=False)
        b.panel((wide * 0.7, wide * 0.8), (0, 0, b.h + 0.0003), DARK_GLASS, facing="z")
        if b.variant == 3:
            app_screen(b, (wide * 0.62, wide * 0.72), (0, 0, b.h + 0.0006), (3, 3))
        else:
            pale = Material("glass", "green", (0.62, 0.70, 0.58), gloss=0.3)
            b.panel((wide * 0.6, wide * 0.4), (0, 0, b.h + 0.0006), pale, facing="z")
            for x in (-0.2, -0.08, 0.08, 0.2):
                b.panel((wide * 0.07, wide * 0.2), (x * wide, 0, b.h + 0.0009), SHADOW_GAP, facing="z")
    b.cylinder(
        0.1 * thick + 0.001, b.d / 2 - wide * 0.4, (0, b.d / 4 + wide * 0.2, z), case, axis="y", sections=8, solid=False
    )
    b.cylinder(
        0.002, b.d / 2 - wide * 0.4, (0.1 * b.w, -b.d / 4 - wide * 0.2, z), case, axis="-y", sections=8, solid=False
    )
    b.solid((0.8 * b.w, 0.7 * b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(strap)


def _bracelet(b: Builder, across: float, height: float) -> None:
    """A closed band of metal links."""
    links, thick = 18, 0.003
    points = primitives.ellipse(b.w - thick, height - thick, links, 2.5)
    for point, following in zip(points, np.roll(points, -1, axis=0), strict=True):
        (x, z), (dx, dz) = (point + following) / 2, following - point
        size = (0.86 * float(np.hypot(dx, dz)), across, thick)
        turned = primitives.turn("y", -float(np.degrees(np.arctan2(dz, dx))))
        b.box(size, (float(x), 0, float(z) + height / 2), SILVER, rotation=turned, solid=False)


def _twin_bell_clock(b: Builder) -> None:
    color = b.pick((*materials.METALS[1:], materials.BRASS, paint("red", "metal", 0.5), paint("blue", "metal", 0.5)))
    bell, foot = 0.2 * b.h, 0.10 * b.h
    radius = min(b.w / 2, (b.h - bell - foot) / 2 + 0.04 * b.h)
    z, deep = max(foot * 0.6 + radius, 0.84 * b.h - radius), min(b.d, 1.4 * radius)
    face = -0.36 * deep
    b.cylinder(radius, 0.86 * deep, (0, face + 0.43 * deep, z), color, axis="y", sections=24, solid=False)
    ring = [(0.86 * radius, 0), (radius, 0), (0.92 * radius, 0.14 * deep), (0.86 * radius, 0)]
    b.add(primitives.revolve(ring, 24).pointed("-y"), color, (0, face, z))
    _dial(b, 0.87 * radius, (0, face - 0.0008, z))
    wide = min(0.42 * radius, 0.5 * b.w - 0.1 * radius)
    dome = [(0, 0), (wide, 0), (0.9 * wide, 0.3 * bell), (0.55 * wide, 0.55 * bell), (0, 0.62 * bell)]
    for x in (-1, 1):
        at = (x * min(0.55 * radius, b.w / 2 - wide), 0, z + 0.86 * radius)
        b.add(primitives.revolve(dome, 12).turned(primitives.turn("y", x * 24.0)), materials.CHROME, at)
    b.box((0.1 * radius, 0.1 * radius, 0.3 * bell), (0, 0, z + radius + 0.1 * bell), materials.CHROME, solid=False)
    rod, reach = min(0.004, 0.05 * bell), 0.45 * radius
    arch = [(x * reach, 0.0, b.h - rod - 0.3 * bell * x * x) for x in np.linspace(-1, 1, 8)]
    b.add(primitives.tube(np.array(arch), rod, 6), materials.CHROME)
    if 2 * radius < 0.85 * b.w or deep < 0.85 * b.d:
        b.box((b.w, b.d, foot), (0, 0, foot / 2), color, radius=0.004, solid=False)
    else:
        for x in (-1, 1):
            path = [(x * 0.5 * radius, 0, z - 0.7 * radius), (x * 0.74 * radius, -0.1 * b.d, 0.003)]
            b.add(primitives.tube(path, 0.006, 6), materials.CHROME)
    b.solid((1.7 * radius, 0.9 * deep, b.h), (0, 0, b.h / 2))
    b.looks_like(color)


def _digital_clock(b: Builder) -> None:
    case = b.pick((BLACK_PLASTIC, materials.WHITE_PLASTIC, materials.OAK, GRAPHITE))
    b.box((b.w, b.d, b.h * 0.96), (0, 0, b.h * 0.48), case, radius=min(0.012, 0.2 * b.d), segments=2)
    b.box((0.4 * b.w, 0.4 * b.d, 0.08 * b.h), (0, 0, 0.96 * b.h), PALE_BUTTON, radius=0.003, solid=False)
    wide, tall = 0.86 * b.w, min(0.62 * b.h, 0.6 * b.w)
    z = max(0.56 * b.h, b.h * 0.9 - tall / 2)
    b.panel((wide, tall), (0, -b.d / 2 - 0.0008, z), DARK_GLASS)
    _digits(b, _time(b), (0.8 * wide, min(0.62 * tall, 0.34 * wide)), (0, -b.d / 2 - 0.0016, z), b.pick(LED_COLORS))
    b.looks_like(case)


def _flip_clock(b: Builder) -> None:
    case = b.pick(PLASTIC_CASES)
    foot = 0.1 * b.h
    b.box((b.w, b.d, b.h - foot), (0, 0, foot + (b.h - foot) / 2), case, radius=min(0.03, 0.25 * b.d), segments=3)
    b.box((0.6 * b.w, 0.7 * b.d, foot * 1.3), (0, 0, foot * 0.65), CHARCOAL, radius=0.004)
    time = _time(b)
    z = foot + (b.h - foot) / 2
    tall = min(0.56 * (b.h - foot), 0.5 * b.w)
    for x, text in ((-0.2, time[:2]), (0.2, time[3:])):
        at = (x * b.w, -b.d / 2 - 0.0008, z)
        b.panel((0.36 * b.w, tall), at, BLACK_PLASTIC)
        _digits(b, text, (0.3 * b.w * 0.75, 0.66 * tall), (at[0], at[1] - 0.0008, z), materials.WHITE_PLASTIC)
        b.panel((0.36 * b.w, 0.02 * tall), (at[0], at[1] - 0.0016, z), SHADOW_GAP)
    for x in (-0.3, 0.3):
        b.cylinder(0.05 * b.w, 0.05 * b.h, (x * b.w, 0, b.h), PALE_BUTTON, sections=12, solid=False)
    b.looks_like(case)


def _arched_clock(b: Builder) -> None:
    wood = b.pick((materials.WALNUT, materials.CHERRY, materials.PINE, materials.EBONY))
    foot = 0.1 * b.h
    dome = min(b.w / 2 * 0.92, 0.5 * (b.h - foot))
    z = b.h - dome
    top = primitives.arc((0, z), dome, 0, 180, 13)
    side = 0.46 * b.w
    outline = [(-side, foot), (side, foot), (side, foot + 0.25 * b.h), *map(tuple, top), (-side, foot + 0.25 * b.h)]
    b.add(primitives.prism(outline, 0.8 * b.d).pointed("-y"), wood, (0, 0, 0))
    b.box((b.w, b.d, foot), (0, 0, foot / 2), wood, radius=0.003, solid=False)
    ring = [(0.74 * dome, 0), (0.88 * dome, 0), (0.80 * dome, 0.06 * b.d), (0.74 * dome, 0)]
    b.add(primitives.revolve(ring, 24).pointed("-y"), materials.BRASS, (0, -0.4 * b.d, z))
    _dial(b, 0.75 * dome, (0, -0.4 * b.d - 0.0008, z))
    b.solid((0.92 * b.w, b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(wood)


def _dial(b: Builder, radius: float, at: Vec3) -> None:
    b.add(primitives.disc(radius, sections=24).pointed("-y"), materials.picture("clock_face"), at)


def _time(b: Builder) -> str:
    return b.pick(("07:30", "12:45", "06:00", "10:08", "23:59"))


def _digits(b: Builder, text: str, size: tuple[float, float], at: Vec3, material: Material) -> None:
    """A lit time such as "07:30" on a front, of flat seven-segment digits."""
    step, height = size[0] / (len(text) - 0.5 * text.count(":")), size[1]
    x = at[0] - size[0] / 2
    stroke = min(0.14 * height, 0.2 * step)
    for letter in text:
        wide = step * (0.5 if letter == ":" else 1.0)
        middle = x + wide / 2
        if letter == ":":
            for z in (-0.2, 0.2):
                b.panel((stroke, stroke), (middle, at[1], at[2] + z * height), material)
        for name in _SEGMENTS.get(letter, ""):
            side, up, flat = _SEGMENT_PLACES[name]
            place = (middle + side * 0.32 * wide, at[1], at[2] + up * (height - stroke) / 2)
            b.panel((0.52 * wide, stroke) if flat else (stroke, 0.42 * height), place, material)
        x += wide


KINDS = {"AlarmClock": Kind(alarm_clock), "Watch": Kind(watch)}
