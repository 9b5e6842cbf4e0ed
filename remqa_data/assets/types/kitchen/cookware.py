"""Pots, pans, kettles: what one cooks in. All hollow."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.turnery import Piece, Profile, loop, radius_at, rod, rounded, turned, turned_vessel
from remqa_data.assets.types.kitchen.tableware import ENAMELS
from remqa_data.geometry.types import F64, Vec3

NONSTICK = Material("metal", "black", (0.12, 0.12, 0.13), gloss=0.3)
CAST_IRON = Material("metal", "black", (0.19, 0.19, 0.20), gloss=0.15)
ALUMINIUM = Material("metal", "gray", (0.80, 0.80, 0.81), gloss=0.5)
INSIDE = Material("metal", "gray", (0.36, 0.37, 0.39), gloss=0.2)
BAKELITE = paint("black", gloss=0.35)


def pot(b: Builder) -> None:
    """A cooking pot with two handles: steel stock pot; enamelled with lugs; copper with brass; black with ears.

    In a nearly square box the handles lie on the diagonal. In a very long one, one of them is as long as a saucepan's.
    """
    deep = b.d > b.w
    with b.quarter_turned(deep):
        enamel = b.pick(ENAMELS)
        body, grip, rim, lining = b.by_variant(
            (
                (materials.STEEL, materials.CHROME, materials.CHROME, ALUMINIUM),
                (enamel, enamel, materials.CHROME, materials.WHITE_CERAMIC),
                (materials.COPPER, materials.BRASS, materials.COPPER, ALUMINIUM),
                (NONSTICK, *(b.pick((BAKELITE, *ENAMELS[:2])),) * 2, INSIDE),
            )
        )
        shape = b.by_variant(
            (
                [(0.96, 0.0), (0.97, 0.04), (0.97, 0.94), (1.0, 0.97), (1.0, 1.0)],
                [(0.76, 0.0), (0.88, 0.06), (0.95, 0.30), (0.98, 0.93), (1.0, 0.95), (1.0, 1.0)],
                [(0.70, 0.0), (0.80, 0.06), (0.92, 0.40), (0.98, 0.94), (1.0, 1.0)],
                [(0.86, 0.0), (0.90, 0.03), (0.95, 0.50), (0.97, 0.95), (1.0, 0.97), (1.0, 1.0)],
            )
        )
        r, gap = b.d / 2, b.w - b.d
        side = [(p * r, z * b.h) for p, z in shape]
        saucepan, square = gap > 0.12, gap < 0.2 * b.d
        ear = min(0.045, 0.18 * b.w) if saucepan else 0.24 * r if square else gap / 2
        x = ear + r - b.w / 2 if saucepan else 0.0
        pieces: list[Piece] = [(body, [(0, 0), *side[:-2]]), (rim, side[-2:])]
        turned_vessel(b, pieces, lining, (x, 0, 0), wall=0.005, floor=0.008)
        z = b.h * b.by_variant((0.80, 0.82, 0.78, 0.84))
        inner = radius_at(side, z)
        turn = primitives.turn("z", (45.0 if deep else -45.0) if square else 0.0)
        _ear(b, (x, z), inner, r + ear, turn @ primitives.turn("z", 180), grip)
        if saucepan:
            _long_handle(b, (x + inner, 0.0), (b.w / 2, 0.0), z, min(z + 0.02, b.h), grip)
        else:
            _ear(b, (x, z), inner, r + ear, turn, grip)
        b.looks_like(body)


def pan(b: Builder) -> None:
    """A frying pan with one long handle: black non-stick; steel; cast iron with spouts; enamelled with wood.

    In a box nearly as wide as long, the handle runs along the diagonal.
    """
    with b.quarter_turned(b.w > b.d):
        enamel = b.pick(ENAMELS[:4])
        outside, lining, grip = b.by_variant(
            (
                (NONSTICK, materials.tinted(NONSTICK, 1.5), b.pick((BAKELITE, paint("red", gloss=0.3)))),
                (materials.STEEL, ALUMINIUM, materials.CHROME),
                (CAST_IRON, materials.tinted(CAST_IRON, 0.75), CAST_IRON),
                (enamel, materials.tinted(NONSTICK, 1.7), b.pick((materials.OAK, materials.WALNUT))),
            )
        )
        straight = b.d - b.by_variant((0.15, 0.15, 0.11, 0.15))
        diagonal = straight < 0.85 * b.w
        r = 0.36 * b.w if diagonal else min(b.w, straight) / 2
        x, y = (b.w / 2 - r, b.d / 2 - r) if diagonal else (0.0, b.d / 2 - r)
        depth = b.h * b.by_variant((0.75, 0.8, 0.94, 0.8))
        foot, wall = b.by_variant(((0.66, 0.004), (0.76, 0.003), (0.92, 0.007), (0.78, 0.004)))
        curve = rounded([(foot * r, 0), ((foot + 0.6) / 1.6 * r, 0.10 * depth), (0.96 * r, 0.8 * depth), (r, depth)])
        turned_vessel(
            b, [(outside, [(0, 0), *curve])], lining, (x, y, 0), wall=wall, floor=min(0.006, 0.2 * depth), sections=22
        )
        end = np.array([-b.w / 2, -b.d / 2] if diagonal else [0.0, -b.d / 2])
        away = (end - [x, y]) / np.linalg.norm(end - [x, y])
        start = np.array([x, y]) + away * (r - 0.002)
        _long_handle(b, (start[0], start[1]), (end[0], end[1]), depth * 0.86, b.h, grip)
        if b.variant == 2:  # lips to pour from, left and right
            for side in (-1, 1):
                lip = primitives.ellipsoid((0.03, 0.04, 0.02), 10, 4).moved((side * (r - 0.008), 0, depth - 0.0105))
                b.add(
                    lip.turned(primitives.turn("z", 90 + float(np.degrees(np.arctan2(away[1], away[0]))))),
                    outside,
                    (x, y, 0),
                )
        b.looks_like(outside)


def kettle(b: Builder) -> None:
    """A kettle with a hinged lid: enamelled with a bow; electric jug; conical whistling kettle; gooseneck.

    Spout and handle lie on the diagonal of the box, so that both fit beside a round body.
    """
    metal = b.pick(
        b.by_variant(
            (
                ENAMELS,
                (materials.STEEL, materials.WHITE_METAL, NONSTICK),
                (materials.STEEL, *ENAMELS[:2]),
                (NONSTICK, materials.COPPER, materials.STEEL),
            )
        )
    )
    grip = b.by_variant((materials.WALNUT, BAKELITE, BAKELITE, b.pick((BAKELITE, materials.OAK))))
    bow = b.variant in (0, 2)
    r = min(b.w, b.d) * b.by_variant((0.43, 0.42, 0.43, 0.38))
    top = b.h * (0.58 if bow else 0.88)
    mouth = min(0.42 * (b.h - top) - 0.004, 0.5 * r) if bow else 0.62 * r  # the open lid passes under the bow
    shape = b.by_variant(
        (
            [(0.80, 0.0), (0.98, 0.10), (1.0, 0.40), (0.95, 0.70), (0.70, 0.95)],
            [(1.0, 0.0), (1.0, 0.08), (0.94, 0.10), (0.86, 0.60), (0.76, 0.97)],
            [(0.98, 0.0), (1.0, 0.08), (0.86, 0.45), (0.66, 0.80), (0.55, 0.97)],
            [(0.98, 0.0), (1.0, 0.05), (0.93, 0.40), (0.82, 0.80), (0.74, 0.97)],
        )
    )
    side = [(p * r, z * top) for p, z in shape]
    corner = np.array([b.w, -b.d]) / 2
    diagonal = corner / np.linalg.norm(corner)
    # With a bow above it, the body fills the corner behind the spout; a handle takes its share of the diagonal.
    at = np.array([r, -r]) - corner if bow else diagonal * (0.08 if b.variant == 1 else -0.05) * b.w
    forward = (corner - at) / np.linalg.norm(corner - at)
    reach = float(np.linalg.norm(corner - at)) - 0.004
    x, y = float(at[0]), float(at[1])
    _kettle_body(b, (x, y, 0), side, mouth, top, metal)
    _spout(b, (x, y, 0), side, forward, reach, top, metal)
    if bow:
        _bow(b, (x, y, 0), side, top, grip)
    else:
        _kettle_handle(b, (x, y, 0), side, -forward, float(np.linalg.norm(corner + at)) - 0.004, top, grip)
    _kettle_lid(b, (x, y, top), mouth, min(0.6 * (b.h - top), 0.03) if bow else b.h - top, metal, grip)
    b.looks_like(metal)


def _ear(b: Builder, centre: tuple[float, float], inner: float, outer: float, turn: F64, material: Material) -> None:
    """A handle on the side of a pot at (x, z), between two radii: bent rod, lug, riveted bow or bakelite ear."""
    x, z = centre
    thick = b.by_variant((0.0045, 0.006, 0.0055, 0.007))
    half = min(b.by_variant((0.038, 0.036, 0.040, 0.034)), 0.6 * inner)
    root = float(np.sqrt(inner**2 - half**2)) - 0.0015
    power = b.by_variant((5.0, 2.6, 2.4, 3.2))
    bend = loop((root, -half, 0), (root, half, 0), (outer - thick - root, 0, 0), power=power)
    b.add(primitives.tube(bend, thick, 6).turned(turn), material, (x, 0, z))
    middle = turn @ [(inner + outer) / 2, 0, 0]
    b.solid((0.8 * (outer - inner), half, 2 * thick), (x + middle[0], middle[1], z), turn)
    if b.variant == 1:  # the lug is filled
        b.add(primitives.prism([*bend[:, :2], (inner - 0.002, 0.0)], 0.006).turned(turn), material, (x, 0, z))
    else:
        for y in (-half, half):
            plate = primitives.rounded_box((0.006, 0.022, 0.026), 0.002, 1).moved((root + 0.0042, y, 0))
            b.add(plate.turned(turn), material, (x, 0, z))


def _long_handle(
    b: Builder, start: tuple[float, float], end: tuple[float, float], z: float, top: float, material: Material
) -> None:
    """A handle in the xy plane that rises from z to the top, with an eye to hang it by."""
    a, e = np.array(start), np.array(end)
    length = float(np.linalg.norm(e - a))
    t = b.by_variant((0.016, 0.010, 0.014, 0.018))
    up = top - t / 2
    wide = b.by_variant((0.024, 0.022, 0.026, 0.022))
    stations = [
        (-0.006, wide, 0.006, z),
        (0.18, wide * 0.8, 0.008, z + 0.45 * (up - z)),
        (0.35, wide * 0.85, t * 0.9, z + 0.85 * (up - z)),
    ]
    stations += [(0.70, wide, t, up), (0.93, wide * 1.05, t, up), (1.0, wide * 0.6, t * 0.8, up)]
    neck = 3 if b.variant in (0, 3) else 6
    turn = primitives.turn("z", float(np.degrees(np.arctan2(-(e - a)[0], (e - a)[1]))))
    placed = [(s * length, w, d, h) for s, w, d, h in stations]
    b.add(rod(placed[:neck], 8, 3.0).turned(turn), materials.CHROME if neck == 3 else material, (a[0], a[1], 0))
    if neck == 3:
        b.add(rod(placed[2:], 8, 3.0).turned(turn), material, (a[0], a[1], 0))
    eye = a + (e - a) * 0.93
    b.add(primitives.cylinder(0.005, t + 0.001, sections=10), materials.SHADOW_GAP, (eye[0], eye[1], up))
    middle = (a + e) / 2
    b.solid((wide, 0.9 * length, t), (middle[0], middle[1], up), turn)


def _kettle_body(b: Builder, at: Vec3, side: Profile, mouth: float, top: float, metal: Material) -> None:
    """The hollow body of a kettle, its outside drawn by a profile, with a mouth on top."""
    floor, wall, foot = 0.008, 0.004, 3 if b.variant == 1 else 1
    points = [(float(r), float(z)) for r, z in side]
    inner = [(r - wall, z - 0.003) for r, z in points[::-1] if z > floor + 0.01]
    inside = [(mouth - 0.001, top), *inner, (points[0][0] - wall, floor), (0.0, floor)]
    outside = [(0.0, 0.0), *points]
    turned(
        b,
        [(BAKELITE, outside[: foot + 1]), (metal, [*outside[foot + 1 :], (mouth, top)]), (INSIDE, inside)],
        at,
        sections=18,
    )
    b.hollow([*outside[:4], (points[2][0], top), *inside[-2:]], at, floor=floor)
    width = 1.2 * mouth
    b.space("inside", (width, width, top - floor), (at[0], at[1], (top + floor) / 2), enclosed=True)


def _bow(b: Builder, at: Vec3, side: Profile, top: float, grip: Material) -> None:
    """A handle that arches over the lid of a kettle, along the lid's hinge, up to the top of the box."""
    wide, foot = 0.80 * radius_at(side, 0.8 * top), 0.86 * top
    start, end = ((wide * s, 0.0, foot) for s in (-1, 1))
    arch = loop(start, end, (0, 0, b.h - 0.006 - foot), power=b.by_variant((2.4, 2.0, 4.0, 2.0)), count=11)
    b.add(primitives.tube(arch[:4], 0.004, 6), materials.CHROME, at)
    b.add(primitives.tube(arch[-4:], 0.004, 6), materials.CHROME, at)
    b.add(primitives.tube(arch[3:-3], 0.0065), grip, at)


