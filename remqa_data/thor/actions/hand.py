"""What the agent without an arm does with what it holds: moves it, turns it, throws it.

Directions are the camera's. What is held stops before what is in its way, and is out of the room all the same: nothing in
the room falls onto it or meets it.
"""

from __future__ import annotations

import math

import numpy as np

from remqa_data.errors import MisuseError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64
from remqa_data.scene import Quaternion
from remqa_data.sim.agent import handling
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.physics.world import World
from remqa_data.thor.actions.objects import PUSH_S
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import PartialVector, Vector, to_thor, turn_of_euler, turn_of_look, whole
from remqa_data.thor.state.simulator import SimulatorState

OUT_OF_RANGE = "The target position is out of range: object cannot move outside of max visibility distance."
OUT_OF_FRAME = (
    "Target position is outside of the agent's viewport. The target position must be within the frustrum of it."
)
STEP_M = 0.025
"""On its way, what is held is looked at in such steps."""
MOST_THROW_M_S = 5.0
"""Nothing is thrown faster: in one step of physics it would fly through things."""


def move_held_object(
    simulator: SimulatorState, ahead: float = 0.0, right: float = 0.0, up: float = 0.0
) -> ActionResult:
    """Move what is held, metres; its middle stays in the frame, and within the visibility distance in plan."""
    agent, world = simulator.agent, simulator.room.world
    refusal = _refusal(agent)
    if refusal is not None:
        return refusal
    held = str(agent.held)
    x, y, z = np.add(agent.hand_offset, (right, up, ahead)).tolist()
    there = agent.hand_at((x, y, z))
    if math.dist(there[:2], (agent.x, agent.y)) > simulator.settings.visibility_distance:
        return ActionResult(False, OUT_OF_RANGE)
    if not agent.has_in_frame((x, y, z)):
        return ActionResult(False, OUT_OF_FRAME)
    blocker = _blocker(world, held, np.asarray(agent.hand_at()), np.asarray(there))
    if blocker is not None:
        return ActionResult(False, f"{blocker} is blocking {held} from moving")
    agent.hand_offset = (x, y, z)
    return ActionResult(True)


def move_held_object_ahead(simulator: SimulatorState, moveMagnitude: float | None = None) -> ActionResult:
    """Move what is held away, by default by one cell of the grid."""
    return move_held_object(simulator, ahead=_distance(simulator, moveMagnitude))


def move_held_object_back(simulator: SimulatorState, moveMagnitude: float | None = None) -> ActionResult:
    """Draw what is held nearer."""
    return move_held_object(simulator, ahead=-_distance(simulator, moveMagnitude))


def move_held_object_right(simulator: SimulatorState, moveMagnitude: float | None = None) -> ActionResult:
    """Move what is held to the right."""
    return move_held_object(simulator, right=_distance(simulator, moveMagnitude))


def move_held_object_left(simulator: SimulatorState, moveMagnitude: float | None = None) -> ActionResult:
    """Move what is held to the left."""
    return move_held_object(simulator, right=-_distance(simulator, moveMagnitude))


def move_held_object_up(simulator: SimulatorState, moveMagnitude: float | None = None) -> ActionResult:
    """Lift what is held."""
    return move_held_object(simulator, up=_distance(simulator, moveMagnitude))


def move_held_object_down(simulator: SimulatorState, moveMagnitude: float | None = None) -> ActionResult:
    """Lower what is held."""
    return move_held_object(simulator, up=-_distance(simulator, moveMagnitude))


