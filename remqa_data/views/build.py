"""Makes a cache of views: one room is one job, and what is finished and whole is kept."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from remqa_data.errors import ConfigError, DatasetError, UnknownNameError
from remqa_data.files import is_remote
from remqa_data.processes.executors import Executor, LocalExecutor
from remqa_data.storage.folder import Folder
from remqa_data.storage.locks import LOCK, exclusive
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.views import LEAST_PX, MOST_PX, SIZE_PX
from remqa_data.views.features import load_function
from remqa_data.views.manifest import CachedRoom, Origin, ViewsManifest, finished_rooms, is_plain, load_views_manifest
from remqa_data.views.room import Configuration, RoomJob, make_room
from remqa_data.views.tasks import NavigationTask, navigation_tasks

Progress = Callable[[int, int, CachedRoom], None]
"""Called with how many rooms are done, of how many, and the one that is."""


@dataclass(frozen=True)
class Wanted:
    """What to cache.

    Attributes
    ----------
    scenes : tuple of str or None
        Rooms by name; None for all.
    split : str or None
        Only rooms of this split.
    configurations : tuple of int or None
        Of each room; None for those that are asked about.
    size_px : int
        Width and height of the frames.
    features : str or None
        See `remqa_data.views.features`.
    """

    scenes: tuple[str, ...] | None = None
    split: str | None = None
    configurations: tuple[int, ...] | None = None
    size_px: int = SIZE_PX
    features: str | None = None


def cache_views(
    root: str | os.PathLike[str],
    out: str | os.PathLike[str],
    wanted: Wanted | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ViewsManifest:
    """Cache the views of a dataset's rooms, or go on with a cache: rooms that are in it already stay.

    Parameters
    ----------
    root : path
        A finished dataset.
    out : path
        Folder of the cache; nothing else may lie there.
    wanted : Wanted, optional
        What to cache, by default all that is asked about.
    executor : Executor, optional
        Where rooms are made, by default in this process. The bytes do not depend on it.
    progress : callable, optional
        See `Progress`.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, the folder holds another cache or anything else, or another run writes there.
    UnknownNameError
        If the dataset has no such room.
    ConfigError
        If something is wanted that cannot be.
    """
    wanted = wanted or Wanted()
    if not LEAST_PX <= wanted.size_px <= MOST_PX:
        raise ConfigError(f"frames of {wanted.size_px} px: give a size from {LEAST_PX} to {MOST_PX}")
    if is_remote(out):
        raise ConfigError(f"{out}: views are mapped into memory; give a folder of this machine")
    if wanted.features is not None:
        load_function(wanted.features)  # what cannot be is told before anything is done
    origin = Origin.of(load_manifest(root), wanted.size_px)
    folder = Path(out)
    _check_place(folder, origin)
    rooms = _rooms(root, wanted)
    with exclusive(Folder(folder)):
        before = load_views_manifest(folder)
        kept = {room.scene: room for room in before.rooms} if before else {}
        known = kept | finished_rooms(folder, list(rooms))
        features = _features(folder, known.values(), wanted.features)
        jobs = [_job(folder, scene, rooms[scene], known.get(scene), wanted, features) for scene in rooms]
        jobs = [job for job in jobs if job.configurations]
        if not jobs:
            raise ConfigError(f"{root}: nothing is asked about these rooms in these configurations; name others")
        others = tuple(room for scene, room in kept.items() if scene not in {job.scene for job in jobs})
        ViewsManifest(origin, others).save(folder)
        made: list[CachedRoom] = []
        for _, room in (executor or LocalExecutor()).run(make_room, jobs):
            made.append(room)
            if progress is not None:
                progress(len(made), len(jobs), room)
        manifest = ViewsManifest(origin, tuple(sorted((*others, *made), key=lambda room: room.scene)), is_finished=True)
        manifest.save(folder)
    return manifest


def _check_place(folder: Path, origin: Origin) -> None:
    """Refuse another cache, and anything that is none."""
    if folder.exists() and not folder.is_dir():
        raise DatasetError(f"{folder} is a file; give a folder")
    before = load_views_manifest(folder)
    if before is not None:
        before.origin.check(origin, folder)
    elif folder.is_dir() and any(path.name != LOCK for path in folder.iterdir()):
        raise DatasetError(f"{folder} is not empty and no cache of views; give another folder")


def _rooms(root: str | os.PathLike[str], wanted: Wanted) -> dict[str, list[Configuration]]:
    """All configurations of the rooms that are wanted."""
    dataset = load_manifest(root)
    splits = dataset.splits("scenes")
    if wanted.split is not None and wanted.split not in splits:
        raise ConfigError(f"{root} has no split {wanted.split!r}; it has: {', '.join(splits)}")
    rooms: dict[str, list[Configuration]] = {}
    for split in splits if wanted.split is None else [wanted.split]:
        asked: dict[tuple[str, int], list[NavigationTask]] = {}
        for task in navigation_tasks(root, split) if split in dataset.splits("questions") else ():
            asked.setdefault((task.scene, task.configuration), []).append(task)
        table = read_table(root, "scenes", split, ["scene", "configuration", "scene_json", "embodiment"])
        for row in table.to_pylist():
            tasks = tuple(asked.get((row["scene"], row["configuration"]), ()))
            one = Configuration(row["configuration"], row["scene_json"], row["embodiment"], tasks)
            if not is_plain(row["scene"]):  # a folder is called so
                raise DatasetError(
                    f"{root}: {row['scene']!r:.60} is no name of a room; fetch or generate the dataset again"
                )
            rooms.setdefault(row["scene"], []).append(one)
    if wanted.scenes is None:
        return rooms
    for name in wanted.scenes:
        if name not in rooms:
            raise UnknownNameError("scene", name, rooms)
    return {name: rooms[name] for name in wanted.scenes}


def _features(folder: Path, known: Iterable[CachedRoom], wanted: str | None) -> str | None:
    """The function whose features the cache has from now on: one, or none."""
    before = next((room.features for room in known if room.features is not None), None)
    if before is not None and wanted not in (None, before):
        raise DatasetError(f"{folder} has features of {before}, not of {wanted}; give another folder")
    return wanted or before


def _job(
    folder: Path,
    scene: str,
    configurations: list[Configuration],
    known: CachedRoom | None,
    wanted: Wanted,
    features: str | None,
) -> RoomJob:
    """The job of a room: what is wanted of it, and what is cached of it already."""
    numbers = (
        {one.number for one in configurations if one.tasks}
        if wanted.configurations is None
        else set(wanted.configurations)
    )
    numbers |= set(known.configurations) if known else set()
    chosen = tuple(sorted((one for one in configurations if one.number in numbers), key=lambda one: one.number))
    return RoomJob(folder, scene, wanted.size_px, chosen, features)