def _kettle_handle(b: Builder, at: Vec3, side: Profile, back: F64, reach: float, top: float, grip: Material) -> None:
    """A handle beside a kettle, towards a direction in the xy plane, out to a distance from its axis."""
    low, high = 0.22 * top, 0.90 * top
    start, end = ((*(back * (radius_at(side, z) - 0.004)), z) for z in (low, high))
    out = reach - 0.008 - (radius_at(side, low) + radius_at(side, high)) / 2
    b.add(primitives.tube(loop(start, end, (*(back * out), 0.0), power=3.0), 0.008), grip, at)
    x, y = back * (reach - 0.015)
    b.solid((0.018, 0.018, high - low), (at[0] + x, at[1] + y, (low + high) / 2))


def _kettle_lid(b: Builder, at: Vec3, mouth: float, knob: float, metal: Material, grip: Material) -> None:
    """A lid with a knob, hinged behind the mouth at a point on the kettle's axis."""
    x, y, z = at
    rim = mouth + 0.004
    dome = [(0.0, 0.0005), (rim, 0.0005), (rim, 0.003), (0.45 * mouth, 0.006), (0.004, 0.35 * knob)]
    ball = [(0.005, 0.40 * knob), (0.011, 0.6 * knob), (0.010, 0.9 * knob), (0.0, knob)]
    hinge = (x, y + mouth + 0.002, z + 0.001)
    with b.link("lid", "revolute", axis="-x", upper=float(np.radians(100)), origin=hinge):
        turned(b, [(metal, dome), (grip, ball)], at, sections=16)
        b.solid((1.6 * rim, 1.6 * rim, 0.008), (x, y, z + 0.005))


