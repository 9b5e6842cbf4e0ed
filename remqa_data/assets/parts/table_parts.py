"""What tables have in common: the top, what carries it, and the cases around drawers and shelves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.carcass import GAP, PANEL, THINNEST, carcass, feet, slab
from remqa_data.assets.parts.fronts import front, hardware
from remqa_data.geometry.types import Box

Shape = Literal["rect", "soft", "round"]

RECESS = 0.022
"""How far a case stands back from the table top's edge; the handles of drawers lie in it."""
FREE_ABOVE = 0.5
"""Height of the space on a table top, metres."""
GLASS_TOPS = (materials.CLEAR_GLASS, materials.FROSTED_GLASS, materials.DARK_GLASS)


def work_height(b: Builder) -> float:
    """Height of the surface that things rest on: recorded, else the top, or 0.75 m where a hutch rises above it."""
    hutch = b.h > 1.1 and b.spec.type == "Desk"
    known = [level for level in b.spec.levels if level > 0.35 * b.h and (not hutch or level < 1.15)]
    height = max(known) if known else (0.75 if hutch else b.h)
    return b.h if height > b.h - 0.03 else float(height)


def top_thickness(b: Builder, surface: float, wanted: float) -> float:
    """Thickness of a top: what the pockets under it leave of the wanted one."""
    rooms = [surface - p[5] - GAP - THINNEST for p in b.pockets if p[5] < surface - 0.01]
    return max(0.006, min([wanted, *rooms]))


def table_top(
    b: Builder, surface: float, thickness: float, material: Material, shape: Shape, *, radius: float = 0.002
) -> None:
    """Draw a top whose upper side is at a height, and declare the room on it."""
    centre = (0.0, 0.0, surface - thickness / 2)
    if shape == "rect":
        b.box((b.w, b.d, thickness), centre, material, radius=min(radius, 0.4 * thickness), segments=2)
        plan = (b.w, b.d)
    elif shape == "soft":
        outline = primitives.rounded_rect(b.w, b.d, 0.22 * min(b.w, b.d), 6)
        b.add(primitives.prism(outline, thickness), material, centre, solid=True, grain="x" if b.w > b.d else "y")
        plan = (0.9 * b.w, 0.9 * b.d)
    else:
        ratio = max(b.w, b.d) / min(b.w, b.d)
        outline = primitives.ellipse(b.w, b.d, 40, 2.0 if ratio < 1.25 else 2.6)
        b.add(primitives.prism(outline, thickness), material, centre, grain="x" if b.w > b.d else "y")
        b.solid((0.92 * b.w, 0.5 * b.d, thickness), centre)
        b.solid((0.5 * b.w, 0.92 * b.d, thickness), centre)
        b.solid((0.74 * b.w, 0.74 * b.d, thickness), centre)
        plan = (0.72 * b.w, 0.72 * b.d)
    room = FREE_ABOVE if surface > b.h - 0.03 else b.h - surface
    b.space("top", (*plan, room), (0, 0, surface + room / 2))


def flat_top(b: Builder, wood: Material, limit: float = 0.2) -> bool:
    """Draw a mere top where the recorded box is too flat for a table; True if so."""
    if b.h >= limit:
        return False
    rail = 0.4 * b.h
    table_top(
        b,
        b.h,
        b.h - rail,
        wood,
        b.by_variant(("rect", "soft", "rect", "soft")),
        radius=b.by_variant((0.002, 0, 0.02, 0)),
    )
    size = (b.w - 0.06, b.d - 0.06, rail)
    b.box(size, (0, 0, rail / 2), wood if b.variant < 2 else materials.BLACK_METAL)
    return True


def raised_back(b: Builder, surface: float, wood: Material) -> None:
    """What stands on the back of a top that is lower than the box: a low rail, or a hutch around the pockets there."""
    if surface > b.h - 0.02:
        return
    above = [p for p in b.pockets if p[2] > surface - 0.10]
    if b.h - surface < 0.25 and not above:
        b.box((b.w, 0.018, b.h - surface), (0, b.d / 2 - 0.009, (b.h + surface) / 2), wood, radius=0.003)
        return
    low_y = min((p[1] for p in above), default=b.d / 2 - min(0.26, 0.45 * b.d))
    y0 = max(low_y, -b.d / 2)
    back = materials.tinted(wood, 0.9)
    if any(p[2] < surface + 0.15 for p in above):
        case = (-b.w / 2, y0, surface + 0.0005, b.w / 2, b.d / 2, b.h)
        free = carcass(b, case, above, wood, hollow=True, back=back)
    else:  # an open bay over the surface, shelves above it
        foot = min((p[2] for p in above), default=surface + 0.45 * (b.h - surface)) - PANEL - GAP
        foot = max(foot, surface + 0.5 * PANEL)
        for side in (-1, 1):
            slab(b, _sorted_x(side * b.w / 2, side * (b.w / 2 - PANEL), (y0, surface, b.d / 2, foot)), wood)
        slab(b, (-b.w / 2 + PANEL, b.d / 2 - 0.008, surface, b.w / 2 - PANEL, b.d / 2, foot), back)
        free = carcass(b, (-b.w / 2, y0, foot, b.w / 2, b.d / 2, b.h), above, wood, hollow=True, back=back)
    for i, (x0, z0, x1, z1) in enumerate(free):
        size = (x1 - x0, 0.94 * (b.d / 2 - y0), z1 - z0)
        b.space(f"hutch{i}", size, ((x0 + x1) / 2, (y0 + b.d / 2) / 2 - 0.01, (z0 + z1) / 2))


