"""Small meshes that tests draw."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import trimesh

from remqa_data.assets.core.model import Material, Surface
from remqa_data.geometry.types import Vec3
from remqa_data.sim.render.renderer import RenderPart

GREY = Material("plastic", "gray", (0.6, 0.6, 0.6))


def quad(corner: Vec3, u: Vec3, v: Vec3, material: Material = GREY, repeats: float = 1.0) -> Surface:
    """A parallelogram; texture coordinates run from 0 to `repeats` along u and v."""
    o, a, b = (np.array(edge, dtype=np.float64) for edge in (corner, u, v))
    normal = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * repeats
    return _surface(
        np.array([o, o + a, o + a + b, o + b]), np.tile(normal, (4, 1)), uv, np.array([[0, 1, 2], [0, 2, 3]]), material
    )


def from_trimesh(mesh: trimesh.Trimesh, material: Material = GREY, *, smooth: bool = False) -> Surface:
    """A surface with the faces of a trimesh, flat or smooth."""
    if smooth:
        return _surface(mesh.vertices, mesh.vertex_normals, np.zeros((len(mesh.vertices), 2)), mesh.faces, material)
    count = len(mesh.faces)
    return _surface(
        mesh.triangles.reshape(-1, 3),
        np.repeat(mesh.face_normals, 3, axis=0),
        np.zeros((3 * count, 2)),
        np.arange(3 * count).reshape(-1, 3),
        material,
    )


def box(size: Vec3 = (1.0, 1.0, 1.0), material: Material = GREY) -> Surface:
    """A box around the origin."""
    return from_trimesh(trimesh.creation.box(extents=size), material)


def sphere(radius: float, material: Material = GREY, subdivisions: int = 3) -> Surface:
    """A smooth sphere around the origin."""
    return from_trimesh(trimesh.creation.icosphere(subdivisions, radius), material, smooth=True)


def at(x: float, y: float, z: float, yaw_deg: float = 0.0) -> np.ndarray:
    """Pose of a part."""
    pose = np.eye(4)
    cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    pose[:2, :2] = [[cos, -sin], [sin, cos]]
    pose[:3, 3] = x, y, z
    return pose


def furnished_room(
    seed: int, width: float = 5.0, depth: float = 4.0, height: float = 2.6
) -> tuple[list[RenderPart], np.ndarray]:
    """A room with boxes on the floor and round things in the air, some of them inside the boxes."""
    rng = np.random.default_rng(seed)
    wood = replace(GREY, substance="wooden", rgb=(0.72, 0.5, 0.32), texture="planks", gloss=0.2)
    shell = (
        quad((0, 0, 0), (width, 0, 0), (0, depth, 0), wood, 3.0),
        quad((0, 0, height), (0, depth, 0), (width, 0, 0)),
        quad((width, 0, 0), (-width, 0, 0), (0, 0, height)),
        quad((0, depth, 0), (width, 0, 0), (0, 0, height)),
        quad((0, 0, 0), (0, depth, 0), (0, 0, height)),
        quad((width, depth, 0), (0, -depth, 0), (0, 0, height)),
    )
    parts, poses = [RenderPart(shell, 0)], [np.eye(4)]
    for instance in range(1, 60):
        x, y = rng.uniform(0.4, width - 0.4), rng.uniform(0.4, depth - 0.4)
        rgb = tuple(rng.uniform(0.2, 0.95, 3))
        material = replace(GREY, rgb=rgb, gloss=0.5)
        if instance < 8:
            size = tuple(rng.uniform((0.3, 0.3, 0.3), (0.9, 0.7, 1.2)))
            parts.append(RenderPart((box(size, material),), instance))
            # A little above the floor, so that no two faces lie in one plane, where either may win.
            poses.append(at(x, y, size[2] / 2 + 0.001, rng.uniform(0, 360)))
            continue
        if instance % 3 == 0:
            surface = sphere(rng.uniform(0.03, 0.12), material)
        elif instance % 3 == 1:
            surface = from_trimesh(trimesh.creation.cylinder(rng.uniform(0.02, 0.06), 0.15, sections=32), material)
        else:
            surface = from_trimesh(trimesh.creation.torus(0.07, 0.02, 32, 16), material, smooth=True)
        parts.append(RenderPart((surface,), instance))
        poses.append(at(x, y, rng.uniform(0.2, 1.6), rng.uniform(0, 360)))
    return parts, np.stack(poses)


def cube_corners(size: float) -> np.ndarray:
    """(8, 3) corners of a cube around the origin."""
    return np.array(list(product((-size / 2, size / 2), repeat=3)))


def _surface(
    vertices: np.ndarray, normals: np.ndarray, uv: np.ndarray, faces: np.ndarray, material: Material
) -> Surface:
    return Surface(
        vertices.astype(np.float32), normals.astype(np.float32), uv.astype(np.float32), faces.astype(np.int32), material
    )
