"""What a straight line through the room meets first."""

from __future__ import annotations

import math
from typing import NamedTuple

from remqa_data.geometry.types import F64
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.frames import PartialVector, to_room, to_thor, whole
from remqa_data.thor.state.simulator import SimulatorState


class Shown(NamedTuple):
    """What a point of the frame shows.

    Attributes
    ----------
    point : (3,) float64 or None
        Metres in the room; None where nothing is.
    away_m : float
        How far that is from the camera; infinitely where nothing is.
    object_id : str or None
        None for the building.
    """

    point: F64 | None
    away_m: float
    object_id: str | None


def shown_at(simulator: SimulatorState, x: float, y: float) -> Shown | ActionResult:
    """What a point of the frame shows, x to the right and y down, both from 0 to 1; or that there is no such point."""
    if not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
        return ActionResult(False, f"x and y must be in [0:1] not (x={x:g}, y={y:g}).")
    room, camera = simulator.room, simulator.room.frame_camera()
    depth, objects = room.view.depth_and_instances(camera)
    height, width = depth.shape
    pixel = min(int(y * height), height - 1), min(int(x * width), width - 1)
    if depth[pixel] <= 0.0:
        return Shown(None, math.inf, None)
    point, index = camera.unproject(depth)[pixel], int(objects[pixel])
    return Shown(point, math.dist(point, camera.position), room.world.ids[index] if index >= 0 else None)


def get_coordinate_from_raycast(simulator: SimulatorState, x: float, y: float) -> ActionResult:
    """The point of the room that a point of the frame shows; see `shown_at`."""
    shown = shown_at(simulator, x, y)
    if isinstance(shown, ActionResult):
        return shown
    if shown.point is None:
        return ActionResult(False, f"nothing is seen at ({x:g}, {y:g})")
    return ActionResult(True, value=to_thor(shown.point))


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
