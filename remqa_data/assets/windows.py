"""Windows: frames with sashes in front of a picture of the sky."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.assets import materials, primitives
from remqa_data.assets.builder import Builder
from remqa_data.assets.kind import Kind
from remqa_data.assets.model import Material, Vec3
from remqa_data.assets.mouldings import Outline, moulding, plate, rectangle
from remqa_data.assets.primitives import Axis, Mesh

SKY = Material("glass", "blue", (1.0, 1.0, 1.0), "sky", None, glow=0.9)
FRAMES = (materials.WHITE_WOOD, materials.WHITE_WOOD, materials.OAK, materials.GRAY_WOOD, materials.WALNUT)


def window(b: Builder) -> None:
    """A window with the sky behind it: casements, crossed panes, a double-hung sash or many small panes.

    A box almost as deep as wide is a bay or corner window: panes on three sides of it, open at the front.
    """
    wood = b.pick(FRAMES)
    if b.d < 0.6 * b.w:
        out, sill = min(0.06, 0.35 * b.d), min(0.04, 0.06 * b.h)
        b.box((b.w, b.d, sill), (0, 0, sill / 2), wood, radius=0.006)
        _fill(_Side(b, wood, b.w - 0.03, b.d - out, b.h - sill, (0, out / 2, sill)))
    else:
        deep = min(0.12, 0.15 * b.w)
        _fill(_Side(b, wood, b.w, deep, b.h, (0, (b.d - deep) / 2, 0)))
        _fill(_Side(b, wood, b.d - deep, deep, b.h, (-(b.w - deep) / 2, -deep / 2, 0), 90.0))
        _fill(_Side(b, wood, b.d - deep, deep, b.h, ((b.w - deep) / 2, -deep / 2, 0), -90.0))
    b.looks_like(wood)


@dataclass(frozen=True)
class _Side:
    """A board for one wall's worth of window: x along the wall, front at -y, z up from its lower edge at `at`."""

    builder: Builder
    wood: Material
    width: float
    depth: float
    height: float
    at: Vec3
    yaw_deg: float = 0.0

    @property
    def casing(self) -> float:
        """Breadth of the fixed frame."""
        return float(np.clip(0.07 * min(self.width, self.height), 0.025, 0.075))

    @property
    def glass(self) -> float:
        """Depth y at which the glass is."""
        return -self.depth / 2 + min(0.07, 0.65 * self.depth)

    @property
    def thick(self) -> float:
        """Thickness of a sash."""
        return min(0.03, 0.5 * (self.glass + self.depth / 2))

    def add(self, mesh: Mesh, at: Vec3, material: Material | None = None, grain: Axis = "z") -> None:
        """Draw a mesh, of the frame's wood unless told otherwise."""
        turned = mesh.moved(at).turned(primitives.turn("z", self.yaw_deg))
        along: Axis = "y" if self.yaw_deg and grain == "x" else grain
        self.builder.add(turned, material or self.wood, self.at, grain=along)

    def frame(self, shape: Outline, profile: Sequence[tuple[float, float]], x: float, z: float) -> None:
        """Draw a frame around a shape."""
        for mesh, grain in moulding(shape, profile):
            self.add(mesh, (x, 0, z), grain=grain)

    def upright(self, x: float, low: float, high: float, breadth: float) -> None:
        """Draw a glazing bar between two heights above the casing."""
        at = (x, self.glass - self.thick / 2, self.casing + (low + high) / 2)
        self.add(primitives.box((breadth, self.thick, high - low)), at)

    def level(self, z: float, left: float, right: float, breadth: float) -> None:
        """Draw a glazing bar at a height above the casing; a little thinner than upright ones, which it crosses."""
        at = ((left + right) / 2, self.glass - 0.48 * self.thick, self.casing + z)
        self.add(primitives.box((right - left, 0.96 * self.thick, breadth)), at, grain="x")


def _fill(side: _Side) -> None:
    casing, glass, thick = side.casing, side.glass, side.thick
    front = -side.depth / 2
    profile = [(0, side.depth / 2), (0, front), (0.75 * casing, front), (casing, front + 0.006), (casing, glass)]
    side.frame(rectangle(side.width, side.height), profile, 0, side.height / 2)
    wide, tall = side.width - 2 * casing, side.height - 2 * casing
    side.add(plate(rectangle(wide, tall)(0), glass, crop=0.6), (0, 0, side.height / 2), SKY)
    x, y, z = side.at
    size = (side.width, side.depth, side.height)
    side.builder.solid(size, (x, y, z + side.height / 2), primitives.turn("z", side.yaw_deg))
    bar = float(np.clip(0.028 * min(wide, tall) + 0.01, 0.016, 0.04))
    if side.builder.variant == 3:
        _lattice(side, wide, tall, 0.6 * bar)
        return
    leaves = max(1, round(wide / side.builder.by_variant((1.0, 1.3, 1.1))))
    share = wide / leaves
    for i in range(leaves):
        x = (i + 0.5) * share - wide / 2
        sash = [(0, glass), (0, glass - thick), (bar, glass - thick), (bar, glass)]
        side.frame(rectangle(share, tall), sash, x, casing + tall / 2)
        if side.builder.variant == 0:
            grip = x + (1 if i < leaves / 2 else -1) * (share - bar) / 2
            _fitting(side, (0.018, 0.016, 0.11), (grip, glass - thick - 0.006, casing + 0.45 * tall))
        elif side.builder.variant == 1:
            side.upright(x, bar, tall - bar, 0.7 * bar)
            side.level(0.5 * tall, x - share / 2 + bar, x + share / 2 - bar, 0.7 * bar)
        else:
            proud = glass - 1.5 * thick
            lower = [(0.01, glass), (0.01, proud), (1.3 * bar, proud), (1.3 * bar, glass)]
            side.frame(rectangle(share, tall / 2), lower, x, casing + tall / 4)
            side.level(0.5 * tall, x - share / 2, x + share / 2, 1.6 * bar)
            side.upright(x, 0.5 * tall, tall - bar, 0.6 * bar)
            _fitting(side, (0.05, 0.02, 0.02), (x, proud, casing + 0.5 * tall))


def _lattice(side: _Side, wide: float, tall: float, breadth: float) -> None:
    """Small panes of about a hand's length."""
    across, up = min(10, max(2, round(wide / 0.34))), min(8, max(2, round(tall / 0.34)))
    for i in range(1, across):
        side.upright((i / across - 0.5) * wide, 0, tall, breadth)
    for i in range(1, up):
        side.level(i / up * tall, -wide / 2, wide / 2, breadth)


def _fitting(side: _Side, size: Vec3, at: Vec3) -> None:
    metal = materials.BRASS if side.wood.color == "brown" else materials.CHROME
    side.add(primitives.rounded_box(size, 0.005, 1), at, metal)


KINDS = {"Window": Kind(window)}
