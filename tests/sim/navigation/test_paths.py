"""The oracle is another search over another state space: complex numbers, horizons and postures included."""

from itertools import product

import networkx as nx
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from remqa_data.errors import ActionError, NoPathError
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.paths import path_length_m, pose_after, shortest_actions
from remqa_data.sim.navigation.viewpoints import AgentPose


def grid_of(*rows: str) -> ReachableGrid:
    """A grid drawn with one character for each cell, "." is free, +x to the right and +y up; its corner is (0, 0)."""
    cells = [(i, len(rows) - 1 - r) for r, row in enumerate(rows) for i, mark in enumerate(row) if mark == "."]
    graph = nx.Graph()
    graph.add_nodes_from(sorted(cells))
    graph.add_edges_from((a, b) for a in cells for b in ((a[0] + 1, a[1]), (a[0], a[1] + 1)) if b in cells)
    return ReachableGrid(tuple(sorted(cells)), graph, (), 0.0)


def oracle_graph(grid: ReachableGrid) -> nx.DiGraph:
    """Every pose and where each action leads, with AI2-THOR's rules written down a second time."""
    graph = nx.DiGraph()
    for i, j in grid.cells:
        for turns in range(4):
            for horizon, up in product((-30, 0, 30, 60), (False, True)):
                here = (complex(i, j), turns, horizon, up)
                graph.add_edge(here, (complex(i, j), turns, horizon, not up), metres=0.0)
                ahead = complex(i, j) + 1j**turns
                target = (round(ahead.real), round(ahead.imag))
                if grid.graph.has_edge((i, j), target):
                    graph.add_edge(here, (complex(*target), turns, horizon, up), metres=AGENT.step_m)
                for turn in (1, 3):
                    graph.add_edge(here, (complex(i, j), (turns + turn) % 4, horizon, up), metres=0.0)
                for look in (-30, 30):
                    if -30 <= horizon + look <= 60:
                        graph.add_edge(here, (complex(i, j), turns, horizon + look, up), metres=0.0)
    return graph


def node(pose: AgentPose) -> tuple[complex, int, int, bool]:
    return complex(*pose.cell), pose.yaw_deg // 90 % 4, pose.horizon_deg, pose.is_standing


def follow(grid: ReachableGrid, pose: AgentPose, actions: list[str]) -> AgentPose:
    for action in actions:
        pose = pose_after(grid, pose, action)
    return pose


OPEN_3X2 = grid_of("...", "...")
RING = grid_of(".....", ".###.", ".###.", ".....")


def test_a_walk_around_one_corner_by_hand() -> None:
    start, goal = AgentPose((0, 0), 0, 0), AgentPose((2, 1), 90, 60)
    expected = ["MoveAhead", "MoveAhead", "RotateLeft", "MoveAhead", "LookDown", "LookDown"]
    assert shortest_actions(OPEN_3X2, start, goal) == expected


def test_turning_right_goes_clockwise_from_plus_y_to_plus_x() -> None:
    assert shortest_actions(OPEN_3X2, AgentPose((1, 0), 90), AgentPose((2, 0), 0)) == ["RotateRight", "MoveAhead"]


def test_there_is_nothing_to_do_where_one_is_already() -> None:
    assert shortest_actions(OPEN_3X2, AgentPose((1, 1), 270, 30), AgentPose((1, 1), 270, 30)) == []


def test_turning_about_takes_two_turns() -> None:
    actions = shortest_actions(OPEN_3X2, AgentPose((1, 1), 0), AgentPose((1, 1), 180))
    assert actions in (["RotateLeft"] * 2, ["RotateRight"] * 2)


def test_looking_up_goes_from_60_to_minus_30() -> None:
    assert shortest_actions(OPEN_3X2, AgentPose((0, 0), 0, 60), AgentPose((0, 0), 0, -30)) == ["LookUp"] * 3


def test_a_horizon_beyond_the_cameras_reach_is_clamped() -> None:
    assert shortest_actions(OPEN_3X2, AgentPose((0, 0), 0, 0), AgentPose((0, 0), 0, 90)) == ["LookDown"] * 2


def test_the_agent_crouches_where_it_arrives_and_then_looks() -> None:
    start, goal = AgentPose((0, 0), 0), AgentPose((1, 0), 0, 30, is_standing=False)
    assert shortest_actions(OPEN_3X2, start, goal) == ["MoveAhead", "Crouch", "LookDown"]
    assert shortest_actions(OPEN_3X2, goal, AgentPose((1, 0), 0, 30)) == ["Stand"]


