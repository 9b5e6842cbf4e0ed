"""What a builder collects while it draws: links with surfaces and collision boxes, and spaces; and the finished asset.

Drawing coordinates: x to the right as seen from the front, front at -y, z up from the floor that the object stands on
(0 to h); x and y are centred. The object is drawn closed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from remqa_data.assets.core.fitting import DraftLink, Fit, box_of, largest_material, vec
from remqa_data.assets.core.model import Asset, AssetSpec, Joint, JointKind, Material, Space
from remqa_data.assets.mesh.triangles import AXES, Axis, Mesh
from remqa_data.errors import AssetError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import quaternion_of
from remqa_data.geometry.types import F64, Box, Rect, Vec3

MAX_FIT = 1.25
"""A builder has to draw its object to within this factor of the asked size on each axis."""


class AssetAssembly:
    """The links, surfaces, collision boxes and spaces of one asset that is being drawn.

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

    # ---- the current link

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

    def solid(self, size: Vec3, at: Vec3, rotation: F64 | None = None) -> None:
        """An invisible box for physics only."""
        if self._turned:
            at = vec(arithmetic.turned(at, _LEFT))
            size = (size[1], size[0], size[2]) if rotation is None else size
            rotation = None if rotation is None else arithmetic.product(_LEFT, rotation)
        quaternion = (0.0, 0.0, 0.0, 1.0) if rotation is None else quaternion_of(rotation)
        self._links[self._current].boxes.append((np.asarray(at, float), np.asarray(size, float), quaternion))

    def space(self, name: str, size: Vec3, at: Vec3, *, enclosed: bool = False) -> None:
        """Declare free room on the current link where things may be, resting on its bottom. Drawing coordinates."""
        c, s = np.asarray(at, float), np.asarray(size, float) / 2
        if self._turned:
            c, s = arithmetic.turned(c, _LEFT), np.abs(arithmetic.turned(s, _LEFT))
        low, high = c - s, c + s
        box = (low[0], low[1], low[2], high[0], high[1], high[2])
        self._spaces.append(Space(name, self._current, box_of(box), enclosed))

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
        direction, point = arithmetic.turned(AXES[axis], turn), arithmetic.turned(origin, turn)
        joint = Joint(kind, vec(direction), vec(point), upper)
        self._links.append(DraftLink(name, parent_index, joint))
        before, self._current = self._current, len(self._links) - 1
        try:
            yield
        finally:
            self._current = before

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
