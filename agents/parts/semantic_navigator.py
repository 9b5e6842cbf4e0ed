"""Knowledge-prior navigation: to where the target is on the semantic map, by the shortest way over its free cells.

After Sima, Tan and Liu (arXiv:2210.02709): the label that the question names is looked up in the map of the walk, the
instance is chosen by the scene graph, and Floyd and Warshall's algorithm gives the shortest ways between all free cells.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import replace

import networkx as nx
import numpy as np
from scipy.sparse.csgraph import shortest_path

from remqa_data.agents.knowledge.inside import Inside, looks_inside
from remqa_data.agents.knowledge.instance import Instance, choose_instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.outlook import Outlook, frontality, is_in_the_way, outlooks, points_of
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.knowledge.sight import seen_of
from remqa_data.agents.parts.interfaces import Percept
from remqa_data.geometry.types import F64, Flags
from remqa_data.sim.metadata import scaled_pixels
from remqa_data.sim.navigation.grid import Cell, ReachableGrid, nearest_cells_in_reach
from remqa_data.sim.navigation.paths import MOVE_AHEAD, cell_ahead, shortest_actions
from remqa_data.sim.navigation.viewpoints import AgentPose

SEEN_SHARE = 0.75
"""Poses that should see this share of what the best pose should see are as good: the nearest of them is the goal."""
FEWEST_PIXELS = 150
"""Of a 300 x 300 view: where fewer show the target, the agent goes on to its next goal."""
NEAR_M = 1.0
"""From so far an object is looked at that is out of reach from everywhere."""
COMPARED = 6
"""Of the nearest goals as many are compared by their numbers of actions."""


class SemanticMapNavigator:
    """Walks to the instance that the question means."""

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> SemanticMapWalker:
        """Begin an episode; nothing is drawn."""
        instance = choose_instance(asked.target, memory)
        return SemanticMapWalker(instance, memory, opens=asked.manipulation == "Open")


class SemanticMapWalker:
    """Walks in one episode; see `SemanticMapNavigator`.

    Where a step is refused the map is wrong: the walker forgets that edge and plans again. Where the walk ends and the target
    is not in sight, it goes on to the next best pose.
    """

    def __init__(self, instance: Instance | None, memory: WalkMemory, *, opens: bool) -> None:
        self.instance, self.memory, self.opens = instance, memory, opens
        self._graph: nx.Graph[Cell] | None = None
        self._waiting: list[Outlook] = []
        self._plan: deque[str] = deque()
        self._last: tuple[str, AgentPose] | None = None
        self._inside = Inside.of(instance) if instance else None
        self._is_looking_inside = False

    def next_action(self, percept: Percept) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Walker`."""
        if self.instance is None:
            return None
        if self._graph is None:
            self._graph = free_cells(self.memory, percept.pose.cell)
            self._waiting = goals(self.instance, self.memory, self._grid(), opens=self.opens)
            self._plan_from(percept.pose)
        elif self._last is not None and not percept.succeeded:
            self._forget(*self._last)
            self._plan_from(percept.pose)
        while not self._plan:
            if self._is_looking_inside or self._is_in_sight(percept) or not self._waiting:
                return None
            self._waiting = [outlook for outlook in self._waiting if outlook.pose != percept.pose]
            self._plan_from(percept.pose)
        action = self._plan.popleft()
        self._last = action, percept.pose
        return action

    def leave(self, percept: Percept) -> None:
        """See `remqa_data.agents.parts.interfaces.Persistent`: it goes on to the best pose in another cell."""
        self._waiting = [goal for goal in self._waiting if goal.pose.cell != percept.pose.cell]
        self._last = None
        if self._graph is not None:
            self._plan_from(percept.pose)

    def look_inside(self, percept: Percept) -> None:
        """See `remqa_data.agents.parts.interfaces.Inspecting`: it goes on to where it has not yet looked in from."""
        self._last = None
        if self.instance is None or self._graph is None:
            return
        if not self._is_looking_inside:
            self._is_looking_inside = True
            self._waiting = inside_goals(self._inside, self.instance, self.memory, self._grid()) if self._inside else []
        self._waiting = [goal for goal in self._waiting if goal.pose.cell != percept.pose.cell]
        self._plan_from(percept.pose)

    def inside_of(self, percept: Percept) -> Flags:
        """See `remqa_data.agents.parts.interfaces.Inspecting`."""
        if self._inside is None:
            return np.zeros(percept.depth.shape, dtype=np.bool_)
        return self._inside.seen(percept.depth, percept.camera)

    def _grid(self) -> ReachableGrid:
        assert self._graph is not None, "the walk has begun"
        return ReachableGrid(tuple(sorted(self._graph)), self._graph, (), self.memory.plan.floor_z, self.memory.body)

    def _forget(self, action: str, pose: AgentPose) -> None:
        assert self._graph is not None, "the walk has begun"
        ahead = cell_ahead(pose.cell, pose.yaw_deg)
        if action == MOVE_AHEAD and self._graph.has_edge(pose.cell, ahead):
            self._graph.remove_edge(pose.cell, ahead)

    def _plan_from(self, pose: AgentPose) -> None:
        """Plan the way to the best of the goals that are left and can be reached."""
        self._plan.clear()
        grid = self._grid()
        steps = dict(zip(grid.cells, floyd_warshall(grid)[grid.cells.index(pose.cell)].tolist(), strict=True))
        self._waiting = [goal for goal in self._waiting if np.isfinite(steps.get(goal.pose.cell, np.inf))]
        if not self._waiting:
            return
        best = max(goal.share for goal in self._waiting)
        good = [goal for goal in self._waiting if goal.share >= SEEN_SHARE * best]
        nearest = sorted(good, key=lambda goal: (steps[goal.pose.cell], -goal.share, goal.pose))[:COMPARED]
        ways = [shortest_actions(grid, pose, goal.pose) for goal in nearest]
        order = [(steps[goal.pose.cell], len(way)) for goal, way in zip(nearest, ways, strict=True)]
        self._plan.extend(ways[order.index(min(order))])

    def _is_in_sight(self, percept: Percept) -> bool:
        assert self.instance is not None, "there is something to see"
        seen = seen_of(self.instance, percept.depth, percept.camera)
        return int(np.count_nonzero(seen)) >= scaled_pixels(FEWEST_PIXELS, seen.shape)


