from collections import Counter
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from remqa_data.errors import NoPathError, VoxelError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.walks.walk import WalkSettings, walk
from remqa_data.mapping.map_picture import PATH_COLOR, draw_plan
from remqa_data.mapping.semantic_map import FLOOR_SLACK_M, UNKNOWN, SemanticPlan, SparseVoxels, VoxelMap, shortest_path
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.navigation.grid import ReachableGrid, reachable_grid
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera, TopDownCamera
from remqa_data.sim.render.view import WorldView

BOUNDS = (-2.0, -2.0, 2.0, 2.0)
TYPES = ("Mug", "Table", "Apple")
MUG, TABLE, APPLE, STRUCTURE = 0, 1, 2, -1


def empty_map() -> VoxelMap:
    return VoxelMap(BOUNDS, 0.0, 2.5)


def see_one_voxel(voxels: VoxelMap, objects: list[list[int]], types: tuple[str, ...] = TYPES) -> None:
    """Show some pixels that all lie in voxel (4, 6, 10), from above."""
    image = np.array(objects, dtype=np.int32)
    height, width = image.shape
    camera = TopDownCamera((0.225, 0.325), 2.0, 0.01, width=width, height=height)  # 1 cm along the shorter side
    voxels.add(np.full(image.shape, 2.0 - 0.52, dtype=np.float32), image, types, camera)


def label_of(voxels: VoxelMap) -> str:
    sparse = voxels.to_sparse()
    assert sparse.coordinates.tolist() == [[4, 6, 10]]  # 0.20, 0.30 and 0.50 m
    return sparse.names[sparse.labels[0]]


# ---- votes


def test_a_voxel_is_labelled_with_what_most_pixels_show() -> None:
    voxels = empty_map()
    see_one_voxel(voxels, [[MUG, MUG, TABLE], [TABLE, TABLE, STRUCTURE]])
    assert label_of(voxels) == "Table"


def test_votes_of_all_frames_count() -> None:
    voxels = empty_map()
    see_one_voxel(voxels, [[MUG, MUG, TABLE]])
    see_one_voxel(voxels, [[TABLE, TABLE, MUG]])
    see_one_voxel(voxels, [[APPLE, MUG]])
    assert label_of(voxels) == "Mug"


def test_of_equal_votes_an_object_wins_against_the_structure() -> None:
    voxels = empty_map()
    see_one_voxel(voxels, [[STRUCTURE, MUG], [MUG, STRUCTURE]])
    assert label_of(voxels) == "Mug"


@pytest.mark.parametrize("objects", [[[TABLE, MUG, APPLE]], [[APPLE, TABLE, MUG]], [[MUG, APPLE, TABLE]]])
def test_of_equal_votes_the_first_name_in_the_alphabet_wins(objects: list[list[int]]) -> None:
    voxels = empty_map()
    see_one_voxel(voxels, objects)
    assert label_of(voxels) == "Apple"


def test_types_are_told_apart_by_name_not_by_index() -> None:
    voxels = empty_map()
    see_one_voxel(voxels, [[MUG, MUG]])
    see_one_voxel(voxels, [[0, 0, 0]], ("Sofa",))
    assert label_of(voxels) == "Sofa"


def test_pixels_that_show_nothing_do_not_vote() -> None:
    voxels = empty_map()
    camera = Camera((0.0, 0.0, 1.5), 0.0, width=4, height=4)
    voxels.add(np.zeros((4, 4), dtype=np.float32), np.zeros((4, 4), dtype=np.int32), TYPES, camera)
    assert len(voxels.to_sparse().labels) == 0


def test_what_is_outside_the_house_is_not_remembered() -> None:
    voxels = empty_map()
    camera = Camera((0.0, 0.0, 1.5), 0.0, width=4, height=4)
    voxels.add(np.full((4, 4), 2.5, dtype=np.float32), np.full((4, 4), -1, dtype=np.int32), TYPES, camera)
    assert len(voxels.to_sparse().labels) == 0


