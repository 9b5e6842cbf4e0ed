"""Questions about the room: where the agent can be, how it gets there, from where an object can be acted on."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from itertools import product

import networkx as nx
import numpy as np
import numpy.typing as npt

from remqa_data.catalog import object_type
from remqa_data.errors import MisuseError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64
from remqa_data.sim.agent.agent import ActionResult
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.ground import Ground
from remqa_data.thor.actions.targets import not_there, of_type
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.events import object_records
from remqa_data.thor.state.frames import PartialVector, Vector, to_room, to_thor, whole, yaw_to_room, yaw_to_thor
from remqa_data.thor.state.simulator import SimulatorState

Plan = tuple[float, float]
"""x and y in the room, metres."""

HORIZONS_DEG, STANDINGS = (-30.0, 0.0, 30.0, 60.0), (False, True)
MOST_STEPS = 10_000
SURFACE_POINTS, APART_M = 30, 0.005
"""So many points stand for an object's surface, or fewer where they would be nearer to each other."""


def get_reachable_positions(
    simulator: SimulatorState,
    gridSize: float | None = None,
    maxStepCount: int | None = None,
    directionsRelativeAgent: bool = False,
) -> ActionResult:
    """Where the agent can get to in whole steps from where it is, along the axes or along its own heading."""
    step = simulator.settings.grid_size if gridSize is None else gridSize
    if not 0.0 < step <= 5.0:
        return ActionResult(False, f"gridSize {step:g} is not in (0, 5]")
    agent = simulator.agent
    heading = agent.yaw_deg if directionsRelativeAgent else 0.0
    places = _flood(agent.ground, (agent.x, agent.y), step, heading, maxStepCount or MOST_STEPS)
    if places is None:
        return ActionResult(False, f"more than {maxStepCount or MOST_STEPS} positions can be reached")
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
    places = (
        _flood(agent.ground, (agent.x, agent.y), simulator.settings.grid_size, 0.0, MOST_STEPS) or []
        if positions is None
        else [to_room(whole(position))[:2] for position in positions]
    )
    found = []
    with agent.elsewhere():
        for horizon, standing, rotation, (x, y) in product(
            horizons or HORIZONS_DEG, standings or STANDINGS, rotations or _headings(simulator), places
        ):
            agent.place((x, y), yaw_to_room(rotation), horizon, standing)
            if agent.sees(objectId, maxDistance):
                answer = {
                    "x": x,
                    "y": simulator.room.agent_y,
                    "z": y,
                    "rotation": rotation,
                    "standing": standing,
                    "horizon": horizon,
                }
                found.append(answer)
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
        message = f"action: GetShortestPathToPoint is missing the following arguments: {missing}"
        raise MisuseError("MissingArguments", message)
    return _way(simulator, position, (x, z))


def get_object_in_frame(simulator: SimulatorState, x: float, y: float, checkVisible: bool = False) -> ActionResult:
    """The id of the object at a point of the frame."""
    object_id = simulator.agent.object_at(x, y, simulator.room.frame_camera())
    if object_id is None or (checkVisible and not simulator.agent.is_near(object_id)):
        return ActionResult(False, f"no object at ({x:g}, {y:g})")
    return ActionResult(True, value=object_id)


def get_visible_objects(simulator: SimulatorState, maxDistance: float | None = None) -> ActionResult:
    """The ids of the objects that the agent sees within a distance, by default its visibility distance."""
    distance = simulator.settings.visibility_distance if maxDistance is None else maxDistance
    return ActionResult(True, value=simulator.agent.visible_objects(distance))


def object_type_to_object_ids(simulator: SimulatorState, objectType: str) -> ActionResult:
    """The ids of all objects of a type that are in the scene."""
    return ActionResult(True, value=of_type(simulator, object_type(objectType).name))


def distance_to_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Metres in plan from the agent's middle to the nearest point of an object."""
    return not_there(simulator, objectId) or ActionResult(True, value=simulator.agent.plan_distance(objectId))


def get_object_metadata(simulator: SimulatorState, objectIds: list[str]) -> ActionResult:
    """What the metadata say of some objects, whatever SetObjectFilter has chosen, in the order in which they are named."""
    if not objectIds:
        return ActionResult(False, "objectIds must not be empty")
    for object_id in objectIds:
        simulator.room.world.type_of(object_id)  # names the nearest ids if there is no such object
    found = {record["objectId"]: record for record in object_records(simulator, frozenset(objectIds))}
    missing = next((object_id for object_id in objectIds if object_id not in found), None)
    if missing is not None:
        return ActionResult(False, f"{missing} is not in the scene")
    return ActionResult(True, value=[found[object_id] for object_id in objectIds])


