"""From a configuration file to a dataset: one room is one job, and the jobs' parts are merged in a fixed order."""

from __future__ import annotations

import gc
import math
import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter

from remqa_data.errors import DamagedShardError, DatasetError, one_line
from remqa_data.generators.config import Config
from remqa_data.generators.questions.allotment import SceneQuota, allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.generators.questions.shortfalls import Answers, Deal, dealt_anew
from remqa_data.generators.scene_job import make_room
from remqa_data.generators.scene_plan import Job
from remqa_data.processes.executors import Executor, LocalExecutor
from remqa_data.storage.backend import storage_at
from remqa_data.storage.card import write_card
from remqa_data.storage.folder import Folder
from remqa_data.storage.locks import exclusive
from remqa_data.storage.manifest import (
    MANIFEST,
    FileInfo,
    Manifest,
    dataset_around,
    load_manifest,
    make_manifest,
    version_here,
    versions_here,
)
from remqa_data.storage.ownership import SPLITS, clear, look, mark, remove_parts
from remqa_data.storage.parts import Part, Parts, assemble, count_questions, finish
from remqa_data.storage.protocol import Storage
from remqa_data.storage.shards import check_files, check_sizes
from remqa_data.tables.rows import Row

FEWEST_SHARDS = {"train": 5}
"""Of a table in a split; in the others one."""
ROOMS_PER_SHARD = 20

