"""Pictures as AI2-THOR sends them: bytes, the bottom row first, and a colour for every object and object type."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.geometry.types import U8

Color = tuple[int, int, int]


class Palette:
    """One colour for every object and every type, the same in every room and process.

    Parameters
    ----------
    object_ids, types : sequence of str
        All objects of the room, and the type of each.

    Notes
    -----
    A colour is the first bytes of the name's MD5 that no earlier name has, so most colours depend on the name alone.
    """

    def __init__(self, object_ids: Sequence[str], types: Sequence[str]) -> None:
        taken: dict[Color, str] = {BACKGROUND: ""}
        self._colors = {name: _color(name, taken) for name in (*sorted(set(types)), *object_ids)}
        # The last row is for index -1, the building.
        background = np.array([*BACKGROUND, OPAQUE], dtype=np.uint8)
        self._by_object = np.vstack([self._rgba(object_ids), background])
        self._by_type = np.vstack([self._rgba(types), background])

    def metadata(self) -> list[dict[str, object]]:
        """The `colors` of an event's metadata."""
        return [{"name": name, "color": list(color)} for name, color in self._colors.items()]

    def instances(self, objects: npt.NDArray[np.int32]) -> U8:
        """(h, w, 4) picture of which object each pixel shows, from indices into the objects (-1 is the building)."""
        return _colored(self._by_object, objects)

    def types(self, objects: npt.NDArray[np.int32]) -> U8:
        """(h, w, 4) picture of which type each pixel shows."""
        return _colored(self._by_type, objects)

    def _rgba(self, names: Sequence[str]) -> U8:
        colors = np.array([self._colors[name] for name in names], dtype=np.uint8).reshape(-1, 3)
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
"""The building; AI2-THOR's Python side calls every colour without a name "background"."""
OPAQUE = 255


def _color(name: str, taken: dict[Color, str]) -> Color:
    digest = hashlib.md5(name.encode(), usedforsecurity=False).digest()
    while True:
        for start in range(len(digest) - 2):
            color = (digest[start], digest[start + 1], digest[start + 2])
            if taken.setdefault(color, name) == name:
                return color
        digest = hashlib.md5(digest, usedforsecurity=False).digest()
