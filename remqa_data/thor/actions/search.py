"""Questions about the room: where the agent can be, how it gets there, from where an object can be acted on."""

from __future__ import annotations

import math
from collections import deque
from itertools import product

import numpy as np
import numpy.typing as npt

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec2
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.grid import Cell
from remqa_data.sim.navigation.ground import Ground
from remqa_data.sim.render.camera import AnyCamera
from remqa_data.thor.actions.targets import not_there, of_type
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.dispatch import ActionFunction, missing_argument
from remqa_data.thor.state.events import object_records
from remqa_data.thor.state.frames import PartialVector, Vector, to_room, to_thor, whole, yaw_to_room, yaw_to_thor
from remqa_data.thor.state.simulator import SimulatorState

HORIZONS_DEG, STANDINGS = (-30.0, 0.0, 30.0, 60.0), (False, True)
MOST_STEPS = 10_000
"""By default no more cells of a grid of 1 m are walked on, and of another one as many as cover the same floor."""
NORTH_DEG = yaw_to_room(0.0)
"""Heading of who looks along AI2-THOR's z."""
RIGHT_AND_AHEAD = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""In which order AI2-THOR looks around."""
SURFACE_POINTS, APART_M = 30, 0.005
"""So many points stand for an object's surface, or fewer where they would be nearer to each other."""


def get_reachable_positions(
    simulator: SimulatorState,
    gridSize: float | None = None,
    maxStepCount: int | None = None,
    directionsRelativeAgent: bool = False,
) -> ActionResult:
    """Where the agent can get to in whole steps from where it is, along the axes or its own heading; nearer ones come first."""
    step = simulator.settings.grid_size if gridSize is None else gridSize
    if not 0.0 < step <= 5.0:
        return ActionResult(False, f"gridSize {step:g} is not in (0, 5]")
    agent = simulator.agent
    heading = agent.yaw_deg if directionsRelativeAgent else NORTH_DEG
    most = math.floor((maxStepCount or MOST_STEPS) / step**2)
    places = _flood(agent.ground, (agent.x, agent.y), step, heading, most)
    if places is None:
        return ActionResult(False, f"more than {most} positions can be reached")
    return ActionResult(True, value=[to_thor((x, y, simulator.room.agent_y)) for x, y in places])


def get_interactable_poses(
    simulator: SimulatorState,
    objectId: str,
    positions: list[PartialVector] | None = None,
    rotations: list[float] | None = None,
    horizons: list[float] | None = None,
    standings: list[bool] | None = None,
    maxDistance: float | None = None,
    maxPoses: int | None = None,
) -> ActionResult:
    """Poses from which the agent sees an object within a distance, by default its visibility distance.

    By default the agent turns, from how it is turned now, in steps of rotateStepDegrees.
    """
    agent = simulator.agent
    if (refusal := not_there(simulator, objectId)) is not None:
        return refusal
    if maxPoses is not None and maxPoses < 1:
        return ActionResult(False, "maxPoses must be > 0.")
    if maxDistance is not None and maxDistance < 0.0:
        return ActionResult(False, "maxDistance must be >= 0 meters from the object.")
    if not all(agent.can_look(horizon - agent.horizon_deg) for horizon in horizons or ()):
        least, most = agent.embodiment.least_horizon_deg, agent.embodiment.most_horizon_deg
        return ActionResult(False, f"Each horizon must be in [{least:g}:{most:g}]. You gave {horizons}.")
    if [] in (positions, rotations, horizons, standings):
        return ActionResult(False, "Every degree of freedom must have at least 1 valid value.")
    step = simulator.settings.grid_size
    places = (
        _flood(agent.ground, (agent.x, agent.y), step, NORTH_DEG, math.floor(MOST_STEPS / step**2)) or []
        if positions is None
        else [to_room(whole(position))[:2] for position in positions]
    )
    found = []
    with agent.elsewhere():
        near = [place for place in places if _is_near(agent, objectId, place, maxDistance)]
        for horizon, standing, rotation, (x, y) in product(
            horizons or HORIZONS_DEG, standings or STANDINGS, rotations or _headings(simulator), near
        ):
            agent.place((x, y), yaw_to_room(rotation), horizon, standing)
            if agent.sees(objectId, maxDistance):
                here = to_thor((x, y, simulator.room.agent_y))
                found.append({**here, "rotation": rotation, "standing": standing, "horizon": horizon})
                if len(found) == maxPoses:
                    break
    return ActionResult(True, value=found)


def get_shortest_path(
    simulator: SimulatorState,
    objectId: str | None = None,
    objectType: str | None = None,
    position: PartialVector | None = None,
    rotation: PartialVector | None = None,
    allowedError: float | None = None,
) -> ActionResult:
    """The corners of the shortest way from a position (by default the agent's) to the place nearest to an object."""
    target = object_meant(simulator, "GetShortestPath", objectId, objectType)
    if isinstance(target, ActionResult):
        return target
    low, high = simulator.room.world.box(target)[:, :2]
    agent = simulator.agent
    return _way(simulator, position, agent.grid.position(nearest_cell(agent, low, high)))


