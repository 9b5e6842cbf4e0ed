"""Things that nobody asks for, hidden beside those that are: what comes to light says nothing about the answer.

A place reveals as many things in each configuration of a room: where fewer are asked for, others take their room. They are
of about the same size, such as a remote control for a phone, and of types that the room's other questions ask for.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from remqa_data.errors import ArrangementError
from remqa_data.generators.arrangement.hiding_check import Hidden
from remqa_data.generators.arrangement.hiding_places import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import hidden_size
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.questions import confusable, mentioned_types

Fitting = Callable[[HidingPlace, int], Sequence[tuple[str, float]]]
"""Gives the types of which so many things fit a place at the same time, with weights."""
SiteKey = tuple[str, str]

ASKED_FACTOR = 4.0
"""Types that questions about the room ask for are chosen so many times more often."""
LOW_M = 0.02
"""A thing that is higher than what it stands in for by more than this is chosen less often."""
AGAIN_FACTOR = 3.0
"""A type that was chosen already is chosen so many times less often, each time anew."""


def distractors(
    groups: Sequence[GroupPlan[HidingPlace]],
    configurations: int,
    fitting: Fitting,
    clashes: Mapping[SiteKey, Collection[frozenset[str]]],
    rng: np.random.Generator,
) -> list[list[Hidden]]:
    """What is hidden beside what is asked for, by configuration.

    Parameters
    ----------
    groups : sequence of GroupPlan
        The questions of a room, with how many things each needs.
    configurations : int
        How many arrangements of the room there are.
    fitting : callable
        Which types fit a place.
    clashes : mapping
        By place, sets of types of which each fits, but not all at the same time.
    rng : Generator
        Draws the types.

    Returns
    -------
    For each configuration, so many things for each place that is asked about that all of its configurations reveal as
    many: those of the one that needs most. Nothing is of a type that the place is asked for, or that may be taken for it, or
    that a question of the room names.

    Raises
    ------
    ArrangementError
        If there is no such type for a place: names the place and what it is asked for, which is too much together.
    """
    sites: dict[SiteKey, list[GroupPlan[HidingPlace]]] = {}
    for group in groups:
        sites.setdefault((group.question.place.object_id, group.question.place.relation), []).append(group)
    named = {name for group in groups for name in mentioned_types(group.question.expression.program)}
    asked = {group.question.type for group in groups}
    used: Counter[str] = Counter()
    made: list[list[Hidden]] = [[] for _ in range(configurations)]
    for key, own in sites.items():
        place = own[0].question.place
        counts = np.sum([group.counts for group in own], axis=0)
        at_object = {g.question.type for g in groups if g.question.place.object_id == place.object_id}
        taken = at_object | named
        for number in range(configurations):
            missing = [g.question.type for g in own for _ in range(max(g.counts) - g.counts[number])]
            chosen: list[str] = []
            for wanted in missing[: int(counts.max() - counts[number])]:
                there = {g.question.type for g in own if g.counts[number]} | set(chosen)
                options = [
                    (name, weight * _likeness(name, wanted) * (ASKED_FACTOR if name in asked else 1.0))
                    for name, weight in fitting(place, len(missing))
                    if not any(confusable(name, other) for other in taken)
                    and not any(clash <= there | {name} for clash in clashes.get(key, ()))
                ]
                if not options:
                    msg = f"{place.object_id}: nothing else than {wanted} can be hidden {place.relation} it"
                    raise ArrangementError(msg, *key, sorted({g.question.type for g in own}))
                weights = np.array([weight / AGAIN_FACTOR ** used[name] for name, weight in options])
                chosen.append(options[int(rng.choice(len(options), p=weights / weights.sum()))][0])
                used[chosen[-1]] += 1
            made[number] += [Hidden(place, name, count) for name, count in sorted(Counter(chosen).items())]
    return made


def _likeness(one: str, wanted: str) -> float:
    """How well things of a type stand in for another, 0 to 1: of like plan, and no higher, so that they hide no more."""
    (w, d, h), (v, e, g) = hidden_size(one), hidden_size(wanted)
    ratio = min(w * d, v * e) / max(w * d, v * e)
    return ratio * ratio * min(1.0, (g + LOW_M) / h)
