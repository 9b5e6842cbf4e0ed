"""Boxes and safes: containers that one opens to look inside."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, CHROME, GRAY_PLASTIC
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.carcass import slab
from remqa_data.geometry.types import Vec3

CARD = 0.004
"""Thickness of cardboard, metres."""
FLAP_OPEN_DEG = 220.0
LID_OPEN_DEG = 105.0


def box(b: Builder) -> None:
    """A box: taped carton with four flaps, storage box with a lid, wooden crate with a hinged lid, wicker chest."""
    b.by_variant((_carton, _storage_box, _crate, _wicker_chest))(b)


def _carton(b: Builder) -> None:
    card = b.pick((materials.CARDBOARD, materials.tinted(materials.CARDBOARD, 0.88), materials.CARDBOARD, WHITE_CARD))
    tape = b.pick((TAPE, materials.tinted(TAPE, 0.75), materials.paint("red", rgb=(0.72, 0.30, 0.24))))
    top = b.h - CARD
    _open_box(b, (b.w, b.d, top - CARD), CARD, card, b.level(0.01, CARD, 0.5 * b.h))
    front = -b.d / 2 - 0.0006
    b.panel((0.05, 0.16 * b.h), (0, front, top - CARD - 0.08 * b.h), tape)
    _label(b, (0.24 * b.w, front, 0.30 * b.h), (0.30 * b.w, 0.24 * b.h))
    angle = float(np.radians(FLAP_OPEN_DEG))
    for sign, axis in ((-1, "x"), (1, "-x")):  # outer flaps meet in the middle
        side = "front" if sign < 0 else "rear"
        with b.link(f"{side}_flap", "revolute", axis=axis, upper=angle, origin=(0, sign * b.d / 2, b.h)):  # type: ignore[arg-type]
            b.box((b.w, b.d / 2 - 0.001, CARD), (0, sign * (b.d / 4 + 0.0005), b.h - CARD / 2), card)
            b.panel((0.05, b.d / 2), (0, sign * b.d / 4, b.h + 0.0004), tape, facing="z")
    length = min(0.36 * b.w, 0.40 * b.d)
    for sign, axis in ((-1, "-y"), (1, "y")):  # inner flaps are trimmed so that they clear the outer ones
        x = sign * b.w / 2
        wide, narrow = b.d / 2 - 2 * CARD, b.d / 2 - 2 * CARD - length
        outline = [(x, -wide), (x, wide), (x - sign * length, narrow), (x - sign * length, -narrow)]
        with b.link("left_flap" if sign < 0 else "right_flap", "revolute", axis=axis, upper=angle, origin=(x, 0, top)):  # type: ignore[arg-type]
            b.add(primitives.prism(outline, CARD), card, (0, 0, top - CARD / 2))
            b.solid((length, 2 * narrow, CARD), (x - sign * length / 2, 0, top - CARD / 2))
    b.looks_like(card)


def _storage_box(b: Builder) -> None:
    shell = b.pick(STORAGE)
    lid = b.pick((materials.tinted(shell, 0.72), WHITE_CARD))
    skirt, t = min(0.07, 0.25 * b.h), CARD
    _open_box(b, (b.w - 4 * t, b.d - 4 * t, b.h - 2 * t), t, shell, b.level(0.01, t, 0.5 * b.h))
    y = -(b.d - 4 * t) / 2
    _label(b, (0, y - 0.0006, 0.42 * b.h), (0.24 * b.w, 0.17 * b.h))
    for side in (-1, 1):  # a grip on each end
        x = side * (b.w / 2 - 2 * t)
        b.box((0.002, min(0.10, 0.4 * b.d), 0.03), (x, 0, 0.62 * b.h), materials.SHADOW_GAP, radius=0.0009, solid=False)
    _lid(b, skirt, t, lid)
    b.looks_like(shell)


def _crate(b: Builder) -> None:
    wood = b.pick((materials.PINE, materials.OAK, materials.WALNUT, materials.GRAY_WOOD))
    dark, t = materials.tinted(wood, 0.82), 0.012
    lid = 0.018
    body = b.h - lid
    inner = (b.w - 2 * t, b.d - 2 * t, body)
    _open_box(b, inner, 0.008, dark, b.level(0.014, 0.008, 0.5 * b.h))
    rows = max(3, min(5, round(body / 0.08)))
    pitch = body / rows
    for i in range(rows):
        z, board = (i + 0.5) * pitch, pitch - 0.010
        for side in (-1, 1):
            b.box((b.w - 0.01, t, board), (0, side * (b.d - t) / 2 - side * 0.003, z), wood, solid=False)
            b.box((t, b.d - 2 * t, board), (side * (b.w - t) / 2 - side * 0.003, 0, z), wood, solid=False)
    post = min(0.035, 0.12 * b.w)
    for sx in (-1, 1):
        for side in (-1, 1):
            b.box((post, 0.006, body), (sx * (b.w - post) / 2, side * (b.d / 2 - 0.003), body / 2), dark, solid=False)
            b.box((0.006, post, body), (sx * (b.w / 2 - 0.003), side * (b.d - post) / 2, body / 2), dark, solid=False)
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(LID_OPEN_DEG)), origin=(0, b.d / 2, body)):
        count = 4
        for i in range(count):
            depth = b.d / count
            at = (0, -b.d / 2 + (i + 0.5) * depth, b.h - lid / 2)
            b.box((b.w, depth - (0.004 if 0 < i < count - 1 else 0.002), lid), at, wood, radius=0.002)
    metal = materials.BLACK_METAL
    b.box((0.05, 0.003, 0.05), (0, -b.d / 2 + 0.0005, body - 0.03), metal, radius=0.001, solid=False)
    b.looks_like(wood)


def _wicker_chest(b: Builder) -> None:
    weave = b.pick(WEAVES)
    rim = materials.tinted(weave, 0.75)
    lid = min(0.05, 0.2 * b.h)
    body = b.h - lid
    inset = 0.010
    _open_box(b, (b.w - 2 * inset, b.d - 2 * inset, body), 0.012, weave, b.level(0.014, 0.012, 0.5 * b.h))
    for z in (0.012, body - 0.016):
        _band(b, (b.w, b.d), z, 0.022, 0.016, rim)
    for side in (-1, 1):
        grip = [
            (side * (b.w / 2 - inset), y, 0.62 * body + dz)
            for y, dz in ((-0.06, 0), (-0.05, -0.03), (0.05, -0.03), (0.06, 0))
        ]
        b.add(primitives.tube(np.array(grip), 0.007, 6), rim)
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(LID_OPEN_DEG)), origin=(0, b.d / 2, body)):
        b.box((b.w, b.d, lid), (0, 0, b.h - lid / 2), weave, radius=min(0.018, 0.4 * lid), segments=2)
    b.box((0.05, 0.006, 0.04), (0, -b.d / 2 + inset - 0.003, body - 0.05), materials.LEATHERS[0], solid=False)
    b.looks_like(weave)


def _label(b: Builder, at: Vec3, size: tuple[float, float]) -> None:
    """A paper label with lines of writing on a side that faces -y."""
    x, y, z = at
    b.panel(size, at, materials.PAPER)
    for i, length in enumerate((0.7, 0.5, 0.6)):
        line = (length * size[0], 0.09 * size[1])
        b.panel(line, (x - (0.8 - length) / 2 * size[0], y - 0.0006, z + (1 - i) * 0.24 * size[1]), INK)


def _open_box(b: Builder, size: tuple[float, float, float], wall: float, material: Material, floor: float) -> None:
    """Four walls and a floor, for the eye and for physics, and the space inside, which only an open lid shows."""
    width, depth, height = size
    b.shell(size, (0, 0, height / 2), wall, material, open_side="z")
    inside = (width - 2 * wall, depth - 2 * wall)
    if floor > wall + 0.001:
        slab(b, (-inside[0] / 2, -inside[1] / 2, wall, inside[0] / 2, inside[1] / 2, floor), material)
    b.space("inside", (*inside, height - floor), (0, 0, (height + floor) / 2), enclosed=True)


def _lid(b: Builder, skirt: float, t: float, material: Material) -> None:
    """A lid over the whole box with a skirt that covers its upper edge, hinged at the back."""
    low = b.h - skirt
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(LID_OPEN_DEG)), origin=(0, b.d / 2, low)):
        b.box((b.w, b.d, t), (0, 0, b.h - t / 2), material)
        for s in (-1, 1):
            b.box((b.w, t, skirt - t), (0, s * (b.d - t) / 2, low + (skirt - t) / 2), material)
            b.box((t, b.d - 2 * t, skirt - t), (s * (b.w - t) / 2, 0, low + (skirt - t) / 2), material)


def _band(b: Builder, size: tuple[float, float], z: float, height: float, width: float, material: Material) -> None:
    """A rectangular band around a box, of a width inwards."""
    x, y = size[0] / 2, size[1] / 2
    for s in (-1, 1):
        b.box((size[0], width, height), (0, s * (y - width / 2), z), material, radius=0.006, solid=False)
        b.box((width, size[1] - 2 * width, height), (s * (x - width / 2), 0, z), material, solid=False)


def safe(b: Builder) -> None:
    """A safe with a thick door: dial and lever, keypad and knob, three-spoked wheel, or hotel safe with a display."""
    steel = b.pick(SAFE_COLORS)
    reach, thick = min(0.035, 0.1 * b.d), min(0.05, 0.14 * b.d)
    face = -b.d / 2 + reach
    y, wall = face + thick, min(0.045, 0.13 * min(b.w, b.h))
    depth = b.d / 2 - y
    foot = 0.012
    b.shell((b.w, depth, b.h - foot), (0, y + depth / 2, (b.h + foot) / 2), wall, steel)
    inside = (b.w - 2 * wall, depth - wall, b.h - foot - 2 * wall)
    lining = materials.tinted(GRAY_PLASTIC, 1.15)
    floor = foot + wall + 0.003
    b.box((inside[0], inside[1], 0.003), (0, y + inside[1] / 2, floor - 0.0015), lining)
    b.box((inside[0], 0.003, inside[2]), (0, y + inside[1] - 0.0015, b.h / 2 + foot / 2), lining, solid=False)
    for sx in (-1, 1):
        for sy in (-1, 1):
            at = (sx * (b.w / 2 - 0.05), y + depth / 2 + sy * (depth / 2 - 0.05), foot / 2)
            b.cylinder(0.025, foot, at, BLACK_PLASTIC, sections=10)
    b.space(
        "inside",
        (inside[0], 0.96 * inside[1], inside[2] - 0.003),
        (0, y + inside[1] / 2, floor + inside[2] / 2),
        enclosed=True,
    )
    left = b.variant % 2 == 0
    origin = (-b.w / 2 if left else b.w / 2, face, b.h / 2)
    side = 1 if left else -1
    with b.link("door", "revolute", axis="-z" if left else "z", upper=float(np.radians(105)), origin=origin):
        z = (b.h + foot) / 2
        b.box((b.w, thick - 0.004, b.h - foot), (0, face + thick / 2 - 0.002, z), steel, radius=0.006)
        b.box((b.w - 0.012, 0.004, b.h - foot - 0.012), (0, y - 0.002, z), GRAY_PLASTIC, solid=False)
        b.box(
            (b.w * 0.84, 0.004, b.h * 0.80),
            (0, face - 0.002, z),
            materials.tinted(steel, 0.85),
            radius=0.0015,
            solid=False,
        )
        _lock(b, face - 0.004, reach - 0.004, side, z)
    b.looks_like(steel)


def _lock(b: Builder, y: float, reach: float, side: int, z: float) -> None:
    """What a safe is opened with, on its door's face; `side` is where the door's free edge is."""
    unit = min(b.w, b.h)
    x = side * 0.20 * b.w
    if b.variant in (0, 2):
        dial = [(0, 0), (0.11, 0), (0.11, 0.3), (0.09, 0.4), (0.05, 0.42), (0.045, 1.0), (0, 1.0)]
        profile = [(r * unit, h * reach) for r, h in dial]
        at = (x, y, z + 0.06 * b.h) if b.variant == 0 else (-x, y, z + 0.16 * b.h)
        b.add(primitives.revolve(profile, 20).pointed("-y"), BLACK_PLASTIC, at)
        ring = [(0.095 * unit, 0.0), (0.125 * unit, 0.0), (0.125 * unit, 0.2 * reach), (0.095 * unit, 0.2 * reach)]
        b.add(primitives.revolve(ring, 20).pointed("-y"), CHROME, at)
    if b.variant == 0:
        b.cylinder(0.03 * unit, 0.6 * reach, (x, y - 0.3 * reach, z - 0.2 * b.h), CHROME, axis="-y", solid=False)
        b.box(
            (0.20 * unit, 0.3 * reach, 0.035 * unit),
            (x - side * 0.07 * unit, y - 0.75 * reach, z - 0.2 * b.h),
            CHROME,
            radius=0.004,
            solid=False,
        )
    elif b.variant == 2:
        hub = (x * 0.4, y, z - 0.10 * b.h)
        b.cylinder(0.05 * unit, reach, (hub[0], y - reach / 2, hub[2]), CHROME, axis="-y", solid=False)
        for k in range(3):
            spoke = primitives.turn("y", 30 + 120 * k) @ np.array([0.16 * unit, 0, 0])
            path = np.array([[0, -0.6 * reach, 0], [spoke[0], -0.6 * reach, spoke[2]]])
            b.add(primitives.tube(path, 0.010, 8), CHROME, hub)
            b.add(
                primitives.ellipsoid((0.035, 0.03, 0.035), 8, 6),
                BLACK_PLASTIC,
                (hub[0] + spoke[0], y - 0.6 * reach, hub[2] + spoke[2]),
            )
    elif b.variant == 1:
        _keypad(b, (x, y, z + 0.06 * b.h), (3, 4), unit, 0.5 * reach)
        knob, at = 0.055 * unit, (x, y - reach / 2, z - 0.25 * b.h)
        b.cylinder(knob, reach, at, CHROME, axis="-y", top_radius=0.8 * knob, solid=False)
    else:
        _keypad(b, (0.0, y, z + 0.16 * b.h), (6, 2), unit, 0.4 * reach)
        b.handle((0.0, y, z - 0.16 * b.h), 0.42 * b.w, CHROME, reach=reach, radius=min(0.012, 0.3 * reach))


def _keypad(b: Builder, at: Vec3, keys: tuple[int, int], unit: float, thickness: float) -> None:
    """A plate with a grid (columns, rows) of keys under a display that shines; the point is on the door's face."""
    columns, rows = keys
    x, y, z = at
    key, pitch = 0.05 * unit, 0.075 * unit
    height = (rows + 1.6) * pitch
    plate = ((columns + 0.9) * pitch, thickness, height)
    b.box(plate, (x, y - thickness / 2, z), BLACK_PLASTIC, radius=min(0.003, 0.4 * thickness), solid=False)
    front = y - thickness
    top = z + height / 2
    b.box((columns * pitch, 0.001, 0.7 * pitch), (x, front - 0.0005, top - 0.7 * pitch), DISPLAY, solid=False)
    for i in range(columns * rows):
        column, row = i % columns - (columns - 1) / 2, i // columns
        b.box(
            (key, 0.002, key), (x + column * pitch, front - 0.001, top - (1.7 + row) * pitch), GRAY_PLASTIC, solid=False
        )


