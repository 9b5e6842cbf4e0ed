"""Triangle meshes as plain arrays, and how they are moved, turned and joined. All sizes in metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

Axis = Literal["x", "y", "z", "-x", "-y", "-z"]

AXES: dict[str, F64] = {
    "x": np.array([1.0, 0.0, 0.0]),
    "y": np.array([0.0, 1.0, 0.0]),
    "z": np.array([0.0, 0.0, 1.0]),
    "-x": np.array([-1.0, 0.0, 0.0]),
    "-y": np.array([0.0, -1.0, 0.0]),
    "-z": np.array([0.0, 0.0, -1.0]),
}


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices (n, 3), unit normals (n, 3), faces (m, 3), and texture coordinates (n, 2) where a shape has its own."""

    vertices: F64
    normals: F64
    faces: npt.NDArray[np.int64]
    uv: F64 | None = None

    def moved(self, offset: Vec3 | F64) -> Mesh:
        """The mesh shifted by an offset in metres."""
        return Mesh(self.vertices + np.asarray(offset, dtype=np.float64), self.normals, self.faces, self.uv)

    def turned(self, rotation: F64) -> Mesh:
        """The mesh rotated about the origin by a 3x3 matrix."""
        return Mesh(
            arithmetic.turned(self.vertices, rotation), arithmetic.turned(self.normals, rotation), self.faces, self.uv
        )

    def scaled(self, factors: Vec3 | F64) -> Mesh:
        """The mesh scaled per axis about the origin; normals follow the inverse transpose."""
        f = np.asarray(factors, dtype=np.float64)
        normals = self.normals / f
        normals /= np.maximum(arithmetic.length(normals)[:, None], 1e-12)
        return Mesh(self.vertices * f, normals, self.faces, self.uv)

    def snapped(self) -> Mesh:
        """The mesh with every number snapped, so that what was drawn with sines and roots is the same mesh everywhere."""
        uv = None if self.uv is None else arithmetic.snapped(self.uv)
        return Mesh(arithmetic.snapped(self.vertices), arithmetic.snapped(self.normals), self.faces, uv)

    def pointed(self, axis: Axis) -> Mesh:
        """The mesh turned so that what pointed along +z points along an axis."""
        return self if axis == "z" else self.turned(_Z_TO[axis])


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """One mesh from several; texture coordinates survive only if all have them."""
    if len(meshes) == 1:
        return meshes[0]
    offsets = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    uvs = [mesh.uv for mesh in meshes if mesh.uv is not None]
    return Mesh(
        np.vstack([mesh.vertices for mesh in meshes]),
        np.vstack([mesh.normals for mesh in meshes]),
        np.vstack([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=False)]),
        np.vstack(uvs) if len(uvs) == len(meshes) else None,
    )


def turn(axis: Axis, degrees: float) -> F64:
    """Rotation matrix of a right-handed turn about an axis."""
    x, y, z = AXES[axis]
    sine, cosine = arithmetic.sin_cos_deg(degrees)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + sine * cross + (1.0 - cosine) * arithmetic.product(cross, cross))


_Z_TO: dict[str, F64] = {
    "x": turn("y", 90),
    "-x": turn("y", -90),
    "y": turn("x", -90),
    "-y": turn("x", 90),
    "-z": turn("x", 180),
    "z": np.eye(3),
}
