"""Tables to eat at, to sit around and to put beside things.

Drawers, shelves and cabinets in them are assets of their own; their boxes come in as pockets, and the furniture is
drawn around them.
"""

from __future__ import annotations

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.parts.carcass import PANEL, carcass, feet
from remqa_data.assets.parts.fronts import THICKNESS, contrast, drawer_fronts, finish, hardware
from remqa_data.assets.parts.table_parts import (
    GLASS_TOPS,
    RECESS,
    apron,
    drawer_case,
    flat_top,
    leg_thickness,
    metal_frame,
    pedestal,
    raised_back,
    shelf_boards,
    shelf_pockets,
    slats,
    splayed_legs,
    table_top,
    top_thickness,
    trestle,
    work_height,
)


def dining_table(b: Builder) -> None:
    """A dining table: four legs and an apron, oval on a pedestal, trestle, or rounded with splayed legs."""
    wood = finish(b)
    if flat_top(b, wood):
        return
    surface = work_height(b)
    variant = 0 if b.pockets and b.variant == 1 else b.variant
    thick = top_thickness(b, surface, min(0.035, 0.06 * b.h))
    under = surface - thick
    white = materials.WHITE_WOOD
    top = (wood, wood, wood, contrast(wood))[b.variant]
    table_top(
        b, surface, thick, top, b.by_variant(("rect", "round", "rect", "soft")) if variant == b.variant else "soft"
    )
    if variant == 0:
        legs = b.pick((wood, white))
        thickness = leg_thickness(b, 0.07)
        b.legs((b.w - 0.04, b.d - 0.04, under), legs, thickness=thickness)
        apron(b, (b.w - 0.04 - thickness, b.d - 0.04 - thickness), under, min(0.09, 0.14 * under), legs)
    elif variant == 1:
        pedestal(b, under, b.pick((wood, materials.BLACK_METAL, white)))
    elif variant == 2:
        trestle(b, under, wood)
    else:
        splayed_legs(b, (b.w, b.d), under, wood, 0.045)
        apron(b, (0.72 * b.w, 0.68 * b.d), under, min(0.05, 0.1 * under), wood)
    shelf_boards(b, surface, wood)
    raised_back(b, surface, wood)


def coffee_table(b: Builder) -> None:
    """A coffee table: wooden with a slatted shelf, round on three legs, glass on a metal frame, or a solid block."""
    wood, metal = finish(b), hardware(b)
    if flat_top(b, wood, 0.08):
        return
    surface = work_height(b)
    thick = top_thickness(b, surface, min(0.03, 0.10 * b.h))
    under = surface - thick
    if shelf_pockets(b) != list(b.pockets):
        top = contrast(wood) if b.variant % 2 else wood
        table_top(b, surface, thick, top, "rect")
        drawer_case(b, under, wood, symmetric=True)
    elif b.variant == 0 or (b.pockets and b.variant in (1, 3)):
        table_top(b, surface, thick, contrast(wood) if b.variant == 1 else wood, "rect")
        thickness = leg_thickness(b, 0.05)
        legs = wood if b.variant != 3 else metal
        b.legs((b.w - 0.006, b.d - 0.006, under), legs, thickness=thickness, round_=b.variant == 1)
        if not b.pockets:
            slats(b, 0.28 * surface, thickness, wood)
        shelf_boards(b, surface, wood)
    elif b.variant == 1:
        table_top(b, surface, thick, wood, "round")
        splayed_legs(b, (b.w, b.d), under, contrast(wood), 0.04, count=3)
    elif b.variant == 2:
        table_top(b, surface, min(thick, 0.014), b.pick(GLASS_TOPS), "rect")
        rod = min(0.03, 0.10 * b.h)
        metal_frame(b, (b.w - 0.06, b.d - 0.06), surface - min(thick, 0.014), rod, metal)
        shelf_boards(b, surface, wood)
    else:
        table_top(b, surface, thick, contrast(wood), "rect")
        niche = (-b.w / 2 + 0.05, -b.d / 2, 0.3 * under, b.w / 2 - 0.05, b.d / 2, 0.86 * under)
        case = (-b.w / 2 + 0.015, -b.d / 2 + 0.015, min(0.05, 0.2 * under), b.w / 2 - 0.015, b.d / 2 - 0.015, under)
        carcass(b, case, [niche], wood, hollow=False)
        feet(b, (b.w - 0.03, b.d - 0.03, case[2]), materials.EBONY, metal, 0)
        room = niche[5] - niche[2]
        b.space("niche", (b.w - 0.12, b.d - 0.04, room), (0, 0, niche[2] + room / 2))
    raised_back(b, surface, wood)


