"""Makes the cache of one room: draws what is seen in each state, and finds where actions lead and what succeeds."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from remqa_data.env.episodes import Episode
from remqa_data.env.loaded_scene import LoadedRoom
from remqa_data.errors import DatasetError
from remqa_data.files import name_of_leftover
from remqa_data.geometry.types import Flags
from remqa_data.metrics import distance_to_goal_m, navigation_success
from remqa_data.scene import Scene
from remqa_data.sim.metadata import is_visible
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.tables.rows import configuration_name
from remqa_data.views.arrays import COLORS, FRAMES, PIXELS, new_array, save_table, table_name
from remqa_data.views.features import add_features
from remqa_data.views.manifest import NOTE, CachedRoom, ViewFile, finished_rooms
from remqa_data.views.states import TURNS, States
from remqa_data.views.tasks import NavigationTask
from remqa_data.views.transitions import transitions


@dataclass(frozen=True)
class Configuration:
    """A configuration of a room as the dataset has it, and what is asked about it."""

    number: int
    scene_json: str
    embodiment: dict[str, float]
    tasks: tuple[NavigationTask, ...]


@dataclass(frozen=True)
class RoomJob:
    """All that is needed to make the cache of one room.

    Attributes
    ----------
    folder : path
        Of the cache.
    features : str or None
        See `remqa_data.views.features.load_function`.
    """

    folder: Path
    scene: str
    size_px: int
    configurations: tuple[Configuration, ...]
    features: str | None = None


def make_room(job: RoomJob) -> CachedRoom:
    """Make the room, or what is missing of it: files that are as they were written are kept.

    Raises
    ------
    DatasetError
        If the dataset asks about what is not in the room.
    """
    _tidy(job.folder / job.scene)
    numbers = tuple(configuration.number for configuration in job.configurations)
    room = finished_rooms(job.folder, [job.scene]).get(job.scene)
    if room is None or room.configurations != numbers or not room.is_whole(job.folder):
        (job.folder / job.scene / NOTE).unlink(missing_ok=True)
        room = _drawn(job)
        room.save(job.folder)
    if job.features is not None and room.features != job.features:
        files = add_features(job.folder, room, job.features)
        room = replace(room, files=room.files + files, features=job.features)
        room.save(job.folder)
    return room


def _tidy(folder: Path) -> None:
    """Remove what a killed run left half-written."""
    for path in folder.iterdir() if folder.is_dir() else ():
        if name_of_leftover(path.name):
            path.unlink()


def _drawn(job: RoomJob) -> CachedRoom:
    folder = job.folder / job.scene
    with ExitStack() as stack:
        loaded = [_loaded(job, configuration, stack) for configuration in job.configurations]
        states = States.of((c for one in loaded for c in one.agent.grid.cells), loaded[0].agent.embodiment.step_m)
        if not states.cells:
            raise DatasetError(f"{job.scene}: there is no cell on which the agent can stand")
        shape = (len(states), job.size_px, job.size_px, 3)
        with new_array(folder / FRAMES, shape, np.uint8) as frames:
            patches = _Patches(frames)
            starts = [patches.draw(one, states) for one in loaded]
        patches.save(folder)
        for configuration, one, start in zip(job.configurations, loaded, starts, strict=True):
            save_table(folder / table_name(configuration.number), **_table(configuration, one, states, start))
        count = sum(len(one.agent.grid.cells) for one in loaded) * len(TURNS)
    numbers = tuple(configuration.number for configuration in job.configurations)
    names = (FRAMES, PIXELS, COLORS, *map(table_name, numbers))
    files = tuple(ViewFile.of(job.folder, f"{job.scene}/{name}") for name in names)
    return CachedRoom(job.scene, numbers, len(states), count, files)


def _loaded(job: RoomJob, configuration: Configuration, stack: ExitStack) -> LoadedRoom:
    """The room as the live environment has it when an episode begins."""
    place = configuration_name(job.scene, configuration.number)
    scene = Scene.from_json(configuration.scene_json, place)
    embodiment = Embodiment.of_dataset(**configuration.embodiment)
    loaded = LoadedRoom(Episode(place, scene, None, embodiment, None), "near")
    stack.enter_context(closing(loaded.world))
    return loaded


class _Patches:
    """The frames of a room, and where configurations differ from them."""

    def __init__(self, frames: npt.NDArray[np.uint8]) -> None:
        self._frames, self._is_drawn = frames, np.zeros(len(frames), dtype=np.bool_)
        self._pixels: list[npt.NDArray[np.uint16]] = []
        self._colors: list[npt.NDArray[np.uint8]] = []
        self._count = 0

    def draw(self, room: LoadedRoom, states: States) -> npt.NDArray[np.int64]:
        """Draw all states of a configuration; (states + 1,) where the patches of each begin, and where the last ends."""
        counts, size = np.zeros(len(states), dtype=np.int64), self._frames.shape[1]
        first = self._count
        for state in states.of_cells(room.agent.grid.cells):
            states.place(room.agent, state)
            rgb = room.view.render(room.agent.camera(size, size)).rgb
            if not self._is_drawn[state]:
                self._frames[state], self._is_drawn[state] = rgb, True
                continue
            pixels = np.flatnonzero((rgb != self._frames[state]).any(axis=2))
            counts[state] = len(pixels)
            self._count += len(pixels)
            self._pixels.append(pixels.astype(np.uint16))
            self._colors.append(rgb.reshape(-1, 3)[pixels])
        return first + np.concatenate([[0], np.cumsum(counts)])

    def save(self, folder: Path) -> None:
        """Write the patches."""
        with new_array(folder / PIXELS, (self._count,), np.uint16) as pixels:
            pixels[:] = np.concatenate([np.empty(0, np.uint16), *self._pixels])
        with new_array(folder / COLORS, (self._count, 3), np.uint8) as colors:
            colors[:] = np.concatenate([np.empty((0, 3), np.uint8), *self._colors])


def _table(
    configuration: Configuration, room: LoadedRoom, states: States, patch_starts: npt.NDArray[np.int64]
) -> dict[str, npt.NDArray[Any]]:
    cells = room.agent.grid.cells
    where = transitions(room.agent, states, cells)
    succeeds = _succeeds(configuration.tasks, room, states)
    return {
        "cells": np.array(states.cells, dtype=np.int32),
        "step_m": np.array(states.step_m),
        "is_reachable": np.isin(np.arange(len(states)), list(states.of_cells(cells))),
        "transitions": where.table,
        "refusals": where.refusals,
        "reasons": np.array(where.reasons),
        "patch_starts": patch_starts,
        "question_ids": np.array([task.question_id for task in configuration.tasks], dtype=np.str_),
        "succeeds": np.packbits(succeeds, axis=1),
    }


def _succeeds(tasks: Sequence[NavigationTask], room: LoadedRoom, states: States) -> Flags:
    """(tasks, states) in which states an agent that stops has navigated to a question's target.

    The target is looked for in the 300 x 300 view of `remqa_data.env.record`, whatever the size of the frames.
    """
    succeeds = np.zeros((len(tasks), len(states)), dtype=np.bool_)
    near = np.array([_is_near(task, states) for task in tasks], dtype=np.bool_).reshape(len(tasks), len(states.cells))
    targets = [_number_of_target(task, room) for task in tasks]
    for state in states.of_cells(cell for cell in room.agent.grid.cells if near[:, states.cell_number(cell)].any()):
        states.place(room.agent, state)
        image = room.view.instances(room.agent.camera())
        seen: dict[int, bool] = {}
        for task in np.flatnonzero(near[:, state // len(TURNS)]).tolist():
            target = targets[task]
            if target not in seen:
                seen[target] = is_visible(image == target)
            succeeds[task, state] = seen[target]
    return succeeds


def _is_near(task: NavigationTask, states: States) -> Flags:
    """(cells,) on which an agent that sees the target has navigated to it."""
    distance_m = distance_to_goal_m(states.positions(), task.goals[None])
    return navigation_success(distance_m, np.ones(len(states.cells), dtype=np.bool_))


def _number_of_target(task: NavigationTask, room: LoadedRoom) -> int:
    if task.target_id not in room.world.ids:
        raise DatasetError(
            f"question {task.question_id}, field target_id: {room.episode.name} has no {task.target_id!r:.80}"
        )
    return room.world.ids.index(task.target_id)
