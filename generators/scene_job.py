"""One room from its floor plan to all its rows: planned, arranged, walked through, asked about and audited."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from remqa_data.errors import ArrangementError, QuotaError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.floorplans.sampled.naming import is_sampled, sampled_index, sampled_split
from remqa_data.floorplans.sampled.scenes import sampled_scene
from remqa_data.generators.arrangement.hiding_places import HidingPlace
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.selection import select
from remqa_data.generators.questions.shortfalls import missing
from remqa_data.generators.samples import AuditedRoom, Refusal, make_sample
from remqa_data.generators.scene_plan import Job, RoomPlan, RoomPlanner
from remqa_data.generators.walks.scene_walk import ConfigurationInfo, walk_through
from remqa_data.scene import Scene
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.tables.rows import QuestionRow, Row, Split

ROOM_ATTEMPTS, ATTEMPTS_FOR_LESS = 4, 2
"""How often a room is made anew when the audit refuses so much that its quota cannot be met; less often if it need not be."""

ARRANGED_ANEW = 2
"""How often a configuration is arranged anew when the audit refuses some of its samples."""

SAMPLED_DRAWS = 40
"""How often a sampled room is drawn anew when it cannot have the questions that it owes."""

Rows = dict[str, list[Row]]
Samples = dict[tuple[str, int], QuestionRow]
"""By group and configuration."""


def make_room(job: Job) -> tuple[Rows, dict[str, Any]]:
    """All rows of one room by table, and the report: samples refused by the truth that they would have broken.

    A recorded room that cannot have all its questions has fewer, and the report says in `short` which samples it lacks, by
    kind and answer. A sampled room is drawn anew until it has them all.

    Raises
    ------
    QuotaError, ArrangementError
        If no draw of a sampled room can have the questions that it owes.
    """
    if not is_sampled(job.scene):
        return _made(job, replace(load_scene(job.scene), light=job.config.image.light), may_fall_short=True)
    draw = 0
    while True:
        try:
            drawn = sampled_scene(sampled_index(job.scene), job.config.seed, draw)
            return _made(job, replace(drawn, light=job.config.image.light))
        except (ArrangementError, QuotaError):
            draw += 1
            if draw == SAMPLED_DRAWS:
                raise


def _made(job: Job, base: Scene, *, may_fall_short: bool = False) -> tuple[Rows, dict[str, Any]]:
    """The rows and the report of a room, of which the floor plan is given."""
    planner = RoomPlanner(job, base, may_fall_short=may_fall_short)
    last = ATTEMPTS_FOR_LESS if may_fall_short else ROOM_ATTEMPTS
    for attempt in range(1, last + 1):
        plan = planner.next()
        rows, samples = _walked_and_asked(job, plan, planner)
        try:
            chosen = _chosen(job, plan, samples, planner, or_fewer=may_fall_short and attempt == last)
            break
        except QuotaError:
            if attempt == last:
                raise
            passed = _passed(plan, samples)
            for group in plan.groups:
                if len(passed[group.name]) < len(plan.configurations):
                    planner.avoid(group)
    rows["questions"] += [samples[name, c] for name, configurations in chosen.items() for c in configurations]
    report = {
        "questions": len(rows["questions"]),
        "frames": len(rows["frames"]),
        "refused": dict(sorted(planner.refused.items())),
    }
    short = missing(job.quota.answers, planner.quota.answers)
    return rows, report | ({"short": short} if short else {})


def _chosen(
    job: Job, plan: RoomPlan, samples: Samples, planner: RoomPlanner, *, or_fewer: bool
) -> dict[str, tuple[int, ...]]:
    """The samples that the room hands in; where too many were refused, those of other configurations are made, too."""
    for number, configuration in enumerate(plan.configurations):
        try:
            return select(plan.groups, _passed(plan, samples), planner.quota)
        except QuotaError:
            short = {group.question.kind for group in plan.groups if _lacks_some(group, samples)}
        room = _audited_room(job, number, configuration.scene)
        try:
            others = [g for g in plan.groups if g.question.kind in short and not _is_due(g, number)]
            samples |= _samples(job, room, number, others, planner)
        finally:
            room.close()
    while True:
        try:
            return select(plan.groups, _passed(plan, samples), planner.quota)
        except QuotaError as error:
            if not (or_fewer and planner.ask_less(error)):
                raise


def _passed(plan: RoomPlan, samples: Samples) -> dict[str, list[int]]:
    return {group.name: sorted(c for g, c in samples if g == group.name) for group in plan.groups}


def _lacks_some(group: GroupPlan[HidingPlace], samples: Samples) -> bool:
    """Whether samples of a group that are due were refused."""
    return any((group.name, number) not in samples for number in group.asked)


def _is_due(group: GroupPlan[HidingPlace], number: int) -> bool:
    """Whether a group asks about a configuration; spare ones ask about none until samples are refused."""
    return number in group.asked


def _audited_room(job: Job, number: int, scene: Scene) -> AuditedRoom:
    place = ConfigurationInfo(job.scene, job.quota.room_type, number, job.quota.split, job.config.seed)
    return AuditedRoom(place, scene, job.config.image.rgb_format)


def _samples(
    job: Job, room: AuditedRoom, number: int, groups: Iterable[GroupPlan[HidingPlace]], planner: RoomPlanner
) -> Samples:
    """The samples of some groups in a configuration that keep all truths."""
    made = {}
    for group in groups:
        sample = make_sample(room, group, job.rng(f"start {group.name} {number}"))
        if isinstance(sample, Refusal):
            planner.refused[sample.truth] += 1
        else:
            made[group.name, number] = sample
    return made


def _walked_and_asked(job: Job, plan: RoomPlan, planner: RoomPlanner) -> tuple[Rows, Samples]:
    """The rows of all configurations but for the questions, and the samples that are due in each."""
    rows: Rows = {"scenes": [], "frames": [], "expressions": [], "questions": []}
    samples: Samples = {}
    for number in range(len(plan.configurations)):
        room, made = _asked(job, plan, number, planner)
        try:
            _walk(job, room, rows)
        finally:
            room.close()
        samples |= made
    return rows, samples


def _asked(job: Job, plan: RoomPlan, number: int, planner: RoomPlanner) -> tuple[AuditedRoom, Samples]:
    """A configuration, and the samples that are due in it; it is arranged anew where the audit refuses some of them."""
    due = [group for group in plan.groups if _is_due(group, number)]
    room = _audited_room(job, number, plan.configurations[number].scene)
    try:
        samples = _samples(job, room, number, due, planner)
        for attempt in range(1, ARRANGED_ANEW + 1):
            lacking = [group for group in due if (group.name, number) not in samples]
            if all(group.question.place.key in planner.hopeless for group in lacking):
                break
            try:
                configuration = planner.arranged_anew(plan.configurations[number], number, attempt)
            except ArrangementError:
                continue
            other = _audited_room(job, number, configuration.scene)
            made = _samples(job, other, number, due, planner)
            for group in due:
                if (group.name, number) not in made and (group.name, number) not in samples:
                    planner.hopeless.add(group.question.place.key)
            if len(made) > len(samples):
                plan.configurations[number], samples = configuration, made
                room, other = other, room
            other.close()
    except BaseException:
        room.close()
        raise
    return room, samples


def _walk(job: Job, room: AuditedRoom, rows: Rows) -> None:
    """Walk through one configuration, adding its rows."""
    rng = job.rng(f"walk {room.place.configuration}")
    start = room.grid.cells[int(rng.integers(len(room.grid.cells)))]
    room.start_over(AgentPose(start, 0))
    found = {object_id: room.expressions.of(object_id) for object_id in room.replay.world.ids}
    walked = walk_through(
        room.place,
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
