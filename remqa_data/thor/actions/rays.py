"""What a straight line through the room meets first."""

from __future__ import annotations

import math

from remqa_data.sim.agent.agent import ActionResult
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.frames import PartialVector, to_room, to_thor, whole
from remqa_data.thor.state.simulator import SimulatorState


def get_coordinate_from_raycast(simulator: SimulatorState, x: float, y: float) -> ActionResult:
    """The point of the room that a point of the frame shows; x to the right and y down, both from 0 to 1."""
    if not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
        return ActionResult(False, f"x and y must be in [0:1] not (x={x:g}, y={y:g}).")
    camera = simulator.room.frame_camera()
    depth, _ = simulator.room.view.depth_and_instances(camera)
    height, width = depth.shape
    row, column = min(int(y * height), height - 1), min(int(x * width), width - 1)
    metres = float(depth[row, column])
    if metres <= 0.0:
        return ActionResult(False, f"nothing is seen at ({x:g}, {y:g})")
    return ActionResult(True, value=to_thor(camera.unproject(depth)[row, column]))


def perform_raycast(simulator: SimulatorState, origin: PartialVector, destination: PartialVector) -> ActionResult:
    """The first thing between two points; `objectId` is None for a part of the building.

    Collision boxes are met, as in AI2-THOR, not the surfaces that the pictures show.
    """
    start, end = to_room(whole(origin)), to_room(whole(destination))
    hit = simulator.room.world.first_hit(start, end)
    if hit is None:
        return ActionResult(False, f"nothing is hit between {_words(origin)} and {_words(destination)}")
    name, point = hit
    is_object = name in simulator.room.world.ids
    value = {"objectId": name if is_object else None, "hit": to_thor(point), "distance": math.dist(start, point)}
    return ActionResult(True, value=value)


ACTIONS: dict[str, Action] = {
    "GetCoordinateFromRaycast": get_coordinate_from_raycast,
    "PerformRaycast": perform_raycast,
}


def _words(point: PartialVector) -> str:
    x, y, z = whole(point).values()
    return f"({x:g}, {y:g}, {z:g})"
