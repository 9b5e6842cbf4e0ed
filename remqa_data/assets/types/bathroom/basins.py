"""Sinks, bathtubs and their basins; faucets and toilets have modules of their own."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.carcass import grown
from remqa_data.assets.parts.hollows import (
    GAP,
    bowl,
    carved,
    corner,
    drain,
    enamel,
    free_boxes,
    inset,
    rim_spaces,
    ring,
    solid_body,
    suite,
)
from remqa_data.geometry.types import F64, Box, Rect

STANDS_M = 0.45
"""Sinks higher than this stand on the floor or hang on a wall; lower ones are let into a counter."""

DIVIDED = 3
"""Of the variants of a sink basin, the one with two bowls, if it is wide enough."""
DOUBLE_M = 0.5
"""From this width on, basins of the last variant are divided in two."""
PAINTS = (
    materials.ceramic("black", (0.16, 0.16, 0.17)),
    materials.ceramic("blue", (0.36, 0.50, 0.60)),
    materials.ceramic("green", (0.35, 0.50, 0.42)),
)
"""Outsides of freestanding bathtubs."""


def sink(b: Builder) -> None:
    """A sink around its basin: plain rim, draining board, front apron, tap ledge; tall ones on four kinds of stand."""
    material = suite(b)
    low = max(0.0, b.h - 0.16) if b.h > STANDS_M else 0.0
    default = (-0.38 * b.w, -0.38 * b.d, low, 0.38 * b.w, 0.26 * b.d, b.h)
    basins = [pocket for pocket in b.pockets if pocket[5] > 0.8 * b.h or b.h <= STANDS_M]
    beneath = [pocket for pocket in b.pockets if pocket not in basins]  # cabinets, which carry the sink
    holes = free_boxes(b, basins or [default])
    lip = min(0.018, 0.15 * b.h)
    radius = _outer_radius(b, holes, b.by_variant((0.05, 0.03, 0.02, 0.008)))
    plan = (-b.w / 2, -b.d / 2, b.w / 2, b.d / 2)
    bead = 0.005 if _margin(b, holes) > 0.02 and b.variant != 3 else 0.0
    rim = ring(plan, b.h - lip, radius)
    tub = _tub_rect(holes, 0.015, plan)
    bottom = max(0.0, min(hole[2] for hole in holes) - 0.025) if b.h > STANDS_M else 0.0
    bottom = max([bottom, *(pocket[5] for pocket in beneath)])
    under = b.h - lip
    if b.h <= STANDS_M:
        rings = [ring(tub, 0.0, radius), ring(tub, under, radius)]
    else:
        wide = inset(plan, 0.004)
        foot = tub if b.variant == 0 else wide
        rings = [ring(foot, bottom, radius), ring(wide, under - 0.06 * b.h, radius), ring(wide, under, radius)]
    carved(b, rings, rim, b.h - bead, holes, material)
    if bead:
        inner = ring(inset(plan, 0.009), 0, max(radius - 0.009, 0.004))[:, :2]
        b.add(primitives.prism(rim[:, :2], bead, [inner]), material, (0, 0, b.h - bead / 2))
    solid_body(b, (*plan[:2], bottom, *plan[2:], b.h), holes)
    if b.h > STANDS_M:
        if beneath:
            case = (-0.49 * b.w, -0.49 * b.d, 0, 0.49 * b.w, 0.49 * b.d, bottom)
            b.block(case, [grown(cabinet, GAP) for cabinet in beneath], material)
        else:
            _sink_stand(b, bottom)
    elif b.variant == 2 and _margin(b, holes) > 0.024:
        apron = (b.w, 0.02, b.h - lip)
        b.box(apron, (0, -b.d / 2 + 0.011, apron[2] / 2), material, radius=0.006, solid=False)
    elif b.variant == 1:
        _draining_board(b, holes, b.h - bead, material)
    if b.variant == 3 and b.d / 2 - max(hole[4] for hole in holes) > 0.05:
        ledge = b.d / 2 - max(hole[4] for hole in holes) - 0.03
        b.box(
            (0.6 * b.w, ledge, 0.006),
            (0, b.d / 2 - 0.015 - ledge / 2, b.h - 0.004),
            material,
            radius=0.002,
            solid=False,
        )
    if not basins:
        _default_bowl(b, holes[0], material)
    rim_spaces(b, holes)
    b.looks_like(material)


def sink_basin(b: Builder) -> None:
    """A hollow basin with a drain: soft, steep, sloping to the back, or two bowls side by side."""
    material = suite(b)
    with b.quarter_turned(b.w < 0.8 * b.d):
        floor = b.level(0.012, 0.005, 0.35 * b.h)
        lean = b.by_variant((0.13, 0.05, 0.09, 0.05)) * min(b.w, b.d)
        slopes = (lean, lean, lean, lean * b.by_variant((1.0, 1.0, 2.2, 1.0)))
        wall = min(0.012, 0.06 * min(b.w, b.d))
        soft = b.by_variant((1.0, 1.0, 1.9, 1.0))
        box = (-b.w / 2, -b.d / 2, 0, b.w / 2, b.d / 2, b.h)
        flat = bowl(b, box, material, floor=floor, slopes=slopes, wall=wall, soft=soft)
        if b.variant == DIVIDED and b.w > DOUBLE_M:
            _divided(b, flat, floor, material)
        else:
            _basin_fittings(b, flat, floor, "basin", b.by_variant((0.0, 0.0, -0.2, 0.0)))
        if b.variant in (1, 2):
            _overflow(b, wall + 0.3 * slopes[3], 0.7 * b.h)
    b.looks_like(material)


def bathtub(b: Builder) -> None:
    """A bathtub around its basin: built in with an apron, freestanding, on claw feet, or in a panelled surround."""
    inner = enamel(b)
    painted = b.pick((inner, *PAINTS))
    shell = b.by_variant((inner, painted, painted, inner))
    with b.quarter_turned(b.w < b.d):
        low = (0.32 if b.variant == 2 else 0.2) * b.h
        default = (-0.42 * b.w, -0.36 * b.d, low, 0.42 * b.w, 0.36 * b.d, b.h)
        holes = free_boxes(b, b.pockets or [default], 0.012)
        plan = (-b.w / 2, -b.d / 2, b.w / 2, b.d / 2)
        lip = 0.03
        soft = b.by_variant((0.04, 0.49 * b.d, 0.49 * b.d, 0.03))
        radius = _outer_radius(b, holes, soft)
        rim = ring(plan, b.h - lip, radius)
        bottom = 0.0
        deepest = min(hole[2] for hole in holes)
        if b.variant == 2:
            bottom = float(np.clip(deepest - 0.03, 0.0, 0.16))
        foot = _tub_rect(holes, 0.03, plan)
        sides = _tub_sides(b, plan, foot, bottom, b.h - lip, radius)
        carved(b, sides, rim, b.h, holes, shell, inner)
        solid_body(b, (*plan[:2], bottom, *plan[2:], b.h), holes)
        if b.variant == 0:
            _apron_panels(b, lip, shell)
        elif b.variant == 2 and bottom > 0.03:
            _claw_feet(b, foot, bottom)
        elif b.variant == 3:
            _surround(b, lip)
        if not b.pockets:
            _default_bowl(b, holes[0], inner)
        rim_spaces(b, holes)
    b.looks_like(shell)


def bathtub_basin(b: Builder) -> None:
    """The hollow of a bathtub: a sloping end and overflow, two and grips, straight and ribbed, or with jets."""
    material = enamel(b)
    with b.quarter_turned(b.w < b.d):
        floor = b.level(0.02, 0.005, 0.35 * b.h)
        side = 0.10 * b.d
        left, right = b.by_variant(((0.22, 0.06), (0.18, 0.18), (0.05, 0.05), (0.12, 0.12)))
        slopes = (left * b.w, side, right * b.w, side)
        flat = bowl(
            b,
            (-b.w / 2, -b.d / 2, 0, b.w / 2, b.d / 2, b.h),
            material,
            floor=floor,
            slopes=slopes,
            wall=0.015,
            soft=b.by_variant((1.0, 1.0, 1.0, 1.6)),
        )
        _basin_fittings(b, flat, floor, "basin", 0.0, bath=True)
        _bath_details(b, flat, floor, slopes)
    b.looks_like(material)


def _divided(b: Builder, flat: Rect, floor: float, material: Material) -> None:
    """A low wall that makes two bowls of one, each with its drain."""
    x0, y0, x1, y1 = flat
    x, thick = x0 + 0.58 * (x1 - x0), 0.02
    high = 0.8 * (b.h - floor)
    b.box((thick, (b.d - 0.03 + y1 - y0) / 2, high), (x, 0, floor + high / 2), material, radius=0.009, segments=2)
    for name, left, right in (("left basin", x0, x - thick / 2), ("right basin", x + thick / 2, x1)):
        _basin_fittings(b, (left, y0, right, y1), floor, name, 0.0)


def _basin_fittings(b: Builder, flat: Rect, floor: float, name: str, shift: float, *, bath: bool = False) -> None:
    x0, y0, x1, y1 = flat
    x = x1 - 0.12 * (x1 - x0) if bath else (x0 + x1) / 2
    y = (y0 + y1) / 2 + shift * (y1 - y0)
    drain(b, (x, y, floor), min(0.04, 0.16 * min(x1 - x0, y1 - y0)))
    b.space(name, (x1 - x0, y1 - y0, b.h - floor), ((x0 + x1) / 2, (y0 + y1) / 2, (b.h + floor) / 2))


def _overflow(b: Builder, inset_m: float, z: float) -> None:
    """A ringed hole or a row of slots in the back wall."""
    y = b.d / 2 - inset_m
    radius = min(0.018, 0.12 * b.h)
    if b.variant == 2:
        b.cylinder(radius, 0.012, (0, y, z), materials.CHROME, axis="y", sections=14, solid=False)
        b.cylinder(0.65 * radius, 0.013, (0, y - 0.001, z), materials.SHADOW_GAP, axis="y", sections=12, solid=False)
    else:
        for x in (-0.022, 0.0, 0.022):
            b.box((0.012, 0.012, 1.2 * radius), (x, y, z), materials.SHADOW_GAP, radius=0.004, solid=False)


def _bath_details(b: Builder, flat: Rect, floor: float, slopes: tuple[float, float, float, float]) -> None:
    """An overflow plate, grips along the sides, ribs against slipping, or the jets of a whirlpool."""
    x0, y0, x1, y1 = flat
    if b.variant == 0:
        x = b.w / 2 - 0.015 - 0.4 * slopes[2]
        b.cylinder(min(0.04, 0.2 * b.h), 0.016, (x, 0, 0.6 * b.h), materials.CHROME, axis="x", sections=16, solid=False)
    elif b.variant == 2:
        for x in np.linspace(x0 + 0.15 * (x1 - x0), x0 + 0.7 * (x1 - x0), 6):
            rib = (0.012, 0.6 * (y1 - y0), 0.003)
            b.box(rib, (float(x), (y0 + y1) / 2, floor + 0.0015), materials.FROSTED_GLASS, solid=False)
    else:
        for side in (-1, 1):
            y = side * (b.d / 2 - 0.015 - (0.15 if b.variant == 1 else 0.5) * slopes[1] - 0.01)
            if b.variant == 1:
                grip = min(0.3, 0.3 * b.w)
                out = y - side * 0.04
                path = [
                    (-grip / 2, y, 0.85 * b.h),
                    (-0.42 * grip, out, 0.85 * b.h),
                    (0.42 * grip, out, 0.85 * b.h),
                    (grip / 2, y, 0.85 * b.h),
                ]
                b.add(primitives.tube(np.array(path), 0.011, 8), materials.CHROME)
                continue
            for x in (-0.1, 0.1):
                b.cylinder(
                    min(0.028, 0.15 * b.h),
                    0.02,
                    (x * b.w, y, 0.5 * b.h),
                    materials.CHROME,
                    axis="y",
                    sections=12,
                    solid=False,
                )


def _default_bowl(b: Builder, hole: Box, material: Material) -> None:
    x0, y0, z0, x1, y1, z1 = hole
    lean = 0.1 * min(x1 - x0, y1 - y0)
    floor = z0 + 0.012
    flat = bowl(b, (x0, y0, z0, x1, y1, z1 - 0.004), material, floor=floor, slopes=(lean,) * 4)
    drain(b, ((flat[0] + flat[2]) / 2, (flat[1] + flat[3]) / 2, floor))
    b.space(
        "basin",
        (flat[2] - flat[0], flat[3] - flat[1], b.h - floor),
        ((flat[0] + flat[2]) / 2, (flat[1] + flat[3]) / 2, (b.h + floor) / 2),
    )


def _margin(b: Builder, holes: tuple[Box, ...]) -> float:
    """Least width of the rim around the holes."""
    return min(min(x0 + b.w / 2, y0 + b.d / 2, b.w / 2 - x1, b.d / 2 - y1) for x0, y0, _, x1, y1, _ in holes)


def _outer_radius(b: Builder, holes: tuple[Box, ...], wanted: float) -> float:
    """Corner radius of the outside, at most what still contains the corners of the holes."""
    inner = min(corner(x1 - x0, y1 - y0) for x0, y0, _, x1, y1, _ in holes)
    return float(np.clip(wanted, 0.005, inner + _margin(b, holes)))


def _tub_rect(holes: tuple[Box, ...], grow: float, plan: Rect) -> Rect:
    """The rectangle around all holes and a little more, inside the plan."""
    return (
        max(min(hole[0] for hole in holes) - grow, plan[0]),
        max(min(hole[1] for hole in holes) - grow, plan[1]),
        min(max(hole[3] for hole in holes) + grow, plan[2]),
        min(max(hole[4] for hole in holes) + grow, plan[3]),
    )


def _draining_board(b: Builder, holes: tuple[Box, ...], top: float, material: Material) -> None:
    """Ribs on the widest free part of the rim."""
    left, right = min(hole[0] for hole in holes) + b.w / 2, b.w / 2 - max(hole[3] for hole in holes)
    front, back = min(hole[1] for hole in holes) + b.d / 2, b.d / 2 - max(hole[4] for hole in holes)
    widest = max(left, right, front, back)
    if widest < 0.12:
        return
    if widest in (left, right):
        x = -b.w / 2 + left / 2 if widest == left else b.w / 2 - right / 2
        for y in np.linspace(-0.36, 0.36, 10) * b.d:
            b.box((widest - 0.05, 0.006, 0.004), (x, float(y), top + 0.001), material, solid=False)
    else:
        y0 = -b.d / 2 + front / 2 if widest == front else b.d / 2 - back / 2
        for x in np.linspace(-0.36, 0.36, 10) * b.w:
            b.box((0.006, widest - 0.05, 0.004), (float(x), y0, top + 0.001), material, solid=False)


def _sink_stand(b: Builder, top: float) -> None:
    """What carries a tall sink: a pedestal, a vanity with doors, a frame with a shelf, or a square column."""
    if b.variant == 0:
        shape = ((0.46, 0.0), (0.44, 0.06), (0.32, 0.25), (0.28, 0.55), (0.36, 0.88), (0.5, 1.0))
        rings = [
            np.column_stack(
                [primitives.ellipse(k * b.w, k * b.d, 24, 2.6) + np.array([0, 0.14 * b.d]), np.full(24, z * top)]
            )
            for k, z in shape
        ]
        b.add(primitives.loft(rings), suite(b), solid=True)
    elif b.variant == 1:
        wood = b.pick((*materials.WOODS, *materials.PAINTED_WOODS))
        metal = b.pick(materials.METALS)
        kick, width, deep = min(0.08, 0.2 * top), 0.96 * b.w, 0.9 * b.d
        b.box((width, deep, top - kick), (0, 0.03 * b.d, (top + kick) / 2), wood)
        b.box((0.9 * width, 0.9 * deep, kick), (0, 0.04 * b.d, kick / 2), materials.SHADOW_GAP)
        face = 0.03 * b.d - deep / 2
        for side in (-1, 1):
            z = (top + kick) / 2
            b.box(
                (width / 2 - 0.008, 0.016, top - kick - 0.016),
                (side * width / 4, face - 0.008, z),
                wood,
                radius=0.003,
                solid=False,
            )
            b.handle((side * 0.045, face - 0.016, z), 0.14, metal, axis="z", reach=0.022)
    elif b.variant == 2:
        metal = b.pick((materials.CHROME, materials.BLACK_METAL, materials.BRASS))
        b.legs((0.92 * b.w, 0.9 * b.d, top), metal, thickness=0.03, round_=True)
        shelf = 0.25 * top
        b.box((0.88 * b.w, 0.84 * b.d, 0.018), (0, 0, shelf), b.pick(materials.WOODS), radius=0.004)
        b.cylinder(0.008, 0.9 * b.w, (0, -0.43 * b.d, 0.86 * top), metal, axis="x", sections=8, solid=False)
        b.space("shelf", (0.84 * b.w, 0.8 * b.d, 0.6 * top), (0, 0, shelf + 0.009 + 0.3 * top))
    else:
        rings = [
            ring((-k * b.w, -k * b.d, k * b.w, k * b.d), z * top, 0.03)
            for k, z in ((0.27, 0.0), (0.24, 0.45), (0.34, 1.0))
        ]
        b.add(primitives.loft(rings), suite(b), solid=True)


def _tub_sides(
    b: Builder,
    plan: Rect,
    foot: Rect,
    bottom: float,
    top: float,
    radius: float,
) -> list[F64]:
    """Rings of the outside of a bathtub, straight or swelling from a smaller foot."""
    if b.variant in (0, 3):
        inner = inset(plan, 0.012)
        return [ring(inner, bottom, radius), ring(inner, top, radius)]
    rings = []
    for share, out in ((0.0, 0.0), (0.04, 0.25), (0.14, 0.5), (0.35, 0.74), (0.65, 0.86), (0.92, 0.92), (1.0, 0.97)):
        rect = tuple(f + (p - f) * out for f, p in zip(foot, plan, strict=True))
        rings.append(ring((rect[0], rect[1], rect[2], rect[3]), bottom + share * (top - bottom), radius))
    return rings


def _apron_panels(b: Builder, lip: float, material: Material) -> None:
    """Raised fields on the long sides, and a plinth."""
    for side in (-1, 1):
        y = side * (b.d / 2 - 0.012)
        for x in (-0.235, 0.235):
            b.box(
                (0.44 * b.w, 0.012, 0.62 * (b.h - lip)),
                (x * b.w, y, 0.52 * (b.h - lip)),
                material,
                radius=0.005,
                solid=False,
            )


def _claw_feet(b: Builder, foot: Rect, height: float) -> None:
    metal = b.pick((materials.CHROME, materials.BRASS, materials.BLACK_METAL))
    x0, y0, x1, y1 = foot
    for x in (x0 + 0.14 * (x1 - x0), x1 - 0.14 * (x1 - x0)):
        for y, out in ((y0 + 0.02, -1), (y1 - 0.02, 1)):
            leg = [(x, y - out * 0.03, height + 0.07), (x, y + out * 0.03, 0.7 * height), (x, y + out * 0.015, 0.03)]
            b.add(primitives.tube(np.array(leg), (0.06, 0.045, 0.03), 8), metal)
            b.add(primitives.ellipsoid((0.10, 0.11, 0.07), 10, 6), metal, (x, y + out * 0.02, 0.035), solid=True)


def _surround(b: Builder, lip: float) -> None:
    """Panels of wood or tiles around the tub, under its rim."""
    wood = b.pick(
        (
            materials.WHITE_WOOD,
            materials.OAK,
            materials.WALNUT,
            Material("ceramic", "white", (0.90, 0.92, 0.92), "tile", 0.3, 0.3),
            Material("ceramic", "blue", (0.55, 0.70, 0.78), "tile", 0.3, 0.3),
        )
    )
    tall = b.h - lip - 0.003
    for side in (-1, 1):
        b.box((b.w - 0.004, 0.02, tall), (0, side * (b.d / 2 - 0.014), tall / 2), wood, solid=False)
        b.box((0.02, b.d - 0.048, tall), (side * (b.w / 2 - 0.014), 0, tall / 2), wood, solid=False)


KINDS = {
    "Sink": Kind(sink),
    "SinkBasin": Kind(sink_basin),
    "Bathtub": Kind(bathtub),
    "BathtubBasin": Kind(bathtub_basin),
}