def random_frame(seed: int) -> tuple[np.ndarray, np.ndarray, Camera]:
    draw = np.random.default_rng(seed)
    position = (*draw.uniform(-1, 1, 2), 1.576)
    camera = Camera(position, draw.uniform(0, 360), draw.uniform(-30, 60), width=13, height=9)
    depth = draw.choice([0.3, 1.0, 3.0]) * draw.uniform(0.9, 1.1, (9, 13))
    depth[draw.random((9, 13)) < 0.1] = 0.0
    return depth.astype(np.float32), draw.integers(-1, 3, (9, 13)).astype(np.int32), camera


@pytest.mark.slow
@settings(max_examples=60)
@given(st.lists(st.integers(0, 10**6), min_size=1, max_size=4), st.sampled_from([0.05, 0.1, 0.3]))
def test_labels_are_those_that_counting_unprojected_pixels_one_by_one_gives(seeds: list[int], voxel_m: float) -> None:
    voxels = VoxelMap(BOUNDS, 0.013, 2.5, voxel_m)
    votes: dict[tuple[int, ...], Counter[str]] = {}
    for depth, objects, camera in map(random_frame, seeds):
        voxels.add(depth, objects, TYPES, camera)
        points = camera.unproject(depth) - [0.0, 0.0, 0.013 - 0.002]
        for point, distance, index in zip(points.reshape(-1, 3), depth.ravel(), objects.ravel(), strict=True):
            place = tuple(np.floor(point / voxel_m).astype(int).tolist())
            inside = all(0 <= p - c < n for p, c, n in zip(place, (*voxels.corner, 0), voxels.shape, strict=True))
            if distance > 0 and inside:
                votes.setdefault(place, Counter())[(*TYPES, "structure")[index]] += 1
    expected = {
        place: min(count, key=lambda name: (-count[name], name == "structure", name)) for place, count in votes.items()
    }
    sparse = voxels.to_sparse()
    found = {
        tuple(c): sparse.names[k] for c, k in zip(sparse.coordinates.tolist(), sparse.labels.tolist(), strict=True)
    }
    assert found == expected
    assert voxels.corner[0] * voxel_m <= BOUNDS[0] - 0.2  # and the walls, with what hangs in them, are inside
    assert (voxels.corner[0] + voxels.shape[0]) * voxel_m >= BOUNDS[2] + 0.2


@settings(max_examples=20)
@given(st.lists(st.integers(0, 10**6), min_size=2, max_size=4), st.randoms(use_true_random=False))
def test_the_order_of_the_frames_does_not_matter(seeds: list[int], shuffler) -> None:
    shuffled = list(seeds)
    shuffler.shuffle(shuffled)
    one, other = empty_map(), empty_map()
    for seed in seeds:
        one.add(*random_frame(seed)[:2], TYPES, random_frame(seed)[2])
    for seed in shuffled:
        other.add(*random_frame(seed)[:2], TYPES, random_frame(seed)[2])
    assert_same(one.to_sparse(), other.to_sparse())


def assert_same(one: SparseVoxels, other: SparseVoxels) -> None:
    assert one.names == other.names
    assert one.coordinates.dtype == other.coordinates.dtype == np.int16
    assert np.array_equal(one.coordinates, other.coordinates)
    assert np.array_equal(one.labels, other.labels)


# ---- storage


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_stored_voxels_are_sorted_and_give_the_same_map_again(seed: int) -> None:
    voxels = empty_map()
    depth, objects, camera = random_frame(seed)
    voxels.add(depth, objects, TYPES, camera)
    sparse = voxels.to_sparse()
    again = VoxelMap.from_sparse(sparse, BOUNDS, 0.0, 2.5)
    assert_same(again.to_sparse(), sparse)
    assert np.array_equal(again.labels()[0], voxels.labels()[0])
    assert [tuple(c) for c in sparse.coordinates] == sorted(tuple(c) for c in sparse.coordinates)
    assert sparse.names[0] == "structure"
    assert set(sparse.labels.tolist()) | {0} == set(range(len(sparse.names)))


def sparse_of(*voxels: tuple[int, int, int, str]) -> SparseVoxels:
    names = ("structure", *sorted({name for *_, name in voxels} - {"structure"}))
    coordinates = np.array([place for *place, _ in voxels], dtype=np.int16).reshape(-1, 3)
    return SparseVoxels(coordinates, np.array([names.index(n) for *_, n in voxels], dtype=np.int16), names)


