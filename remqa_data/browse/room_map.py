"""A room from above as coordinates for a drawing: metres to the right and down from the map's upper left corner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import networkx as nx

from remqa_data.browse.dataset import Arrangement
from remqa_data.errors import RemqaError
from remqa_data.geometry.types import Box, Vec2
from remqa_data.sim.agent.actions import parse_actions, walk_and_rest
from remqa_data.sim.metadata import AgentState
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.paths import poses_along


@dataclass(frozen=True)
class Rectangle:
    """x and y of the upper left corner, width and height, in metres on the map."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class Standing:
    """Where somebody stands on the map, and which way they look: degrees clockwise from the right, as drawings turn."""

    x: float
    y: float
    turn_deg: float


@dataclass(frozen=True)
class RoomMap:
    """The frame of a map.

    Attributes
    ----------
    left, top : float
        World x and y of the upper left corner, metres.
    width, height : float
        Metres.
    """

    left: float
    top: float
    width: float
    height: float

    @classmethod
    def of(cls, room: Arrangement) -> RoomMap:
        """The frame of a room's stored map."""
        columns, rows = room.plan_labels.shape
        (i, j), size = room.corner, room.voxel_m
        return cls(i * size, (j + rows) * size, columns * size, rows * size)

    def point(self, x: float, y: float) -> Vec2:
        """A place of the world on the map."""
        return round(x - self.left, 3), round(self.top - y, 3)

    def standing(self, state: dict[str, Any]) -> Standing:
        """A stored agent state on the map."""
        x, y = self.point(*state["position"][:2])
        return Standing(x, y, -state["yaw_deg"])

    def rectangle(self, box: Box) -> Rectangle:
        """A box of the world from above."""
        x, y = self.point(box[0], box[4])
        return Rectangle(x, y, round(box[3] - box[0], 3), round(box[4] - box[1], 3))

    def centre(self, box: Box) -> Vec2:
        """The middle of a box of the world."""
        return self.point((box[0] + box[3]) / 2, (box[1] + box[4]) / 2)


def way(room: Arrangement, frame: RoomMap, start: dict[str, Any], actions: Sequence[str]) -> list[Vec2]:
    """The places that an oracle's actions lead through on the map; only the start if they cannot be followed."""
    state = AgentState((start["position"][0], start["position"][1], start["position"][2]), start["yaw_deg"], 0.0)
    first = frame.point(*state.position[:2])
    try:
        walk, _ = walk_and_rest(parse_actions(actions))
        grid = _grid(room)
        poses = poses_along(grid, state.pose(), (step.name for step in walk))
    except RemqaError:
        return [first]
    points = [frame.point(*grid.position(pose.cell)) for pose in poses]
    return [point for place, point in enumerate(points) if place == 0 or point != points[place - 1]]


def _grid(room: Arrangement) -> ReachableGrid:
    """The stored cells; that a step from one to its neighbour is free, the dataset has proved."""
    cells = set(room.cells)
    graph: nx.Graph[tuple[int, int]] = nx.Graph()
    graph.add_nodes_from(room.cells)
    graph.add_edges_from(((i, j), other) for i, j in room.cells for other in ((i + 1, j), (i, j + 1)) if other in cells)
    return ReachableGrid(room.cells, graph, (), 0.0)
