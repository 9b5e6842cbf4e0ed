"""Pictures as AI2-THOR sends them: bytes, the bottom row first, and a colour for every object and object type."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.assets.core.model import Surface
from remqa_data.geometry.types import I32, U8
from remqa_data.scene import Scene, StructureKind
from remqa_data.sim.render.scene_arrays import structure_groups
from remqa_data.sim.render.view import Observation
from remqa_data.thor.state.frames import to_thor

Color = tuple[int, int, int]


class Palette:
    """One colour for every object and every type, the same in every room and process.

    Parameters
    ----------
    object_ids, types : sequence of str
        All objects of the room, and the type of each.
    scene : Scene
        Whose building has walls and more; the renderer's first parts are its `structure_groups`.

    Notes
    -----
    A colour is the first bytes of the name's MD5 that no earlier name has, so most colours depend on the name alone.
    """

    def __init__(self, object_ids: Sequence[str], types: Sequence[str], scene: Scene) -> None:
        taken: dict[Color, str] = {BACKGROUND: ""}
        building = [(STRUCTURE_TYPES.get(kind, ""), panel) for kind, panel in structure_groups(scene)]
        kinds, panels = [kind for kind, _ in building], [_name(kind, panel) for kind, panel in building]
        names = dict.fromkeys((*sorted({*types, *kinds}), *object_ids, *panels))
        self._colors = {name: _color(name, taken) for name in names if name}
        self._panels = len(object_ids) + np.arange(len(panels))
        # The last row is for nothing.
        self._by_object = self._rgba([*object_ids, *panels, ""])
        self._by_type = self._rgba([*types, *kinds, ""])

    def metadata(self) -> list[dict[str, object]]:
        """The `colors` of an event's metadata."""
        return [{"name": name, "color": list(color)} for name, color in self._colors.items()]

    def rows(self, seen: Observation) -> I32:
        """(h, w) of which object, or panel of the building, each pixel is: what `instances` and `types` have colours for."""
        of_part = seen.object_of.copy()  # -1 where a part is no object's
        of_part[: len(self._panels)] = self._panels
        return np.asarray(of_part.take(seen.instances))

    def instances(self, rows: I32) -> U8:
        """(h, w, 4) picture of which object, or panel of the building, each pixel shows."""
        return _colored(self._by_object, rows)

    def types(self, rows: I32) -> U8:
        """(h, w, 4) picture of which type each pixel shows."""
        return _colored(self._by_type, rows)

    def _rgba(self, names: Sequence[str]) -> U8:
        colors = np.array([self._colors.get(name, BACKGROUND) for name in names], dtype=np.uint8).reshape(-1, 3)
        return np.column_stack([colors, np.full(len(colors), OPAQUE, dtype=np.uint8)])


def _colored(colors: U8, objects: npt.NDArray[np.int32]) -> U8:
    """(h, w, 4) the colour of every pixel's object; four bytes taken as one number are several times as quick."""
    words = colors.view(np.uint32).ravel()
    return words.take(objects, mode="wrap").view(np.uint8).reshape(*objects.shape, 4)


def as_bytes(image: npt.NDArray[np.uint8 | np.float32]) -> bytes:
    """A picture as AI2-THOR's Python side reads it."""
    return image[::-1].tobytes()


def depth_bytes(depth: npt.NDArray[np.float32], far_m: float) -> bytes:
    """Depth in metres; where nothing is seen, or beyond the far plane, it is the far plane's."""
    shown = np.minimum(depth, np.float32(far_m))
    shown[depth <= 0.0] = far_m
    return as_bytes(shown)


BACKGROUND: Color = (0, 0, 0)
"""Agents, and what is outside; AI2-THOR's Python side calls every colour without a name "background"."""
STRUCTURE_TYPES: dict[StructureKind, str] = {
    "wall": "Wall",
    "ceiling": "Ceiling",
    "floor": "Floor",
    "fixture": "Fixture",
}
"""What parts of the building are called in pictures; they are no objects of the metadata."""
OPAQUE = 255


def _name(kind: str, panel: Surface) -> str:
    """A part of the building, by its middle in AI2-THOR's frame, as ids of objects are made."""
    middle = to_thor((panel.vertices.min(axis=0) + panel.vertices.max(axis=0)) / 2)
    return "|".join([kind, *(f"{along:+06.2f}" for along in middle.values())]) if kind else ""


def _color(name: str, taken: dict[Color, str]) -> Color:
    digest = hashlib.md5(name.encode(), usedforsecurity=False).digest()
    while True:
        for start in range(len(digest) - 2):
            color = (digest[start], digest[start + 1], digest[start + 2])
            if taken.setdefault(color, name) == name:
                return color
        digest = hashlib.md5(digest, usedforsecurity=False).digest()
