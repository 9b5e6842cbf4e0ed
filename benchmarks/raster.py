"""Milliseconds per frame: our renderer, PyBullet's TinyRenderer and Embree, on the same meshes from the same cameras.

Embree traces depth and instances only; the others also draw colours. Run it alone on an idle machine:
`python benchmarks/raster.py`. The figures are printed and stored in out/benchmarks/raster.json.
"""

from __future__ import annotations

import json
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
from rich.console import Console
from rich.table import Table

from remqa_data.assets.model import F64, Surface, Vec3
from remqa_data.generators.floorplans.ithor import load_scene
from remqa_data.sim.camera import NEAR_M, Camera
from remqa_data.sim.navigation import reachable_grid
from remqa_data.sim.renderer import Part, Renderer
from remqa_data.sim.view import world_parts
from remqa_data.sim.viewpoints import HEADINGS_DEG, AgentPose
from remqa_data.sim.world import World

OUTPUT = Path("out/benchmarks/raster.json")
ROOM, POSES = "FloorPlan1", 50


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
    """Measure a kitchen, print a table and store the figures."""
    report(room(ROOM), OUTPUT)


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
    from remqa_data.sim.bullet import pybullet

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


def room(name: str, seed: int = 0) -> BenchmarkScene:
    """One of the 120 rooms, settled, from poses of the agent spread over its reachable cells."""
    scene = load_scene(name)
    with World(scene) as world:
        world.settle()
        grid = reachable_grid(world)
        parts, poses = world_parts(world)
    rng = np.random.default_rng(seed)
    cells = [grid.cells[int(i)] for i in rng.integers(len(grid.cells), size=POSES)]
    agents = [AgentPose(cell, int(rng.choice(HEADINGS_DEG)), int(rng.choice((0, 30)))) for cell in cells]
    cameras = [agent.camera(grid) for agent in agents]
    return BenchmarkScene(f"{name} ({scene.room_type})", parts, poses, scene.lights, cameras)


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
