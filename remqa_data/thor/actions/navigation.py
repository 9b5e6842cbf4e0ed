"""Walking, turning and looking.

`forceAction` lets nobody through anything: in AI2-THOR it only ignores what the held object meets, which is nothing here
without an arm.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from remqa_data.errors import MisuseError
from remqa_data.sim.agent.results import ActionResult
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import PartialVector, Vector, facing, to_room, to_thor, whole, yaw_to_room
from remqa_data.thor.state.simulator import SimulatorState

NO_PITCH = "No agents currently can change in pitch or roll. So, you must set rotation(x=0, y=yaw, z=0)."
"""AI2-THOR's words."""
UPRIGHT_DEG = 0.01
"""What a rotation tilts by less than that is upright."""
HEIGHT_TOLERANCE_M = 0.05
"""How far from the floor a teleport may aim; the agent stands on the floor afterwards."""


def look_up(simulator: SimulatorState, degrees: float = 0.0, manualInteract: bool = False) -> ActionResult:
    """Tilt the camera up, by default by 30 degrees."""
    return _then_rest(simulator, _look(simulator, -1, degrees), manualInteract)


def look_down(simulator: SimulatorState, degrees: float = 0.0, manualInteract: bool = False) -> ActionResult:
    """Tilt the camera down, by default by 30 degrees."""
    return _then_rest(simulator, _look(simulator, 1, degrees), manualInteract)


def teleport(
    simulator: SimulatorState,
    position: PartialVector | None = None,
    rotation: PartialVector | None = None,
    horizon: float | None = None,
    standing: bool | None = None,
    forceAction: bool = False,
    x: float | None = None,
    y: float | None = None,
    z: float | None = None,
) -> ActionResult:
    """Be somewhere else; what is not given stays as it is. A position is a vector, or x, y and z."""
    if position is not None:
        if (x, y, z) != (None, None, None):
            raise MisuseError(
                "AmbiguousAction", "Ambiguous action: a position was given twice, as a vector and as x, y, z"
            )
        x, y, z = position.get("x"), position.get("y"), position.get("z")
    stands_at = simulator.room.agent_y
    if y is not None and abs(y - stands_at) > HEIGHT_TOLERANCE_M and not forceAction:
        return ActionResult(
            False, f"y {y:g} is more than {HEIGHT_TOLERANCE_M} m from {stands_at:g}, where the agent stands"
        )
    turned = whole(rotation or {})
    if max(abs(turned["x"]), abs(turned["z"])) >= UPRIGHT_DEG and not forceAction:
        return ActionResult(False, f"{NO_PITCH} You gave ({turned['x']:f}, {turned['y']:f}, {turned['z']:f}).")
    yaw = None if rotation is None else yaw_to_room(turned["y"])
    if horizon is not None and forceAction:
        horizon = -((180.0 - horizon) % 360.0 - 180.0)  # 330 is -30
    elif horizon is not None and simulator.agent.tilt_refusal(horizon):
        least, most = simulator.agent.embodiment.least_horizon_deg, simulator.agent.embodiment.most_horizon_deg
        return ActionResult(False, f"Each horizon must be in [{least:g}:{most:g}]. You gave {horizon:g}.")
    return _then_rest(simulator, simulator.agent.teleport(x, z, yaw, horizon, standing, forceAction))


def rotate_look(
    simulator: SimulatorState, rotation: PartialVector | None = None, horizon: float | None = None
) -> ActionResult:
    """Look somewhere, however the agent looked before; what is not given stays as it is."""
    return teleport(simulator, rotation=rotation, horizon=horizon)


def crouch(simulator: SimulatorState) -> ActionResult:
    """Lower the camera."""
    return simulator.agent.crouch()


def stand(simulator: SimulatorState) -> ActionResult:
    """Stand up."""
    return simulator.agent.stand()


def _walk(ahead: int = 0, right: int = 0, *, any_way: bool = False) -> ActionFunction:
    """The action of walking one way, looking ahead; by default one cell of the grid, and also the other way if any will do."""

    def walk(
        simulator: SimulatorState,
        moveMagnitude: float | None = None,
        forceAction: bool = False,
        objectId: str = "",
        maxAgentsDistance: float = -1.0,
        manualInteract: bool = False,
        allowAgentsToIntersect: bool = False,
    ) -> ActionResult:
        distance = simulator.settings.grid_size if moveMagnitude is None else moveMagnitude
        if distance <= 0.0 and not any_way:
            return ActionResult(
                False, f"moveMagnitude must be positive, not {distance:g}: name the direction in the action"
            )
        step = (ahead * distance, right * distance)
        with simulator.agent.passing_agents(allowAgentsToIntersect):
            moved = _too_far_from(simulator, objectId, maxAgentsDistance, *step) or _move(simulator, *step)
        return _then_rest(simulator, moved, manualInteract)

    return walk


