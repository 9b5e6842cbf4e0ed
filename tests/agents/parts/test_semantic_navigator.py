"""The walker on maps made by hand."""

import math

import networkx as nx
import numpy as np
import pytest

from remqa_data.agents.knowledge.instance import choose_instance
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.semantic_navigator import (
    SemanticMapNavigator,
    floyd_warshall,
    free_cells,
    goals,
)
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.room_records import thing
from tests.helpers.walked_rooms import memory_of, percept_of, walk

BOUNDS = (-2.0, -3.0, 2.0, 0.5)
FRIDGE = thing("Fridge|1", (0.0, 0.1, 0.0), (0.8, 0.8, 1.8))
CAN = thing("GarbageCan|1", (0.0, 0.1, 0.0), (0.3, 0.3, 0.4))
QUESTION = read_question("Is there a mug in the fridge?")
START = AgentPose((0, -10), 0)
RNG = np.random.default_rng(0)


def grid_of(*pairs) -> ReachableGrid:
    graph = nx.Graph(pairs)
    return ReachableGrid(tuple(sorted(graph)), graph, (), 0.0)


def test_all_pairs_shortest_paths_of_a_map_by_hand() -> None:
    # Five cells in a row that is bent once, and two that cannot be reached from there.
    grid = grid_of(((0, 0), (0, 1)), ((0, 1), (0, 2)), ((0, 2), (1, 2)), ((1, 2), (2, 2)), ((5, 5), (5, 6)))
    steps = floyd_warshall(grid)
    order = [grid.cells.index(cell) for cell in ((0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (5, 5))]
    assert steps[order[0]][order].tolist() == [0, 1, 2, 3, 4, math.inf]
    assert steps.tolist() == steps.T.tolist()


def test_the_walk_leads_straight_to_the_front_of_the_target() -> None:
    memory = memory_of([FRIDGE], BOUNDS)
    instance = choose_instance(QUESTION.target, memory)
    actions, pose = walk(SemanticMapNavigator().begin(QUESTION, memory, RNG), START, instance)
    assert pose.yaw_deg == 90
    # The front of the fridge is at y = -0.3; the shoulder is 0.15 m ahead of the agent and the arm 0.63 m long.
    assert math.dist((pose.cell[0] * 0.25, pose.cell[1] * 0.25), (0.0, -0.3)) < 0.9
    assert actions.count("MoveAhead") == abs(pose.cell[0]) + pose.cell[1] + 10  # no cell is walked in vain
    assert actions.count("RotateLeft") == 1


def test_where_nothing_could_be_done_it_goes_to_another_cell() -> None:
    memory = memory_of([FRIDGE], BOUNDS)
    instance = choose_instance(QUESTION.target, memory)
    walker, pose, cells = SemanticMapNavigator().begin(QUESTION, memory, RNG), START, []
    for _ in range(4):
        _, pose = walk(walker, pose, instance)
        cells.append(pose.cell)
        walker.leave(percept_of(pose))
    assert len(set(cells)) == 4
    assert max(math.dist((x * 0.25, y * 0.25), (0.0, -0.3)) for x, y in cells) < 1.3


def test_a_way_round_is_found_where_the_map_knows_an_obstacle() -> None:
    shelf = thing("Shelf|1", (0.0, -1.5, 0.0), (2.0, 0.3, 1.0))
    memory = memory_of([FRIDGE, shelf], BOUNDS)
    instance = choose_instance(QUESTION.target, memory)
    actions, pose = walk(SemanticMapNavigator().begin(QUESTION, memory, RNG), START, instance)
    assert pose.cell[1] > -6
    assert actions.count("MoveAhead") > 10


def test_a_step_that_is_refused_is_not_tried_again() -> None:
    memory = memory_of([FRIDGE], BOUNDS)
    instance = choose_instance(QUESTION.target, memory)
    closed = {(i, -8) for i in range(1, 5)}  # of which the map knows nothing
    walker = SemanticMapNavigator().begin(QUESTION, memory, RNG)
    actions, pose = walk(walker, START, instance, closed)
    free, _ = walk(SemanticMapNavigator().begin(QUESTION, memory, RNG), START, instance)
    assert pose.cell[1] > -8  # past the cells that are closed
    assert len(free) < len(actions) < len(free) + 20


@pytest.mark.slow
def test_where_the_target_is_not_in_sight_the_next_goal_is_tried() -> None:
    memory = memory_of([FRIDGE], BOUNDS)
    instance = choose_instance(QUESTION.target, memory)
    walker = SemanticMapNavigator().begin(QUESTION, memory, RNG)
    _, first = walk(walker, START, instance)
    walker = SemanticMapNavigator().begin(QUESTION, memory, RNG)
    actions, _ = walk(walker, START, None, most_steps=500)  # who sees nothing looks from everywhere
    grid = ReachableGrid(tuple(sorted(free_cells(memory, START.cell))), free_cells(memory, START.cell), (), 0.0)
    assert len(goals(instance, memory, grid, opens=True)) > 3
    assert len(actions) > 3 * (abs(first.cell[0]) + abs(first.cell[1] + 10))
    assert walker.next_action(percept_of(first)) is None  # then it gives up


def test_who_stands_where_the_map_says_that_nobody_can_finds_the_way_out() -> None:
    memory = memory_of([FRIDGE, thing("Chair|1", (0.0, -2.5, 0.0), (0.4, 0.4, 0.8))], BOUNDS)
    assert START.cell not in memory.plan.navigation_grid().graph
    graph = free_cells(memory, START.cell)
    assert nx.has_path(graph, START.cell, (0, -4))
    instance = choose_instance(QUESTION.target, memory)
    _, pose = walk(SemanticMapNavigator().begin(QUESTION, memory, RNG), START, instance)
    assert pose.cell[1] > -6


@pytest.mark.slow
@pytest.mark.parametrize("text", ["Is there a mug in the safe?", "Is there a mug in the microwave?"])
def test_nobody_walks_to_what_was_never_seen(text: str) -> None:
    walker = SemanticMapNavigator().begin(read_question(text), memory_of([FRIDGE], BOUNDS), RNG)
    assert walk(walker, START) == ([], START)


def test_what_is_opened_is_reached_from_its_front_and_not_from_where_it_slides_out() -> None:
    drawer = thing("Drawer|1", (0.0, 0.1, 0.5), (0.5, 0.5, 0.2))  # slides out to y = -0.6
    memory = memory_of([drawer], BOUNDS)
    instance = choose_instance(read_question("Is there a mug in the drawer?").target, memory)
    graph = free_cells(memory, START.cell)
    grid = ReachableGrid(tuple(sorted(graph)), graph, (), 0.0)
    found = {look.pose.cell for look in goals(instance, memory, grid, opens=True)}
    assert found
    assert all(j * 0.25 <= -0.8 or abs(i) * 0.25 >= 0.45 for i, j in found)
    around = {look.pose.cell for look in goals(instance, memory, grid, opens=False)}
    assert found < around


@pytest.mark.slow
def test_into_what_is_open_it_looks_from_before_it_each_time_from_another_cell() -> None:
    fridge = thing("Fridge|1", (0.0, 0.1, 0.0), (0.8, 0.8, 1.8))
    memory = memory_of([fridge], BOUNDS)
    instance = choose_instance(QUESTION.target, memory)
    walker = SemanticMapNavigator().begin(QUESTION, memory, RNG)
    _, pose = walk(walker, START, instance)
    cells = [pose.cell]
    for _ in range(3):
        walker.look_inside(percept_of(pose))
        actions, pose = walk(walker, pose)  # who sees nothing inside stops there all the same
        assert actions
        assert pose.yaw_deg == 90
        cells.append(pose.cell)
    assert len(set(cells)) == 4
    assert max(abs(i) * 0.25 for i, _ in cells[1:]) < 0.6  # before its middle


def test_only_what_opens_into_the_room_has_an_inside_to_look_into() -> None:
    walker = SemanticMapNavigator().begin(
        read_question("Is there a CD under the garbage can?"), memory_of([CAN], BOUNDS), RNG
    )
    _, pose = walk(
        walker, START, choose_instance(read_question("Is there a CD under the garbage can?").target, walker.memory)
    )
    walker.look_inside(percept_of(pose))
    assert walk(walker, pose) == ([], pose)
    assert not walker.inside_of(percept_of(pose)).any()