def get_shortest_path_to_point(
    simulator: SimulatorState,
    target: PartialVector | None = None,
    position: PartialVector | None = None,
    x: float | None = None,
    y: float | None = None,
    z: float | None = None,
    allowedError: float | None = None,
) -> ActionResult:
    """The corners of the shortest way from a position to a target, a vector or x and z."""
    if target is not None:
        x, z = target.get("x"), target.get("z")
    if x is None or z is None:
        missing = "target" if x is None and z is None else "x" if x is None else "z"
        raise missing_argument("GetShortestPathToPoint", missing)
    return _way(simulator, position, to_room({"x": x, "y": 0.0, "z": z})[:2])


def get_object_in_frame(simulator: SimulatorState, x: float, y: float, checkVisible: bool = False) -> ActionResult:
    """The id of the object at a point of the frame."""
    object_id = simulator.agent.object_at(x, y, simulator.room.frame_camera())
    if object_id is None or (checkVisible and not simulator.agent.is_near(object_id)):
        return ActionResult(False, f"no object at ({x:g}, {y:g})")
    return ActionResult(True, value=object_id)


def get_visible_objects(
    simulator: SimulatorState,
    maxDistance: float | None = None,
    objectIds: list[str] | None = None,
    thirdPartyCameraIndex: int | None = None,
) -> ActionResult:
    """The ids of the objects that the agent, or a camera, sees within a distance of the agent, the nearest to the eye first.

    By default that is its visibility distance. Of some objects, if these are given.
    """
    agent, cameras = simulator.agent, simulator.cameras
    camera: AnyCamera
    distance = simulator.settings.visibility_distance if maxDistance is None else maxDistance
    if thirdPartyCameraIndex is None:
        camera, seen = agent.camera(), agent.visible_objects(distance)
    elif 0 <= thirdPartyCameraIndex < len(cameras):
        camera = cameras[thirdPartyCameraIndex].camera(simulator.frame)
        shown = simulator.room.view.instances(camera, simulator.room.shown_to(camera))
        seen = [name for name in agent.seen_in(shown) if agent.plan_distance(name) <= distance]
    else:
        return ActionResult(False, f"there is no third party camera {thirdPartyCameraIndex}: {len(cameras)} were added")
    wanted = [name for name in seen if objectIds is None or name in objectIds]
    eye = camera.view().eye
    wanted.sort(key=lambda name: math.dist(eye, simulator.room.records.position(name)))
    return ActionResult(True, value=wanted)


def object_type_to_object_ids(simulator: SimulatorState, objectType: str) -> ActionResult:
    """The ids of all objects of a type that are in the scene."""
    return ActionResult(True, value=of_type(simulator, object_type(objectType).name))


def distance_to_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Metres in plan from the agent's middle to the nearest point of an object."""
    return not_there(simulator, objectId) or ActionResult(True, value=simulator.agent.plan_distance(objectId))


def get_object_metadata(simulator: SimulatorState, objectIds: list[str] | None = None) -> ActionResult:
    """What the metadata say of objects, whatever SetObjectFilter has chosen, in the order in which they are named.

    By default of all; what is not in the scene is left out.
    """
    names = simulator.room.world.ids if objectIds is None else objectIds
    found = {record["objectId"]: record for record in object_records(simulator, frozenset(names))}
    return ActionResult(True, value=[found[name] for name in names if name in found])


