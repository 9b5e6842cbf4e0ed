"""How many questions each room owes: decided up front from the floor plans alone, so that rooms stay independent jobs.

What a room can take is in `templates/capacities.csv`, counted on the room as recorded. The totals of a split are dealt out
in whole lots of four samples, one for each answer 0 to 3, or two yes and two no, so that answers are balanced in every
room; what a total leaves over becomes one smaller lot.
"""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from remqa_data.errors import QuotaError, counted, named
from remqa_data.floorplans.sampled.naming import is_sampled
from remqa_data.floorplans.splits import QUESTION_SPLITS, QuestionSplit, split_of
from remqa_data.generators.questions.capacity_table import SceneCapacity, recorded_capacities
from remqa_data.language.question_rules import question_rules
from remqa_data.tables.rows import KINDS, QuestionKind

Totals = Mapping[QuestionKind, int]
Lots = dict[QuestionKind, dict[str, int]]
"""By kind and room."""
RoomFor = Mapping[str, Mapping[QuestionKind, int]]
"""By room and kind, how many lots it takes."""

LOT_SIZE = 4
"""Samples of a whole lot: as many as there are answers to a COUNTING question."""
FEWEST_LOTS, MOST_LOTS = 4, 15
"""Of a room, of all kinds together, as far as the totals allow."""


@dataclass(frozen=True)
class SceneQuota:
    """How many samples a room owes, by kind and answer."""

    scene: str
    room_type: str
    split: QuestionSplit
    answers: Mapping[QuestionKind, Mapping[str, int]]

    def total(self, kind: QuestionKind) -> int:
        """Samples of a kind."""
        return sum(self.answers[kind].values())


def allot(rooms: Sequence[SceneCapacity], totals: Mapping[QuestionSplit, Totals]) -> list[SceneQuota]:
    """Deal the totals of both splits out to rooms.

    Parameters
    ----------
    rooms : sequence of SceneCapacity
        The rooms, in any order; their names say their splits.
    totals : mapping
        Samples by split and kind.

    Returns
    -------
    One quota for each room, in the order of the rooms. By split and kind, they add up to the totals exactly; the numbers
    of samples with each answer differ by at most one; and a room's quota makes no more lots than it can take at most, in
    groups each of which asks for at least two different answers. No room takes more than it does easily, unless all do, or
    it would have fewer than `FEWEST_LOTS`; and as far as rooms can, all take `FEWEST_LOTS` to `MOST_LOTS`.

    Raises
    ------
    QuotaError
        If the rooms cannot take the totals: names the split, the kind and the rooms.
    """
    splits = {room.scene: split_of(room.scene) for room in rooms}
    answers: dict[str, dict[QuestionKind, dict[str, int]]] = {room.scene: {} for room in rooms}
    for split in QUESTION_SPLITS:
        own = [room for room in rooms if splits[room.scene] == split]
        asked = {kind: totals.get(split, {}).get(kind, 0) for kind in KINDS}
        for kind, lots in _dealt(own, split, asked).items():
            for scene, quota in _in_samples(lots, kind, asked[kind]).items():
                answers[scene][kind] = quota
    return [SceneQuota(room.scene, room.room_type, splits[room.scene], answers[room.scene]) for room in rooms]


# ---- dealing


def _dealt(rooms: Sequence[SceneCapacity], split: str, totals: Totals) -> Lots:
    """Lots by kind and room of one split."""
    dealt: Lots = {}
    had = dict.fromkeys((room.scene for room in rooms), 0)
    later = {room.scene: sum(room.lots.values()) for room in rooms}
    for kind in reversed(KINDS):  # of EXISTENCE rooms take most, so it comes last and evens out
        count = _lots_of(rooms, split, kind, totals[kind])
        later = {room.scene: later[room.scene] - room.lots[kind] for room in rooms}
        first = {name: FEWEST_LOTS - lots - later[name] for name, lots in had.items()}
        most = {room.scene: room.most[kind] for room in rooms}
        easy = {room.scene: min(room.lots[kind], most[room.scene]) for room in rooms}
        even = {scene: max(0, min(lots, MOST_LOTS - had[scene])) for scene, lots in easy.items()}
        dealt[kind] = _deal_lots((even, easy, most), count, first)
        had = {scene: lots + dealt[kind][scene] for scene, lots in had.items()}
    if not all(is_sampled(room.scene) for room in rooms):  # those are alike, and may be a million
        _even_out(dealt, rooms)
    return {kind: dealt[kind] for kind in KINDS}


