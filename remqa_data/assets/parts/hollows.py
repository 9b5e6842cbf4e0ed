"""Basins and what they are sunk into: rounded rings, thin bowls, and bodies with a hole from above.

A sink and its basin are separate assets, as are a bathtub and its basin. Both know the basin's box, and `corner` gives
both the same rounded outline; `suite` gives both the same material when they are built with the same seed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.geometry.types import F64, Box, Rect

SEGMENTS = 5
"""Steps of each rounded corner, the same everywhere so that rings can be skinned together."""
GAP = 0.002
"""Free room between a basin and the hole around it, metres."""
COMPOSITE = Material("stone", "black", (0.23, 0.23, 0.25), "granite", 0.4, 0.3)
ENAMELS = (materials.WHITE_CERAMIC, materials.WHITE_CERAMIC, materials.ceramic("beige", (0.93, 0.89, 0.81)))
SUITES = (materials.WHITE_CERAMIC, materials.STEEL, materials.WHITE_CERAMIC, COMPOSITE)


def suite(b: Builder) -> Material:
    """The material of the sink or basin built with this seed."""
    return SUITES[b.spec.seed % len(SUITES)]


def enamel(b: Builder) -> Material:
    """The inside of the bathtub built with this seed, and its basin."""
    return ENAMELS[b.spec.seed % len(ENAMELS)]


def corner(width: float, depth: float) -> float:
    """Radius of the corners of a basin: nearly round if it is square, softly rounded if it is long."""
    short, long = min(width, depth), max(width, depth)
    return 0.46 * short if long < 1.2 * short else 0.24 * short


def ring(rect: Rect, z: float, radius: float) -> F64:
    """Points (n, 3) of a rounded rectangle at a height, counter-clockwise."""
    x0, y0, x1, y1 = rect
    points = primitives.rounded_rect(x1 - x0, y1 - y0, max(radius, 0.002), SEGMENTS)
    return np.column_stack([points + np.array([(x0 + x1) / 2, (y0 + y1) / 2]), np.full(len(points), z)])


def inset(rect: Rect, sides: float | tuple[float, float, float, float]) -> Rect:
    """The rectangle made smaller, by one amount or by (left, front, right, back)."""
    left, front, right, back = (sides,) * 4 if isinstance(sides, float) else sides
    return rect[0] + left, rect[1] + front, rect[2] - right, rect[3] - back


def lid(points: F64) -> list[F64]:
    """Two rings that close a ring flat, facing down: its middle, and the ring itself."""
    middle = points.mean(axis=0)
    return [middle + (points - middle) * 1e-3, points]


def skin(b: Builder, rings: Sequence[F64], material: Material) -> None:
    """Draw a body from rings, closed below and open above."""
    b.add(primitives.loft(list(rings), capped=False), material)
    b.add(primitives.loft(lid(rings[0]), capped=False), material)


def lining(b: Builder, rings: Sequence[F64], material: Material) -> None:
    """Draw the inside of a hollow from rings: a floor that flows into the walls, open above."""
    turned = [points[::-1] for points in (lid(rings[0])[0], *rings)]
    b.add(primitives.loft(turned, capped=False), material)


def bowl(
    b: Builder,
    box: Box,
    material: Material,
    *,
    floor: float,
    slopes: tuple[float, float, float, float],
    wall: float = 0.01,
    soft: float = 1.0,
) -> Rect:
    """Draw a thin open bowl that fills a box, with its collision walls.

    Parameters
    ----------
    floor : float
        Height of the inner floor.
    slopes : (left, front, right, back)
        How far each wall leans inwards from the rim to the floor, metres.
    soft : float
        How much rounder the corners of the hollow are than those of the outside.

    Returns
    -------
    The flat part of the floor.
    """
    x0, y0, z0, x1, y1, z1 = box
    rim = (x0, y0, x1, y1)
    radius = corner(x1 - x0, y1 - y0)
    lean = np.asarray(slopes)
    fillet = min(0.06, 0.4 * (z1 - floor), 0.2 * min(x1 - x0 - lean[0] - lean[2], y1 - y0 - lean[1] - lean[3]))
    inside = []
    for angle in np.radians([0, 25, 50, 75, 90]):
        z = floor + fillet * (1 - np.cos(angle))
        inside.append((z, fillet * (1 - np.sin(angle))))
    inside += [(z, 0.0) for z in np.linspace(floor + fillet, z1, 4)[1:]]
    rings = []
    for z, extra in inside:
        low = (z1 - z) / (z1 - floor)
        sides = _four(wall + extra + lean * low)
        rings.append(ring(inset(rim, sides), z, soft * (radius - wall) - 0.3 * extra - 0.3 * float(lean.min()) * low))
    lining(b, rings, material)
    outside = [ring(inset(rim, _four(0.9 * lean)), z0, 0.7 * radius), ring(rim, z1, radius)]
    b.add(primitives.loft([outside[1], rings[-1]], capped=False), material)
    skin(b, outside, material)
    flat = inset(rim, _four(wall + lean + 0.5 * fillet))
    hole = (*inset(rim, _four(wall + 0.5 * lean)), floor, z1 + 1.0)
    for part in solid_around(box, [(hole[0], hole[1], floor, hole[2], hole[3], hole[5])]):
        _solid(b, part)
    return flat


def carved(
    b: Builder,
    outside: Sequence[F64],
    rim: F64,
    top: float,
    holes: Sequence[Box],
    material: Material,
    inner: Material | None = None,
) -> None:
    """Draw a body with holes from above that leaves boxes free for basins.

    Parameters
    ----------
    outside : sequence of rings
        The skin from the bottom up to just under the rim.
    rim : (n, 3) ring
        Outline of the plate on top; its z is the underside.
    top : float
        Height of the plate's upper face.
    holes : sequence of Box
        The boxes to leave free.
    inner : Material, optional
        Of the plate and the walls of the holes; the same as the skin without it.
    """
    skin(b, outside, material)
    inner = inner or material
    outlines = []
    low = float(rim[0, 2])
    for x0, y0, z0, x1, y1, _ in holes:
        rect, radius = (x0 - GAP, y0 - GAP, x1 + GAP, y1 + GAP), corner(x1 - x0, y1 - y0) + GAP
        outlines.append(ring(rect, low, radius)[:, :2])
        bottom = max(z0 - GAP, float(outside[0][0, 2]))
        rings = [ring(rect, bottom, radius), ring(rect, low, radius)]
        b.add(primitives.loft([points[::-1] for points in rings], capped=False), inner)
        b.add(primitives.loft([points[::-1] for points in lid(rings[0])], capped=False), inner)
    b.add(primitives.prism(rim[:, :2], top - low, outlines), inner, (0, 0, (top + low) / 2))


def solid_body(b: Builder, box: Box, holes: Sequence[Box]) -> None:
    """Collision boxes of a box with holes from above."""
    for part in solid_around(box, [(x0, y0, z0, x1, y1, box[5] + 1.0) for x0, y0, z0, x1, y1, _ in holes]):
        _solid(b, part)


def rim_spaces(b: Builder, holes: Sequence[Box]) -> None:
    """Declare the flat parts of the top around the holes as room to put things."""
    plan = solid_around((-b.w / 2, -b.d / 2, 0, b.w / 2, b.d / 2, 1), [(*h[:2], -1, *h[3:5], 2) for h in holes])
    for i, (x0, y0, _, x1, y1, _) in enumerate(plan):
        if min(x1 - x0, y1 - y0) > 0.05:
            b.space(f"rim {i}", (x1 - x0, y1 - y0, 0.4), ((x0 + x1) / 2, (y0 + y1) / 2, b.h + 0.2))


def free_boxes(b: Builder, basins: Sequence[Box], margin: float = 0.006) -> tuple[Box, ...]:
    """The places of basins, each kept a margin away from the sides of the asset's box; without those too small."""
    kept = []
    for x0, y0, z0, x1, y1, z1 in basins:
        w, d = b.w / 2 - margin - GAP, b.d / 2 - margin - GAP
        kept.append((max(x0, -w), max(y0, -d), max(z0, 0.0), min(x1, w), min(y1, d), min(z1, b.h)))
    return tuple(box for box in kept if box[3] - box[0] > 0.05 and box[4] - box[1] > 0.05 and box[2] < b.h - 0.02)


def drain(b: Builder, at: tuple[float, float, float], radius: float = 0.035) -> None:
    """Draw a drain with a dark hole on a floor."""
    x, y, z = at
    b.cylinder(radius, 0.003, (x, y, z + 0.0012), materials.CHROME, sections=16, solid=False)
    b.cylinder(0.62 * radius, 0.001, (x, y, z + 0.0032), materials.SHADOW_GAP, sections=12, solid=False)
    for size in ((1.2 * radius, 0.12 * radius, 0.001), (0.12 * radius, 1.2 * radius, 0.001)):
        b.box(size, (x, y, z + 0.0042), materials.CHROME, solid=False)


def _four(values: F64) -> tuple[float, float, float, float]:
    left, front, right, back = (float(value) for value in values)
    return left, front, right, back


def _solid(b: Builder, box: Box) -> None:
    x0, y0, z0, x1, y1, z1 = box
    b.solid((x1 - x0, y1 - y0, z1 - z0), ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2))
