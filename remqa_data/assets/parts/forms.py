"""Shapes that furniture, figures and plants share: curves in side view, limbs, leaves, and parts fitted to a box."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh, Points2
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

Part = tuple[Mesh, Material]


def draw_fitted(b: Builder, parts: Sequence[Part], low: Vec3, high: Vec3, *, rooted: bool = False) -> None:
    """Draw parts that were modelled at any size, stretched together so that they fill a box.

    `rooted` keeps x = y = 0 in the middle of the box, by stretching either side on its own: a plant stays in its pot.
    """
    by_material: dict[Material, list[Mesh]] = {}
    for mesh, material in parts:
        by_material.setdefault(material, []).append(Mesh(mesh.vertices, mesh.normals, mesh.faces))
    merged = {material: primitives.joined(meshes) for material, meshes in by_material.items()}
    vertices = np.vstack([mesh.vertices for mesh in merged.values()])
    start, end = vertices.min(axis=0), vertices.max(axis=0)
    target, size = np.asarray(low, float), np.asarray(high, float) - np.asarray(low, float)
    if rooted:
        near, far = size / np.maximum(-2 * start, 1e-9), size / np.maximum(2 * end, 1e-9)
        near[2] = far[2] = size[2] / max(end[2] - start[2], 1e-9)
        start, target = np.array([0.0, 0.0, start[2]]), np.array([*(target + size / 2)[:2], target[2]])
    else:
        near = far = size / np.maximum(end - start, 1e-9)
    for material, mesh in merged.items():
        factors = np.where(mesh.vertices < start, near, far)
        normals = mesh.normals / factors
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        b.add(Mesh((mesh.vertices - start) * factors + target, normals, mesh.faces), material)


def side_cut(outline: Points2, width: float) -> Mesh:
    """A board of a width along x, cut to an outline of (y, z) points."""
    points = np.asarray(outline, float)
    return primitives.prism(np.column_stack([-points[:, 1], points[:, 0]]), width).pointed("x")


def leaning(mesh: Mesh, slope: float) -> Mesh:
    """The mesh sheared towards +y by `slope` metres a metre of height."""
    vertices, normals = mesh.vertices.copy(), mesh.normals.copy()
    vertices[:, 1] += slope * vertices[:, 2]
    normals[:, 2] -= slope * normals[:, 1]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Mesh(vertices, normals, mesh.faces, mesh.uv)


def ring(radius: float, thickness: float, sections: int = 24, sides: int = 8) -> Mesh:
    """A torus about z: the radius of its outer edge and the thickness of its tube."""
    tube = primitives.arc((radius - thickness / 2, 0.0), thickness / 2, -180, 180, sides + 1)
    return primitives.revolve(tube, sections, crease_deg=89)


def limb(start: Vec3, end: Vec3, start_radius: float, end_radius: float, sections: int = 10) -> Mesh:
    """A round limb between two points with round ends."""
    a, z = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(z - a))
    low = primitives.arc((0.0, 0.0), start_radius, -90, 0, 3)
    high = primitives.arc((0.0, length), end_radius, 0, 90, 3)
    profile = np.vstack([low, high])
    profile[[0, -1], 0] = 0.0
    return primitives.revolve(profile, sections, crease_deg=89).turned(towards(z - a)).moved(a)


def towards(direction: Vec3 | F64) -> F64:
    """A rotation that turns +z to a direction."""
    z = np.asarray(direction, float)
    z = z / np.linalg.norm(z)
    x = arithmetic.cross(np.eye(3)[1] if abs(z[1]) < 0.9 else np.eye(3)[0], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, arithmetic.cross(z, x), z])


def bent_panel(path: Points2, widths: Sequence[float], thickness: float, curl: float = 0.0) -> Mesh:
    """A panel along a path of (y, z) points from front to top, its sides curled up: the seat of a moulded chair."""
    points = np.asarray(path, float)
    tangents = np.gradient(points, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    across = np.linspace(-0.5, 0.5, 7)
    u = np.concatenate([across, across[::-1]])
    face = np.repeat([-0.5, 0.5], 7) * thickness
    rings = []
    for point, tangent, width in zip(points, tangents, widths, strict=True):
        v = face - curl * np.abs(2 * u) ** 3
        below = np.array([tangent[1], -tangent[0]])
        rings.append(np.column_stack([u * width, point + v[:, None] * below]))
    return primitives.loft(rings)


def leaf(
    base: Vec3,
    yaw_deg: float,
    pitch_deg: float,
    length: float,
    width: float,
    droop_deg: float = 40.0,
    widest: float = 0.45,
    steps: int = 4,
) -> Mesh:
    """A blade that grows from a base point, folded along its spine and drooping towards its tip: one open sheet."""
    t = np.linspace(0, 1, steps + 1)
    pitch = np.radians(pitch_deg - droop_deg * t)
    yaw = np.radians(yaw_deg)
    out = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    side = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    directions = np.cos(pitch)[:, None] * out + np.sin(pitch)[:, None] * [0.0, 0.0, 1.0]
    spine = np.asarray(base, float) + np.vstack([np.zeros(3), np.cumsum(directions[1:] * length / steps, axis=0)])
    swell = np.where(t < widest, t / widest, (1 - t) / (1 - widest))
    half = width / 2 * np.maximum(np.sin(swell * np.pi / 2), 0.06)
    up = arithmetic.cross(directions, side)
    edge = half[:, None] * side
    rise = 0.35 * half[:, None] * up
    grid = np.stack([spine - edge + rise, spine, spine + edge + rise], axis=1)
    normals = arithmetic.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1)).reshape(-1, 3)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    faces = primitives.grid_faces(steps + 1, 3)
    return Mesh(grid.reshape(-1, 3), normals, faces)
