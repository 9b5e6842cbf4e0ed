"""From a configuration file to a dataset: one room is one job, and the jobs' parts are merged in a fixed order."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from remqa_data.dataset_card import write_card
from remqa_data.errors import ArrangementError, DatasetError
from remqa_data.generators.allotment import SceneQuota, allot, capacities
from remqa_data.generators.config import Config
from remqa_data.generators.configurations import Configuration, Hidden, arrange
from remqa_data.generators.expressions import Expression, Expressions
from remqa_data.generators.floorplans.ithor import load_scene
from remqa_data.generators.groups import GroupPlan, wishes
from remqa_data.generators.hiding_places import HidingPlace, hiding_places
from remqa_data.generators.placement_priors import fitting_types
from remqa_data.generators.planning import plan_groups
from remqa_data.generators.samples import Refusal, Room, make_sample
from remqa_data.generators.selection import select
from remqa_data.generators.tour import Place, tour
from remqa_data.manifest import Manifest, make_manifest
from remqa_data.metadata import object_metadata
from remqa_data.parts import assemble, begin_parts, count_questions, finish, read_report, write_scene_part
from remqa_data.rows import QuestionRow, Row, Split
from remqa_data.scene import Scene
from remqa_data.scene_graph import SceneGraph
from remqa_data.sim.navigation import ReachableGrid
from remqa_data.sim.viewpoints import HEADINGS_DEG, AgentPose
from remqa_data.sim.world import World
from remqa_data.version import __version__

PLANS = 25
"""How often a room's questions are planned anew when an arrangement of them cannot be made."""
MIN_WAY_CELLS = 3
"""An episode starts at least so many cells from the goal, where the room allows it."""
SHARDS = {"train": 5, "val": 1, "test": 1}


@dataclass(frozen=True)
class Job:
    """All that one room needs; it can be sent to another process."""

    quota: SceneQuota
    config: Config

    @property
    def scene(self) -> str:
        """The room."""
        return self.quota.scene


