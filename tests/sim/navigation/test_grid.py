import networkx as nx
import numpy as np
import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.assets.looks.materials import OAK
from remqa_data.scene import Scene, SceneObject, StructureBox
from remqa_data.sim.navigation.embodiment import AGENT, Embodiment
from remqa_data.sim.navigation.grid import cells_in_reach, reach_distance, reachable_grid
from remqa_data.sim.navigation.ground import Ground
from remqa_data.sim.physics.world import World


def empty_room(*boxes, objects=(), half=2.0) -> Scene:
    floor = StructureBox("floor", (-half, -half, -0.1, half, half, 0.0), OAK)
    extra = tuple(StructureBox("wall", box, OAK) for box in boxes)
    return Scene(
        "Test", "kitchen", (-half, -half, half, half), 0.0, 2.5, ((0, 0, 2.4),), (floor, *extra), tuple(objects)
    )


def cells(scene: Scene) -> set[tuple[int, int]]:
    with World(scene) as world:
        return set(reachable_grid(world).cells)


def test_an_empty_room_is_free_up_to_the_agents_radius_from_the_walls() -> None:
    found = cells(empty_room())
    # 2 m - 0.2 m = 1.8 m: cells at -1.75 .. 1.75
    assert found == {(i, j) for i in range(-7, 8) for j in range(-7, 8)}


def test_a_table_blocks_its_plan_and_the_agents_radius_around_it() -> None:
    found = cells(empty_room((-0.5, -0.5, 0.4, 0.5, 0.5, 0.8)))
    positions = np.array(sorted(found)) * AGENT.step_m
    gap = np.hypot(*np.maximum(np.abs(positions) - 0.5, 0).T)
    assert gap.min() > 0.2 - 0.02
    assert (3, 0) in found  # 0.75 - 0.5 = 0.25 m
    assert (2, 0) not in found


@pytest.mark.parametrize("z", [(0.0, 0.04), (1.85, 2.2)])
def test_rugs_and_wall_cabinets_do_not_block(z: tuple[float, float]) -> None:
    assert (0, 0) in cells(empty_room((-0.5, -0.5, z[0], 0.5, 0.5, z[1])))


def test_a_wall_cuts_off_what_is_behind_it() -> None:
    mug = SceneObject("Mug|1", AssetSpec("Mug", (0.1, 0.1, 0.1)), (-1.5, 0.0, 0.05))
    scene = empty_room((0.48, -2.0, 0.0, 0.52, 2.0, 2.5), objects=(mug,))
    with World(scene) as world:
        grid = reachable_grid(world)
    assert max(i for i, _ in grid.cells) == 1  # 0.25 m: the mug is on the smaller x side
    assert grid.other_parts == (75,)  # 0.75 .. 1.75 m: 5 columns of 15
    assert nx.is_connected(grid.graph)


def test_steps_never_cut_a_corner() -> None:
    scene = empty_room((0.2, -2.0, 0.0, 0.3, 1.2, 2.5))
    with World(scene) as world:
        grid = reachable_grid(world)
    for a, b in grid.graph.edges:
        assert abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1
    assert nx.shortest_path_length(grid.graph, (-2, 0), (3, 0)) > 5


def test_reach_is_from_a_shoulder_that_slides_between_45_and_180_cm() -> None:
    # the shoulder is 0.15 m ahead of the agent's middle
    assert reach_distance((0.0, 0.0), 0.0, (0.65, 0.0, 1.0)) == pytest.approx(0.5)
    assert reach_distance((0.0, 0.0), 0.0, (0.15, 0.0, 0.05)) == pytest.approx(0.4)
    assert reach_distance((0.0, 0.0), 0.0, (0.45, 0.0, 2.2)) == pytest.approx(0.5)
    assert reach_distance((0.0, 0.0), 0.2, (0.15, 0.0, 0.25)) == pytest.approx(0.4)


def test_cells_in_reach_are_those_near_any_of_the_points() -> None:
    with World(empty_room()) as world:
        grid = reachable_grid(world)
    near = cells_in_reach(grid, [(0.0, 0.0, 1.0)])
    distances = [np.hypot(*grid.position(cell)) for cell in near]
    assert max(distances) <= 0.63 + 0.15
    assert len(near) == sum(np.hypot(i, j) * AGENT.step_m <= 0.78 for i in range(-7, 8) for j in range(-7, 8))


@pytest.mark.parametrize(
    ("body", "is_free"),
    [
        (Embodiment(), {(2, 0): False, (3, 0): True, (0, 0): False}),
        (Embodiment(radius_m=0.35), {(2, 0): False, (3, 0): False, (0, 0): False}),
        (Embodiment(height_m=1.2), {(2, 0): True, (3, 0): True, (0, 0): True}),
        (Embodiment(step_m=0.5), {(2, 0): False, (3, 0): True, (0, 0): False}),
    ],
    ids=["usual", "wide", "low", "in long steps"],
)
def test_a_grid_is_for_the_body_that_is_to_stand_there(body: Embodiment, is_free: dict[tuple[int, int], bool]) -> None:
    """Under a box, 1 m wide, that hangs from 1.3 to 1.6 m."""
    with World(empty_room((-0.5, -0.5, 1.3, 0.5, 0.5, 1.6))) as world:
        ground = Ground(world, body)
        grid = ground.grid()
    assert {cell: cell in grid.graph for cell in is_free} == is_free
    assert grid.positions() == pytest.approx(np.array(grid.cells) * 0.25)
    assert all(ground.blocker_at(*grid.position(cell)) is None for cell in grid.cells)
