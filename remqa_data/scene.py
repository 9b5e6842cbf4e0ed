"""A room and everything in it, as plain data: what is stored, loaded again anywhere, and simulated.

A `Scene` holds no meshes. Each object names its asset by type, size, variant and seed, and the walls, ceiling and
built-in furniture are boxes with a finish; `remqa_data.sim.physics.world.World` builds the same world from that, bit for bit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from pydantic import TypeAdapter, ValidationError

from remqa_data.assets.core.model import AssetSpec, Material
from remqa_data.errors import SceneFormatError, UnknownNameError, one_line
from remqa_data.files import atomic_path
from remqa_data.geometry.types import Box, Rect, Vec3
from remqa_data.limits import MOST_SCENE_JSON_BYTES
from remqa_data.scene_checks import scene_problem

Quaternion = tuple[float, float, float, float]
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
        Ids of the receptacles that hold it.
    """

    id: str
    asset: AssetSpec
    position: Vec3
    quaternion: Quaternion = (0.0, 0.0, 0.0, 1.0)
    openness: float = 0.0
    is_fixed: bool = True
    parents: tuple[str, ...] = ()

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
    """

    name: str
    room_type: str
    bounds: Rect
    floor_z: float
    height: float
    lights: tuple[Vec3, ...]
    structure: tuple[StructureBox, ...]
    objects: tuple[SceneObject, ...]
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
        if len(text) > MOST_SCENE_JSON_BYTES:
            raise SceneFormatError(f"{where}: {len(text):,} bytes; at most {MOST_SCENE_JSON_BYTES:,} are read")
        try:
            scene = _ADAPTER.validate_json(text)
        except ValidationError as error:
            first = error.errors()[0]
            field = ".".join(str(part) for part in first["loc"]) or "the whole text"
            raise SceneFormatError(f"{where}: {field}: {one_line(first['msg'])}") from None
        if scene.format_version != FORMAT_VERSION:
            msg = f"{where}: format version {scene.format_version}; this package reads {FORMAT_VERSION}"
            raise SceneFormatError(msg)
        problem = scene_problem(scene)
        if problem is not None:
            raise SceneFormatError(f"{where}: {problem}")
        return scene

    def save(self, path: Path) -> None:
        """Write the scene to a file; it appears only when it is whole."""
        with atomic_path(path) as temporary:
            temporary.write_bytes(self.to_json())

    @classmethod
    def load(cls, path: Path) -> Scene:
        """Read a scene from a file."""
        return cls.from_json(path.read_bytes(), str(path))


_ADAPTER = TypeAdapter(Scene)
