"""Newspapers, pens and pencils."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, BRASS, CHROME, WHITE_PLASTIC, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts import forms
from remqa_data.assets.parts.spindle import spindle
from remqa_data.geometry.types import Vec3

FRONT_PAGE = Material("paper", "white", (0.96, 0.96, 0.96), "newsprint", None)
NEWS_PAPER = Material("paper", "white", (0.88, 0.87, 0.82))
INK = Material("paper", "black", (0.12, 0.12, 0.13))
GRAPHITE_LEAD = Material("stone", "gray", (0.22, 0.22, 0.24), gloss=0.3)
RAW_WOOD = Material("wooden", "beige", (0.90, 0.74, 0.52))
ERASER = Material("rubber", "pink", (0.88, 0.52, 0.54))
PEN_COLORS = ("blue", "black", "red", "green", "purple")


def newspaper(b: Builder) -> None:
    """A newspaper: folded flat, rolled up with a rubber band, in two sections, or with its front page lifting."""
    with b.quarter_turned(b.d > b.w):
        w, d, h = b.w, b.d, b.h
        if b.variant == 1:
            _rolled_news(b)
        elif b.variant == 2:
            _folded_news(b, (0.92 * w, 0.94 * d, 0.55 * h), (0.04 * w, 0.03 * d, 0))
            _folded_news(b, (0.88 * w, 0.88 * d, 0.45 * h), (-0.06 * w, -0.06 * d, 0.55 * h))
            photograph = materials.picture(b.pick(("picture_0", "picture_2", "picture_4", "picture_6")))
            b.panel((0.44 * w, 0.52 * d), (0.12 * w, -0.16 * d, h + 0.0004), photograph, facing="z")
        elif b.variant == 3:
            bundle = 0.5 * h
            _folded_news(b, (w, d, bundle), (0, 0, 0))
            x, y = np.meshgrid(np.linspace(-0.495, 0.495, 7) * w, np.linspace(-0.47, 0.48, 5) * d, indexing="ij")
            lift = np.clip(x / w - 0.25 * y / d + 0.2, 0, 1) ** 1.5 / 0.75
            page = primitives.sheet(x, y, bundle + 0.001 + (h - bundle - 0.002) * lift, 0.001)
            b.add(_printed(page, w, d, sideways=True), FRONT_PAGE)
        else:
            _folded_news(b, (w, d, h), (0, 0, 0))
        b.solid((0.97 * w, 0.96 * d, h), (0, 0, h / 2))
    b.looks_like(FRONT_PAGE)


def pen(b: Builder) -> None:
    """A pen lying on its side: ballpoint with a button, with a cap and a clear barrel, a marker, or a fountain pen."""
    ink = paint(b.pick(PEN_COLORS), gloss=0.4)
    board = Posed(b, flat=True)
    if b.variant == 0:
        barrel = b.pick((ink, WHITE_PLASTIC, CHROME))
        spindle(board, [(0.10, 0.0), (0.16, 0.01), (0.22, 0.012), (0.85, 0.12), (0.85, 0.14)], CHROME)
        spindle(board, [(0.85, 0.135), (0.9, 0.15), (0.9, 0.40), (0, 0.401)], BLACK_PLASTIC)
        spindle(board, [(0.92, 0.39), (0.92, 0.9), (0.7, 0.93), (0, 0.93)], barrel)
        spindle(board, [(0.45, 0.92), (0.45, 1.0), (0, 1.0)], CHROME)
        _clip(board, 0.62, 0.93, CHROME)
    elif b.variant == 1:
        clear = paint("white", gloss=0.6, rgb=(0.86, 0.90, 0.93))
        spindle(board, [(0.10, 0.0), (0.14, 0.008), (0.5, 0.05), (0.5, 0.10)], BRASS)
        spindle(board, [(0.5, 0.06), (0.82, 0.10), (0.82, 0.70), (0, 0.70)], clear, 6)
        spindle(board, [(0, 0.66), (0.92, 0.66), (0.92, 0.98), (0.6, 1.0), (0, 1.0)], ink)
        _clip(board, 0.60, 0.98, ink)
        barrel = ink
    elif b.variant == 2:
        barrel = b.pick((WHITE_PLASTIC, ink, paint("gray", gloss=0.3)))
        spindle(board, [(0, 0.0), (0.8, 0.0), (0.92, 0.02), (0.98, 0.30), (0, 0.301)], ink)
        spindle(board, [(0.86, 0.29), (0.86, 0.97), (0, 0.97)], barrel)
        spindle(board, [(0, 0.96), (0.7, 0.965), (0.7, 1.0), (0, 1.0)], ink)
        spindle(board, [(0.88, 0.5), (0.88, 0.6)], ink)
        _clip(board, 0.05, 0.3, ink)
    else:
        barrel = b.pick(
            (
                BLACK_PLASTIC,
                paint("blue", gloss=0.5, rgb=(0.12, 0.18, 0.36)),
                paint("red", gloss=0.5, rgb=(0.42, 0.08, 0.10)),
            )
        )
        gold = b.pick((BRASS, CHROME))
        spindle(board, [(0, 0), (0.35, 0.004), (0.62, 0.04), (0.86, 0.2), (0.9, 0.56), (0, 0.56)], barrel)
        spindle(board, [(0.92, 0.55), (0.94, 0.7), (0.9, 0.85), (0.62, 0.96), (0.3, 1.0), (0, 1.0)], barrel)
        for y in (0.055, 0.552, 0.585):
            radius = float(np.interp(y, [0, 0.04, 0.2], [0.3, 0.62, 0.86])) if y < 0.2 else 0.96
            spindle(board, [(0, y), (radius, y), (radius, y + 0.014), (0, y + 0.014)], gold)
        _clip(board, 0.64, 0.95, gold)
    board.solid((board.w, board.d, board.h), (0, 0, board.h / 2))
    b.looks_like(barrel)


def pencil(b: Builder) -> None:
    """A pencil lying on its side: yellow with an eraser, a colour pencil, plain wood, or dark with a dipped end."""
    shade = b.pick(("red", "blue", "green", "orange", "purple"))
    coat = b.by_variant(
        (paint("yellow", "wooden", 0.3), paint(shade, "wooden", 0.3), materials.PINE, paint("black", "wooden", 0.3))
    )
    lead = paint(shade, "stone") if b.variant == 1 else GRAPHITE_LEAD
    board = Posed(b, flat=True)
    tip = min(0.024, 0.2 * board.d) / board.d
    end = {0: 1 - 0.12, 1: 1.0, 2: 0.97, 3: 0.94}[b.variant]
    hexagon = primitives.ellipse(board.w * 1.04, board.h * 1.08, 12 if b.variant == 2 else 6)
    barrel = primitives.prism(hexagon, (end - tip) * board.d).pointed("y")
    board.add(barrel, coat, (0, ((tip + end) / 2 - 0.5) * board.d, board.h / 2), grain="y")
    spindle(board, [(0.30, 0.32 * tip), (0.94, tip + 0.004), (0, tip + 0.004)], RAW_WOOD, 12)
    spindle(board, [(0.04, 0), (0.34, 0.35 * tip), (0, 0.35 * tip)], lead, 8)
    if b.variant == 0:
        for y in (0.0, 0.016, 0.032):
            spindle(
                board, [(0, end + y - 0.002), (1.0, end + y), (1.0, end + y + 0.01), (0.92, end + y + 0.016)], CHROME
            )
        spindle(board, [(0.92, end + 0.045), (0.92, 0.985), (0.75, 1.0), (0, 1.0)], ERASER)
    elif b.variant >= 2:
        cap = BLACK_PLASTIC if b.variant == 2 else WHITE_PLASTIC
        spindle(board, [(0.98, end - 0.002), (0.98, 0.99), (0.7, 1.0), (0, 1.0)], cap, 12)
        if b.variant == 3:
            spindle(board, [(0, end - 0.03), (1.02, end - 0.03), (1.02, end), (0, end)], BRASS, 12)
    board.solid((board.w, board.d, board.h), (0, 0, board.h / 2))
    b.looks_like(coat)


def _folded_news(b: Builder, size: Vec3, at: Vec3) -> None:
    """Folded pages in layers, the fold at the front; `at` is the middle of the bottom."""
    w, d, h = size
    layers = max(2, min(4, round(h / 0.006)))
    thick = h / layers
    for i in range(layers):
        wide, deep = w * (1 - 0.015 * (i % 2)), d * (1 - 0.02 * (i % 2))
        bend = primitives.arc((-deep / 2 + thick * 0.5, 0), thick * 0.49, 90, 270, 5)
        outline = np.vstack([bend, [[deep / 2, -thick * 0.49], [deep / 2, thick * 0.49]]])
        layer = _printed(forms.side_cut(outline, wide), wide, deep)
        top = i == layers - 1
        b.add(layer, FRONT_PAGE if top else NEWS_PAPER, (at[0], at[1], at[2] + (i + 0.5) * thick))


def _printed(mesh: Mesh, width: float, depth: float, *, sideways: bool = False) -> Mesh:
    """A mesh with half of the front page laid over it from above: the upper half, or `sideways` the left half."""
    x, y = mesh.vertices[:, 0] / width, mesh.vertices[:, 1] / depth
    uv = np.column_stack([0.27 * (1 - 2 * y), 0.5 - x] if sideways else [0.5 + x, 0.27 * (1 - 2 * y)])
    return Mesh(mesh.vertices, mesh.normals, mesh.faces, uv)


def _rolled_news(b: Builder) -> None:
    w, d, h = b.w, b.d, b.h
    roll = forms.side_cut(primitives.ellipse(d, h, 20), 0.985 * w)
    b.add(_printed(roll, w, d), FRONT_PAGE, (0, 0, h / 2))
    turns = np.linspace(0, 2.6 * 2 * np.pi, 24)
    shrink = 1 - 0.62 * turns / turns[-1]
    spiral = np.column_stack([np.cos(turns) * d / 2, np.sin(turns) * h / 2]) * shrink[:, None]
    for side in (-1, 1):
        cap = forms.side_cut(primitives.ellipse(0.98 * d, 0.98 * h, 16), 0.001)
        b.add(cap, NEWS_PAPER, (side * 0.4925 * w, 0, h / 2))
        path = np.column_stack([np.full(len(spiral), side * 0.4945 * w), spiral[:, 0], spiral[:, 1] + h / 2])
        b.add(primitives.tube(path, min(0.001, 0.05 * h), 3), INK)
    band = forms.side_cut(primitives.ellipse(1.02 * d, 1.03 * h, 16), 0.008)
    b.add(band, paint("red", "rubber", 0.1), (0.12 * w, 0, h / 2))


def _clip(board: Posed, start: float, end: float, material: Material) -> None:
    """A pocket clip along the upper side."""
    long = (end - start) * board.d
    y = ((start + end) / 2 - 0.5) * board.d
    board.add(primitives.box((0.24 * board.w, long, 0.08 * board.h)), material, (0, y, 0.98 * board.h))
    board.add(
        primitives.box((0.24 * board.w, 0.08 * long, 0.2 * board.h)), material, (0, y + 0.46 * long, 0.92 * board.h)
    )


KINDS = {
    "Newspaper": Kind(newspaper),
    "Pen": Kind(pen),
    "Pencil": Kind(pencil),
}