DEAL = "deal.json"
"""What the rooms are asked for, once that is something else than the first allotment."""

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
        Where the dataset shall lie, see `storage_at`; nothing else may lie there.
    config : Config
        What to generate.
    executor : Executor, optional
        Where rooms are made, by default in this process. The bytes do not depend on it.
    progress : callable, optional
        See `Progress`.
    overwrite : bool
        Whether to remove first the dataset that is there.

    Raises
    ------
    RemqaError
        If a room cannot have its questions, or there is another dataset or anything else, or another run is writing one.
    """
    executor = executor or LocalExecutor()
    storage = storage_at(out)
    first = allot(capacities(config.scene_names), config.totals)  # what cannot be is told before anything is done
    place = look(storage)
    if not overwrite and place.is_finished and not place.has_parts and not place.lacks:
        return _finished(storage, config)  # it can be read even if nothing can be written there
    with exclusive(storage) as lock:
        place = look(storage)
        if place.is_finished and not overwrite:
            manifest = _finished(storage, config)
            write_card(storage.root, manifest, place.lacks)
            remove_parts(storage)  # whoever wrote the manifest was killed before that
            return manifest
        mark(storage)
        if overwrite:
            clear(storage)
        parts = Parts(storage.root, {"config": config.sha256, "seed": config.seed, "versions": versions_here()})
        made, quotas = _made_rooms(parts, config, first, executor, progress)
        shards = shards_per_split((file.table, file.split) for part in made for file in part.files)
        files = assemble(parts, made, shards, executor)
        anew = {new.scene: _plain(new.answers) for old, new in zip(first, quotas, strict=True) if new != old}
        manifest = _manifest(config, made, anew, files)
        look(storage)  # once more, hours later: a README.md may be somebody else's
        write_card(storage.root, manifest)
        lock.confirm()
        finish(storage, manifest)
    return manifest


@dataclass(frozen=True)
class RoomJob:
    """A room to make, and where its part goes."""

    parts: Parts
    room: Job

    def write(self, rows: Mapping[str, Sequence[Row]], report: Mapping[str, Any]) -> Part:
        """The part of the room, which says what was asked for."""
        return self.parts.write(self.room.scene, rows, {**report, "asked": _plain(self.room.quota.answers)})


def make_part(job: RoomJob) -> Part:
    """Generate one room and write its part."""
    with _rare_collections():
        rows, report = make_room(job.room)
    return job.write(rows, report)


@contextmanager
def _rare_collections() -> Iterator[None]:
    """Look for cycles of dead objects much more rarely: a room makes few, and each look goes through all that is known."""
    usual = gc.get_threshold()
    gc.set_threshold(50_000, 20, 100)
    try:
        yield
    finally:
        gc.set_threshold(*usual)


def check_place(out: str | os.PathLike[str], *, overwrite: bool, resume: bool) -> None:
    """Refuse to write among other files.

    Raises
    ------
    DatasetError
        If the place holds anything but a dataset of ours, or that and neither overwriting nor resuming was asked for; or if
        it is in another dataset.
    """
    storage = storage_at(out)
    if isinstance(storage, Folder) and storage.path.exists() and not storage.path.is_dir():
        raise DatasetError(f"{out} is a file; give a folder")
    if isinstance(storage, Folder) and (outer := dataset_around(storage.path)):
        raise DatasetError(f"{out} is in the dataset {outer}, which holds nothing else; give another folder")
    if not look(storage).is_empty and not (overwrite or resume):
        raise DatasetError(
            f"{out} is not empty; use --resume to go on with it, --overwrite to replace it, or another folder"
        )


def _finished(storage: Storage, config: Config) -> Manifest:
    """The manifest of a finished dataset, if it is the one that is asked for, and whole."""
    manifest = load_manifest(storage.root)
    if (manifest.config_sha256, manifest.versions.get("remqa-data")) != (config.sha256, version_here()):
        raise DatasetError(
            f"{storage.where()} holds a finished dataset of another configuration, seed, version or templates; "
            "use --overwrite to replace it, or another folder"
        )
    asked = {f"{split}.{kind}" for split, kinds in config.totals.items() for kind in kinds}
    for name in (f"{split}.{kind}" for split, kinds in manifest.questions.items() for kind in kinds):
        if name not in asked:
            raise DatasetError(
                f"{storage.where(MANIFEST)}: questions.{one_line(name):.40}: the configuration asks for none; "
                "use --overwrite to replace the dataset, or another folder"
            )
    try:
        if isinstance(storage, Folder):
            check_files(storage.root)
        else:
            check_sizes(storage, manifest)  # a bucket sees to it itself that bytes stay as they are
    except DamagedShardError as error:
        raise DatasetError(f"{error}, with --overwrite") from None
    return manifest


def _made_rooms(
    parts: Parts, config: Config, first: Sequence[SceneQuota], executor: Executor, progress: Progress | None
) -> tuple[list[Part], tuple[SceneQuota, ...]]:
    """Parts of all rooms, in the order of the configuration, and what they were asked for in the end.

    What is missing when all rooms are made is asked of other rooms, which are then made again.
    """
    tell = progress or (lambda scene, report: None)
    rooms = capacities(config.scene_names)
    deal = _deal_so_far(parts) or Deal(tuple(first))
    told: set[str] = set()
    while True:
        asked = {quota.scene: _plain(quota.answers) for quota in deal.quotas}
        made = {name: part for name, part in parts.finished().items() if part.report.get("asked") == asked.get(name)}
        for scene in sorted(set(made) - told):
            tell(scene, made[scene].report)
        jobs = [RoomJob(parts, Job(quota, config)) for quota in deal.quotas if quota.scene not in made]
        for _, part in executor.run(make_part, jobs):
            made[part.scene] = part
            tell(part.scene, part.report)
        told |= set(made)
        anew = dealt_anew(rooms, deal, {scene: part.report.get("short", {}) for scene, part in made.items()})
        if anew is None:
            return [made[quota.scene] for quota in deal.quotas], deal.quotas
        parts.keep(DEAL, _DEAL.dump_json(anew))
        deal = anew


def _deal_so_far(parts: Parts) -> Deal | None:
    """What an interrupted run asked of the rooms last, if it had come so far as to ask anew."""
    text = parts.kept(DEAL)
    return None if text is None else _DEAL.validate_json(text)


def _plain(answers: Answers) -> dict[str, dict[str, int]]:
    return {kind: dict(of_kind) for kind, of_kind in answers.items()}


def shards_per_split(rooms: Iterable[tuple[str, str]]) -> dict[str, int]:
    """How many shards a table has in each split: more for more rooms, so that they stay about as large.

    Parameters
    ----------
    rooms : iterable of (str, str)
        For each room, the tables and splits in which it has rows.
    """
    counts = Counter(rooms)
    most = {split: max((count for (_, s), count in counts.items() if s == split), default=0) for split in SPLITS}
    return {split: max(FEWEST_SHARDS.get(split, 1), math.ceil(n / ROOMS_PER_SHARD)) for split, n in most.items()}


def _manifest(
    config: Config,
    made: Sequence[Part],
    anew: Mapping[str, Mapping[str, Mapping[str, int]]],
    files: tuple[FileInfo, ...],
) -> Manifest:
    refused: Counter[str] = Counter()
    for part in made:
        refused.update(part.report["refused"])
    return make_manifest(
        files,
        seed=config.seed,
        config=config.model_dump(mode="json"),
        questions=count_questions(made),
        refused=refused,
        asked_anew=anew,
    )


_DEAL = TypeAdapter(Deal)
