"""How a room comes to rest after things were put somewhere, and whether any is in something then."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.sim.agent import handling
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.world import World
from remqa_data.thor.state.floor_plan import LoadedFloorPlan

AT_REST_M = 0.001
"""What physics moves by no more was at rest."""


def come_to_rest(
    room: LoadedFloorPlan, moved: Sequence[str], most_m: float = handling.OVERLAP_M
) -> tuple[str, str] | None:
    """Let what is loose of what was moved fall, and furniture stand still then; returns what `sunken` finds afterwards."""
    world, home = room.world, room.at_rest.states
    moved = [name for name in moved if world.state(name) is not home.get(name)]
    loose = [name for name in moved if object_type(world.type_of(name)).is_loose]
    let_fall(world, [name for name in loose if world.state(name).is_fixed])
    parts = {part for name in loose for part in world.built_into(name)}
    return sunken(room, [name for name in moved if name in {*loose, *parts}], most_m)


def let_fall(world: World, furniture: Sequence[str], awake: Sequence[str] | None = None) -> None:
    """Let furniture fall, which stands still afterwards, and all that is loose, or of that only what is said to be awake.

    Furniture with parts, or around chairs, does not tilt: physics would drive it and them apart.
    """
    for name in furniture:
        if world.built_into(name) or handling.sunk_into(world, name):
            handling.lower(world, name)
        else:
            world.set_fixed(name, False)
    if awake is None:
        settle(world)
    else:
        handling.settle(world, awake=awake)
    for name in furniture:
        world.set_fixed(name, True)


def settle(world: World, times: int = 1) -> None:
    """Let all come to rest, so many times if need be; what physics moves by no more than a hair in the end does not move."""
    for _ in range(times):
        before = world.save()
        handling.settle(world)
        if farthest(world, before.states) <= AT_REST_M:
            world.restore(before)
            return


def farthest(world: World, states: Mapping[str, ObjectState]) -> float:
    """Metres by which what has moved most is away from some states."""
    moved = [np.subtract(world.state(name).position, state.position) for name, state in states.items()]
    return float(arithmetic.length(moved).max())


def sunken(
    room: LoadedFloorPlan, moved: Collection[str], most_m: float = handling.OVERLAP_M, *, as_one: bool = False
) -> tuple[str, str] | None:
    """Which of some objects is in what, by more metres than when the room was loaded; by default more than things that touch.

    What was moved `as_one` is in one another as it was before.
    """
    depths = handling.depths(room.world, moved, own=moved if as_one else ())
    return next(iter(handling.deeper(depths, room.depths, most_m)), None)
