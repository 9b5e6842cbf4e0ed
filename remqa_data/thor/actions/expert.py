"""What somebody who knows the room would do next on the way to an object or a place."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count
from typing import NamedTuple
from weakref import WeakKeyDictionary

import networkx as nx
import numpy as np

from remqa_data.geometry.types import Vec2
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.ground import Ground
from remqa_data.sim.navigation.straight_ways import SAME_PLACE_M
from remqa_data.thor.actions.search import nearest_cell, no_path, object_meant
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.frames import PartialVector, to_room, whole
from remqa_data.thor.state.simulator import SimulatorState

CELLS_TRIED = 12
"""Of the cells that are nearest to a place as many are tried: from one of them the way goes on."""
MOST_PLACES = 500
"""So many places are looked at on the way; where the goal is not among them, the agent goes to the nearest to it."""
SAME_SHARE = 0.2
"""Places nearer to each other than this share of a step are one on a way."""
MOST_REMEMBERED = 50_000
"""Of an agent in one state of the room about so many steps, and so many places before goals, are remembered."""
LEAST_GAIN_M = 0.01
"""Where no way leads nearer by more than this, the agent is as near as it gets."""
STRAIGHT = math.sqrt(0.5)
"""The straight way is at least so many times as long as the one over the grid."""
FEW_HEADINGS = 8
"""Of so few headings each counts on its own at a place, so that turns are fewest; with more of them that takes too long."""
TURN_M = 0.001
"""What a turn counts for: of ways with as many steps the one with fewer turns is taken."""


def object_nav_expert_action(
    simulator: SimulatorState,
    objectId: str | None = None,
    objectType: str | None = None,
    position: PartialVector | None = None,
) -> ActionResult:
    """The name of the next action on the way to an object, which is seen in the end, or to a position; None there.

    Steps are as long, and turns as wide, as Initialize has set. Where no step leads nearer, it fails if the agent is
    farther than a step from the place, and does not see the object.
    """
    agent = simulator.agent
    if position is not None:
        x, y, _ = to_room(whole(position))
        step, is_there = _step_towards(simulator, nearest_cell(agent, (x, y), (x, y)))
        return ActionResult(True, value=step) if step or is_there else no_path((agent.x, agent.y), (x, y))
    target = object_meant(simulator, "ObjectNavExpertAction", objectId, objectType)
    if isinstance(target, ActionResult):
        return target
    low, high = agent.world.box(target)[:, :2]
    step, is_there = _step_towards(simulator, nearest_cell(agent, low, high))
    if step is None and (is_there or agent.is_near(target)):
        step = _turn_towards(agent, target)
    if step or is_there or agent.sees(target):
        return ActionResult(True, value=step)
    return no_path((agent.x, agent.y), tuple(((low + high) / 2).tolist()))


ACTIONS: dict[str, ActionFunction] = {"ObjectNavExpertAction": object_nav_expert_action}


_Stop = tuple[Cell, int]
"""A spot, and the heading there if there are few."""


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
    place: Vec2
    left_m: float
    gone_m: float
    heading: int
    first_turns: int | None


@dataclass
class _Known:
    """What the searches in one state of the room have found out.

    Attributes
    ----------
    others : tuple of bytes
        Where the other agents were, and what of their arms was held out.
    can_walk : dict
        Whether the agent can walk from a place to another, by both; see `_exact`.
    ways : dict
        To each goal that was asked for.
    metres_left : dict
        From a place to a goal, by both.
    """

    others: tuple[bytes, ...] = ()
    can_walk: dict[tuple[Cell, Cell], bool] = field(default_factory=dict)
    ways: dict[Cell, _WaysTo] = field(default_factory=dict)
    metres_left: dict[tuple[Cell, Cell], float] = field(default_factory=dict)


_KNOWN: WeakKeyDictionary[nx.Graph[Cell], _Known] = WeakKeyDictionary()
"""By the graphs of the agents' grids: each is another one when something has moved."""


