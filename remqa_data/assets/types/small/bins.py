"""Laundry hampers, bins and bin bags: what one throws things into."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, STEEL
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.table_parts import leaning_leg
from remqa_data.assets.types.small.containers import LID_OPEN_DEG, WEAVES
from remqa_data.geometry.types import F64


def laundry_hamper(b: Builder) -> None:
    """A laundry hamper with a hinged lid: square wicker, oval wicker, slotted plastic, or cloth in a wooden frame."""
    material = b.by_variant((b.pick(WEAVES), b.pick(WEAVES), b.pick(HAMPER_PLASTICS), b.pick(materials.FABRICS)))
    power, taper = b.by_variant(((8.0, 0.90), (2.3, 0.86), (6.0, 0.85), (12.0, 0.94)))
    lid = 0.035
    rim = b.h - lid
    trim = b.by_variant((materials.tinted(material, 0.75), materials.tinted(material, 0.75), material, materials.OAK))
    size = (b.w - 0.02, b.d - 0.02)
    floor = b.level(0.02, 0.012, 0.4 * b.h)
    tub(b, size, taper, rim, 0.010, material, power=power, floor=floor)
    _ring(b, size, power, rim - 0.022, 0.02, trim, 0.008)
    _decorate_hamper(b, size, power, taper, rim, trim)
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(LID_OPEN_DEG)), origin=(0, b.d / 2, rim)):
        plate = primitives.ellipse(b.w, b.d, 32, power)
        b.add(primitives.prism(plate, 0.6 * lid), trim if b.variant == 3 else material, (0, 0, rim + 0.3 * lid))
        b.add(primitives.prism(0.86 * plate, 0.4 * lid), trim if b.variant == 3 else material, (0, 0, rim + 0.8 * lid))
        b.solid((0.9 * b.w, 0.9 * b.d, lid), (0, 0, rim + lid / 2))
    b.looks_like(material)


def _decorate_hamper(
    b: Builder, size: tuple[float, float], power: float, taper: float, rim: float, trim: Material
) -> None:
    width, depth = size
    if b.variant == 3:  # the frame's posts, and its stretchers
        for sx in (-1, 1):
            for sy in (-1, 1):
                x, y = 0.485 * sx * width, 0.485 * sy * depth
                leaning_leg(b, (taper * x, taper * y), (x, y), rim - 0.002, (0.011, 0.011), trim)
    elif b.variant == 2:  # columns of ventilation slots on the front and the back, grips on the ends
        for row in range(4):
            z = (0.22 + 0.15 * row) * rim
            y = depth / 2 * (taper + (1 - taper) * z / rim)
            for k in range(-3, 4):
                for s in (-1, 1):
                    b.box((0.018, 0.004, 0.09 * rim), (k * 0.095 * width, s * y, z), materials.SHADOW_GAP, solid=False)
    else:
        z = 0.5 * rim
        middle = (1 + taper) / 2
        _ring(b, (width * middle, depth * middle), power, z, 0.025, trim, 0.004)
        _ring(b, (width * taper, depth * taper), power, 0.0, 0.03, trim, 0.006)


def garbage_can(b: Builder) -> None:
    """An open bin: round with a rim, square with a bin bag, step bin with its lid up, or wire mesh."""
    color = b.pick(BIN_PLASTICS)
    if b.variant == 0:
        tub(b, (b.w, b.d), 0.78, b.h, 0.006, color, power=2.0, floor=_bin_floor(b))
        _ring(b, (b.w - 0.012, b.d - 0.012), 2.0, b.h - 0.03, 0.024, materials.tinted(color, 0.85), 0.006)
    elif b.variant == 1:
        bag = b.pick((materials.paint("white", gloss=0.4), materials.paint("black", gloss=0.4)))
        size = (b.w - 0.008, b.d - 0.008)
        tub(b, size, 0.82, b.h - 0.004, 0.008, color, power=7.0, floor=_bin_floor(b), lining=bag)
        _ring(b, size, 7.0, b.h - 0.07, 0.07, bag, 0.004)
        b.box(
            (0.14, 0.006, 0.035), (0, -0.91 * size[1] / 2 - 0.006, 0.5 * b.h), materials.tinted(color, 0.7), solid=False
        )
    elif b.variant == 2:
        _step_bin(
            b, b.pick((STEEL, materials.WHITE_METAL, materials.BLACK_METAL, materials.paint("red", "metal", 0.4)))
        )
    else:
        _mesh_bin(b, b.pick((materials.BLACK_METAL, STEEL, materials.WHITE_METAL)))


def _bin_floor(b: Builder) -> float:
    """Height of a bin's inner floor, above the hollow on whose rim it stands."""
    return b.level(BIN_FLOOR_M, BIN_FLOOR_M, 0.4 * b.h)


