"""What somebody who knows the room would do next on the way to an object or a place."""

from __future__ import annotations

import math
from heapq import heappop, heappush
from itertools import count
from typing import NamedTuple

import networkx as nx
import numpy as np

from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.grid import Cell
from remqa_data.thor.actions.search import Plan, nearest_cell, object_meant
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.dispatch import Action
from remqa_data.thor.state.frames import PartialVector, to_room, whole
from remqa_data.thor.state.simulator import SimulatorState

CELLS_TRIED = 12
"""Of the cells that are nearest to a place as many are tried: from one of them the way goes on."""
MOST_PLACES = 500
"""So many places are looked at on the way; where the goal is not among them, the agent goes to the nearest to it."""
SAME_SHARE, SAME_PLACE_M = 0.2, 1e-6
"""Places nearer to each other than this share of a step are one on a way; a place so near to a cell is that cell."""
LEAST_GAIN_M = 0.01
"""Where no way leads nearer by more than this, the agent is there."""
STRAIGHT = math.sqrt(0.5)
"""The straight way is at least so many times as long as the one over the grid."""
TURN_M = 0.001
"""What a turn counts for: of ways with as many steps the one with fewer turns is taken."""


def object_nav_expert_action(
    simulator: SimulatorState,
    objectId: str | None = None,
    objectType: str | None = None,
    position: PartialVector | None = None,
) -> ActionResult:
    """The name of the next action on the way to an object, which is seen in the end, or to a position; None there.

    Steps are as long, and turns as wide, as Initialize has set.
    """
    agent = simulator.agent
    if position is not None:
        x, y, _ = to_room(whole(position))
        return ActionResult(True, value=_step_towards(simulator, nearest_cell(agent, (x, y), (x, y))))
    target = object_meant(simulator, "ObjectNavExpertAction", objectId, objectType)
    if isinstance(target, ActionResult):
        return target
    low, high = agent.world.box(target)[:, :2]
    step = _step_towards(simulator, nearest_cell(agent, low, high))
    return ActionResult(True, value=step or _turn_towards(agent, target))


ACTIONS: dict[str, Action] = {"ObjectNavExpertAction": object_nav_expert_action}


class _Reached(NamedTuple):
    """A place on a way, as A* orders them.

    Attributes
    ----------
    whole_m : float
        At least so far it is from the start over this place to the goal.
    number : int
        The first one comes first.
    place : (float, float)
    left_m : float
        From here to the goal, over the grid.
    gone_m : float
        From the start to here.
    heading : int
        How many turns to the right of the start's.
    first_turns : int or None
        How many turns come before the first step; None at the start.
    """

    whole_m: float
    number: int
    place: Plan
    left_m: float
    gone_m: float
    heading: int
    first_turns: int | None


def _step_towards(simulator: SimulatorState, goal: Cell) -> str | None:
    """The first action on the way with the fewest steps to within half a step of the goal, or as near as steps lead."""
    agent, step_m, turn_deg = simulator.agent, simulator.settings.grid_size, simulator.settings.rotate_step_degrees
    metres_left, numbers, start = _MetresLeft(agent, goal), count(), (agent.x, agent.y)
    nearest = _Reached(0.0, next(numbers), start, metres_left(start), 0.0, 0, None)
    queue, seen = [nearest], set[Cell]()
    while queue and len(seen) < MOST_PLACES:
        here = heappop(queue)
        spot = _spot(here.place, step_m)
        if spot in seen:
            continue
        seen.add(spot)
        if here.left_m < nearest.left_m - LEAST_GAIN_M:
            nearest = here
        if here.left_m <= step_m / 2:
            break
        for turns in _turns(turn_deg):
            heading = here.heading + turns
            angle = math.radians(agent.yaw_deg - heading * turn_deg)
            there = (here.place[0] + step_m * math.cos(angle), here.place[1] + step_m * math.sin(angle))
            if _spot(there, step_m) not in seen and agent.can_walk(here.place, there):
                left, gone = metres_left(there), here.gone_m + step_m + TURN_M * abs(turns)
                first = heading if here.first_turns is None else here.first_turns
                heappush(queue, _Reached(gone + STRAIGHT * left, next(numbers), there, left, gone, heading, first))
    turns_first = nearest.first_turns
    if turns_first is None:
        return None
    return _rotation(turns_first) if turns_first else "MoveAhead"


def _spot(place: Plan, step_m: float) -> Cell:
    """Which places count as the same."""
    return round(place[0] / (SAME_SHARE * step_m)), round(place[1] / (SAME_SHARE * step_m))


def _turns(step_deg: float) -> list[int]:
    """How many turns to the right (or, negative, to the left) lead to each heading, the fewest first."""
    around = max(1, round(360.0 / step_deg)) if step_deg > 0 else 1
    return sorted(range(-((around - 1) // 2), around // 2 + 1), key=lambda turn: (abs(turn), -turn))


class _MetresLeft:
    """How far it is from a place to a goal: straight to a cell, then over the grid."""

    def __init__(self, agent: ThorAgent, goal: Cell) -> None:
        self._agent, grid = agent, agent.grid
        steps = nx.single_source_shortest_path_length(grid.graph, goal)
        self._cells = np.array([grid.position(cell) for cell in steps])
        self._rest = np.array(list(steps.values())) * grid.body.step_m

    def __call__(self, place: Plan) -> float:
        away = np.hypot(*(self._cells - place).T)
        whole_way = away + self._rest
        near = np.argsort(away, kind="stable")[:CELLS_TRIED]
        for index in near[np.argsort(whole_way[near], kind="stable")]:
            x, y = self._cells[index].tolist()
            if away[index] < SAME_PLACE_M or self._agent.ground.is_clear(place, (x, y)):
                return float(whole_way[index])
        return math.inf


def _turn_towards(agent: ThorAgent, target: str) -> str | None:
    """Turn, then tilt the camera, towards an object; None once it is seen, or the camera can come no nearer to it."""
    if agent.sees(target):
        return None
    camera = agent.camera()
    x, y, z = (agent.world.box(target).mean(axis=0) - camera.position).tolist()
    turn = _nearest_turn(agent.yaw_deg - math.degrees(math.atan2(y, x)), agent.embodiment.rotate_deg)
    if turn:
        return _rotation(turn)
    down = math.degrees(math.atan2(-z, math.hypot(x, y))) - agent.horizon_deg
    tilt = round(down / agent.embodiment.look_deg)
    if tilt and agent.can_look(math.copysign(agent.embodiment.look_deg, tilt)):
        return "LookDown" if tilt > 0 else "LookUp"
    return None


def _nearest_turn(clockwise_deg: float, step_deg: float) -> int:
    """How many turns to the right come nearest to an angle."""
    return round(((clockwise_deg + 180.0) % 360.0 - 180.0) / step_deg) if step_deg > 0 else 0


def _rotation(turn: int) -> str:
    return "RotateRight" if turn > 0 else "RotateLeft"