def _step_towards(simulator: SimulatorState, goal: Cell) -> tuple[str | None, bool]:
    """The first action on the way with the fewest steps to within half a step of the goal, or as near as steps lead.

    None if no step leads nearer; and whether the goal is no farther than a step away, which whole steps cannot better.
    """
    agent, step_m, turn_deg = simulator.agent, simulator.settings.grid_size, simulator.settings.rotate_step_degrees
    known, numbers, start = _known(simulator), count(), (agent.x, agent.y)
    nearest = _Reached(0.0, next(numbers), start, _metres_left(known, agent, start, goal), 0.0, 0, None)
    queue, seen, least_gone = [nearest], set[_Stop](), dict[_Stop, float]()
    turns_to = _turns(turn_deg)
    around = len(turns_to) if len(turns_to) <= FEW_HEADINGS else 1
    while queue and len(seen) < MOST_PLACES * around:
        here = heappop(queue)
        stop = _spot(here.place, step_m), here.heading % around
        if stop in seen:
            continue
        seen.add(stop)
        if here.left_m < nearest.left_m - LEAST_GAIN_M:
            nearest = here
        if here.left_m <= step_m / 2:
            break
        for turns in turns_to:
            heading, gone = here.heading + turns, here.gone_m + step_m + TURN_M * abs(turns)
            angle = math.radians(agent.yaw_deg - heading * turn_deg)
            there = (here.place[0] + step_m * math.cos(angle), here.place[1] + step_m * math.sin(angle))
            stop = _spot(there, step_m), heading % around
            if stop in seen or gone >= least_gone.get(stop, math.inf) or not _can_walk(known, agent, here.place, there):
                continue
            least_gone[stop], left = gone, _metres_left(known, agent, there, goal)
            first = heading if here.first_turns is None else here.first_turns
            heappush(queue, _Reached(gone + STRAIGHT * left, next(numbers), there, left, gone, heading, first))
    turns_first = nearest.first_turns
    if turns_first is None:
        return None, nearest.left_m <= step_m + SAME_PLACE_M
    return _rotation(turns_first) if turns_first else "MoveAhead", False


def _known(simulator: SimulatorState) -> _Known:
    """What is known of the room as it is now."""
    agent = simulator.agent
    known = _KNOWN.setdefault(agent.grid.graph, _Known())
    tall = agent.embodiment.height_m
    others = tuple(other.outline(tall).tobytes() for other in simulator.room.agents if other is not agent)
    if known.others != others or len(known.can_walk) > MOST_REMEMBERED:
        known.others, known.can_walk = others, {}
    if len(known.metres_left) > MOST_REMEMBERED:
        known.metres_left = {}
    return known


def _can_walk(known: _Known, agent: ThorAgent, start: Vec2, end: Vec2) -> bool:
    step = _exact(start), _exact(end)
    if step not in known.can_walk:
        known.can_walk[step] = agent.can_walk(start, end)
    return known.can_walk[step]


def _metres_left(known: _Known, agent: ThorAgent, place: Vec2, goal: Cell) -> float:
    asked = _exact(place), goal
    if asked not in known.metres_left:
        if goal not in known.ways:
            known.ways[goal] = _WaysTo(goal, agent.grid)
        known.metres_left[asked] = known.ways[goal].metres_from(place, agent.ground)
    return known.metres_left[asked]


def _exact(place: Vec2) -> Cell:
    """What places are remembered by; they differ by roundings only."""
    return round(place[0] / SAME_PLACE_M), round(place[1] / SAME_PLACE_M)


def _spot(place: Vec2, step_m: float) -> Cell:
    """Which places count as the same."""
    return round(place[0] / (SAME_SHARE * step_m)), round(place[1] / (SAME_SHARE * step_m))


def _turns(step_deg: float) -> list[int]:
    """How many turns to the right (or, negative, to the left) lead to each heading, the fewest first."""
    around = max(1, round(360.0 / step_deg)) if step_deg > 0 else 1
    return sorted(range(-((around - 1) // 2), around // 2 + 1), key=lambda turn: (abs(turn), -turn))


class _WaysTo:
    """How far it is to a goal: straight to a cell, then over the grid."""

    def __init__(self, goal: Cell, grid: ReachableGrid) -> None:
        steps = nx.single_source_shortest_path_length(grid.graph, goal)
        self._cells = np.array([grid.position(cell) for cell in steps])
        self._rest = np.array(list(steps.values())) * grid.body.step_m

    def metres_from(self, place: Vec2, ground: Ground) -> float:
        """Metres from a place to the goal; infinite if no cell near it can be walked to."""
        away = np.hypot(*(self._cells - place).T)
        whole_way = away + self._rest
        near = np.argsort(away, kind="stable")[:CELLS_TRIED]
        for index in near[np.argsort(whole_way[near], kind="stable")]:
            x, y = self._cells[index].tolist()
            if away[index] < SAME_PLACE_M or ground.is_clear(place, (x, y)):
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
