"""Books that open."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BRASS, paint
from remqa_data.assets.mesh.primitives import Axis

OPEN_DEG = 175.0
SLIT_M = 0.0005
"""Half the gap between the two halves when the book is shut; the printed lines lie in it."""

PAGES = Material("paper", "white", (0.94, 0.91, 0.82))
LINE = Material("paper", "black", (0.30, 0.30, 0.32))
CLOTHS = tuple(
    materials.fabric(color, "fabric", 0.1, rgb)
    for color, rgb in (
        ("blue", (0.20, 0.30, 0.50)),
        ("red", (0.58, 0.16, 0.16)),
        ("green", (0.18, 0.38, 0.27)),
        ("gray", (0.42, 0.43, 0.45)),
        ("black", (0.15, 0.15, 0.17)),
        ("yellow", (0.82, 0.66, 0.25)),
    )
)
BINDINGS = tuple(paint(color, "paper", 0.3) for color in ("white", "red", "blue", "green", "orange", "purple"))


def book(b: Builder) -> None:
    """A book lying flat, spine at -x, that opens in the middle: picture cover, cloth, old leather, or two-tone.

    The upper half turns about the outer edge of the spine, halfway up, and comes to rest on the table to the left.
    """
    cover = b.by_variant((b.pick(BINDINGS), b.pick(CLOTHS), b.pick(materials.LEATHERS[:2]), b.pick(CLOTHS)))
    spine = b.pick(BINDINGS) if b.variant == 3 else cover
    bump = min(0.002, 0.02 * b.w) if b.variant == 2 else 0.0
    _half(b, cover, spine, bump, upper=False)
    hinge = (-b.w / 2, 0.0, b.h / 2)
    with b.link("cover", "revolute", axis="-y", upper=float(np.radians(OPEN_DEG)), origin=hinge):
        _half(b, cover, spine, bump, upper=True)
        _front(b, cover)
    b.looks_like(cover)


def _half(b: Builder, cover: Material, spine: Material, bump: float, *, upper: bool) -> None:
    """One board with half the spine and half the pages; the upper half is the mirror image of the lower."""
    side = 1 if upper else -1
    facing: Axis = "-z" if upper else "z"
    middle = b.h / 2
    board = min(0.003, 0.16 * b.h)
    left = -b.w / 2 + bump
    width = b.w - bump
    rim = min(0.005, 0.03 * b.w)
    inner = middle - SLIT_M
    lift = 0.0006 if upper else 0.0

    def z_of(from_middle: float) -> float:
        return middle + side * from_middle

    b.box(
        (width, b.d, board - lift),
        (left + width / 2, 0, z_of(middle - lift - (board - lift) / 2)),
        cover,
        radius=0.0008,
    )
    tall = inner - 0.0002 - board
    b.box((board, b.d, tall), (left + board / 2, 0, z_of(middle - board - tall / 2)), spine, solid=False)
    block = inner - board
    long = width - board - rim
    pages_x = left + board + long / 2
    b.box((long, b.d - 2 * rim, block), (pages_x, 0, z_of(middle - board - block / 2)), PAGES)
    b.panel((board, b.d - 2 * rim), (left + board / 2, 0, z_of(SLIT_M)), PAGES, facing=facing)
    edge = 0.35 * board  # closes the gap in the back of the shut book
    b.box(
        (edge, b.d, tall / 2 + SLIT_M), (left + edge / 2 - 0.0001, 0, z_of((tall / 2 + SLIT_M) / 2)), spine, solid=False
    )
    _print(b, (long, b.d - 2 * rim), pages_x, z_of(0.3 * SLIT_M), facing)
    for band in (-0.36, -0.14, 0.14, 0.36) if bump else ():
        size = (0.35 * board + bump, 0.03 * b.d, middle - SLIT_M)
        b.box(size, (-b.w / 2 + size[0] / 2, band * b.d, z_of(middle - size[2] / 2 - 0.0003)), cover, solid=False)
    if b.variant == 3:  # the spine's paper reaches over the boards
        strip = 0.16 * width
        b.box((strip, b.d * 0.998, 0.0004), (left + strip / 2, 0, z_of(middle - lift + 0.0001)), spine, solid=False)


def _print(b: Builder, size: tuple[float, float], x: float, z: float, facing: Axis) -> None:
    """Lines of text over a page: a heading, paragraphs with ragged ends, a page number."""
    width, depth = size
    pitch = min(0.016, 0.055 * depth)
    count = int(0.8 * depth / pitch)
    for i in range(count):
        if i == 1:
            continue
        share = 0.5 if i == 0 else 0.78 if i % 6 else b.between(0.3, 0.6)
        left = x - 0.39 * width
        at = (left + share * width / 2, 0.40 * depth - i * pitch, z)
        b.panel((share * width, pitch * (0.5 if i == 0 else 0.3)), at, LINE, facing=facing)
    b.panel((0.05 * width, 0.3 * pitch), (x, -0.45 * depth, z), LINE, facing=facing)


def _front(b: Builder, cover: Material) -> None:
    """Title and ornaments on the outside of the upper board."""
    z = b.h
    if b.variant == 0:
        art = materials.picture(f"book_cover_{b.rng.integers(4)}", cover.color)
        b.panel((0.90 * b.w, b.d - 0.002), (0.045 * b.w, 0, z), art, facing="z")
        b.panel((0.07 * b.w, b.d - 0.002), (-0.46 * b.w, 0, z), cover, facing="z")
    elif b.variant == 1:
        gold = b.pick((BRASS, materials.PAPER, materials.CHROME))
        b.panel((0.56 * b.w, 0.13 * b.d), (0.02 * b.w, 0.22 * b.d, z), gold, facing="z")
        for y, wide in ((0.24, 0.44), (0.20, 0.30)):
            b.panel((wide * b.w, 0.016 * b.d), (0.02 * b.w, y * b.d, z + 0.0004), LINE, facing="z")
        b.panel((0.26 * b.w, 0.02 * b.d), (0.02 * b.w, -0.34 * b.d, z), gold, facing="z")
    elif b.variant == 2:
        for x, y, wide, deep in (
            (0.02, 0.43, 0.84, 0.012),
            (0.02, -0.43, 0.84, 0.012),
            (-0.40, 0, 0.016, 0.86),
            (0.44, 0, 0.016, 0.86),
        ):
            b.panel((wide * b.w, deep * b.d), (x * b.w, y * b.d, z), BRASS, facing="z")
        b.panel((0.40 * b.w, 0.035 * b.d), (0.02 * b.w, 0.2 * b.d, z), BRASS, facing="z")
        b.panel((0.28 * b.w, 0.025 * b.d), (0.02 * b.w, 0.13 * b.d, z), BRASS, facing="z")
        for x in (-0.46, 0.46):
            for y in (-0.46, 0.46):
                size = (0.07 * b.w, 0.07 * b.d, 0.0004)
                b.box(size, (x * b.w, y * b.d, z), BRASS, solid=False)
    else:
        b.panel((0.50 * b.w, 0.04 * b.d), (0.10 * b.w, 0.18 * b.d, z), materials.PAPER, facing="z")
        b.panel((0.34 * b.w, 0.03 * b.d), (0.10 * b.w, 0.11 * b.d, z), materials.PAPER, facing="z")
        b.panel((0.012, b.d - 0.001), (0.40 * b.w, 0, z), materials.SHADOW_GAP, facing="z")


KINDS = {"Book": Kind(book)}
