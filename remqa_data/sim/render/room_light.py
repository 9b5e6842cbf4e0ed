"""The indirect light of a room: baked once, from the building and from what stands fixed in it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from remqa_data.assets import build
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F32, F64, Vec3
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.light.bake import Lamps
from remqa_data.sim.light.cache import bake_once
from remqa_data.sim.light.volume import Volume
from remqa_data.sim.light.voxels import Faces
from remqa_data.sim.render.mipmap import SIZE_BITS
from remqa_data.sim.render.raster import Geometry, place_part
from remqa_data.sim.render.renderer import AMBIENT, RenderPart, empty_placed, room_lights
from remqa_data.sim.render.scene_arrays import build_geometry, build_materials, structure_surfaces

LEAST_GLOW = 0.5
"""What glows less is only drawn brighter than it is, such as the liner of a fridge, and lights nothing."""
LEVEL = AMBIENT
"""Mean indirect light; what a room without baked light has, which is brighter from above and below."""
BALANCE = 0.75
"""Share of the common colour of a room's light that is taken away."""
EXPOSURE = 1.3
"""Indirect light is shown so many times brighter than its mean asks for, and what is dark by more: answers lie in shade."""


def room_light(scene: Scene) -> Volume:
    """The indirect light of a room, whatever lies about in it and whether anything is open.

    Baking takes a second or two; it is kept on disk, and the last rooms in memory, so that other configurations of a room
    cost nothing.
    """
    return _baked(static_scene(scene))


def static_scene(scene: Scene) -> Scene:
    """The room with only what stands fixed in it, all closed."""
    fixed = (replace(o, openness=0.0, parents=()) for o in scene.objects if o.is_fixed)
    return scene.with_objects(tuple(fixed))


@lru_cache(maxsize=4)
def _baked(scene: Scene) -> Volume:
    return _exposed(_balanced(bake_once(*_asked(scene))))


def _asked(scene: Scene) -> tuple[Faces, Lamps, Vec3, Vec3, float]:
    """What `bake` is told of a room."""
    x0, y0, x1, y1 = scene.bounds
    lights = room_lights(scene.lights)
    lamps = Lamps(lights.positions, lights.strength, lights.reach_m)
    return static_faces(scene), lamps, (x0, y0, scene.floor_z), (x1, y1, scene.floor_z + scene.height), LEVEL


def _balanced(volume: Volume) -> Volume:
    """The same with most of the colour that all light in the room has taken away, as a camera does and an eye.

    A blue fridge stays blue among yellow walls; what one wall throws on another stays coloured.
    """
    means = volume.light[volume.is_valid].mean(axis=(0, 1), dtype=np.float64)
    share = arithmetic.snapped(means.mean() / np.maximum(means, 1e-9))
    volume.light[:] *= (1.0 + BALANCE * (share - 1.0)).astype(np.float32)
    return volume


def _exposed(volume: Volume) -> Volume:
    """The same, brighter, with the square root of how much darker than the mean a place is taken away.

    So the insides of what is opened stand out as well as under even light, while corners still darken.
    """
    light = volume.light
    level = np.maximum((light[..., :1] + light[..., 1:2] + light[..., 2:]) / 3.0, volume.least).astype(np.float64)
    light *= (EXPOSURE / np.sqrt(level / LEVEL)).astype(np.float32)
    return volume._replace(least=volume.least * EXPOSURE / math.sqrt(volume.least / LEVEL))


def static_faces(scene: Scene) -> Faces:
    """Everything in a room that never moves, and the closed doors and drawers."""
    parts, poses = static_parts(scene)
    fronts: list[F64] = []
    for placed in scene.objects:
        moving = len(build(placed.asset).links) - 1
        fronts += [np.zeros(3), *[-_pose(placed)[:3, 1]] * moving]  # the front of an asset is at -y
    building = [np.zeros(3)] * (len(parts) - len(fronts))
    return _faces(build_geometry(parts), poses, np.array(building + fronts), parts)


def static_parts(scene: Scene) -> tuple[list[RenderPart], list[F64]]:
    """The building's parts, then all links of all objects as they are when closed; and their (4, 4) poses."""
    parts = [RenderPart(surfaces, 0) for surfaces in structure_surfaces(scene)]
    poses = [np.eye(4)] * len(parts)
    for placed in scene.objects:
        links = build(placed.asset).links
        parts += [RenderPart(link.surfaces, 0) for link in links]
        poses += [_pose(placed)] * len(links)
    return parts, poses


def _pose(placed: SceneObject) -> F64:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation_of(placed.quaternion), placed.position
    return pose


def _faces(geometry: Geometry, poses: list[F64], fronts: F64, parts: list[RenderPart]) -> Faces:
    placed = empty_placed(geometry)
    for part, pose in enumerate(poses):
        place_part(geometry, placed, part, pose)
    materials, texels = build_materials(parts)
    corners = placed.vertices.T[geometry.faces]
    a, b, c = (corners[:, corner].astype(np.float64) for corner in range(3))
    normals = arithmetic.cross(b - a, c - a)
    lengths = np.sqrt(np.square(normals).sum(axis=1, keepdims=True))
    is_face = lengths[:, 0] > 0
    surface = geometry.face_surface
    part_of = np.repeat(np.arange(len(parts)), np.diff(geometry.part_surface_start))[surface]
    return Faces(
        corners=np.ascontiguousarray(corners[is_face]),
        normals=(normals / np.where(lengths > 0, lengths, 1.0))[is_face].astype(np.float32),
        albedo=(materials.albedo * _mean_colours(materials.texture, texels))[surface][is_face],
        glow=np.where(materials.glow < LEAST_GLOW, np.float32(0.0), materials.glow)[surface][is_face],
        is_open=~geometry.face_of_solid[is_face],
        front=fronts[part_of][is_face].astype(np.float32),
    )


def _mean_colours(texture: np.ndarray, texels: np.ndarray) -> F32:
    """(s, 3) linear mean colour of the texture of each surface: its smallest level, one texel."""
    stride = 2 << (2 * SIZE_BITS)
    packed = texels.reshape(-1, stride)[texture & 0xFFF, 1]
    bytes_ = np.stack([packed & 255, packed >> 8 & 255, packed >> 16 & 255], axis=1)
    return np.square(bytes_ / np.float32(255.0)).astype(np.float32)