def rotate_held_object(
    simulator: SimulatorState,
    pitch: float | None = None,
    yaw: float | None = None,
    roll: float | None = None,
    rotation: PartialVector | None = None,
) -> ActionResult:
    """Turn what is held, degrees: by pitch, yaw, roll (to the right) about the agent's axes, or to a rotation in the camera's.

    A vessel that is turned over is empty.
    """
    by: Vector = {"x": pitch or 0.0, "y": yaw or 0.0, "z": -(roll or 0.0)}
    if rotation is not None and (pitch, yaw, roll) != (None, None, None):
        message = "Ambiguous action: a rotation was given twice, as a vector and as pitch, yaw, roll"
        raise MisuseError("AmbiguousAction", message)
    agent, world, records = simulator.agent, simulator.room.world, simulator.room.records
    refusal = _refusal(agent)
    if refusal is not None:
        return refusal
    held = str(agent.held)
    if rotation is not None:
        turn = arithmetic.product(turn_of_look(agent.yaw_deg, agent.horizon_deg), turn_of_euler(whole(rotation)))
    else:
        body = turn_of_look(agent.yaw_deg)
        about_body = arithmetic.product(arithmetic.product(body, turn_of_euler(by)), body.T)
        turn = arithmetic.product(about_body, records.turn(held))
    _, quaternion = records.pose_of(held, (0.0, 0.0, 0.0), turn)
    blocker = _blocker_of_turn(world, held, np.asarray(agent.hand_at()), quaternion)
    if blocker is not None:
        return ActionResult(False, f"{blocker} is blocking {held} from turning")
    agent.tilt_held(quaternion)
    return ActionResult(True)


def throw_object(simulator: SimulatorState, moveMagnitude: float, forceAction: bool = False) -> ActionResult:
    """Throw what is held where the camera looks, with a force in newtons that acts for one physics step of AI2-THOR."""
    agent, world = simulator.agent, simulator.room.world
    if agent.held is None:
        return ActionResult(False, "Nothing in Hand to Throw!")
    if moveMagnitude < 0.0:
        return ActionResult(False, f"moveMagnitude {moveMagnitude:g} is not a force: give newtons")
    mass = simulator.room.records.mass_kg(agent.held)
    ahead = agent.camera().rotation()[2]
    x, y, z = arithmetic.snapped(min(moveMagnitude * PUSH_S / mass, MOST_THROW_M_S) * ahead).tolist()
    released = handling.drop_at(world, agent.held, [agent.hand_at(), *agent.drop_spots()], (x, y, z))
    if released.object_id is None:
        return ActionResult(False, released.error)
    agent.rest_hand()
    return ActionResult(True, value=to_thor(simulator.room.records.position(released.object_id)))


ACTIONS: dict[str, ActionFunction] = {
    "MoveHeldObject": move_held_object,
    "MoveHeldObjectAhead": move_held_object_ahead,
    "MoveHeldObjectBack": move_held_object_back,
    "MoveHeldObjectDown": move_held_object_down,
    "MoveHeldObjectLeft": move_held_object_left,
    "MoveHeldObjectRight": move_held_object_right,
    "MoveHeldObjectUp": move_held_object_up,
    "RotateHeldObject": rotate_held_object,
    "ThrowObject": throw_object,
}


def _refusal(agent: ThorAgent) -> ActionResult | None:
    if agent.hands == "arm":
        return ActionResult(False, "the arm moves what it holds: MoveArm")
    return ActionResult(False, "nothing is held") if agent.held is None else None


def _distance(simulator: SimulatorState, metres: float | None) -> float:
    return simulator.settings.grid_size if metres is None else metres


def _blocker(world: World, held: str, start: F64, end: F64) -> str | None:
    """What the held object meets on its way; what it is in already only where it gets deeper into that."""
    quaternion = world.state(held).quaternion
    before = _depths(world, held, start, quaternion)
    count = max(1, math.ceil(float(arithmetic.length(end - start)) / STEP_M))
    way = (start + k / count * (end - start) for k in range(1, count + 1))
    met = (handling.deeper(_depths(world, held, point, quaternion), before) for point in way)
    return next((min(names) for names in met if names), None)


def _blocker_of_turn(world: World, held: str, hand: F64, quaternion: Quaternion) -> str | None:
    """What the held object would meet if it were turned."""
    before = _depths(world, held, hand, world.state(held).quaternion)
    return min(handling.deeper(_depths(world, held, hand, quaternion), before), default=None)


def _depths(world: World, held: str, hand: F64, quaternion: Quaternion) -> dict[str, float]:
    """How deep the held object would be in what, metres, if the hand were at a (3,) point; it stays where it is."""
    before = world.save()
    x, y, z = arithmetic.snapped(hand).tolist()
    world.move_alone(held, (x, y, z), quaternion)
    depths = handling.touched(world, held)
    world.restore(before)
    return depths
