"""What a camera sees of a world: one renderer part for each moving link, kept in step with the world's poses."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from remqa_data.assets.core.model import Material, Surface
from remqa_data.geometry.boxes import corners
from remqa_data.geometry.types import F32, F64, I32, I64, Flags
from remqa_data.scene import StructureKind
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import AnyCamera, Scissor, Windows, scissor_around
from remqa_data.sim.render.renderer import Renderer, RenderPart
from remqa_data.sim.render.room_light import room_light
from remqa_data.sim.render.room_mirrors import mirrors_of, room_mirrors
from remqa_data.sim.render.scene_arrays import structure_groups, structure_surfaces

if TYPE_CHECKING:
    from remqa_data.sim.render.renderer import Frame

STRUCTURE = -1
"""Object index of walls, ceiling and built-in furniture."""

Shapes = Mapping[str, Sequence[tuple[Surface, ...]]]
"""What is drawn of some objects, link by link, instead of what they were built with."""
_AS_BUILT: Shapes = {}
Body = Sequence[tuple[Surface, ...]]
"""What is drawn of each part of something that is no object of the world, such as an agent."""


@dataclass(frozen=True)
class Figure:
    """Somebody who is in a picture of a world: a body, and what is held.

    Attributes
    ----------
    poses : (n, 4, 4) array or None
        Of all parts of its body in the room, metres; None if none of them is seen.
    parts : slice
        Which parts of it are seen.
    held : mapping of str to (links, 4, 4) array
        Poses of the links of what is held, by its id.
    """

    poses: F64 | None
    parts: slice
    held: Mapping[str, F64]

    def key(self) -> bytes:
        """The same for figures that look the same."""
        body = b"" if self.poses is None else self.poses.tobytes()
        return b"|".join(
            [body, f"{self.parts}{[*self.held]}".encode(), *(poses.tobytes() for poses in self.held.values())]
        )


@dataclass(frozen=True)
class Observation:
    """A frame with what its instances mean.

    Attributes
    ----------
    rgb : (h, w, 3) uint8
    depth : (h, w) float32, metres along the camera's forward axis, 0 where nothing is seen.
    instances : (h, w) int32, number of the renderer's part, -1 where nothing is.
    object_of, link_of : (n + 1,) int32, of each part, and of nothing.
    """

    rgb: npt.NDArray[np.uint8]
    depth: npt.NDArray[np.float32]
    instances: I32
    object_of: I32
    link_of: I32

    @cached_property
    def objects(self) -> I32:
        """(h, w) index into the scene's objects, -1 for the building and for nothing."""
        return self.object_of.take(self.instances)

    @cached_property
    def links(self) -> I32:
        """(h, w) index of the object's link (0 is its base), -1 for the building and for nothing."""
        return self.link_of.take(self.instances)


