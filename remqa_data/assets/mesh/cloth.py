"""Meshes of cloth: a sheet of any shape with a thickness, folds that hang down, and a strip laid over a bar."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.mesh.primitives import Mesh, grid_faces, joined
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64


def slab(grid: F64, thickness: float) -> Mesh:
    """A sheet with a thickness over a grid of points, closed at its rim.

    Parameters
    ----------
    grid : (rows, columns, 3)
        Middle surface in metres. Its front is on the side to which (along the rows) x (along the columns) points.
    thickness : float
        Metres.

    Returns
    -------
    Mesh
        With texture coordinates: u along the rows, v down the columns, 0 to 1 on both sides.
    """
    rows, columns, _ = grid.shape
    normals = arithmetic.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1))
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    offset = normals * thickness / 2
    u, v = np.meshgrid(np.linspace(0, 1, rows), np.linspace(1, 0, columns), indexing="ij")
    uv = np.column_stack([u.ravel(), v.ravel()])
    faces = grid_faces(rows, columns)
    flat = normals.reshape(-1, 3)
    front = Mesh((grid + offset).reshape(-1, 3), flat, faces, uv)
    back = Mesh((grid - offset).reshape(-1, 3), -flat, faces[:, ::-1], uv)
    index = np.arange(rows * columns).reshape(rows, columns)
    rim = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    upper, lower = front.vertices[rim], back.vertices[rim]
    outward = arithmetic.cross(np.roll(upper, -1, axis=0) - np.roll(upper, 1, axis=0), flat[rim])
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    n = len(rim)
    j = np.arange(n)
    k = (j + 1) % n
    side_faces = np.vstack([np.column_stack([n + j, n + k, k]), np.column_stack([n + j, k, j])])
    side = Mesh(np.vstack([upper, lower]), np.vstack([outward, outward]), side_faces, np.vstack([uv[rim], uv[rim]]))
    return joined([front, back, side])


def over_bar(depth: float, height: float, back: float, thickness: float) -> F64:
    """Middle line of a strip laid over a bar: (n, 2) points (y, z) from the hem in front to the hem behind.

    Parameters
    ----------
    depth, height : float
        Box that the strip fills, z from 0.
    back : float
        Height of the back's hem above the front's.
    thickness : float
        Of the cloth.
    """
    radius = (depth - thickness) / 2
    shoulder = height - thickness / 2 - radius
    steps = np.linspace(0.0, 1.0, 6)
    angles = np.linspace(np.pi, 0.0, 5)[1:-1]
    front = np.column_stack([np.full(6, -radius), shoulder * steps])
    top = np.column_stack([radius * np.cos(angles), shoulder + radius * np.sin(angles)])
    behind = np.column_stack([np.full(2, radius), np.linspace(shoulder, back, 2)])
    return np.vstack([front, top, behind])


def hung(
    path: F64,
    top: float,
    width: float,
    folds: float,
    amplitude: float,
    *,
    gather: float = 1.0,
    span: float = 1.0,
    columns: int = 8,
) -> F64:
    """A grid (columns, len(path), 3) of cloth that follows a path of (y, z) points and spreads over a width in x.

    Parameters
    ----------
    top : float
        Height from which the cloth hangs.
    folds : float
        Number of waves over the width.
    amplitude : float
        Depth of the waves at the hem in metres; they fade towards the top.
    gather : float
        Width at the top as a fraction of the width at the hem.
    span : float
        Middle part of the width that is drawn: a narrower strip with the same waves.
    """
    y, z = path[:, 0], path[:, 1]
    fall = np.clip((top - z) / top, 0.0, 1.0)
    across = np.linspace(-0.5, 0.5, columns) * span
    x = across[:, None] * width * (gather + (1.0 - gather) * np.sqrt(fall))
    wave = amplitude * np.sqrt(fall) * np.sin(2 * np.pi * folds * (across[:, None] + 0.13))
    return np.stack([x, y + wave, np.broadcast_to(z, x.shape)], axis=2)
