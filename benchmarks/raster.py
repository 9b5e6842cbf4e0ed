"""Milliseconds per frame: our renderer, PyBullet's TinyRenderer and Embree, on the same meshes from the same cameras.

Embree traces depth and instances only; the others also draw colours. Run it alone on an idle machine:
`python benchmarks/raster.py`. The figures are printed and stored in out/benchmarks/raster.json.
"""

from __future__ import annotations

import json
import math
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
from rich.console import Console
from rich.table import Table

from remqa_data.assets.model import F64, Material, Surface, Vec3
from remqa_data.sim.camera import NEAR_M, Camera
from remqa_data.sim.renderer import Part, Renderer

OUTPUT = Path("out/benchmarks/raster.json")
POSES = 50


@dataclass(frozen=True, eq=False)
class BenchmarkScene:
    """What is drawn, and from where."""

    name: str
    parts: Sequence[Part]
    poses: F64
    lights: Sequence[Vec3]
    cameras: Sequence[Camera]

    @property
    def triangles(self) -> int:
        """Number of triangles in all parts."""
        return sum(len(surface.faces) for part in self.parts for surface in part.surfaces)


@dataclass(frozen=True)
class Timing:
    """Time per frame of one renderer."""

    renderer: str
    median_ms: float
    least_ms: float
    greatest_ms: float


def main() -> None:
    """Measure the synthetic room, print a table and store the figures."""
    report(synthetic_scene(), OUTPUT)


def report(scene: BenchmarkScene, output: Path) -> list[Timing]:
    """Measure a scene with every renderer, print a table and store the figures as JSON."""
    timings = [*our_timings(scene), *bullet_timings(scene), *embree_timings(scene)]
    table = Table(title=f"{scene.name}: {len(scene.parts)} parts, {scene.triangles} triangles, ms per 300 x 300 frame")
    for heading in ("renderer", "median", "least", "greatest"):
        table.add_column(heading, justify="left" if heading == "renderer" else "right")
    for timing in timings:
        figures = (timing.median_ms, timing.least_ms, timing.greatest_ms)
        table.add_row(timing.renderer, *(f"{figure:.2f}" for figure in figures))
    Console().print(table)
    output.parent.mkdir(parents=True, exist_ok=True)
    facts = {"scene": scene.name, "parts": len(scene.parts), "triangles": scene.triangles, "cpu": platform.processor()}
    output.write_text(json.dumps({**facts, "timings": [asdict(timing) for timing in timings]}, indent=2) + "\n")
    return timings


def our_timings(scene: BenchmarkScene) -> list[Timing]:
    """Our renderer in four ways."""
    renderer = Renderer(scene.parts, scene.poses, lights=scene.lights)
    nudge = np.array(scene.poses[-1])

    def draw_after_a_move(camera: Camera) -> None:
        nudge[0, 3] += 1e-4
        renderer.set_pose(len(scene.parts) - 1, nudge)
        renderer.render(camera, antialias=False)

    draws: dict[str, Callable[[Camera], object]] = {
        "ours, no shadows": lambda camera: renderer.render(camera, shadows=False, antialias=False),
        "ours, shadows": lambda camera: renderer.render(camera, antialias=False),
        "ours, shadows, antialiased": lambda camera: renderer.render(camera),
        "ours, shadows, a part moves before every frame": draw_after_a_move,
    }
    return [time_frames(name, draw, scene.cameras) for name, draw in draws.items()]


def bullet_timings(scene: BenchmarkScene) -> list[Timing]:
    """PyBullet's software renderer, without and with shadows."""
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    for part, pose in zip(scene.parts, scene.poses, strict=True):
        for surface in part.surfaces:
            _add_to_bullet(pybullet, client, surface, pose)

    def draw(camera: Camera, shadow: bool) -> None:
        eye = np.array(camera.position)
        _, up, forward = camera.rotation()
        pybullet.getCameraImage(
            camera.width,
            camera.height,
            viewMatrix=pybullet.computeViewMatrix(eye.tolist(), (eye + forward).tolist(), up.tolist()),
            projectionMatrix=pybullet.computeProjectionMatrixFOV(
                camera.fov_deg, camera.width / camera.height, NEAR_M, 20
            ),
            shadow=shadow,
            lightDirection=[0.3, 0.2, 1.0],
            renderer=pybullet.ER_TINY_RENDERER,
            physicsClientId=client,
        )

    timings = [
        time_frames("PyBullet TinyRenderer, no shadows", lambda camera: draw(camera, False), scene.cameras),
        time_frames("PyBullet TinyRenderer, shadows", lambda camera: draw(camera, True), scene.cameras),
    ]
    pybullet.disconnect(client)
    return timings


def embree_timings(scene: BenchmarkScene) -> list[Timing]:
    """Embree: one ray a pixel, depth and instances."""
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    triangles, instances = [], []
    for part, pose in zip(scene.parts, scene.poses, strict=True):
        for surface in part.surfaces:
            world = surface.vertices.astype(np.float64) @ pose[:3, :3].T + pose[:3, 3]
            triangles.append(world[surface.faces].astype(np.float32))
            instances.append(np.full(len(surface.faces), part.instance, dtype=np.int32))
    embree = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(embree, np.concatenate(triangles))
    instance = np.concatenate(instances)

    def draw(camera: Camera) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        directions = camera.unproject(np.ones((camera.height, camera.width))).reshape(-1, 3) - camera.position
        origins = np.tile(np.array(camera.position, dtype=np.float32), (len(directions), 1))
        hit = embree.run(origins, directions.astype(np.float32), output=True)
        return hit["tfar"], np.where(hit["primID"] >= 0, instance[hit["primID"]], -1)

    timing = time_frames("Embree, depth and instances only", draw, scene.cameras)
    del mesh
    return [timing]


