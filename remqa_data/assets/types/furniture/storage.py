"""Drawers, cabinets, counters and shelves: what is built in, and what one opens to look inside."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.assets.parts.carcass import PANEL, carcass, feet, slab
from remqa_data.assets.parts.fronts import (
    Pull,
    Style,
    contrast,
    door_pull,
    drawer_pull,
    finish,
    front,
    front_thickness,
    handle_reach,
    hardware,
)
from remqa_data.geometry.types import Box

DOOR_OPEN_DEG = 105.0
HOOD = 0.002
"""Thickness of the hood over a drawer, metres."""
LET_IN = 0.2
"""A worktop has a hole for what reaches this far into it from below, in parts of its thickness."""


def drawer(b: Builder) -> None:
    """A drawer without a carcass: slab with a bar, raised panel with knobs, shaker with a cup, slab with a lip.

    A thin hood stays behind when it opens: nobody looks in from above or from the side where the furniture around has gaps.
    """
    wood, metal = finish(b), hardware(b)
    style: Style = b.by_variant(("slab", "raised", "shaker", "slab"))
    pull: Pull = b.by_variant(("bar", "knob", "cup", "lip"))
    reach, thick = handle_reach(b.d), front_thickness(b.d)
    rect = (-b.w / 2, 0.0, b.w / 2, b.h)
    face, back = -b.d / 2 + reach, b.d / 2
    with b.link("tray", "prismatic", axis="-y", upper=0.82 * b.d):
        front(b, rect, face, thick, style, wood)
        drawer_pull(b, rect, face, reach, pull, metal)
        floor = b.level(0.014, 0.005, 0.6 * b.h)
        low, high = min(0.008, 0.5 * floor), max(0.78 * b.h, floor + 0.3 * (b.h - floor))
        wall = min(0.012, 0.05 * b.w)
        x, y = b.w / 2 - min(0.012, 0.04 * b.w), face + thick
        for side in (-1, 1):
            outer, inner = side * x, side * (x - wall)
            slab(b, (min(outer, inner), y, low, max(outer, inner), back, high), materials.PINE)
        slab(b, (wall - x, back - wall, low, x - wall, back, b.h - 2 * HOOD), materials.PINE)
        slab(b, (wall - x, y, max(low, floor - 0.012), x - wall, back - wall, floor), materials.PINE)
        behind = b.w / 2 - HOOD  # a front with a lip for its pull is not as high as the drawer
        slab(b, (-behind, y, low, behind, y + HOOD, b.h - 2 * HOOD), materials.PINE)
        y += HOOD
        width, depth = 2 * (x - wall), back - wall - y
        room = b.h - 2 * HOOD - floor
        b.space("inside", (width, depth, room), (0.0, y + depth / 2, floor + room / 2), enclosed=True)
    hooded, middle = back - face - thick / 2, (back + face + thick / 2) / 2
    b.box((b.w - 0.002, hooded, HOOD), (0.0, middle, b.h - HOOD / 2), materials.PINE, solid=False)
    for side in (-1, 1):
        at = (side * (b.w / 2 - HOOD / 2 - 0.001), middle, (b.h + 0.6 * high) / 2)
        b.box((HOOD, hooded, b.h - 0.6 * high), at, materials.PINE, solid=False)
    b.looks_like(wood)


def cabinet(b: Builder) -> None:
    """A cupboard with one door (even variants hinge it left, odd ones right) or two: slab, shaker, raised, grooved.

    A sink that hangs into it from above is a pocket.
    """
    wood, metal = finish(b), hardware(b)
    reach, thick = handle_reach(b.d), front_thickness(b.d)
    face, back = -b.d / 2 + reach, b.d / 2
    y = face + thick
    depth = back - y
    wall = min(PANEL, 0.3 * depth, 0.08 * b.h, 0.08 * b.w)
    b.shell((b.w, depth, b.h), (0, y + depth / 2, b.h / 2), wall, wood, pockets=b.pockets)
    liner = min(0.002, 0.1 * depth)
    inside = (b.w - 2 * wall, depth - wall - liner)
    top = max(0.3 * b.h, min([b.h, *(pocket[2] for pocket in b.pockets)]))
    lining = min(b.h - wall, top) - wall
    b.box(
        (inside[0], liner, lining), (0, back - wall - liner / 2, wall + lining / 2), materials.WHITE_WOOD, solid=False
    )
    _boards(b, inside, y + inside[1] / 2, wall, top)
    styles: tuple[Style, ...] = ("slab", "shaker", "raised", "grooved")
    style = styles[b.variant // 2]
    pull: Pull = "bar" if style in ("slab", "raised") else "knob"
    height = 0.5 if b.h > 1.0 else 0.72
    left_hinged = b.variant % 2 == 0
    edges = (-b.w / 2, 0.0, b.w / 2) if b.w >= 0.6 else (-b.w / 2, b.w / 2)
    for i, (x0, x1) in enumerate(pairwise(edges)):
        left = i == 0 if len(edges) == 3 else left_hinged
        origin = (x0 if left else x1, face, b.h / 2)
        name, angle = f"door{i}", float(np.radians(DOOR_OPEN_DEG))
        with b.link(name, "revolute", axis="-z" if left else "z", upper=angle, origin=origin):
            rect = (x0, 0.0, x1, b.h)
            front(b, rect, face, thick, style, wood)
            door_pull(b, rect, face, reach, pull, metal, 1 if left else -1, height)
    b.looks_like(wood)


def _boards(b: Builder, inside: tuple[float, float], y: float, wall: float, top: float) -> None:
    """Boards of a cabinet at the recorded levels (else one in the middle of a tall one), and the room above each.

    Above `top` there is no room: a sink hangs there.
    """
    width, depth = inside
    wanted = b.spec.levels or ((top / 2,) if top > 0.5 else ())
    tops = [wall]
    for level in sorted(wanted):
        if level - tops[-1] > 0.08 and top - level > 0.08:
            tops.append(level)
            board = min(0.014, wall)
            b.box((width, 0.96 * depth, board), (0, y + 0.02 * depth, level - board / 2), materials.WHITE_WOOD)
        elif len(tops) == 1 and wall < level < wall + 0.08:  # a raised floor
            slab(b, (-width / 2, y - depth / 2, wall, width / 2, y + depth / 2, level), materials.WHITE_WOOD)
            tops[0] = level
    for i, (low, high) in enumerate(zip(tops, [*tops[1:], top], strict=True)):
        room = max(high - low - wall, 0.02)
        b.space(f"shelf{i}", (0.98 * width, 0.94 * depth, room), (0, y + 0.02 * depth, low + room / 2), enclosed=True)


def counter_top(b: Builder) -> None:
    """A worktop with holes for sinks: stone, edged laminate, butcher block or tiles; cabinets below a tall one."""
    top, edge = b.by_variant(
        (
            (b.pick(materials.STONES), None),
            (b.pick(LAMINATES), materials.STEEL),
            (b.pick((materials.OAK, materials.PINE, materials.WALNUT)), None),
            (b.pick(TILES), materials.OAK),
        )
    )
    thickness = b.h if b.h < 0.2 else 0.035
    under = b.h - thickness
    sinks = [pocket for pocket in b.pockets if pocket[5] > under + LET_IN * thickness]
    _worktop(b, sinks, under, top, edge)
    count = 0
    for x0, y0, x1, y1 in b.footprint:
        for part in solid_around((x0, y0, under, x1, y1, b.h), [_tall(sink) for sink in sinks]):
            size = (part[3] - part[0], part[4] - part[1], thickness)
            centre = ((part[0] + part[3]) / 2, (part[1] + part[4]) / 2)
            b.solid(size, (*centre, under + thickness / 2))
            if min(size[:2]) > 0.08:
                b.space(f"top{count}", (size[0], size[1], 0.5), (*centre, b.h + 0.25))
                count += 1
        if under > 0:
            _base_cabinets(b, (x0, y0, 0.0, x1, y1, under))
    b.looks_like(top)


def _worktop(b: Builder, sinks: list[Box], under: float, top: Material, edge: Material | None) -> None:
    """One plate over the whole footprint, without seams; an edge band shows as a rim around an inlaid surface."""
    from shapely import box as rectangle
    from shapely import unary_union

    holes = unary_union([rectangle(p[0], p[1], p[3], p[4]) for p in sinks])
    plan = unary_union([rectangle(*rect) for rect in b.footprint]).difference(holes)
    rim = 0.0008 if edge else 0.0
    layers = [(plan, b.h - under - rim, under, edge or top)]
    if edge:
        layers.append((plan.buffer(-0.014, join_style="mitre"), rim, b.h - rim, top))
    for shape, height, z, material in layers:
        for polygon in getattr(shape, "geoms", (shape,)):
            if not polygon.is_empty:
                rings = [np.asarray(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
                b.add(primitives.prism(rings[0], height, rings[1:]), material, (0, 0, z + height / 2))


def _tall(pocket: Box) -> Box:
    return pocket[0], pocket[1], -10.0, pocket[3], pocket[4], 10.0


def _base_cabinets(b: Builder, box: Box) -> None:
    """Closed cabinets under a worktop: toe kick, body around the pockets, doors where nothing else opens."""
    x0, y0, z0, x1, y1, z1 = box
    wood, kick = finish(b), 0.09
    inset = min(0.02, 0.05 * (y1 - y0))
    slab(b, (x0 + 0.01, y0 + 0.07, z0, x1 - 0.01, y1 - 0.01, kick), materials.BLACK_PLASTIC)
    front_y = y0 + inset
    body = (x0 + 0.005, front_y + 0.018, kick, x1 - 0.005, y1, z1)
    b.block(body, b.pockets, wood)
    count = max(1, round((x1 - x0) / 0.5))
    width = (x1 - x0 - 0.01) / count
    for i in range(count):
        left = x0 + 0.005 + i * width
        if any(p[0] < left + width - 0.02 and p[3] > left + 0.02 and p[1] < front_y + 0.1 for p in b.pockets):
            continue
        rect = (left, kick, left + width, z1)
        front(b, rect, front_y, 0.018, "shaker", wood)
        door_pull(b, rect, front_y, min(0.02, inset), "bar", hardware(b), 1 if i % 2 == 0 else -1, 0.75)


def shelf(b: Builder) -> None:
    """One compartment of shelving, open to the front: cubby, board between brackets, wire, board with a back."""
    wood = finish(b)
    if b.h < 0.06:
        b.box((b.w, b.d, b.h), (0, 0, b.h / 2), wood, radius=min(0.003, 0.3 * b.h))
        b.space("top", (b.w, b.d, 0.3), (0, 0, b.h + 0.15))
        return
    top = b.level(min(0.018, 0.2 * b.h), 0.004, 0.85 * b.h)
    board = min(0.018, top)
    side = min(0.012, 0.06 * b.w)
    back = min(0.008, 0.06 * b.d)
    walls = 2 * side
    if b.variant == 2:
        _wire_shelf(b, top, board)
    else:
        b.box((b.w - walls if b.variant == 0 else b.w, b.d, board), (0, 0, top - board / 2), wood)
        if b.variant == 0:
            for s in (-1, 1):
                b.box((side, b.d, b.h), (s * (b.w - side) / 2, 0, b.h / 2), wood)
            _back(b, back, walls, top, wood)
        elif b.variant == 1:
            _bracket_ends(b, top, board, side, wood)
        else:
            _back(b, back, 0.0, top, wood)
            if top - board > 0.01:
                slab(b, (-b.w / 2, b.d / 2 - back, 0, b.w / 2, b.d / 2, top - board), wood)
            lip = min(0.012, 0.1 * b.h)
            b.box((b.w, 0.008, lip), (0, -b.d / 2 + 0.004, top + lip / 2), wood, solid=False)
    room = b.h - top
    b.space("shelf", (b.w - walls, b.d - back, room), (0, -back / 2, top + room / 2))


def _back(b: Builder, thickness: float, walls: float, top: float, material: Material) -> None:
    """The back of a compartment, above its board."""
    b.box((b.w - walls, thickness, b.h - top), (0, (b.d - thickness) / 2, (b.h + top) / 2), material)


def _bracket_ends(b: Builder, top: float, board: float, side: float, wood: Material) -> None:
    """Ends that sweep down from a high back to a low front, and a rail along the back."""
    low, high = top - board, b.h
    nose = top + 0.25 * (high - top)
    steps = np.linspace(0, 1, 8)
    sweep = [(-b.d / 2 + b.d * f, nose + (high - nose) * f**2) for f in steps]
    outline = [(b.d / 2, 0.0), (-b.d / 2, 0.5 * low), *sweep]
    curve = primitives.prism(outline, side)
    # The prism's x, y, z become the object's y, z, x.
    turned = primitives.Mesh(curve.vertices[:, [2, 0, 1]], curve.normals[:, [2, 0, 1]], curve.faces)
    for s in (-1, 1):
        b.add(turned, wood, (s * (b.w + side) / 2 - s * side, 0, 0), grain="y")
        b.solid((side, b.d, nose), (s * (b.w - side) / 2, 0, nose / 2))
    rail = min(0.05, 0.3 * (high - top))
    b.box((b.w - 2 * side, 0.01, rail), (0, b.d / 2 - 0.005, high - 0.2 * (high - top) - rail / 2), wood)


def _wire_shelf(b: Builder, top: float, board: float) -> None:
    """Four posts, a grid of rods to stand things on, and rails along the back."""
    metal = hardware(b)
    r = min(0.005, 0.1 * b.w, 0.1 * b.d, 0.5 * board)
    x, y = b.w / 2 - r, b.d / 2 - r
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.cylinder(r, b.h, (sx * x, sy * y, b.h / 2), metal, sections=8)
        b.cylinder(0.7 * r, b.d - 2 * r, (sx * x, 0, b.h - r), metal, axis="y", sections=6, solid=False)
        b.cylinder(r, b.d - 2 * r, (sx * x, 0, top - r), metal, axis="y", sections=6, solid=False)
    along = max(4, min(12, round(b.d / 0.03)))
    for i in range(along):
        b.cylinder(
            0.6 * r,
            b.w - 2 * r,
            (0, -y + 2 * y * i / (along - 1), top - 0.6 * r),
            metal,
            axis="x",
            sections=6,
            solid=False,
        )
    for z in (0.35, 0.95):
        b.cylinder(0.7 * r, b.w - 2 * r, (0, y, top + z * (b.h - top - r)), metal, axis="x", sections=6, solid=False)
    b.solid((b.w, b.d, board), (0, 0, top - board / 2))


def shelving_unit(b: Builder) -> None:
    """A bookcase around its compartments: classic with a plinth, industrial posts, open cubes, or with a cornice."""
    wood, metal = finish(b), hardware(b)
    lowest = min((p[2] for p in b.pockets), default=0.08 if b.variant in (0, 3) else 0.02)
    base = min(max(lowest - PANEL - 0.002, 0.0), 0.35)
    crown = 0.03 if b.variant == 3 else 0.0
    inset = 0.012 if b.variant == 3 else 0.0
    case = (-b.w / 2 + inset, -b.d / 2 + inset, base, b.w / 2 - inset, b.d / 2, b.h - crown)
    pockets = list(b.pockets) or _compartments(b, case)
    if b.variant == 1:
        _industrial(b, pockets, wood, metal)
    else:
        back = (wood, None, None, contrast(wood))[b.variant]
        free = carcass(b, case, pockets, wood, hollow=True, back=back)
        feet(
            b,
            (b.w - 2 * inset, b.d - 2 * inset, base),
            wood,
            metal,
            0 if b.variant == 0 else 2 if b.variant == 3 else 1,
        )
        if crown:
            b.box((b.w, b.d, crown), (0, 0, b.h - crown / 2), wood, radius=0.01, segments=2)
        if base > 0.1 and b.variant == 0:
            slab(b, (case[0], case[1], 0, case[0] + PANEL, case[4], base), wood)
            slab(b, (case[3] - PANEL, case[1], 0, case[3], case[4], base), wood)
        for i, (x0, z0, x1, z1) in enumerate(free):
            b.space(f"free{i}", (x1 - x0, b.d - 0.02, z1 - z0), ((x0 + x1) / 2, 0, (z0 + z1) / 2))
    if not b.pockets:
        for i, (x0, y0, z0, x1, y1, z1) in enumerate(pockets):
            b.space(f"shelf{i}", (x1 - x0, y1 - y0 - 0.02, z1 - z0), ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2))
    b.space("top", (b.w, b.d, 0.4), (0, 0, b.h + 0.2))


def _compartments(b: Builder, case: Box) -> list[Box]:
    """Compartments of a unit that was recorded without any: above each recorded level, or evenly spaced."""
    x0, y0, z0, x1, y1, z1 = case
    rows = max(2, round((z1 - z0) / 0.36))
    levels = [level for level in sorted(b.spec.levels) if z0 < level < z1 - 0.1]
    floors = levels or [z0 + PANEL + i * (z1 - z0 - PANEL) / rows for i in range(rows)]
    if floors[0] > z0 + 0.15:
        floors.insert(0, z0 + PANEL)
    columns = max(1, round((x1 - x0) / (0.42 if b.variant == 2 else 1.0)))
    width = (x1 - x0 - PANEL) / columns
    result = []
    for low, high in zip(floors, [*floors[1:], z1], strict=True):
        for i in range(columns):
            left = x0 + PANEL + i * width
            result.append((left, y0, low, left + width - PANEL, y1 - 0.008, high - PANEL))
    return result


def _industrial(b: Builder, pockets: list[Box], wood: Material, metal: Material) -> None:
    """Metal corner posts, a board under each compartment, and crossed braces on the ends."""
    post = min(0.025, 0.1 * b.d)
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.box((post, post, b.h), (sx * (b.w - post) / 2, sy * (b.d - post) / 2, b.h / 2), metal)
    thickness = 0.02
    tops: list[float] = []
    for z in [*sorted(p[2] - 0.002 for p in pockets), b.h]:
        if z >= 0.012 and all(abs(z - other) > 0.06 for other in tops):
            tops.append(z)
            size = (b.w - 0.004, b.d - 0.004, min(thickness, z))
            board = (-size[0] / 2, -size[1] / 2, z - size[2], size[0] / 2, size[1] / 2, z)
            for part in solid_around(board, pockets):
                slab(b, part, wood)
    low, high = tops[0], tops[-1] - thickness
    length = float(np.hypot(b.d - post, high - low))
    slope = float(np.degrees(np.arctan2(high - low, b.d - post)))
    for sx in (-1, 1):
        for sign in (-1, 1):
            turn = primitives.turn("x", sign * slope)
            at = (sx * (b.w / 2 - 0.004 - 0.004 * (sign + 1)), 0, (low + high) / 2)
            b.box((0.004, length, 0.012), at, metal, rotation=turn, solid=False)


LAMINATES = (
    Material("laminate", "white", (0.93, 0.93, 0.91), gloss=0.3),
    Material("laminate", "gray", (0.60, 0.61, 0.62), gloss=0.3),
    Material("laminate", "black", (0.17, 0.17, 0.18), gloss=0.35),
    Material("laminate", "beige", (0.83, 0.77, 0.67), gloss=0.3),
)
TILES = (
    Material("tiled", "white", (0.95, 0.95, 0.93), "tile", 0.45, 0.4),
    Material("tiled", "blue", (0.52, 0.66, 0.78), "tile", 0.45, 0.4),
    Material("tiled", "beige", (0.87, 0.80, 0.68), "tile", 0.45, 0.4),
)

KINDS = {
    "Drawer": Kind(drawer),
    "Cabinet": Kind(cabinet, 8),
    "CounterTop": Kind(counter_top),
    "Shelf": Kind(shelf),
    "ShelvingUnit": Kind(shelving_unit),
}
