"""Milliseconds per frame: our renderer, PyBullet's TinyRenderer and Embree, on the same meshes from the same cameras.

Embree traces depth and instances only; the others also draw colours. `python benchmarks/raster.py`, on an idle machine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
from measure import Benchmark, Facts, Headline, Table, times_ms

from remqa_data.assets.core.model import Surface
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, AgentPose
from remqa_data.sim.physics.bullet import BulletClient, pybullet
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import NEAR_M, Camera
from remqa_data.sim.render.renderer import Renderer, RenderPart
from remqa_data.sim.render.view import world_parts

ROOM, POSES, ROUNDS = "FloorPlan1", 50, 3
PLAIN, SHADOWS, ANTIALIASED = "ours, no shadows", "ours, shadows", "ours, shadows, antialiased"
MOVED = "ours, shadows, a part moves before every frame"
BULLET_PLAIN, BULLET_SHADOWS = "PyBullet TinyRenderer, no shadows", "PyBullet TinyRenderer, shadows"
EMBREE = "Embree, depth and instances only"

Draw = Callable[[Camera], object]


@dataclass(frozen=True, eq=False)
class BenchmarkScene:
    """What is drawn, and from where."""

    name: str
    parts: Sequence[RenderPart]
    poses: F64
    lights: Sequence[Vec3]
    cameras: Sequence[Camera]

    @property
    def triangles(self) -> int:
        """Number of triangles in all parts."""
        return sum(len(surface.faces) for part in self.parts for surface in part.surfaces)


def measure(arguments: list[str]) -> Facts:
    """Milliseconds per frame of a kitchen with every renderer, and what antialiasing adds to a frame."""
    scene = room(ROOM)
    times = our_times(scene) | bullet_times(scene) | embree_times(scene)
    return {
        "scene": scene.name,
        "parts": len(scene.parts),
        "triangles": scene.triangles,
        "ms": {
            name: {"median": float(np.median(ms)), "least": float(ms.min()), "greatest": float(ms.max())}
            for name, ms in times.items()
        },
        "antialiasing_adds": float(np.median(times[ANTIALIASED] / times[SHADOWS])) - 1,
    }


def table(facts: Facts) -> Table:
    """Milliseconds by renderer."""
    title = f"ms per 300 x 300 frame of {facts['scene']}, {facts['parts']} parts, {facts['triangles']:,} triangles"
    rows = [(name, *(f"{ms[key]:.2f}" for key in ("median", "least", "greatest"))) for name, ms in facts["ms"].items()]
    return Table(title, ("renderer", "median", "least", "greatest"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """Our frames beside those of the others."""
    median = {name: ms["median"] for name, ms in facts["ms"].items()}
    return [
        Headline("frame of a kitchen, shadows", median[SHADOWS], "ms", at_most=6),
        Headline("the same, antialiased", median[ANTIALIASED], "ms", at_most=9),
        Headline("antialiasing adds, median over poses", 100 * facts["antialiasing_adds"], "%", at_most=60),
        Headline("TinyRenderer, no shadows", median[BULLET_PLAIN] / median[PLAIN], "x our time", at_least=6),
        Headline("TinyRenderer, shadows", median[BULLET_SHADOWS] / median[SHADOWS], "x our time", at_least=12),
        Headline("Embree, without colours", median[EMBREE] / median[SHADOWS], "x our time"),
    ]


def our_times(scene: BenchmarkScene) -> dict[str, F64]:
    """Our renderer in four ways."""
    renderer = Renderer(scene.parts, scene.poses, lights=scene.lights)
    nudge = np.array(scene.poses[-1])

    def draw_after_a_move(camera: Camera) -> None:
        nudge[0, 3] += 1e-4
        renderer.set_pose(len(scene.parts) - 1, nudge)
        renderer.render(camera, antialias=False)

    draws: dict[str, Draw] = {
        PLAIN: partial(renderer.render, shadows=False, antialias=False),
        SHADOWS: partial(renderer.render, antialias=False),
        ANTIALIASED: renderer.render,
    }
    return frame_times(draws, scene.cameras) | frame_times({MOVED: draw_after_a_move}, scene.cameras)


def bullet_times(scene: BenchmarkScene) -> dict[str, F64]:
    """PyBullet's software renderer, without and with shadows."""
    client = BulletClient()
    for part, pose in zip(scene.parts, scene.poses, strict=True):
        for surface in part.surfaces:
            _add_to_bullet(client, surface, pose)

    def draw(camera: Camera, shadow: bool) -> None:
        eye = np.array(camera.position)
        _, up, forward = camera.rotation()
        client.getCameraImage(
            camera.width,
            camera.height,
            viewMatrix=pybullet.computeViewMatrix(eye.tolist(), (eye + forward).tolist(), up.tolist()),
            projectionMatrix=pybullet.computeProjectionMatrixFOV(
                camera.fov_deg, camera.width / camera.height, NEAR_M, 20
            ),
            shadow=shadow,
            lightDirection=[0.3, 0.2, 1.0],
            renderer=pybullet.ER_TINY_RENDERER,
        )

    draws = {BULLET_PLAIN: partial(draw, shadow=False), BULLET_SHADOWS: partial(draw, shadow=True)}
    times = frame_times(draws, scene.cameras)
    client.close()
    return times


def embree_times(scene: BenchmarkScene) -> dict[str, F64]:
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

    times = frame_times({EMBREE: draw}, scene.cameras)
    del mesh  # Embree only borrows it
    return times


def frame_times(draws: Mapping[str, Draw], cameras: Sequence[Camera]) -> dict[str, F64]:
    """Milliseconds from every camera; from each in all ways in turns, so that they can be compared frame by frame."""
    for draw in draws.values():
        draw(cameras[0])  # compiles, and draws maps and textures
    medians = []
    for camera in cameras:
        turns = [times_ms(partial(draw, camera) for draw in draws.values()) for _ in range(ROUNDS)]
        medians.append(np.median(turns, axis=0))
    return dict(zip(draws, np.transpose(medians), strict=True))


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


def _add_to_bullet(client: BulletClient, surface: Surface, pose: F64) -> None:
    shape = client.createVisualShape(
        pybullet.GEOM_MESH,
        vertices=surface.vertices.tolist(),
        indices=surface.faces.ravel().tolist(),
        normals=surface.normals.tolist(),
        uvs=surface.uv.tolist(),
        rgbaColor=[*surface.material.rgb, 1.0],
    )
    matrix = np.eye(4)
    matrix[:3, :3] = pose[:3, :3]
    w, x, y, z = trimesh.transformations.quaternion_from_matrix(matrix)
    client.createMultiBody(
        baseVisualShapeIndex=shape,
        basePosition=pose[:3, 3].tolist(),
        baseOrientation=[x, y, z, w],
    )


BENCHMARK = Benchmark("raster", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
