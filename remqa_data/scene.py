"""A room and everything in it, as plain data: what is stored, loaded again anywhere, and simulated.

A `Scene` holds no meshes. Each object names its asset by type, size, variant and seed, and the walls, ceiling and
built-in furniture are boxes with a finish; `remqa_data.sim.physics.world.World` builds the same world from that, bit for bit.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from pydantic import TypeAdapter, ValidationError

from remqa_data import limits
from remqa_data.assets.core.model import AssetSpec, Material
from remqa_data.assets.looks.textures import TEXTURE_NAMES
from remqa_data.errors import SceneFormatError, UnknownNameError, what_is_invalid
from remqa_data.files import atomic_path
from remqa_data.geometry.types import Box, Rect, Vec3

Quaternion = tuple[float, float, float, float]
Light = Literal["direct", "baked"]
StructureKind = Literal["wall", "ceiling", "floor", "fixture", "outside"]

FORMAT_VERSION = 1


@dataclass(frozen=True)
class SceneObject:
    """One object.

    Attributes
    ----------
    id : str
        AI2-THOR's objectId, unique in the scene.
    asset : AssetSpec
        What it looks like.
    position : tuple of float
        Where the centre of its closed box is, metres, world frame.
    quaternion : tuple of float
        Its rotation (x, y, z, w).
    openness : float
        0 (closed) to 1 (open).
    is_fixed : bool
        Whether physics leaves it where it is until something acts on it: furniture, and things that hang or lean.
    parents : tuple of str
        Ids of the receptacles that held it where it was first put, whatever has happened since: what holds a thing now,
        `remqa_data.sim.physics.support.supports` tells, and the dataset's `support`.
    most_open : float
        How far it opens where it stands, as a share of what it could: less than 1 where a wall is in the way.
    """

    id: str
    asset: AssetSpec
    position: Vec3
    quaternion: Quaternion = (0.0, 0.0, 0.0, 1.0)
    openness: float = 0.0
    is_fixed: bool = True
    parents: tuple[str, ...] = ()
    most_open: float = 1.0

    @property
    def type(self) -> str:
        """Object type, such as "Mug"."""
        return self.asset.type


@dataclass(frozen=True)
class StructureBox:
    """A piece of the building or of built-in furniture: an axis-aligned box that is not an object."""

    kind: StructureKind
    box: Box
    finish: Material


@dataclass(frozen=True)
class Scene:
    """A room.

    Attributes
    ----------
    name : str
        Such as "FloorPlan1".
    room_type : str
        kitchen, living_room, bedroom or bathroom.
    bounds : Rect
        Inner faces of the outer walls: x0, y0, x1, y1 in metres.
    floor_z : float
        Height of the floor in metres (0 in most rooms).
    height : float
        Floor to ceiling in metres.
    lights : tuple of Vec3
        Ceiling lights.
    structure : tuple of StructureBox
        Walls, ceiling, built-in furniture.
    objects : tuple of SceneObject
        Everything that has an id.
    light : {"direct", "baked"}
        How it is drawn: lit by its lamps and evenly from everywhere, or with surfaces that light each other, too.
    """

    name: str
    room_type: str
    bounds: Rect
    floor_z: float
    height: float
    lights: tuple[Vec3, ...]
    structure: tuple[StructureBox, ...]
    objects: tuple[SceneObject, ...]
    light: Light = "direct"
    format_version: int = FORMAT_VERSION

    def object(self, object_id: str) -> SceneObject:
        """The object with an id."""
        for candidate in self.objects:
            if candidate.id == object_id:
                return candidate
        raise UnknownNameError("object", object_id, [candidate.id for candidate in self.objects])

    def with_objects(self, objects: tuple[SceneObject, ...]) -> Scene:
        """The same room with other objects."""
        return replace(self, objects=objects)

    def to_json(self) -> bytes:
        """The scene as JSON; every float keeps all its bits."""
        return _ADAPTER.dump_json(self)

    @classmethod
    def from_json(cls, text: str | bytes, where: str = "scene") -> Scene:
        """Read what `to_json` wrote.

        Raises
        ------
        SceneFormatError
            Naming the place, the field and what is wrong with it; also if it does not keep `remqa_data.limits`.
        """
        if len(text) > limits.MOST_SCENE_JSON_BYTES:
            raise SceneFormatError(f"{where}: {len(text):,} bytes; at most {limits.MOST_SCENE_JSON_BYTES:,} are read")
        try:
            scene = _ADAPTER.validate_json(text)
        except ValidationError as error:
            raise SceneFormatError(f"{where}: {what_is_invalid(error)}") from None
        if scene.format_version != FORMAT_VERSION:
            msg = f"{where}: format version {scene.format_version}; this package reads {FORMAT_VERSION}"
            raise SceneFormatError(msg)
        problem = next(_scene_problems(scene), None)
        if problem is not None:
            raise SceneFormatError(f"{where}: {problem}")
        return scene

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the scene to a file; it appears only when it is whole."""
        with atomic_path(path) as temporary:
            temporary.write_bytes(self.to_json())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Read a scene from a file."""
        return cls.from_json(Path(path).read_bytes(), os.fspath(path))


_ADAPTER = TypeAdapter(Scene)


def _scene_problems(scene: Scene) -> Iterator[str]:
    """What must not be, with its place, so that whatever is left is built in bounded time and memory."""
    yield from _room(scene)
    for place, light in enumerate(scene.lights):
        yield from _near(f"lights.{place}", scene, light)
    for place, part in enumerate(scene.structure):
        yield from _structure_box(f"structure.{place}", scene, part)
    seen: set[str] = set()
    for place, thing in enumerate(scene.objects):
        if thing.id in seen:
            yield f"objects: id {thing.id!r} occurs twice"
        seen.add(thing.id)
        yield from _object(f"objects.{place}", scene, thing)
    sides = sum(max(thing.asset.size) for thing in scene.objects)
    yield from _within("objects: their longest sides together", [sides], 0.0, limits.MOST_ASSETS_M, " m")


def _room(scene: Scene) -> Iterator[str]:
    for field, items, most in (
        ("lights", scene.lights, limits.MOST_LIGHTS),
        ("structure", scene.structure, limits.MOST_STRUCTURE_BOXES),
        ("objects", scene.objects, limits.MOST_OBJECTS),
    ):
        if len(items) > most:
            yield f"{field}: there are {len(items):,}; at most {most:,} are read"
    if not scene.lights:
        yield "lights: there are none; a room has one at least"
    yield from _text("name", scene.name)
    x0, y0, x1, y1 = scene.bounds
    yield from _within("bounds", (*scene.bounds, scene.floor_z), -limits.MOST_FAR_M, limits.MOST_FAR_M, " m")
    yield from _within("bounds: the sides of the room", (x1 - x0, y1 - y0), 0.1, limits.MOST_ROOM_M, " m")
    yield from _within("height", [scene.height], 0.1, limits.MOST_ROOM_HEIGHT_M, " m")


def _structure_box(where: str, scene: Scene, part: StructureBox) -> Iterator[str]:
    for corner in (part.box[:3], part.box[3:]):
        yield from _near(f"{where}.box", scene, corner)
    yield from _within(f"{where}.box: its sides", [part.box[i + 3] - part.box[i] for i in range(3)], 0.0, 1e3, " m")
    yield from _material(f"{where}.finish", part.finish)


def _material(where: str, finish: Material) -> Iterator[str]:
    yield from _within(
        f"{where}: rgb, gloss, glow or mirror", (*finish.rgb, finish.gloss, finish.glow, finish.mirror), 0.0, 1.0
    )
    if finish.repeat_m is not None:
        yield from _within(f"{where}.repeat_m", [finish.repeat_m], 1e-3, limits.MOST_FAR_M, " m")
    if finish.texture is not None and finish.texture not in TEXTURE_NAMES:
        yield f"{where}.texture: there is no texture {finish.texture[:80]!r}"


def _object(where: str, scene: Scene, thing: SceneObject) -> Iterator[str]:
    yield from _text(f"{where}.id", thing.id)
    yield from _near(f"{where}.position", scene, thing.position)
    length = sum(number * number for number in thing.quaternion)
    yield from _within(f"{where}.quaternion: its length", [length], 0.99, 1.01)
    yield from _within(f"{where}.openness", [thing.openness], 0.0, 1.0)
    yield from _within(f"{where}.most_open", [thing.most_open], 0.0, 1.0)
    if len(thing.parents) > limits.MOST_ASSET_PARTS:
        yield f"{where}.parents: there are {len(thing.parents):,}; at most {limits.MOST_ASSET_PARTS} are read"
    yield from _asset(f"{where}.asset", thing.asset)


def _asset(where: str, asset: AssetSpec) -> Iterator[str]:
    yield from _within(f"{where}.size", asset.size, limits.LEAST_ASSET_M, limits.MOST_ASSET_M, " m")
    yield from _within(f"{where}.seed", [asset.seed], 0, limits.MOST_SEED)
    parts = len(asset.levels) + len(asset.pockets) + len(asset.footprint)
    if parts > limits.MOST_ASSET_PARTS:
        yield f"{where}: levels, pockets and footprint are {parts:,} together; at most {limits.MOST_ASSET_PARTS} are read"
    for field, numbers in (
        ("levels", asset.levels),
        ("pockets", [number for box in asset.pockets for number in box]),
        ("footprint", [number for rect in asset.footprint for number in rect]),
    ):
        yield from _within(f"{where}.{field}", numbers, -limits.MOST_ASSET_M, limits.MOST_ASSET_M, " m")


def _near(where: str, scene: Scene, point: Iterable[float]) -> Iterator[str]:
    """A point must lie in the room or not far from it."""
    x0, y0, x1, y1 = scene.bounds
    lows, highs = (x0, y0, scene.floor_z), (x1, y1, scene.floor_z + scene.height)
    far = limits.MOST_OUTSIDE_M
    for low, number, high in zip(lows, point, highs, strict=True):
        yield from _within(where, [number], low - far, high + far, " m")


def _text(where: str, text: str) -> Iterator[str]:
    if len(text) > limits.MOST_TEXT_BYTES:
        yield f"{where}: {len(text):,} characters; at most {limits.MOST_TEXT_BYTES:,} are read"


def _within(where: str, numbers: Iterable[float], low: float, high: float, unit: str = "") -> Iterator[str]:
    for number in numbers:
        if not low <= number <= high:  # so it is for nan, too
            yield f"{where}: {number:g}; expected {low:g} to {high:g}{unit}"
            return
