"""Walking, turning and looking.

`forceAction` lets nobody through anything: in AI2-THOR it only ignores what the held object meets, which is nothing here.
"""

from __future__ import annotations

from remqa_data.errors import MisuseError
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.frames import PartialVector, facing, yaw_to_room
from remqa_data.thor.state.simulator import SimulatorState

BLOCKED = " is blocking Agent from moving"
"""What an agent says that meets something."""
HEIGHT_TOLERANCE_M = 0.05
"""How far from the floor a teleport may aim; the agent stands on the floor afterwards."""


def rotate_right(simulator: SimulatorState, degrees: float | None = None, forceAction: bool = False) -> ActionResult:
    """Turn clockwise, by default as far as Initialize has set."""
    return _rotate(simulator, -1, degrees)


def rotate_left(simulator: SimulatorState, degrees: float | None = None, forceAction: bool = False) -> ActionResult:
    """Turn counter-clockwise."""
    return _rotate(simulator, 1, degrees)


def look_up(simulator: SimulatorState, degrees: float = 0.0) -> ActionResult:
    """Tilt the camera up, by default by 30 degrees."""
    return _look(simulator, -1, degrees)


def look_down(simulator: SimulatorState, degrees: float = 0.0) -> ActionResult:
    """Tilt the camera down, by default by 30 degrees."""
    return _look(simulator, 1, degrees)


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
    yaw = None if rotation is None else yaw_to_room(rotation.get("y", 0.0))
    return simulator.agent.teleport(x, z, yaw, horizon, standing, forceAction)


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


def _walk(ahead: int = 0, right: int = 0) -> Action:
    """The action of walking one way, looking ahead; by default one cell of the grid."""

    def walk(
        simulator: SimulatorState,
        moveMagnitude: float | None = None,
        forceAction: bool = False,
        objectId: str = "",
        maxAgentsDistance: float = -1.0,
    ) -> ActionResult:
        return _move(simulator, ahead, right, moveMagnitude)

    return walk


ACTIONS: dict[str, Action] = {
    "Crouch": crouch,
    "LookDown": look_down,
    "LookUp": look_up,
    "MoveAhead": _walk(ahead=1),
    "MoveBack": _walk(ahead=-1),
    "MoveLeft": _walk(right=-1),
    "MoveRight": _walk(right=1),
    "RotateLeft": rotate_left,
    "RotateLook": rotate_look,
    "RotateRight": rotate_right,
    "Stand": stand,
    "Teleport": teleport,
    "TeleportFull": teleport,
}


def _move(simulator: SimulatorState, ahead: int, right: int, metres: float | None) -> ActionResult:
    distance = simulator.settings.grid_size if metres is None else metres
    if distance <= 0:
        return ActionResult(
            False, f"moveMagnitude must be positive, not {distance:g}: name the direction in the action"
        )
    agent = simulator.agent
    moved = agent.move(ahead * distance, right * distance)
    if not moved.error.endswith(BLOCKED):
        return moved
    right_of, ahead_of = facing(agent.yaw_deg)[:, :2].T
    x, y, _ = (ahead * distance * ahead_of + right * distance * right_of).tolist()
    by = f"({x:.4f}, {0.0:.4f}, {y:.4f})"
    return ActionResult(
        False, f"{moved.error.removesuffix(BLOCKED)} is blocking Agent {agent.number} from moving by {by}."
    )


def _rotate(simulator: SimulatorState, counter_clockwise: int, degrees: float | None) -> ActionResult:
    angle = simulator.settings.rotate_step_degrees if degrees is None else degrees
    if angle == 0:
        return ActionResult(False, "degrees must be non-zero")
    return simulator.agent.rotate(counter_clockwise * angle)


def _look(simulator: SimulatorState, down: int, degrees: float) -> ActionResult:
    if degrees < 0:
        return ActionResult(False, f"degrees must be positive, not {degrees:g}: name the direction in the action")
    return simulator.agent.look(down * (degrees or simulator.agent.embodiment.look_deg))
