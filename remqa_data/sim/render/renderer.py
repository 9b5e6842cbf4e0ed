"""Draws the room: colour, depth and instance images from any camera, on one core."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from remqa_data.assets.core.model import Material
from remqa_data.geometry.types import F32, F64, I32, I64, U8, Flags, Vec3
from remqa_data.sim.light.patches import Patches, light_faces, patches
from remqa_data.sim.light.volume import Volume
from remqa_data.sim.render.antialias import smooth_edges
from remqa_data.sim.render.camera import AnyCamera, Scissor, View, Windows, scissor_around
from remqa_data.sim.render.counting import count_in_windows, count_labels, mark_relevant, write_labels
from remqa_data.sim.render.mirrors import Mirrors, no_mirrors
from remqa_data.sim.render.raster import (
    Buffers,
    Geometry,
    Placed,
    part_faces,
    place_part,
    rasterise,
)
from remqa_data.sim.render.scene_arrays import (
    RenderPart,
    build_geometry,
    build_materials,
    materials_and_texels,
    surface_instances,
)
from remqa_data.sim.render.shade import Lights, Materials, shade, write_depth
from remqa_data.sim.render.shadow import empty_shadows, lamp_views, mark_stale, summarise

__all__ = ["Frame", "RenderPart", "Renderer"]

_Number = TypeVar("_Number", np.float32, np.int32)

AMBIENT = 0.37
BACKGROUND = (0.93, 0.94, 0.95)
_NO_SHADOWS = empty_shadows((0.0, 0.0, 0.0), 0)
_NO_PATCHES = Patches(np.zeros(1, dtype=np.int32), np.zeros(0, dtype=np.int32), np.zeros((0, 3), dtype=np.float32))


@dataclass(frozen=True, eq=False)
class Frame:
    """What a camera sees; all images have the same height and width."""

    rgb: U8
    """(h, w, 3) sRGB."""
    depth: F32
    """(h, w) metres along the camera's forward axis at the pixel's centre, 0 where nothing is."""
    instances: I32
    """(h, w) `RenderPart.instance` at the pixel's centre, -1 where nothing is."""


