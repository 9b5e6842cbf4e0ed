"""Acting on objects as AI2-THOR's agent without an arm does: on what it sees within its visibility distance."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection

import numpy as np

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import about_z, rotation_of
from remqa_data.geometry.types import F64, Flags
from remqa_data.sim.agent.receptacles import CLOSED
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.physics.bodies import FRICTION, GRAVITY_M_S2
from remqa_data.thor.actions.compatible import is_compatible, is_specific
from remqa_data.thor.actions.rays import shown_at
from remqa_data.thor.actions.targets import target_of
from remqa_data.thor.object_states.conditions import BASINS
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import PartialVector, to_thor, whole, yaw_to_thor
from remqa_data.thor.state.simulator import SimulatorState, generator

NO_OBJECT = "not a sim object, a structure was touched"
"""AI2-THOR's words for a wall or the floor."""
NO_PLACE = "No valid positions to place object found"
"""AI2-THOR's words, which its clients look for."""
NOTHING_TO_PUT = "Can't place an object if Agent isn't holding anything"
"""The same."""
NOT_OPEN = "Target openable Receptacle is CLOSED, can't place if target is not open!"
"""The same."""
UPRIGHT = 0.999
"""Cosine of the angle from which a thing counts as tilted."""
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
    target = target_of(simulator, "OpenObject", objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    refusal = simulator.room.conditions.opening_refusal(target)
    if refusal is not None:
        return ActionResult(False, refusal)
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
    target = target_of(simulator, "CloseObject", objectId, x, y)
    return target if isinstance(target, ActionResult) else _plain(simulator.agent.close(target, forceAction))


def pick_up_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
    manualInteract: bool = False,
) -> ActionResult:
    """Take an object into the hand, where it faces as the agent does; with `manualInteract` it stays where it was."""
    target = target_of(simulator, "PickupObject", objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    agent, room = simulator.agent, simulator.room
    where = room.world.box(target).mean(axis=0)
    result = agent.pick_up(target, forceAction)
    if result.success and manualInteract:
        agent.hand_offset = agent.offset_of(where)
    elif result.success:
        agent.turn_held(about_z(room.records.rotation(target)["y"] - yaw_to_thor(agent.yaw_deg)))
    return ActionResult(True, value=target) if result.success else result


def put_object(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
    placeStationary: bool = True,
    receptacleObjectId: str | None = None,
    randomSeed: int = 0,
    putNearXY: bool = False,
) -> ActionResult:
    """Put what is held into or onto a receptacle, which `receptacleObjectId` names in old code; a sink means its basin.

    Without `forceAction` it goes where such things go, see `compatible`. Of the places where there is room it gets the one
    nearest to the agent; with a `randomSeed`, to a point of the receptacle that is drawn; with `putNearXY`, to what (x, y)
    of the frame shows.
    """
    target = target_of(simulator, "PutObject", receptacleObjectId or objectId, x, y)
    if isinstance(target, ActionResult):
        return target
    world, held = simulator.room.world, simulator.agent.held
    if held is None:
        return ActionResult(False, NOTHING_TO_PUT)
    near = _near(simulator, target, x, y, randomSeed, putNearXY)
    if isinstance(near, ActionResult):
        return near
    named, basins = target, {f"{target}|{name}" for name in BASINS} & set(world.ids)
    target = basins.pop() if basins else target
    if is_specific(world.type_of(target)) and not _may_be_put(simulator, held, {target}):
        return ActionResult(False, f"{held} is not a valid Object Type to be placed in {named}")
    if not forceAction and not _may_be_put(simulator, held, {named, target}) and simulator.agent.refusal(named) is None:
        return ActionResult(False, f"{held} cannot be placed in {named}")
    turned = world.state(held).quaternion
    _stand_up(simulator)
    result = simulator.agent.put(target, forceAction, near, named, _within_reach(simulator))
    if not result.success:
        world.move_alone(held, world.state(held).position, turned)
    if result.error == f"{target} is {CLOSED}":
        return ActionResult(False, NOT_OPEN)
    return ActionResult(False, NO_PLACE) if result.error.startswith("no free place") else _plain(result)


def _within_reach(simulator: SimulatorState) -> Callable[[F64], Flags]:
    """What says of (n, 3) points in the room which are no farther from the agent than it sees things to act on, (n,)."""
    here, reach = simulator.room.agent_position(), simulator.settings.visibility_distance
    return lambda points: np.asarray(arithmetic.length(points - here) <= reach)


def drop_object(simulator: SimulatorState, forceAction: bool = False) -> ActionResult:
    """Let go of what is held; returns where it comes to rest."""
    agent, held = simulator.agent, simulator.agent.held
    dropped = agent.drop(forceAction)
    if held is None or not dropped.success:
        return dropped
    return ActionResult(True, value=to_thor(simulator.room.records.position(held)))


def push_object(
    simulator: SimulatorState,
    moveMagnitude: float = 0.0,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Push an object in the direction that the agent faces, with a force in newtons."""
    return _push(simulator, target_of(simulator, "PushObject", objectId, x, y), moveMagnitude, 0.0, forceAction)


def pull_object(
    simulator: SimulatorState,
    moveMagnitude: float = 0.0,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Push an object against the direction that the agent faces."""
    return _push(simulator, target_of(simulator, "PullObject", objectId, x, y), moveMagnitude, 180.0, forceAction)


def directional_push(
    simulator: SimulatorState,
    moveMagnitude: float = 0.0,
    pushAngle: float = 0.0,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Push an object at an angle clockwise from the direction that the agent faces, degrees."""
    target = target_of(simulator, "DirectionalPush", objectId, x, y)
    return _push(simulator, target, moveMagnitude, pushAngle, forceAction)


def touch_then_apply_force(
    simulator: SimulatorState,
    x: float,
    y: float,
    direction: PartialVector | None = None,
    moveMagnitude: float = 0.0,
    handDistance: float | None = None,
) -> ActionResult:
    """Reach for what a point of the frame shows, as far as `handDistance`, and push it, in newtons; returns what is touched.

    A direction is as the agent faces; what of it goes up or down is lost to friction. Less than no force pushes backwards.
    """
    shown = shown_at(simulator, x, y)
    if isinstance(shown, ActionResult):
        return shown
    reach = simulator.settings.visibility_distance if handDistance is None else handDistance
    if shown.away_m > reach:
        return ActionResult(True, value={"didHandTouchSomething": False, "objectId": "", "armsLength": reach})
    touched, ahead = shown.object_id, whole(direction or {})
    if touched is not None and shown.away_m > simulator.settings.visibility_distance:
        return ActionResult(
            False,
            "Object successfully hit, but it is outside of the Agent's interaction range",
            {"didHandTouchSomething": False, "objectId": "", "armsLength": reach},
        )
    share = math.hypot(ahead["x"], ahead["z"]) / (math.hypot(ahead["x"], ahead["y"], ahead["z"]) or 1.0)
    if touched is not None and moveMagnitude * share != 0.0:  # what cannot be moved stays
        angle = math.degrees(math.atan2(ahead["x"], ahead["z"])) + (180.0 if moveMagnitude < 0.0 else 0.0)
        _push(simulator, touched, abs(moveMagnitude) * share, angle, force=True)
    value = {"didHandTouchSomething": True, "objectId": touched or NO_OBJECT, "armsLength": shown.away_m}
    return ActionResult(True, value=value)


def set_mass_properties(
    simulator: SimulatorState, objectId: str, mass: float, drag: float = 0.0, angularDrag: float = 0.0
) -> ActionResult:
    """Let an object weigh something else, kilograms; a push or throw sends it as far as that lets it go."""
    target = target_of(simulator, "SetMassProperties", objectId, None, None)
    if isinstance(target, ActionResult):
        return target
    if not object_type(simulator.room.world.type_of(target)).is_loose:
        return ActionResult(False, f"{target} is neither pickupable nor moveable")
    if mass < 0.0:
        return ActionResult(False, f"mass {mass:g} is negative: give kilograms")
    simulator.room.records.set_mass(target, mass)
    return ActionResult(True)


def toggle_object_on(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Switch an object on."""
    return _toggle(simulator, target_of(simulator, "ToggleObjectOn", objectId, x, y), True, forceAction)


def toggle_object_off(
    simulator: SimulatorState,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Switch an object off."""
    return _toggle(simulator, target_of(simulator, "ToggleObjectOff", objectId, x, y), False, forceAction)


ACTIONS: dict[str, ActionFunction] = {
    "CloseObject": close_object,
    "DirectionalPush": directional_push,
    "DropHandObject": drop_object,
    "DropHeldObject": drop_object,
    "DropHeldObjectAhead": drop_object,
    "OpenObject": open_object,
    "PickupObject": pick_up_object,
    "PullObject": pull_object,
    "PushObject": push_object,
    "PutObject": put_object,
    "SetMassProperties": set_mass_properties,
    "ToggleObjectOff": toggle_object_off,
    "ToggleObjectOn": toggle_object_on,
    "TouchThenApplyForce": touch_then_apply_force,
}


def _plain(result: ActionResult) -> ActionResult:
    """A result without our own answer: AI2-THOR's actions on objects return nothing."""
    return ActionResult(result.success, result.error)


def _stand_up(simulator: SimulatorState) -> None:
    """Turn what is held and has been tilted to how it lay or stood when the room was loaded, as it is put down so."""
    world, loaded = simulator.room.world, simulator.room.at_rest.states
    held = simulator.agent.held
    if held is None or held not in loaded:
        return
    state = world.state(held)
    upright = loaded[held].quaternion
    if float(arithmetic.dot(rotation_of(state.quaternion)[2], rotation_of(upright)[2])) < UPRIGHT:
        world.move_alone(held, state.position, upright)


def _push(
    simulator: SimulatorState, target: str | ActionResult, newtons: float, angle_deg: float, force: bool
) -> ActionResult:
    if isinstance(target, ActionResult):
        return target
    if target in simulator.room.world.held:
        return ActionResult(False, "Please use Throw for an item in the Agent's Hand")
    if not object_type(simulator.room.world.type_of(target)).is_loose:
        return ActionResult(False, f"{target} is not moveable")
    if newtons < 0.0:
        return ActionResult(False, f"moveMagnitude {newtons:g} is not a force: give newtons")
    agent, room = simulator.agent, simulator.room
    if newtons == 0.0:
        refusal = agent.access_refusal(target, force)
        return refusal or ActionResult(True, value=to_thor(room.records.position(target)))
    distance = _slide_m(newtons, room.records.mass_kg(target))
    x, y, _ = room.world.state(target).position
    away_deg = math.degrees(math.atan2(y - agent.y, x - agent.x))
    pushed = agent.push(target, distance, agent.yaw_deg - angle_deg - away_deg, force)
    if not pushed.success:
        return pushed
    return ActionResult(True, value=to_thor(room.records.position(target)))


def _near(
    simulator: SimulatorState, target: str, x: float | None, y: float | None, seed: int, near_xy: bool
) -> tuple[float, float] | ActionResult | None:
    """To which x and y in the room, metres, something is to be put near; None for the agent's."""
    if near_xy:
        if x is None or y is None:
            return ActionResult(False, "putNearXY needs x and y")
        shown = shown_at(simulator, x, y)
        if isinstance(shown, ActionResult):
            return shown
        return None if shown.point is None else (float(shown.point[0]), float(shown.point[1]))
    if seed:
        low, high = simulator.room.world.box(target)[:, :2]
        drawn_x, drawn_y = generator(seed).uniform(low, high).tolist()
        return drawn_x, drawn_y
    return None


def _may_be_put(simulator: SimulatorState, object_id: str, receptacles: Collection[str]) -> bool:
    """Whether any of the names of a receptacle, if it is one, is of a type that takes an object."""
    world = simulator.room.world
    types = {world.type_of(name) for name in receptacles}
    is_receptacle = any(object_type(name).receptacle for name in types)
    return not is_receptacle or any(is_compatible(world.type_of(object_id), name) for name in types)


def _slide_m(newtons: float, mass_kg: float) -> float:
    """How far a push sends an object, metres; one that friction would swallow moves it a millimetre."""
    speed = newtons * PUSH_S / mass_kg
    return min(max(speed**2 / (2 * FRICTION * -GRAVITY_M_S2), 0.001), AGENT.push_m)


def _toggle(simulator: SimulatorState, target: str | ActionResult, on: bool, force: bool) -> ActionResult:
    if isinstance(target, ActionResult):
        return target
    conditions, world = simulator.room.conditions, simulator.room.world
    if not object_type(world.type_of(target)).toggleable:
        return ActionResult(False, f"{target} is not toggleable")
    if conditions.is_on(target) == on:
        return ActionResult(False, f"{target} is already {'on' if on else 'off'}")
    if on and (why := conditions.switch_refusal(target)) is not None:
        return ActionResult(False, why)
    agent = simulator.agent
    refusal = agent.access_refusal(target, force or target == agent.held)
    if refusal is not None:
        return refusal
    conditions.change(target, isToggled=on)
    return ActionResult(True)