def _turn(counter_clockwise: int, *, any_way: bool = False) -> ActionFunction:
    """The action of turning, by default as far as Initialize has set, and also by nothing if any angle will do."""

    def turn(
        simulator: SimulatorState, degrees: float | None = None, forceAction: bool = False, manualInteract: bool = False
    ) -> ActionResult:
        angle = simulator.settings.rotate_step_degrees if degrees is None else degrees
        if angle == 0 and not any_way:
            return ActionResult(False, "degrees must be non-zero")
        return _then_rest(simulator, simulator.agent.rotate(counter_clockwise * angle), manualInteract)

    return turn


ACTIONS: dict[str, ActionFunction] = {
    "Crouch": crouch,
    "LookDown": look_down,
    "LookUp": look_up,
    "MoveAhead": _walk(ahead=1),
    "MoveBack": _walk(ahead=-1),
    "MoveLeft": _walk(right=-1),
    "MoveRight": _walk(right=1),
    "RotateLeft": _turn(1),
    "RotateLook": rotate_look,
    "RotateRight": _turn(-1),
    "Stand": stand,
    "Teleport": teleport,
    "TeleportFull": teleport,
}
ANY_WAY: dict[str, ActionFunction] = {
    "MoveAhead": _walk(ahead=1, any_way=True),
    "MoveBack": _walk(ahead=-1, any_way=True),
    "MoveLeft": _walk(right=-1, any_way=True),
    "MoveRight": _walk(right=1, any_way=True),
    "RotateLeft": _turn(1, any_way=True),
    "RotateRight": _turn(-1, any_way=True),
}
"""What an agent with an arm does otherwise: it takes any distance and angle."""


def _then_rest(simulator: SimulatorState, result: ActionResult, stays: bool = False) -> ActionResult:
    """A result of having moved, after which the hand is where it usually is, unless it stays."""
    if result.success and not stays:
        simulator.agent.rest_hand()
    return result


def _way(simulator: SimulatorState, ahead: float, right: float) -> Vector:
    """The way that so many metres are, in AI2-THOR's frame."""
    right_of, ahead_of = facing(simulator.agent.yaw_deg)[:, :2].T
    return to_thor(ahead * ahead_of + right * right_of)


def _too_far_from(
    simulator: SimulatorState, object_id: str, most_m: float, ahead: float, right: float
) -> ActionResult | None:
    """That a step would end too far from an object, if it is to stay near to one."""
    if not object_id or most_m <= 0.0:
        return None
    if object_id not in simulator.room.world.there:
        return ActionResult(False, f"No object with ID {object_id}")
    there = np.add(simulator.room.agent_position(), to_room(_way(simulator, ahead, right)))
    if math.dist(there, simulator.room.records.position(object_id)) > most_m:
        return ActionResult(False, f"Agent movement would bring it beyond the max distance of {object_id}")
    return None


def _move(simulator: SimulatorState, ahead: float, right: float) -> ActionResult:
    agent = simulator.agent
    moved = agent.move(ahead, right)
    if moved.blocked_by is None:
        return moved
    way = _way(simulator, ahead, right)
    by = f"({way['x']:.4f}, {way['y']:.4f}, {way['z']:.4f})"
    return replace(moved, error=f"{moved.blocked_by} is blocking Agent {agent.number} from moving by {by}.")


def _look(simulator: SimulatorState, down: int, degrees: float) -> ActionResult:
    if degrees < 0:
        return ActionResult(False, f"degrees must be positive, not {degrees:g}: name the direction in the action")
    agent = simulator.agent
    angle = down * (degrees or agent.embodiment.look_deg)
    if not agent.can_look(angle):
        return ActionResult(
            False,
            f"can't look down beyond {agent.embodiment.most_horizon_deg:g} degrees below the forward horizon"
            if down > 0
            else f"can't look up beyond {-agent.embodiment.least_horizon_deg:g} degrees above the forward horizon",
        )
    return agent.look(angle)
