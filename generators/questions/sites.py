"""Places as questions see them: what can be said of each, what can be asked about it, and what it has room for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, NewType

from remqa_data.generators.arrangement.hiding_rules import plan_ratio
from remqa_data.generators.questions.expressions import Expression
from remqa_data.generators.questions.groups import things_for
from remqa_data.generators.questions.questions import (
    Candidate,
    P,
    QuestionSite,
    confusable,
    kinds_for,
    usable_expressions,
)
from remqa_data.language.inner_relations import Partner
from remqa_data.language.question_rules import question_rules
from remqa_data.tables.rows import QuestionKind

FittingTypes = Callable[[P, int], Sequence[tuple[str, float]]]
"""Gives the types of which so many things fit a place at the same time, with weights."""
InnerFits = Callable[[P, str, Partner], bool]
"""Whether a thing of a type can lie in a place as said to its partner, and clearly not so."""
HasRoom = Callable[[P, tuple[str, ...], tuple[str, ...]], bool]
"""Whether a place has room for things of some types at the same time, each named as often as there are things, such that one
sees whether things of other types are there; both sorted."""
TakesThings = Callable[[P, tuple[str, ...], tuple[str, ...], int], bool]
"""The same, with so many things of a type that is not asked for beside them."""
LEAST_PLAN_RATIO = 0.35
"""What comes to light instead of a thing is at least so large, and not as many times larger."""
SiteKey = NewType("SiteKey", tuple[str, str])
"""Object id and relation: in a microwave and under it are two places."""


def site_key(place: QuestionSite) -> SiteKey:
    """Which place it is."""
    return SiteKey((place.object_id, place.relation))


@dataclass(eq=False)
class Site(Generic[P]):
    """A place with what can be said and asked about it."""

    place: P
    expressions: list[tuple[Expression, float]]
    types: Mapping[QuestionKind, Sequence[tuple[str, float]]]

    @property
    def key(self) -> SiteKey:
        """Which place it is."""
        return site_key(self.place)


def sites_of(
    places: Sequence[P], expressions: Mapping[str, Sequence[Expression]], fitting_types: FittingTypes[P]
) -> list[Site[P]]:
    """The places that can be named and hide something."""
    sites = []
    for place in places:
        usable = usable_expressions(expressions.get(place.object_id, ()))
        types: dict[QuestionKind, Sequence[tuple[str, float]]] = {}
        for kind in kinds_for(place) if usable else ():
            things = max(map(things_for, question_rules().answers(kind)))
            if things <= len(place.spots):
                types[kind] = [(name, weight) for name, weight in fitting_types(place, things) if weight > 0]
        if any(types.values()):
            sites.append(Site(place, usable, types))
    return sites


@dataclass
class Option(Generic[P]):
    """A question that could be asked of a room.

    Attributes
    ----------
    site : Site
        What it is about.
    question : Candidate
        The question.
    weight : float
        How often it is drawn.
    text : str
        Its words.
    named : frozenset of str
        The types that its phrase names.
    """

    site: Site[P]
    question: Candidate[P]
    weight: float
    text: str
    named: frozenset[str]

    @property
    def words(self) -> int:
        """Length in words."""
        return len(self.text.split())


def takes(has_room: HasRoom[P], fitting_beside: Callable[[P], Sequence[tuple[str, float]]]) -> TakesThings[P]:
    """Whether a place has room for things, and for others that come to light instead of those that are asked for.

    For each of these there are some that are about as large, so that neither number nor pixels tell the answer.

    Parameters
    ----------
    has_room : callable
        Whether a place has room for some types.
    fitting_beside : callable
        Gives the types that fit a place, with weights.
    """

    def both(place: P, types: tuple[str, ...], asked: tuple[str, ...], beside: int) -> bool:
        found = (name for name, _ in fitting_beside(place))
        others = [name for name in found if not any(confusable(name, type_) for type_ in asked)]
        return all(any(plan_ratio(name, type_) >= LEAST_PLAN_RATIO for name in others) for type_ in asked) and any(
            has_room(place, tuple(sorted((*types, *(name,) * beside))), asked) for name in others
        )

    return both


def any_room(place: P, types: tuple[str, ...], asked: tuple[str, ...], beside: int) -> bool:
    """That spots are counted is enough."""
    return True