@pytest.mark.parametrize(
    ("sparse", "said"),
    [
        (sparse_of((0, 0, 0, "Mug"), (99, 0, 0, "Mug")), r"voxel 1 at \[99, 0, 0\] is outside the room"),
        (sparse_of((0, 0, -1, "Mug")), "outside the room"),
        (sparse_of((0, 0, 3, "Mug"), (0, 0, 3, "Apple")), "twice"),
        (
            SparseVoxels(np.zeros((1, 3), np.int16), np.array([2], np.int16), ("structure", "Mug")),
            "label 2, but .* 2 n",
        ),
        (SparseVoxels(np.zeros((1, 3), np.int16), np.zeros(2, np.int16), ("structure",)), "coordinates with"),
    ],
)
def test_voxels_that_do_not_fit_are_refused(sparse: SparseVoxels, said: str) -> None:
    with pytest.raises(VoxelError, match=said):
        VoxelMap.from_sparse(sparse, BOUNDS, 0.0, 2.5)


def test_frames_that_do_not_fit_are_refused() -> None:
    camera = Camera((0.0, 0.0, 1.5), 0.0, width=4, height=3)
    depth, objects = np.ones((3, 4), dtype=np.float32), np.zeros((3, 4), dtype=np.int32)
    with pytest.raises(VoxelError, match=r"camera's image \(3, 4\)"):
        empty_map().add(depth[:2], objects[:2], TYPES, camera)
    with pytest.raises(VoxelError, match="from 0 to 3, but there are 3 types"):
        empty_map().add(depth, objects + np.eye(3, 4, dtype=np.int32) * 3, TYPES, camera)
    with pytest.raises(VoxelError, match="from -2"):
        empty_map().add(depth, objects - 2, TYPES, camera)


# ---- from above


def plan_of(*voxels: tuple[int, int, int, str]) -> SemanticPlan:
    return VoxelMap.from_sparse(sparse_of(*voxels), BOUNDS, 0.0, 2.5).plan()


def floor(without: set[tuple[int, int]] = frozenset()) -> list[tuple[int, int, int, str]]:
    """The ground of the whole room, -2 .. 2 m."""
    return [(i, j, 0, "Floor") for i in range(-40, 40) for j in range(-40, 40) if (i, j) not in without]


def name_at(plan: SemanticPlan, i: int, j: int) -> str | None:
    label = plan.labels[i - plan.corner[0], j - plan.corner[1]]
    return None if label == UNKNOWN else plan.names[label]


def test_a_column_shows_what_is_highest_below_180_cm() -> None:
    plan = plan_of(
        *[(3, 4, 0, "Floor"), (3, 4, 14, "Table"), (3, 4, 15, "Mug"), (3, 4, 36, "Painting")],
        *[(5, 5, 0, "Floor")],
        *[(6, 6, 35, "Cabinet")],
        *[(7, 7, 49, "structure")],
    )
    assert [name_at(plan, i, j) for i, j in ((3, 4), (5, 5), (6, 6), (7, 7), (8, 8))] == [
        *("Mug", "Floor", "Cabinet", None, None)
    ]


@pytest.mark.parametrize(
    ("layer", "occupied", "known"), [(0, False, True), (1, True, True), (35, True, True), (36, False, False)]
)
def test_what_is_between_5_and_180_cm_blocks(layer: int, occupied: bool, known: bool) -> None:
    plan = plan_of((3, 4, layer, "Rug"))
    place = (3 - plan.corner[0], 4 - plan.corner[1])
    assert (bool(plan.occupied[place]), bool(plan.known[place])) == (occupied, known)
    assert plan.occupied.sum() == occupied
    assert plan.known.sum() == known


@pytest.mark.parametrize("voxel_m", [0.1, 0.2])
def test_the_floor_blocks_nobody_in_a_coarse_map_either(voxel_m: float) -> None:
    columns = range(-round(2.0 / voxel_m), round(2.0 / voxel_m))
    ground = [(i, j, 0, "Floor") for i in columns for j in columns]
    plan = VoxelMap.from_sparse(sparse_of(*ground), BOUNDS, 0.0, 2.5, voxel_m).plan()
    assert not plan.occupied.any()
    assert len(plan.navigation_grid().cells) > 100


