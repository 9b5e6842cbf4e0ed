"""From a configuration file to a dataset: one room is one job, and the jobs' parts are merged in a fixed order."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from remqa_data.errors import DamagedShardError, DatasetError
from remqa_data.generators.config import Config
from remqa_data.generators.questions.allotment import SceneQuota, allot, capacities
from remqa_data.generators.scene_job import make_room
from remqa_data.generators.scene_plan import Job
from remqa_data.processes.executors import Executor, LocalExecutor
from remqa_data.storage.backend import Folder, Storage, storage_at
from remqa_data.storage.card import write_card
from remqa_data.storage.locks import LOCK, exclusive
from remqa_data.storage.manifest import MANIFEST, FileInfo, Manifest, load_manifest, make_manifest
from remqa_data.storage.parts import PARTS, Part, Parts, assemble, count_questions, finish, unfinish
from remqa_data.storage.shards import check_files
from remqa_data.version import __version__

FEWEST_SHARDS = {"train": 5, "val": 1, "test": 1}
ROOMS_PER_SHARD = 20

Progress = Callable[[str, Mapping[str, Any]], None]
"""Called with the name and the report of each room when it is finished."""


def generate(
    out: str | os.PathLike[str],
    config: Config,
    executor: Executor | None = None,
    progress: Progress | None = None,
    *,
    overwrite: bool = False,
) -> Manifest:
    """Generate a dataset, go on with one that was interrupted, or leave a finished one as it is.

    Parameters
    ----------
    out : path or str
        Where the dataset shall lie, see `storage_at`; nothing else does.
    config : Config
        What to generate.
    executor : Executor, optional
        Where rooms are made, by default in this process. The bytes do not depend on it.
    progress : callable, optional
        See `Progress`.
    overwrite : bool
        Whether to remove first whatever there is.

    Raises
    ------
    RemqaError
        If a room cannot have its questions, or there is another dataset, or another run is writing one.
    """
    executor = executor or LocalExecutor()
    storage = storage_at(out)
    quotas = allot(capacities(config.scene_names), config.totals)
    if not overwrite and storage.exists(MANIFEST) and not storage.files(PARTS):
        return _finished(storage, config)  # it can be read even if nothing can be written there
    with exclusive(storage) as lock:
        if overwrite:
            _clear(storage)
        if storage.exists(MANIFEST):
            manifest = _finished(storage, config)
            storage.delete_folder(PARTS)  # whoever wrote the manifest was killed before that
            return manifest
        parts = Parts(storage.root, {"config": config.sha256, "seed": config.seed, "version": __version__})
        made = _made_rooms(parts, quotas, config, executor, progress)
        files = assemble(parts, made, _shards_per_split(made), executor)
        manifest = _manifest(config, made, files)
        write_card(storage.root, manifest)
        lock.confirm()
        finish(storage, manifest)
    return manifest


@dataclass(frozen=True)
class RoomJob:
    """A room to make, and where its part goes."""

    parts: Parts
    room: Job


def make_part(job: RoomJob) -> Part:
    """Generate one room and write its part."""
    rows, report = make_room(job.room)
    return job.parts.write(job.room.scene, rows, report)


def check_place(out: str | os.PathLike[str], *, overwrite: bool, resume: bool) -> None:
    """Refuse to write among other files.

    Raises
    ------
    DatasetError
        If the place is not empty and neither overwriting nor resuming was asked for.
    """
    storage = storage_at(out)
    if isinstance(storage, Folder) and storage.path.exists() and not storage.path.is_dir():
        raise DatasetError(f"{out} is a file; give a folder")
    if not (overwrite or resume) and any(file.path.partition("/")[0] != LOCK for file in storage.files()):
        raise DatasetError(
            f"{out} is not empty; use --resume to go on with it, --overwrite to replace it, or another folder"
        )


def _finished(storage: Storage, config: Config) -> Manifest:
    """The manifest of a finished dataset, if it is the one that is asked for, and whole."""
    manifest = load_manifest(storage.root)
    if (manifest.config_sha256, manifest.versions["remqa-data"]) != (config.sha256, __version__):
        raise DatasetError(
            f"{storage.where()} holds a finished dataset of another configuration, seed or version; "
            "use --overwrite to replace it, or another folder"
        )
    if isinstance(storage, Folder):  # a bucket checks what it stores itself
        try:
            check_files(storage.root)
        except DamagedShardError as error:
            raise DatasetError(f"{error}, with --overwrite") from None
    return manifest


def _clear(storage: Storage) -> None:
    """Remove everything but the lock; the manifest first, so that a half-removed dataset does not look finished."""
    unfinish(storage)
    found = {file.path.partition("/")[0] for file in storage.files()} - {LOCK}
    for name in sorted(found):
        storage.delete([name]) if storage.exists(name) else storage.delete_folder(name)


def _made_rooms(
    parts: Parts, quotas: Sequence[SceneQuota], config: Config, executor: Executor, progress: Progress | None
) -> list[Part]:
    """Parts of all rooms, in the order of the quotas; those that are not there yet are made."""
    tell = progress or (lambda scene, report: None)
    made = parts.finished()
    for scene in sorted(made):
        tell(scene, made[scene].report)
    jobs = [RoomJob(parts, Job(quota, config)) for quota in quotas if quota.scene not in made]
    for _, part in executor.run(make_part, jobs):
        made[part.scene] = part
        tell(part.scene, part.report)
    return [made[quota.scene] for quota in quotas]


def _shards_per_split(made: Sequence[Part]) -> dict[str, int]:
    """More shards for more rooms, so that they stay about as large."""
    rooms: Counter[tuple[str, str]] = Counter()
    for part in made:
        rooms.update({(file.table, file.split) for file in part.files})
    return {
        split: max(fewest, *(math.ceil(count / ROOMS_PER_SHARD) for (_, s), count in rooms.items() if s == split), 0)
        for split, fewest in FEWEST_SHARDS.items()
    }


def _manifest(config: Config, made: Sequence[Part], files: tuple[FileInfo, ...]) -> Manifest:
    refused: Counter[str] = Counter()
    for part in made:
        refused.update(part.report["refused"])
    return make_manifest(
        files,
        seed=config.seed,
        config=config.model_dump(mode="json"),
        questions=count_questions(made),
        refused=refused,
    )
