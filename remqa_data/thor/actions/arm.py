"""What the agent with an arm does in its own way, as in ManipulaTHOR.

An arm is there at once, or stops before what is in its way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from remqa_data.catalog import object_type
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.sim.navigation.grid import SHOULDER_HIGH_M, SHOULDER_LOW_M
from remqa_data.thor.actions import objects as actions_objects
from remqa_data.thor.state.arm_metadata import touched_objects
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.frames import PartialVector, Vector, to_room, whole
from remqa_data.thor.state.simulator import Stage

Space = Literal["armBase", "world"]
"""Where a position is given: in the room, or from the shoulder, with x to the agent's right and z ahead of it."""

LEAST_RADIUS_M, MOST_RADIUS_M = 0.04, 0.5


def move_arm(
    stage: Stage, position: PartialVector, coordinateSpace: Space = "armBase", returnToStart: bool = True
) -> ActionResult:
    """Bring the hand to a position, metres."""
    origin = stage.agent.arm.shoulder(stage.agent.base)
    return _reach(stage, _in_room(stage, whole(position), coordinateSpace, origin), returnToStart)


def move_arm_relative(
    stage: Stage, offset: PartialVector, coordinateSpace: Space = "armBase", returnToStart: bool = True
) -> ActionResult:
    """Bring the hand somewhere, as seen from where it is."""
    hand = stage.agent.arm.hand(stage.agent.base)
    if coordinateSpace == "world":
        x, y, z = (np.asarray(hand) + np.asarray(to_room(whole(offset)))).tolist()
        return _reach(stage, (x, y, z), returnToStart)
    return _reach(stage, _in_room(stage, whole(offset), coordinateSpace, hand), returnToStart)


def move_arm_base(stage: Stage, y: float, normalizedY: bool = True, returnToStart: bool = True) -> ActionResult:
    """Slide the shoulder: 0 is lowest and 1 highest, or metres if not normalised."""
    if normalizedY:
        if not 0.0 <= y <= 1.0:
            return ActionResult(False, f"y {y:g} is not between 0 and 1")
        y = SHOULDER_LOW_M + y * (SHOULDER_HIGH_M - SHOULDER_LOW_M)
    return _or_back(stage, returnToStart, lambda: stage.agent.set_arm_base(y))


def move_arm_base_up(stage: Stage, distance: float, returnToStart: bool = True) -> ActionResult:
    """Slide the shoulder up, metres."""
    height = stage.agent.arm.state.base_height_m + distance
    return _or_back(stage, returnToStart, lambda: stage.agent.set_arm_base(height))


def move_arm_base_down(stage: Stage, distance: float, returnToStart: bool = True) -> ActionResult:
    """Slide the shoulder down, metres."""
    return move_arm_base_up(stage, -distance, returnToStart)


def pick_up_object(
    stage: Stage, objectIdCandidates: list[str] | None = None, objectId: str | None = None
) -> ActionResult:
    """Take hold of the nearest object that the hand touches, of those that are named, if any."""
    agent, world = stage.agent, stage.room.world
    names = [objectId] if objectId is not None else objectIdCandidates
    touched = touched_objects(world, agent.arm.hand(agent.base), agent.arm.hand_radius_m)
    fit = [name for name in touched if object_type(world.type_of(name)).pickupable]
    chosen = [name for name in fit if names is None or name in names]
    if not chosen:
        return ActionResult(False, "no pickupable object is within the hand's sphere")
    return agent.pick_up(chosen[0], force=True)


def release_object(stage: Stage) -> ActionResult:
    """Let go of what the hand holds."""
    return actions_objects.drop_object(stage)


def set_hand_sphere_radius(stage: Stage, radius: float) -> ActionResult:
    """Set how near the hand must come to touch an object, metres."""
    if not LEAST_RADIUS_M <= radius <= MOST_RADIUS_M:
        return ActionResult(False, f"radius {radius:g} is not between {LEAST_RADIUS_M} and {MOST_RADIUS_M} m")
    stage.agent.arm.hand_radius_m = radius
    return ActionResult(True)


def move_agent(stage: Stage, ahead: float = 0.0, right: float = 0.0, forceAction: bool = False) -> ActionResult:
    """Walk straight, metres; the arm folds first."""
    return stage.agent.move(ahead, right, forceAction)


def rotate_agent(stage: Stage, degrees: float) -> ActionResult:
    """Turn clockwise; the arm folds first."""
    return stage.agent.rotate(-degrees)


ACTIONS: dict[str, Action] = {
    "MoveAgent": move_agent,
    "MoveArm": move_arm,
    "MoveArmBase": move_arm_base,
    "MoveArmBaseDown": move_arm_base_down,
    "MoveArmBaseUp": move_arm_base_up,
    "MoveArmRelative": move_arm_relative,
    "PickupObject": pick_up_object,
    "ReleaseObject": release_object,
    "RotateAgent": rotate_agent,
    "SetHandSphereRadius": set_hand_sphere_radius,
}


def _in_room(stage: Stage, position: Vector, space: Space, origin: Vec3) -> Vec3:
    """A position of AI2-THOR in the room, metres."""
    if space == "world":
        return to_room(position)
    yaw = np.radians(stage.agent.yaw_deg)
    ahead: F64 = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    right: F64 = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
    up: F64 = np.array([0.0, 0.0, 1.0])
    place = np.asarray(origin) + position["x"] * right + position["y"] * up + position["z"] * ahead
    x, y, z = place.tolist()
    return x, y, z


def _reach(stage: Stage, point: Vec3, return_to_start: bool) -> ActionResult:
    return _or_back(stage, return_to_start, lambda: stage.agent.move_hand(point))


def _or_back(stage: Stage, return_to_start: bool, movement: Callable[[], ActionResult]) -> ActionResult:
    """Move the arm; if it is stopped, it goes back to where it was, or stays there."""
    arm = stage.agent.arm
    before = arm.state
    result = movement()
    if not result.success and return_to_start:
        arm.state = before
    return ActionResult(result.success, result.error)
