"""Desks, chests of drawers and television stands: furniture built around drawers, shelves and cabinets.

Those are assets of their own; their boxes come in as pockets.
"""

from __future__ import annotations

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.parts.carcass import GAP, PANEL, carcass, clusters, feet, hull, slab
from remqa_data.assets.parts.fronts import (
    THICKNESS,
    Pull,
    Style,
    contrast,
    door_pull,
    drawer_fronts,
    finish,
    front,
    hardware,
)
from remqa_data.assets.parts.table_parts import (
    GLASS_TOPS,
    RECESS,
    apron,
    drawer_case,
    flat_top,
    leaning_leg,
    raised_back,
    table_top,
    top_thickness,
    work_height,
)
from remqa_data.geometry.types import Rect


def desk(b: Builder) -> None:
    """A desk: panel ends, tapered legs, metal frame, or trestles; pedestals and a hutch around its pockets."""
    wood, metal = finish(b), hardware(b)
    if len(b.footprint) > 1:
        _corner_desk(b, wood)
        return
    if flat_top(b, wood):
        return
    surface = work_height(b)
    thick = top_thickness(b, surface, min(0.028, 0.05 * surface))
    under = surface - thick
    top = (wood, wood, contrast(wood), contrast(wood))[b.variant]
    table_top(b, surface, thick, top, "rect", radius=0.004)
    y = -b.d / 2 + RECESS
    ends = {-1: True, 1: True}
    below = [p for p in b.pockets if p[2] < under - 0.02]
    for group in clusters(below, 0.25):
        box = hull(group)
        low = box[2] - PANEL - GAP
        foot = low if low > 0.45 * under else 0.0
        x0, x1 = max(box[0] - PANEL, -b.w / 2 + 0.004), min(box[3] + PANEL, b.w / 2 - 0.004)
        carcass(b, (x0, y, foot, x1, b.d / 2 - 0.004, under), group, wood, hollow=True, back=wood)
        if foot == 0.0:
            ends[-1] &= x0 > -b.w / 2 + 0.15
            ends[1] &= x1 < b.w / 2 - 0.15
    plain = not below
    if plain and b.variant == 0:
        _desk_drawers(b, under, wood)
        ends[1] = False
    for side, stands in ends.items():
        if stands:
            _desk_end(b, side, under, wood, metal)
    if plain and b.variant == 1:
        apron(b, (b.w - 0.09, b.d - 0.11), under, 0.09, wood)
    elif b.variant == 0:
        span = (b.w - 0.12, 0.018, min(0.30, 0.4 * under))
        if plain:
            b.box(span, (0, b.d / 2 - 0.05, under - span[2] / 2), wood)
    elif plain and b.variant > 1:
        b.box((b.w - 0.12, 0.025, 0.025), (0, 0.3 * b.d, under - 0.0125), metal if b.variant == 2 else wood)
    raised_back(b, surface, wood)


def _corner_desk(b: Builder, wood: Material) -> None:
    """A desk round a corner: a top over each rectangle of its plan, on panels at the ends of each."""
    thick = top_thickness(b, b.h, 0.03)
    under = b.h - thick
    for i, (x0, y0, x1, y1) in enumerate(b.footprint):
        slab(b, (x0, y0, under, x1, y1, b.h), wood)
        middle = ((x0 + x1) / 2, (y0 + y1) / 2)
        b.space(f"top{i}", (x1 - x0, y1 - y0, 0.5), (*middle, b.h + 0.25))
        if x1 - x0 >= y1 - y0:
            for x in (x0 + 0.03, x1 - 0.055):
                slab(b, (x, y0 + 0.03, 0, x + 0.025, y1 - 0.03, under), wood)
        else:
            for y in (y0 + 0.03, y1 - 0.055):
                slab(b, (x0 + 0.03, y, 0, x1 - 0.03, y + 0.025, under), wood)


