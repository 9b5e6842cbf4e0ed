"""Fronts of drawers and doors, and the finish that the pieces of one suite of furniture share.

A dresser and the drawers in it are separate assets. Built with one seed they get one finish and one kind of metal, so
they read as one piece of furniture.
"""

from __future__ import annotations

from typing import Literal

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_METAL, BRASS, CHROME, STEEL
from remqa_data.geometry.types import Rect

Style = Literal["slab", "shaker", "raised", "grooved"]
Pull = Literal["bar", "knob", "cup", "lip"]

FINISHES = (*materials.WOODS, *materials.PAINTED_WOODS)
HARDWARE = (STEEL, BLACK_METAL, BRASS, CHROME)
THICKNESS = 0.018
"""Of a drawer front or a door, metres."""
RECESS_TINT = {"slab": 1.0, "shaker": 0.9, "raised": 0.88, "grooved": 0.55}
"""How much darker the parts of a front that lie back are drawn, as if dust and shade had gathered there."""


def finish(b: Builder) -> Material:
    """The wood or paint of everything built with this seed."""
    return FINISHES[b.spec.seed % len(FINISHES)]


def hardware(b: Builder) -> Material:
    """The metal of the handles of everything built with this seed."""
    return HARDWARE[b.spec.seed % len(HARDWARE)]


def contrast(material: Material) -> Material:
    """A finish that stands out beside another: dark or natural wood beside paint, white beside dark wood."""
    if material in materials.PAINTED_WOODS:
        return materials.OAK
    return materials.WALNUT if material in (materials.OAK, materials.PINE) else materials.WHITE_WOOD


def handle_reach(depth: float) -> float:
    """How far a handle stands out from a front, given the depth of what it opens; it lies inside the asset's box."""
    return min(0.024, 0.12 * depth)


def front_thickness(depth: float) -> float:
    """Thickness of a front, thinner on something very shallow."""
    return min(THICKNESS, 0.25 * depth)


def front(b: Builder, rect: Rect, y: float, thickness: float, style: Style, material: Material) -> None:
    """Draw a front panel on the current link, with a dark line around it.

    Parameters
    ----------
    rect : (x0, z0, x1, z1)
        What it fills; neighbouring fronts may touch, each keeps its own reveal.
    y : float
        Where its outermost surface is; it reaches `thickness` back from there.
    """
    x0, z0, x1, z1 = rect
    width, height = x1 - x0, z1 - z0
    x, z = (x0 + x1) / 2, (z0 + z1) / 2
    gap = min(0.0025, 0.02 * min(width, height))
    gasket, rear = 0.1 * thickness, 0.25 * thickness
    shade = materials.tinted(material, 0.4)
    b.box((width, gasket, height), (x, y + thickness - rear - gasket / 2, z), shade, solid=False)
    b.box((width - 2 * gap, rear, height - 2 * gap), (x, y + thickness - rear / 2, z), material, solid=False)
    b.solid((width, thickness, height), (x, y + thickness / 2, z))
    width, height, body = width - 2 * gap, height - 2 * gap, thickness - gasket - rear
    relief = 0.0 if style == "slab" else min(0.005, 0.4 * body)
    slab_y = y + relief + (body - relief) / 2
    slab = materials.tinted(material, RECESS_TINT[style])
    rounding = min(0.003, 0.2 * body)
    b.box((width, body - relief, height), (x, slab_y, z), slab, radius=rounding, solid=False)
    rail = min(0.06, 0.22 * min(width, height))
    if style == "shaker":
        for side in (-1, 1):
            stile = (x + side * (width - rail) / 2, y + relief / 2, z)
            b.box((rail, relief, height), stile, material, solid=False)
            across = (x, y + relief / 2, z + side * (height - rail) / 2)
            b.box((width - 2 * rail, relief, rail), across, material, solid=False)
    elif style == "raised":
        size = (width - 1.4 * rail, 2 * relief, height - 1.4 * rail)
        b.box(size, (x, y + relief, z), material, radius=0.9 * relief, solid=False)
    elif style == "grooved":
        count = max(2, min(7, round(width / 0.08)))
        pitch = width / count
        for i in range(count):
            board_x = x - width / 2 + (i + 0.5) * pitch
            b.box((pitch - 0.005, relief, height), (board_x, y + relief / 2, z), material, solid=False)


def drawer_pull(b: Builder, rect: Rect, y: float, reach: float, pull: Pull, metal: Material) -> None:
    """Draw what one pulls a drawer by, on a front whose surface is at y."""
    x0, z0, x1, z1 = rect
    width, height, x, z = x1 - x0, z1 - z0, (x0 + x1) / 2, (z0 + z1) / 2
    if pull == "bar":
        length, radius = min(0.30, 0.45 * width), min(0.006, 0.08 * height, 0.3 * reach)
        b.handle((x, y, z), length, metal, reach=reach, radius=radius)
    elif pull == "knob":
        for side in (-1, 1) if width > 0.55 else (0,):
            b.knob((x + side * 0.28 * width, y, z), min(0.016, 0.2 * height), metal, reach=reach)
    elif pull == "cup":
        size = (min(0.10, 0.4 * width), reach, min(0.035, 0.35 * height))
        b.box(size, (x, y - reach / 2, z), metal, radius=0.45 * min(reach, size[2]), segments=2, solid=False)
    else:
        size = (0.94 * width, reach, min(0.014, 0.15 * height))
        b.box(size, (x, y - reach / 2, z1 - size[2]), metal, radius=0.003, solid=False)


def door_pull(
    b: Builder, rect: Rect, y: float, reach: float, pull: Pull, metal: Material, side: int, height: float = 0.5
) -> None:
    """Draw what one pulls a door by, near the edge on a side (-1 left, 1 right), at a fraction of its height."""
    x0, z0, x1, z1 = rect
    x = (x0 if side < 0 else x1) - side * min(0.04, 0.15 * (x1 - x0))
    z = z0 + height * (z1 - z0)
    if pull == "knob":
        b.knob((x, y, z), min(0.016, 0.08 * (x1 - x0)), metal, reach=reach)
    else:
        b.handle((x, y, z), min(0.22, 0.35 * (z1 - z0)), metal, axis="z", reach=reach, radius=min(0.006, 0.3 * reach))


def drawer_fronts(
    b: Builder, rect: Rect, y: float, rows: int, columns: int, style: Style, pull: Pull, material: Material
) -> None:
    """Draw a grid of drawer fronts that do not open; surfaces at y, handles before it."""
    x0, z0, x1, z1 = rect
    width, height = (x1 - x0) / columns, (z1 - z0) / rows
    for i in range(columns):
        for j in range(rows):
            cell = (x0 + i * width, z0 + j * height, x0 + (i + 1) * width, z0 + (j + 1) * height)
            front(b, cell, y, THICKNESS, style, material)
            drawer_pull(b, cell, y, 0.02, pull, hardware(b))