def get_visibility_points(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Some points of an object's surface, as far apart as can be; which of them are seen is not asked."""
    if (refusal := not_there(simulator, objectId)) is not None:
        return refusal
    points = _spread(_vertices(simulator, objectId), SURFACE_POINTS)
    return ActionResult(True, value=[to_thor(point) for point in points])


def get_2d_semantic_hulls(
    simulator: SimulatorState, objectIds: list[str] | None = None, objectTypes: list[str] | None = None
) -> ActionResult:
    """The convex hulls of objects as seen from above, by their ids, each a list of x and z; by default of all."""
    if objectIds is not None and objectTypes is not None:
        return ActionResult(False, "Either objectIds or objectTypes should be null.")
    world = simulator.room.world
    names = world.there if objectIds is None else objectIds
    for name in names:
        if (refusal := not_there(simulator, name)) is not None:
            return refusal
    wanted = None if objectTypes is None else {object_type(name).name for name in objectTypes}
    chosen = [name for name in names if wanted is None or world.type_of(name) in wanted]
    return ActionResult(True, value={name: _hull(simulator, name) for name in chosen})


def get_2d_semantic_hull(simulator: SimulatorState, objectId: str) -> ActionResult:
    """The convex hull of an object as seen from above, a list of x and z."""
    return not_there(simulator, objectId) or ActionResult(True, value=_hull(simulator, objectId))


def no_path(start: Vec2, goal: Vec2) -> ActionResult:
    """That no way leads from one place to another."""
    return ActionResult(False, f"no path from ({start[0]:g}, {start[1]:g}) to ({goal[0]:g}, {goal[1]:g}) (x, z)")


ACTIONS: dict[str, ActionFunction] = {
    "DistanceToObject": distance_to_object,
    "Get2DSemanticHull": get_2d_semantic_hull,
    "Get2DSemanticHulls": get_2d_semantic_hulls,
    "GetInteractablePoses": get_interactable_poses,
    "GetObjectInFrame": get_object_in_frame,
    "GetObjectMetadata": get_object_metadata,
    "GetReachablePositions": get_reachable_positions,
    "GetShortestPath": get_shortest_path,
    "GetShortestPathToPoint": get_shortest_path_to_point,
    "GetVisibilityPoints": get_visibility_points,
    "GetVisibleObjects": get_visible_objects,
    "ObjectsVisibleFromThirdPartyCamera": get_visible_objects,
    "ObjectTypeToObjectIds": object_type_to_object_ids,
}


def _headings(simulator: SimulatorState) -> list[float]:
    """All headings to which the agent can turn step by step, degrees clockwise."""
    step = simulator.settings.rotate_step_degrees
    first = round(yaw_to_thor(simulator.agent.yaw_deg) % step)
    return [float((first + k * step) % 360.0) for k in range(max(1, round(360.0 / step)))]


def object_meant(
    simulator: SimulatorState, action: str, object_id: str | None, type_name: str | None
) -> str | ActionResult:
    """The id of the object that is named by its id or, if there is one of them, by its type; or why there is none."""
    if object_id is None:
        if type_name is None:
            raise missing_argument(action, "objectId")
        ids = of_type(simulator, object_type(type_name).name)
        if len(ids) != 1:
            return ActionResult(False, f"there are {len(ids)} objects of type {type_name}: give an objectId")
        object_id = ids[0]
    return not_there(simulator, object_id) or object_id


def nearest_cell(agent: ThorAgent, low: npt.ArrayLike, high: npt.ArrayLike) -> Cell:
    """The reachable cell that is nearest to a box in plan, given as two (2,) corners; of several the one by its middle."""
    middle = np.add(low, high) / 2

    def distance(cell: Cell) -> tuple[float, float]:
        place = agent.grid.position(cell)
        return math.dist(place, np.clip(place, low, high)), math.dist(place, middle)

    return min(agent.grid.cells, key=distance)


def _vertices(simulator: SimulatorState, object_id: str) -> F64:
    """(n, 3) corners of an object's surfaces, metres in the room."""
    world = simulator.room.world
    return world.assets[object_id].vertices_at(world.link_poses(object_id))


def _hull(simulator: SimulatorState, object_id: str) -> list[list[float]]:
    from scipy.spatial import ConvexHull

    plan = _vertices(simulator, object_id)[:, :2]  # AI2-THOR's x and z
    hull: list[list[float]] = plan[ConvexHull(plan).vertices].tolist()
    return hull


def _spread(points: F64, count: int) -> F64:
    """At most so many of (n, 3) points, each as far from those before it as can be; the highest is the first."""
    chosen = [int(np.lexsort((points[:, 0], points[:, 1], points[:, 2]))[-1])]
    away = arithmetic.length(points - points[chosen[0]])
    while len(chosen) < count and away.max() > APART_M:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, arithmetic.length(points - points[chosen[-1]]))
    return points[chosen]


def _is_near(agent: ThorAgent, object_id: str, place: Vec2, distance_m: float | None) -> bool:
    """Whether an agent that is put to a place may be within a distance in plan of an object, however it looks from there."""
    if object_id in agent.world.held:  # it comes along
        return True
    agent.place(place, agent.yaw_deg, agent.horizon_deg, agent.is_standing)
    return agent.is_near(object_id, distance_m)


def _flood(ground: Ground, start: Vec2, step_m: float, heading_deg: float, most: int) -> list[Vec2] | None:
    """Places that whole steps lead to, as a breadth-first search finds them; None if there are more than `most`."""
    cos, sin = round(math.cos(math.radians(heading_deg)), 15), round(math.sin(math.radians(heading_deg)), 15)

    def place(cell: Cell) -> Vec2:
        right, ahead = cell[0] * step_m, cell[1] * step_m
        return start[0] + ahead * cos + right * sin, start[1] + ahead * sin - right * cos

    seen, queue = {(0, 0): None}, deque([(0, 0)])
    while queue:
        here = queue.popleft()
        for right, ahead in RIGHT_AND_AHEAD:
            there = (here[0] + right, here[1] + ahead)
            if there not in seen and ground.is_clear(place(here), place(there)):
                seen[there] = None
                queue.append(there)
        if len(seen) > most:
            return None
    return [place(cell) for cell in seen]


def _way(simulator: SimulatorState, position: PartialVector | None, goal: Vec2) -> ActionResult:
    agent = simulator.agent
    start = (agent.x, agent.y) if position is None else to_room(whole(position))[:2]
    direct = agent.ground.is_clear(start, goal) and agent.ground.is_clear(goal, start)
    way = [start, goal] if direct else agent.ground.straight_ways().shortest(start, goal)
    if way is None:
        return no_path(start, goal)
    floor_z = agent.world.scene.floor_z
    corners: list[Vector] = [to_thor((x, y, floor_z)) for x, y in way]
    return ActionResult(True, value={"corners": corners})
