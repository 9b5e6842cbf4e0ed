"""From a drawing to an asset: fitted to the asked box, origin at its centre, with texture coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from operator import itemgetter

import numpy as np

from remqa_data.assets.core.model import CollisionBox, Joint, Link, Material, Surface
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Axis, Mesh
from remqa_data.errors import AssetError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of, snapped_quaternion
from remqa_data.geometry.types import F64, Box, Vec3


class DraftLink:
    """A link while it is being drawn: meshes with their material and the direction of the grain, and collision boxes."""

    def __init__(self, name: str, parent: int, joint: Joint | None) -> None:
        self.name, self.parent, self.joint = name, parent, joint
        self.meshes: list[tuple[Mesh, Material, Axis | None]] = []
        self.boxes: list[tuple[F64, F64, tuple[float, float, float, float]]] = []


class Fit:
    """The affine map from drawing coordinates to the asset frame."""

    def __init__(self, scale: F64, centre: F64) -> None:
        self.scale, self.centre = scale, centre

    def point(self, at: Vec3 | F64) -> F64:
        """A point in the asset frame, snapped."""
        return arithmetic.snapped((np.asarray(at, float) - self.centre) * self.scale)

    def box(self, box: Box) -> Box:
        """A box in the asset frame."""
        return box_of((*self.point(box[:3]), *self.point(box[3:])))

    def link(self, draft: DraftLink) -> Link:
        """A link in the asset frame, its meshes joined by material."""
        joint = draft.joint
        if joint is not None:
            along = float(arithmetic.dot(np.abs(joint.axis), self.scale))
            upper = joint.upper * along if joint.kind == "prismatic" else joint.upper
            joint = Joint(joint.kind, joint.axis, vec(self.point(joint.origin)), float(arithmetic.snapped(upper)))
        by_material: dict[Material, list[tuple[Mesh, Axis | None]]] = {}
        for mesh, material, grain in draft.meshes:
            by_material.setdefault(material, []).append((mesh, grain))
        surfaces = tuple(self._surface(material, meshes) for material, meshes in by_material.items())
        boxes = tuple(self.collision_box(*box) for box in draft.boxes)
        return Link(draft.name, draft.parent, joint, surfaces, boxes)

    def _surface(self, material: Material, meshes: Sequence[tuple[Mesh, Axis | None]]) -> Surface:
        """What is drawn in a material; joined before it is fitted, as far as the grain runs one way: it takes fewer steps."""
        fitted = []
        for grain, alike in groupby(meshes, itemgetter(1)):
            drawn = primitives.joined([mesh for mesh, _ in alike])
            fitted.append(with_uv(drawn.moved(-self.centre).scaled(self.scale), material, grain))
        return surface(primitives.joined(fitted), material)

    def collision_box(self, at: F64, size: F64, quaternion: tuple[float, float, float, float]) -> CollisionBox:
        """A collision box in the asset frame."""
        snapped = snapped_quaternion(quaternion)
        stretch = arithmetic.length((self.scale[:, None] * rotation_of(snapped)).T)
        full = arithmetic.snapped(np.maximum(size * stretch, 1e-4))
        return CollisionBox(vec(self.point(at)), vec(full), snapped)


def with_uv(mesh: Mesh, material: Material, grain: Axis | None) -> Mesh:
    """Give a mesh the texture coordinates its material asks for: its own, or a projection along each face's main axis.

    Here the drawing ends, and the mesh is snapped: before the main axis is chosen, because a face may lie between two.
    """
    mesh = mesh.snapped()
    if material.texture is None:
        return Mesh(mesh.vertices, mesh.normals, mesh.faces, np.zeros((len(mesh.vertices), 2)))
    if material.repeat_m is None:
        return mesh
    corners = mesh.vertices[mesh.faces]
    normal = arithmetic.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    main = np.abs(normal).argmax(axis=1)
    keys = mesh.faces * 3 + main[:, None]
    is_used = np.zeros(3 * len(mesh.vertices), dtype=np.bool_)
    is_used[keys] = True
    unique, faces = np.flatnonzero(is_used), (np.cumsum(is_used) - 1)[keys]  # without sorting, as np.unique does
    source, axis = unique // 3, unique % 3
    points = mesh.vertices[source]
    first, second = _PLANE_AXES[:, 0][axis], _PLANE_AXES[:, 1][axis]
    if grain is not None:  # the grain runs along u
        g = "xyz".index(grain[-1])
        swap = second == g
        first, second = np.where(swap, second, first), np.where(swap, first, second)
    rows = np.arange(len(points))
    uv = np.column_stack([points[rows, first], -points[rows, second]]) / material.repeat_m
    return Mesh(points, mesh.normals[source], faces, uv)


_PLANE_AXES = np.array([[1, 2], [0, 2], [0, 1]])


def surface(mesh: Mesh, material: Material) -> Surface:
    """A mesh as single-precision arrays."""
    if mesh.uv is None:
        raise AssetError(f"texture {material.texture!r} is stretched over a mesh without texture coordinates")
    return Surface(
        np.ascontiguousarray(mesh.vertices, dtype=np.float32),
        np.ascontiguousarray(mesh.normals, dtype=np.float32),
        np.ascontiguousarray(mesh.uv, dtype=np.float32),
        np.ascontiguousarray(mesh.faces, dtype=np.int32),
        material,
    )


def largest_material(links: Sequence[Link]) -> Material:
    """The material of the largest surface."""
    area: dict[Material, float] = {}
    for link in links:
        for surface in link.surfaces:
            a, b, c = (surface.vertices[surface.faces[:, i]] for i in range(3))
            total = float(arithmetic.length(arithmetic.cross(b - a, c - a)).sum())
            area[surface.material] = area.get(surface.material, 0.0) + total
    return max(area, key=lambda material: area[material])


def vec(values: F64) -> Vec3:
    """Three numbers as a tuple of floats."""
    return float(values[0]), float(values[1]), float(values[2])


def box_of(values: Iterable[float]) -> Box:
    """Six numbers as a box."""
    x0, y0, z0, x1, y1, z1 = (float(v) for v in values)
    return x0, y0, z0, x1, y1, z1