def _step_bin(b: Builder, metal: Material) -> None:
    """A pedal bin whose lid stands open at the back."""
    pedal = min(0.05, 0.12 * b.d)
    depth = b.d - pedal - 0.02
    y = pedal / 2 - 0.01
    rim = b.h - min(0.42 * b.h, 0.8 * depth)
    floor = _bin_floor(b)
    tub(b, (b.w, depth), 0.97, rim, 0.007, metal, power=2.4, floor=floor, at=(0, y), lining=BLACK_PLASTIC)
    _ring(b, (b.w - 0.01, depth - 0.01), 2.4, 0.0, 0.035, BLACK_PLASTIC, 0.005, at=(0, y))
    _ring(b, (b.w - 0.012, depth - 0.012), 2.4, rim - 0.02, 0.02, BLACK_PLASTIC, 0.004, at=(0, y))
    b.box((0.07, pedal + 0.03, 0.012), (0, -b.d / 2 + (pedal + 0.03) / 2, 0.022), BLACK_PLASTIC, radius=0.003)
    height = b.h - rim
    dome = primitives.prism(primitives.ellipse(b.w - 0.004, 2 * height, 24, 2.6)[:13], 0.018).pointed("y")
    # `pointed` sends the ellipse's y to -z: turn it over so that the round side is up.
    b.add(dome.turned(primitives.turn("y", 180)), metal, (0, b.d / 2 - 0.009, rim))
    b.solid((0.8 * b.w, 0.018, height), (0, b.d / 2 - 0.009, rim + height / 2))
    b.box((0.12, 0.025, 0.03), (0, b.d / 2 - 0.0125, rim - 0.004), BLACK_PLASTIC, solid=False)


def _mesh_bin(b: Builder, metal: Material) -> None:
    """A basket of slats between rings, round like a waste paper basket."""
    r, taper, count = 0.005, 0.80, 26
    for z, scale in ((b.h - r, 1.0), (0.5 * b.h, 0.9 + 0.0), (r, taper)):
        loop = primitives.ellipse(scale * (b.w - 2 * r), scale * (b.d - 2 * r), 24)
        ring = np.column_stack([loop, np.full(24, z)])
        b.add(primitives.tube(np.vstack([ring, ring[:1]]), r, 6), metal)
    upper = primitives.ellipse(b.w - 2 * r, b.d - 2 * r, count)
    for x, y in upper:
        path = np.array([[taper * x, taper * y, r], [x, y, b.h - r]])
        b.add(primitives.tube(path, 0.0028, 4), metal)
    floor = _bin_floor(b)
    disc = primitives.ellipse(taper * (b.w - r), taper * (b.d - r), 24)
    b.add(primitives.prism(disc, floor), materials.tinted(metal, 0.9), (0, 0, floor / 2))
    _tub_solids(b, (b.w, b.d), taper, b.h, 0.008, floor, 2.0, (0.0, 0.0))


