"""Single shapes that a builder draws: boxes, cylinders, flat pictures and open vessels."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.assembly import AssetAssembly
from remqa_data.assets.core.fitting import vec
from remqa_data.assets.core.model import Material
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Axis, Mesh
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3


class Shapes(AssetAssembly):
    """A draft with shapes to draw on its current link, in drawing coordinates."""

    def box(
        self,
        size: Vec3,
        at: Vec3,
        material: Material,
        *,
        radius: float = 0.0,
        segments: int = 1,
        solid: bool = True,
        rotation: F64 | None = None,
    ) -> None:
        """Draw a box, sharp or with rounded edges, centred at a point; solid for physics unless told otherwise."""
        longest: Axis = ("x", "y", "z")[int(np.argmax(size))]
        mesh = primitives.rounded_box(size, radius, segments) if radius > 0 else primitives.box(size)
        turned = mesh if rotation is None else mesh.turned(rotation)
        self.add(turned, material, at, grain=longest)
        if solid:
            self.solid(size, at, rotation)

    def panel(self, size: tuple[float, float], at: Vec3, material: Material, *, facing: Axis = "-y") -> None:
        """Draw a flat picture (width, height) facing an axis, its texture stretched once over it, upright."""
        width, height = size
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
        normal = primitives.AXES[facing]
        if facing in ("z", "-z"):
            right, up = np.array([1.0, 0, 0]), arithmetic.cross(normal, [1.0, 0, 0])
        else:
            up = np.array([0.0, 0, 1.0])
            right = arithmetic.cross(up, normal)
        vertices = corners[:, :1] * width * right + corners[:, 1:] * height * up
        uv = np.column_stack([corners[:, 0] + 0.5, 0.5 - corners[:, 1]])
        self.add(Mesh(vertices, np.tile(normal, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]]), uv), material, at)

    def cylinder(
        self,
        radius: float,
        height: float,
        at: Vec3,
        material: Material,
        *,
        axis: Axis = "z",
        top_radius: float | None = None,
        sections: int = 16,
        solid: bool = True,
    ) -> None:
        """Draw a cylinder or cone frustum centred at a point, along an axis."""
        mesh = primitives.cylinder(radius, height, top_radius, sections).pointed(axis)
        self.add(mesh, material, at, solid=solid, grain=_bare(axis))

    def hollow(
        self, profile: primitives.Points2, at: Vec3 = (0, 0, 0), *, floor: float, wall: float = 0.004, boxes: int = 8
    ) -> None:
        """Give an open round container collision walls and a floor, so that it can hold things; draw nothing.

        Parameters
        ----------
        profile : (radius, z) points
            Bottom centre, outside up to the rim, inside down to the inner floor's centre.
        floor : float
            Height of the inner floor in metres.
        wall : float
            Thickness of the collision walls in metres.
        """
        points = np.asarray(profile, float)
        top = float(points[:, 1].max())
        bottom = float(points[:, 1].min())
        outer_top = float(points[points[:, 1] > top - 0.25 * (top - bottom), 0].max())
        outer_bottom = float(points[points[:, 1] < floor + 0.15 * (top - floor) + 1e-9, 0].max())
        middle, run = (outer_top + outer_bottom) / 2, np.hypot(outer_top - outer_bottom, top - bottom)
        tilt = float(np.arctan2(outer_top - outer_bottom, top - bottom))
        # Each wall lies within the outside, and is cut where its inner edge would stick out above the rim or below.
        cut = min(wall * abs(np.tan(tilt)), 0.6 * run)
        along, outward = np.array([np.sin(tilt), np.cos(tilt)]), np.array([np.cos(tilt), -np.sin(tilt)])
        r, z = [middle, (top + bottom) / 2] - outward * wall / 2 - np.sign(tilt) * along * cut / 2
        across = 2 * max(outer_top, outer_bottom) * np.tan(np.pi / boxes)
        for a in np.arange(boxes) * 360.0 / boxes:
            turn = primitives.turn("z", a)
            self.solid(
                (wall, across, run - cut),
                vec(np.asarray(at, float) + turn @ [r, 0.0, z]),
                turn @ primitives.turn("y", float(np.degrees(tilt))),
            )
        flat = outer_bottom * np.sqrt(2.0)
        self.solid((flat, flat, floor - bottom), (at[0], at[1], at[2] + (floor + bottom) / 2))


def _bare(axis: Axis) -> Axis:
    return axis.removeprefix("-")  # type: ignore[return-value]
