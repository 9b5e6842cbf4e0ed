"""Towels, what they hang on, and cleaning cloths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import cloth, primitives
from remqa_data.geometry.types import F64

TOWELS = tuple(
    materials.fabric(color, "towel", 0.3, rgb)
    for color, rgb in (
        ("white", (0.95, 0.94, 0.91)),
        ("blue", (0.36, 0.51, 0.68)),
        ("green", (0.50, 0.66, 0.55)),
        ("pink", (0.87, 0.64, 0.67)),
        ("beige", (0.85, 0.77, 0.64)),
        ("gray", (0.58, 0.59, 0.61)),
        ("red", (0.66, 0.24, 0.23)),
        ("yellow", (0.91, 0.79, 0.43)),
    )
)
RAIL_METALS = (materials.CHROME, materials.STEEL, materials.BRASS, materials.BLACK_METAL)


def towel(b: Builder) -> None:
    """A bath towel folded over a bar: with a border, layered with a smaller one, striped, or with a fringe; a flat one lies."""
    if _lies(b):
        _lying_towel(b)
    else:
        _folded_towel(b, folds=2.0, gather=1.0)


def hand_towel(b: Builder) -> None:
    """A hand towel drawn through a ring, narrower at the top: with a border, layered, striped, or fringed; a flat one lies."""
    if _lies(b):
        _lying_towel(b)
    else:
        _folded_towel(b, folds=1.5, gather=0.78)


def towel_holder(b: Builder) -> None:
    """A towel rail on the wall: round, square, double, or of wood; the bar is the front's upper edge."""
    metal = b.pick(materials.WOODS[:3] if b.variant == 3 else RAIL_METALS)
    fitting = b.pick(RAIL_METALS) if b.variant == 3 else metal
    radius = min(0.009, 0.25 * b.h, 0.1 * b.d)
    y, z, foot = -b.d / 2 + radius, b.h - radius, min(0.05, 0.1 * b.w)
    ends = b.w / 2 - foot / 2
    bars = [(y, z)] if b.variant != 2 else [(y, z), (y + 0.5 * b.d, 0.6 * b.h)]
    for bar_y, bar_z in bars:
        if b.variant == 1:
            b.box((b.w - foot, 2 * radius, 2 * radius), (0, bar_y, bar_z), metal, radius=0.002)
        else:
            length = b.w if b.variant == 3 else b.w - foot
            b.cylinder(radius, length, (0, bar_y, bar_z), metal, axis="x", sections=12)
    plate = min(0.012, 0.12 * b.d)
    for side in (-1, 1):
        x = side * ends
        if b.variant == 1:
            b.box((foot, plate, b.h), (x, b.d / 2 - plate / 2, b.h / 2), fitting, radius=0.002)
            b.box((0.5 * foot, b.d - plate, 2 * radius), (x, -plate / 2, z), fitting, radius=0.002)
        else:
            disc = primitives.cylinder(0.5, plate, 0.42, 20).scaled((foot, b.h, 1.0)).pointed("-y")
            b.add(disc, fitting, (x, b.d / 2 - plate / 2, b.h / 2), solid=True)
            arm = [
                (x, b.d / 2 - plate, b.h / 2),
                (x, 0.1 * b.d, b.h / 2),
                (x, y + 0.2 * b.d, 0.5 * (z + b.h / 2)),
                (x, y, z),
            ]
            b.add(primitives.tube(arm, radius * 0.95, 8), fitting, solid=True)
            if b.variant != 3:
                b.add(primitives.ellipsoid((2 * radius, 2 * radius, 2 * radius), 10, 6), fitting, (x, y, z))
    b.space("bar", (b.w - 2 * foot, 0.06, 0.62), (0, y, b.h + 0.012 - 0.31))
    b.looks_like(metal)