def time_frames(name: str, draw: Callable[[Camera], object], cameras: Sequence[Camera]) -> Timing:
    """Time `draw` from every camera, after one frame to warm up."""
    draw(cameras[0])
    times = []
    for camera in cameras:
        start = time.perf_counter()
        draw(camera)
        times.append((time.perf_counter() - start) * 1e3)
    return Timing(name, float(np.median(times)), min(times), max(times))


def synthetic_scene(objects: int = 90, seed: int = 0) -> BenchmarkScene:
    """A furnished room of about 80,000 triangles."""
    rng = np.random.default_rng(seed)
    width, depth, height = 5.0, 4.0, 2.6
    wood = Material("wooden", "brown", (0.72, 0.5, 0.32), "planks", 1.5, 0.2)
    parts = [Part((_shell(width, depth, height, wood),), 0)]
    poses = [np.eye(4)]
    for instance in range(1, objects + 1):
        rgb: Vec3 = (float(rng.uniform(0.2, 0.95)), float(rng.uniform(0.2, 0.95)), float(rng.uniform(0.2, 0.95)))
        material = replace(wood, rgb=rgb, gloss=0.4, texture="wood" if instance % 2 else None)
        x, y = rng.uniform(0.4, width - 0.4), rng.uniform(0.4, depth - 0.4)
        if instance <= 12:
            size = rng.uniform((0.4, 0.4, 0.4), (1.0, 0.7, 1.3))
            mesh, z = trimesh.creation.box(extents=size), size[2] / 2 + 0.001
        elif instance % 3 == 0:
            mesh, z = trimesh.creation.icosphere(3, rng.uniform(0.04, 0.12)), rng.uniform(0.1, 1.4)
        elif instance % 3 == 1:
            mesh, z = trimesh.creation.cylinder(rng.uniform(0.03, 0.08), 0.15, sections=64), rng.uniform(0.1, 1.4)
        else:
            mesh, z = trimesh.creation.torus(0.08, 0.025, 40, 24), rng.uniform(0.1, 1.4)
        pose = np.eye(4)
        pose[:3, 3] = x, y, z
        parts.append(Part((_surface(mesh, material),), instance))
        poses.append(pose)
    cameras = [
        Camera(
            (float(rng.uniform(0.5, width - 0.5)), float(rng.uniform(0.5, depth - 0.5)), 1.576),
            yaw_deg=float(rng.integers(4) * 90),
            horizon_deg=float(rng.choice([0, 30])),
        )
        for _ in range(POSES)
    ]
    return BenchmarkScene("synthetic room", parts, np.stack(poses), [(width / 2, depth / 2, height - 0.1)], cameras)


def _surface(mesh: trimesh.Trimesh, material: Material) -> Surface:
    """Vertices of a trimesh with smooth normals, and a texture wrapped around its vertical axis."""
    vertices = np.asarray(mesh.vertices)
    around = np.arctan2(vertices[:, 1], vertices[:, 0]) / (2 * math.pi)
    return Surface(
        vertices.astype(np.float32),
        np.asarray(mesh.vertex_normals, dtype=np.float32),
        np.column_stack([around, vertices[:, 2]]).astype(np.float32),
        np.asarray(mesh.faces, dtype=np.int32),
        material,
    )


def _shell(width: float, depth: float, height: float, material: Material) -> Surface:
    """Floor, ceiling and walls seen from inside."""
    box = trimesh.creation.box(extents=(width, depth, height))
    box.apply_translation((width / 2, depth / 2, height / 2))
    corners = box.triangles[:, ::-1].reshape(-1, 3)
    normals = np.repeat(-box.face_normals, 3, axis=0)
    flat = np.abs(normals).argmax(axis=1)
    uv = np.stack([corners[np.arange(len(corners)), (flat + k) % 3] for k in (1, 2)], axis=1)
    return Surface(
        corners.astype(np.float32),
        normals.astype(np.float32),
        uv.astype(np.float32),
        np.arange(len(corners), dtype=np.int32).reshape(-1, 3),
        material,
    )


def _add_to_bullet(pybullet: Any, client: int, surface: Surface, pose: F64) -> None:
    shape = pybullet.createVisualShape(
        pybullet.GEOM_MESH,
        vertices=surface.vertices.tolist(),
        indices=surface.faces.ravel().tolist(),
        normals=surface.normals.tolist(),
        uvs=surface.uv.tolist(),
        rgbaColor=[*surface.material.rgb, 1.0],
        physicsClientId=client,
    )
    matrix = np.eye(4)
    matrix[:3, :3] = pose[:3, :3]
    w, x, y, z = trimesh.transformations.quaternion_from_matrix(matrix)
    pybullet.createMultiBody(
        baseVisualShapeIndex=shape,
        basePosition=pose[:3, 3].tolist(),
        baseOrientation=[x, y, z, w],
        physicsClientId=client,
    )


if __name__ == "__main__":
    main()
