import math
from itertools import product

import networkx as nx
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.generators.samples import goals_and_starts
from remqa_data.metrics import navigation_success
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose


def open_floor(columns: int, rows: int) -> ReachableGrid:
    """A room without anything in it, with a cell each 0.25 m."""
    graph: nx.Graph[Cell] = nx.grid_2d_graph(columns, rows)
    return ReachableGrid(tuple(product(range(columns), range(rows))), graph, (), 0.0)


cells = st.tuples(st.integers(0, 9), st.integers(0, 7))


@given(st.lists(cells, min_size=1, max_size=5, unique=True))
def test_nobody_arrives_without_a_step(goal_cells: list[Cell]) -> None:
    grid = open_floor(10, 8)
    goals, starts = goals_and_starts(grid, [AgentPose(cell, 0) for cell in goal_cells])
    assert goals[0].cell == goal_cells[0]
    assert starts
    for start in starts:
        nearest = min(math.dist(grid.position(start), grid.position(goal.cell)) for goal in goals)
        assert not navigation_success([nearest], [True])[0]


def test_a_large_room_keeps_all_goals_and_a_small_one_those_that_leave_room_to_start() -> None:
    corners = [AgentPose(cell, 0) for cell in ((0, 0), (0, 7), (7, 7))]
    assert goals_and_starts(open_floor(20, 20), corners)[0] == corners
    goals, starts = goals_and_starts(open_floor(8, 8), corners)
    assert goals == corners[:1] or len(starts) >= 12
    assert starts


def test_where_all_is_near_there_is_no_start() -> None:
    # by hand: the corners of 4 x 4 cells are 0.75 m * sqrt 2 = 1.06 m from one another, those of 3 x 3 cells 0.71 m
    assert goals_and_starts(open_floor(4, 4), [AgentPose((0, 0), 0)])[1] == [(3, 3)]
    assert goals_and_starts(open_floor(3, 3), [AgentPose((0, 0), 0)])[1] == []
