"""What a room is asked, and its arrangements: planned, arranged, and planned anew without what could not be arranged."""

from __future__ import annotations

import zlib
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from remqa_data.errors import ArrangementError, QuotaError
from remqa_data.generators.arrangement.configurations import Configuration, arrange
from remqa_data.generators.arrangement.fitting_types import fitting_types
from remqa_data.generators.arrangement.hiding_check import HidingWish
from remqa_data.generators.arrangement.hiding_place import HidingPlace, PlaceKey
from remqa_data.generators.arrangement.hiding_places import hiding_places
from remqa_data.generators.arrangement.inner_packing import inner_fits
from remqa_data.generators.arrangement.wished_things import has_room, infeasible_wishes
from remqa_data.generators.config import Config
from remqa_data.generators.distractors import distractors
from remqa_data.generators.questions.allotment import SceneQuota
from remqa_data.generators.questions.expressions import Expression, Expressions
from remqa_data.generators.questions.groups import GroupPlan, wishes
from remqa_data.generators.questions.planning import plan_groups
from remqa_data.generators.questions.questions import Candidate
from remqa_data.generators.questions.shortfalls import with_a_lot_less
from remqa_data.generators.questions.sites import SiteKey, site_key, takes
from remqa_data.scene import Scene
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.physics.world import World
from remqa_data.tables.rows import QuestionKind

PLANS = 200
"""How often a room's questions are planned anew before its arrangement counts as impossible."""
ARRANGED, ARRANGED_FOR_LESS = 25, 8
"""The same for plans that were arranged in the simulator, which takes seconds and not milliseconds; where fewer questions
would do, fewer are tried."""
FAILURES = 12
"""A place in which things could not be arranged so often is used no more."""


_Asked = list[tuple[Candidate[HidingPlace], tuple[str, ...]]]


@dataclass(frozen=True)
class Job:
    """All that one room needs; it can be sent to another process."""

    quota: SceneQuota
    config: Config

    @property
    def scene(self) -> str:
        """The room."""
        return self.quota.scene

    def rng(self, purpose: str) -> np.random.Generator:
        """Random numbers of the room for one purpose, whatever is drawn for others."""
        codes = [self.config.seed, zlib.crc32(self.scene.encode()), zlib.crc32(purpose.encode())]
        return np.random.default_rng(np.random.SeedSequence(codes))


@dataclass(frozen=True)
class RoomPlan:
    """Questions of a room, and the arrangements that they are about."""

    groups: list[GroupPlan[HidingPlace]]
    configurations: list[Configuration]


