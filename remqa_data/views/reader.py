"""Reads a cache of views: frames and features, mapped into memory, and where actions lead."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from remqa_data.errors import DatasetError, UnknownNameError
from remqa_data.geometry.types import F32, F64, U8, Flags
from remqa_data.storage.manifest import load_manifest
from remqa_data.views.arrays import COLORS, FRAMES, PIXELS, features_name, load_table, mapped, table_name
from remqa_data.views.manifest import CachedRoom, Origin, ViewsManifest, load_views_manifest
from remqa_data.views.states import States
from remqa_data.views.transitions import Transitions

OPEN_ROOMS = 1024
"""How many configurations of rooms are kept open; each takes half a megabyte."""


@dataclass(frozen=True, eq=False)
class RoomViews:
    """One configuration of a room.

    Attributes
    ----------
    states : States
        What the numbers of states mean.
    transitions : Transitions
        Where actions lead.
    is_reachable : (states,) bool
        Which states there are in this configuration; other configurations may have others.
    frames : (states, size, size, 3) uint8
        Views of the room, mapped into memory; use `frame`, which puts right what is else in this configuration.
    features : (states, ...) float16 or None
        Of its views, mapped into memory.
    """

    states: States
    transitions: Transitions
    is_reachable: Flags
    frames: U8
    features: npt.NDArray[np.float16] | None
    pixels: npt.NDArray[np.uint16]
    colors: U8
    patch_starts: list[int]
    succeeding: dict[str, npt.NDArray[np.uint8]]

    def frame(self, state: int) -> U8:
        """(size, size, 3) what is seen in a state; read-only, and not copied where the room's first configuration shows it."""
        shown: U8 = self.frames[state]
        first, last = self.patch_starts[state], self.patch_starts[state + 1]
        if first == last:
            return shown
        shown = shown.copy()
        shown.reshape(-1, 3)[self.pixels[first:last]] = self.colors[first:last]
        return shown

    def draw(self, state: int, onto: U8) -> None:
        """Copy what is seen in a state onto a (size, size, 3) image, whose pixels lie one after the other."""
        onto[:] = self.frames[state]
        first, last = self.patch_starts[state], self.patch_starts[state + 1]
        if first != last:
            onto.reshape(-1, 3)[self.pixels[first:last]] = self.colors[first:last]

    def succeeds(self, question_id: str) -> Flags:
        """(states,) in which an agent that stops has navigated to the target of a question (S_N)."""
        if question_id not in self.succeeding:
            raise UnknownNameError("question", question_id, self.succeeding)
        return np.unpackbits(self.succeeding[question_id], count=len(self.states)).view(np.bool_)

    @cached_property
    def poses(self) -> F32:
        """(states, 5) x, y, yaw_deg, horizon_deg, 1 if it stands; read-only."""
        poses = self.states.poses()
        poses.flags.writeable = False
        return poses

    @cached_property
    def positions(self) -> F64:
        """(cells, 2) x, y of the cells, metres."""
        return self.states.positions()


class Views:
    """A finished cache of views.

    Parameters
    ----------
    folder : path
        Where it lies.
    root : path, optional
        The dataset that it must be made from.

    Raises
    ------
    DatasetError
        If it is not a finished cache, or one of another dataset.
    """

    def __init__(self, folder: str | os.PathLike[str], root: str | os.PathLike[str] | None = None) -> None:
        self.folder = Path(folder)
        self.manifest = _loaded(self.folder)
        if root is not None:
            self.manifest.origin.check(Origin.of(load_manifest(root), self.size_px), self.folder)
        self._rooms = {room.scene: room for room in self.manifest.rooms}
        self.room = lru_cache(OPEN_ROOMS)(self._room)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.folder,)  # another process opens the files for itself

    @property
    def size_px(self) -> int:
        """Width and height of the frames."""
        return self.manifest.origin.size_px

    def has(self, scene: str, configuration: int) -> bool:
        """Whether a configuration of a room is cached."""
        return scene in self._rooms and configuration in self._rooms[scene].configurations

    def _room(self, scene: str, configuration: int) -> RoomViews:
        """One configuration of a room.

        Raises
        ------
        UnknownNameError
            If the room is not cached.
        DatasetError
            If its configuration is not, or its files cannot be read.
        """
        if scene not in self._rooms:
            raise UnknownNameError("scene", scene, self._rooms)
        room = self._rooms[scene]
        if configuration not in room.configurations:
            raise DatasetError(f"{self.folder}: {scene} has configurations {room.configurations}, not {configuration}")
        return read_room(self.folder, room, configuration)


def _loaded(folder: Path) -> ViewsManifest:
    manifest = load_views_manifest(folder)
    if manifest is None:
        raise DatasetError(f"{folder} is no cache of views; make one with remqa-data cache DATASET --out {folder}")
    if not manifest.is_finished:
        raise DatasetError(f"{folder} is not finished; run remqa-data cache again, it goes on")
    return manifest


def read_room(folder: Path, room: CachedRoom, configuration: int) -> RoomViews:
    """A configuration of a finished room of a cache, which need not be finished; errors as in `Views.room`."""
    folder = folder / room.scene
    table = load_table(folder / table_name(configuration))
    states = States(tuple(map(tuple, table["cells"].tolist())), float(table["step_m"]))
    features = None if room.features is None else mapped(folder / features_name(configuration))
    views = RoomViews(
        states=states,
        transitions=Transitions(table["transitions"], table["refusals"], tuple(table["reasons"].tolist())),
        is_reachable=table["is_reachable"],
        frames=mapped(folder / FRAMES),
        features=features,
        pixels=mapped(folder / PIXELS),
        colors=mapped(folder / COLORS),
        patch_starts=table["patch_starts"].tolist(),
        succeeding=dict(zip(table["question_ids"].tolist(), table["succeeds"], strict=True)),
    )
    _check_shapes(folder, room, views)
    return views


def _check_shapes(folder: Path, room: CachedRoom, views: RoomViews) -> None:
    """Files of different runs do not fit together."""
    count: dict[str, Any] = {
        "states": len(views.states),
        "frames": len(views.frames),
        "transitions": len(views.transitions.table),
        "patches": len(views.patch_starts) - 1,
        "features": room.states if views.features is None else len(views.features),
    }
    wrong = [name for name, number in count.items() if number != room.states]
    if wrong or views.patch_starts[-1] > len(views.pixels):
        raise DatasetError(f"{folder}: {', '.join(wrong) or 'patches'} of another run; run remqa-data cache again")
