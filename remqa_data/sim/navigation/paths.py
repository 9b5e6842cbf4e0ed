"""The shortest ways over the grid, in the agent's own actions.

AI2-THOR's navigation actions: MoveAhead goes 0.25 m along the heading, RotateLeft and RotateRight turn by 90 degrees,
LookUp and LookDown tilt the camera by 30 degrees between 30 degrees up and 60 degrees down. Yaw is counter-clockwise
from +x, so that RotateLeft adds 90 degrees; horizon is positive downwards, so that LookDown adds 30 degrees. Crouch and
Stand change the posture; the agent walks and turns in either.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import accumulate

import networkx as nx

from remqa_data.errors import ActionError, NoPathError
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose

MOVE_AHEAD = "MoveAhead"
ROTATE_LEFT, ROTATE_RIGHT = "RotateLeft", "RotateRight"
LOOK_UP, LOOK_DOWN = "LookUp", "LookDown"
CROUCH, STAND = "Crouch", "Stand"
ROTATE_DEG = 90
LOOK_DEG = 30
LEAST_HORIZON_DEG, MOST_HORIZON_DEG = -30, 60


def shortest_actions(grid: ReachableGrid, start: AgentPose, goal: AgentPose) -> list[str]:
    """The shortest way that takes the agent from one pose to another.

    Of ways of equally many metres, the one with the fewest actions; posture and camera come last. Headings and horizons
    must differ by whole steps of 90 and 30 degrees; a horizon that the camera cannot reach is clamped to -30 or 60
    degrees first.

    Raises
    ------
    NoPathError
        If a pose is not on the grid, or a heading or horizon cannot be reached in whole steps.

    Notes
    -----
    Dijkstra's algorithm over (cell, heading), with the cost (cells walked, actions) compared in this order: SPL counts
    metres, and a way with fewer turns can be longer.
    """
    start, goal = _reachable(grid, start), _reachable(grid, goal)
    for name, step in (("yaw_deg", ROTATE_DEG), ("horizon_deg", LOOK_DEG)):
        if (getattr(goal, name) - getattr(start, name)) % step:
            msg = f"no way from {start} to {goal}: their {name} differ by no multiple of {step} degrees"
            raise NoPathError(msg)
    looks = (goal.horizon_deg - start.horizon_deg) // LOOK_DEG
    tilt = [LOOK_DOWN] * looks if looks > 0 else [LOOK_UP] * -looks
    posture = [] if start.is_standing == goal.is_standing else [STAND if goal.is_standing else CROUCH]
    return _walk_and_turn(grid, start, goal) + posture + tilt


def path_length_m(grid: ReachableGrid, start: Cell, goal: Cell) -> float:
    """Metres of the shortest way from one cell to another.

    Raises
    ------
    NoPathError
        If a cell is not in the grid.
    """
    _check_reachable(grid, start)
    _check_reachable(grid, goal)
    return grid.body.step_m * int(nx.shortest_path_length(grid.graph, start, goal))


def pose_after(grid: ReachableGrid, pose: AgentPose, action: str) -> AgentPose:
    """The pose to which a navigation action leads.

    Raises
    ------
    ActionError
        If something is in the way, the camera tilts no farther, the agent has that posture already, or the action is
        not a navigation action.
    """
    if action == MOVE_AHEAD:
        ahead = cell_ahead(pose.cell, pose.yaw_deg)
        if not grid.graph.has_edge(pose.cell, ahead):
            raise ActionError(f"{MOVE_AHEAD} from {pose}: something is in the way to {ahead}")
        return replace(pose, cell=ahead)
    if action in (ROTATE_LEFT, ROTATE_RIGHT):
        return replace(pose, yaw_deg=_turned(pose.yaw_deg, action))
    if action in (LOOK_UP, LOOK_DOWN):
        horizon = pose.horizon_deg + (LOOK_DEG if action == LOOK_DOWN else -LOOK_DEG)
        if not LEAST_HORIZON_DEG <= horizon <= MOST_HORIZON_DEG:
            raise ActionError(f"{action} from {pose}: the camera tilts from {LEAST_HORIZON_DEG} to {MOST_HORIZON_DEG}")
        return replace(pose, horizon_deg=horizon)
    if action in (CROUCH, STAND):
        if pose.is_standing == (action == STAND):
            raise ActionError(f"{action} from {pose}: the agent does so already")
        return replace(pose, is_standing=action == STAND)
    raise ActionError(f"{action!r} is not a navigation action")


def poses_along(grid: ReachableGrid, start: AgentPose, actions: Iterable[str]) -> list[AgentPose]:
    """The poses that navigation actions lead through, the start first; raises what `pose_after` does."""
    return list(accumulate(actions, lambda pose, action: pose_after(grid, pose, action), initial=start))


def _reachable(grid: ReachableGrid, pose: AgentPose) -> AgentPose:
    _check_reachable(grid, pose.cell)
    if pose.yaw_deg % ROTATE_DEG:
        raise NoPathError(f"{pose} does not face along the grid: yaw_deg is no multiple of {ROTATE_DEG}")
    horizon = min(max(pose.horizon_deg, LEAST_HORIZON_DEG), MOST_HORIZON_DEG)
    return replace(pose, yaw_deg=pose.yaw_deg % 360, horizon_deg=horizon)


def _check_reachable(grid: ReachableGrid, cell: Cell) -> None:
    if cell not in grid.graph:
        raise NoPathError(f"{cell} is not among the {len(grid.cells)} reachable cells of the grid")


_Standing = tuple[Cell, int]
"""Where the agent stands and which way it faces, in degrees."""


def _walk_and_turn(grid: ReachableGrid, start: AgentPose, goal: AgentPose) -> list[str]:
    first, last = (start.cell, start.yaw_deg), (goal.cell, goal.yaw_deg)
    best: dict[_Standing, tuple[int, int]] = {first: (0, 0)}
    came_by: dict[_Standing, tuple[_Standing, str]] = {}
    queue = [((0, 0), first)]
    while queue:
        cost, here = heapq.heappop(queue)
        if here == last:
            return _retrace(came_by, last)
        if cost > best[here]:
            continue
        for action, there in _options(grid, here):
            reached = (cost[0] + (action == MOVE_AHEAD), cost[1] + 1)
            if there not in best or reached < best[there]:
                best[there] = reached
                came_by[there] = (here, action)
                heapq.heappush(queue, (reached, there))
    raise NoPathError(f"no way from {start} to {goal}: the grid is in several parts")


def _options(grid: ReachableGrid, here: _Standing) -> Iterator[tuple[str, _Standing]]:
    cell, yaw = here
    ahead = cell_ahead(cell, yaw)
    if ahead in grid.graph.adj[cell]:
        yield MOVE_AHEAD, (ahead, yaw)
    yield ROTATE_LEFT, (cell, _turned(yaw, ROTATE_LEFT))
    yield ROTATE_RIGHT, (cell, _turned(yaw, ROTATE_RIGHT))


def _retrace(came_by: dict[_Standing, tuple[_Standing, str]], last: _Standing) -> list[str]:
    actions = []
    while last in came_by:
        last, action = came_by[last]
        actions.append(action)
    return actions[::-1]


def _turned(yaw_deg: int, action: str) -> int:
    return (yaw_deg + (ROTATE_DEG if action == ROTATE_LEFT else -ROTATE_DEG)) % 360


def cell_ahead(cell: Cell, yaw_deg: int) -> Cell:
    """The cell to which MoveAhead leads.

    Raises
    ------
    ActionError
        If the heading is none along the grid.
    """
    if yaw_deg % 360 not in _AHEAD:
        raise ActionError(f"{MOVE_AHEAD} needs a yaw that is a multiple of {ROTATE_DEG} degrees, not {yaw_deg}")
    dx, dy = _AHEAD[yaw_deg % 360]
    return cell[0] + dx, cell[1] + dy


_AHEAD = {0: (1, 0), 90: (0, 1), 180: (-1, 0), 270: (0, -1)}
