"""Which object an action is about: it is named by its id, or by a point of the frame, x to the right and y down, 0 to 1."""

from __future__ import annotations

import itertools
from collections.abc import Collection

from remqa_data.sim.agent.results import ActionResult
from remqa_data.thor.state.dispatch import missing_argument
from remqa_data.thor.state.simulator import SimulatorState


def target_of(
    simulator: SimulatorState, action: str, object_id: str | None, x: float | None, y: float | None
) -> str | ActionResult:
    """The id of the object that an action is about, or why there is none."""
    if object_id is not None:
        return _absence(simulator, object_id) or object_id
    if x is None or y is None:
        raise missing_argument(action, "objectId")
    seen = simulator.agent.object_at(x, y, simulator.room.frame_camera())
    return seen or ActionResult(False, f"no object at ({x:g}, {y:g})")


def not_there(simulator: SimulatorState, object_id: str) -> ActionResult | None:
    """Why an object is not in the scene, or None; an error with the nearest ids if the room has no such object."""
    simulator.room.world.type_of(object_id)
    return _absence(simulator, object_id)


def _absence(simulator: SimulatorState, object_id: str) -> ActionResult | None:
    if object_id in simulator.room.records.sliced:
        return ActionResult(False, f"{object_id} has been sliced")
    is_away = object_id in simulator.room.world.away
    return ActionResult(False, f"{object_id} is not in the scene") if is_away else None


def copy_id_of(object_id: str, number: int, taken: Collection[str]) -> str:
    """The id of a copy of an object, as AI2-THOR numbers it; with a greater number where that is taken."""
    ids = (f"{object_id}_copy_{k}" for k in itertools.count(number))
    return next(name for name in ids if name not in taken)


def of_type(simulator: SimulatorState, type_name: str) -> list[str]:
    """The ids of the objects of a type that are in the scene."""
    world = simulator.room.world
    return [name for name in world.there if world.type_of(name) == type_name]