def test_an_empty_floor_is_free_up_to_the_agents_radius() -> None:
    # the same cells as tests/sim/navigation/test_grid.py expects of a room of this size
    grid = plan_of(*floor()).navigation_grid()
    assert set(grid.cells) == {(i, j) for i in range(-7, 8) for j in range(-7, 8)}
    assert grid.graph.number_of_edges() == 2 * 15 * 14


def test_ground_that_was_not_seen_is_not_free() -> None:
    grid = plan_of(*floor(without={(0, 0)})).navigation_grid()
    missing = {(i, j) for i in range(-7, 8) for j in range(-7, 8)} - set(grid.cells)
    # the middle of that column, (0.025, 0.025) m, is .035 m from cell (0, 0) and .226 m from (1, 0) and (0, 1)
    assert missing == {(0, 0)}


def test_obstacles_block_within_the_agents_radius_and_cut_the_steps_beside_them() -> None:
    # a post 0.125 m left of the middle between the cells (0, 0) and (1, 0), too far from both to block them
    post = [(2, 4, layer, "Pole") for layer in range(1, 20)]  # its middle is at (0.125, 0.225) m
    grid = plan_of(*floor(), *post).navigation_grid()
    # (0, 0): .257 m away; (0, 1): .127 m; (1, 1): .127 m; half-way from (0, 0) to (1, 0): .225 m
    assert {(0, 0), (1, 0)} <= set(grid.cells)
    assert grid.graph.has_edge((0, 0), (1, 0))
    assert {(0, 1), (1, 1)} & set(grid.cells) == set()
    nearer = [(2, 3, layer, "Pole") for layer in range(1, 20)]  # (0.125, 0.175): .215 m from both, .175 m from between
    grid = plan_of(*floor(), *nearer).navigation_grid()
    assert {(0, 0), (1, 0)} <= set(grid.cells)
    assert not grid.graph.has_edge((0, 0), (1, 0))


def wall(gap: range) -> list[tuple[int, int, int, str]]:
    """A wall at x = 0.1 m, with a gap."""
    return [(2, j, 20, "structure") for j in range(-40, 40) if j not in gap]


def test_the_shortest_path_leads_through_the_gap_in_a_wall() -> None:
    grid = plan_of(*floor(), *wall(gap=range(24, 36))).navigation_grid()  # 1.2 .. 1.8 m
    path = shortest_path(grid, (-3, 0), (4, 0))
    assert path[0] == (-3, 0)
    assert path[-1] == (4, 0)
    # up to 1.5 m, through, and down: 7 cells across and 2 * 6 along
    assert len(path) == 7 + 12 + 1
    assert all(abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1 for a, b in pairwise(path))


def test_the_part_behind_a_wall_is_another_grid() -> None:
    plan = plan_of(*floor(), *wall(gap=range(0)))
    left, right = plan.navigation_grid(), plan.navigation_grid(near=(5, 0))
    assert max(i for i, _ in left.cells) < 0 < min(i for i, _ in right.cells)
    assert left.other_parts == (len(right.cells),)
    with pytest.raises(NoPathError, match=r"\(5, 0\) is not a reachable cell"):
        shortest_path(left, (-5, 0), (5, 0))


def test_without_any_ground_there_is_no_cell() -> None:
    assert plan_of((0, 0, 10, "Table")).navigation_grid(near=(0, 0)).cells == ()


# ---- real rooms: `python -m pytest -k rooms -s` prints the numbers


@pytest.fixture(scope="module", params=["FloorPlan301", "FloorPlan405"])
def explored(request: pytest.FixtureRequest) -> tuple[str, VoxelMap, ReachableGrid, dict[str, list]]:
    """A room after a walk of 24 frames: its map, the true grid, and the boxes of the objects by type."""
    with World(load_scene(request.param)) as world:
        world.settle()
        view, grid = WorldView(world), reachable_grid(world)
        voxels = VoxelMap.of_scene(world.scene)
        types = [world.type_of(object_id) for object_id in world.ids]
        for frame in walk(view, grid, grid.cells[0], WalkSettings(), np.random.default_rng(0)):
            millimetres = np.round(frame.observation.depth * 1000) / 1000  # as frames are stored
            voxels.add(millimetres, frame.observation.objects, types, frame.camera)
        boxes: dict[str, list] = {}
        for record in object_metadata(world).values():
            boxes.setdefault(record.type, []).append(record.box)
        return request.param, voxels, grid, boxes


