"""Actions under the names, and with the arguments, that they had in earlier versions of AI2-THOR, as Unity still takes them."""

from __future__ import annotations

from typing import Any

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.sim.agent.results import ActionResult
from remqa_data.thor.actions import arm, hand, navigation, objects, search
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import PartialVector
from remqa_data.thor.state.simulator import SimulatorState

LEAST_TILT_DEG = 1.0
"""Tilts of the camera that are looked from are at least so far apart."""


def positions_from_which_item_is_interactable(
    simulator: SimulatorState,
    objectId: str,
    positions: list[PartialVector] | None = None,
    rotations: list[float] | None = None,
    horizons: list[float] | None = None,
    standings: list[bool] | None = None,
    maxDistance: float | None = None,
    maxPoses: int | None = None,
    horizon: float = 30.0,
) -> ActionResult:
    """What `GetInteractablePoses` finds, as lists of numbers, one for each of x, y, z, ...; `horizon` lies between tilts."""
    if horizon < LEAST_TILT_DEG:
        return ActionResult(False, f"horizon must be at least {LEAST_TILT_DEG:g} degrees, not {horizon:g}")
    if horizons is None:
        body = simulator.agent.embodiment
        horizons = np.arange(body.least_horizon_deg, body.most_horizon_deg + 1e-6, horizon).tolist()
    found = search.get_interactable_poses(
        simulator, objectId, positions, rotations, horizons, standings, maxDistance, maxPoses
    )
    if not found.success:
        return found
    names = ("x", "y", "z", "rotation", "standing", "horizon")
    return ActionResult(True, value={name: [float(pose[name]) for pose in found.value] for name in names})


def move(
    simulator: SimulatorState,
    x: float = 0.0,
    z: float = 0.0,
    moveMagnitude: float | None = None,
    forceAction: bool = False,
) -> ActionResult:
    """Walk along the room's axes, metres, whichever way the agent looks."""
    agent = simulator.agent
    sine, cosine = arithmetic.sin_cos_deg(agent.yaw_deg)
    return agent.move(float(x * cosine + z * sine), float(x * sine - z * cosine), forceAction)


def rotate(simulator: SimulatorState, rotation: PartialVector) -> ActionResult:
    """Look along a heading, degrees."""
    return navigation.rotate_look(simulator, rotation)


def look(simulator: SimulatorState, horizon: float) -> ActionResult:
    """Tilt the camera to an angle, degrees."""
    return navigation.rotate_look(simulator, horizon=horizon)


def move_hand(simulator: SimulatorState, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> ActionResult:
    """Move what is held, metres: x to the agent's right, y up, z ahead, however its camera is tilted."""
    sine, cosine = arithmetic.sin_cos_deg(simulator.agent.horizon_deg)
    ahead, up = float(z * cosine - y * sine), float(z * sine + y * cosine)
    return hand.move_held_object(simulator, ahead=ahead, right=x, up=up)


def move_hand_delta(simulator: SimulatorState, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> ActionResult:
    """Move what is held, metres: x to the camera's right, y up, z ahead."""
    return hand.move_held_object(simulator, ahead=z, right=x, up=y)


def rotate_hand(simulator: SimulatorState, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> ActionResult:
    """Turn what is held to a rotation in the camera's frame, degrees."""
    return hand.rotate_held_object(simulator, rotation={"x": x, "y": y, "z": z})


def rotate_hand_relative(simulator: SimulatorState, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> ActionResult:
    """Turn what is held about the agent's axes, degrees."""
    return hand.rotate_held_object(simulator, pitch=x, yaw=y, roll=-z)


def move_mid_level_arm(
    simulator: SimulatorState,
    position: PartialVector,
    handCameraSpace: bool = False,
    returnToStart: bool = True,
    **ignored: Any,
) -> ActionResult:
    """Bring the hand to a position, as seen from the shoulder, or from the hand."""
    return arm.move_arm(simulator, position, "armBase", returnToStart, handCameraSpace)


def move_mid_level_arm_height(
    simulator: SimulatorState, y: float, returnToStart: bool = True, **ignored: Any
) -> ActionResult:
    """Slide the shoulder: 0 is lowest and 1 highest."""
    return arm.move_arm_base(simulator, y, returnToStart=returnToStart)


def pick_up_mid_level_hand(
    simulator: SimulatorState, objectIdCandidates: list[str] | None = None, **ignored: Any
) -> ActionResult:
    """Take hold of the objects that the hand touches."""
    return arm.pick_up_object(simulator, objectIdCandidates)


def drop_mid_level_hand(simulator: SimulatorState, **ignored: Any) -> ActionResult:
    """Let go of what the hand holds."""
    return arm.release_object(simulator)


def move_continuous(simulator: SimulatorState, direction: PartialVector, **ignored: Any) -> ActionResult:
    """Walk straight, metres: x to the right and z ahead."""
    return arm.move_agent(simulator, direction.get("z", 0.0), direction.get("x", 0.0))


def rotate_continuous(simulator: SimulatorState, degrees: float, **ignored: Any) -> ActionResult:
    """Turn clockwise."""
    return arm.rotate_agent(simulator, degrees)


ACTIONS: dict[str, ActionFunction] = {
    "Look": look,
    "Move": move,
    "MoveGlobal": move,
    "MoveHand": move_hand,
    "MoveHandAhead": hand.move_held_object_ahead,
    "MoveHandBack": hand.move_held_object_back,
    "MoveHandDelta": move_hand_delta,
    "MoveHandDown": hand.move_held_object_down,
    "MoveHandLeft": hand.move_held_object_left,
    "MoveHandRight": hand.move_held_object_right,
    "MoveHandUp": hand.move_held_object_up,
    "OpenObjectImmediate": objects.open_object,
    "PlaceHeldObject": objects.put_object,
    "PositionsFromWhichItemIsInteractable": positions_from_which_item_is_interactable,
    "Rotate": rotate,
    "RotateHand": rotate_hand,
    "RotateHandRelative": rotate_hand_relative,
}
ARM_ACTIONS: dict[str, ActionFunction] = {
    "DropMidLevelHand": drop_mid_level_hand,
    "MoveContinuous": move_continuous,
    "MoveMidLevelArm": move_mid_level_arm,
    "MoveMidLevelArmHeight": move_mid_level_arm_height,
    "PickUpMidLevelHand": pick_up_mid_level_hand,
    "RotateContinuous": rotate_continuous,
}
