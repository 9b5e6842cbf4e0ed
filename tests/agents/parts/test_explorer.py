"""Exploration of maps made by hand, and of a room in which a detector that knows the truth looks round."""

import math

import networkx as nx
import numpy as np
import pytest

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.parts.explorer import Belief, frontier, nearest_frontier
from remqa_data.agents.parts.frontier_navigator import is_sure
from remqa_data.mapping.semantic_map import SemanticPlan
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose


def plan(*rows: str) -> SemanticPlan:
    """A plan from drawings, the highest y first: "." is free floor, "#" a wall, " " was never looked at."""
    drawn = np.array([list(row) for row in rows[::-1]]).T
    return SemanticPlan(
        corner=(10, 20),
        voxel_m=0.05,
        floor_z=0.0,
        names=("structure",),
        labels=np.where(drawn == "#", 0, -1).astype(np.int16),
        known=drawn != " ",
        occupied=drawn == "#",
    )


def test_a_frontier_is_free_floor_beside_what_was_never_looked_at() -> None:
    found = frontier(
        plan("#########", "#......  ", "#......  ", "#......  ", "#......  ", "#......  ", "#......  ", "#########")
    )
    assert sorted(map(tuple, found.tolist())) == [(16, 20 + y) for y in range(1, 7)]  # the column beside the unknown
    assert not len(frontier(plan("####", "#..#", "####")))


def test_small_gaps_and_what_was_given_up_are_no_frontier() -> None:
    assert not len(frontier(plan("#####", "#.. #", "#...#", "#####")))
    rows = ("#########", *["#......  "] * 8, "#########")
    assert len(frontier(plan(*rows))) == 8
    assert len(frontier(plan(*rows), {(16, 21), (0, 0)})) == 7
    assert not len(frontier(plan(*rows), {(16, 24)}))  # two pieces of 3 and 4


def corridor(cells: int) -> ReachableGrid:
    graph = nx.path_graph([(i, 0) for i in range(cells)])
    return ReachableGrid(tuple(sorted(graph)), graph, (), 0.0)


def nowhere(places: np.ndarray) -> np.ndarray:
    return np.zeros(len(places))


def test_the_nearest_frontier_is_looked_at_from_a_metre() -> None:
    places = np.array([[-1.0, 0.0], [4.5, 0.0], [4.5, 0.1]])
    goal, seen = nearest_frontier(corridor(17), AgentPose((12, 0), 0, 30), places, nowhere(places))
    assert goal == AgentPose((14, 0), 0, 30)  # x = 3.5
    assert seen.tolist() == [False, True, False]  # the third is 5 mm farther than a metre from there
    goal, _ = nearest_frontier(corridor(17), AgentPose((1, 0), 0, 30), places, nowhere(places))
    assert goal == AgentPose((0, 0), 180, 30)


def test_turns_cost_as_much_as_steps_and_costs_count() -> None:
    places = np.array([[-1.25, 0.0], [1.25, 0.0]])
    costs = nowhere(places)
    here = AgentPose((0, 0), 0, 30)
    graph = nx.path_graph([(i, 0) for i in range(-4, 5)])
    grid = ReachableGrid(tuple(sorted(graph)), graph, (), 0.0)
    goal, _ = nearest_frontier(grid, here, places, costs)
    assert goal is not None
    assert goal.cell == (1, 0)  # the other one takes two turns more
    goal, _ = nearest_frontier(grid, here, places, np.array([0.0, 5.0]))
    assert goal == AgentPose((-1, 0), 180, 30)


def test_what_is_out_of_reach_is_no_goal() -> None:
    goal, seen = nearest_frontier(corridor(3), AgentPose((0, 0), 0, 30), np.array([[5.0, 0.0]]), np.zeros(1))
    assert goal is None
    assert not seen.any()


@pytest.mark.parametrize(
    ("found_by", "votes", "sure"),
    [
        ("graph", 0.9, True),
        ("graph", 0.7, False),
        ("graph, roughly", 1.6, True),
        ("graph, roughly", 1.4, False),
        ("type", math.inf, False),
        ("map", math.inf, False),
    ],
)
def test_an_agent_goes_to_what_many_views_agree_on(found_by: str, votes: float, sure: bool) -> None:
    instance = Instance("Mug", (0.0, 0.0, 0.0, 0.1, 0.1, 0.1), None, found_by)  # type: ignore[arg-type]
    assert is_sure(Belief(instance, votes)) is sure
