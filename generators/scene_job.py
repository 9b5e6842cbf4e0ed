"""One room from its floor plan to all its rows: planned, arranged, walked through, asked about and audited."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

from remqa_data.errors import ArrangementError, QuotaError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.floorplans.sampled.naming import is_sampled, sampled_index, sampled_split
from remqa_data.floorplans.sampled.scenes import sampled_scene
from remqa_data.generators.arrangement.hiding_places import HidingPlace
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.selection import select
from remqa_data.generators.samples import AuditedRoom, Refusal, make_sample
from remqa_data.generators.scene_plan import Job, RoomPlan, RoomPlanner
from remqa_data.generators.walks.scene_walk import ConfigurationInfo, walk_through
from remqa_data.scene import Scene
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, AgentPose
from remqa_data.tables.rows import QuestionRow, Row, Split

MIN_WAY_CELLS = 3
"""An episode starts at least so many cells from the goal, where the room allows it."""
ROOM_ATTEMPTS = 4
"""How often a room is made anew when the audit refuses so much that its quota cannot be met."""

SAMPLED_DRAWS = 40
"""How often a sampled room is drawn anew when it cannot have the questions that it owes."""

Rows = dict[str, list[Row]]


def make_room(job: Job) -> tuple[Rows, dict[str, Any]]:
    """All rows of one room by table, and the report: samples refused by the truth that they would have broken.

    Raises
    ------
    QuotaError
        If the room cannot have the questions that it owes.
    ArrangementError
        If its things cannot be arranged.
    """
    if not is_sampled(job.scene):
        return _made(job, replace(load_scene(job.scene), light=job.config.image.light))
    draw = 0
    while True:
        try:
            drawn = sampled_scene(sampled_index(job.scene), job.config.seed, draw)
            return _made(job, replace(drawn, light=job.config.image.light))
        except (ArrangementError, QuotaError):
            draw += 1
            if draw == SAMPLED_DRAWS:
                raise


def _made(job: Job, base: Scene) -> tuple[Rows, dict[str, Any]]:
    """The rows and the report of a room, of which the floor plan is given."""
    planner = RoomPlanner(job, base)
    for attempt in range(1, ROOM_ATTEMPTS + 1):
        plan = planner.next()
        rows, samples = _walked_and_asked(job, plan, planner.refused)
        passed = {group.name: [c for g, c in samples if g == group.name] for group in plan.groups}
        try:
            chosen = select(plan.groups, passed, job.quota)
            break
        except QuotaError:
            if attempt == ROOM_ATTEMPTS:
                raise
            for group in plan.groups:
                if len(passed[group.name]) < len(plan.configurations):
                    planner.avoid(group)
    rows["questions"] += [samples[name, c] for name, configurations in chosen.items() for c in configurations]
    report = {
        "questions": len(rows["questions"]),
        "frames": len(rows["frames"]),
        "refused": dict(sorted(planner.refused.items())),
    }
    return rows, report


def _walked_and_asked(
    job: Job, plan: RoomPlan, refused: Counter[str]
) -> tuple[Rows, dict[tuple[str, int], QuestionRow]]:
    """The rows of all configurations but for the questions, and all samples by group and configuration."""
    rows: Rows = {"scenes": [], "frames": [], "expressions": [], "questions": []}
    samples: dict[tuple[str, int], QuestionRow] = {}
    for number, configuration in enumerate(plan.configurations):
        made = _in_configuration(job, number, configuration.scene, plan.groups, rows, refused)
        samples |= {(sample.group, number): sample for sample in made}
    return rows, samples


def _in_configuration(
    job: Job,
    number: int,
    scene: Scene,
    groups: list[GroupPlan[HidingPlace]],
    rows: Rows,
    refused: Counter[str],
) -> list[QuestionRow]:
    """Walk through one configuration, adding its rows, and make the samples of all groups in it."""
    rng = job.rng(f"walk {number}")
    place = ConfigurationInfo(job.scene, job.quota.room_type, number, job.quota.split, job.config.seed)
    room = AuditedRoom(place, scene, job.config.image.rgb_format)
    try:
        start = room.grid.cells[int(rng.integers(len(room.grid.cells)))]
        found = {object_id: room.expressions.of(object_id) for object_id in room.replay.world.ids}
        walked = walk_through(
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
            sample = make_sample(room, group, _start(room.grid, group, job.rng(f"start {group.name} {number}")))
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
    if is_sampled(scene):
        return sampled_split(scene)
    number = int(scene.removeprefix("FloorPlan")) % 100
    if number > 25:
        return "test"
    return "val" if number > 20 else "train"
