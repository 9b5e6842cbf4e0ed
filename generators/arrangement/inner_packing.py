"""Putting two or three things into a place so that they lie to one another as asked, or clearly do not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.loose_objects import SKIN_M
from remqa_data.generators.arrangement.areas import Area
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import hiding_rules, largest_size
from remqa_data.generators.arrangement.packing import Outline, Put, free_put, outline_of, packed, put_at, turned_half
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.geometry.types import Vec3
from remqa_data.language.inner_relations import InnerRelation, Partner, clearly_related
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.sim.navigation.embodiment import AGENT

PACKED, TRIES = 4, 40
FITTED = 3
"""Things fit as asked if they were put so in each of so many tries."""
APART_M = (0.01, 0.035)
"""What is next to, behind or between others is so far from them."""
MOST_ASKEW_DEG = 40.0
"""Who acts stands so far off the front at most, where it is asked what is behind what."""
FRONT_DEG = -90.0
"""Where the front of an object looks that is not turned."""
LAID_ON = types_with("laid_on")
OPENS_FORWARD = types_with("opens_forward")


@dataclass(frozen=True)
class RelationConstraint:
    """How a thing is to lie to one or two others, all given by their numbers; `holds` is whether it is to, or not."""

    thing: int
    others: tuple[int, ...]
    relation: InnerRelation
    holds: bool


def inner_fits(place: HidingPlace, type_: str, partner: Partner) -> bool:
    """Whether things of two types can lie in a place as said, and clearly not so, whatever their sizes within the spread."""
    return _fits(replace(place, spots=()), type_, partner)


def packed_with_constraint(
    place: HidingPlace,
    types: Sequence[str],
    sizes: Sequence[Vec3],
    wanted: RelationConstraint,
    rng: np.random.Generator,
) -> list[Put] | None:
    """Where all things of a place go, in their order: first those that are to lie in some way, then the others around them.

    Parameters
    ----------
    place : HidingPlace
        Where.
    types, sizes : sequence
        Of all things of the place.
    wanted : RelationConstraint
        Which of them are to lie in some way, and how.
    rng : numpy.random.Generator
        Draws places and turns.

    Returns
    -------
    None if no way was found.
    """
    for _ in range(PACKED):
        first = _constrained(place, types, sizes, wanted, rng)
        if first is None:
            return None
        puts = packed(place.areas, sizes, hiding_rules().gap_m, rng, first)
        if puts is not None:
            return puts
    return None


def _constrained(
    place: HidingPlace,
    types: Sequence[str],
    sizes: Sequence[Vec3],
    wanted: RelationConstraint,
    rng: np.random.Generator,
) -> dict[int, Put] | None:
    """Where the things of a constraint go, by their numbers; None if no way was found."""
    weights = np.array([area.half[0] * area.half[1] for area in place.areas])
    for _ in range(TRIES):
        area = place.areas[int(rng.choice(len(place.areas), p=weights / weights.sum()))]
        puts = _related(area, sizes, wanted, rng) if wanted.holds else _apart(place.areas, area, sizes, wanted, rng)
        if puts is not None and _is_clear(place, types, sizes, wanted, puts):
            return puts
    return None


@lru_cache(maxsize=4096)
def _fits(place: HidingPlace, type_: str, partner: Partner) -> bool:
    if partner.relation == "behind" and not _seen_from_front(place):
        return False
    if partner.relation == "on" and partner.type not in LAID_ON:
        return False
    types = [type_, *[partner.type] * partner.count]
    sizes = [largest_size(name) for name in types]
    constraints = [
        RelationConstraint(0, tuple(range(1, len(types))), partner.relation, holds) for holds in (True, False)
    ]
    rng = np.random.default_rng(0)
    return all(
        _constrained(place, types, sizes, wanted, rng) is not None for wanted in constraints for _ in range(FITTED)
    )


def _seen_from_front(place: HidingPlace) -> bool:
    """Whether the agent looks in from the front at all poses of a place."""
    if place.type not in OPENS_FORWARD:
        return False
    facing = place.areas[0].yaw_deg + FRONT_DEG
    x, y = (float(np.mean([area.centre[axis] for area in place.areas])) for axis in (0, 1))
    for goal in (place.goal, *place.other_goals):
        px, py = AGENT.centre_of(goal.cell)
        towards = math.degrees(arithmetic.arctan2(py - y, px - x))
        if degrees_apart(towards, facing) > MOST_ASKEW_DEG:
            return False
    return True


def _related(
    area: Area, sizes: Sequence[Vec3], wanted: RelationConstraint, rng: np.random.Generator
) -> dict[int, Put] | None:
    """The others at random, the thing on, beside, behind or between them."""
    if wanted.relation == "on":
        under = _free_put(area, sizes[wanted.others[0]], rng, [])
        if under is None:
            return None
        x, y, z = under.position
        on_top = Put(area, (x, y, z + sizes[wanted.others[0]][2] + SKIN_M), _turn(rng) + area.yaw_deg)
        return {wanted.others[0]: under, wanted.thing: on_top}
    # In a row, from one side to the other as one looks in, or to the back.
    row = [wanted.others[0], wanted.thing, *wanted.others[1:]]
    if rng.random() < 0.5 and wanted.relation != "behind":
        row.reverse()
    axis = 1 if wanted.relation == "behind" else 0
    turns = [_turn(rng) for _ in row]
    halves = [turned_half(sizes[number], turn) for number, turn in zip(row, turns, strict=True)]
    gaps = rng.uniform(*APART_M, len(row) - 1)
    length = 2 * sum(half[axis] for half in halves) + float(gaps.sum())
    across = max(half[1 - axis] for half in halves)
    if length > 2 * area.half[axis] or across > area.half[1 - axis]:
        return None
    at = float(rng.uniform(-1, 1)) * (area.half[axis] - length / 2) - length / 2
    beside = float(rng.uniform(-1, 1)) * (area.half[1 - axis] - across)
    puts = {}
    for place, (number, turn, half) in enumerate(zip(row, turns, halves, strict=True)):
        middle = at + half[axis]
        x, y = (middle, beside) if axis == 0 else (beside, middle)
        puts[number] = put_at(area, x, y, turn)
        at = middle + half[axis] + (float(gaps[place]) if place < len(gaps) else 0.0)
    return puts


def _apart(
    areas: Sequence[Area], area: Area, sizes: Sequence[Vec3], wanted: RelationConstraint, rng: np.random.Generator
) -> dict[int, Put] | None:
    """All of them anywhere: two others that something could be between on one area, the thing on any."""
    puts: dict[int, Put] = {}
    for number in (*wanted.others, wanted.thing):
        on = area if number in wanted.others else areas[int(rng.integers(len(areas)))]
        there = [outline_of(put, sizes[n]) for n, put in puts.items() if put.area == on]
        put = _free_put(on, sizes[number], rng, there)
        if put is None:
            return None
        puts[number] = put
    return puts


def _free_put(area: Area, size: Vec3, rng: np.random.Generator, there: list[Outline]) -> Put | None:
    """A thing anywhere on an area, turned at random, if it is free there."""
    turn = _turn(rng)
    half = turned_half(size, turn)
    room = (area.half[0] - half[0], area.half[1] - half[1])
    if min(room) < 0:
        return None
    x, y = (float(share) * free for share, free in zip(rng.uniform(-1, 1, 2), room, strict=True))
    return free_put(area, x, y, half, turn, hiding_rules().gap_m, there)


def _turn(rng: np.random.Generator) -> float:
    """Square to the place: so gaps are what they seem."""
    return 90.0 * int(rng.integers(4))


def _is_clear(
    place: HidingPlace,
    types: Sequence[str],
    sizes: Sequence[Vec3],
    wanted: RelationConstraint,
    puts: dict[int, Put],
) -> bool:
    """Whether the things fit below what is above them, are high enough to be seen, and lie as asked by the rules."""
    records = [_record(place.object_id, place.type, place.areas[0], None, (0.0, 0.0, 0.0))]
    for number, put in puts.items():
        raised = put.position[2] - put.area.centre[2]
        if not put.area.seen_from_m < raised + sizes[number][2] <= put.area.height_m:
            return False
        records.append(_record(str(number), types[number], put.area, put, sizes[number], place.object_id))
    return clearly_related(records, str(wanted.thing), wanted.relation, [str(n) for n in wanted.others]) is wanted.holds


def _record(
    name: str, type_: str, area: Area, put: Put | None, size: Vec3, support: str | None = None
) -> ObjectMetadata:
    """What metadata would say of a thing that has been put somewhere, or of the place."""
    x, y, z = area.centre if put is None else put.position
    half = turned_half(size, 0.0 if put is None else put.yaw_deg)
    box = (x - half[0], y - half[1], z, x + half[0], y + half[1], z + size[2])
    return ObjectMetadata(
        id=name,
        type=type_,
        color="",
        substance="",
        box=box,
        openness=0.0,
        is_picked_up=False,
        support=support,
        support_kind=None if support is None else "in",
        facing_deg=(area.yaw_deg + FRONT_DEG) % 360.0,
    )
