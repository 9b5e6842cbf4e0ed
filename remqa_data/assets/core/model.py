"""What an asset is: links with surfaces and collision boxes, joints between them, and spaces that hold things.

Every asset is described in its own frame: origin at the centre of its closed bounding box, x to the right as seen from
the front, the front at -y, z up, metres. A link's geometry is given in that same frame while the asset is closed; moving
a joint moves the link about or along the joint's axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F32, F64, I32, Box, Rect, Vec3

JointKind = Literal["revolute", "prismatic"]


@dataclass(frozen=True)
class Material:
    """How a surface looks, and the words that describe it.

    Attributes
    ----------
    substance : str
        What it is made of, as an adjective: "wooden", "metal", "ceramic".
    color : str
        A basic colour word: "white", "brown".
    rgb : tuple of float
        sRGB in 0..1; multiplies the texture.
    texture : str or None
        Name of a procedural texture, see `remqa_data.assets.looks.textures`.
    repeat_m : float or None
        Metres that one repeat of the texture covers; None stretches it once over a mesh with its own coordinates.
    gloss : float
        Strength of the highlight, 0 (matt) to 1.
    glow : float
        0 for lit by the room, 1 for a surface that shines by itself (lamp, sky behind a window).
    mirror : float
        Share of what it shows that is a reflection of the room where light is baked, 0 to 1 (a perfect mirror).
    """

    substance: str
    color: str
    rgb: Vec3
    texture: str | None = None
    repeat_m: float | None = 1.0
    gloss: float = 0.0
    glow: float = 0.0
    mirror: float = 0.0


@dataclass(frozen=True, eq=False)
class Surface:
    """A triangle mesh of one material. Triangles are counter-clockwise as seen from outside."""

    vertices: F32
    """(n, 3) metres, asset frame."""
    normals: F32
    """(n, 3) unit vectors."""
    uv: F32
    """(n, 2) texture coordinates in repeats."""
    faces: I32
    """(m, 3) indices into vertices."""
    material: Material


@dataclass(frozen=True)
class CollisionBox:
    """An oriented box that physics sees, in the asset frame."""

    centre: Vec3
    size: Vec3
    quaternion: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    """x, y, z, w."""


@dataclass(frozen=True)
class Joint:
    """What moves a link; at openness f the joint stands at f * upper (radians or metres)."""

    kind: JointKind
    axis: Vec3
    origin: Vec3
    upper: float


@dataclass(frozen=True)
class Space:
    """A box of free room, given by a link, where other things can be: a shelf, the inside of a drawer, a table top.

    Things rest on the bottom of the box. `enclosed` says that it can only be seen and reached when the asset is open.
    """

    name: str
    link: int
    box: Box
    enclosed: bool


@dataclass(frozen=True)
class Link:
    """A rigid part. Link 0 is the base and has no joint; every other link hangs on an earlier one."""

    name: str
    parent: int
    joint: Joint | None
    surfaces: tuple[Surface, ...]
    boxes: tuple[CollisionBox, ...]


@dataclass(frozen=True)
class AssetSpec:
    """All that is needed to build the same asset again, anywhere.

    Attributes
    ----------
    type : str
        iTHOR object type, such as "Mug".
    size : tuple of float
        Width (x), depth (y), height (z) of the closed asset in metres.
    variant : int
        Which of the type's shapes.
    seed : int
        Chooses colours and small proportions.
    levels : tuple of float
        Heights above the asset's bottom, in metres, at which things rest inside it (seat, mattress, shelves, basin
        floor). Empty: the builder chooses.
    pockets : tuple of Box
        Parts of the asset's box to leave free for other objects, such as the drawers of a dresser. Asset frame.
    footprint : tuple of Rect
        Rectangles that make up the plan of an L- or U-shaped asset. Asset frame. Empty: the whole box.
    """

    type: str
    size: Vec3
    variant: int = 0
    seed: int = 0
    levels: tuple[float, ...] = ()
    pockets: tuple[Box, ...] = ()
    footprint: tuple[Rect, ...] = ()


@dataclass(frozen=True, eq=False)
class Asset:
    """A built asset."""

    spec: AssetSpec
    links: tuple[Link, ...]
    spaces: tuple[Space, ...]
    color: str
    """Colour word of what one sees most of."""
    substance: str
    """Material word of what one sees most of."""
    hollow: Box | None = None
    """Free room below its base for what lies under it; asset frame."""

    @property
    def is_openable(self) -> bool:
        """Whether it has a joint."""
        return len(self.links) > 1

    def link_poses(self, openness: float) -> F64:
        """Pose of every link in the asset frame.

        Parameters
        ----------
        openness : float
            0 (closed) to 1 (open).

        Returns
        -------
        (links, 4, 4) float64; each maps the link's geometry as drawn (closed) to where it is.
        """
        poses = np.empty((len(self.links), 4, 4))
        for i, link in enumerate(self.links):
            if link.joint is None:
                poses[i] = np.eye(4)
            else:
                poses[i] = arithmetic.product(poses[link.parent], joint_motion(link.joint, openness))
        return poses

    def bounds(self, openness: float = 0.0) -> F64:
        """(2, 3) least and greatest corner of the visible mesh in the asset frame at an openness."""
        return self._closed_bounds.copy() if openness == 0.0 else self.box_at(self.link_poses(openness))

    def box_at(self, link_poses: F64) -> F64:
        """(2, 3) least and greatest corner of the visible mesh with the links at (links, 4, 4) poses."""
        low, high = [math.inf] * 3, [-math.inf] * 3
        for (x, y, z), pose in zip(self._link_vertices, link_poses.tolist(), strict=True):
            for axis in range(3) if len(x) else ():
                a, b, c, shift = pose[axis]
                along = a * x + b * y + c * z
                low[axis] = min(low[axis], along.min().item() + shift)
                high[axis] = max(high[axis], along.max().item() + shift)
        return np.array([low, high])

    def vertices_at(self, link_poses: F64) -> F64:
        """(n, 3) vertices of the visible mesh with the links at (links, 4, 4) poses."""
        links = zip(self._link_vertices, link_poses, strict=True)
        return np.concatenate([arithmetic.moved(vertices.T, pose) for vertices, pose in links])

    @cached_property
    def _closed_bounds(self) -> F64:
        return self.box_at(self.link_poses(0.0))

    @cached_property
    def _link_vertices(self) -> list[F64]:
        """(3, n) vertices of all surfaces of each link: what is asked for most often is where they are."""
        empty = np.empty((0, 3))
        parts = [[surface.vertices for surface in link.surfaces] for link in self.links]
        return [np.ascontiguousarray(np.concatenate([empty, *vertices]).T) for vertices in parts]

    @property
    def triangle_count(self) -> int:
        """Number of triangles in all links."""
        return sum(len(surface.faces) for link in self.links for surface in link.surfaces)


def joint_motion(joint: Joint, openness: float) -> F64:
    """4x4 motion of a joint at an openness, in the asset frame (Rodrigues' formula for revolute joints)."""
    axis = np.asarray(joint.axis, dtype=np.float64)
    motion = np.eye(4)
    amount = joint.upper * openness
    if joint.kind == "prismatic":
        motion[:3, 3] = axis * amount
        return motion
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = arithmetic.sin_cos(amount)
    rotation = np.eye(3) + sine * cross + (1.0 - cosine) * arithmetic.product(cross, cross)
    origin = np.asarray(joint.origin, dtype=np.float64)
    motion[:3, :3] = rotation
    motion[:3, 3] = origin - arithmetic.turned(origin, rotation)
    return motion
