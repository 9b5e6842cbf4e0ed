"""Things that nobody asks for, hidden beside those that are: what comes to light says nothing about the answer.

A place reveals as many things in each configuration of a room: where fewer are asked for, others take their room. They are
of about the same size, such as a remote control for a phone, and of types that the room's other questions ask for.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from remqa_data.errors import ArrangementError
from remqa_data.generators.arrangement.hiding_check import HidingWish
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import hidden_size, plan_ratio
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.questions import any_confusable, mentioned_types
from remqa_data.generators.questions.sites import FittingTypes, HasRoom, SiteKey, site_key

ASKED_FACTOR = 4.0
"""Types that questions about the room ask for are chosen so many times more often."""
LOW_M = 0.02
"""A thing that is higher than what it stands in for by more than this is chosen less often."""
ALIKE_POWER = 4
"""What is half as large as another is drawn one sixteenth as often in its place: as many pixels are to come to light."""
AGAIN_FACTOR = 3.0
"""A type that was chosen already is chosen so many times less often, each time anew."""


def distractors(
    groups: Sequence[GroupPlan[HidingPlace]],
    configurations: int,
    fitting: FittingTypes[HidingPlace],
    has_room: HasRoom[HidingPlace],
    clashes: Mapping[SiteKey, Collection[frozenset[str]]],
    rng: np.random.Generator,
    before: Mapping[SiteKey, Sequence[Sequence[str]]] | None = None,
) -> list[list[HidingWish]]:
    """What is hidden beside what is asked for, by configuration.

    Parameters
    ----------
    groups : sequence of GroupPlan
        The questions of a room, with how many things each needs.
    configurations : int
        How many arrangements of the room there are.
    fitting : callable
        Which types fit a place.
    has_room : callable
        Whether a place has room for things of some types.
    clashes : mapping
        By place, sets of types of which each fits, but not all at the same time.
    rng : Generator
        Draws the types.
    before : mapping, optional
        By place, the types that were hidden there in each configuration, where an earlier plan asked the same: they stay.

    Returns
    -------
    For each configuration, so many things for each place that is asked about that all of its configurations reveal as
    many: those of the one that needs most, or fewer but at least one where nothing else fits. Nothing is of a type that
    the place is asked for, or that may be taken for it, or that a question of the room names.

    Raises
    ------
    ArrangementError
        If there is no such type for a place: names the place and what it is asked for, which is too much together.
    """
    sites: dict[SiteKey, list[GroupPlan[HidingPlace]]] = {}
    for group in groups:
        sites.setdefault(site_key(group.question.place), []).append(group)
    named = {name for group in groups for name in mentioned_types(group.question.expression.program)}
    draw = _Draw(fitting, has_room, clashes, frozenset(group.question.type for group in groups), rng)
    made: list[list[HidingWish]] = [[] for _ in range(configurations)]
    for key, own in sites.items():
        place, taken = own[0].question.place, named.union(*(group.question.types for group in own))
        chosen = (before or {}).get(key, ())
        if chosen and not any_confusable((name for names in chosen for name in names), taken):
            for names in chosen:
                draw.used.update(names)
        else:
            chosen = [draw.beside(key, own, number, taken) for number in range(configurations)]
        for wishes, names in zip(made, chosen, strict=True):
            wishes.extend(HidingWish(place, name, count) for name, count in sorted(Counter(names).items()))
    return made


@dataclass
class _Draw:
    """Draws types for one place after the other; parameters as of `distractors`.

    Attributes
    ----------
    asked : frozenset of str
        Types that questions of the room ask for.
    used : Counter
        How often a type was chosen already.
    """

    fitting: FittingTypes[HidingPlace]
    has_room: HasRoom[HidingPlace]
    clashes: Mapping[SiteKey, Collection[frozenset[str]]]
    asked: frozenset[str]
    rng: np.random.Generator
    used: Counter[str] = field(default_factory=Counter)

    def beside(
        self, key: SiteKey, own: Sequence[GroupPlan[HidingPlace]], number: int, taken: Collection[str]
    ) -> list[str]:
        """Types for a place in one configuration, beside what its own questions ask for there; none of those that are taken."""
        place, counts = own[0].question.place, np.sum([group.counts for group in own], axis=0)
        at_site = tuple(sorted({g.question.type for g in own if g.question.partner is None}))
        missing = [g.question.type for g in own for _ in range(max(g.counts) - g.counts[number])]
        there = [name for g in own for name in g.things(number)]
        chosen: list[str] = []
        for wanted in missing[: int(counts.max() - counts[number])]:
            weights = self._weights(key, place, wanted, {*there, *chosen}, taken)
            name = self._that_fits(place, [*there, *chosen], at_site, weights)
            if name is None and (there or chosen):
                break  # something comes to light all the same
            if name is None:
                msg = f"{place.object_id}: nothing else than {wanted} can be hidden {place.relation} it"
                raise ArrangementError(msg, *key, at_site)
            chosen.append(name)
            self.used[name] += 1
        return chosen

    def _weights(
        self, key: SiteKey, place: HidingPlace, wanted: str, there: set[str], taken: Collection[str]
    ) -> dict[str, float]:
        """How often each type is to be drawn in the place of one that is wanted."""
        return {
            name: weight
            * _likeness(name, wanted)
            * (ASKED_FACTOR if name in self.asked else 1.0)
            / AGAIN_FACTOR ** self.used[name]
            for name, weight in self.fitting(place, 1)
            if not any_confusable([name], taken)
            and not any(clash <= there | {name} for clash in self.clashes.get(key, ()))
        }

    def _that_fits(
        self, place: HidingPlace, there: Sequence[str], at_site: tuple[str, ...], weights: Mapping[str, float]
    ) -> str | None:
        """A type drawn by its weight of which a place takes one more beside what is there; None if there is none."""
        left = dict(weights)
        while left:
            names = sorted(left)
            shares = np.array([left[name] for name in names])
            name = names[int(self.rng.choice(len(names), p=shares / shares.sum()))]
            if self.has_room(place, tuple(sorted((*there, name))), at_site):
                return name
            del left[name]
        return None


def _likeness(one: str, wanted: str) -> float:
    """How well things of a type stand in for another, 0 to 1: of like plan, and no higher, so that they hide no more."""
    height, aim = hidden_size(one)[2], hidden_size(wanted)[2]
    return plan_ratio(one, wanted) ** ALIKE_POWER * min(1.0, (aim + LOW_M) / height) ** 3
