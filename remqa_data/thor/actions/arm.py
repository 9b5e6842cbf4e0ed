"""What the agent with an arm does in its own way, as in ManipulaTHOR.

An arm is there at once, or stops before what is in its way. In AI2-THOR that is only what never moves: a hand that is sent
into a thing that can be picked up pushes it about. Here the hand goes into it or, if a table is in its way, touches it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import cast

import numpy as np

from remqa_data.catalog import object_type
from remqa_data.errors import ActionError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.arm import jaco
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.thor.actions import navigation
from remqa_data.thor.actions import objects as actions_objects
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.arm_agent import CARRY_STEP_DEG, CARRY_STEP_M, ArmAgent
from remqa_data.thor.state.arm_metadata import hand_facing
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import SWAP, PartialVector, Vector, facing, to_room, turn_of_euler, whole
from remqa_data.thor.state.simulator import SimulatorState

SPACES = ("armBase", "world", "wrist")
"""Where a position is given: from the shoulder, with x to the agent's right and z ahead of it; in the room; or from the hand,
with x to its right and z out of the palm."""

LEAST_RADIUS_M, MOST_RADIUS_M = 0.04, 0.5
IS_THERE_M = 1e-4
"""So near to where it should go the hand stays where it is."""


def move_arm(
    simulator: SimulatorState,
    position: PartialVector,
    coordinateSpace: str = "armBase",
    returnToStart: bool = True,
    handCameraSpace: bool = False,
) -> ActionResult:
    """Bring the hand to a position, metres; `handCameraSpace` is an old name of the coordinate space "wrist"."""
    coordinateSpace = "wrist" if handCameraSpace else coordinateSpace
    arm, base = simulator.agent.arm, simulator.agent.base
    origin = arm.hand(base) if coordinateSpace == "wrist" else arm.shoulder(base)
    return _reach(simulator, _in_room(simulator, whole(position), coordinateSpace, origin), returnToStart)


def move_arm_relative(
    simulator: SimulatorState, offset: PartialVector, coordinateSpace: str = "armBase", returnToStart: bool = True
) -> ActionResult:
    """Bring the hand somewhere, as seen from where it is."""
    hand = simulator.agent.arm.hand(simulator.agent.base)
    if coordinateSpace == "world":
        x, y, z = (np.asarray(hand) + np.asarray(to_room(whole(offset)))).tolist()
        return _reach(simulator, (x, y, z), returnToStart)
    return _reach(simulator, _in_room(simulator, whole(offset), coordinateSpace, hand), returnToStart)


def move_arm_base(
    simulator: SimulatorState, y: float, normalizedY: bool = True, returnToStart: bool = True
) -> ActionResult:
    """Slide the shoulder: 0 is lowest and 1 highest, or metres if not normalised."""
    if normalizedY:
        if not 0.0 <= y <= 1.0:
            return ActionResult(False, f"y {y:g} is not between 0 and 1")
        y = AGENT.shoulder_low_m + y * (AGENT.shoulder_high_m - AGENT.shoulder_low_m)
    return _or_back(simulator, returnToStart, lambda: simulator.agent.set_arm_base(y))


def move_arm_base_up(simulator: SimulatorState, distance: float, returnToStart: bool = True) -> ActionResult:
    """Slide the shoulder up, metres, as far as it goes."""
    height = simulator.agent.arm.state.base_height_m + distance
    height = min(max(height, AGENT.shoulder_low_m), AGENT.shoulder_high_m)
    return _or_back(simulator, returnToStart, lambda: simulator.agent.set_arm_base(height))


def move_arm_base_down(simulator: SimulatorState, distance: float, returnToStart: bool = True) -> ActionResult:
    """Slide the shoulder down, metres, as far as it goes."""
    return move_arm_base_up(simulator, -distance, returnToStart)


def pick_up_object(
    simulator: SimulatorState,
    objectIdCandidates: list[str] | None = None,
    objectId: str | None = None,
    x: float | None = None,
    y: float | None = None,
    forceAction: bool = False,
    manualInteract: bool = False,
) -> ActionResult:
    """Take hold of the objects that the hand touches, of those that are named, if any are; no point of a frame names one."""
    if (x, y) != (None, None):
        return ActionResult(False, "an arm takes what its hand touches: x and y name nothing")
    agent, world = simulator.agent, simulator.room.world
    names = [objectId] if objectId is not None else objectIdCandidates
    touched = agent.arm.touched(agent.arm.hand(agent.base))
    fit = [name for name in touched if object_type(world.type_of(name)).pickupable]
    chosen = [name for name in fit if names is None or name in names]
    if not chosen:
        named = "" if names is None else " (specified by objectId)"
        return ActionResult(False, f"No objects{named} were valid to be picked up by the arm")
    return agent.pick_up(chosen[0], force=True, along=chosen[1:])


def release_object(simulator: SimulatorState) -> ActionResult:
    """Let go of what the hand holds, if it holds something."""
    if simulator.agent.held is None:
        return ActionResult(True)
    dropped = actions_objects.drop_object(simulator)
    return ActionResult(dropped.success, dropped.error)


def set_hand_sphere_radius(simulator: SimulatorState, radius: float) -> ActionResult:
    """Set how near the hand must come to touch an object, metres."""
    if not LEAST_RADIUS_M <= radius <= MOST_RADIUS_M:
        return ActionResult(False, f"radius {radius:g} is not between {LEAST_RADIUS_M} and {MOST_RADIUS_M} m")
    simulator.agent.arm.hand_radius_m = radius
    return ActionResult(True)


def move_agent(
    simulator: SimulatorState,
    ahead: float | None = None,
    right: float | None = None,
    forceAction: bool = False,
    returnToStart: bool = True,
) -> ActionResult:
    """Walk straight, metres, with the arm as it is held; who is stopped goes back, or stays there."""
    if ahead is None and right is None:
        return ActionResult(False, "Must specify ahead or right!")
    agent, ahead, right = simulator.agent, ahead or 0.0, right or 0.0
    walked = agent.move(ahead, right, forceAction)
    if not walked.success and not returnToStart:
        steps = math.ceil(math.hypot(ahead, right) / CARRY_STEP_M)
        _as_far_as_it_goes(steps, lambda: agent.move(ahead / steps, right / steps))
    return walked


def rotate_agent(simulator: SimulatorState, degrees: float, returnToStart: bool = True) -> ActionResult:
    """Turn clockwise, with the arm as it is held; who is stopped turns back, or stays so."""
    agent = simulator.agent
    turned = agent.rotate(-degrees)
    if not turned.success and not returnToStart:
        steps = math.ceil(min(abs(degrees), 360.0) / CARRY_STEP_DEG)
        _as_far_as_it_goes(steps, lambda: agent.rotate(-degrees / steps))
    return turned


def rotate_wrist_relative(
    simulator: SimulatorState, pitch: float = 0.0, yaw: float = 0.0, roll: float = 0.0, returnToStart: bool = True
) -> ActionResult:
    """Turn the hand about its own axes, degrees, and what it holds with it; its middle stays where it is."""
    agent = _with_arm(simulator)
    hand = _hand_axes(agent)
    local = arithmetic.product(arithmetic.product(SWAP, turn_of_euler({"x": pitch, "y": yaw, "z": -roll})), SWAP)
    rotation = arithmetic.product(arithmetic.product(hand, local), hand.T)
    return _or_back(simulator, returnToStart, lambda: agent.turn_hand(rotation))


def rotate_elbow_relative(simulator: SimulatorState, degrees: float, returnToStart: bool = True) -> ActionResult:
    """Turn the elbow about the line from the shoulder to the hand, whose middle stays where it is; the hand turns with it."""
    agent = _with_arm(simulator)
    return _or_back(simulator, returnToStart, lambda: agent.turn_elbow(-math.radians(degrees)))


ACTIONS: dict[str, ActionFunction] = {
    "MoveAgent": move_agent,
    **navigation.ANY_WAY,
    "MoveArm": move_arm,
    "MoveArmBase": move_arm_base,
    "MoveArmBaseDown": move_arm_base_down,
    "MoveArmBaseUp": move_arm_base_up,
    "MoveArmRelative": move_arm_relative,
    "PickupObject": pick_up_object,
    "ReleaseObject": release_object,
    "RotateAgent": rotate_agent,
    "RotateElbowRelative": rotate_elbow_relative,
    "RotateWristRelative": rotate_wrist_relative,
    "SetHandSphereRadius": set_hand_sphere_radius,
}


def _as_far_as_it_goes(steps: int, step: Callable[[], ActionResult]) -> None:
    """Take so many steps, or as many as succeed."""
    for _ in range(steps):
        if not step().success:
            break


def _with_arm(simulator: SimulatorState) -> ArmAgent:
    """Who acts; these actions exist only in arm mode, in which all agents have arms."""
    return cast(ArmAgent, simulator.agent)


def _in_room(simulator: SimulatorState, position: Vector, space: str, origin: Vec3) -> Vec3:
    """A position of AI2-THOR in the room, metres.

    Raises
    ------
    ActionError
        If there is no such space.
    """
    if space not in SPACES:
        raise ActionError(f"Invalid coordinateSpace: {space}")
    if space == "world":
        return to_room(position)
    agent = simulator.agent
    axes = _hand_axes(agent) if space == "wrist" else facing(agent.yaw_deg)
    away = axes @ np.array(to_room(position))
    x, y, z = (np.asarray(origin) + away).tolist()
    return x, y, z


def _hand_axes(agent: ThorAgent) -> F64:
    """(3, 3) the hand's right, ahead and up in the room, as columns."""
    return hand_facing(agent.arm.link_poses(agent.base)[jaco.HAND])