def _desk_end(b: Builder, side: int, under: float, wood: Material, metal: Material) -> None:
    """What holds up one end of a desk."""
    x, depth = side * (b.w / 2 - 0.03), b.d - 0.05
    if b.variant == 0:
        b.box((0.025, depth, under), (x, 0, under / 2), wood)
        return
    for sy in (-1, 1):
        y = sy * (depth / 2 - 0.025)
        if b.variant == 1:
            b.cylinder(0.015, under, (x - side * 0.01, y, under / 2), wood, top_radius=0.026, sections=12)
        elif b.variant == 2:
            b.box((0.03, 0.03, under), (x, y, under / 2), metal)
        else:  # splayed legs of a trestle, shown in profile
            leaning_leg(b, (x, y), (x, 0.35 * y), under, (0.018, 0.018), wood)
    if b.variant == 2:
        for z in (0.015, under - 0.015):
            b.box((0.03, depth - 0.08, 0.03), (x, 0, z), metal)
    elif b.variant == 3:
        b.box((0.03, 0.66 * depth, 0.03), (x, 0, 0.3 * under), wood)
        b.box((0.05, 0.5 * depth, 0.03), (x, 0, under - 0.015), wood)


def _desk_drawers(b: Builder, under: float, wood: Material) -> None:
    """A pedestal of three drawers that do not open, at the right end."""
    width = min(0.42, 0.3 * b.w)
    x1, y = b.w / 2 - 0.006, -b.d / 2 + RECESS + THICKNESS
    slab(b, (x1 - width, y, 0, x1, b.d / 2 - 0.02, under), wood)
    drawer_fronts(b, (x1 - width, 0.05, x1, under), y - THICKNESS, 3, 1, "slab", "bar", wood)


def dresser(b: Builder) -> None:
    """A chest of drawers: on a plinth, on tapered legs, with bun feet and posts, or two-tone on a metal sled."""
    wood = finish(b)
    surface = work_height(b)
    thick = top_thickness(b, surface, 0.035)
    under = surface - thick
    top = (wood, wood, wood, contrast(wood))[b.variant]
    table_top(b, surface, thick, top, "rect", radius=0.01 if b.variant == 2 else 0.003)
    if b.pockets:
        drawer_case(b, under, wood)
    else:
        low = b.by_variant((0.06, 0.16, 0.09, 0.12))
        low = min(low, 0.2 * b.h)
        style: Style = b.by_variant(("slab", "slab", "raised", "shaker"))
        pull: Pull = b.by_variant(("lip", "knob", "bar", "cup"))
        _closed_case(b, low, under, wood, style, pull)
    if b.variant == 2:  # turned posts at the front corners
        r = min(0.018, 0.4 * RECESS + 0.008)
        for side in (-1, 1):
            b.cylinder(
                r, under - 0.1, (side * (b.w / 2 - r - 0.002), -b.d / 2 + r, under / 2 + 0.05), wood, sections=10
            )
    raised_back(b, surface, wood)


def _closed_case(b: Builder, low: float, under: float, wood: Material, style: Style, pull: Pull) -> None:
    """A case with drawer fronts that do not open."""
    x, y = b.w / 2 - 0.008, -b.d / 2 + RECESS + THICKNESS
    slab(b, (-x, y, low, x, b.d / 2 - 0.002, under), wood)
    feet(b, (2 * x, b.d - RECESS, low), wood, hardware(b), b.variant)
    columns = 1 if b.w < 0.85 else 2 if b.w < 1.8 else 3
    rows = max(2, min((4, 4, 2)[columns - 1], round((under - low) / 0.22)))
    rect = (-x + 0.012, low + 0.012, x - 0.012, under - 0.006)
    drawer_fronts(b, rect, y - THICKNESS, rows, columns, style, pull, contrast(wood) if b.variant == 1 else wood)