WHITE_CARD = Material("cardboard", "white", (0.92, 0.91, 0.88))
INK = materials.paint("gray", "paper", 0.0)
TAPE = Material("plastic", "beige", (0.86, 0.74, 0.52), gloss=0.4)
STORAGE = tuple(
    Material("cardboard", color, rgb)
    for color, rgb in (
        ("blue", (0.33, 0.46, 0.60)),
        ("green", (0.45, 0.58, 0.47)),
        ("gray", (0.60, 0.61, 0.62)),
        ("pink", (0.84, 0.62, 0.62)),
        ("red", (0.66, 0.27, 0.24)),
    )
)
WEAVES = (
    materials.WICKER,
    Material("wicker", "brown", (0.52, 0.36, 0.23), "wicker", 0.2),
    Material("wicker", "white", (0.92, 0.90, 0.85), "wicker", 0.2),
    Material("wicker", "gray", (0.62, 0.60, 0.57), "wicker", 0.2),
)
SAFE_COLORS = (
    materials.paint("gray", "metal", 0.35, (0.40, 0.41, 0.43)),
    materials.paint("black", "metal", 0.35, (0.17, 0.17, 0.18)),
    materials.paint("green", "metal", 0.35, (0.22, 0.32, 0.27)),
    materials.paint("white", "metal", 0.35, (0.82, 0.82, 0.80)),
)
DISPLAY = Material("glass", "green", (0.45, 0.85, 0.50), glow=0.6)

KINDS = {
    "Box": Kind(box),
    "Safe": Kind(safe),
}
