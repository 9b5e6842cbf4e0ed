"""Depth and instance images from Intel Embree, a ray tracer: the oracle of these tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

from remqa_data.sim.render.camera import NEAR_M, AnyCamera
from remqa_data.sim.render.renderer import Frame, RenderPart


@dataclass(frozen=True)
class Agreement:
    """How two renderings of one view compare."""

    other_instance: float
    """Share of pixels that show another instance."""
    depth_error_p999_m: float
    """99.9th percentile of the difference in depth, where the instances agree."""


def trace(
    parts: Sequence[RenderPart], poses: npt.NDArray[np.float64], camera: AnyCamera
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """Depth (0 where nothing is) and instances (-1 where nothing is): one ray through the centre of every pixel."""
    triangles, instances = world_triangles(parts, poses)
    scene = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(scene, triangles)
    view = camera.view()
    origins, directions = _rays(camera)
    hit = scene.run(origins, directions, output=True)
    del mesh
    is_hit = hit["primID"] >= 0
    depth = np.where(is_hit, hit["tfar"] + NEAR_M, 0.0).astype(np.float32)
    ids = np.where(is_hit, instances[np.where(is_hit, hit["primID"], 0)], -1).astype(np.int32)
    shape = (view.height, view.width)
    return depth.reshape(shape), ids.reshape(shape)


def world_triangles(
    parts: Sequence[RenderPart], poses: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """(m, 3, 3) triangles in the world and (m,) the instance of each."""
    triangles, instances = [], []
    for part, pose in zip(parts, poses, strict=True):
        for surface in part.surfaces:
            world = surface.vertices.astype(np.float64) @ pose[:3, :3].T + pose[:3, 3]
            triangles.append(world[surface.faces])
            instances.append(np.full(len(surface.faces), part.instance))
    return np.concatenate(triangles).astype(np.float32), np.concatenate(instances).astype(np.int32)


def compare(frame: Frame, depth: npt.NDArray[np.float32], instances: npt.NDArray[np.int32]) -> Agreement:
    """Our frame against the oracle's images."""
    same = frame.instances == instances
    error = np.abs(frame.depth - depth)[same]
    return Agreement(float((~same).mean()), float(np.quantile(error, 0.999)) if error.size else 0.0)


def _rays(camera: AnyCamera) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Origins on the near plane, and directions that go one metre of depth per unit."""
    view = camera.view()
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    image = np.stack([x - view.width / 2, y - view.height / 2, np.ones_like(x)], axis=-1).reshape(-1, 3)
    if view.pinhole:
        directions = image @ view.inverse.T
        origins = view.eye + NEAR_M * directions
    else:
        directions = np.tile(view.inverse[:, 2], (len(image), 1))
        origins = view.eye + image[:, :2] @ view.inverse[:, :2].T + NEAR_M * directions
    return origins.astype(np.float32), directions.astype(np.float32)
