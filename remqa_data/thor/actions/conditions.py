"""What AI2-THOR's agent does to an object without moving it: to break, cook, dirty, clean, fill, empty and use it up."""

from __future__ import annotations

from typing import Any

from remqa_data.catalog import object_type
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.thor.actions.targets import target_of
from remqa_data.thor.state.conditions import LIQUIDS
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.simulator import SimulatorState


def fill_object_with_liquid(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    fillLiquid: str = "water",
    forceAction: bool = False,
) -> ActionResult:
    """Fill an object with water, coffee or wine."""
    if fillLiquid not in LIQUIDS:
        return ActionResult(False, f"fillLiquid {fillLiquid!r} is none of {', '.join(LIQUIDS)}")
    values = {"isFilledWithLiquid": True, "fillLiquid": fillLiquid}
    return _change(simulator, "FillObjectWithLiquid", objectId, x, y, forceAction, "fillable", values)


def slice_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Refuse, as a room has no slices."""
    target = target_of(simulator, "SliceObject", objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    return ActionResult(False, f"{target} is not sliced: a room has the objects here that it began with, and no slices")


def _changing(name: str, able: str, **values: Any) -> Action:
    """An action that brings an object that can be it into a condition."""

    def act(
        simulator: SimulatorState,
        objectId: str | None = None,
        x: float | None = None,
        y: float | None = None,
        forceAction: bool = False,
    ) -> ActionResult:
        return _change(simulator, name, objectId, x, y, forceAction, able, values)

    return act


def _change(
    simulator: SimulatorState,
    action: str,
    object_id: str | None,
    x: float | None,
    y: float | None,
    force: bool,
    able: str,
    values: dict[str, Any],
) -> ActionResult:
    target = target_of(simulator, action, object_id, x, y)
    if isinstance(target, ActionResult):
        return target
    room, agent = simulator.room, simulator.agent
    record, after = room.conditions.of(target), next(iter(values))
    if able not in object_type(room.world.type_of(target)).can:
        return ActionResult(False, f"{target} is not {able.replace('_', ' ')}")
    if bool(record.get(after, False)) == bool(values[after]):
        return ActionResult(False, f"{target} is {'already' if values[after] else 'not'} {CONDITIONS[after]}")
    refusal = None if force or target == agent.held else agent.refusal(target) or agent.reach(target)
    if refusal is not None:
        return refusal
    room.conditions.change(target, **values)
    return ActionResult(True)


CONDITIONS = {
    "isBroken": "broken",
    "isCooked": "cooked",
    "isDirty": "dirty",
    "isFilledWithLiquid": "filled",
    "isUsedUp": "used up",
}
"""AI2-THOR's names of conditions, and the words for them."""

_ONE_WAY: dict[str, tuple[str, dict[str, Any]]] = {
    "BreakObject": ("breakable", {"isBroken": True}),
    "CleanObject": ("dirtyable", {"isDirty": False}),
    "CookObject": ("cookable", {"isCooked": True}),
    "DirtyObject": ("dirtyable", {"isDirty": True}),
    "EmptyLiquidFromObject": ("fillable", {"isFilledWithLiquid": False, "fillLiquid": None}),
    "UseUpObject": ("used_up", {"isUsedUp": True}),
}

ACTIONS: dict[str, Action] = {
    **{name: _changing(name, able, **values) for name, (able, values) in _ONE_WAY.items()},
    "FillObjectWithLiquid": fill_object_with_liquid,
    "SliceObject": slice_object,
}