class Renderer:
    """Parts at their poses, lamps, and what is kept between frames.

    Parameters
    ----------
    parts : sequence of RenderPart
        What there is to draw.
    poses : (n, 4, 4) array
        Pose of each part: its frame to the world.
    lights : sequence of tuple of float
        One to three lamps, metres, world frame. The first one casts shadows.
    ambient : float
        Light from everywhere, linear; 0.3 to 0.6 looks like a room by day. Not used with a volume.
    volume : Volume, optional
        Indirect light, see `remqa_data.sim.light`; what moves takes it from where it is.
    mirrors : Mirrors, optional
        What the mirrors among the parts' surfaces show; without, they show the texture of their material.
    background : tuple of float
        sRGB in 0..1 of pixels where nothing is.
    shadow_size : int
        Pixels along each side of the six shadow maps of the first lamp.
    """

    def __init__(
        self,
        parts: Sequence[RenderPart],
        poses: npt.ArrayLike,
        *,
        lights: Sequence[Vec3] = ((0.0, 0.0, 2.4),),
        ambient: float = AMBIENT,
        volume: Volume | None = None,
        mirrors: Mirrors | None = None,
        background: Vec3 = BACKGROUND,
        shadow_size: int = 512,
    ) -> None:
        self.parts = tuple(parts)
        self._geometry = build_geometry(self.parts)
        # Materials and texels, which are many megabytes, once somebody sees colours.
        self._paint: tuple[Materials, I32] | None = None
        self._instances = surface_instances(self.parts)
        self._lights = room_lights(lights, ambient, background)
        count, vertices = len(self.parts), self._geometry.vertices.shape[1]
        self._placed = empty_placed(self._geometry)
        self._poses = np.full((count, 4, 4), np.nan)
        self._records = np.empty((len(self._geometry.faces), 9), dtype=np.float32)
        self._record_face = np.empty(len(self._geometry.faces), dtype=np.int32)
        self._candidates = np.empty(len(self._geometry.faces), dtype=np.int32)
        self._drawn_parts = np.empty((count + 1, 2), dtype=np.int32)
        self._image = np.empty((5, vertices), dtype=np.float32)
        lamp = self._lights.positions[0]
        self._shadows = empty_shadows(lamp, shadow_size)
        self._lamp_views = lamp_views(lamp, shadow_size)
        self._lamp_axes = np.stack([view.axes for view in self._lamp_views])
        self._shadow_slots = np.empty((shadow_size, shadow_size), dtype=np.int32)
        self._stale_maps = np.tile(np.array(Scissor.whole(shadow_size, shadow_size), dtype=np.int32), (6, 1))
        self._frame_buffers: dict[tuple[int, int], Buffers] = {}
        self._stale_light = np.ones(count, dtype=np.bool_)
        self.set_light(volume, mirrors)
        self.set_poses(range(count), poses)

    def labels_of_surfaces(self, labels: I32) -> I32:
        """(s,) the label of each surface, of labels by `RenderPart.instance`; the last of them is that of -1."""
        return labels.take(self._instances)

    def set_light(self, volume: Volume | None, mirrors: Mirrors | None = None) -> None:
        """Light everything by what was baked; parameters as of the class."""
        self._volume = volume
        self._mirrors = no_mirrors(len(self._instances)) if mirrors is None else mirrors
        self._patches = _NO_PATCHES if volume is None else patches(self._geometry.vertices, self._geometry.faces)
        self._stale_light[:] = True

    @property
    def lights(self) -> Lights:
        """The lamps, and light from everywhere where none is baked."""
        return self._lights

    def set_lamps(self, strength: npt.ArrayLike, ambient: float) -> None:
        """Let the lamps shine with (k,) other strengths, and what comes from everywhere where none is baked."""
        self._lights = self._lights._replace(strength=np.asarray(strength, dtype=np.float32), ambient=ambient)

    def set_materials(self, materials: Sequence[Material]) -> None:
        """Paint the surfaces, of which there is one material each in the order of the parts; light and shape stay."""
        self._paint = materials_and_texels(materials)

    def set_pose(self, part: int, pose: npt.ArrayLike) -> None:
        """Put one part elsewhere; `pose` is (4, 4), from its frame to the world."""
        matrix = np.ascontiguousarray(pose, dtype=np.float64)
        if np.array_equal(matrix, self._poses[part]):
            return
        self._poses[part] = matrix
        self._mark_shadows(part)
        place_part(self._geometry, self._placed, part, matrix)
        self._mark_shadows(part)
        self._stale_light[part] = True

    def set_poses(self, indices: Iterable[int], poses: npt.ArrayLike) -> None:
        """Put several parts elsewhere; `poses` is (n, 4, 4)."""
        for part, pose in zip(indices, np.asarray(poses, dtype=np.float64), strict=True):
            self.set_pose(part, pose)

    def set_visible(self, part: int, visible: bool) -> None:
        """Show or hide one part. A hidden part is drawn nowhere and casts no shadow."""
        if self._placed.visible[part] != visible:
            self._placed.visible[part] = True
            self._mark_shadows(part)
            self._placed.visible[part] = visible

    def render(
        self,
        camera: AnyCamera,
        *,
        shadows: bool = True,
        antialias: bool = True,
        only: Flags | None = None,
        scissor: Scissor | None = None,
    ) -> Frame:
        """Draw one frame.

        Parameters
        ----------
        camera : Camera or TopDownCamera
            From where.
        shadows : bool
            Whether the first lamp casts shadows. Of its six maps, what a moved part covered or covers is drawn again.
        antialias : bool
            Whether to smooth the edges in the colour image. Depth and instances are the same either way.
        only : (n,) array of bool, optional
            Which parts to draw; the others still cast shadows and throw light back.
        scissor : Scissor, optional
            Draw only these pixels; the others are 0, and nothing. Those along its border are not smoothed.

        Raises
        ------
        ValueError
            If the scissor is not a part of the picture.
        """
        if shadows:
            self._draw_stale_maps()
        # All of it decides which parts show, and so what edges are smoothed with; colours are what takes time.
        buffers = self._drawn(camera.view(), only)
        view = _cut(camera.view(), scissor)
        depth, instances = self._depth(buffers, view), self._labels(buffers, view, self._instances)
        self._light_stale_parts(self._shown_parts(buffers, view))
        rgb = np.zeros((view.height, view.width, 3), dtype=np.uint8)
        self._paint = self._paint or build_materials(self.parts)
        shade(
            self._geometry,
            self._placed,
            view,
            buffers,
            *self._paint,
            self._lights,
            self._shadows if shadows else _NO_SHADOWS,
            self._patches,
            self._mirrors,
            rgb,
        )
        if antialias:
            smooth_edges(self._geometry, buffers, view, rgb)
        return Frame(rgb, depth, instances)

    def render_instances(self, camera: AnyCamera) -> tuple[F32, I32]:
        """Depth and instances of the frame that `render` would draw, several times quicker than with its colours."""
        view = camera.view()
        buffers = self._drawn(view, None)
        return self._depth(buffers, view), self._labels(buffers, view, self._instances)

    def render_depth(self, camera: AnyCamera, only: Flags | None = None, scissor: Scissor | None = None) -> F32:
        """Only the depth of the frame that `render` would draw."""
        view = _cut(camera.view(), scissor)
        return self._depth(self._drawn(view, only), view)

    def render_labels(
        self, camera: AnyCamera, labels: I32, only: Flags | None = None, scissor: Scissor | None = None
    ) -> I32:
        """(h, w) labels of the surfaces that `render` would draw, as of `count`; -1 where nothing is."""
        view = _cut(camera.view(), scissor)
        return self._labels(self._drawn(view, only), view, labels)

    def count(
        self, camera: AnyCamera, labels: I32, bins: int, only: Flags | None = None, scissor: Scissor | None = None
    ) -> I64:
        """(bins,) how many pixels of the frame that `render` would draw show a surface of each label.

        Parameters
        ----------
        camera, only, scissor
            As of `render`.
        labels : (s,) array
            Of the surfaces of all parts, less than `bins`; -1 for those that are not counted.
        bins : int
            How many labels there are.
        """
        view = _cut(camera.view(), scissor)
        counts = np.zeros(bins, dtype=np.int64)
        count_labels(self._geometry, labels, self._drawn(view, only), view.scissor, counts)
        return counts

    def count_in_windows(self, windows: Windows, labels: I32, bins: int, only: Flags | None = None) -> I64:
        """(windows, bins) the same for each of some windows, many times quicker than one by one."""
        side = int(windows.side.max(initial=1))
        counts = np.zeros((len(windows.side), bins), dtype=np.int64)
        placed, buffers = self._shown(only), self._buffers(side, side)
        count_in_windows(self._geometry, placed, windows, buffers, True, labels, counts)
        return counts

    def relevant(self, camera: AnyCamera, wanted: Flags) -> Flags:
        """(n,) which parts a picture needs that is to show (n,) some parts rightly: those, and what may be before them."""
        relevant = np.zeros(len(self.parts), dtype=np.bool_)
        mark_relevant(self._placed.corners, camera.view(), wanted, relevant)
        return relevant

    def scissor_around(self, camera: AnyCamera, wanted: Flags) -> Scissor:
        """The part of a picture in which (n,) some parts, at least one, are where they are now, and a margin."""
        return scissor_around(camera.view(), self._placed.corners[wanted].reshape(-1, 3))

    def _drawn(self, view: View, only: Flags | None) -> Buffers:
        """What each pixel of a picture shows."""
        buffers = self._buffers(view.height, view.width)
        rasterise(self._geometry, self._shown(only), view, buffers)
        return buffers

    def _depth(self, buffers: Buffers, view: View) -> F32:
        depth = _canvas(view, np.float32(0.0))
        write_depth(buffers, view, depth)
        return depth

    def _labels(self, buffers: Buffers, view: View, labels: I32) -> I32:
        image = _canvas(view, np.int32(-1))
        write_labels(self._geometry, labels, buffers, view.scissor, image)
        return image

    def _shown(self, only: Flags | None) -> Placed:
        """The parts where they are, of which only some are visible."""
        placed = self._placed
        return placed if only is None else placed._replace(visible=placed.visible & only)

    def _mark_shadows(self, part: int) -> None:
        """Note where shadow maps show a part as it is now."""
        if self._placed.visible[part]:
            shadows = self._shadows
            mark_stale(
                shadows.lamp, self._lamp_axes, len(self._shadow_slots), self._placed.corners[part], self._stale_maps
            )

    def _draw_stale_maps(self) -> None:
        for face, stale in enumerate(self._stale_maps.tolist()):
            scissor = Scissor(*stale)
            if scissor.left <= scissor.right:
                buffers = self._with_scratch(self._shadows.maps[face], self._shadow_slots)
                rasterise(self._geometry, self._placed, _cut(self._lamp_views[face], scissor), buffers)
                summarise(self._shadows, face, scissor)
        side = len(self._shadow_slots)
        self._stale_maps[:] = side, -1, side, -1

    def _shown_parts(self, buffers: Buffers, view: View) -> I32:
        """The parts that were drawn, of which the scissor may show something."""
        drawn = buffers.drawn[: np.argmax(buffers.drawn[:, 0] < 0), 0]
        if view.is_whole:
            return drawn
        wanted, shown = np.zeros((2, len(self.parts)), dtype=np.bool_)
        wanted[drawn] = True
        mark_relevant(self._placed.corners, view, wanted, shown)
        return drawn[shown[drawn]]

    def _light_stale_parts(self, parts: I32) -> None:
        """Look up the indirect light of those of some parts that are elsewhere than when it was looked up."""
        if self._volume is None:
            return
        geometry, placed = self._geometry, self._placed
        for part in parts[self._stale_light[parts]].tolist():
            first, stop = part_faces(geometry, part)
            light_faces(
                self._patches,
                self._volume,
                placed.vertices,
                placed.normals,
                geometry.faces,
                geometry.face_of_solid,
                first,
                stop,
            )
            self._stale_light[part] = False

    def _buffers(self, height: int, width: int) -> Buffers:
        if (height, width) not in self._frame_buffers:
            key = np.empty((height, width), dtype=np.float32)
            slot = np.empty((height, width), dtype=np.int32)
            self._frame_buffers = {(height, width): self._with_scratch(key, slot)}
        return self._frame_buffers[height, width]

    def _with_scratch(self, key: F32, slot: I32) -> Buffers:
        return Buffers(key, slot, self._records, self._record_face, self._drawn_parts, self._candidates, self._image)


