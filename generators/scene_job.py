"""One room from its floor plan to all its rows: planned, arranged, walked through, asked about and audited."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import replace
from typing import Any

from remqa_data.errors import ArrangementError, QuotaError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.floorplans.sampled.naming import is_sampled, sampled_index
from remqa_data.floorplans.sampled.scenes import sampled_scene
from remqa_data.floorplans.splits import expression_split
from remqa_data.generators.arrangement.configurations import Configuration
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.audited_room import AuditedRoom
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.selection import select
from remqa_data.generators.questions.shortfalls import missing
from remqa_data.generators.samples import Refusal, make_sample
from remqa_data.generators.scene_plan import Job, RoomPlanner
from remqa_data.generators.walks.scene_walk import ConfigurationInfo, walk_through
from remqa_data.scene import Scene
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.tables.rows import QuestionRow, Row

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
    for number in range(1, last + 1):
        with closing(_Attempt(job, planner)) as attempt:
            attempt.ask()
            try:
                chosen = attempt.chosen(or_fewer=may_fall_short and number == last)
            except QuotaError:
                if number == last:
                    raise
                attempt.learn()
                continue
            rows = attempt.walked()
            break
    rows["questions"] += [attempt.samples[name, c] for name, configurations in chosen.items() for c in configurations]
    report = {
        "questions": len(rows["questions"]),
        "frames": len(rows["frames"]),
        "refused": dict(sorted(planner.refused.items())),
    }
    short = missing(job.quota.answers, planner.quota.answers)
    return rows, report | ({"short": short} if short else {})


class _Attempt:
    """One plan of a room, with its configurations at rest until it is closed.

    Attributes
    ----------
    rooms : list of AuditedRoom
        The configurations that have been asked about.
    samples : dict
        Those that keep all truths.
    """

    def __init__(self, job: Job, planner: RoomPlanner) -> None:
        self.job, self.planner, self.plan = job, planner, planner.next()
        self.rooms: list[AuditedRoom] = []
        self.samples: Samples = {}

    def close(self) -> None:
        """Give the simulators' memory back."""
        for room in self.rooms:
            room.close()

    def ask(self) -> None:
        """Make the samples that are due; a configuration is arranged anew where the audit refuses some of them."""
        for number, configuration in enumerate(self.plan.configurations):
            self.rooms.append(self._room(number, configuration.scene))
            due = [group for group in self.plan.groups if _is_due(group, number)]
            samples = self._samples(number, due)
            for again in range(1, ARRANGED_ANEW + 1):
                lacking = [group for group in due if (group.name, number) not in samples]
                if all(group.question.place.key in self.planner.hopeless for group in lacking):
                    break
                samples = self._asked_anew(configuration, number, again, due, samples)
            self.rooms[number].forget_views()
            self.samples |= samples

    def _asked_anew(
        self,
        configuration: Configuration,
        number: int,
        again: int,
        due: Sequence[GroupPlan[HidingPlace]],
        samples: Samples,
    ) -> Samples:
        """Arrange a configuration anew, and keep the one with more samples; returns these."""
        try:
            scene = self.planner.arranged_anew(configuration, number, again).scene
        except ArrangementError:
            return samples
        before, self.rooms[number] = self.rooms[number], self._room(number, scene)
        made = self._samples(number, due)
        self.planner.hopeless |= {g.question.place.key for g in due if (g.name, number) not in made | samples}
        if len(made) <= len(samples):
            before, self.rooms[number] = self.rooms[number], before
        before.close()
        return max(samples, made, key=len)

    def chosen(self, *, or_fewer: bool) -> dict[str, tuple[int, ...]]:
        """The samples that the room hands in; where too many were refused, those of other configurations are made, too."""
        groups, planner = self.plan.groups, self.planner
        for number in range(len(self.rooms)):
            try:
                return select(groups, self._passed(), planner.quota)
            except QuotaError:
                short = {group.question.kind for group in groups if self._lacks_some(group)}
            others = [group for group in groups if group.question.kind in short and not _is_due(group, number)]
            self.samples |= self._samples(number, others)
        while True:
            try:
                return select(groups, self._passed(), planner.quota)
            except QuotaError as error:
                if not (or_fewer and planner.ask_less(error)):
                    raise

    def learn(self) -> None:
        """Do not ask again for what the audit refused."""
        passed = self._passed()
        self.planner.avoid(group for group in self.plan.groups if len(passed[group.name]) < len(self.rooms))

    def walked(self) -> Rows:
        """The rows of walks through all configurations."""
        rows: Rows = {"scenes": [], "frames": [], "expressions": [], "questions": []}
        for room in self.rooms:
            rng = self.job.rng(f"walk {room.info.configuration}")
            start = room.grid.cells[int(rng.integers(len(room.grid.cells)))]
            room.start_over(AgentPose(start, 0))
            walked = walk_through(
                room.info,
                room.replay.view,
                room.grid,
                start,
                {object_id: room.expressions.of(object_id) for object_id in room.replay.world.ids},
                self.job.config.walk.settings(self.job.config.image.size_px),
                rng,
                rgb_format=self.job.config.image.rgb_format,
                expression_split=expression_split(self.job.scene),
            )
            rows["scenes"].append(walked.scene)
            rows["frames"] += walked.frames
            rows["expressions"] += walked.expressions
        return rows

    def _room(self, number: int, scene: Scene) -> AuditedRoom:
        job = self.job
        place = ConfigurationInfo(job.scene, job.quota.room_type, number, job.quota.split, job.config.seed)
        return AuditedRoom(place, scene, job.config.image.rgb_format)

    def _samples(self, number: int, groups: Iterable[GroupPlan[HidingPlace]]) -> Samples:
        """The samples of some groups in a configuration that keep all truths."""
        made = {}
        for group in groups:
            sample = make_sample(self.rooms[number], group, self.job.rng(f"start {group.name} {number}"))
            if isinstance(sample, Refusal):
                self.planner.refused[sample.truth] += 1
            else:
                made[group.name, number] = sample
        return made

    def _passed(self) -> dict[str, list[int]]:
        return {group.name: sorted(c for g, c in self.samples if g == group.name) for group in self.plan.groups}

    def _lacks_some(self, group: GroupPlan[HidingPlace]) -> bool:
        """Whether samples of a group that are due were refused."""
        return any((group.name, number) not in self.samples for number in group.asked)


def _is_due(group: GroupPlan[HidingPlace], number: int) -> bool:
    """Whether a group asks about a configuration; spare ones ask about none until samples are refused."""
    return number in group.asked
