"""What AI2-THOR's agent does to an object without moving it: to break, cook, dirty, clean, fill, empty, slice and use it up."""

from __future__ import annotations

from collections.abc import Sequence

from remqa_data.catalog import object_type
from remqa_data.sim.agent.handling import settle
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.physics.world import World
from remqa_data.thor.actions.targets import target_of
from remqa_data.thor.object_states.conditions import BROKEN, CONDITIONS, FILLED, LIQUIDS
from remqa_data.thor.object_states.pieces import pieces_of
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.simulator import SimulatorState


def fill_object_with_liquid(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    fillLiquid: str = "water",
    forceAction: bool = False,
) -> ActionResult:
    """Fill an object with water, coffee or wine, in whatever case it is written."""
    liquid = fillLiquid.lower()
    if liquid not in LIQUIDS:
        return ActionResult(False, f"fillLiquid {fillLiquid!r} is none of {', '.join(LIQUIDS)}")
    target = target_of(simulator, "FillObjectWithLiquid", objectId, x, y)
    return _put(simulator, target, forceAction, FILLED, True, liquid)


def slice_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Slice an object; an egg is cracked. The pieces, of a type of their own, fall where they are."""
    target = target_of(simulator, "SliceObject", objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    room, agent = simulator.room, simulator.agent
    if not _has_pieces(room.world, target):
        return ActionResult(False, f"{target} is not sliceable")
    if target in room.world.held:
        return ActionResult(False, f"{target} is in the hand: put it down to slice it")
    refusal = agent.access_refusal(target, forceAction)
    if refusal is not None:
        return refusal
    cut(simulator, [target])
    return ActionResult(True)


def can_be_cut(world: World, object_id: str) -> bool:
    """Whether an object can be sliced, or cracked, where it is."""
    return object_id not in world.held and _has_pieces(world, object_id)


def _has_pieces(world: World, object_id: str) -> bool:
    return object_type(world.type_of(object_id)).slices is not None


def cut(simulator: SimulatorState, targets: Sequence[str]) -> None:
    """Put the pieces of some objects in their places; the room is loaded anew once for all of them."""
    room = simulator.room
    room.records.update()
    pieces = {target: pieces_of(room.world, target) for target in targets}
    room.records.sliced.update(targets)
    room.add([piece for made in pieces.values() for piece in made], simulator.settings)
    for target, made in pieces.items():
        room.conditions.change(target, isSliced=True)
        for piece in made:
            room.conditions.pass_on(target, piece.id)
        room.take_away(target)
    settle(room.world)


def break_all(simulator: SimulatorState, targets: Sequence[str]) -> list[str]:
    """Break some objects, and say which: they fall from hands, and an egg is cracked where it is then.

    An egg in something that is held stays whole.
    """
    room, broken = simulator.room, []
    for target in targets:
        holder = next((agent for agent in room.agents if agent.held == target), None)
        if holder is None and target in room.world.held and _has_pieces(room.world, target):
            continue
        room.conditions.put(target, BROKEN, True)
        if holder is not None:
            holder.drop(force=True)
        broken.append(target)
    if cracked := [name for name in broken if can_be_cut(room.world, name)]:
        cut(simulator, cracked)
    return broken


def _putting(action: str, condition: str, is_so: bool) -> ActionFunction:
    """An action that brings an object that can be in it into a condition, or out of it."""

    def act(
        simulator: SimulatorState,
        objectId: str | None = None,
        x: float | None = None,
        y: float | None = None,
        forceAction: bool = False,
    ) -> ActionResult:
        return _put(simulator, target_of(simulator, action, objectId, x, y), forceAction, condition, is_so)

    return act


def _put(
    simulator: SimulatorState, target: str | ActionResult, force: bool, name: str, is_so: bool, liquid: str = "water"
) -> ActionResult:
    if isinstance(target, ActionResult):
        return target
    room, agent, condition = simulator.room, simulator.agent, CONDITIONS[name]
    if condition.able not in object_type(room.world.type_of(target)).can:
        return ActionResult(False, f"{target} is not {condition.able.replace('_', ' ')}")
    if bool(room.conditions.of(target).get(name)) == is_so:
        return ActionResult(False, f"{target} is {'already' if is_so else 'not'} {condition.word}")
    if name == FILLED and is_so and room.conditions.of(target).get(BROKEN):
        return ActionResult(False, f"{target} is broken and holds nothing")
    refusal = agent.access_refusal(target, force or target == agent.held)
    if refusal is not None:
        return refusal
    if name == BROKEN and is_so:
        is_broken = break_all(simulator, [target]) == [target]
        return ActionResult(is_broken, "" if is_broken else f"{target} is in what is held: put that down to break it")
    room.conditions.put(target, name, is_so, liquid)
    return ActionResult(True)


_BROUGHT_ABOUT = {
    "BreakObject": (BROKEN, True),
    "CleanObject": ("isDirty", False),
    "CookObject": ("isCooked", True),
    "DirtyObject": ("isDirty", True),
    "EmptyLiquidFromObject": (FILLED, False),
    "UseUpObject": ("isUsedUp", True),
}

ACTIONS: dict[str, ActionFunction] = {
    **{action: _putting(action, condition, is_so) for action, (condition, is_so) in _BROUGHT_ABOUT.items()},
    "FillObjectWithLiquid": fill_object_with_liquid,
    "SliceObject": slice_object,
}