def _cut(view: View, scissor: Scissor | None) -> View:
    """A view of which only a part is drawn; ValueError if that is not a part of the picture."""
    if scissor is None:
        return view
    scissor = Scissor(*scissor)
    left, right, top, bottom = scissor
    if not (0 <= left <= right + 1 <= view.width and 0 <= top <= bottom + 1 <= view.height):
        msg = f"{scissor} is no part of {view.width} x {view.height} pixels"
        raise ValueError(msg)
    return view._replace(scissor=scissor)


def _canvas(view: View, beyond: _Number) -> npt.NDArray[_Number]:
    """An image to draw in, with a value where the scissor lets nothing be drawn."""
    image = np.empty((view.height, view.width), dtype=type(beyond))
    if not view.is_whole:
        image[:] = beyond
    return image


def empty_placed(geometry: Geometry) -> Placed:
    """Room for the vertices of a geometry in the world; all its parts are visible."""
    count, vertices = len(geometry.part_corners), geometry.vertices.shape[1]
    return Placed(
        vertices=np.empty((3, vertices), dtype=np.float32),
        normals=np.empty((vertices, 3), dtype=np.float32),
        corners=np.zeros((count, 8, 3)),
        visible=np.ones(count, dtype=np.bool_),
    )


def room_lights(positions: Sequence[Vec3], ambient: float = AMBIENT, background: Vec3 = BACKGROUND) -> Lights:
    """Share the light of a room out among its lamps; the first one, which casts shadows, gets most."""
    if not 1 <= len(positions) <= 3:
        msg = f"a room has one to three lamps, not {len(positions)}"
        raise ValueError(msg)
    shares = [1.0] if len(positions) == 1 else [0.6] + [0.4 / (len(positions) - 1)] * (len(positions) - 1)
    linear_background: F64 = np.square(np.array(background))
    return Lights(
        positions=np.array(positions, dtype=np.float64).reshape(-1, 3),
        strength=np.array(shares, dtype=np.float32) * np.float32(0.82),
        reach_m=4.0,
        ambient=ambient,
        background=linear_background.astype(np.float32),
    )