def test_the_way_leads_round_an_obstacle() -> None:
    # 4 right, 3 up: both ways round the ring are 7 cells; facing +x, the one along the bottom needs a turn less
    actions = shortest_actions(RING, AgentPose((0, 0), 0), AgentPose((4, 3), 90))
    assert actions == ["MoveAhead"] * 4 + ["RotateLeft"] + ["MoveAhead"] * 3
    assert path_length_m(RING, (0, 0), (4, 3)) == 7 * 0.25


STAIRS = grid_of(
    ".....#",
    ".###.#",
    ".##..#",
    ".#..##",
    "...###",
    ".#####",
)


def test_the_shortest_way_is_taken_even_if_it_turns_more_often() -> None:
    # up the stairs: 8 cells and 6 turns, and 2 to face down; along the edges: 10 cells and 2 turns
    actions = shortest_actions(STAIRS, AgentPose((0, 0), 90), AgentPose((4, 4), 270))
    assert (len(actions), actions.count("MoveAhead")) == (16, 8)
    assert path_length_m(STAIRS, (0, 0), (4, 4)) == 8 * 0.25


def test_of_equally_long_ways_the_one_with_fewer_turns_is_taken() -> None:
    actions = shortest_actions(OPEN_3X2, AgentPose((0, 0), 0), AgentPose((2, 1), 90))
    assert actions == ["MoveAhead", "MoveAhead", "RotateLeft", "MoveAhead"]


@st.composite
def grids(draw: st.DrawFn) -> ReachableGrid:
    width, height = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    rows = draw(st.lists(st.text(".#", min_size=width, max_size=width), min_size=height, max_size=height))
    grid = grid_of(*rows)
    assume(grid.cells)
    return grid


poses = st.tuples(
    st.integers(0, 24), st.sampled_from((0, 90, 180, 270)), st.sampled_from((-30, 0, 30, 60)), st.booleans()
)


@pytest.mark.slow
@settings(max_examples=150)
@given(grids(), poses, poses)
def test_no_other_search_finds_a_shorter_way(grid: ReachableGrid, a: tuple[int, ...], b: tuple[int, ...]) -> None:
    start, goal = (AgentPose(grid.cells[pose[0] % len(grid.cells)], *pose[1:]) for pose in (a, b))
    graph = oracle_graph(grid)
    if not nx.has_path(graph, node(start), node(goal)):
        with pytest.raises(NoPathError, match="no way"):
            shortest_actions(grid, start, goal)
        return
    actions = shortest_actions(grid, start, goal)
    assert follow(grid, start, actions) == goal
    metres = actions.count("MoveAhead") * AGENT.step_m
    assert metres == nx.dijkstra_path_length(graph, node(start), node(goal), "metres")
    assert metres == path_length_m(grid, start.cell, goal.cell)
    # of all ways so short, none has fewer actions: each costs a little, so that their number breaks ties
    cheapest = nx.dijkstra_path_length(graph, node(start), node(goal), lambda u, v, edge: edge["metres"] + 1e-6)
    assert len(actions) == round((cheapest - metres) / 1e-6)


@pytest.mark.parametrize(
    ("start", "goal", "said"),
    [
        (AgentPose((9, 9), 0), AgentPose((0, 0), 0), r"\(9, 9\) is not among the 6 reachable cells"),
        (AgentPose((0, 0), 0), AgentPose((0, 5), 0), r"\(0, 5\) is not among"),
        (AgentPose((0, 0), 45), AgentPose((0, 1), 0), "multiple of 90"),
        (AgentPose((0, 0), 0, 0), AgentPose((0, 1), 0, 15), "multiple of 30"),
    ],
)
def test_poses_off_the_grid_are_refused(start: AgentPose, goal: AgentPose, said: str) -> None:
    with pytest.raises(NoPathError, match=said):
        shortest_actions(OPEN_3X2, start, goal)


def test_the_length_of_a_way_off_the_grid_is_refused() -> None:
    with pytest.raises(NoPathError, match=r"\(3, 0\)"):
        path_length_m(OPEN_3X2, (0, 0), (3, 0))


@pytest.mark.parametrize(
    ("pose", "action", "said"),
    [
        (AgentPose((2, 0), 0), "MoveAhead", "in the way"),
        (AgentPose((0, 0), 45), "MoveAhead", "multiple of 90"),
        (AgentPose((0, 0), 0, 60), "LookDown", "tilts from -30 to 60"),
        (AgentPose((0, 0), 0, -30), "LookUp", "tilts"),
        (AgentPose((0, 0), 0), "Stand", "already"),
        (AgentPose((0, 0), 0), "Jump", "not a navigation action"),
    ],
)
def test_actions_that_cannot_be_done_are_refused(pose: AgentPose, action: str, said: str) -> None:
    with pytest.raises(ActionError, match=said):
        pose_after(OPEN_3X2, pose, action)
