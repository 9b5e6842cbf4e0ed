"""Which questions a room gets: places, phrases and types for its groups, drawn until its quota is met.

What is drawn more often, and how long questions become, is in `templates/questions.yaml`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Generic

import numpy as np

from remqa_data.errors import QuotaError
from remqa_data.generators.questions.allotment import SceneQuota
from remqa_data.generators.questions.chosen_groups import ChosenGroups
from remqa_data.generators.questions.expressions import Expression
from remqa_data.generators.questions.groups import GroupPlan, shapes_of, things_for, things_of
from remqa_data.generators.questions.questions import Candidate, P, any_confusable, confusable, mentioned_types
from remqa_data.generators.questions.sites import (
    FittingTypes,
    InnerFits,
    Option,
    Site,
    SiteKey,
    TakesThings,
    any_room,
    site_key,
    sites_of,
)
from remqa_data.geometry import arithmetic
from remqa_data.language.inner_relations import InnerRelation, Partner
from remqa_data.language.question_rules import QuestionRules, question_rules
from remqa_data.tables.rows import QuestionKind

Clashes = Mapping[SiteKey, Collection[frozenset[str]]]
"""By place, sets of types of which each fits, but not all at the same time."""
PLAN_ORDER: tuple[QuestionKind, ...] = ("COUNTING", "SPATIAL", "EXISTENCE")
ATTEMPTS = 12
"""Draws of a whole room before its quota counts as impossible."""
SHUFFLES = 8
"""Orders of a group's answers that are tried before the one that leaves most room."""
MOST_WORDS = 99
"""More than any question has."""
INNER_DRAWS = 24
"""Draws of a place and two types before it has no room for a question about whether they lie to one another in some way."""


