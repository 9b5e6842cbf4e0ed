"""What a straight line through the room meets first, and where the frame shows a point."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.geometry.types import F64
from remqa_data.sim.agent.results import ActionResult
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import PartialVector, Vector, to_room, to_thor, whole
from remqa_data.thor.state.simulator import SimulatorState

LONGEST_M = 50.0
"""No ray meets anything farther away."""


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


def world_to_viewport_point(simulator: SimulatorState, position: PartialVector) -> ActionResult:
    """Where the frame shows a point: x to the right and y down, both from 0 to 1, and z its depth in metres."""
    camera = simulator.room.frame_camera()
    (x, y, depth), view = camera.project([to_room(whole(position))])[0].tolist(), camera.view()
    x, y = x / view.width, y / view.height
    if depth <= 0.0 or not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
        return ActionResult(False, "Point not in viewport.")
    return ActionResult(True, value={"x": x, "y": y, "z": depth})


def perform_raycast(simulator: SimulatorState, origin: PartialVector, destination: PartialVector) -> ActionResult:
    """The first object on the way from a point towards another one, and beyond it, and where it is met.

    Collision boxes are met, as in AI2-THOR, not the surfaces that the pictures show.
    """
    start, end = to_room(whole(origin)), to_room(whole(destination))
    between = f"from {_words(origin)} towards {_words(destination)}"
    length = math.dist(start, end)
    if length == 0.0:
        return ActionResult(False, "origin and destination are the same point")
    x, y, z = (start + (np.subtract(end, start) / length) * LONGEST_M).tolist()
    hit = simulator.room.world.first_hit(start, (x, y, z))
    if hit is None:
        return ActionResult(False, f"nothing is hit {between}")
    name, point = hit
    if name not in simulator.room.world.ids:
        return ActionResult(
            False, f"no object is hit {between}, but a part of the building at {_words(to_thor(point))}"
        )
    value = {"objectId": name, "hitPoint": to_thor(point), "hitDistance": math.dist(start, point)}
    return ActionResult(True, value=value)


def get_object_hit_from_raycast(
    simulator: SimulatorState, origin: PartialVector, destination: PartialVector
) -> ActionResult:
    """The id of the first object on the way from a point towards another one."""
    met = perform_raycast(simulator, origin, destination)
    return ActionResult(True, value=met.value["objectId"]) if met.success else met


ACTIONS: dict[str, ActionFunction] = {
    "GetCoordinateFromRaycast": get_coordinate_from_raycast,
    "GetObjectHitFromRaycast": get_object_hit_from_raycast,
    "PerformRaycast": perform_raycast,
    "WorldToViewportPoint": world_to_viewport_point,
}


def _words(point: PartialVector | Vector) -> str:
    x, y, z = (point.get(axis, 0.0) for axis in ("x", "y", "z"))
    return f"({x:g}, {y:g}, {z:g})"
