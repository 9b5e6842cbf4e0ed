"""What rooms could not have after all is asked of others, until all that was asked for is there.

`templates/capacities.csv` is measured without arranging anything, so now and then a room cannot have its quota. It hands in
what it can, and once all rooms are made, the samples that are missing are owed by the rooms with the most room left.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from remqa_data.errors import QuotaError
from remqa_data.floorplans.splits import QuestionSplit
from remqa_data.generators.questions.allotment import LOT_SIZE, MOST_LOTS, SceneQuota, Totals, allot
from remqa_data.generators.questions.capacity_table import SceneCapacity, capacities
from remqa_data.language.question_rules import question_rules
from remqa_data.tables.rows import KINDS, QuestionKind

Answers: TypeAlias = Mapping[QuestionKind, Mapping[str, int]]
"""Samples by kind and answer."""


@dataclass(frozen=True)
class Deal:
    """What each room is asked for.

    Attributes
    ----------
    quotas : tuple of SceneQuota
        In the order of the rooms.
    full : frozenset of (str, str)
        Rooms and kinds of which a room could not have all that it was asked for: it is not asked for more.
    excused : frozenset of str
        Rooms that may hand in less than they were asked for, as others are asked for the rest.
    """

    quotas: tuple[SceneQuota, ...]
    full: frozenset[tuple[str, QuestionKind]] = frozenset()
    excused: frozenset[str] = frozenset()


def with_a_lot_less(answers: Answers, kind: QuestionKind) -> Answers:
    """A quota without the last lot of a kind, which may be smaller; what is left has two different answers, or is nothing.

    >>> with_a_lot_less({"EXISTENCE": {"yes": 5, "no": 4}}, "EXISTENCE")
    {'EXISTENCE': {'yes': 4, 'no': 4}}
    >>> with_a_lot_less({"EXISTENCE": {"yes": 2, "no": 2}}, "EXISTENCE")
    {'EXISTENCE': {'yes': 0, 'no': 0}}
    """
    each = LOT_SIZE // len(question_rules().answers(kind))
    whole = -(-sum(answers[kind].values()) // LOT_SIZE) - 1
    left = {answer: min(count, whole * each) for answer, count in answers[kind].items()}
    if sum(count > 0 for count in left.values()) < 2:
        left = dict.fromkeys(left, 0)
    return {**answers, kind: left}


def missing(asked: Answers, had: Answers) -> dict[QuestionKind, dict[str, int]]:
    """What a room hands in less than it was asked for; only kinds of which anything is missing."""
    less = {kind: {answer: n - had[kind][answer] for answer, n in answers.items()} for kind, answers in asked.items()}
    return {kind: answers for kind, answers in less.items() if any(answers.values())}


def dealt_anew(rooms: Sequence[SceneCapacity], deal: Deal, short: Mapping[str, Answers]) -> Deal | None:
    """Ask other rooms of the same split for what is missing; None if nothing is.

    Parameters
    ----------
    rooms : sequence of SceneCapacity
        What rooms can take, as far as is known.
    deal : Deal
        What they were asked for.
    short : mapping
        By room, the samples that it could not have.

    Returns
    -------
    A deal in which the rooms that step in owe what they have and some more; the quotas of all others are as they were.

    Raises
    ------
    QuotaError
        If all rooms are full: names the split, the kind and some rooms.
    """
    had = {quota.scene: _without(quota, short.get(quota.scene, {})) for quota in deal.quotas}
    full = deal.full | {(scene, kind) for scene, kinds in short.items() for kind in kinds}
    most = {room.scene: room.most for room in rooms}
    asked = {quota.scene: quota for quota in deal.quotas}
    owing = [quota for quota in deal.quotas if short.get(quota.scene) and quota.scene not in deal.excused]
    takers = set()
    for kind in KINDS:
        for quota in owing:
            for lot in _lots(short.get(quota.scene, {}).get(kind, {}), kind):
                open_rooms = [r for r in had.values() if r.split == quota.split and (r.scene, kind) not in full]
                if sum(n > 0 for n in lot.values()) < 2:  # one sample is not asked for alone
                    open_rooms = [room for room in open_rooms if room.total(kind)]
                if not open_rooms:
                    names = sorted(scene for scene, of_kind in full if of_kind == kind)
                    raise QuotaError(
                        f"questions.{quota.split}.{kind}: {quota.scene} could not have {dict(lot)}, and no other room can; "
                        f"full are {', '.join(names[:5])}; ask for fewer questions, or for more scenes",
                        kind,
                    )
                taker = min(open_rooms, key=lambda room: _fullness(room, kind, most[room.scene][kind]))
                answers = Counter(taker.answers[kind]) + Counter(lot)
                more = {**taker.answers, kind: {answer: answers[answer] for answer in taker.answers[kind]}}
                had[taker.scene] = asked[taker.scene] = replace(taker, answers=more)
                takers.add(taker.scene)
    excused = (deal.excused | {quota.scene for quota in owing}) - takers
    return Deal(tuple(asked.values()), full, excused) if owing else None


def asked_in_the_end(
    scenes: Sequence[str],
    totals: Mapping[QuestionSplit, Totals],
    anew: Mapping[str, Mapping[str, Mapping[str, int]]],
) -> list[SceneQuota]:
    """What rooms were asked for by a configuration, and some of them instead by what a manifest says in `asked_anew`."""
    quotas = allot(capacities(scenes), totals)
    new = {q.scene: {kind: anew[q.scene][kind] for kind in q.answers} for q in quotas if q.scene in anew}
    return [replace(quota, answers=new.get(quota.scene, quota.answers)) for quota in quotas]


def _without(quota: SceneQuota, short: Answers) -> SceneQuota:
    """What a room handed in."""
    left = {
        kind: {answer: n - short.get(kind, {}).get(answer, 0) for answer, n in answers.items()}
        for kind, answers in quota.answers.items()
    }
    return replace(quota, answers=left)


def _lots(samples: Mapping[str, int], kind: QuestionKind) -> Iterator[dict[str, int]]:
    """Samples in whole lots, as far as they make some; the last may be smaller."""
    each, left = LOT_SIZE // len(question_rules().answers(kind)), dict(samples)
    while any(left.values()):
        lot = {answer: min(count, each) for answer, count in left.items()}
        left = {answer: count - lot[answer] for answer, count in left.items()}
        yield lot


def _fullness(room: SceneQuota, kind: QuestionKind, most: int) -> tuple[bool, bool, float]:
    """What is asked first is least: rooms that should have room for more, then those that have little of it."""
    lots = room.total(kind) / LOT_SIZE
    all_lots = sum(map(room.total, room.answers)) / LOT_SIZE
    return lots + 1 > most, all_lots + 1 > MOST_LOTS, (lots + 1) / max(most, 1)