def garbage_bag(b: Builder) -> None:
    """A full bin bag: with a knot, tied with a drawstring, with two tied ears, or slumped with a flared neck."""
    plastic = b.pick(b.by_variant(BAG_PLASTICS))
    lobes, bulge, neck = b.by_variant(((5, 0.07, 0.80), (7, 0.04, 0.86), (4, 0.09, 0.76), (6, 0.10, 0.68)))
    profile = [
        (0.62, 0),
        (0.86, 0.05),
        (0.98, 0.18),
        (1, 0.32),
        (0.92, 0.5),
        (0.7, neck - 0.12),
        (0.34, neck - 0.03),
        (0.1, neck),
    ]
    phase = b.between(0, 6.28)
    count = 28
    around = np.arange(count) * 2 * np.pi / count
    rings = []
    for i, (radius, z) in enumerate(profile):
        wrinkle = 1 + bulge * np.sin(lobes * around + phase + 0.9 * i) * np.sin(np.pi * min(z / neck, 1) + 0.25)
        pleats = 1 + (0.10 if radius < 0.5 else 0.03 * (z > 0.4)) * np.cos(14 * around)
        r = radius * wrinkle * pleats / (1 + bulge)
        rings.append(
            np.column_stack([r * np.cos(around) * b.w / 2, r * np.sin(around) * b.d / 2, np.full(count, z * b.h)])
        )
    rings = _filling(rings, b.w, b.d)
    b.add(primitives.loft(np.array(rings)), plastic)
    _bag_top(b, plastic, neck * b.h)
    b.solid((0.72 * b.w, 0.72 * b.d, 0.5 * b.h), (0, 0, 0.25 * b.h))
    b.solid((0.45 * b.w, 0.45 * b.d, (neck - 0.5) * b.h), (0, 0, (0.5 + (neck - 0.5) / 2) * b.h))


def _filling(rings: list[F64], width: float, depth: float) -> list[F64]:
    """The rings stretched so that the widest reach the sides of the box."""
    points = np.vstack(rings)
    low, high = points.min(axis=0), points.max(axis=0)
    scale = np.array([width / (high[0] - low[0]), depth / (high[1] - low[1]), 1.0])
    shift = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, 0.0])
    return [(ring - shift) * scale for ring in rings]


def _bag_top(b: Builder, plastic: Material, neck: float) -> None:
    """What is above the tie."""
    left = b.h - neck
    tie = b.pick((materials.paint("red"), materials.paint("yellow"), materials.paint("white")))
    r = 0.05 * min(b.w, b.d)
    if b.variant in (0, 2):
        b.add(primitives.ellipsoid((3.2 * r, 2.8 * r, 0.42 * left), 12, 6), plastic, (0, 0, neck + 0.10 * left))
        for side in (-1, 1):
            if b.variant == 0:  # the twisted ends of the knot
                ear = [(0.0, 0.1), (0.5, 0.5), (1.2, 0.97)]
                radii = [0.9 * r, 0.5 * r, 0.2 * r]
            else:  # long ears that hang over
                ear = [(0.0, 0.1), (1.3, 0.55), (2.6, 0.9), (3.7, 0.75), (4.4, 0.35)]
                radii = [0.8 * r, 0.55 * r, 0.6 * r, 0.75 * r, 0.9 * r]
            path = np.array([(side * x * r, 0.0, neck + z * left) for x, z in ear])
            b.add(primitives.tube(path, radii, 8), plastic)
    else:
        flare = 2.6 * r if b.variant == 1 else 4.0 * r
        rings = []
        around = np.arange(20) * 2 * np.pi / 20
        for f, z in ((1.6 * r, neck - 0.02 * b.h), (1.3 * r, neck + 0.2 * left), (flare, b.h)):
            wave = f * (1 + 0.15 * np.cos(5 * around) * (z == b.h))
            rings.append(np.column_stack([wave * np.cos(around), wave * np.sin(around), np.full(20, z)]))
        b.add(primitives.loft(np.array(rings)), plastic)
        loop = [(1.75 * r * np.cos(a), 1.75 * r * np.sin(a), neck + 0.16 * left) for a in np.linspace(0, 2 * np.pi, 13)]
        b.add(primitives.tube(np.array(loop), 0.006, 6), tie)
        if b.variant == 1:
            for side in (-1, 1):
                ends = np.array(
                    [
                        [0, -1.8 * r, neck + 0.16 * left],
                        [side * 2 * r, -2.6 * r, neck + 0.2 * left],
                        [side * 2.6 * r, -3.0 * r, neck - 0.3 * left],
                    ]
                )
                b.add(primitives.tube(ends, 0.006, 6), tie)