class RoomPlanner:
    """Plans a room, and learns from every failure what not to ask for there.

    Parameters
    ----------
    job : Job
        What the room owes.
    base : Scene
        The room as recorded.
    may_fall_short : bool
        Whether it may have fewer questions where not all can be had.

    Attributes
    ----------
    quota : SceneQuota
        What the plans are for: what the room owes, or less.
    refused : Counter
        How often the audit refused samples, by the truth that they would have broken.
    hopeless : set of PlaceKey
        Places of which samples were refused again when the room was arranged anew for them: it is not for these.
    misfits, clashes
        What was learnt: types that cannot be hidden in or under an object, and by object those that cannot be together.
    failures : Counter
        How often something could not be arranged, by object and relation.
    groups, kept : list of GroupPlan
        The last plan, and what of it the next one keeps.
    beside : dict
        What comes to light besides what is asked for, with the questions that it was chosen for.
    fits : set
        Wishes for a place, by configuration, that were found to be feasible.
    """

    def __init__(self, job: Job, base: Scene, *, may_fall_short: bool = False) -> None:
        self.job, self.base, self.quota, self.may_fall_short = job, base, job.quota, may_fall_short
        self.places = hiding_places(base)
        self.expressions = expressions_of_places(base, self.places)
        self.plans_made = 0
        self.failures: Counter[SiteKey] = Counter()
        self.refused: Counter[str] = Counter()
        self.hopeless: set[PlaceKey] = set()
        self._fitting_at_first = cache(
            lambda place, count, others: fitting_types(place, job.quota.room_type, count, others=others)
        )
        self._has_room = cache(has_room)
        self.groups: list[GroupPlan[HidingPlace]] = []
        self.kept: list[GroupPlan[HidingPlace]] = []
        self.beside: dict[SiteKey, tuple[_Asked, list[list[str]]]] = {}
        self.fits: set[tuple[int, PlaceKey, tuple[object, ...]]] = set()
        self.misfits: set[tuple[SiteKey, str]] = set()
        self.clashes: defaultdict[SiteKey, set[frozenset[str]]] = defaultdict(set)
        self._start_over()

    def next(self) -> RoomPlan:
        """A plan that has not been tried yet; for fewer questions where there is no other, if that may be.

        Raises
        ------
        QuotaError
            If the room cannot have the questions that it owes.
        ArrangementError
            If its things cannot be arranged, however they are planned.
        """
        while True:
            try:
                return self._next()
            except (QuotaError, ArrangementError) as error:
                if not (self.may_fall_short and self.ask_less(error)):
                    raise

    def ask_less(self, error: QuotaError | ArrangementError) -> bool:
        """Ask for a lot fewer of the kind that cannot be had; False if nothing of it is asked for."""
        kind = self._kind_of(error)
        if not self.quota.total(kind):
            return False
        self.quota = replace(self.quota, answers=with_a_lot_less(self.quota.answers, kind))
        self._start_over()
        return True

    def _start_over(self) -> None:
        self.kept, self.beside = [], {}
        self.plans_left = PLANS
        self.arrangements_left = ARRANGED_FOR_LESS if self.may_fall_short else ARRANGED
        self._forget()

    def _kind_of(self, error: QuotaError | ArrangementError) -> QuestionKind:
        """The kind of which there is too much: of questions about what could not be hidden, or of most questions."""
        if isinstance(error, QuotaError):
            return error.kind  # type: ignore[return-value]
        groups = [group for group in self.groups if group.question.place.object_id == error.place_id]
        kinds = Counter(group.question.kind for group in groups if group.question.type in error.types)
        return max(kinds or self.quota.answers, key=self.quota.total)

    def _next(self) -> RoomPlan:
        while True:
            groups = self.groups = self._planned()
            try:
                hidden = self._hidden(groups)
                unfit = [e for number, wishes in enumerate(hidden) for e in self._unfit(number, wishes)]
                if not unfit:
                    self.arrangements_left -= 1
                    return RoomPlan(groups, [self._arranged(wishes, number) for number, wishes in enumerate(hidden)])
            except ArrangementError as error:
                unfit = [error]
            self.refused["arrangement"] += 1
            if self.plans_left <= 0 or self.arrangements_left <= 0:
                raise unfit[0]
            self._learn(unfit)

    def _hidden(self, groups: Sequence[GroupPlan[HidingPlace]]) -> list[list[HidingWish]]:
        """What is to be hidden in each configuration: what is asked for, and what else comes to light with it."""
        others = distractors(
            groups,
            self.job.config.configurations,
            self._fitting_beside,
            self._has_room,
            self.clashes,
            self.job.rng(f"distractors {self.plans_made}"),
            {key: names for key, (asked, names) in self.beside.items() if asked == _asked_at(groups, key)},
        )
        self.beside = {
            key: (_asked_at(groups, key), [_types_at(wishes, key) for wishes in others])
            for key in {site_key(group.question.place) for group in groups}
        }
        return [[*wishes(groups, number), *beside] for number, beside in enumerate(others)]

    def _unfit(self, number: int, wishes: Sequence[HidingWish]) -> list[ArrangementError]:
        """What of some wishes cannot be; what was found to fit before, in the same place, is not tried again."""
        by_place: defaultdict[PlaceKey, list[HidingWish]] = defaultdict(list)
        for wish in wishes:
            by_place[wish.place.key].append(wish)
        keys = {key: (number, key, tuple(map(_without_place, own))) for key, own in by_place.items()}
        new = [wish for wish in wishes if keys[wish.place.key] not in self.fits]
        errors = infeasible_wishes(self.base, new, self.job.rng(f"arrange {number}")) if new else []
        failed = set(map(_site_of, errors))
        self.fits |= {keys[w.place.key] for w in new if site_key(w.place) not in failed}
        return errors

    def avoid(self, groups: Iterable[GroupPlan[HidingPlace]]) -> None:
        """Ask some of the last plan's questions no more, and nothing else about the same types there."""
        questions = [group.question for group in groups]
        self.misfits |= {(site_key(q.place), q.type) for q in questions}
        self.kept = [group for group in self.groups if group.question not in questions]

    def _planned(self) -> list[GroupPlan[HidingPlace]]:
        self.plans_made, self.plans_left = self.plans_made + 1, self.plans_left - 1
        job, rng = self.job, self.job.rng(f"plan {self.plans_made}")
        configurations, spare = job.config.configurations, job.config.spare_groups.by_kind()
        try:
            return plan_groups(
                self.places,
                self.expressions,
                self._fitting,
                self.quota,
                rng,
                configurations,
                spare,
                self.clashes,
                inner_fits,
                takes(self._has_room, lambda place: self._fitting_beside(place, 1)),
                self.kept,
            )
        except QuotaError:
            if not self.kept:
                if not self.has_learnt or self.plans_left <= 0:
                    raise
                self._forget()  # too much was ruled out for what may have been bad luck
            self.kept = []
            return self._planned()

    def _fitting_beside(self, place: HidingPlace, count: int) -> list[tuple[str, float]]:
        """What may be hidden beside what is asked for."""
        return self._fitting(place, count, others=True)

    def _fitting(self, place: HidingPlace, count: int, others: bool = False) -> list[tuple[str, float]]:
        found = self._fitting_at_first(replace(place, spots=()), count, others)
        return [pair for pair in found if (site_key(place), pair[0]) not in self.misfits]

    def arranged_anew(self, configuration: Configuration, number: int, attempt: int) -> Configuration:
        """The same things hidden in the same places, but otherwise; ArrangementError if that cannot be done."""
        hidden = [wish for wish, _ in configuration.hidden]
        return arrange(self.base, self.places, hidden, self.job.rng(f"arrange {number} again {attempt}"))

    def _arranged(self, hidden: list[HidingWish], number: int) -> Configuration:
        return arrange(self.base, self.places, hidden, self.job.rng(f"arrange {number}"))

    @property
    def has_learnt(self) -> bool:
        """Whether anything is ruled out that might work another time."""
        return bool(self.misfits or self.clashes)

    def _forget(self) -> None:
        self.misfits, self.clashes = set(), defaultdict(set)

    def _learn(self, errors: Iterable[ArrangementError]) -> None:
        """Rule out what could not be arranged, and keep the other questions."""
        failed, self.kept = set[SiteKey](), list(self.groups)
        for error in errors:
            key = _site_of(error)
            self.beside.pop(key, None)
            self.kept = [
                g
                for g in self.kept
                if site_key(g.question.place) != key or not {*error.types}.intersection(g.question.types)
            ]
            if len(error.types) > 1:
                self.clashes[key].add(frozenset(error.types))
            else:
                self.misfits.add((key, error.types[0]))
                failed.add(key)
        self.failures.update(failed)
        self.places = [p for p in self.places if self.failures[site_key(p)] < FAILURES]


def _site_of(error: ArrangementError) -> SiteKey:
    """Where something could not be arranged."""
    return SiteKey((error.place_id, error.relation))


def _asked_at(groups: Iterable[GroupPlan[HidingPlace]], key: SiteKey) -> _Asked:
    """The questions about a place, and what their answers are to be."""
    return [(group.question, group.answers) for group in groups if site_key(group.question.place) == key]


def _without_place(wish: HidingWish) -> tuple[object, ...]:
    return wish.type, wish.count, wish.partner, wish.holds, wish.is_asked


def _types_at(wishes: Iterable[HidingWish], key: SiteKey) -> list[str]:
    """The types of which things are to lie in a place, each named as often as there are."""
    return [w.type for w in wishes if site_key(w.place) == key for _ in range(w.count)]


def expressions_of_places(scene: Scene, places: Iterable[HidingPlace]) -> dict[str, list[Expression]]:
    """Referring expressions of the places of a room, with everything closed, by object id."""
    with World(scene) as world:
        world.settle()
        for place in places:
            if place.manipulation == "Open":
                world.open(place.object_id, 0.0)
        found = Expressions(SceneGraph.from_objects(object_metadata(world).values()))
        return {place.object_id: found.of(place.object_id) for place in places}