def generate(
    out: Path,
    config: Config,
    workers: int = 1,
    progress: Callable[[str, Mapping[str, Any]], None] | None = None,
) -> Manifest:
    """Generate a dataset, or go on with one that was interrupted.

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


def make_room(job: Job) -> tuple[dict[str, list[Row]], dict[str, Any]]:
    """All rows of one room by table, and the report: samples refused by the truth that they would have broken.

    Raises
    ------
    QuotaError
        If the room cannot have the questions that it owes.
    ArrangementError
        If its things cannot be arranged.
    """
    base = load_scene(job.scene)
    places = hiding_places(base)
    expressions = expressions_of_places(base, places)
    refused: Counter[str] = Counter()
    groups, arranged = _planned(job, base, places, expressions, refused)
    rows: dict[str, list[Row]] = {"scenes": [], "frames": [], "expressions": [], "questions": []}
    samples: dict[tuple[str, int], QuestionRow] = {}
    for number, configuration in enumerate(arranged):
        made = _in_configuration(job, number, configuration.scene, groups, rows, refused)
        samples |= {(sample.group, number): sample for sample in made}
    passed = {group.name: [c for c in range(len(arranged)) if (group.name, c) in samples] for group in groups}
    for name, configurations in select(groups, passed, job.quota).items():
        rows["questions"] += [samples[name, c] for c in configurations]
    report = {
        "questions": len(rows["questions"]),
        "frames": len(rows["frames"]),
        "refused": dict(sorted(refused.items())),
    }
    return rows, report


def _planned(
    job: Job,
    base: Scene,
    places: list[HidingPlace],
    expressions: Mapping[str, list[Expression]],
    refused: Counter[str],
) -> tuple[list[GroupPlan[HidingPlace]], list[Configuration]]:
    """Questions of a room and its configurations; what turns out not to fit a place is not asked for there again."""
    misfits: set[tuple[str, str, str]] = set()

    @cache
    def fitting_at_first(place: HidingPlace, count: int) -> list[tuple[str, float]]:
        return fitting_types(place, job.quota.room_type, count)

    def fitting(place: HidingPlace, count: int) -> list[tuple[str, float]]:
        return [
            (name, weight)
            for name, weight in fitting_at_first(place, count)
            if (place.object_id, place.relation, name) not in misfits
        ]

    for attempt in range(PLANS):
        groups = plan_groups(
            places,
            expressions,
            fitting,
            job.quota,
            job_rng(job, f"plan {attempt}"),
            job.config.configurations,
            job.config.spare_groups.by_kind(),
        )
        try:
            return groups, [_arranged(job, base, places, groups, c) for c in range(job.config.configurations)]
        except ArrangementError as error:
            refused["arrangement"] += 1
            last = error
            if len(error.types) > 1:  # each may fit, but not all at the same time
                places = [_with_less_room(place) if _is_meant(error, place) else place for place in places]
            else:
                misfits |= {(error.place_id, error.relation, name) for name in error.types}
    raise last


def _is_meant(error: ArrangementError, place: HidingPlace) -> bool:
    return (place.object_id, place.relation) == (error.place_id, error.relation)


def _with_less_room(place: HidingPlace) -> HidingPlace:
    return replace(place, spots=place.spots[: max(len(place.spots) - 1, 1)])


def job_rng(job: Job, purpose: str) -> np.random.Generator:
    """Random numbers of one room for one purpose, whatever is drawn for others."""
    codes = [job.config.seed, zlib.crc32(job.scene.encode()), zlib.crc32(purpose.encode())]
    return np.random.default_rng(np.random.SeedSequence(codes))


def expressions_of_places(scene: Scene, places: Iterable[HidingPlace]) -> dict[str, list[Expression]]:
    """Referring expressions of the places of a room, with everything closed, by object id."""
    with World(scene) as world:
        world.settle()
        for place in places:
            if place.manipulation == "Open":
                world.open(place.object_id, 0.0)
        found = Expressions(SceneGraph.from_objects(object_metadata(world).values()))
        return {place.object_id: found.of(place.object_id) for place in places}


def _arranged(
    job: Job, base: Scene, places: list[HidingPlace], groups: list[GroupPlan[HidingPlace]], number: int
) -> Configuration:
    hidden = [Hidden(wish.place, wish.type, wish.count) for wish in wishes(groups, number)]
    return arrange(base, places, hidden, job_rng(job, f"arrange {number}"))


def _in_configuration(
    job: Job,
    number: int,
    scene: Scene,
    groups: list[GroupPlan[HidingPlace]],
    rows: dict[str, list[Row]],
    refused: Counter[str],
) -> list[QuestionRow]:
    """Walk through one configuration, adding its rows, and make the samples of all groups in it."""
    rng = job_rng(job, f"walk {number}")
    place = Place(job.scene, job.quota.room_type, number, job.quota.split, job.config.seed)
    room = Room(place, scene, job.config.image.rgb_format)
    try:
        start = room.grid.cells[int(rng.integers(len(room.grid.cells)))]
        found = {object_id: room.expressions.of(object_id) for object_id in room.replay.world.ids}
        walked = tour(
            place,
            room.replay.view,
            room.grid,
            start,
            found,
            job.config.walk.settings(job.config.image.size_px),
            rng,
            rgb_format=job.config.image.rgb_format,
            expression_split=expression_split(job.scene),
        )
        rows["scenes"].append(walked.scene)
        rows["frames"] += walked.frames
        rows["expressions"] += walked.expressions
        made = []
        for group in groups:
            sample = make_sample(room, group, _start(room.grid, group, job_rng(job, f"start {group.name} {number}")))
            if isinstance(sample, Refusal):
                refused[sample.truth] += 1
            else:
                made.append(sample)
        return made
    finally:
        room.close()


def _start(grid: ReachableGrid, group: GroupPlan[HidingPlace], rng: np.random.Generator) -> AgentPose:
    """Somewhere in the room, not right at the goal, looking any way."""
    goal = group.question.place.goal.cell
    away = [cell for cell in grid.cells if abs(cell[0] - goal[0]) + abs(cell[1] - goal[1]) >= MIN_WAY_CELLS]
    cells = away or grid.cells
    return AgentPose(cells[int(rng.integers(len(cells)))], int(rng.choice(HEADINGS_DEG)), 0)


def expression_split(scene: str) -> Split:
    """Split of a room's referring expressions: AI2-THOR's usual one, 1-20 train, 21-25 val, 26-30 test of each type.

    >>> [expression_split(f"FloorPlan{n}") for n in (20, 221, 430)]
    ['train', 'val', 'test']
    """
    number = int(scene.removeprefix("FloorPlan")) % 100
    if number > 25:
        return "test"
    return "val" if number > 20 else "train"


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