def tub(
    b: Builder,
    size: tuple[float, float],
    taper: float,
    height: float,
    wall: float,
    material: Material,
    *,
    power: float,
    floor: float,
    at: tuple[float, float] = (0.0, 0.0),
    lining: Material | None = None,
) -> None:
    """Draw an open tub that holds things, from a narrower bottom up to a plan (width, depth) at its rim.

    Parameters
    ----------
    taper : float
        Size of the bottom as a fraction of the rim.
    power : float
        2 for an oval plan; larger for a rectangle with ever sharper corners.
    floor : float
        Height of the inner floor, metres.
    lining : Material, optional
        Material of the inside; the same as outside without it.
    """
    width, depth = size
    offset = np.array([at[0], at[1], 0.0])
    inner_taper = taper + (1 - taper) * floor / height

    def ring(scale: float, z: float, shrink: float) -> F64:
        plan = primitives.ellipse(scale * width - 2 * shrink, scale * depth - 2 * shrink, 32, power)
        return np.asarray(np.column_stack([plan, np.full(32, z)]) + offset)

    outer = [ring(taper, 0.0, 0.0), ring((taper + 1) / 2, height / 2, 0.0), ring(1.0, height, 0.0)]
    inner = [ring(1.0, height, wall), ring(inner_taper, floor, wall)]
    b.add(primitives.loft(outer, capped=False), material)
    b.add(primitives.loft([outer[-1], inner[0]], capped=False), material)
    b.add(primitives.loft(inner, capped=False), lining or material)
    centre = (at[0], at[1], floor - 0.001)
    b.add(primitives.prism(inner[-1][:, :2] - offset[:2], 0.002), lining or material, centre)
    b.add(primitives.prism(outer[0][:, :2] - offset[:2], 0.002), material, (at[0], at[1], 0.001))
    _tub_solids(b, size, taper, height, wall, floor, power, at)


def _tub_solids(
    b: Builder,
    size: tuple[float, float],
    taper: float,
    height: float,
    wall: float,
    floor: float,
    power: float,
    at: tuple[float, float],
) -> None:
    """Collision walls and floor of a tub, and the space inside it."""
    width, depth = size
    middle, wall = (1 + taper) / 2, max(wall, 0.01)
    round_ = power < 4
    count = 8 if round_ else 4
    for k in range(count):
        angle = 2 * np.pi * k / count
        c, s = np.cos(angle), np.sin(angle)
        reach = middle / 2 / np.hypot(c / width, s / depth)
        across = 2 * reach * np.tan(np.pi / count) if round_ else middle * (depth if k % 2 == 0 else width)
        radius = reach - wall / 2
        turn = primitives.turn("z", float(np.degrees(angle)))
        b.solid((wall, across, height), (at[0] + radius * c, at[1] + radius * s, height / 2), turn)
    fill = taper * (0.72 if round_ else 0.96)
    b.solid((fill * width, fill * depth, floor), (at[0], at[1], floor / 2))
    inside = (fill * (width - 2 * wall), fill * (depth - 2 * wall), height - floor)
    b.space("inside", inside, (at[0], at[1], (height + floor) / 2), enclosed=b.spec.type == "LaundryHamper")


def _ring(
    b: Builder,
    size: tuple[float, float],
    power: float,
    z: float,
    height: float,
    material: Material,
    out: float,
    at: tuple[float, float] = (0.0, 0.0),
) -> None:
    """A band around a tub, standing out from a plan (width, depth)."""
    outer = primitives.ellipse(size[0] + 2 * out, size[1] + 2 * out, 32, power)
    inner = primitives.ellipse(size[0] - 0.004, size[1] - 0.004, 32, power)
    b.add(primitives.prism(outer, height, [inner]), material, (at[0], at[1], z + height / 2))


BIN_FLOOR_M = 0.055
HAMPER_PLASTICS = tuple(materials.paint(color) for color in ("white", "blue", "gray", "pink"))
BIN_PLASTICS = tuple(materials.paint(color) for color in ("gray", "black", "blue", "green", "white", "red"))
BLACK_BAG = materials.paint("black", gloss=0.55, rgb=(0.13, 0.13, 0.14))
WHITE_BAG = materials.paint("white", gloss=0.45)
GREEN_BAG = materials.paint("green", gloss=0.5, rgb=(0.22, 0.40, 0.27))
BLUE_BAG = materials.paint("blue", gloss=0.5, rgb=(0.25, 0.38, 0.58))
BAG_PLASTICS = ((BLACK_BAG, GREEN_BAG), (WHITE_BAG, BLACK_BAG), (GREEN_BAG, WHITE_BAG), (BLACK_BAG, BLUE_BAG))

KINDS = {
    "LaundryHamper": Kind(laundry_hamper),
    "GarbageCan": Kind(garbage_can),
    "GarbageBag": Kind(garbage_bag),
}
