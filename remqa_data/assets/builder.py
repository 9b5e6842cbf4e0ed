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

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

import numpy as np

from remqa_data.assets import primitives
from remqa_data.assets.cutting import solid_around
from remqa_data.assets.fitting import DraftLink, Fit, box_of, largest_material, vec
from remqa_data.assets.model import (
    F64,
    Asset,
    AssetSpec,
    Box,
    Joint,
    JointKind,
    Material,
    Rect,
    Space,
    Vec3,
)
from remqa_data.assets.primitives import Axis, Mesh
from remqa_data.errors import AssetError
from remqa_data.rotations import quaternion_of

T = TypeVar("T")

MAX_FIT = 1.25
"""A builder has to draw its object to within this factor of the asked size on each axis."""


class Builder:
    """Collects the links, surfaces, collision boxes and spaces of one asset.

    Parameters
    ----------
    spec : AssetSpec
        What to build.

    Attributes
    ----------
    w, d, h : float
        Width, depth and height to fill, in metres.
    variant : int
        Which shape to draw.
    rng : numpy.random.Generator
        For colours and small proportions; depends on the seed alone.
    """

    def __init__(self, spec: AssetSpec) -> None:
        self.spec = spec
        self.w, self.d, self.h = spec.size
        self.variant = spec.variant
        # The seed alone, so that a kitchen's cabinets and drawers of one seed come in one colour.
        self.rng = np.random.default_rng(spec.seed)
        self._links: list[DraftLink] = [DraftLink("base", 0, None)]
        self._current = 0
        self._spaces: list[Space] = []
        self._words: Material | None = None
        self._turned = False

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

    @property
    def pockets(self) -> tuple[Box, ...]:
        """Boxes that must stay free for other objects, in drawing coordinates."""
        half = self.h / 2
        boxes = self.spec.pockets
        if self._turned:
            boxes = tuple((y0, -x1, z0, y1, -x0, z1) for x0, y0, z0, x1, y1, z1 in boxes)
        return tuple((x0, y0, z0 + half, x1, y1, z1 + half) for x0, y0, z0, x1, y1, z1 in boxes)

    @property
    def footprint(self) -> tuple[Rect, ...]:
        """Rectangles of the plan; the whole box when the spec names none."""
        return self.spec.footprint or ((-self.w / 2, -self.d / 2, self.w / 2, self.d / 2),)

    def looks_like(self, material: Material) -> None:
        """Say which material's words describe the whole object; without it, the largest surface decides."""
        self._words = material

    @contextmanager
    def quarter_turned(self, wanted: bool = True) -> Iterator[None]:
        """Draw with the board turned a quarter to the left: w and d change places, the front (-y) becomes +x.

        For objects that lie along x in one room and along y in another; does nothing unless `wanted`.
        """
        if not wanted:
            yield
            return
        self.w, self.d, self._turned = self.d, self.w, True
        try:
            yield
        finally:
            self.w, self.d, self._turned = self.d, self.w, False

    # ---- geometry on the current link

    def add(
        self, mesh: Mesh, material: Material, at: Vec3 = (0, 0, 0), *, solid: bool = False, grain: Axis | None = None
    ) -> None:
        """Draw a mesh. `solid` also adds its bounding box for physics; `grain` is the direction of a wood's grain."""
        moved = mesh.moved(at)
        if solid:
            low, high = moved.vertices.min(axis=0), moved.vertices.max(axis=0)
            self.solid(vec(high - low), vec((low + high) / 2))
        if self._turned:
            moved = moved.turned(_LEFT)
            grain = "y" if grain == "x" else "x" if grain == "y" else grain
        self._links[self._current].meshes.append((moved, material, grain))

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

    def solid(self, size: Vec3, at: Vec3, rotation: F64 | None = None) -> None:
        """An invisible box for physics only."""
        if self._turned:
            at = vec(_LEFT @ np.asarray(at, float))
            size = (size[1], size[0], size[2]) if rotation is None else size
            rotation = None if rotation is None else _LEFT @ rotation
        quaternion = (0.0, 0.0, 0.0, 1.0) if rotation is None else quaternion_of(rotation)
        self._links[self._current].boxes.append((np.asarray(at, float), np.asarray(size, float), quaternion))

    def panel(self, size: tuple[float, float], at: Vec3, material: Material, *, facing: Axis = "-y") -> None:
        """Draw a flat picture (width, height) facing an axis, its texture stretched once over it, upright."""
        width, height = size
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
        normal = primitives.AXES[facing]
        if facing in ("z", "-z"):
            right, up = np.array([1.0, 0, 0]), np.cross(normal, [1.0, 0, 0])
        else:
            up = np.array([0.0, 0, 1.0])
            right = np.cross(up, normal)
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

    def vessel(
        self,
        profile: primitives.Points2,
        material: Material,
        at: Vec3 = (0, 0, 0),
        *,
        floor: float,
        wall: float = 0.004,
        sections: int = 20,
        boxes: int = 8,
    ) -> None:
        """Draw an open round container from an outside-then-inside profile, with collision walls, so that it can hold things.

        Parameters
        ----------
        profile : (radius, z) points
            Bottom centre, outside up to the rim, inside down to the inner floor's centre.
        floor : float
            Height of the inner floor in metres.
        wall : float
            Thickness of the collision walls in metres.
        """
        self.add(primitives.revolve(profile, sections), material, at)
        self.hollow(profile, at, floor=floor, wall=wall, boxes=boxes)

    def hollow(
        self, profile: primitives.Points2, at: Vec3 = (0, 0, 0), *, floor: float, wall: float = 0.004, boxes: int = 8
    ) -> None:
        """Physics of a `vessel` alone, for one whose surfaces are drawn otherwise."""
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

    # ---- structure

    @contextmanager
    def link(
        self, name: str, kind: JointKind, *, axis: Axis, upper: float, origin: Vec3 = (0, 0, 0), parent: str = "base"
    ) -> Iterator[None]:
        """Draw on a new moving link.

        Parameters
        ----------
        name : str
            Name of the link, such as "door".
        kind : {"revolute", "prismatic"}
            A hinge or a slide.
        axis : Axis
            Right-handed hinge axis, or direction of the slide.
        upper : float
            Where it stands when fully open, in radians or metres.
        origin : tuple of float
            A point on the hinge.
        """
        parent_index = next(i for i, link in enumerate(self._links) if link.name == parent)
        turn = _LEFT if self._turned else np.eye(3)
        joint = Joint(kind, vec(turn @ primitives.AXES[axis]), vec(turn @ np.asarray(origin, float)), upper)
        self._links.append(DraftLink(name, parent_index, joint))
        before, self._current = self._current, len(self._links) - 1
        try:
            yield
        finally:
            self._current = before

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

    def space(self, name: str, size: Vec3, at: Vec3, *, enclosed: bool = False) -> None:
        """Declare free room on the current link where things may be, resting on its bottom. Drawing coordinates."""
        c, s = np.asarray(at, float), np.asarray(size, float) / 2
        if self._turned:
            c, s = _LEFT @ c, np.abs(_LEFT @ s)
        low, high = c - s, c + s
        box = (low[0], low[1], low[2], high[0], high[1], high[2])
        self._spaces.append(Space(name, self._current, box_of(box), enclosed))

    def block(self, box: Box, pockets: Sequence[Box], material: Material) -> None:
        """Draw a solid box with box-shaped pockets left free: the carcass around drawers."""
        for x0, y0, z0, x1, y1, z1 in solid_around(box, pockets):
            self.box((x1 - x0, y1 - y0, z1 - z0), ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2), material)

    # ---- result

    def finish(self) -> Asset:
        """The asset, fitted to the asked box, origin at the box's centre.

        Raises
        ------
        AssetError
            If the builder drew nothing, or an object whose size is far from what was asked.
        """
        if not any(link.meshes for link in self._links):
            raise AssetError(f"{self.spec.type}: the builder drew nothing")
        vertices = np.vstack([mesh.vertices for link in self._links for mesh, _, _ in link.meshes])
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        scale = np.asarray(self.spec.size) / np.maximum(high - low, 1e-9)
        if scale.max() > MAX_FIT or scale.min() < 1 / MAX_FIT:
            msg = f"{self.spec.type} variant {self.variant}: drawn {np.round(high - low, 4).tolist()} m"
            raise AssetError(f"{msg} for a box of {np.round(self.spec.size, 4).tolist()} m")
        fit = Fit(scale, (low + high) / 2)
        links = tuple(fit.link(draft) for draft in self._links)
        spaces = tuple(Space(s.name, s.link, fit.box(s.box), s.enclosed) for s in self._spaces)
        words = self._words or largest_material(links)
        return Asset(self.spec, links, spaces, words.color, words.substance)


_LEFT = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
_TURN_45 = np.array([[1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2.0)


def _frustum(foot: F64, top: F64, height: float) -> Mesh:
    rings = [np.column_stack([ring, np.full(len(ring), z)]) for ring, z in ((foot, -height / 2), (top, height / 2))]
    corners = np.roll(np.arange(4), -1)
    parts = []
    for i, j in enumerate(corners):
        quad = np.array([rings[0][i], rings[0][j], rings[1][j], rings[1][i]])
        normal = np.cross(quad[1] - quad[0], quad[3] - quad[0])
        normal /= np.linalg.norm(normal)
        parts.append(Mesh(quad, np.tile(normal, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])))
    up = np.array([0.0, 0.0, 1.0])
    parts.append(Mesh(rings[1], np.tile(up, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])))
    parts.append(Mesh(rings[0], np.tile(-up, (4, 1)), np.array([[0, 2, 1], [0, 3, 2]])))
    return primitives.joined(parts)


def _bare(axis: Axis) -> Axis:
    return axis.removeprefix("-")  # type: ignore[return-value]