def side_table(b: Builder) -> None:
    """A side table or nightstand: tapered legs, round on a pedestal, case with a drawer, metal frame with a tray."""
    wood, metal = finish(b), hardware(b)
    surface = work_height(b)
    thick = top_thickness(b, surface, min(0.022, 0.05 * b.h))
    under = surface - thick
    low_shelves = [level for level in b.spec.levels if 0.05 < level < surface - 0.15]
    tall = b.w > 1.6 * b.d
    if b.pockets:
        top = contrast(wood) if b.variant in (1, 3) else wood
        table_top(b, surface, thick, top, "rect", radius=0.008 if b.variant == 2 else 0.002)
        if shelf_pockets(b) == list(b.pockets):
            b.legs((b.w - 0.006, b.d - 0.006, under), wood, thickness=leg_thickness(b, 0.035))
            shelf_boards(b, surface, wood)
        else:
            drawer_case(b, under, wood)
    elif b.variant == 0 or (b.variant == 1 and tall):
        table_top(b, surface, thick, wood if b.variant == 0 else contrast(wood), "rect" if b.variant == 0 else "soft")
        leg = min(0.045, 0.12 * b.d)
        b.legs((b.w - 0.02, b.d - 0.02, under), wood, thickness=leg, taper=0.6, round_=b.variant == 1)
        apron(b, (b.w - 0.02 - leg, b.d - 0.02 - leg), under, 0.16 * under, wood)
        if tall:
            low_shelves = low_shelves or [0.25 * surface]
    elif b.variant == 1:
        table_top(b, surface, thick, wood, "round")
        pedestal(b, under, b.pick((wood, metal)))
    elif b.variant == 2:
        table_top(b, surface, thick, wood, "rect", radius=0.008)
        _bedside_case(b, under, wood)
        low_shelves = []
    else:
        table_top(b, surface, thick, b.pick((wood, materials.STONES[0], GLASS_TOPS[0])), "rect")
        metal_frame(b, (b.w - 0.01, b.d - 0.01), under, min(0.02, 0.08 * b.d), metal)
        low_shelves = low_shelves or [0.22 * surface]
    for i, level in enumerate(low_shelves):
        size = (b.w - 0.05, b.d - 0.05, 0.014)
        b.box(size, (0, 0, level - 0.007), wood)
        room = surface - thick - level
        b.space(f"shelf{i}", (size[0], size[1], room), (0, 0, level + room / 2))
    raised_back(b, surface, wood)


def _bedside_case(b: Builder, under: float, wood: Material) -> None:
    """A nightstand: one drawer front over an open niche, on short legs."""
    low = min(0.12, 0.22 * under)
    x, y, rear = b.w / 2 - 0.008, -b.d / 2 + RECESS + THICKNESS, b.d / 2 - 0.004
    split = low + 0.58 * (under - low)
    niche = (-x + PANEL, y, low + PANEL, x - PANEL, rear - 0.01, split)
    carcass(b, (-x, y, low, x, rear, under), [niche], wood, hollow=False, back=wood)
    feet(b, (2 * x, b.d - RECESS, low), wood, hardware(b), 1)
    rect = (-x, split + 0.012, x, under)
    drawer_fronts(b, rect, y - THICKNESS, 1, 1, "slab", "knob", contrast(wood))
    room = split - low - PANEL
    b.space("niche", (2 * (x - PANEL), rear - y - 0.02, room), (0, (y + rear) / 2, low + PANEL + room / 2))


KINDS = {
    "DiningTable": Kind(dining_table),
    "CoffeeTable": Kind(coffee_table),
    "SideTable": Kind(side_table),
}
