"""Pictures, mirrors and the floor: what a room's walls and ground carry."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from remqa_data.assets import hangings, materials, primitives, windows
from remqa_data.assets.builder import Builder
from remqa_data.assets.cloth import slab
from remqa_data.assets.kind import Kind
from remqa_data.assets.model import F64, Material, Vec3
from remqa_data.assets.mouldings import moulding, oval, plate, rectangle, rounded
from remqa_data.assets.primitives import Axis, Mesh

GOLD = Material("wooden", "yellow", (0.76, 0.60, 0.28), gloss=0.45)
PICTURE_FRAMES = (materials.EBONY, materials.OAK, materials.WALNUT, materials.WHITE_WOOD, GOLD)
MIRROR_FRAMES = (materials.CHROME, materials.OAK, materials.WALNUT, materials.WHITE_WOOD, materials.BLACK_METAL, GOLD)
MOUNT = 0.07
"""Share of a picture texture that its printed white mount takes up at each edge."""
FLOORS: tuple[tuple[Material, ...], ...] = (
    tuple(
        Material("wooden", color, rgb, "planks", 1.6, 0.12)
        for color, rgb in (("brown", (0.72, 0.53, 0.36)), ("beige", (0.90, 0.78, 0.61)), ("gray", (0.62, 0.60, 0.57)))
    ),
    tuple(
        Material("ceramic", color, rgb, "tile", 1.2, 0.30)
        for color, rgb in (("white", (0.93, 0.93, 0.91)), ("beige", (0.86, 0.79, 0.68)), ("gray", (0.58, 0.60, 0.62)))
    ),
    tuple(
        Material("fabric", color, rgb, "carpet", 0.6)
        for color, rgb in (("beige", (0.78, 0.71, 0.60)), ("gray", (0.58, 0.58, 0.60)), ("blue", (0.43, 0.50, 0.60)))
    ),
    tuple(
        Material("wooden", color, rgb, "parquet", 1.2, 0.15)
        for color, rgb in (("brown", (0.66, 0.45, 0.28)), ("beige", (0.88, 0.74, 0.54)))
    ),
    (
        Material("stone", "gray", (0.86, 0.85, 0.83), "terrazzo", 1.2, 0.30),
        Material("stone", "beige", (0.90, 0.83, 0.73), "terrazzo", 1.2, 0.30),
    ),
)


def painting(b: Builder) -> None:
    """A picture: with a passe-partout, in a broad profiled frame, on bare canvas, or in a slim frame.

    A deep box is that of a picture that leans on the wall; one almost as deep as wide hangs across a corner.
    """
    frame = b.pick(PICTURE_FRAMES)
    image = materials.picture(f"picture_{int(b.rng.integers(8))}")
    pose = _Pose(b.w, b.d, b.h)
    w, h, d = pose.width, pose.height, pose.depth
    shape = rectangle(w, h)
    if b.variant == 2:
        edge = Material("fabric", "white", (0.93, 0.91, 0.87))
        _hang(b, pose, moulding(shape, [(0, d / 2), (0, -d / 2)]), edge)
        b.add(pose(plate(shape(0), -d / 2, border=MOUNT, crop=0.5)), image)
    else:
        broad = min(w, h) * b.by_variant((0.05, 0.15, 0.0, 0.04))
        broad = float(np.clip(broad, 0.012, b.by_variant((0.03, 0.11, 0.0, 0.025))))
        lip = min(0.012, 0.4 * d)
        steps = [
            (0.0, d / 2),
            (0.0, -0.25 * d),
            (0.25 * broad, -d / 2),
            (0.5 * broad, -0.40 * d),
            (0.8 * broad, -0.15 * d),
            (broad, -0.2 * d),
        ]
        plain = [(0.0, d / 2), (0.0, -d / 2), (broad, -d / 2)]
        profile = (steps if b.variant == 1 else plain) + [(broad, -d / 2 + lip + 0.2 * d * (b.variant == 1))]
        _hang(b, pose, moulding(shape, profile), frame)
        y = profile[-1][1] - 0.001
        if b.variant == 0:
            mat = broad + 0.13 * min(w, h)
            _hang(b, pose, moulding(shape, [(broad, y), (mat, y), (mat, y + 0.003)]), materials.PAPER)
            b.add(pose(plate(shape(mat), y + 0.002, border=MOUNT, crop=0.5)), image)
        else:
            b.add(pose(plate(shape(broad), y, border=MOUNT, crop=0.5)), image)
    b.add(pose(plate(shape(0), -d / 2).turned(primitives.turn("z", 180))), materials.CARDBOARD)
    b.solid((w, d, h), pose.origin, pose.rotation)
    b.looks_like(image if b.variant == 2 else frame)


def poster(b: Builder) -> None:
    """A paper poster: taped with a curling lower edge, pinned, hung between wooden rails on pegs, or on a board."""
    image = materials.picture(f"poster_{int(b.rng.integers(4))}")
    b.by_variant((_taped, _pinned, _on_rails, _on_board))(b, image)
    b.looks_like(image)


def mirror(b: Builder) -> None:
    """A mirror: bevelled without a frame, in a rounded frame, oval, or with lamps above it. A deep box adds a shelf."""
    frame = b.pick(MIRROR_FRAMES) if b.variant else materials.CHROME
    depth = b.d if b.d < 0.12 else 0.05
    y = (b.d - depth) / 2
    shelf = 0.02 if depth < b.d else 0.0
    lamps = min(0.11, 0.16 * b.h) if b.variant == 3 else 0.0
    height = b.h - shelf - lamps
    centre = (0.0, y, shelf + height / 2)
    if b.variant == 2 and 0.5 < b.w / height < 2.0:
        shape = oval(b.w, height)
    elif b.variant in (1, 2):
        corner = min(b.w, height) * (0.5 if b.variant == 2 else 0.16)
        shape = rounded(b.w, height, corner)
    else:
        shape = rectangle(b.w, height)
    half = depth / 2
    if b.variant == 0:  # a bevel of glass on a thin metal backing
        bevel = min(0.03, 0.06 * min(b.w, height))
        for profile, material in (
            ([(0.0, half), (0.0, -0.2 * half)], frame),
            ([(0.0, -0.2 * half), (bevel, -half)], materials.CLEAR_GLASS),
        ):
            for mesh, _ in moulding(shape, profile):
                b.add(mesh, material, centre)
        b.add(plate(shape(bevel), -half), materials.MIRROR_GLASS, centre)
    else:
        broad = float(np.clip(0.08 * min(b.w, height), 0.012, 0.055))
        sunk = min(0.014, half)
        profile = [(0, half), (0, -0.4 * half), (0.3 * broad, -half), (0.8 * broad, -half), (broad, -half + sunk)]
        for mesh, grain in moulding(shape, profile):
            b.add(mesh, frame, centre, grain=grain)
        b.add(plate(shape(broad), -half + sunk), materials.MIRROR_GLASS, centre)
    b.solid((b.w, depth, height), centre)
    if lamps:
        _lamp_row(b, lamps, depth, y, frame)
    if shelf:
        b.box((b.w, b.d, shelf), (0, 0, shelf / 2), frame, radius=0.004)
    b.looks_like(materials.MIRROR_GLASS if b.variant == 0 else frame)


def floor(b: Builder) -> None:
    """The floor of a room: planks, tiles, carpet, parquet or terrazzo."""
    covering = b.pick(b.by_variant(FLOORS))
    for i, (x0, y0, x1, y1) in enumerate(b.footprint):
        middle = ((x0 + x1) / 2, (y0 + y1) / 2)
        b.box((x1 - x0, y1 - y0, b.h), (*middle, b.h / 2), covering)
        b.space("top" if i == 0 else f"top_{i}", (x1 - x0, y1 - y0, 1.0), (*middle, b.h + 0.5))


class _Pose:
    """How a flat picture stands in its box, and the size it then has: against the wall, leaning, or across a corner."""

    def __init__(self, w: float, d: float, h: float) -> None:
        self.width, self.depth, self.height = w, d, h
        self.rotation = np.eye(3)
        self.origin: Vec3 = (0.0, 0.0, h / 2)
        if d > 0.6 * w:
            self.depth = 0.04
            across = np.arctan2(d, w)
            self.width = float(np.hypot(w, d)) - self.depth
            self.rotation = primitives.turn("z", float(np.degrees(across)))
        elif d > 0.15 and d < h:
            self.depth = 0.03
            lean = np.arcsin(d / h) * 0.95
            self.height = float((h - self.depth * np.sin(lean)) / np.cos(lean))
            self.rotation = primitives.turn("x", -float(np.degrees(lean)))

    def __call__(self, mesh: Mesh) -> Mesh:
        return mesh.turned(self.rotation).moved(self.origin)


def _hang(b: Builder, pose: _Pose, parts: Sequence[tuple[Mesh, Axis]], material: Material) -> None:
    for mesh, grain in parts:
        b.add(pose(mesh), material, grain=grain)


def _lamp_row(b: Builder, tall: float, depth: float, y: float, metal: Material) -> None:
    """Round bulbs on a rail along the top of a mirror."""
    z = b.h - tall / 2
    b.box((b.w, 0.5 * depth, tall), (0, y + depth / 4, z), metal, radius=0.004)
    count = int(np.clip(round(b.w / 0.16), 2, 9))
    for i in range(count):
        x = ((i + 0.5) / count - 0.5) * b.w
        bulb = primitives.ellipsoid((0.8 * tall, 0.7 * depth, 0.8 * tall), 8, 4)
        b.add(bulb, materials.LAMP_LIGHT, (x, y - 0.15 * depth, z))


def _taped(b: Builder, image: Material) -> None:
    """Paper held by its upper corners; the lower edge curls off the wall."""
    _wall_paper(b, image, lambda v: np.clip(1 - v / 0.22, 0, 1) ** 2)
    tape = materials.paint("yellow", "paper", 0.1)
    for side in (-1, 1):
        at = (side * (b.w / 2 - 0.035), b.d / 2 - 0.0035, b.h - 0.03)
        b.box((0.06, 0.0012, 0.02), at, tape, rotation=primitives.turn("y", 45 * side), solid=False)


def _pinned(b: Builder, image: Material) -> None:
    """Paper pinned at its four corners; its middle bulges off the wall."""
    _wall_paper(b, image, lambda v: np.sin(np.pi * v) ** 2)
    pin, reach = materials.paint("red"), min(0.01, b.d)
    for x in (-(b.w / 2 - 0.035), b.w / 2 - 0.035):
        for z in (0.03, b.h - 0.03):
            b.cylinder(0.008, reach, (x, (b.d - reach) / 2, z), pin, axis="-y", sections=8, solid=False)


def _on_rails(b: Builder, image: Material) -> None:
    """Paper between two wooden rails, the upper of which hangs from pegs."""
    wood, rod = b.pick(materials.WOODS), min(0.022, b.d)
    y = (rod - b.d) / 2
    for z in (0.011, b.h - 0.011):
        b.box((b.w, rod, 0.022), (0, y, z), wood, radius=0.003)
    b.add(slab(_paper(b.w - 0.03, b.h, lambda v: np.full_like(v, y - 0.001)), 0.001), image)
    for x in (-0.35 * b.w, 0.35 * b.w):
        b.cylinder(min(0.006, 0.4 * b.d), b.d, (x, 0, b.h - 0.011), materials.BRASS, axis="y", sections=8)


def _on_board(b: Builder, image: Material) -> None:
    """Paper clipped to a board, which stands off the wall on pegs where its box is deep."""
    proud, clip = min(0.006, 0.3 * b.d), b.pick((materials.BLACK_METAL, materials.CHROME))
    board = materials.paint("black" if clip.color == "black" else "white")
    thick = min(0.02, b.d - proud)
    b.box((b.w, thick, b.h), (0, proud + (thick - b.d) / 2, b.h / 2), board)
    peg = b.d - proud - thick
    if peg > 0:
        for x in (-0.38 * b.w, 0.38 * b.w):
            for z in (0.15 * b.h, 0.85 * b.h):
                b.cylinder(0.012, peg, (x, (b.d - peg) / 2, z), materials.CHROME, axis="y", sections=10)
    b.panel((b.w - 0.024, b.h - 0.024), (0, -b.d / 2 + 0.85 * proud, b.h / 2), image)
    for x in (-0.25 * b.w, 0.25 * b.w):
        for z in (0.016, b.h - 0.016):
            b.box((0.03, proud, 0.032), (x, (proud - b.d) / 2, z), clip, radius=0.001)


def _wall_paper(b: Builder, image: Material, lift: Callable[[F64], F64]) -> None:
    """A sheet whose distance from the wall is a share of the box's depth that follows from the height, 0 to 1."""
    flat = min(0.002, 0.2 * b.d)
    b.add(slab(_paper(b.w, b.h, lambda v: b.d / 2 - flat - (b.d - flat) * lift(v)), min(0.0012, flat)), image)
    b.solid((b.w, min(0.01, b.d), b.h), (0, b.d / 2 - min(0.005, b.d / 2), b.h / 2))


def _paper(width: float, height: float, depth_at: Callable[[F64], F64]) -> F64:
    """Grid of a hanging sheet whose y follows from the height (0 at the hem to 1)."""
    v = np.linspace(0.0, 1.0, 17)
    x, z = np.meshgrid(np.linspace(-0.5, 0.5, 3) * width, v * height, indexing="ij")
    return np.stack([x, np.broadcast_to(depth_at(v), x.shape), z], axis=2)


def _along_wall(draw: Callable[[Builder], None]) -> Callable[[Builder], None]:
    """The same builder function for a wall that may also run along y: then the front is at +x."""

    def drawn(b: Builder) -> None:
        with b.quarter_turned(b.d > 1.3 * b.w):
            draw(b)

    return drawn


KINDS = {
    **{name: Kind(_along_wall(kind.draw), kind.variants) for name, kind in (hangings.KINDS | windows.KINDS).items()},
    "Painting": Kind(_along_wall(painting)),
    "Poster": Kind(_along_wall(poster)),
    "Mirror": Kind(_along_wall(mirror)),
    "Floor": Kind(floor, variants=5),
}