def tv_stand(b: Builder) -> None:
    """A television stand: console with doors, glass tiers, mid-century sideboard with slats, or open cubbies."""
    wood, metal = finish(b), hardware(b)
    surface = work_height(b)
    thick = top_thickness(b, surface, min(0.03, 0.08 * b.h))
    under = surface - thick
    if b.variant == 1 and not b.pockets:
        _glass_tiers(b, surface, metal)
        raised_back(b, surface, wood)
        return
    top = (wood, contrast(wood), wood, contrast(wood))[b.variant]
    table_top(b, surface, thick, top, "rect", radius=0.006 if b.variant == 2 else 0.002)
    if b.pockets:
        drawer_case(b, under, wood, hollow=True)
    else:
        low = (min(0.06, 0.12 * b.h), 0.0, min(0.14, 0.25 * b.h), min(0.03, 0.1 * b.h))[b.variant]
        feet(
            b,
            (b.w - 0.03, b.d - 0.02, low),
            wood if b.variant == 2 else materials.EBONY,
            metal,
            b.by_variant((0, 0, 1, 0)),
        )
        y, rear = -b.d / 2 + RECESS + THICKNESS, b.d / 2 - 0.004
        x = b.w / 2 - 0.006
        openings = _openings(b, low, under)
        case = (-x, y, low, x, rear, under)
        carcass(b, case, [(r[0], y, r[1], r[2], rear - 0.01, r[3]) for r in openings], wood, hollow=False, back=wood)
        for i, (x0, z0, x1, z1) in enumerate(openings):
            size = (x1 - x0, rear - y - 0.01, z1 - z0)
            b.space(f"niche{i}", size, ((x0 + x1) / 2, (y + rear) / 2, (z0 + z1) / 2))
        if b.variant != 3:
            style: Style = "grooved" if b.variant == 2 else "shaker"
            for side in (-1, 1):
                inner, outer = openings[0][2] + PANEL / 2, x
                rect = (min(side * inner, side * outer), low, max(side * inner, side * outer), under)
                front(b, rect, y - THICKNESS, THICKNESS, style, contrast(wood) if b.variant == 2 else wood)
                door_pull(b, rect, y - THICKNESS, 0.02, "bar" if b.variant == 0 else "knob", metal, -side)
    raised_back(b, surface, wood)


def _openings(b: Builder, low: float, under: float) -> list[Rect]:
    """Niches in a stand without pockets: one in the middle between doors, or a grid of cubbies."""
    x = b.w / 2 - 0.006 - PANEL
    z0, z1 = low + PANEL, under - PANEL
    if b.variant != 3:
        inner = 0.20 * b.w
        middle = (z0 + z1) / 2
        return [(-inner, z0, inner, middle - PANEL / 2), (-inner, middle + PANEL / 2, inner, z1)]
    columns = max(2, round(b.w / 0.45))
    rows = 2 if z1 - z0 > 0.45 else 1
    width, height = (2 * x + PANEL) / columns, (z1 - z0 + PANEL) / rows
    return [
        (-x + i * width, z0 + j * height, -x + (i + 1) * width - PANEL, z0 + (j + 1) * height - PANEL)
        for i in range(columns)
        for j in range(rows)
    ]


def _glass_tiers(b: Builder, surface: float, metal: Material) -> None:
    """Three tiers of glass between four metal tubes, a panel behind."""
    glass, thick = b.pick(GLASS_TOPS), 0.012
    table_top(b, surface, thick, glass, "soft")
    r = 0.02
    for sx in (-1, 1):
        for sy in (-1, 1):
            at = (sx * (b.w / 2 - 0.09), sy * (b.d / 2 - 0.07), (surface - thick) / 2)
            b.cylinder(r, surface - thick, at, metal)
    levels = (0.06, 0.48 * surface)
    for i, z in enumerate(levels):
        size = (b.w - 0.22, b.d - 0.10, thick)
        b.box(size, (0, 0, z - thick / 2), glass)
        room = (levels[1] if i == 0 else surface) - thick - z
        b.space(f"shelf{i}", (size[0], size[1], room), (0, 0, z + room / 2))
    b.box((0.3 * b.w, 0.012, surface - thick - 0.06), (0, b.d / 2 - 0.03, (surface - thick + 0.06) / 2), metal)


KINDS = {
    "Desk": Kind(desk),
    "Dresser": Kind(dresser),
    "TVStand": Kind(tv_stand),
}