def share_inside(voxels: VoxelMap, boxes: dict[str, list]) -> float:
    """Share of the voxels labelled with a type whose centre is in, or a voxel from, the box of an object of that type."""
    sparse, margin = voxels.to_sparse(), voxels.voxel_m
    centres = (sparse.coordinates + 0.5) * voxels.voxel_m + [0.0, 0.0, voxels.floor_z - FLOOR_SLACK_M]
    is_inside = np.zeros(len(centres), dtype=bool)
    for label, name in enumerate(sparse.names):
        for box in boxes.get(name, ()):
            low, high = np.array(box[:3]) - margin, np.array(box[3:]) + margin
            is_inside |= (sparse.labels == label) & np.all((centres >= low) & (centres <= high), axis=1)
    return float(np.mean(is_inside[sparse.labels != 0]))


@pytest.mark.slow
def test_in_rooms_voxels_lie_in_the_boxes_of_their_types(explored) -> None:
    name, voxels, _, boxes = explored
    share = share_inside(voxels, boxes)
    print(f"\n{name}: {len(voxels.to_sparse().labels)} voxels, {share:.2%} of those of objects in their boxes")
    assert share >= 0.95
    # and the measure can tell: boxes half a metre off, or of the wrong types, hold far fewer
    shifted = {kind: [np.add(box, 0.5) for box in found] for kind, found in boxes.items()}
    assert share_inside(voxels, shifted) < 0.6
    rotated = dict(zip(boxes, [*list(boxes.values())[1:], next(iter(boxes.values()))], strict=True))
    assert share_inside(voxels, rotated) < 0.4


def test_in_rooms_the_floor_is_one_layer_of_voxels(explored) -> None:
    _, voxels, _, _ = explored
    sparse = voxels.to_sparse()
    layers = sparse.coordinates[sparse.labels == sparse.names.index("Floor"), 2]
    assert np.mean(layers == 0) > 0.99


def test_in_rooms_the_navigation_grid_is_the_true_one_but_for_a_few_cells(explored) -> None:
    name, voxels, truth, _ = explored
    plan, found = voxels.plan(), set[tuple[int, int]]()
    parts = 0
    for cell in truth.cells:  # voxels may close a passage that is hardly wider than the agent, as in FloorPlan301
        if cell not in found:
            found |= set(plan.navigation_grid(near=cell).cells)
            parts += 1
    both, either = found & set(truth.cells), found | set(truth.cells)
    print(f"\n{name}: navigation IoU {len(both) / len(either):.3f}, {len(found - both)} cells too many")
    assert len(both) / len(either) >= 0.85
    assert parts <= 1 + 0.05 * len(truth.cells)


@pytest.mark.slow
def test_a_picture_of_the_plan_shows_types_path_and_legend(explored, tmp_path: Path) -> None:
    _, voxels, truth, _ = explored
    plan = voxels.plan()
    bare = draw_plan(plan, voxel_px=6)
    assert bare.shape[0] == plan.labels.shape[1] * 6 + 20
    assert bare.shape[1] > plan.labels.shape[0] * 6 + 190
    # as many colours as types in view, with unknown ground and the text
    shown = {name for label, name in enumerate(plan.names) if np.any(plan.labels == label)}
    assert len(np.unique(bare.reshape(-1, 3), axis=0)) >= 0.95 * len(shown)
    start, goal = truth.cells[0], truth.cells[-1]
    drawn = draw_plan(plan, grid=truth, path=shortest_path(truth, start, goal), title="A room")

    def color_at(x_m: float, y_m: float) -> tuple[int, ...]:
        left, low = np.array(plan.corner) * plan.voxel_m
        right_px = 10 + (x_m - left) / plan.voxel_m * 6
        down_px = 28 + plan.labels.shape[1] * 6 - (y_m - low) / plan.voxel_m * 6
        return tuple(drawn[round(down_px), round(right_px)].tolist())

    assert color_at(*truth.position(start)) == PATH_COLOR
    assert color_at(*truth.position(goal)) == PATH_COLOR
    assert not np.any(np.all(bare == PATH_COLOR, axis=-1))
    assert cv2.imwrite(str(tmp_path / "map.png"), drawn)
