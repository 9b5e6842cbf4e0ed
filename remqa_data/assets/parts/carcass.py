"""What furniture is built of around the drawers, shelves and cabinets in it, which are assets of their own."""

from __future__ import annotations

from collections.abc import Sequence

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.geometry.types import Box, Rect

PANEL = 0.016
"""Thickness of a furniture panel, metres."""
THINNEST = 0.004
"""Of an outer panel beside a drawer that reaches to the side of its furniture, metres."""
GAP = 0.002
"""Free room left around a drawer, metres."""
SMALLEST_VOID = 0.10
"""Free areas at least this wide and high stay open in open furniture; smaller ones are boards."""


def slab(b: Builder, box: Box, material: Material, *, radius: float = 0.0) -> None:
    """Draw a solid box given by its corners; slivers are left out."""
    x0, y0, z0, x1, y1, z1 = box
    if min(x1 - x0, y1 - y0, z1 - z0) < 0.0005:
        return
    at = ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
    b.box((x1 - x0, y1 - y0, z1 - z0), at, material, radius=radius)


def carcass(
    b: Builder, box: Box, pockets: Sequence[Box], material: Material, *, hollow: bool, back: Material | None = None
) -> list[Rect]:
    """Draw a case whose front is open where the pockets are.

    Parameters
    ----------
    box : Box
        The outside of the case.
    pockets : sequence of Box
        What must stay free. Each is clipped to leave the outer panels standing, and reaches from front to back.
    hollow : bool
        Whether areas without a pocket are open compartments; otherwise they are filled.
    back : Material, optional
        Material of a back panel; none without it.

    Returns
    -------
    list of (x0, z0, x1, z1): areas of the front that no pocket takes, open when `hollow`, else filled.
    """
    x0, y0, z0, x1, y1, z1 = box
    panel = min(PANEL, (x1 - x0) / 8, (z1 - z0) / 8)
    low = [_outer_panel([p[i] - box[i] for p in pockets], panel) for i in (0, 2)]
    high = [_outer_panel([box[i] - p[i] for p in pockets], panel) for i in (3, 5)]
    inner = (x0 + low[0], y0, z0 + low[1], x1 - high[0], y1, z1 - high[1])
    holes = [hole for pocket in pockets if (hole := _through(pocket, inner)) is not None]
    free: list[Rect] = []
    voids: list[Box] = []
    for piece in solid_around(inner, holes):
        if min(piece[3] - piece[0], piece[5] - piece[2]) < SMALLEST_VOID:
            continue
        left, bottom, right, top = (
            piece[i] + sign * (0.0 if abs(piece[i] - inner[i]) < 1e-4 else panel)
            for i, sign in ((0, 1), (2, 1), (3, -1), (5, -1))
        )
        free.append((left, bottom, right, top))
        voids.append((left, y0, bottom, right, y1, top))
    rear = y1 - (0.0 if back is None else 0.006)
    case = (x0, y0, z0, x1, rear, z1)
    for part in solid_around(case, holes + voids if hollow else holes):
        slab(b, part, material)
    if back is not None:
        for part in solid_around((x0, rear, z0, x1, y1, z1), [grown(p, GAP) for p in pockets]):
            slab(b, part, back)
    return free


def _outer_panel(margins: Sequence[float], wanted: float) -> float:
    """Thickness of an outer panel: what the nearest pocket leaves of the wanted one."""
    return max(THINNEST, min([wanted, *(margin - GAP for margin in margins)]))


def _through(pocket: Box, inner: Box) -> Box | None:
    """The pocket from front to back, with a gap around it, clipped to what lies inside the outer panels."""
    x0, _, z0, x1, _, z1 = grown(pocket, GAP)
    hole = (max(x0, inner[0]), inner[1], max(z0, inner[2]), min(x1, inner[3]), inner[4], min(z1, inner[5]))
    return hole if hole[3] - hole[0] > 0.01 and hole[5] - hole[2] > 0.01 else None


def grown(box: Box, by: float) -> Box:
    """A box with a margin on all sides."""
    x0, y0, z0, x1, y1, z1 = box
    return x0 - by, y0 - by, z0 - by, x1 + by, y1 + by, z1 + by


def clusters(pockets: Sequence[Box], apart: float = 0.12) -> list[list[Box]]:
    """Pockets grouped from left to right wherever the free width between two groups is more than `apart`.

    >>> [len(group) for group in clusters([(0, 0, 0, 1, 1, 1), (2, 0, 0, 3, 1, 1), (0, 0, 1, 1, 1, 2)])]
    [2, 1]
    """
    groups: list[list[Box]] = []
    reach = float("-inf")
    for pocket in sorted(pockets, key=lambda p: p[0]):
        if pocket[0] > reach + apart:
            groups.append([])
            reach = pocket[3]
        groups[-1].append(pocket)
        reach = max(reach, pocket[3])
    return groups


def hull(boxes: Sequence[Box]) -> Box:
    """The least box around some boxes."""
    low = [min(box[i] for box in boxes) for i in range(3)]
    high = [max(box[i] for box in boxes) for i in range(3, 6)]
    return low[0], low[1], low[2], high[0], high[1], high[2]


def feet(b: Builder, size: tuple[float, float, float], material: Material, metal: Material, style: int) -> None:
    """Draw what a case of (width, depth) stands on, up to a height: plinth, tapered legs, bun feet, metal sled."""
    width, depth, height = size
    if height < 0.012:
        return
    if style == 0 or height < 0.04:
        b.box((width - 0.02, depth - 0.07, height), (0, 0.015, height / 2), material)
    elif style == 1:
        thickness = min(0.05, 0.5 * height)
        b.legs((width - 0.04, depth - 0.04, height), material, thickness=thickness, taper=0.55, round_=True)
    elif style == 2:
        for sx in (-1, 1):
            for sy in (-1, 1):
                r = min(0.04, 0.12 * depth)
                profile = [(0, 0), (0.7 * r, 0), (r, 0.3 * height), (r, 0.5 * height), (0.6 * r, height), (0, height)]
                at = (sx * (width / 2 - r - 0.01), sy * (depth / 2 - r - 0.01), 0.0)
                b.add(primitives.revolve(profile, 12, crease_deg=60), material, at, solid=True)
    else:
        rod = min(0.022, 0.4 * height)
        for sx in (-1, 1):
            x = sx * (width / 2 - 0.05)
            b.box((rod, depth - 0.04, rod), (x, 0, rod / 2), metal)
            for sy in (-1, 1):
                b.box((rod, rod, height - rod), (x, sy * (depth / 2 - 0.05), (height + rod) / 2), metal)
