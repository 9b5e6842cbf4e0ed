from collections.abc import Iterator

import networkx as nx
import numpy as np
import pytest

from remqa_data.errors import NoPathError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.walks.walk import WalkFrame, WalkSettings, breadth_first, plan_walk, walk
from remqa_data.sim.metadata import AgentState
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell, ReachableGrid, reachable_grid
from remqa_data.sim.navigation.viewpoints import MIN_PIXELS, AgentPose
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

SETTINGS = WalkSettings(frames=12)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def lattice(*walls: tuple[Cell, Cell], side: int = 5) -> ReachableGrid:
    """A square of cells, without some of the steps between them."""
    graph = nx.grid_2d_graph(side, side)
    graph.remove_edges_from(walls)
    return ReachableGrid(tuple(sorted(graph)), graph, (), 0.0)


# ---- the order of the cells


def test_neighbours_come_before_their_neighbours() -> None:
    order = list(breadth_first(lattice(side=3), (0, 0)))
    # by hand: +x before +y
    assert order[:6] == [((0, 0), 0), ((1, 0), 1), ((0, 1), 1), ((2, 0), 2), ((1, 1), 2), ((0, 2), 2)]


@pytest.mark.parametrize("seed", range(5))
def test_every_cell_is_visited_once_and_none_before_a_nearer_one(seed: int) -> None:
    grid = lattice(((0, 0), (1, 0)), ((1, 1), (1, 2)), ((3, 3), (3, 4)), ((2, 3), (3, 3)))
    order = list(breadth_first(grid, (1, 1), rng(seed)))
    assert dict(order) == nx.single_source_shortest_path_length(grid.graph, (1, 1))
    assert len(order) == 25
    distances = [steps for _, steps in order]
    assert distances == sorted(distances)


def test_the_generator_decides_which_neighbour_comes_first() -> None:
    firsts = {list(breadth_first(lattice(), (2, 2), rng(seed)))[1][0] for seed in range(30)}
    assert firsts == {(3, 2), (2, 3), (1, 2), (2, 1)}


def test_a_walk_starts_on_the_grid() -> None:
    with pytest.raises(NoPathError, match=r"cannot start at \(7, 7\)"):
        list(breadth_first(lattice(), (7, 7)))


# ---- a bedroom


@pytest.fixture(scope="module")
def room() -> Iterator[tuple[WorldView, ReachableGrid]]:
    with World(load_scene("FloorPlan301")) as world:
        world.settle()
        yield WorldView(world), reachable_grid(world)


@pytest.fixture(scope="module")
def frames(room: tuple[WorldView, ReachableGrid]) -> list[WalkFrame]:
    view, grid = room
    return list(walk(view, grid, grid.cells[0], SETTINGS, rng()))


def test_a_walk_gives_as_many_frames_as_wanted_all_different(frames: list[WalkFrame]) -> None:
    assert len({frame.pose for frame in frames}) == len(frames) == SETTINGS.frames


def test_frames_come_in_breadth_first_order(room: tuple[WorldView, ReachableGrid], frames: list[WalkFrame]) -> None:
    _, grid = room
    distances = nx.single_source_shortest_path_length(grid.graph, grid.cells[0])
    assert [frame.steps for frame in frames] == [distances[frame.pose.cell] for frame in frames]
    order = [cell for cell, _ in breadth_first(grid, grid.cells[0], rng())]
    places = [order.index(frame.pose.cell) for frame in frames]
    assert places == sorted(places)


def test_frames_are_spread_over_the_room(room: tuple[WorldView, ReachableGrid], frames: list[WalkFrame]) -> None:
    _, grid = room
    order = [cell for cell, _ in breadth_first(grid, grid.cells[0], rng())]
    # the walk is cut into 12 runs of one frame each; a cell's views can fall into two runs
    runs = [order.index(frame.pose.cell) * 12 / len(order) for frame in frames]
    assert max(abs(run - place) for place, run in enumerate(runs)) < 1.5


def test_a_frame_says_where_it_was_taken(room: tuple[WorldView, ReachableGrid], frames: list[WalkFrame]) -> None:
    _, grid = room
    assert frames
    for frame in frames:
        i, j = frame.pose.cell
        place = (i * AGENT.step_m, j * AGENT.step_m, grid.floor_z)
        assert frame.metadata.agent == AgentState(place, frame.pose.yaw_deg, frame.pose.horizon_deg)
        assert frame.camera == frame.pose.camera(grid)
        assert frame.observation.rgb.shape == (300, 300, 3)
        assert frame.observation.depth.shape == frame.observation.objects.shape == (300, 300)