def _lots_of(rooms: Sequence[SceneCapacity], split: str, kind: QuestionKind, total: int) -> int:
    """How many lots a total makes, the last of which may be smaller; QuotaError if rooms cannot take them."""
    if total == 1 or total < 0:
        raise QuotaError(
            f"questions.{split}.{kind}: {counted(total, 'question')} cannot have different answers; "
            "ask for none or for at least 2"
        )
    count = -(-total // LOT_SIZE)
    if count and not rooms:
        raise QuotaError(
            f"questions.{split}.{kind}: none of the rooms is for {split}; add one, or ask for no {split} questions"
        )
    if count > sum(room.most[kind] for room in rooms):
        raise QuotaError(f"questions.{split}.{kind}: {_too_many(rooms, split, kind, total)}")
    return count


def _too_many(rooms: Sequence[SceneCapacity], split: str, kind: QuestionKind, total: int) -> str:
    """Why rooms cannot take a total, and what to ask for instead."""
    most = LOT_SIZE * sum(room.most[kind] for room in rooms)
    names = f"the {counted(len(rooms), 'room').removeprefix('1 ')} {named((room.scene for room in rooms), most=5)}"
    have = f"{names} can be asked {f'at most {most}' if most else 'none'}"
    if most and (empty := [room.scene for room in rooms if room.most[kind] == 0]):
        have += f" ({named(empty, most=5)} none)"
    others = _other_rooms(rooms, split, kind)
    return f"{total} questions need rooms that can be asked as many; {have}; ask for {others}fewer questions"


def _other_rooms(rooms: Sequence[SceneCapacity], split: str, kind: QuestionKind) -> str:
    """Words for rooms to ask for besides, or instead, with the one that takes most questions of a kind, if there is any."""
    more = "more scenes" if any(room.most[kind] for room in rooms) else "other scenes"
    if any(is_sampled(room.scene) for room in rooms):
        return f"{more} or "
    given = {room.scene for room in rooms}
    others = [
        room for room in recorded_capacities().values() if room.scene not in given and split_of(room.scene) == split
    ]
    best = max(others, key=lambda room: room.most[kind], default=None)
    return f"{more}, such as {best.scene}, or " if best is not None and best.most[kind] else ""


def _in_samples(lots: Mapping[str, int], kind: QuestionKind, total: int) -> dict[str, dict[str, int]]:
    """Samples by room and answer: two or four of an answer make a lot."""
    names, left = question_rules().answers(kind), total % LOT_SIZE
    per_answer = LOT_SIZE // len(names)
    quotas = {scene: dict.fromkeys(names, count * per_answer) for scene, count in lots.items()}
    if left:  # the last lot of the room with most of them is not a whole one
        fullest = max(lots, key=lambda scene: lots[scene])
        others = [scene for scene, count in lots.items() if count == 1 and scene != fullest]
        quotas[fullest] = dict.fromkeys(names, (lots[fullest] - 1) * per_answer)
        extra = [fullest] * left
        if left == lots[fullest] == 1:  # one sample makes no lot: two rooms share it with a whole one, as 3 and 2
            quotas[others[0]] = dict.fromkeys(names, 0)
            extra = [fullest] * 3 + [others[0]] * 2
        for index, scene in enumerate(extra):
            quotas[scene][names[index % len(names)]] += 1
    return quotas


def _even_out(dealt: Lots, rooms: Sequence[SceneCapacity]) -> None:
    """Pass lots on until no room has more than `MOST_LOTS`, or fewer than `FEWEST_LOTS`, as far as others can take or give.

    What a room has too many of goes where it is easy, or else where there is room: what is not easy here either, and anything
    where all rooms together cannot easily take all. A room that has too few takes as many as it can at most, of kinds that
    rooms can easily take.
    """
    easy = {room.scene: {kind: min(room.lots[kind], room.most[kind]) for kind in KINDS} for room in rooms}
    plenty = [kind for kind in KINDS if sum(dealt[kind].values()) <= sum(lots[kind] for lots in easy.values())]
    most = {room.scene: {kind: room.most[kind] if kind in plenty else 0 for kind in KINDS} for room in rooms}
    while True:
        had = {room.scene: sum(lots[room.scene] for lots in dealt.values()) for room in rooms}
        ranked = sorted(had, key=lambda scene: had[scene])
        full = [scene for scene in reversed(ranked) if had[scene] > MOST_LOTS]
        poor = [scene for scene in ranked if had[scene] < FEWEST_LOTS]
        takers = {scene: easy[scene] for scene in ranked if had[scene] < MOST_LOTS}
        givers = [scene for scene in reversed(ranked) if had[scene] > FEWEST_LOTS]
        if not any(_pass_on(dealt, [scene], takers, easy) for scene in full) and not any(
            _pass_on(dealt, givers, {scene: most[scene]}, easy) for scene in poor
        ):
            break
    crowded = sum(had.values()) > sum(min(sum(lots.values()), MOST_LOTS) for lots in easy.values())
    for room in rooms:
        for kept in (room.lots, dict.fromkeys(KINDS, 0)) if crowded else (room.lots,):
            while sum(dealt[kind][room.scene] for kind in KINDS) > MOST_LOTS and _hand_on(
                dealt, room.scene, kept, rooms
            ):
                pass


def _hand_on(dealt: Lots, giver: str, kept: Mapping[QuestionKind, int], rooms: Sequence[SceneCapacity]) -> bool:
    """Let another room that is not full have one lot of what a room has more of than it keeps, though it is not easy there."""
    for room in rooms:
        for kind in KINDS:
            is_full = sum(dealt[other][room.scene] for other in KINDS) >= MOST_LOTS
            if not is_full and dealt[kind][giver] > kept[kind] and dealt[kind][room.scene] < room.most[kind]:
                dealt[kind][giver] -= 1
                dealt[kind][room.scene] += 1
                return True
    return False


def _pass_on(dealt: Lots, givers: Sequence[str], takers: RoomFor, others: RoomFor) -> bool:
    """Let one of the givers have one lot fewer, and one of the takers one more, by way of others if need be."""
    came_from: dict[str, tuple[str, QuestionKind] | None] = dict.fromkeys(givers)
    waiting = deque(givers)
    while waiting:
        giver = waiting.popleft()
        for name in others:
            room_for = takers.get(name, others[name])
            kinds = [kind for kind in KINDS if dealt[kind][giver] > 0 and dealt[kind][name] < room_for[kind]]
            if not kinds or name in came_from:
                continue
            came_from[name] = giver, kinds[0]
            if name in takers:
                _shift(dealt, name, came_from)
                return True
            waiting.append(name)
    return False


def _shift(dealt: Lots, taker: str, came_from: Mapping[str, tuple[str, QuestionKind] | None]) -> None:
    step = came_from[taker]
    while step is not None:
        giver, kind = step
        dealt[kind][giver] -= 1
        dealt[kind][taker] += 1
        taker, step = giver, came_from[giver]


def _deal_lots(limits: Sequence[Mapping[str, int]], count: int, first: Mapping[str, int]) -> dict[str, int]:
    """Deal lots to rooms one by one, each to the room that is least full, up to one limit of all rooms after the other.

    So all rooms keep some room, in case things cannot be arranged as planned. Before that, rooms get so many lots `first`.
    """
    dealt = dict.fromkeys(limits[0], 0)

    def turn(name: str, room: int) -> float:
        return float(dealt[name]) if dealt[name] < first[name] else 1e3 + (dealt[name] + 1) / room

    for limit in limits:
        waiting = [(turn(name, n), order, name) for order, (name, n) in enumerate(limit.items()) if dealt[name] < n]
        heapq.heapify(waiting)
        while waiting and sum(dealt.values()) < count:
            _, order, name = heapq.heappop(waiting)
            dealt[name] += 1
            if dealt[name] < limit[name]:
                heapq.heappush(waiting, (turn(name, limit[name]), order, name))
    return dealt