def _spout(b: Builder, at: Vec3, side: Profile, forward: F64, reach: float, top: float, metal: Material) -> None:
    """A spout from the body towards a direction in the xy plane: short, beak, straight or gooseneck."""
    low, lip, thick, thin = b.by_variant(
        (
            (0.42, 0.96, 0.019, 0.009),
            (0.66, 0.98, 0.030, 0.012),
            (0.50, 0.92, 0.017, 0.009),
            (0.16, 0.98, 0.009, 0.0055),
        )
    )
    r = radius_at(side, low * top)
    bends = b.by_variant(
        (
            [(-0.10, 0.0), (0.45, 0.25), (0.75, 0.75), (1.0, 1.0)],
            [(-0.35, 0.0), (0.4, 0.60), (1.0, 1.0)],
            [(-0.15, 0.0), (0.5, 0.5), (1.0, 1.0)],
            [(-0.15, 0.0), (0.5, 0.0), (0.85, 0.3), (0.42, 0.75), (0.60, 1.0), (1.0, 1.0)],
        )
    )
    line = np.array([(r + s * (reach - thin - r), (low + u * (lip - low)) * top) for s, u in bends])
    line = rounded(line) if b.variant in (0, 3) else line
    path = np.column_stack([line[:, :1] * forward, line[:, 1]])
    b.add(primitives.tube(path, np.linspace(thick, thin, len(path)).tolist()), metal, at)
    ahead = (path[-1] - path[-2]) / np.linalg.norm(path[-1] - path[-2])
    b.add(primitives.tube([path[-1] - 0.001 * ahead, path[-1] + 0.0006 * ahead], thin * 0.75), materials.SHADOW_GAP, at)


KINDS = {"Pot": Kind(pot), "Pan": Kind(pan), "Kettle": Kind(kettle)}