def hand_towel_holder(b: Builder) -> None:
    """A towel ring on a wall plate: round, square, an arch with a straight bar, or a triangle."""
    metal = b.pick(RAIL_METALS)
    radius = min(0.0055, 0.12 * b.d)
    post = 0.14 * b.h
    tall, wide = b.h - post, b.w - 2 * radius
    pivot_z = b.h - post
    shapes = (
        primitives.ellipse(wide, tall, 24),
        primitives.rounded_rect(wide, tall, 0.02, 3),
        np.vstack(
            [
                primitives.arc((0, 0), 1.0, 0, 180, 13) * [wide / 2, tall / 2],
                _corner(wide, tall, -1),
                _corner(wide, tall, 1),
            ]
        ),
        _rounded_triangle(wide, tall),
    )
    outline = b.by_variant(shapes)
    closed = np.vstack([outline, outline[:2]])
    y = -b.d / 2 + 2.2 * radius
    path = np.column_stack(
        [closed[:, 0], np.full(len(closed), y), radius + closed[:, 1] * (1 - 2 * radius / tall) + tall / 2]
    )
    b.add(primitives.tube(path, radius, 6), metal)
    for x, z, w, h in (
        (0, radius, 0.7 * wide, 2 * radius),
        (-wide / 2, tall / 2, 2 * radius, tall),
        (wide / 2, tall / 2, 2 * radius, tall),
    ):
        b.solid((w, 2 * radius, h), (x, y, z))
    plate = min(0.012, 0.25 * b.d)
    broad = min(2.2 * post, 0.34 * b.w)
    centre = pivot_z + post / 2 - broad / 2 + post / 2
    if b.variant in (0, 2):
        disc = primitives.cylinder(broad / 2, plate, 0.42 * broad, 20).pointed("-y")
        b.add(disc, metal, (0, b.d / 2 - plate / 2, centre), solid=True)
    else:
        b.box((broad, plate, broad), (0, b.d / 2 - plate / 2, centre), metal, radius=0.003)
    reach = b.d - plate
    b.cylinder(0.008, reach, (0, -plate / 2, pivot_z - radius), metal, axis="-y", top_radius=0.010, sections=12)
    b.add(
        primitives.ellipsoid((0.03, min(0.02, 0.35 * b.d), 0.03), 12, 6),
        metal,
        (0, -b.d / 2 + min(0.01, 0.175 * b.d), pivot_z - radius),
    )
    b.space("ring", (0.8 * b.w, 0.05, 0.42), (0, y, 0.35 * b.h + 0.012 - 0.21))


def cloth_(b: Builder) -> None:
    """A cleaning cloth that lies flat: folded in four, crumpled, folded in half with stripes, or spread out."""
    with b.quarter_turned(b.d > b.w):
        main = b.pick(TOWELS)
        second = _other(b, main)
        if b.variant in (0, 2):
            _folded_cloth(b, main, second)
        else:
            _loose_cloth(b, main, second)
        b.solid((0.8 * b.w, 0.8 * b.d, b.h * 0.9), (0, 0, 0.45 * b.h))
        b.looks_like(main)


def _lies(b: Builder) -> bool:
    """Whether a towel is put away rather than hung up: it is flatter than it is deep."""
    return b.h < b.d


