"""Laptops, televisions, computers, phones and remote controls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, DARK_GLASS, SHADOW_GAP, paint
from remqa_data.assets.mesh import primitives
from remqa_data.geometry.types import Vec3

LAPTOP_OPEN_DEG = 92.0
"""The recorded open laptops are as high as they are deep, so their lids stand almost upright."""
LAPTOP_THICKNESS = 0.055
"""Height of a closed laptop as a fraction of its width."""
HINGE_INSET_M = 0.006
"""From the back edge of a laptop to its hinge."""

SILVER = paint("gray", "metal", 0.5, (0.76, 0.77, 0.79))
GRAPHITE = paint("gray", "metal", 0.4, (0.34, 0.35, 0.37))
CHARCOAL = paint("black", "plastic", 0.2, (0.16, 0.16, 0.17))
ALUMINIUM_FRAMES = (SILVER, GRAPHITE, paint("black", "metal", 0.4), materials.WHITE_METAL)
LID_COLORS = tuple(paint(color, "metal", 0.4) for color in ("blue", "red", "green", "pink", "purple"))
LED_COLORS = tuple(
    Material("plastic", color, rgb, glow=1.0)
    for color, rgb in (("red", (0.95, 0.15, 0.10)), ("green", (0.25, 0.90, 0.35)), ("blue", (0.35, 0.75, 1.0)))
)
BUTTON_COLORS = tuple(paint(color, gloss=0.3) for color in ("red", "green", "yellow", "blue"))
WALLPAPERS = tuple(
    Material("glass", color, rgb, glow=0.6)
    for color, rgb in (("blue", (0.16, 0.32, 0.60)), ("purple", (0.36, 0.22, 0.52)), ("black", (0.08, 0.10, 0.14)))
)
ICONS = tuple(replace(paint(color), glow=0.7) for color in ("white", "green", "yellow", "red", "orange", "blue"))
PALE_BUTTON = paint("gray", gloss=0.1, rgb=(0.70, 0.71, 0.72))
BLACK_KEYS = Material("plastic", "black", (0.33, 0.33, 0.35), "keyboard", None)
WHITE_KEYS = Material("plastic", "white", (0.86, 0.87, 0.88), "keyboard", None)
PLASTIC_CASES = tuple(paint(color, gloss=0.4) for color in ("white", "black", "red", "blue", "green", "pink"))


def laptop(b: Builder) -> None:
    """A laptop that opens: silver and slim, black with two hinges, white and round, or with a coloured lid."""
    lid = b.by_variant((b.pick((SILVER, GRAPHITE)), CHARCOAL, materials.WHITE_PLASTIC, b.pick(LID_COLORS)))
    deck = b.by_variant((lid, CHARCOAL, materials.WHITE_PLASTIC, GRAPHITE))
    corner = b.by_variant((0.004, 0.0015, 0.006, 0.003))
    base, gap = _laptop_layers(b.h)
    hinge_y, hinge_z = b.d / 2 - HINGE_INSET_M, base + gap
    thick, deep = b.h - hinge_z, b.d - HINGE_INSET_M
    b.box((b.w, b.d, base), (0, 0, base / 2), deck, radius=corner, segments=2)
    keys = WHITE_KEYS if b.variant == 2 else BLACK_KEYS
    b.panel((0.88 * b.w, 0.46 * b.d), (0, 0.17 * b.d, base + 0.4 * gap), keys, facing="z")
    pad = b.by_variant((0.36, 0.26, 0.24, 0.30)) * b.w
    b.panel((pad, 0.27 * b.d), (0, -0.27 * b.d, base + 0.4 * gap), materials.tinted(deck, 0.8), facing="z")
    for x, length in b.by_variant(
        (((0, 0.6),), ((-0.34, 0.09), (0.34, 0.09)), ((0, 0.8),), ((-0.3, 0.16), (0.3, 0.16)))
    ):
        b.cylinder(
            min(0.005, 0.5 * thick),
            length * b.w,
            (x * b.w, hinge_y, hinge_z),
            CHARCOAL,
            axis="x",
            sections=10,
            solid=False,
        )
    b.cylinder(0.28 * thick, 0.96 * b.w, (0, hinge_y, hinge_z), CHARCOAL, axis="x", sections=8, solid=False)
    for side, facing in ((-1, "-x"), (1, "x")):
        for y in (0.08, 0.18):
            at = (side * (b.w / 2 + 0.0002), y * b.d, base / 2)
            b.panel((0.012, 0.3 * base), at, SHADOW_GAP, facing=facing)  # type: ignore[arg-type]
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(LAPTOP_OPEN_DEG)), origin=(0, hinge_y, hinge_z)):
        middle = hinge_y - deep / 2
        b.box((b.w, deep, thick), (0, middle, hinge_z + thick / 2), lid, radius=min(corner, 0.4 * thick), segments=2)
        rim = 0.012 if b.variant == 0 else 0.018
        b.panel((b.w - 0.008, deep - 0.008), (0, middle, hinge_z - 0.3 * gap), BLACK_PLASTIC, facing="-z")
        screen = b.pick((lit("screen_0"), lit("screen_0"), DARK_GLASS))
        b.panel((b.w - 2 * rim, deep - 2.4 * rim), (0, middle - 0.3 * rim, hinge_z - 0.6 * gap), screen, facing="-z")
        _lid_logo(b, middle, BLACK_PLASTIC if b.variant in (0, 2) else SILVER)
    b.looks_like(lid)


def closed_laptop_size(opened: Vec3) -> Vec3:
    """Size of the closed laptop whose box, when it is open, comes closest to a recorded width, depth and height.

    The lid of length l = d - inset, turned by the angle a, reaches to a depth l (1 - cos a) + t sin a and a height
    z + l sin a, where t is its thickness and z the height of its hinge. Both are solved for l; the mean is taken.
    """
    width, depth, height = opened
    thickness = LAPTOP_THICKNESS * width
    hinge_z = sum(_laptop_layers(thickness))
    cos, sin = float(np.cos(np.radians(LAPTOP_OPEN_DEG))), float(np.sin(np.radians(LAPTOP_OPEN_DEG)))
    from_depth = (depth - (thickness - hinge_z) * sin) / (1 - cos)
    from_height = (height - hinge_z) / sin
    return width, (from_depth + from_height) / 2 + HINGE_INSET_M, thickness


def television(b: Builder) -> None:
    """A television: on a central foot, on two feet, on a glass foot with a sound bar, or an old one with a deep back.

    Boxes too thin to stand are drawn without a foot, for the wall.
    """
    frame = b.by_variant((BLACK_PLASTIC, b.pick(ALUMINIUM_FRAMES), SILVER, b.pick((GRAPHITE, CHARCOAL, SILVER))))
    screen = b.pick((DARK_GLASS, DARK_GLASS, DARK_GLASS, lit("screen_1")))
    hangs = b.d < 0.12
    if b.variant == 3:
        _old_television(b, frame, screen)
    else:
        foot = 0.0 if hangs else b.by_variant((0.11, 0.08, 0.16)) * b.h
        thick = b.d if hangs else min(0.06, 0.3 * b.d)
        rim = b.by_variant((0.018, 0.010, 0.028))
        height = b.h - foot
        b.box((b.w, thick, height), (0, 0, foot + height / 2), frame, radius=0.006, segments=1)
        chin = 0.012 if b.variant != 2 else 0.030
        front = -thick / 2 - 0.0015
        b.panel((b.w - 2 * rim, height - 2 * rim - chin), (0, front, foot + height / 2 + chin / 2), screen)
        b.panel((0.07 * b.w, 0.010), (0, front, foot + rim * 0.5 + chin * 0.5), PALE_BUTTON)
        if not hangs:
            _television_foot(b, foot, thick, frame)
    b.looks_like(frame if frame.color != "black" else BLACK_PLASTIC)


def desktop(b: Builder) -> None:
    """A desktop computer: a monitor with a keyboard before it and a tower beside it."""
    tower = b.by_variant((BLACK_PLASTIC, SILVER, materials.WHITE_PLASTIC, GRAPHITE))
    accent = b.by_variant((SILVER, BLACK_PLASTIC, GRAPHITE, b.pick(LED_COLORS)))
    keys = WHITE_KEYS if b.variant == 2 else BLACK_KEYS
    side = b.by_variant((1, -1, 1, -1))
    wide, tall = min(0.21, 0.26 * b.w), b.h * b.by_variant((0.84, 0.78, 0.9, 0.86))
    x = side * (b.w - wide) / 2
    b.box((wide, b.d, tall), (x, 0, tall / 2), tower, radius=0.008)
    front = -b.d / 2 - 0.001
    b.panel((0.8 * wide, 0.09 * tall), (x, front, 0.88 * tall), accent if b.variant != 3 else BLACK_PLASTIC)
    b.panel((0.8 * wide, 0.05 * tall), (x, front, 0.79 * tall), SHADOW_GAP)
    for i in range(6):
        b.panel((0.7 * wide, 0.008), (x, front, (0.12 + 0.05 * i) * tall), accent if b.variant == 3 else SHADOW_GAP)
    b.cylinder(0.014, 0.004, (x, -b.d / 2 - 0.001, 0.62 * tall), accent, axis="-y", sections=12, solid=False)
    room = b.w - wide - 0.03
    x = -side * (b.w - room) / 2
    foot, thick = 0.24 * b.h, 0.03
    y = b.d / 2 - 0.10 if b.d > 0.2 else 0.2 * b.d
    b.box((room, thick, b.h - foot), (x, y, foot + (b.h - foot) / 2), tower, radius=0.006)
    screen = b.pick((DARK_GLASS, lit("screen_0")))
    b.panel((room - 0.03, b.h - foot - 0.045), (x, y - thick / 2 - 0.001, foot + (b.h - foot) / 2 + 0.008), screen)
    b.box((0.05, 0.02, 0.6 * b.h), (x, y + thick / 2 + 0.01, 0.3 * b.h), tower)
    b.box((0.42 * room, min(0.19, 0.7 * b.d), 0.012), (x, y, 0.006), tower, radius=0.004)
    deep = min(0.14, 0.5 * b.d)
    b.box((0.76 * room, deep, 0.016), (x - 0.1 * room, -b.d / 2 + deep / 2, 0.02), tower, radius=0.004)
    b.panel(
        (0.73 * room, 0.88 * deep),
        (x - 0.1 * room, -b.d / 2 + deep / 2, 0.0288),
        keys,
        facing="z",
    )
    b.add(
        primitives.ellipsoid((0.06, min(0.1, deep), 0.035), 12, 6), tower, (x + 0.4 * room, -b.d / 2 + deep / 2, 0.0175)
    )
    b.looks_like(tower)


def cell_phone(b: Builder) -> None:
    """A phone lying on its back: all screen, with a round button, in a coloured case, or small with large icons."""
    with b.quarter_turned(b.w > b.d):
        w, d, h = b.w, b.d, b.h
        body = b.by_variant(
            (
                b.pick((BLACK_PLASTIC, SILVER)),
                b.pick((materials.WHITE_PLASTIC, SILVER)),
                b.pick(PLASTIC_CASES[2:]),
                b.pick(PLASTIC_CASES[:2]),
            )
        )
        corner = b.by_variant((0.16, 0.14, 0.2, 0.28)) * w
        lift = 0.0006
        b.add(primitives.prism(primitives.rounded_rect(w, d, corner, 3), h - lift), body, (0, 0, (h - lift) / 2))
        for y in (0.12, 0.22):
            b.box(
                (0.002, 0.07 * d, 0.3 * h), (w / 2 - 0.0002, y * d, 0.5 * h), materials.tinted(body, 0.7), solid=False
            )
        if b.variant == 3:
            b.panel((0.88 * w, 0.86 * d), (0, 0, h - lift / 2), DARK_GLASS, facing="z")
            app_screen(b, (0.80 * w, 0.80 * d), (0, 0, h), (2, 3))
            b.box((0.3 * w, 0.012 * d, lift), (0, 0.465 * d, h - lift / 2), SHADOW_GAP, solid=False)
        else:
            rim = b.by_variant((0.05, 0.06, 0.12)) * w
            glass = primitives.rounded_rect(w - 2 * rim, d - 2 * rim, corner * 0.8, 3)
            b.add(primitives.prism(glass, lift), BLACK_PLASTIC if b.variant != 1 else body, (0, 0, h - lift * 0.9))
            bar = 0.14 * d if b.variant == 1 else 0.03 * d
            app_screen(b, (w - 2.6 * rim, d - 2.6 * rim - 2 * bar), (0, 0, h), (4, 6))
            b.box((0.2 * w, 0.006 * d, 0.0004), (0, d / 2 - rim - 0.5 * bar, h - lift * 0.3), SHADOW_GAP, solid=False)
            if b.variant == 1:
                button = (0, -d / 2 + rim + 0.45 * bar, h - lift * 0.3)
                b.cylinder(0.075 * w, lift, button, SILVER, sections=14, solid=False)
        b.solid((w, d, h), (0, 0, h / 2))
    b.looks_like(body)


def remote_control(b: Builder) -> None:
    """A remote control lying flat: many buttons, coloured keys and a ring, waisted, or slim with few buttons."""
    with b.quarter_turned(b.w > b.d):
        w, d, h = b.w, b.d, b.h
        body = b.by_variant((BLACK_PLASTIC, b.pick((CHARCOAL, GRAPHITE)), SILVER, materials.WHITE_PLASTIC))
        lift = min(0.003, 0.2 * h)
        top = h - lift
        if b.variant == 2:
            side = [(w * (0.5 - 0.12 * np.sin(np.pi * t) ** 2), d * (t - 0.5) * 0.94) for t in np.linspace(0, 1, 9)]
            outline = [(-0.3 * w, -d / 2), (0.3 * w, -d / 2), *side, (0.3 * w, d / 2), (-0.3 * w, d / 2)]
            outline += [(-x, y) for x, y in reversed(side)]
            b.add(primitives.prism(outline, top), body, (0, 0, top / 2))
        else:
            b.box((w, d, top), (0, 0, top / 2), body, radius=min(0.4 * top, 0.008), segments=2, solid=False)
        key = paint("gray", gloss=0.1, rgb=(0.35, 0.36, 0.38)) if body.color == "white" else PALE_BUTTON
        power = (-0.28 * w, 0.43 * d, h - lift / 2)
        b.cylinder(0.085 * w, lift, power, BUTTON_COLORS[0], sections=10, solid=False)
        if b.variant == 0:
            _button_grid(b, (0.8 * w, 0.34 * d), (0, 0.17 * d, top), (3, 5), key, lift)
            _button_grid(b, (0.8 * w, 0.22 * d), (0, -0.16 * d, top), (3, 3), key, lift)
            _button_grid(b, (0.8 * w, 0.07 * d), (0, -0.35 * d, top), (4, 1), BUTTON_COLORS, lift)
        elif b.variant == 1:
            _button_grid(b, (0.8 * w, 0.07 * d), (0, 0.33 * d, top), (4, 1), BUTTON_COLORS, lift)
            _button_ring(b, 0.33 * w, (0, 0.14 * d, top), key, lift)
            _button_grid(b, (0.8 * w, 0.36 * d), (0, -0.25 * d, top), (3, 4), key, lift)
        elif b.variant == 2:
            _button_ring(b, 0.28 * w, (0, 0.28 * d, top), CHARCOAL, lift)
            _button_grid(b, (0.56 * w, 0.30 * d), (0, -0.05 * d, top), (2, 4), CHARCOAL, lift)
            _button_grid(b, (0.7 * w, 0.18 * d), (0, -0.34 * d, top), (3, 2), BUTTON_COLORS, lift)
        else:
            _button_ring(b, 0.36 * w, (0, 0.20 * d, top), CHARCOAL, lift)
            _button_grid(b, (0.6 * w, 0.24 * d), (0, -0.10 * d, top), (2, 2), CHARCOAL, lift)
        b.solid((w, d, h), (0, 0, h / 2))
    b.looks_like(body)


def lit(picture: str) -> Material:
    """A screen that shines."""
    return replace(materials.picture(picture, "blue", "glass"), glow=0.7)


def app_screen(b: Builder, size: tuple[float, float], at: Vec3, count: tuple[int, int]) -> None:
    """A small screen that faces up: dark, or lit with rows of coloured icons (columns, rows)."""
    if b.rng.random() < 0.25:
        b.panel(size, at, DARK_GLASS, facing="z")
        return
    b.panel(size, at, b.pick(WALLPAPERS), facing="z")
    columns, rows = count
    step_x, step_y = size[0] / (columns + 0.4), size[1] / (rows + 0.6)
    icon = 0.62 * min(step_x, step_y)
    for j in range(rows):
        for i in range(columns):
            if j == 2 and rows > 4:  # a gap above the lowest rows
                continue
            x, y = (i - (columns - 1) / 2) * step_x, (j - (rows - 1) / 2) * step_y
            place = (at[0] + x, at[1] + y, at[2] + 0.0002)
            b.panel((icon, icon), place, ICONS[(3 * j + 2 * i) % len(ICONS)], facing="z")


def _laptop_layers(thickness: float) -> tuple[float, float]:
    """Height of the base of a laptop, and the gap between it and the lid."""
    return 0.56 * thickness, min(0.0012, 0.06 * thickness)


def _lid_logo(b: Builder, y: float, material: Material) -> None:
    z = b.h + 0.0004
    if b.variant == 0:
        b.add(primitives.disc(0.02, sections=16), material, (0, y, z))
    elif b.variant == 1:
        b.panel((0.05, 0.014), (0.36 * b.w, y - 0.38 * b.d, z), material, facing="z")
    elif b.variant == 2:
        b.add(primitives.disc(0.026, 0.018, 18), material, (0, y, z))
    else:
        for x in (-0.02, 0.0, 0.02):
            b.panel((0.01, 0.05), (x, y, z), material, facing="z")


def _television_foot(b: Builder, foot: float, thick: float, frame: Material) -> None:
    if b.variant == 1:
        for x in (-1, 1):
            for y in (-1, 1):
                path = [(x * 0.36 * b.w, 0, foot + 0.01), (x * 0.37 * b.w, y * (b.d / 2 - 0.010), 0.010)]
                b.add(primitives.tube(path, 0.009, 6), frame)
            b.box((0.02, b.d, 0.016), (x * 0.37 * b.w, 0, 0.008), frame, radius=0.005)
        return
    plate = 0.014
    if b.variant == 0:
        b.add(
            primitives.prism(primitives.ellipse(0.46 * b.w, b.d, 28, 3.0), plate), frame, (0, 0, plate / 2), solid=True
        )
        b.box((0.16 * b.w, thick * 0.7, foot), (0, 0, foot / 2 + plate / 2), frame, radius=0.01)
        return
    b.box((0.56 * b.w, b.d, plate), (0, 0, plate / 2), DARK_GLASS, radius=0.004)
    for x in (-1, 1):
        b.cylinder(0.016, foot, (x * 0.10 * b.w, 0.15 * thick, foot / 2), materials.CHROME, sections=10)
    bar = min(0.07, 0.5 * foot)
    before = min(b.d / 2 - 0.04, thick / 2 + 0.05)
    b.box((0.5 * b.w, 0.07, bar), (0, -before, plate + bar / 2), CHARCOAL, radius=0.012, segments=2)


def _old_television(b: Builder, frame: Material, screen: Material) -> None:
    front = min(0.4 * b.d, 0.14)
    speaker = 0.14 * b.h
    foot = 0.0 if b.d < 0.12 else 0.04 * b.h
    height = b.h - foot
    b.box((b.w, front, height), (0, -b.d / 2 + front / 2, foot + height / 2), frame, radius=0.015, segments=2)
    y = -b.d / 2 + front
    back = [
        (-0.46 * b.w, y - 0.01),
        (0.46 * b.w, y - 0.01),
        (0.44 * b.w, y + 0.3 * (b.d / 2 - y)),
        (0.27 * b.w, b.d / 2),
    ]
    back += [(-x, py) for x, py in reversed(back[2:])]
    b.add(primitives.prism(back, 0.84 * height), CHARCOAL, (0, 0, foot + 0.47 * height), solid=True)
    rim = 0.05 * b.w
    face = -b.d / 2 - 0.0015
    z = foot + (height + speaker) / 2
    b.panel((b.w - 1.4 * rim, height - speaker - 0.6 * rim), (0, face + 0.0005, z), SHADOW_GAP)
    b.panel((b.w - 2 * rim, height - speaker - 1.2 * rim), (0, face, z), screen)
    for x in (-1, 1):
        for i in range(5):
            b.panel((0.3 * b.w, 0.008), (x * 0.28 * b.w, face, foot + (0.22 + 0.14 * i) * speaker), SHADOW_GAP)
    for knob in (-0.04, 0.0, 0.04):
        b.cylinder(
            0.010, 0.006, (knob * b.w, face, foot + 0.5 * speaker), PALE_BUTTON, axis="-y", sections=10, solid=False
        )
    if foot:
        b.box((0.7 * b.w, 0.8 * b.d, foot + 0.01), (0, 0, foot / 2), CHARCOAL)


def _button_grid(
    b: Builder,
    size: tuple[float, float],
    at: Vec3,
    count: tuple[int, int],
    colors: Material | tuple[Material, ...],
    lift: float,
) -> None:
    """Buttons (columns, rows) over a rectangle centred at a point of the surface; colours alternate by column."""
    columns, rows = count
    shades = (colors,) if isinstance(colors, Material) else colors
    step_x, step_y = size[0] / columns, size[1] / rows
    for i in range(columns):
        for j in range(rows):
            place = (at[0] + (i - (columns - 1) / 2) * step_x, at[1] + (j - (rows - 1) / 2) * step_y, at[2] + lift / 2)
            b.box((0.68 * step_x, 0.62 * step_y, lift), place, shades[i % len(shades)], solid=False)


def _button_ring(b: Builder, radius: float, at: Vec3, material: Material, lift: float) -> None:
    profile = [(0.55 * radius, 0), (radius, 0), (radius, 0.8 * lift), (0.55 * radius, 0.8 * lift)]
    b.add(primitives.revolve(profile, 16), material, at)
    b.cylinder(0.38 * radius, lift, (at[0], at[1], at[2] + lift / 2), material, sections=10, solid=False)


KINDS = {
    "CellPhone": Kind(cell_phone),
    "Desktop": Kind(desktop),
    "Laptop": Kind(laptop),
    "RemoteControl": Kind(remote_control),
    "Television": Kind(television),
}
