"""Walking, turning and looking."""

from __future__ import annotations

from remqa_data.errors import MisuseError
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.frames import PartialVector, yaw_to_room
from remqa_data.thor.state.simulator import AGENT_Y, Stage

HEIGHT_TOLERANCE_M = 0.05
"""How far from the floor a teleport may aim; the agent stands on the floor afterwards."""


def move_ahead(stage: Stage, moveMagnitude: float | None = None, forceAction: bool = False) -> ActionResult:
    """Walk ahead by a number of metres, by default one cell of the grid."""
    return _move(stage, 1, 0, moveMagnitude, forceAction)


def move_back(stage: Stage, moveMagnitude: float | None = None, forceAction: bool = False) -> ActionResult:
    """Walk backwards."""
    return _move(stage, -1, 0, moveMagnitude, forceAction)


def move_right(stage: Stage, moveMagnitude: float | None = None, forceAction: bool = False) -> ActionResult:
    """Walk to the right, looking ahead."""
    return _move(stage, 0, 1, moveMagnitude, forceAction)


def move_left(stage: Stage, moveMagnitude: float | None = None, forceAction: bool = False) -> ActionResult:
    """Walk to the left, looking ahead."""
    return _move(stage, 0, -1, moveMagnitude, forceAction)


def rotate_right(stage: Stage, degrees: float | None = None, forceAction: bool = False) -> ActionResult:
    """Turn clockwise, by default as far as Initialize has set."""
    return _rotate(stage, -1, degrees)


def rotate_left(stage: Stage, degrees: float | None = None, forceAction: bool = False) -> ActionResult:
    """Turn counter-clockwise."""
    return _rotate(stage, 1, degrees)


def look_up(stage: Stage, degrees: float | None = None) -> ActionResult:
    """Tilt the camera up."""
    return stage.agent.look(-(stage.agent.embodiment.look_deg if degrees is None else degrees))


def look_down(stage: Stage, degrees: float | None = None) -> ActionResult:
    """Tilt the camera down."""
    return stage.agent.look(stage.agent.embodiment.look_deg if degrees is None else degrees)


def teleport(
    stage: Stage,
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
    if y is not None and abs(y - AGENT_Y) > HEIGHT_TOLERANCE_M and not forceAction:
        return ActionResult(
            False, f"y {y:g} is more than {HEIGHT_TOLERANCE_M} m from {AGENT_Y}, where the agent stands"
        )
    yaw = None if rotation is None else yaw_to_room(rotation.get("y", 0.0))
    return stage.agent.teleport(x, z, yaw, horizon, standing, forceAction)


def crouch(stage: Stage) -> ActionResult:
    """Lower the camera."""
    return stage.agent.crouch()


def stand(stage: Stage) -> ActionResult:
    """Stand up."""
    return stage.agent.stand()


ACTIONS: dict[str, Action] = {
    "Crouch": crouch,
    "LookDown": look_down,
    "LookUp": look_up,
    "MoveAhead": move_ahead,
    "MoveBack": move_back,
    "MoveLeft": move_left,
    "MoveRight": move_right,
    "RotateLeft": rotate_left,
    "RotateRight": rotate_right,
    "Stand": stand,
    "Teleport": teleport,
    "TeleportFull": teleport,
}


def _move(stage: Stage, ahead: int, right: int, metres: float | None, force: bool) -> ActionResult:
    distance = stage.settings.grid_size if metres is None else metres
    if distance < 0:
        return ActionResult(False, f"moveMagnitude {distance:g} is negative: name the direction in the action")
    return stage.agent.move(ahead * distance, right * distance, force)


def _rotate(stage: Stage, counter_clockwise: int, degrees: float | None) -> ActionResult:
    angle = stage.settings.rotate_step_degrees if degrees is None else degrees
    if angle < 0:
        return ActionResult(False, f"degrees {angle:g} is negative: name the direction in the action")
    return stage.agent.rotate(counter_clockwise * angle)
