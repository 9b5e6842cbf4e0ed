"""The drawing board on which an object type's function draws one asset.

A builder function receives a `Builder` and draws the object closed, in *drawing coordinates*: x to the right as seen
from the front, front at -y, z up from the floor that the object stands on (0 to h); x and y are centred. When it
returns, `finish` makes the closed mesh fill the asked box exactly and shifts the origin to the centre of that box.

    def crate(b: Builder) -> None:
        wood = b.pick(WOODS)
        b.shell((b.w, b.d, b.h), (0, 0, b.h / 2), 0.015, wood, open_side="z")
        b.space("inside", (b.w - 0.03, b.d - 0.03, b.h - 0.015), (0, 0, b.h / 2 + 0.0075))
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from remqa_data.assets.core.fitting import box_of, vec
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.shapes import Shapes
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.assets.mesh.primitives import Axis, Mesh
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Box, Vec3

T = TypeVar("T")


class Builder(Shapes):
    """A drawing board: choices by seed and variant, single shapes, and the parts that furniture is made of."""

    # ---- choices

    def pick(self, options: Sequence[T]) -> T:
        """One of several options at random."""
        return options[int(self.rng.integers(len(options)))]

    def by_variant(self, options: Sequence[T]) -> T:
        """The option of this variant, so that variants look different."""
        return options[self.variant % len(options)]

    def between(self, low: float, high: float) -> float:
        """A random number between two."""
        return float(self.rng.uniform(low, high))

    def level(self, default: float, low: float = 0.0, high: float | None = None) -> float:
        """Height above the bottom at which things rest: the first recorded one, or a default; kept in [low, high]."""
        wanted = self.spec.levels[0] if self.spec.levels else default
        return float(min(max(wanted, low), self.h if high is None else high))

    # ---- furniture parts

    def shell(
        self,
        size: Vec3,
        at: Vec3,
        thickness: float,
        material: Material,
        *,
        open_side: Axis | None = "-y",
        radius: float = 0.0,
        pockets: Sequence[Box] = (),
    ) -> None:
        """Draw a hollow box of panels, one side left open, and holes where it would cut into pockets."""
        centre, full = np.asarray(at, float), np.asarray(size, float)
        sides: list[Axis] = [side for side in ("z", "-z", "x", "-x", "y", "-y") if side != open_side]
        for side in sides:
            i, sign = "xyz".index(side[-1]), -1.0 if side.startswith("-") else 1.0
            low, high = centre - full / 2, centre + full / 2
            for j in range("zxy".index(side[-1])):  # panels already drawn leave this one their thickness less
                k = "xyz".index("zxy"[j])
                low[k] += thickness * ("-" + "zxy"[j] in sides)
                high[k] -= thickness * ("zxy"[j] in sides)
            if sign > 0:
                low[i] = high[i] - thickness
            else:
                high[i] = low[i] + thickness
            for part in solid_around(box_of((*low, *high)), pockets) if pockets else [box_of((*low, *high))]:
                start, end = np.asarray(part[:3]), np.asarray(part[3:])
                self.box(vec(end - start), vec((start + end) / 2), material, radius=radius)

    def legs(
        self,
        size: Vec3,
        material: Material,
        *,
        thickness: float = 0.04,
        taper: float = 1.0,
        round_: bool = False,
        inset: float = 0.0,
    ) -> None:
        """Draw four legs from the floor up to a height, inside a plan of (width, depth); `taper` narrows the foot."""
        width, depth, height = size
        for sx in (-1, 1):
            for sy in (-1, 1):
                at = (
                    sx * (width / 2 - thickness / 2 - inset),
                    sy * (depth / 2 - thickness / 2 - inset),
                    height / 2,
                )
                if round_:
                    self.cylinder(thickness / 2 * taper, height, at, material, top_radius=thickness / 2, sections=10)
                elif taper == 1.0:
                    self.box((thickness, thickness, height), at, material)
                else:
                    foot = primitives.ellipse(thickness * taper, thickness * taper, 4) @ _TURN_45
                    top = primitives.ellipse(thickness, thickness, 4) @ _TURN_45
                    root2 = np.sqrt(2.0)
                    self.add(_frustum(foot * root2, top * root2, height), material, at, solid=True, grain="z")

    def handle(
        self,
        at: Vec3,
        length: float,
        material: Material,
        *,
        axis: Axis = "x",
        reach: float = 0.028,
        radius: float = 0.005,
    ) -> None:
        """Draw a bar handle on a front that faces -y: the point is on the front's surface."""
        along = primitives.AXES[axis] * length / 2
        out = np.array([0.0, -(reach - radius), 0.0])
        path = [
            -along,
            -along * 0.98 + out * 0.8,
            -along * 0.9 + out,
            along * 0.9 + out,
            along * 0.98 + out * 0.8,
            along,
        ]
        self.add(primitives.tube(np.array(path), radius, 6), material, at)

    def knob(self, at: Vec3, radius: float, material: Material, *, reach: float = 0.025) -> None:
        """Draw a round knob on a front that faces -y: the point is on the front's surface."""
        profile = [
            (0, 0),
            (radius * 0.45, 0),
            (radius * 0.4, reach * 0.45),
            (radius, reach * 0.65),
            (radius * 0.8, reach),
            (0, reach),
        ]
        self.add(primitives.revolve(profile, 10).pointed("-y"), material, at)

    def door(
        self,
        name: str,
        size: Vec3,
        at: Vec3,
        material: Material,
        *,
        hinge: Axis = "-x",
        degrees: float = 100.0,
        handle: Material | None = None,
        radius: float = 0.004,
    ) -> None:
        """Draw a hinged front panel; `hinge` is the side that stays ("-x" left, "x" right, "z" top, "-z" bottom)."""
        width, thickness, height = size
        x, y, z = at
        place = {
            "-x": ((x - width / 2, y + thickness / 2, z), "-z"),
            "x": ((x + width / 2, y + thickness / 2, z), "z"),
            "z": ((x, y + thickness / 2, z + height / 2), "-x"),
            "-z": ((x, y + thickness / 2, z - height / 2), "x"),
        }
        origin, axis = place[hinge]
        with self.link(name, "revolute", axis=axis, upper=float(np.radians(degrees)), origin=origin):  # type: ignore[arg-type]
            self.box(size, at, material, radius=radius)
            if handle is None:
                return
            front = y - thickness / 2
            if hinge in ("-x", "x"):
                side = 1 if hinge == "-x" else -1
                self.handle((x + side * (width / 2 - 0.04), front, z), min(0.3 * height, 0.35), handle, axis="z")
            else:
                side = -1 if hinge == "z" else 1
                self.handle((x, front, z + side * (height / 2 - 0.05)), min(0.5 * width, 0.3), handle)

    def block(self, box: Box, pockets: Sequence[Box], material: Material) -> None:
        """Draw a solid box with box-shaped pockets left free: the carcass around drawers."""
        for x0, y0, z0, x1, y1, z1 in solid_around(box, pockets):
            self.box((x1 - x0, y1 - y0, z1 - z0), ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2), material)


_TURN_45 = np.array([[1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2.0)


def _frustum(foot: F64, top: F64, height: float) -> Mesh:
    rings = [np.column_stack([ring, np.full(len(ring), z)]) for ring, z in ((foot, -height / 2), (top, height / 2))]
    corners = np.roll(np.arange(4), -1)
    parts = []
    for i, j in enumerate(corners):
        quad = np.array([rings[0][i], rings[0][j], rings[1][j], rings[1][i]])
        normal = arithmetic.cross(quad[1] - quad[0], quad[3] - quad[0])
        normal /= np.linalg.norm(normal)
        parts.append(Mesh(quad, np.tile(normal, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])))
    up = np.array([0.0, 0.0, 1.0])
    parts.append(Mesh(rings[1], np.tile(up, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])))
    parts.append(Mesh(rings[0], np.tile(-up, (4, 1)), np.array([[0, 2, 1], [0, 3, 2]])))
    return primitives.joined(parts)
