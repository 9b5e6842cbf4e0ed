"""A room in which other things lie about: what can be picked up is put on and into other receptacles, at random.

Where a thing may be is what was recorded of such things in such rooms, or what AI2-THOR has take them. What is put down comes
to rest; what would not stay where it was put is put down anew, alone.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from typing_extensions import TypedDict

from remqa_data.catalog import object_type
from remqa_data.floorplans.loose_objects import OpenSurface, put_anew
from remqa_data.sim.agent import handling
from remqa_data.sim.agent.receptacles import open_spaces, spaces_for_things
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.physics.world import World
from remqa_data.thor.actions.compatible import is_compatible
from remqa_data.thor.actions.targets import copy_id_of, of_type
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.rest import AT_REST_M, farthest, settle
from remqa_data.thor.state.simulator import SimulatorState, generator

MOST_SETTLING = 5
"""So often all are given time to come to rest."""
MOST_COPIES = 100
"""No more are made at once."""


class ObjectTypeCount(TypedDict):
    """How many objects of a type there are to be."""

    objectType: str
    count: int


def initial_random_spawn(
    simulator: SimulatorState,
    randomSeed: int = 0,
    forceVisible: bool = False,
    numPlacementAttempts: int = 5,
    placeStationary: bool = True,
    numDuplicatesOfType: list[ObjectTypeCount] | None = None,
    excludedReceptacles: list[str] | None = None,
    excludedObjectIds: list[str] | None = None,
    allowFloor: bool = False,
    numRepeats: list[ObjectTypeCount] | None = None,
    minFreePerReceptacleType: list[ObjectTypeCount] | None = None,
) -> ActionResult:
    """Put what can be picked up somewhere else, at random; what finds no place stays where it is.

    Parameters
    ----------
    simulator : SimulatorState
        The room.
    randomSeed : int
        The same seed gives the same places to things that lie where they lay.
    forceVisible : bool
        Whether nothing is put into what is closed.
    numPlacementAttempts : int
        How many places are tried for each object.
    placeStationary : bool
        Means nothing: all is at rest after every action.
    numDuplicatesOfType, numRepeats : list of ObjectTypeCount
        How many there are to be of types of which there are fewer: what is missing is copied, and what then finds no place is
        not there.
    excludedReceptacles : list of str
        Types of receptacles on and into which nothing is put; what finds no place elsewhere stays on them.
    excludedObjectIds : list of str
        Objects that stay where they are.
    allowFloor : bool
        Means nothing: nothing is put on the floor.
    minFreePerReceptacleType : list of ObjectTypeCount
        So many receptacles of a type, or all if there are fewer, get nothing.
    """
    room, rng = simulator.room, generator(randomSeed)
    if numPlacementAttempts < 1:
        return ActionResult(False, "numPlacementAttempts must be a positive integer.")
    excluded = set(excludedObjectIds or [])
    for name in excluded:
        room.world.type_of(name)  # names the nearest ids if there is no such object
    for type_name in excludedReceptacles or []:
        object_type(type_name)
    kept_free = _drawn(simulator, minFreePerReceptacleType or [], rng)
    copies = _copies(simulator, [*(numDuplicatesOfType or []), *(numRepeats or [])], rng)
    if len(copies) > MOST_COPIES:
        return ActionResult(False, f"{len(copies)} copies are asked for: no more than {MOST_COPIES} are made at once")
    if (refusal := room.let_go(room.agents)) is not None:
        return refusal
    room.copy(copies, "(Clone)_random_copy_", simulator.settings)
    world = room.world
    surfaces = _surfaces(world, {*world.away, *kept_free}, set(excludedReceptacles or []), forceVisible)
    loose = [
        name for name in world.ids if name in copies or (name not in world.away and _may_move(world, name, excluded))
    ]
    return _spawn(world, loose, surfaces, numPlacementAttempts, rng)


def _drawn(simulator: SimulatorState, wishes: Sequence[ObjectTypeCount], rng: np.random.Generator) -> set[str]:
    """So many objects of each type as are wished for, at random."""
    drawn = [
        rng.permutation(of_type(simulator, object_type(wish["objectType"]).name))[: max(0, wish["count"])].tolist()
        for wish in wishes
    ]
    return {name for names in drawn for name in names}


def _copies(simulator: SimulatorState, wishes: Sequence[ObjectTypeCount], rng: np.random.Generator) -> dict[str, str]:
    """What is copied, by the ids of the copies, so that there are as many of each type as are wished for.

    Of what there is nothing, or cannot be picked up, there is nothing to copy.
    """
    copies: dict[str, str] = {}
    there = simulator.room.world.there
    for wish in wishes:
        kind = object_type(wish["objectType"])
        names = of_type(simulator, kind.name) if kind.pickupable else []
        for number in range(min(wish["count"] - len(names), MOST_COPIES + 1) if names else 0):
            original = names[int(rng.integers(len(names)))]
            copies[copy_id_of(original, number, {*there, *copies})] = original
    return copies


ACTIONS: dict[str, ActionFunction] = {"InitialRandomSpawn": initial_random_spawn}


def _may_move(world: World, object_id: str, excluded: Collection[str]) -> bool:
    """Whether an object can be picked up, is not hung up, and neither it nor what it carries is to stay."""
    if not object_type(world.type_of(object_id)).pickupable or world.state(object_id).is_fixed:
        return False
    return not {object_id, *world.contents(object_id)} & set(excluded)


def _surfaces(
    world: World, away: Collection[str], excluded_types: Collection[str], force_visible: bool
) -> list[OpenSurface]:
    """Where things can be put: not onto the floor, nor onto what can be carried away itself."""
    owners = [
        name
        for name in world.ids
        if name not in away
        and world.type_of(name) not in {"Floor", *excluded_types}
        and not object_type(world.type_of(name)).pickupable
    ]
    return [
        OpenSurface(name, space)
        for name in owners
        for space in (open_spaces if force_visible else spaces_for_things)(world, name)
    ]


def _spawn(
    world: World, loose: Sequence[str], surfaces: Sequence[OpenSurface], tries: int, rng: np.random.Generator
) -> ActionResult:
    before = world.save()
    copies = {name: world.away[name] for name in loose if name in world.away}
    for name, state in copies.items():
        world.put_back(name, replace(state, position=world.place_away(name), is_fixed=False))
    order = [loose[index] for index in rng.permutation(len(loose))]
    moved = [name for name in order if _put_anew(world, name, surfaces, tries, rng)]
    for name, state in copies.items():
        if name not in moved:
            world.put_away(name, state)
    owners = {surface.owner for surface in surfaces}
    settle(world, MOST_SETTLING)
    for name in moved:
        if not _stayed(world, name, owners):
            _put_alone(world, name, surfaces, tries, rng)
    settle(world, MOST_SETTLING)
    for name, state in before.states.items():
        is_there = name not in moved and name not in world.away
        if is_there and farthest(world, {name: state}) <= AT_REST_M:
            world.put_back(name, state)
    sunken = next((name for name in moved if handling.sunk_into(world, name)), None)
    if sunken is not None:
        world.restore(before)
        return ActionResult(False, f"no room was found for {sunken}: try another seed")
    return ActionResult(True)


def _put_anew(
    world: World, object_id: str, surfaces: Sequence[OpenSurface], tries: int, rng: np.random.Generator
) -> bool:
    """Put a thing where such things were recorded; if there is no room, on or into anything that AI2-THOR has take it."""
    room_type = world.scene.room_type
    if put_anew(world, object_id, room_type, surfaces, (), rng, tries):
        return True
    types = {world.type_of(surface.owner) for surface in surfaces}
    taking = {name: 1.0 for name in types if is_compatible(world.type_of(object_id), name)}  # put_anew sorts them
    return put_anew(world, object_id, room_type, surfaces, (), rng, tries, taking)


def _put_alone(
    world: World, object_id: str, surfaces: Sequence[OpenSurface], tries: int, rng: np.random.Generator
) -> None:
    """Put a thing that did not stay somewhere where it does, and moves nothing else; or leave it where it came to rest."""
    owners = {surface.owner for surface in surfaces}
    for _ in range(tries):
        before = world.save()
        if not _put_anew(world, object_id, surfaces, tries, rng):
            return
        put = world.save()
        handling.settle(world)
        others = {name: state for name, state in put.states.items() if name != object_id}
        if _stayed(world, object_id, owners) and farthest(world, others) <= AT_REST_M:
            return
        world.restore(before)


def _stayed(world: World, object_id: str, owners: Collection[str]) -> bool:
    """Whether a thing lies where things can be put, or in what lies there, and is sunk into nothing."""
    holder = handling.support_of(world, object_id, by_agents=True)
    if holder is None or handling.sunk_into(world, object_id):
        return False
    return holder in owners or object_type(world.type_of(holder)).pickupable