def get_visibility_points(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Some points of an object's surface, as far apart as can be; which of them are seen is not asked."""
    if (refusal := not_there(simulator, objectId)) is not None:
        return refusal
    world = simulator.room.world
    links = zip(world.link_poses(objectId), world.assets[objectId].links, strict=True)
    corners = [arithmetic.moved(surface.vertices, pose) for pose, link in links for surface in link.surfaces]
    return ActionResult(True, value=[to_thor(point) for point in _spread(np.concatenate(corners), SURFACE_POINTS)])


ACTIONS: dict[str, Action] = {
    "DistanceToObject": distance_to_object,
    "GetInteractablePoses": get_interactable_poses,
    "GetObjectInFrame": get_object_in_frame,
    "GetObjectMetadata": get_object_metadata,
    "GetReachablePositions": get_reachable_positions,
    "GetShortestPath": get_shortest_path,
    "GetShortestPathToPoint": get_shortest_path_to_point,
    "GetVisibilityPoints": get_visibility_points,
    "GetVisibleObjects": get_visible_objects,
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
            raise MisuseError("MissingArguments", f"action: {action} is missing the following arguments: objectId")
        ids = of_type(simulator, type_name)
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


def _spread(points: F64, count: int) -> F64:
    """At most so many of (n, 3) points, each as far from those before it as can be; the highest is the first."""
    chosen = [int(np.lexsort((points[:, 0], points[:, 1], points[:, 2]))[-1])]
    away = arithmetic.length(points - points[chosen[0]])
    while len(chosen) < count and away.max() > APART_M:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, arithmetic.length(points - points[chosen[-1]]))
    return points[chosen]


def _flood(ground: Ground, start: Plan, step_m: float, heading_deg: float, most: int) -> list[Plan] | None:
    """Places that whole steps lead to, sorted by the steps; None if there are more than `most`."""
    cos, sin = round(math.cos(math.radians(heading_deg)), 15), round(math.sin(math.radians(heading_deg)), 15)

    def place(cell: Cell) -> Plan:
        ahead, left = cell[0] * step_m, cell[1] * step_m
        return start[0] + ahead * cos - left * sin, start[1] + ahead * sin + left * cos

    seen, queue = {(0, 0)}, deque([(0, 0)])
    while queue:
        here = queue.popleft()
        for there in _neighbours(here):
            if there not in seen and ground.is_clear(place(here), place(there)):
                seen.add(there)
                queue.append(there)
        if len(seen) > most:
            return None
    return [place(cell) for cell in sorted(seen)]


def _neighbours(cell: Cell) -> Iterator[Cell]:
    for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        yield cell[0] + step[0], cell[1] + step[1]


def _way(simulator: SimulatorState, position: PartialVector | None, goal: Plan) -> ActionResult:
    agent = simulator.agent
    start = (agent.x, agent.y) if position is None else to_room(whole(position))[:2]
    way = _shortest_way(agent, start, goal)
    if way is None:
        return ActionResult(False, f"no path from ({start[0]:g}, {start[1]:g}) to ({goal[0]:g}, {goal[1]:g}) (x, z)")
    floor_z = agent.world.scene.floor_z
    corners: list[Vector] = [to_thor((x, y, floor_z)) for x, y in way]
    return ActionResult(True, value={"corners": corners})


def _shortest_way(agent: ThorAgent, start: Plan, goal: Plan) -> list[Plan] | None:
    """The shortest way over the grid with its corners pulled tight, or None."""
    first, last = _cell_near(agent, start), _cell_near(agent, goal)
    if first is None or last is None:
        return None
    cells = nx.shortest_path(agent.grid.graph, first, last)
    places = [start, *(agent.grid.position(cell) for cell in cells), goal]
    way, here = [start], 0
    while here < len(places) - 1:
        ahead = range(here + 1, len(places))
        here = max((k for k in ahead if agent.ground.is_clear(places[here], places[k])), default=here + 1)
        way.append(places[here])
    return way


def _cell_near(agent: ThorAgent, place: Plan) -> Cell | None:
    """The nearest cell of the grid that can be walked to straight from a place."""
    grid: ReachableGrid = agent.grid
    near = sorted((math.dist(grid.position(cell), place), cell) for cell in grid.cells)
    for distance, cell in near[:8]:
        if distance < 1e-9 or agent.ground.is_clear(place, grid.position(cell)):
            return cell
    return None