def goals(instance: Instance, memory: WalkMemory, grid: ReachableGrid, *, opens: bool) -> list[Outlook]:
    """Poses that should see an object and reach it; where there are none, poses near to it.

    What is to be opened is looked at from before its front, where the agent is not in its way; and the shares of the outlooks
    are less for who stands aside, who sees less of the inside.
    """
    points = points_of(instance, memory)
    reach = nearest_cells_in_reach(grid, points, memory.body.reach_m)
    near = nearest_cells_in_reach(grid, points, memory.body.reach_m + NEAR_M)
    front = {cell: frontality(instance, grid.position(cell)) if opens else 1.0 for cell in near}
    before = [cell for cell in reach if front[cell]]
    clear = [
        cell for cell in before if not (opens and is_in_the_way(instance, grid.position(cell), memory.body.radius_m))
    ]
    for cells in (clear, before, reach, near):
        found = [outlook for outlook in outlooks(instance, memory, grid, cells) if outlook.share > 0]
        if found:
            return [replace(one, share=one.share * (front[one.pose.cell] or 1.0)) for one in found]
    return []


def inside_goals(inside: Inside, instance: Instance, memory: WalkMemory, grid: ReachableGrid) -> list[Outlook]:
    """Poses before the front of an open object, out of its reach too, that should see something of its inside."""
    near = nearest_cells_in_reach(grid, inside.points, memory.body.reach_m + NEAR_M)
    before = [cell for cell in near if frontality(instance, grid.position(cell))]
    return [look for look in looks_inside(inside, instance, memory, grid, before) if look.share > 0]


def free_cells(memory: WalkMemory, start: Cell) -> nx.Graph[Cell]:
    """The cells on which the agent can stand by its map, joined where a step is free, with the one where it stands.

    If that one is not free by the map, the map is wrong there: all steps between it and the nearest free cell are tried.
    """
    graph: nx.Graph[Cell] = nx.Graph(memory.plan.navigation_grid(near=start).graph)
    if start not in graph:
        known = list(graph)
        graph.add_node(start)
        if known:
            nearest = min(known, key=lambda cell: (abs(cell[0] - start[0]) + abs(cell[1] - start[1]), cell))
            graph.add_edges_from(_steps_between(start, nearest))
    return graph


def floyd_warshall(grid: ReachableGrid) -> F64:
    """(n, n) steps between all pairs of cells of a grid, inf where there is no way."""
    edges = nx.to_scipy_sparse_array(grid.graph, nodelist=grid.cells, format="csr")
    return np.asarray(shortest_path(edges, method="FW", directed=False, unweighted=True))


def _steps_between(a: Cell, b: Cell) -> Iterable[tuple[Cell, Cell]]:
    """All steps in the rectangle between two cells."""
    columns = range(min(a[0], b[0]), max(a[0], b[0]) + 1)
    rows = range(min(a[1], b[1]), max(a[1], b[1]) + 1)
    for i in columns:
        for j in rows:
            if i + 1 in columns:
                yield (i, j), (i + 1, j)
            if j + 1 in rows:
                yield (i, j), (i, j + 1)
