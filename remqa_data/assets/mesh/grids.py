"""Meshes over a grid of points: cushions and cloth."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from remqa_data.assets.mesh.triangles import Mesh, joined
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3


def cushion(size: Vec3, puff: float = 0.35, count: int = 8) -> Mesh:
    """A pillow: a rounded square that is thick in the middle and thin at its seam.

    Parameters
    ----------
    size : (x, y, z)
        The box that it fills.
    puff : float
        Thickness at the seam as a fraction of the middle.
    count : int
        Grid steps a side.
    """
    t = np.linspace(-1, 1, count + 1)
    u, v = np.meshgrid(t, t, indexing="ij")
    height = (1 - np.abs(u) ** 3.0) ** 0.5 * (1 - np.abs(v) ** 3.0) ** 0.5
    height = height * (1 - puff * 0.5) + puff * 0.5 * (height > 0)
    pinch = 1 - 0.06 * (1 - np.abs(u)) * np.abs(v) ** 4
    pinch_v = 1 - 0.06 * (1 - np.abs(v)) * np.abs(u) ** 4
    x, y = u * pinch_v, v * pinch
    return _two_sheets(x, y, height).scaled(np.asarray(size, dtype=np.float64) / 2)


def sheet(x: F64, y: F64, z: F64, thickness: float) -> Mesh:
    """Cloth: a grid of points (rows, columns) with a thickness along z, closed at its rim."""
    rows, columns = x.shape
    top = np.stack([x, y, z + thickness / 2], axis=2)
    du, dv = np.gradient(top, axis=0), np.gradient(top, axis=1)
    normals = arithmetic.cross(du, dv)
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    faces = grid_faces(rows, columns)
    upper = Mesh(top.reshape(-1, 3), normals.reshape(-1, 3), faces)
    lower = Mesh(upper.vertices - [0, 0, thickness], -upper.normals, faces[:, ::-1])
    index = np.arange(rows * columns).reshape(rows, columns)
    rim = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    n = len(rim)
    t, b = upper.vertices[rim], lower.vertices[rim]
    outward = arithmetic.cross(np.roll(t, -1, axis=0) - np.roll(t, 1, axis=0), [0.0, 0.0, 1.0])
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    j = np.arange(n)
    k = (j + 1) % n
    side_faces = np.vstack([np.column_stack([n + j, n + k, k]), np.column_stack([n + j, k, j])])
    side = Mesh(np.vstack([t, b]), np.vstack([outward, outward]), side_faces)
    return joined([upper, lower, side])


def grid_faces(rows: int, columns: int) -> npt.NDArray[np.int64]:
    """Triangles of a rows x columns grid of vertices whose first axis is x and second is y, facing +z."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    b, c, d = a + columns, a + columns + 1, a + 1
    return np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _two_sheets(x: F64, y: F64, z: F64) -> Mesh:
    """Upper sheet at +z and its mirror image at -z over the same grid, sharing the rim's shape."""
    grid = np.stack([x, y, z], axis=2)
    du, dv = np.gradient(grid, axis=0), np.gradient(grid, axis=1)
    normals = arithmetic.cross(du, dv)
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    faces = grid_faces(*x.shape)
    flip = np.array([1.0, 1.0, -1.0])
    upper = Mesh(grid.reshape(-1, 3), normals.reshape(-1, 3), faces)
    lower = Mesh(upper.vertices * flip, upper.normals * flip, faces[:, ::-1])
    return joined([upper, lower])