def _reach(simulator: SimulatorState, point: Vec3, return_to_start: bool) -> ActionResult:
    agent = simulator.agent
    if math.dist(agent.arm.hand(agent.base), point) < IS_THERE_M:
        return ActionResult(True)
    return _or_back(simulator, return_to_start, lambda: _bring_hand(agent, point))


def _bring_hand(agent: ThorAgent, point: Vec3) -> ActionResult:
    """Bring the hand to a point, into what can be picked up there; or else until it touches that."""
    world, before = agent.world, agent.arm.state
    there = [name for name in agent.arm.touched(point) if object_type(world.type_of(name)).pickupable]
    stopped = agent.arm.move_hand(agent.base, point, ignore=there)
    if stopped.success:
        return ActionResult(True)
    after = agent.arm.state
    for name in there:
        agent.arm.state = before
        if agent.arm.touch(agent.base, name, point).success:
            return ActionResult(True)
    agent.arm.state = after
    return ActionResult(False, stopped.error)


def _or_back(simulator: SimulatorState, return_to_start: bool, movement: Callable[[], ActionResult]) -> ActionResult:
    """Move the arm; if it is stopped, it goes back to where it was, or stays there."""
    arm = simulator.agent.arm
    before = arm.state
    result = movement()
    if not result.success and return_to_start:
        arm.state = before
    return ActionResult(result.success, result.error)