class WorldView:
    """Draws a world.

    Parameters
    ----------
    world : World
        What to draw; later changes of the world are followed by `render`.
    bodies : sequence of Body
        What may be in pictures besides the world; see `show_body`.

    Attributes
    ----------
    instance_of_bodies : int
        Which instance pictures show where there is a body.
    """

    def __init__(self, world: World, *, bodies: Sequence[Body] = ()) -> None:
        self.world, self.bodies = world, bodies
        self._shapes: Shapes = {}
        self._asked_to_hide: set[str] = set()
        self._brightness: Sequence[float] | None = None
        self._changes = 0
        self._build()

    def _build(self) -> None:
        """Make the renderer anew, of what the world holds and of the shapes that were asked for."""
        world = self.world
        parts, poses = world_parts(world, self._shapes)
        self._first_object_part = len(parts) - sum(len(asset.links) for asset in world.assets.values())
        object_of, link_of = [STRUCTURE] * self._first_object_part, [STRUCTURE] * self._first_object_part
        self.instance_of_bodies = len(parts)  # which is read as "no object"
        self._parts_of_bodies = []
        for body in self.bodies:
            self._parts_of_bodies.append(range(len(parts), len(parts) + len(body)))
            parts += [RenderPart(surfaces, self.instance_of_bodies) for surfaces in body]
        poses = np.concatenate([poses, np.tile(np.eye(4), (len(parts) - len(poses), 1, 1))])
        self._parts_of: dict[str, range] = {}
        for index, object_id in enumerate(world.ids):
            count = len(world.assets[object_id].links)
            self._parts_of[object_id] = range(len(object_of), len(object_of) + count)
            object_of += [index] * count
            link_of += range(count)
        # The last entry answers for instance -1, where nothing is seen.
        self._object_of = np.array([*object_of, STRUCTURE], dtype=np.int32)
        self._link_of = np.array([*link_of, STRUCTURE], dtype=np.int32)
        self._shown = {object_id: world.state(object_id) for object_id in world.ids}
        self._out_of_room = frozenset[str]()
        self._revision: int | None = None
        self.renderer = Renderer(parts, poses, lights=world.scene.lights)
        self._object_labels = self.renderer.labels_of_surfaces(self._object_of)
        for number in range(len(self.bodies)):
            self.show_body(number, None)
        self._lamps = self.renderer.lights
        self._level = 1.0
        self._waits_for_light = world.scene.light == "baked"

    def rebuild(self, shapes: Shapes | None = None, bodies: Sequence[Body] | None = None) -> None:
        """Draw some objects in other shapes from now on, and all others as built; and what the world has got since.

        Takes some 50 ms, as everything is put together anew; but for materials all stays as it was set. Without shapes, or
        without bodies, those of before go on.
        """
        self._shapes = self._shapes if shapes is None else shapes
        self.bodies = self.bodies if bodies is None else bodies
        self._build()
        self._asked_to_hide &= self._parts_of.keys()
        for object_id in self._asked_to_hide:
            self._show_or_hide(object_id)
        if self._brightness is not None:
            self.set_brightness(self._brightness)
        self._changes += 1

    def sync(self) -> None:
        """Follow the world's poses, what is held and what is away; `render` does it by itself."""
        if self.world.revision == self._revision:
            return
        self._revision = self.world.revision
        for object_id, rows in self._parts_of.items():
            state = self.world.state(object_id)
            if state is not self._shown[object_id]:
                self._shown[object_id] = state
                self.renderer.set_poses(np.arange(rows.start, rows.stop), self.world.link_poses(object_id))
        before, self._out_of_room = self._out_of_room, frozenset((*self.world.held, *self.world.away))
        for changed in before ^ self._out_of_room:
            self._show_or_hide(changed)

    def hide(self, object_id: str, hidden: bool = True) -> None:
        """Leave an object out of the pictures, or in them again; what is held or away needs no hiding."""
        self.world.state(object_id)  # which there must be
        (self._asked_to_hide.add if hidden else self._asked_to_hide.discard)(object_id)
        self._changes += 1
        self._show_or_hide(object_id)

    def show_body(self, number: int, poses: F64 | None, parts: slice = slice(None)) -> None:
        """Let a body, or some of its parts, be in pictures from now on, with all parts at (n, 4, 4) poses, or in none."""
        rows = self._parts_of_bodies[number]
        if poses is not None:
            self.renderer.set_poses(rows, poses)
        shown = range(0) if poses is None else rows[parts]
        self._set_visible(shown, True)
        self._set_visible((part for part in rows if part not in shown), False)

    @contextmanager
    def showing(self, figures: Mapping[int, Figure]) -> Iterator[None]:
        """For the length of a block, let some figures be in pictures, by the numbers of their bodies."""
        self.sync()
        for number, figure in figures.items():
            if figure.poses is not None:
                self.show_body(number, figure.poses, figure.parts)
            for object_id, poses in figure.held.items():
                self.show_held(object_id, poses)
        try:
            yield
        finally:
            for number, figure in figures.items():
                if figure.poses is not None:
                    self.show_body(number, None)
                for object_id in figure.held:
                    self.show_held(object_id, None)

    def show_held(self, object_id: str, poses: F64 | None) -> None:
        """Let what is held be in pictures from now on, with its links at (n, 4, 4) poses, or, as usual, in none."""
        rows = self._parts_of[object_id]
        self.renderer.set_poses(rows, self.world.link_poses(object_id) if poses is None else poses)
        self._shown[object_id] = self.world.state(object_id)
        self._set_visible(rows, poses is not None)

    def render(
        self,
        camera: AnyCamera,
        *,
        shadows: bool = True,
        antialias: bool = True,
        only: Flags | None = None,
        scissor: Scissor | None = None,
    ) -> Observation:
        """Draw the world as it is now; the first picture of a room with baked light may take a second or two.

        With (parts,) `only`, some parts, in the light that all of them leave; with a scissor, some pixels, of which those
        along its border are not smoothed.
        """
        self.sync()
        if self._waits_for_light:
            self._bake()
        frame: Frame = self.renderer.render(camera, shadows=shadows, antialias=antialias, only=only, scissor=scissor)
        return Observation(frame.rgb, frame.depth, frame.instances, self._object_of, self._link_of)

    @property
    def lamp_shares(self) -> F64:
        """(k,) how much of the lamps' light each gives when the room is as it was built."""
        strength = self._lamps.strength.astype(np.float64)
        return np.asarray(strength / strength.sum())

    def set_brightness(self, lamps: Sequence[float]) -> None:
        """Let each lamp shine so many times as bright as it was built; what light the room throws back changes with them.

        ValueError, unless there is a number for each that is finite and not negative.
        """
        if len(lamps) != len(self._lamps.strength) or not all(0.0 <= share < math.inf for share in lamps):
            raise ValueError(f"brightness {lamps!r:.80}: give {len(self._lamps.strength)} numbers, none negative")
        self._changes += 1
        self._brightness = lamps
        self._level = float((self.lamp_shares * np.asarray(lamps)).sum())
        strength = self._lamps.strength * np.asarray(lamps, dtype=np.float32)
        self.renderer.set_lamps(strength, self._lamps.ambient * self._level)
        if self.world.scene.light == "baked" and not self._waits_for_light:
            self._bake()

    def set_materials(self, materials: Sequence[Material]) -> None:
        """Paint the surfaces, of which there is one material each in the order of the parts; light and shape stay."""
        self._changes += 1
        self.renderer.set_materials(materials)

    @property
    def version(self) -> tuple[int, int]:
        """Another one whenever pictures from one place may differ: of the world, and of how it is drawn."""
        return self.world.revision, self._changes

    def parts_of(self, object_ids: Iterable[str]) -> Flags:
        """(parts,) which of the renderer's parts are those of some objects."""
        found = np.zeros(len(self.renderer.parts), dtype=np.bool_)
        for object_id in object_ids:
            self.world.state(object_id)  # which there must be
            found[self._parts_of[object_id]] = True
        return found

    def scissor_around(self, camera: AnyCamera, object_ids: Iterable[str], margin_px: int = 1) -> Scissor:
        """The part of a picture in which some objects, at least one, are where they are now, and a margin."""
        boxes = [corners(self.world.box(object_id)) for object_id in object_ids]
        return scissor_around(camera.view(), np.concatenate(boxes), margin_px)

    def parts_of_building(self, kind: StructureKind) -> Flags:
        """(parts,) which of the renderer's parts are walls, ceilings or another kind of the building's."""
        found = np.zeros(len(self.renderer.parts), dtype=np.bool_)
        found[: self._first_object_part] = [other == kind for other, _ in structure_groups(self.world.scene)]
        return found

    def instances(self, camera: AnyCamera, only: Flags | None = None, scissor: Scissor | None = None) -> I32:
        """Only the (h, w) image of object indices, which is much cheaper than a picture; -1 beyond a scissor."""
        self.sync()
        return self.renderer.render_labels(camera, self._object_labels, only, scissor)

    def depth(self, camera: AnyCamera, only: Flags | None = None, scissor: Scissor | None = None) -> F32:
        """Only the (h, w) image of depth, metres; 0 beyond a scissor."""
        self.sync()
        return self.renderer.render_depth(camera, only, scissor)

    def depth_and_instances(self, camera: AnyCamera) -> tuple[F32, I32]:
        """Only the (h, w) images of depth, metres, and of object indices."""
        self.sync()
        depth, parts = self.renderer.render_instances(camera)
        return depth, self._object_of.take(parts)

    def pixels(self, camera: AnyCamera, only: Flags | None = None, scissor: Scissor | None = None) -> I64:
        """(objects,) how many pixels of a picture, within a scissor, show each object, in the world's order.

        With (parts,) `only`, as if there were nothing but some parts.
        """
        self.sync()
        return self.renderer.count(camera, self._object_labels, len(self._parts_of), only, scissor)

    def pixels_in_windows(self, windows: Windows, only: Flags | None = None) -> I64:
        """(windows, objects) the same for each of some windows, many times quicker than one by one."""
        self.sync()
        return self.renderer.count_in_windows(windows, self._object_labels, len(self._parts_of), only)

    def pixels_of(self, camera: AnyCamera, object_ids: Iterable[str]) -> I64:
        """(objects,) how many pixels show each of some objects; those of all others mean nothing.

        Quicker than `pixels`: nothing is drawn beside them or that cannot be before any of them, and nothing if they are out of
        sight.
        """
        self.sync()
        wanted = self.parts_of(object_ids)
        relevant = self.renderer.relevant(camera, wanted)
        if not relevant.any():
            return np.zeros(len(self._parts_of), dtype=np.int64)
        return self.pixels(camera, relevant, self.renderer.scissor_around(camera, wanted))

    def _bake(self) -> None:
        """Not before it is seen: most rooms that are planned are never drawn."""
        self._waits_for_light = False
        scene, bases = self.world.scene, {object_id: rows.start for object_id, rows in self._parts_of.items()}
        light = room_light(scene)
        if self._level != 1.0:
            light = light._replace(light=light.light * np.float32(self._level), least=light.least * self._level)
        self.renderer.set_light(light, mirrors_of(room_mirrors(scene), self.renderer.parts, bases))

    def _show_or_hide(self, object_id: str) -> None:
        is_seen = object_id not in self._asked_to_hide and object_id not in self._out_of_room
        self._set_visible(self._parts_of[object_id], is_seen)

    def _set_visible(self, parts: Iterable[int], is_seen: bool) -> None:
        for part in parts:
            self.renderer.set_visible(part, is_seen)


def world_parts(world: World, shapes: Shapes = _AS_BUILT) -> tuple[list[RenderPart], F64]:
    """Everything there is to draw: the building's parts, then every link of every object; and their (n, 4, 4) poses.

    A part's instance is its place in the list; objects have the shapes that are given, or else those they were built with.
    """
    surfaces = structure_surfaces(world.scene)
    poses = [np.eye(4)] * len(surfaces)
    for object_id in world.ids:
        built = [link.surfaces for link in world.assets[object_id].links]
        surfaces += shapes.get(object_id, built)
        poses += list(world.link_poses(object_id))
    return [RenderPart(shown, i) for i, shown in enumerate(surfaces)], np.stack(poses)