def _sorted_x(a: float, c: float, rest: tuple[float, float, float, float]) -> Box:
    y0, z0, y1, z1 = rest
    return min(a, c), y0, z0, max(a, c), y1, z1


def drawer_case(b: Builder, under: float, wood: Material, *, hollow: bool = False, symmetric: bool = False) -> None:
    """A case that spans the width around all pockets below a top, on feet if they leave room for it."""
    inside = [p for p in b.pockets if p[2] < under - 0.02]
    metal = hardware(b)
    lowest = min((p[2] for p in inside), default=0.1)
    low = lowest - PANEL - GAP
    low = low if low >= 0.03 else 0.0
    x = b.w / 2 - 0.004
    y0 = -b.d / 2 + (0.006 if hollow else RECESS)
    y1 = b.d / 2 - (RECESS if symmetric else 0.004)
    case = (-x, y0, low, x, y1, under)
    free = carcass(b, case, inside, wood, hollow=hollow, back=None if symmetric else wood)
    if low > 0.2:
        b.legs((b.w - 0.012, y1 - y0, low), wood, thickness=min(0.04, 0.12 * b.d), taper=0.65, round_=b.variant == 1)
    else:
        feet(b, (2 * x, y1 - y0, low), wood, metal, b.variant)
    for i, rect in enumerate(free):
        size = (rect[2] - rect[0], y1 - y0 - 0.01, rect[3] - rect[1])
        if hollow:
            b.space(f"free{i}", size, ((rect[0] + rect[2]) / 2, (y0 + y1) / 2, (rect[1] + rect[3]) / 2))
        elif not symmetric:
            front(b, rect, y0 - 0.8 * RECESS, 0.8 * RECESS, "shaker", wood)


def shelf_pockets(b: Builder) -> list[Box]:
    """Pockets that take nearly the whole plan: open under-shelves rather than drawers."""
    y = b.d / 2
    return [
        p
        for p in b.pockets
        if p[3] - p[0] > 0.8 * b.w and abs(p[1] + y) < 0.07 * b.d + 0.015 and abs(p[4] - y) < 0.07 * b.d + 0.015
    ]


def leg_thickness(b: Builder, wanted: float) -> float:
    """Thickness of a leg in a corner of the plan that under-shelves leave free."""
    margins = [min(p[0] + b.w / 2, b.w / 2 - p[3]) for p in b.pockets]
    return max(0.018, min([wanted, 0.14 * min(b.w, b.d), *(0.9 * m for m in margins)]))


def shelf_boards(b: Builder, surface: float, wood: Material) -> None:
    """Boards that carry the shelves under a top."""
    shelves: Sequence[Box] = [p for p in b.pockets if p[2] < surface - 0.1]
    for low in sorted({round(p[2], 3) for p in shelves}):
        if low > 0.016:
            size = (b.w - 0.02, b.d - 0.02, 0.014)
            b.box(size, (0, 0, low - GAP - 0.007), wood)


# ---- legs and frames


def apron(b: Builder, size: tuple[float, float], under: float, height: float, wood: Material) -> None:
    """Draw the four boards under a top that join its legs, on a plan (width, depth)."""
    width, depth = size
    for s in (-1, 1):
        b.box((width, 0.02, height), (0, s * depth / 2, under - height / 2), wood)
        b.box((0.02, depth - 0.02, height), (s * width / 2, 0, under - height / 2), wood)


def slats(b: Builder, z: float, leg: float, wood: Material) -> None:
    """An under-shelf of slats between two rails, and the room on it."""
    count = max(3, min(9, round(b.d / 0.09)))
    pitch = (b.d - 0.03) / count
    for i in range(count):
        y = -b.d / 2 + 0.015 + (i + 0.5) * pitch
        b.box((b.w - 2 * leg, pitch - 0.018, 0.014), (0, y, z - 0.007), wood)
    for s in (-1, 1):
        b.box((0.03, b.d - 2 * leg, 0.02), (s * (b.w / 2 - leg / 2 - 0.003), 0, z - 0.010), wood)
    room = min(0.3, b.h - z - 0.04)
    b.space("shelf", (b.w - 2 * leg - 0.03, b.d - 0.06, room), (0, 0, z + room / 2))


