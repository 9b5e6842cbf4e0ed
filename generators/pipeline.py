"""From a configuration file to a dataset: one room is one job, and the jobs' parts are merged in a fixed order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from remqa_data.dataset_card import write_card
from remqa_data.errors import DatasetError
from remqa_data.generators.allotment import allot, capacities
from remqa_data.generators.config import Config
from remqa_data.generators.room import make_room
from remqa_data.generators.room_plan import Job
from remqa_data.manifest import MANIFEST, Manifest, load_manifest, make_manifest
from remqa_data.parts import assemble, begin_parts, count_questions, finish, read_report, write_scene_part
from remqa_data.version import __version__

SHARDS = {"train": 5, "val": 1, "test": 1}


def generate(
    out: Path,
    config: Config,
    workers: int = 1,
    progress: Callable[[str, Mapping[str, Any]], None] | None = None,
) -> Manifest:
    """Generate a dataset, go on with one that was interrupted, or leave a finished one as it is.

    Parameters
    ----------
    out : Path
        Folder of the dataset; holds nothing else.
    config : Config
        What to generate.
    workers : int
        Number of processes. The bytes do not depend on it.
    progress : callable, optional
        Called with the name and the report of each room when it is finished.

    Raises
    ------
    RemqaError
        If a room cannot have its questions, or the folder belongs to another run.
    """
    if (out / MANIFEST).is_file():
        return _finished(out, config)
    quotas = allot(capacities(config.scene_names), config.totals)
    run = {"config": config.sha256, "seed": config.seed, "version": __version__}
    done = set(begin_parts(out, run))
    for scene in sorted(done):
        _tell(progress, scene, read_report(out, scene))
    jobs = [Job(quota, config) for quota in quotas if quota.scene not in done]
    for scene, report in _run(out, jobs, workers):
        _tell(progress, scene, report)
    order = [quota.scene for quota in quotas]
    files = assemble(out, order, SHARDS)
    refused: Counter[str] = Counter()
    for scene in order:
        refused.update(read_report(out, scene)["refused"])
    manifest = make_manifest(
        files,
        seed=config.seed,
        config=config.model_dump(mode="json"),
        questions=count_questions(out, files),
        refused=dict(refused),
    )
    write_card(out, manifest)
    finish(out, manifest)
    return manifest


def _finished(out: Path, config: Config) -> Manifest:
    """The manifest of a finished dataset, if it is the one that is asked for."""
    manifest = load_manifest(out)
    if (manifest.config_sha256, manifest.versions["remqa-data"]) != (config.sha256, __version__):
        raise DatasetError(
            f"{out} holds a finished dataset of another configuration, seed or version; "
            "use --overwrite to replace it, or another folder"
        )
    return manifest


def _tell(progress: Callable[[str, Mapping[str, Any]], None] | None, scene: str, report: Mapping[str, Any]) -> None:
    if progress is not None:
        progress(scene, report)


def _run(out: Path, jobs: list[Job], workers: int) -> Iterable[tuple[str, dict[str, Any]]]:
    if workers == 1:
        for job in jobs:
            yield job.scene, make_part(out, job)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        waiting = {pool.submit(make_part, out, job): job for job in jobs}
        try:
            for future in as_completed(waiting):
                yield waiting[future].scene, future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def make_part(out: Path, job: Job) -> dict[str, Any]:
    """Generate one room and write its part; returns its report."""
    rows, report = make_room(job)
    write_scene_part(out, job.scene, rows, report)
    return report


def check_folder(out: Path, *, overwrite: bool, resume: bool) -> None:
    """Refuse to write among other files.

    Raises
    ------
    DatasetError
        If the folder is not empty and neither overwriting nor resuming was asked for.
    """
    if out.exists() and not out.is_dir():
        raise DatasetError(f"{out} is a file; give a folder")
    if out.is_dir() and any(out.iterdir()) and not (overwrite or resume):
        raise DatasetError(
            f"{out} is not empty; use --resume to go on with it, --overwrite to replace it, or another folder"
        )