def _lying_towel(b: Builder) -> None:
    """A towel that is folded to a pile of layers."""
    main = b.pick(TOWELS)
    _folded_cloth(b, main, _other(b, main))
    b.solid((b.w, b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(main)


def _folded_towel(b: Builder, *, folds: float, gather: float) -> None:
    main = b.pick(TOWELS)
    second = _other(b, main)
    t, amplitude = min(0.006, 0.2 * b.d), min(0.008, 0.16 * b.d)
    fringe = 0.05 * b.h if b.variant == 3 else 0.0
    back = b.by_variant((0.05, 0.02, 0.09, 0.04)) * b.h
    path = cloth.over_bar(b.d - amplitude - 0.003, b.h - fringe - 0.001, back, t)
    path[:, 1] += fringe

    def strip(points: F64, span: float, thickness: float, material: Material) -> None:
        grid = cloth.hung(points, b.h, b.w, folds, amplitude, gather=gather, span=span)
        b.add(cloth.slab(grid, thickness), material)

    strip(path, 1.0, t, main)
    for low, high in b.by_variant(
        (((0.10, 0.15), (0.165, 0.175)), (), ((0.08, 0.16), (0.24, 0.32), (0.40, 0.48)), ((0.12, 0.22),))
    ):
        strip(_between(path, low * b.h, high * b.h), 1.001, t + 0.002, second)
    if b.variant == 1:
        hems = path[path[:, 1] > 0.48 * b.h]
        strip(np.vstack([[[path[0, 0], 0.42 * b.h]], hems]), 0.55, t + 0.003, second)
    if fringe:
        hem = cloth.hung(path[:1], b.h, b.w, folds, amplitude, gather=gather, columns=13)[:, 0]
        for x, y, z in hem:
            inside = float(np.clip(x, -0.4775 * b.w, 0.4775 * b.w))
            b.box((0.045 * b.w, 0.6 * t, fringe + 0.004), (inside, float(y), float(z) / 2 + 0.002), main, solid=False)
    for y in (-(b.d - t) / 2, (b.d - t) / 2):
        b.solid((b.w, t, b.h), (0, y, b.h / 2))
    b.solid((b.w, b.d, t), (0, 0, b.h - t / 2))
    b.looks_like(main)


def _between(path: F64, low: float, high: float) -> F64:
    """The part of a towel's front between two heights."""
    return np.array([[float(path[0, 0]), z] for z in np.linspace(low, high, 2)])


def _folded_cloth(b: Builder, main: Material, second: Material) -> None:
    """Layers with round folds on the left, each a little smaller and turned against the one below."""
    layers = 4 if b.variant == 0 else 2
    thick = b.h / layers
    for i in range(layers):
        shrink = 1.0 - 0.035 * i
        mesh = primitives.rounded_box((b.w * shrink, b.d * shrink, thick * 1.04), 0.49 * thick, 2)
        turned = primitives.turn("z", (0.0, 1.4, -1.2, 0.6)[i])
        b.add(
            mesh.turned(turned), materials.tinted(main, 1.0 - 0.04 * (i % 2)), (-0.01 * b.w * i, 0, (i + 0.5) * thick)
        )
    top = b.h + 0.0004
    if b.variant == 2:
        for x in (-0.30, -0.22, 0.22, 0.30):
            b.box((0.035 * b.w, 0.8 * b.d, 0.001), (x * b.w, 0, top), second, solid=False)
    else:
        b.box((0.76 * b.w, 0.02 * b.d, 0.001), (-0.03 * b.w, -0.3 * b.d, top), second, solid=False)
        b.box((0.02 * b.w, 0.72 * b.d, 0.001), (0.27 * b.w, 0, top + 0.0004), second, solid=False)


def _loose_cloth(b: Builder, main: Material, second: Material) -> None:
    """A sheet with bumps: high and pinched when crumpled, low when spread."""
    crumpled = b.variant == 1
    n = 11 if crumpled else 10
    u, v = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    phases = b.rng.uniform(0, 2 * np.pi, 4)
    busy = 1.7 if crumpled else 1.0
    bumps = (
        np.sin(busy * (2.6 * u + 1.1 * v) + phases[0])
        + 0.8 * np.sin(busy * (-1.7 * u + 3.2 * v) + phases[1])
        + (0.7 if crumpled else 0.25) * np.sin(4.4 * u + 3.8 * v + phases[2])
    )
    bumps = (bumps - bumps.min()) / np.ptp(bumps)
    edge = np.clip(1.25 - np.maximum(np.abs(u), np.abs(v)) ** 4, 0.25, 1.0)
    wander = 0.10 if crumpled else 0.02
    x = u * (1 - wander * (1 + np.sin(3 * v + phases[3]))) * b.w / 2
    y = v * (1 - wander * (1 + np.sin(2.5 * u + phases[1]))) * b.d / 2
    t = min(0.004, 0.2 * b.h)
    rise = bumps * (edge if crumpled else 0.4 + 0.6 * edge)
    z = t / 2 + (b.h - t) * rise / rise.max()
    grid = np.stack([x, y, z], axis=2)
    b.add(cloth.slab(grid, t), main)
    if not crumpled:
        for rows in (slice(0, 2), slice(n - 2, n)):
            b.add(cloth.slab(grid[rows], t + 0.0015), second)


def _other(b: Builder, main: Material) -> Material:
    return replace(b.pick([one for one in TOWELS if one.color != main.color]), repeat_m=main.repeat_m)


def _corner(wide: float, tall: float, side: int) -> F64:
    radius = 0.018
    start = 180 if side < 0 else 270
    return primitives.arc((side * (wide / 2 - radius), -tall / 2 + radius), radius, start, start + 90, 4)


def _rounded_triangle(wide: float, tall: float) -> F64:
    corners: Sequence[tuple[float, float, int, int]] = ((-1, -1, 150, 270), (1, -1, 270, 390), (0, 1, 30, 150))
    radius = 0.016
    parts = [
        primitives.arc((sx * (wide / 2 - 1.15 * radius), sz * (tall / 2 - radius)), radius, low, high, 4)
        for sx, sz, low, high in corners
    ]
    return np.vstack(parts)


KINDS = {
    "Towel": Kind(towel),
    "TowelHolder": Kind(towel_holder),
    "HandTowel": Kind(hand_towel),
    "HandTowelHolder": Kind(hand_towel_holder),
    "Cloth": Kind(cloth_),
}
