"""What an agent can do in a room that it has not seen: look, explore to the nearest frontier, go to what it believes in.

A frontier (Yamauchi 1997) is where the free floor that is known borders on what was never looked at.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import networkx as nx
import numpy as np
import numpy.typing as npt
from scipy import ndimage

from remqa_data.agents.knowledge.instance import Instance, choose_instance
from remqa_data.agents.knowledge.memory import Look, WalkMemory
from remqa_data.agents.knowledge.predicted_memory import RoomMap
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import Percept
from remqa_data.agents.parts.semantic_navigator import SEEN_SHARE, free_cells, goals
from remqa_data.geometry.types import F64, Flags
from remqa_data.mapping.semantic_map import SemanticPlan
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.paths import LOOK_DOWN, LOOK_UP, MOVE_AHEAD, cell_ahead, shortest_actions
from remqa_data.sim.navigation.viewpoints import AgentPose

FEWEST_COLUMNS = 6
"""Of 5 cm: what is less is no frontier."""
NEAR_M = 1.0
"""From so far a frontier is looked at."""
EXPLORING_DEG = 30
"""Who explores looks down: level eyes see the floor from 1.6 m on."""
DETECT_EVERY = 2
"""Steps ahead; after each turn the detector looks in any case."""
TURN_DEG = 90


@dataclass(frozen=True)
class Belief:
    """What the agent takes for the target.

    Attributes
    ----------
    instance : Instance
    votes : float
        How sure the detector is; see `RoomMap.votes`.
    """

    instance: Instance
    votes: float


class Explorer:
    """The map of one episode, and ways on it.

    Parameters
    ----------
    room : RoomMap
        Empty.
    asked : Question
    """

    def __init__(self, room: RoomMap, asked: Question) -> None:
        self._room, self._asked = room, asked
        self._been: list[Cell] = []
        self._looked: set[AgentPose] = set()
        self._since = 0
        self._blocked: set[tuple[Cell, Cell]] = set()
        self._given_up: set[Cell] = set()
        self._last: tuple[str, AgentPose] | None = None
        self._pose: AgentPose | None = None
        self._known: WalkMemory | None = None
        self._graph: nx.Graph[Cell] | None = None

    # ---- perceiving

    def perceive(self, percept: Percept) -> None:
        """Take in what an action has led to."""
        pose = percept.pose
        if self._last is not None and not percept.succeeded and self._last[0] == MOVE_AHEAD:
            before = self._last[1]
            self._blocked.add((before.cell, cell_ahead(before.cell, before.yaw_deg)))
        self._last, self._pose = None, pose
        self._known = self._graph = None
        if pose.cell not in self._been:
            self._been.append(pose.cell)
        if pose in self._looked:
            return
        is_ahead = any(
            pose
            == AgentPose(cell_ahead(other.cell, other.yaw_deg), other.yaw_deg, other.horizon_deg, other.is_standing)
            for other in self._looked
        )
        look = Look(percept.rgb, percept.depth, percept.camera)
        self._since = self._since + 1 if is_ahead else DETECT_EVERY
        if self._since >= DETECT_EVERY:
            self._room.add(look)
            self._since = 0
        else:
            self._room.add_shape(look)
        self._looked.add(pose)

    def act(self, action: str) -> str:
        """What is going to be done."""
        assert self._pose is not None, "who acts has perceived"
        self._last = action, self._pose
        return action

    # ---- knowing

    @property
    def pose(self) -> AgentPose:
        """Where the agent is."""
        assert self._pose is not None, "who is asked has perceived"
        return self._pose

    @property
    def memory(self) -> WalkMemory:
        """What it knows now."""
        if self._known is None:
            self._known = self._room.memory(self._been)
        return self._known

    def belief(self) -> Belief | None:
        """What it takes for the target; None if nothing."""
        instance = choose_instance(self._asked.target, self.memory)
        return None if instance is None else Belief(instance, self._room.votes(instance))

    def grid(self) -> ReachableGrid:
        """Where it can go."""
        if self._graph is None:
            self._graph = free_cells(self.memory, self.pose.cell)
            self._graph.remove_edges_from(self._blocked)
        reached = nx.node_connected_component(self._graph, self.pose.cell)
        graph: nx.Graph[Cell] = nx.Graph(self._graph.subgraph(reached))
        return ReachableGrid(tuple(sorted(graph)), graph, (), self.memory.plan.floor_z, self.memory.body)

    # ---- ways

    def to_frontier(self, towards: Instance | None = None) -> list[str]:
        """The way to the nearest frontier, looking at it; nothing where there is none.

        Parameters
        ----------
        towards : Instance, optional
            Of frontiers, those near to it are preferred.
        """
        if self.pose.horizon_deg != EXPLORING_DEG:
            return [LOOK_DOWN if self.pose.horizon_deg < EXPLORING_DEG else LOOK_UP]
        grid, plan = self.grid(), self.memory.plan
        while len(columns := frontier(plan, self._given_up)):
            places = (columns.astype(np.float64) + 0.5) * plan.voxel_m
            costs: F64 = np.zeros(len(places))
            if towards is not None:
                costs += np.linalg.norm(places - towards.centre[:2], axis=1) / grid.body.step_m
            goal, is_near = nearest_frontier(grid, self.pose, places, costs)
            if goal is None:
                break
            if way := shortest_actions(grid, self.pose, goal):
                return way
            # It stands before it and looks at it, and it is still there: nothing more can be seen of it.
            self._given_up.update((int(i), int(j)) for i, j in columns[is_near].tolist())
        return []

    def to_outlook(self, instance: Instance) -> list[str] | None:
        """The way to a pose that should see and reach an object; None where no such pose is known.

        Nothing where the agent is there.
        """
        grid = self.grid()
        found = goals(instance, self.memory, grid, opens=self._asked.manipulation == "Open")
        if not found:
            return None
        best = max(one.share for one in found)
        steps = nx.single_source_shortest_path_length(grid.graph, self.pose.cell)
        good = [one for one in found if one.share >= SEEN_SHARE * best and one.pose.cell in steps]
        nearest = sorted(good, key=lambda one: (steps[one.pose.cell], -one.share, one.pose))[:6]
        ways = [shortest_actions(grid, self.pose, one.pose) for one in nearest]
        return min(ways, key=lambda way: (sum(name == MOVE_AHEAD for name in way), len(way))) if ways else None


def frontier(plan: SemanticPlan, given_up: Collection[Cell] = ()) -> npt.NDArray[np.int64]:
    """(n, 2) columns of a plan, numbered as in the room, where free ground borders on what was never looked at.

    Those that were given up are left out, and pieces that are smaller than `FEWEST_COLUMNS`.
    """
    is_free = plan.known & ~plan.occupied
    is_border = is_free & ndimage.binary_dilation(~plan.known)
    for i, j in given_up:
        a, b = i - plan.corner[0], j - plan.corner[1]
        if 0 <= a < is_border.shape[0] and 0 <= b < is_border.shape[1]:
            is_border[a, b] = False
    pieces, count = ndimage.label(is_border, np.ones((3, 3)))
    sizes = np.bincount(pieces.ravel(), minlength=count + 1)
    sizes[0] = 0
    return np.asarray(np.argwhere(sizes[pieces] >= FEWEST_COLUMNS) + np.array(plan.corner))


def nearest_frontier(grid: ReachableGrid, pose: AgentPose, places: F64, costs: F64) -> tuple[AgentPose | None, Flags]:
    """From where to look at some frontier with the fewest actions, and which of its places are looked at from there.

    Parameters
    ----------
    grid : ReachableGrid
        Where the agent can go.
    pose : AgentPose
        Where it is.
    places : (n, 2)
        Of frontiers, metres.
    costs : (n,)
        Of each place, in actions.
    """
    steps = nx.single_source_shortest_path_length(grid.graph, pose.cell)
    cells = list(steps)
    positions = np.array([grid.position(cell) for cell in cells])
    ways = places[None] - positions[:, None]
    is_near = np.linalg.norm(ways, axis=2) <= NEAR_M
    if not is_near.any():
        return None, np.zeros(len(places), dtype=np.bool_)
    headings = np.rint(np.degrees(np.arctan2(ways[..., 1], ways[..., 0])) / TURN_DEG) * TURN_DEG % 360
    turns = np.abs((headings - pose.yaw_deg + 180) % 360 - 180) / TURN_DEG
    total = np.where(is_near, np.array(list(steps.values()))[:, None] + turns + costs[None], np.inf)
    row, column = np.unravel_index(int(total.argmin()), total.shape)
    heading = headings[row, column]
    goal = AgentPose(cells[row], int(heading), pose.horizon_deg, pose.is_standing)
    return goal, is_near[row] & (headings[row] == heading)