def pedestal(b: Builder, under: float, material: Material) -> None:
    """A turned column on a round foot; two of them under a long top."""
    long, short = max(b.w, b.d), min(b.w, b.d)
    foot = 0.30 * short
    profile = [
        (0, 0),
        (foot, 0),
        (foot, 0.02),
        (0.8 * foot, 0.035),
        (0.25 * foot + 0.02, 0.10 * under),
        (0.03 + 0.02 * short, 0.25 * under),
        (0.045 + 0.03 * short, 0.45 * under),
        (0.03 + 0.01 * short, 0.72 * under),
        (0.05 + 0.03 * short, 0.93 * under),
        (0.4 * foot + 0.04, under),
        (0, under),
    ]
    mesh = primitives.revolve(profile, 20, crease_deg=50)
    away = 0.25 * long if long > max(1.15, 1.4 * short) else 0.0
    if not away and long > 1.2 * short:
        stretch = (long / short) ** 0.6
        mesh = mesh.scaled((stretch, 1.0, 1.0) if b.w >= b.d else (1.0, stretch, 1.0))
    for side in (-1, 1) if away else (0,):
        at = (side * away, 0.0, 0.0) if b.w >= b.d else (0.0, side * away, 0.0)
        b.add(mesh, material, at, grain="z")
        b.solid((1.4 * foot, 1.4 * foot, 0.04), (at[0], at[1], 0.02))
        b.solid((0.16 * short + 0.04, 0.16 * short + 0.04, under), (at[0], at[1], under / 2))


def trestle(b: Builder, under: float, wood: Material) -> None:
    """Two T-shaped ends joined by a stretcher along the longer side."""
    along_x = b.w >= b.d
    long, short = max(b.w, b.d), min(b.w, b.d)

    def beam(along: float, across: float, height: float, offset: float, z: float) -> None:
        size = (along, across, height) if along_x else (across, along, height)
        b.box(size, (offset, 0, z) if along_x else (0, offset, z), wood, radius=0.004)

    for s in (-1, 1):
        offset = s * 0.30 * long
        beam(0.07, 0.72 * short, 0.06, offset, 0.03)
        beam(0.055, min(0.14, 0.3 * short), under - 0.11, offset, 0.06 + (under - 0.11) / 2)
        beam(0.07, 0.80 * short, 0.05, offset, under - 0.025)
    beam(0.60 * long - 0.055, 0.035, 0.08, 0.0, 0.35 * under)


def splayed_legs(
    b: Builder, size: tuple[float, float], under: float, material: Material, thickness: float, count: int = 4
) -> None:
    """Draw 3 or 4 round legs that lean outwards to their feet, within a plan (width, depth)."""
    width, depth = size
    thickness = min(thickness, 0.12 * min(size))
    if count == 4:
        feet_at = [(sx * 0.44 * width, sy * 0.43 * depth) for sx in (-1, 1) for sy in (-1, 1)]
    else:
        angles = np.radians(90.0 + 360.0 / count * np.arange(count))
        feet_at = [(0.38 * width * float(np.cos(a)), 0.38 * depth * float(np.sin(a))) for a in angles]
    for x, y in feet_at:
        leaning_leg(b, (x, y), (0.78 * x, 0.76 * y), under, (0.32 * thickness, 0.6 * thickness), material)


def leaning_leg(
    b: Builder,
    foot: tuple[float, float],
    top: tuple[float, float],
    height: float,
    radii: tuple[float, float],
    material: Material,
) -> None:
    """Draw a round leg from a foot (x, y) on the floor to a top (x, y) at a height; its ends are level."""
    ring = primitives.ellipse(2, 2, 10)
    ends = [
        np.column_stack([radius * ring + at, np.full(10, z)])
        for at, radius, z in ((foot, radii[0], 0.0), (top, radii[1], height))
    ]
    b.add(primitives.loft(ends), material, grain="z")
    thickness = 2 * max(radii)
    b.solid((thickness, thickness, height), ((foot[0] + top[0]) / 2, (foot[1] + top[1]) / 2, height / 2))


def metal_frame(b: Builder, size: tuple[float, float], under: float, rod: float, metal: Material) -> None:
    """A frame of square tube: four legs, rails under the top and along the floor at the ends."""
    width, depth = size
    b.legs((width, depth, under), metal, thickness=rod)
    for s in (-1, 1):
        b.box((width - 2 * rod, rod, rod), (0, s * (depth - rod) / 2, under - rod / 2), metal)
        for z in (rod / 2, under - rod / 2):
            b.box((rod, depth - 2 * rod, rod), (s * (width - rod) / 2, 0, z), metal)