def plan_groups(
    places: Sequence[P],
    expressions: Mapping[str, Sequence[Expression]],
    fitting_types: FittingTypes[P],
    quota: SceneQuota,
    rng: np.random.Generator,
    configurations: int = 4,
    spare_groups: Mapping[QuestionKind, int] | None = None,
    clashes: Clashes | None = None,
    inner_fits: InnerFits[P] | None = None,
    has_room: TakesThings[P] | None = None,
    kept: Sequence[GroupPlan[P]] = (),
) -> list[GroupPlan[P]]:
    """The questions of one room.

    Parameters
    ----------
    places : sequence of Place
        Where things can be hidden.
    expressions : mapping of str to sequence of Expression
        By object id, the phrases that pick out the place's object, best first.
    fitting_types : callable
        Given a place and a number, the types of which so many things can be hidden there at the same time, with weights.
    quota : SceneQuota
        How many samples with each answer the room owes. They are met exactly by the groups' `asked`.
    rng : Generator
        Decides what is left open.
    configurations : int
        How many arrangements of the room there will be.
    spare_groups : mapping, optional
        By kind, groups beyond the quota, as far as there is room.
    clashes : Clashes, optional
        What is known not to fit together; no place is asked for all types of such a set.
    inner_fits : callable, optional
        Given a place, a type and its partner, whether they can lie there so, and clearly not so. Without it, no question
        asks how two things lie to one another.
    has_room : callable, optional
        See `TakesThings`; by default spots are counted only.
    kept : sequence of GroupPlan
        Groups of an earlier plan that stay, where their places can still be asked about; they count, and get new names.

    Returns
    -------
    Groups, by kind: first COUNTING, which needs most room, then SPATIAL, EXISTENCE; the spare ones last. In no
    configuration does a place hold more things than it has spots, or things of two types that are taken for one another.

    Raises
    ------
    QuotaError
        If the room has not enough places: names the room and the kind, and says what there is.
    """
    sites = sites_of(places, expressions, fitting_types)
    keys = {site.key for site in sites}
    kept = [group for group in kept if site_key(group.question.place) in keys]
    order, refusal, hardest = PLAN_ORDER, "", PLAN_ORDER[0]
    for attempt in range(ATTEMPTS):
        planner = Planner(sites, quota.scene, configurations, rng, clashes or {}, inner_fits, has_room or any_room)
        for group in kept:
            planner.keep(group)
        failed = _fill(planner, order, _without(quota, kept), with_inner=attempt < ATTEMPTS // 2)
        if failed is None:
            for kind in PLAN_ORDER:
                spare = sum(group.question.kind == kind and not group.asked for group in kept)
                for _ in range((spare_groups or {}).get(kind, 0) - spare):
                    planner.add(kind, {})
            return planner.chosen.groups
        refusal, hardest = planner.refusal(failed, quota.answers[failed]), failed
        order = (failed, *(kind for kind in order if kind != failed))  # what found no room comes first
    raise QuotaError(refusal, hardest)


def _without(quota: SceneQuota, groups: Iterable[GroupPlan[P]]) -> SceneQuota:
    """What a room owes beside the samples of some groups."""
    given = Counter((group.question.kind, group.answers[c]) for group in groups for c in group.asked)
    left = {
        kind: {answer: count - given[kind, answer] for answer, count in answers.items()}
        for kind, answers in quota.answers.items()
    }
    return replace(quota, answers=left)


def _fill(
    planner: Planner[P], order: Sequence[QuestionKind], quota: SceneQuota, with_inner: bool
) -> QuestionKind | None:
    """Plan what a room owes; returns the kind for which there is no room."""
    shapes = {
        kind: shapes_of(kind, quota.answers[kind], planner.configurations, f"{quota.scene}: {kind}") for kind in order
    }
    if with_inner:  # first, as they need most room
        inner = planner.inner_groups(len(shapes["SPATIAL"]))
        shapes["SPATIAL"] = [s for n, s in enumerate(shapes["SPATIAL"]) if n >= inner or not planner.add_inner(s)]
    for kind in order:
        for shape in shapes[kind]:
            if not planner.add(kind, shape):
                return kind
    return None


@dataclass(eq=False)
class Planner(Generic[P]):
    """Draws one group after the other, each of which goes with those that have been chosen."""

    sites: list[Site[P]]
    scene: str
    configurations: int
    rng: np.random.Generator
    clashes: Clashes = field(default_factory=dict)
    inner_fits: InnerFits[P] | None = None
    has_room: TakesThings[P] = field(default_factory=lambda: any_room)

    def __post_init__(self) -> None:
        self.rules: QuestionRules = question_rules()
        self.chosen: ChosenGroups[P] = ChosenGroups([site.key for site in self.sites], self.configurations)
        self.options = {kind: list(self._options(kind)) for kind in PLAN_ORDER}

    def keep(self, group: GroupPlan[P]) -> None:
        """Ask what an earlier plan asked."""
        self.chosen.add(replace(group, name=self._name(group.question.kind)))

    def add(self, kind: QuestionKind, shape: Mapping[str, int], crowd: bool = True) -> bool:
        """Ask for so many samples of each answer; False if there is no room.

        A new question is asked, or one that is asked already is asked in more configurations. With `crowd`, a place takes
        more groups than it should once all have as many as they should, and questions are longer: by one word, or, where
        nothing else does, by any number.
        """
        longest = self.rules.longest_words[kind]
        asked = self._ask(kind, shape, longest, strict=True) or (
            crowd and self._ask(kind, shape, longest + 1, strict=False)
        )
        return asked or self._widen(kind, shape) or (crowd and self._ask(kind, shape, MOST_WORDS, strict=False))

    def inner_groups(self, count: int) -> int:
        """How many of so many SPATIAL groups are to ask how two things lie to one another."""
        return 0 if self.inner_fits is None else int(self.rules.inner_share * count + self.rng.random())

    def add_inner(self, shape: Mapping[str, int]) -> bool:
        """Ask how two things lie to one another in a place; False if no place has room for that."""
        assert self.inner_fits is not None, "nothing says what fits"
        sites = [site for site in self.sites if len(site.types.get("EXISTENCE", ())) > 1]
        relations = list(self.rules.inner_relations)
        likely = np.array([self.rules.inner_relations[relation] for relation in relations])
        for which in self.rng.choice(len(relations), np.count_nonzero(likely), replace=False, p=likely / likely.sum()):
            for _ in range(INNER_DRAWS if sites else 0):
                option = self._inner_option(sites[int(self.rng.integers(len(sites)))], relations[int(which)])
                question = option.question
                assert question.partner is not None
                if self._is_free(option) and self.inner_fits(question.place, question.type, question.partner):
                    answers = self._answers(option, shape)
                    if answers is not None and self._has_room(question, answers):
                        self._take("SPATIAL", option, answers, shape)
                        return True
        return False

    def _inner_option(self, site: Site[P], relation: InnerRelation) -> Option[P]:
        """A question about two types that fit a place."""
        types = site.types["EXISTENCE"]
        one, two = (types[i][0] for i in self.rng.permutation(len(types))[:2])
        expression = min((spoken for spoken, _ in site.expressions), key=lambda spoken: len(spoken.text.split()))
        question = Candidate("SPATIAL", site.place, expression, one, Partner(relation, two))
        return Option(site, question, 1.0, question.text, mentioned_types(expression.program))

    def _is_free(self, option: Option[P]) -> bool:
        """Whether a question about how two things lie to one another goes with those that have been chosen."""
        question, key = option.question, option.site.key
        here = [g.question for g in self.chosen.groups if g.question.place.object_id == option.site.place.object_id]
        others: set[str] = set(option.named | self.chosen.mentioned).union(*(other.types for other in here))
        return (
            option.words <= self.rules.inner_longest_words
            and option.text not in self.chosen.texts
            and all(other.place.relation == "in" and other.partner is None for other in here)
            and not confusable(*question.types)
            and not any_confusable(question.types, others)
            and not any_confusable(option.named, self.chosen.asked_for)
            and not self._clash(key, set(question.types).union(*(other.types for other in here)))
        )

    def _ask(self, kind: QuestionKind, shape: Mapping[str, int], longest: int, strict: bool) -> bool:
        """Add a group of questions with so many words at most, if there is room for it."""
        size = sum(shape.values()) or self.configurations
        for pool in self._pools(kind, size, self._free_options(kind, longest, strict)):
            while pool:
                chosen = self._draw(kind, size, pool)
                answers = self._answers(chosen, shape)
                if answers is None:
                    pool = [option for option in pool if option.site is not chosen.site]
                elif self._has_room(chosen.question, answers):
                    self._take(kind, chosen, answers, shape)
                    return True
                else:
                    pool = [o for o in pool if o.site is not chosen.site or o.question.type != chosen.question.type]
        return False

    def _has_room(self, question: Candidate[P], answers: Sequence[str]) -> bool:
        """Whether the things of a question find room beside those of the other questions about its place.

        So must others, so many that as much comes to light whatever the answer.
        """
        place = question.place
        own = [g for g in self.chosen.groups if g.question.place == place and g.question != question]
        asked = {q.type for q in (question, *(group.question for group in own)) if q.partner is None}
        there = [
            (*things_of(question, answer), *(name for group in own for name in group.things(number)))
            for number, answer in enumerate(answers)
        ]
        most = max(map(len, there))
        return all(
            self.has_room(place, tuple(sorted(types)), tuple(sorted(asked)), most - len(types)) for types in there
        )

    def _widen(self, kind: QuestionKind, shape: Mapping[str, int]) -> bool:
        """Let a group ask in configurations in which it does not ask yet, if one has room for what is to be found there."""
        more = [answer for answer, count in shape.items() for _ in range(count)]
        for place in self.rng.permutation(len(self.chosen.groups)) if more else ():
            group = self.chosen.groups[place]
            free = [c for c in range(self.configurations) if c not in group.asked]
            if group.question.kind != kind or not group.asked or len(free) < len(more):
                continue
            for _ in range(SHUFFLES):
                chosen = self.rng.permutation(free)[: len(more)].tolist()
                given = dict(zip(chosen, more, strict=True))
                answers = tuple(given.get(c, answer) for c, answer in enumerate(group.answers))
                wider = replace(group, answers=answers, asked=tuple(sorted((*group.asked, *chosen))))
                filled = self.chosen.filled_by(group, wider)
                if np.all(filled <= len(group.question.place.spots)) and self._has_room(group.question, answers):
                    self.chosen.widen(place, wider)
                    return True
        return False

    def refusal(self, kind: QuestionKind, quota: Mapping[str, int]) -> str:
        """Why there is no room for another group."""
        sites = [site for site in self.sites if site.types.get(kind)]
        spots = sum(len(site.place.spots) for site in sites)
        return (
            f"{self.scene}: {kind}: {sum(quota.values())} questions need more places than there are: {len(sites)} that can be "
            f"named, with {spots} spots in all, hold {self.chosen.per_kind[kind]} groups; lower this room's capacity in "
            "templates/capacities.csv or the totals of the configuration"
        )

    # ---- choosing

    def _options(self, kind: QuestionKind) -> Iterator[Option[P]]:
        """All questions of a kind that could be asked of the room."""
        fits = Counter(name for site in self.sites for name, _ in site.types.get(kind, ()))
        for site in self.sites:
            types = site.types.get(kind, ())
            spoken: dict[bool, list[float]] = {True: [], False: []}
            for expression, weight in site.expressions:
                spoken[_is_bare(expression)].append(weight)
            for expression, weight in site.expressions:
                others = spoken[_is_bare(expression)]
                for name, likely in types:
                    question = Candidate(kind, site.place, expression, name)
                    # A type counts for the same in however many places it fits, and a place for as much as its best phrase.
                    worth = weight * max(others) / sum(others) * likely / fits[name]
                    worth *= self.rules.type_weights.get(name, 1.0)
                    yield Option(site, question, worth, question.text, mentioned_types(expression.program))

    def _free_options(self, kind: QuestionKind, longest: int, strict: bool) -> list[Option[P]]:
        """The questions that go with those that have been chosen."""
        limit = self.rules.max_groups_per_place[kind] if strict else len(self.chosen.texts) + 1
        full = {site.key for site in self.sites if self.chosen.at_site[kind, site.key] >= limit}
        at_object: dict[str, set[str]] = {site.place.object_id: set(self.chosen.mentioned) for site in self.sites}
        at_site: dict[SiteKey, set[str]] = {site.key: set() for site in self.sites}
        for group in self.chosen.groups:
            place = group.question.place
            at_object[place.object_id] |= group.question.types
            at_site[site_key(place)] |= group.question.types
        # Of two types that look alike in one place, or a type that phrases of this room name, nobody could tell which.
        # What has something under it is raised, and does not open as it did: an object is one place or the other.
        asked = {group.question.place.object_id: group.question.place.relation for group in self.chosen.groups}
        return [
            option
            for option in self.options[kind]
            if option.site.key not in full
            and asked.get(option.site.place.object_id, option.site.place.relation) == option.site.place.relation
            and option.words <= longest
            and not (strict and self.chosen.asked_for[option.question.type] >= self.rules.max_groups_per_type)
            and option.text not in self.chosen.texts
            and not any_confusable({option.question.type}, at_object[option.site.place.object_id] | option.named)
            and not any_confusable(option.named, self.chosen.asked_for)
            and not self._clash(option.site.key, at_site[option.site.key] | {option.question.type})
        ]

    def _clash(self, key: SiteKey, types: set[str]) -> bool:
        return any(clash <= types for clash in self.clashes.get(key, ()))

    def _pools(self, kind: QuestionKind, size: int, options: list[Option[P]]) -> Iterator[list[Option[P]]]:
        """The options in lots, of which the first that has room is drawn from: by manipulation, then bare nouns or not."""
        shares = self.rules.manipulations[kind]
        total = sum(self.chosen.samples[kind, m] for m in shares) + size
        owed = sorted(shares, key=lambda m: (self.chosen.samples[kind, m] - shares[m] * total, self.rng.random()))
        bare = bool(self.rng.random() < self._bare_share(kind))
        for manipulation in owed:
            lot = [option for option in options if option.question.place.manipulation == manipulation]
            for as_drawn in (True, False):
                yield [option for option in lot if (_is_bare(option.question.expression) == bare) == as_drawn]

    def _bare_share(self, kind: QuestionKind) -> float:
        asked = sum(self.chosen.samples[kind, m] for m in ("Open", "Pickup", "Move"))
        excess = self.chosen.excess_words[kind] / asked if asked else 0.0
        return self.rules.bare_share[kind] + self.rules.bare_share_per_word * excess

    def _draw(self, kind: QuestionKind, size: int, pool: list[Option[P]]) -> Option[P]:
        weights = np.array([option.weight for option in pool])
        at_site = {key: sum(self.chosen.at_site[k, key] for k in PLAN_ORDER) for key in self.chosen.filled}
        again = [at_site[o.site.key] + self.chosen.asked_for[o.question.type] for o in pool]
        weights /= self.rules.again_factor ** np.array(again)
        words = np.array([option.words for option in pool])
        off = np.abs(self.chosen.excess_words[kind] + size * (words - self.rules.aim_words[kind])) / size
        weights *= arithmetic.exp((off.min() - off) / self.rules.tolerance_words[kind])
        return pool[int(self.rng.choice(len(pool), p=weights / weights.sum()))]

    def _answers(self, option: Option[P], shape: Mapping[str, int]) -> tuple[str, ...] | None:
        """One answer for each configuration such that the place has room for all things, if there are such.

        Configurations about which nobody asks have none of the things, and so room for others.
        """
        possible = sorted(self.rules.answers(option.question.kind), key=things_for)
        asked = [answer for answer, count in shape.items() for _ in range(count)] or possible
        pattern = asked + possible[:1] * (self.configurations - len(asked))
        things = np.array([len(things_of(option.question, answer)) for answer in pattern])
        free = len(option.site.place.spots) - self.chosen.filled[option.site.key]
        for _ in range(SHUFFLES):
            order = self.rng.permutation(self.configurations)
            if np.all(things[order] <= free):
                return tuple(pattern[i] for i in order)
        by_things, by_room = np.argsort(things, kind="stable"), np.argsort(free, kind="stable")
        if np.any(things[by_things] > free[by_room]):  # most things where most room is
            return None
        answers = dict(zip(by_room.tolist(), (pattern[i] for i in by_things), strict=True))
        return tuple(answers[c] for c in range(self.configurations))

    def _take(self, kind: QuestionKind, chosen: Option[P], answers: tuple[str, ...], shape: Mapping[str, int]) -> None:
        asked: list[int] = []
        for answer, count in shape.items():
            with_it = [c for c, given in enumerate(answers) if given == answer]
            asked += self.rng.permutation(with_it)[:count].tolist()
        self.chosen.add(GroupPlan(self._name(kind), chosen.question, answers, tuple(sorted(asked))))

    def _name(self, kind: QuestionKind) -> str:
        return f"{self.scene}-{kind}-{self.chosen.per_kind[kind]:02d}"


def _is_bare(expression: Expression) -> bool:
    return expression.kind == "bare"
