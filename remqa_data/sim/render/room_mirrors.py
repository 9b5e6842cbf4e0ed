"""The maps of a room's mirrors: pictures taken once, of the building and of what stands fixed in it, all closed.

A mirror shows nothing that moves or opens. So it can never show an answer, and ids of pixels need not know of mirrors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from remqa_data.assets import build
from remqa_data.assets.core.model import Surface
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F32, F64
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.render.camera import View
from remqa_data.sim.render.mirrors import SIDES, Mirrors, side_views
from remqa_data.sim.render.renderer import Renderer, RenderPart
from remqa_data.sim.render.room_light import room_light, static_parts, static_scene

SIZE_PX = 256
"""Of each picture of a map: as sharp as a picture of 300 pixels and 90 degrees."""
BEFORE_M = 0.03
"""How far before the mirror its map is taken: farther out than its frame."""


@dataclass(frozen=True, eq=False)
class RoomMirrors:
    """Maps of a room, see `remqa_data.sim.render.mirrors.Mirrors`."""

    objects: tuple[str, ...]
    """Ids of the k objects that have a mirror."""
    frames: F32
    texels: F32


def room_mirrors(scene: Scene) -> RoomMirrors:
    """The maps of a room's mirrors, whatever lies about in it and whether anything is open.

    The last rooms are kept, so that other configurations of a room cost nothing. A room without mirrors costs nothing.
    """
    return _taken(static_scene(scene))


def mirrors_of(room: RoomMirrors, parts: Sequence[RenderPart], bases: Mapping[str, int]) -> Mirrors:
    """The maps as a renderer reads them that draws `parts`; `bases` says which part is the fixed link of an object."""
    number = {bases[object_id]: i for i, object_id in enumerate(room.objects)}
    surfaces = [
        number.get(part, -1) if surface.material.mirror > 0 else -1
        for part, drawn in enumerate(parts)
        for surface in drawn.surfaces
    ]
    return Mirrors(np.array(surfaces, dtype=np.int32), room.frames, room.texels)


@lru_cache(maxsize=4)
def _taken(scene: Scene) -> RoomMirrors:
    frames = {placed.id: frame for placed in scene.objects if (frame := _mirror_frame(placed)) is not None}
    stacked = np.array(list(frames.values()), dtype=np.float32).reshape(-1, 4, 3)
    if not frames:
        return RoomMirrors((), stacked, np.zeros((0, SIDES, 1, 1, 4), dtype=np.float32))
    parts, poses = static_parts(scene)
    renderer = Renderer(parts, poses, lights=scene.lights, volume=room_light(scene))
    texels = np.stack([_map(renderer, frame) for frame in stacked.astype(np.float64)])
    return RoomMirrors(tuple(frames), stacked, texels)


@dataclass(frozen=True)
class _Taken:
    """A camera that is known by its view."""

    seen: View

    def view(self) -> View:
        return self.seen


def _map(renderer: Renderer, frame: F64) -> F32:
    """(5, n, n, 4) pictures around a mirror."""
    texels = np.zeros((SIDES, SIZE_PX, SIZE_PX, 4), dtype=np.float32)
    for texel, view in zip(texels, side_views(frame, SIZE_PX), strict=True):
        frame_ = renderer.render(_Taken(view))
        texel[..., :3] = np.square(frame_.rgb / np.float32(255.0))
        np.divide(np.float32(1.0), frame_.depth, out=texel[..., 3], where=frame_.depth > 0)
    return texels


def _mirror_frame(placed: SceneObject) -> F64 | None:
    """(4, 3) where the map of an object's mirror is taken, as in `Mirrors`; None if it has none in its fixed link."""
    mirrors = [s for s in build(placed.asset).links[0].surfaces if s.material.mirror > 0]
    if not mirrors:
        return None
    rotation = rotation_of(placed.quaternion)
    middle, normal = _middle_and_normal(mirrors[0])
    ahead = (rotation * normal).sum(axis=1)
    point = (rotation * middle).sum(axis=1) + np.array(placed.position) + BEFORE_M * ahead
    upright = np.array([0.0, 0.0, 1.0]) if abs(ahead[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = arithmetic.cross(ahead, upright)
    right /= np.sqrt(np.square(right).sum())
    return np.stack([right, arithmetic.cross(right, ahead), ahead, point])


def _middle_and_normal(surface: Surface) -> tuple[F64, F64]:
    vertices = surface.vertices.astype(np.float64)
    normal = surface.normals[0].astype(np.float64)
    return (vertices.min(axis=0) + vertices.max(axis=0)) / 2, normal / np.sqrt(np.square(normal).sum())
