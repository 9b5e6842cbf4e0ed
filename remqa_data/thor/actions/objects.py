"""Acting on objects as AI2-THOR's agent without an arm does: on what it sees within its visibility distance.

An object is named by its id, or by a point of the frame: x to the right and y down, both from 0 to 1.
"""

from __future__ import annotations

import math

from remqa_data.catalog import object_type
from remqa_data.errors import MisuseError
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.physics.bodies import FRICTION, GRAVITY_M_S2
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.simulator import SimulatorState

NO_PLACE = "No valid positions to place object found"
"""AI2-THOR's words, which its clients look for."""
PUSH_S = 0.02
"""A push in newtons acts for one physics step of AI2-THOR; then the object slides until friction stops it."""


def open_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    openness: float = 1.0,
    forceAction: bool = False,
    moveMagnitude: float | None = None,
) -> ActionResult:
    """Open an object. `moveMagnitude` is the old name of `openness`, with 0 for all the way."""
    target = _target(simulator, "OpenObject", objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    share = openness if moveMagnitude is None else moveMagnitude or 1.0
    return _plain(simulator.agent.open(target, share, forceAction))


def close_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Close an object."""
    target = _target(simulator, "CloseObject", objectId, x, y)
    return target if isinstance(target, ActionResult) else _plain(simulator.agent.close(target, forceAction))


def pick_up_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
    manualInteract: bool = False,
) -> ActionResult:
    """Take an object into the hand; with `manualInteract` the hand is where the object was."""
    target = _target(simulator, "PickupObject", objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    where = simulator.room.world.box(target).mean(axis=0)
    result = simulator.agent.pick_up(target, forceAction)
    if result.success and manualInteract:
        simulator.agent.hand_offset = simulator.agent.offset_of(where)
    return result


def put_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
    placeStationary: bool = True,
    receptacleObjectId: str | None = None,
) -> ActionResult:
    """Put what is held into or onto a receptacle, which `receptacleObjectId` names in old code."""
    target = _target(simulator, "PutObject", receptacleObjectId or objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    result = simulator.agent.put(target, forceAction)
    return ActionResult(False, NO_PLACE) if result.error.startswith("no free place") else _plain(result)


def drop_object(simulator: SimulatorState, forceAction: bool = False) -> ActionResult:
    """Let go of what is held."""
    return _plain(simulator.agent.drop())


def push_object(
    simulator: SimulatorState,
    moveMagnitude: float,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Push an object in the direction that the agent faces, with a force in newtons."""
    return _push(simulator, _target(simulator, "PushObject", objectId, x, y), moveMagnitude, 0.0)


def pull_object(
    simulator: SimulatorState,
    moveMagnitude: float,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Push an object against the direction that the agent faces."""
    return _push(simulator, _target(simulator, "PullObject", objectId, x, y), moveMagnitude, 180.0)


def directional_push(
    simulator: SimulatorState,
    moveMagnitude: float,
    pushAngle: float,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Push an object at an angle clockwise from the direction that the agent faces, degrees."""
    return _push(simulator, _target(simulator, "DirectionalPush", objectId, x, y), moveMagnitude, pushAngle)


def toggle_object_on(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Switch an object on."""
    return _toggle(simulator, _target(simulator, "ToggleObjectOn", objectId, x, y), True, forceAction)


def toggle_object_off(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Switch an object off."""
    return _toggle(simulator, _target(simulator, "ToggleObjectOff", objectId, x, y), False, forceAction)


ACTIONS: dict[str, Action] = {
    "CloseObject": close_object,
    "DirectionalPush": directional_push,
    "DropHandObject": drop_object,
    "DropHeldObject": drop_object,
    "OpenObject": open_object,
    "PickupObject": pick_up_object,
    "PullObject": pull_object,
    "PushObject": push_object,
    "PutObject": put_object,
    "ToggleObjectOff": toggle_object_off,
    "ToggleObjectOn": toggle_object_on,
}


def _target(
    simulator: SimulatorState, action: str, object_id: str | None, x: float | None, y: float | None
) -> str | ActionResult:
    """The id of the object that an action is about, or why there is none."""
    if object_id is not None:
        is_away = object_id in simulator.room.records.away
        return ActionResult(False, f"{object_id} is not in the scene") if is_away else object_id
    if x is None or y is None:
        raise MisuseError("MissingArguments", f"action: {action} is missing the following arguments: objectId")
    seen = simulator.agent.object_at(x, y, simulator.room.frame_camera())
    return seen or ActionResult(False, f"no object at ({x:g}, {y:g})")


def _plain(result: ActionResult) -> ActionResult:
    """A result without our own answer: AI2-THOR's actions on objects return nothing."""
    return ActionResult(result.success, result.error)


def _push(simulator: SimulatorState, target: str | ActionResult, newtons: float, angle_deg: float) -> ActionResult:
    if isinstance(target, ActionResult):
        return target
    if newtons <= 0:
        return ActionResult(False, f"moveMagnitude {newtons:g} is not a force: give newtons")
    agent, world = simulator.agent, simulator.room.world
    distance = _slide_m(newtons, object_type(world.type_of(target)).mass_kg or 1.0)
    x, y, _ = world.state(target).position
    away_deg = math.degrees(math.atan2(y - agent.y, x - agent.x))
    return _plain(agent.push(target, distance, agent.yaw_deg - angle_deg - away_deg))


def _slide_m(newtons: float, mass_kg: float) -> float:
    """How far a push sends an object, metres; one that friction would swallow moves it a millimetre."""
    speed = newtons * PUSH_S / mass_kg
    return min(max(speed**2 / (2 * FRICTION * -GRAVITY_M_S2), 0.001), AGENT.push_m)


def _toggle(simulator: SimulatorState, target: str | ActionResult, on: bool, force: bool) -> ActionResult:
    if isinstance(target, ActionResult):
        return target
    toggled = simulator.room.records.toggled
    if not object_type(simulator.room.world.type_of(target)).toggleable:
        return ActionResult(False, f"{target} is not toggleable")
    if (target in toggled) == on:
        return ActionResult(False, f"{target} is already {'on' if on else 'off'}")
    agent = simulator.agent
    refusal = None if force else agent.refusal(target) or agent.reach(target)
    if refusal is not None:
        return refusal
    (toggled.add if on else toggled.remove)(target)
    return ActionResult(True)