def test_every_frame_sees_three_objects_besides_the_floor(frames: list[WalkFrame]) -> None:
    assert frames
    for frame in frames:
        assert sum(thing.type != "Floor" for thing in frame.metadata.objects) >= 3


@pytest.mark.slow
def test_together_the_frames_see_nearly_all_that_can_be_seen(
    room: tuple[WorldView, ReachableGrid], frames: list[WalkFrame]
) -> None:
    view, grid = room
    best = np.zeros(len(view.world.ids), dtype=np.int64)
    for cell in grid.cells:
        for heading in SETTINGS.headings_deg:
            for horizon in SETTINGS.horizons_deg:
                best = np.maximum(best, view.pixels(AgentPose(cell, heading, horizon).camera(grid)))
    seen = {thing.id for frame in frames for thing in frame.metadata.objects}
    assert len(seen) >= 0.95 * np.count_nonzero(best >= MIN_PIXELS)


def test_chosen_poses_see_more_than_drawn_ones(room: tuple[WorldView, ReachableGrid]) -> None:
    view, grid = room
    few = WalkSettings(frames=3)
    chosen = plan_walk(view, grid, grid.cells[0], few, rng())
    draw = rng(1)
    counts = []
    for _ in range(20):
        cells = draw.permutation(len(grid.cells))[:3]
        poses = [AgentPose(grid.cells[c], int(draw.choice(few.headings_deg)), int(draw.choice((0, 30)))) for c in cells]
        counts.append(seen_by(view, grid, poses))
    assert seen_by(view, grid, chosen) > np.percentile(counts, 90)


def seen_by(view: WorldView, grid: ReachableGrid, poses: list[AgentPose]) -> int:
    return int(np.any([view.pixels(pose.camera(grid)) >= MIN_PIXELS for pose in poses], axis=0).sum())


def test_the_same_generator_gives_the_same_frames(
    room: tuple[WorldView, ReachableGrid], frames: list[WalkFrame]
) -> None:
    view, grid = room
    again = list(walk(view, grid, grid.cells[0], SETTINGS, rng()))
    assert again
    assert [frame.pose for frame in again] == [frame.pose for frame in frames]
    assert [frame.metadata for frame in again] == [frame.metadata for frame in frames]
    for one, other in zip(again, frames, strict=True):
        assert np.array_equal(one.observation.rgb, other.observation.rgb)
        assert np.array_equal(one.observation.depth, other.observation.depth)


@pytest.mark.slow
def test_another_generator_gives_other_frames(room: tuple[WorldView, ReachableGrid]) -> None:
    view, grid = room
    start = grid.cells[len(grid.cells) // 2]
    assert len({tuple(plan_walk(view, grid, start, SETTINGS, rng(seed))) for seed in range(4)}) > 1


def test_headings_horizons_and_stride_come_from_the_settings(room: tuple[WorldView, ReachableGrid]) -> None:
    view, grid = room
    settings = WalkSettings(frames=5, headings_deg=(45, 225), horizons_deg=(60,), stride=7, min_objects=1)
    poses = plan_walk(view, grid, grid.cells[0], settings, rng())
    order = [cell for cell, _ in breadth_first(grid, grid.cells[0], rng())]
    assert len(poses) == 5
    assert {pose.yaw_deg for pose in poses} <= {45, 225}
    assert {pose.horizon_deg for pose in poses} == {60}
    assert all(order.index(pose.cell) % 7 == 0 for pose in poses)


@pytest.mark.slow
def test_poses_that_see_too_little_give_no_frame(room: tuple[WorldView, ReachableGrid]) -> None:
    view, grid = room
    strict = WalkSettings(frames=60, min_objects=20, stride=5)
    poses = plan_walk(view, grid, grid.cells[0], strict, rng())
    every = [
        AgentPose(cell, heading, horizon)
        for cell, _ in list(breadth_first(grid, grid.cells[0], rng()))[::5]
        for heading in strict.headings_deg
        for horizon in strict.horizons_deg
    ]
    floor = [view.world.type_of(object_id) == "Floor" for object_id in view.world.ids].index(True)

    def things(pose: AgentPose) -> int:
        shown = view.pixels(pose.camera(grid)) >= MIN_PIXELS
        return int(np.count_nonzero(np.delete(shown, floor)))

    worth_a_frame = [pose for pose in every if things(pose) >= 20]
    assert 0 < len(worth_a_frame) < 60
    assert poses == worth_a_frame
