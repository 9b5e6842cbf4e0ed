import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.catalog import object_type
from remqa_data.floorplans.ithor.placements import probability
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.arrangement.areas import Area, largest_rectangle
from remqa_data.generators.arrangement.fitting_types import fitting_types
from remqa_data.generators.arrangement.hiding_check import goal_camera, manipulated
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_places import hiding_places
from remqa_data.sim.arm.arm import HOME, Arm, ArmBase
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import reach_distance, reachable_grid
from remqa_data.sim.navigation.viewpoints import MIN_PIXELS, front_points, surface_points
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from tests.helpers.places import places_of

pytestmark = pytest.mark.slow

ROOMS = ("FloorPlan7", "FloorPlan205", "FloorPlan324", "FloorPlan417")


@pytest.fixture(scope="module", params=ROOMS)
def room(request: pytest.FixtureRequest) -> Iterator[tuple[WorldView, tuple[HidingPlace, ...]]]:
    scene = load_scene(request.param)
    with World(scene) as world:
        world.settle()
        for object_id in world.ids:
            if world.type_of(object_id) == "Box":
                world.open(object_id, 0.0)
        yield WorldView(world), places_of(request.param)


# ---- areas


# by hand: 0.40 m hold three things 0.12 m wide with 1 cm between them, and 0.30 m hold one 0.28 m deep
@pytest.mark.parametrize(
    ("size", "count"), [((0.12, 0.28, 0.05), 3), ((0.28, 0.12, 0.05), 3), ((0.1, 0.1, 0.2), 0), ((0.5, 0.1, 0.05), 0)]
)
def test_capacity_counts_rows(size: tuple[float, float, float], count: int) -> None:
    assert Area((0, 0, 0), 30.0, (0.2, 0.15), 0.1).capacity(size, 0.01) == count


@given(st.floats(-180, 180), st.floats(0.05, 0.5), st.floats(0.05, 0.5))
def test_spots_lie_in_their_area_and_do_not_overlap(yaw: float, half_x: float, half_y: float) -> None:
    area = Area((1.0, 2.0, 0.5), yaw, (half_x, half_y), 0.2)
    spots = area.spots(0.11)
    assert spots or 2 * min(half_x, half_y) < 0.11
    angle = math.radians(yaw)
    for i, spot in enumerate(spots):
        dx, dy = spot.position[0] - 1.0, spot.position[1] - 2.0
        along = dx * math.cos(angle) + dy * math.sin(angle)
        across = -dx * math.sin(angle) + dy * math.cos(angle)
        assert abs(along) + spot.radius_m <= half_x + 1e-9
        assert abs(across) + spot.radius_m <= half_y + 1e-9
        for other in spots[:i]:
            assert math.dist(spot.position, other.position) >= spot.radius_m + other.radius_m - 1e-9


@given(st.lists(st.lists(st.booleans(), min_size=5, max_size=5), min_size=1, max_size=5))
def test_the_largest_rectangle_is_the_largest(rows: list[list[bool]]) -> None:
    mask = np.array(rows)
    found = largest_rectangle(mask)
    sizes = [  # every rectangle there is
        (bottom - top + 1) * (right - left + 1)
        for top in range(len(mask))
        for bottom in range(top, len(mask))
        for left in range(5)
        for right in range(left, 5)
        if mask[top : bottom + 1, left : right + 1].all()
    ]
    if found is None:
        assert not sizes
    else:
        top, left, bottom, right = found
        assert mask[top : bottom + 1, left : right + 1].all()
        assert (bottom - top + 1) * (right - left + 1) == max(sizes)


# ---- places in rooms


@pytest.mark.slow
def test_rooms_have_places_of_each_manipulation() -> None:
    kitchen = [place.manipulation for place in places_of("FloorPlan7")]
    assert kitchen.count("Open") >= 4
    for name in ROOMS[1:]:
        assert sum(place.manipulation == "Open" for place in places_of(name)) >= 2
    every = [place.manipulation for name in ROOMS for place in places_of(name)]
    # one sees from afar, crouched, under most of what lies on a counter
    assert min(every.count("Pickup"), every.count("Move")) >= 2


@pytest.mark.slow
def test_what_is_done_can_be_done_and_hides_as_it_says(room: tuple[WorldView, tuple[HidingPlace, ...]]) -> None:
    view, places = room
    assert places
    for place in places:
        kind = object_type(view.world.type_of(place.object_id))
        assert {"Open": kind.openable, "Pickup": kind.pickupable, "Move": kind.moveable}[place.manipulation]
        assert place.relation == ("in" if place.manipulation == "Open" else "under")
        assert (place.move_to is not None) == (place.manipulation == "Move")
        assert place.spots


@pytest.mark.slow
def test_goals_stand_on_the_grid_see_the_object_and_reach_it(room: tuple[WorldView, tuple[HidingPlace, ...]]) -> None:
    view, places = room
    grid = reachable_grid(view.world)
    assert places
    for place in places:
        is_open = place.manipulation == "Open"
        points = front_points(view, place.object_id) if is_open else surface_points(view.world, place.object_id)
        for pose in (place.goal, *place.other_goals):
            assert pose.is_standing
            assert pose.cell in grid.graph
            assert min(reach_distance(grid.position(pose.cell), grid.floor_z, p) for p in points) <= AGENT.reach_m
        others = [o for o in view.world.ids if not view.world.state(o).is_fixed and o != place.object_id]
        assert others
        for other in others:
            view.hide(other)
        seen = view.pixels(place.goal.camera(grid))[view.world.ids.index(place.object_id)]
        for other in others:
            view.hide(other, False)
        assert seen >= MIN_PIXELS


def test_spots_are_in_view_after_the_manipulation(room: tuple[WorldView, tuple[HidingPlace, ...]]) -> None:
    view, places = room
    assert any(place.relation == "under" for place in places)
    for place in places:
        if place.relation == "under":
            with manipulated(view.world, view, place):
                x, y, depth = goal_camera(place).project([spot.position for spot in place.spots]).T
            assert np.all((depth > 0) & (x > 0) & (x < 300) & (y > 0) & (y < 300))


def test_what_is_revealed_is_in_view_from_before_the_front(
    room: tuple[WorldView, tuple[HidingPlace, ...]],
) -> None:
    view, places = room
    grid = reachable_grid(view.world)
    assert places
    for place in places:
        assert place.provable
        if place.manipulation == "Open":
            low, high = view.world.box(place.object_id)
            front = -view.world.state(place.object_id).matrix()[:2, 1]
            for pose in (place.goal, *place.other_goals):
                away = np.array(grid.position(pose.cell)) - (low + high)[:2] / 2
                assert away @ front >= np.linalg.norm(away) * np.linalg.norm(front) * (
                    math.cos(math.radians(60)) - 1e-6
                )


def test_what_is_moved_aside_moves_by_more_than_its_own_length(
    room: tuple[WorldView, tuple[HidingPlace, ...]],
) -> None:
    view, places = room
    assert places
    for place in places:
        if place.move_to is not None:
            state = view.world.state(place.object_id)
            shift = np.abs(state.matrix()[:3, :3].T @ np.subtract(place.move_to, state.position))
            assert np.any(shift >= view.world.assets[place.object_id].spec.size)


def test_equal_rooms_have_equal_places() -> None:
    assert tuple(hiding_places(load_scene("FloorPlan417"))) == places_of("FloorPlan417")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["FloorPlan4", "FloorPlan220", "FloorPlan308", "FloorPlan405"])
def test_every_hiding_place_is_reached_from_its_goal(name: str) -> None:
    scene = load_scene(name)
    places, missed = hiding_places(scene), []
    assert places
    with World(scene) as world:
        world.settle()
        arm = Arm(world)
        for place in places:
            i, j = place.goal.cell
            arm.state = HOME
            base = ArmBase(i * AGENT.step_m, j * AGENT.step_m, place.goal.yaw_deg, scene.floor_z)
            move = arm.reach_object(base, place.object_id)
            if not move.success:
                missed.append((place.object_id, move.error))
    assert missed == []


# ---- what fits


def test_priors_are_those_of_the_table() -> None:
    # placements.csv: 17 of 30 eggs lie in a fridge, 5 of 30 knives in a drawer
    assert probability("Egg", "Fridge", "kitchen") == pytest.approx(17 / 30, abs=1e-4)
    assert probability("Knife", "Drawer", "kitchen") == pytest.approx(5 / 30, abs=1e-4)
    assert probability("Egg", "Fridge", "bathroom") == 0.0


def test_weights_follow_the_priors_as_far_as_things_show_enough_pixels() -> None:
    full = 0
    for place in places_of("FloorPlan7"):
        for name, weight in fitting_types(place, "kitchen", 1):
            # what shows more than 1.5 times the 300 pixels aimed at is preferred no more
            most = (1 + probability(name, place.type, "kitchen")) * 1.5**2
            assert 0 < weight <= most + 1e-9
            full += weight == pytest.approx(most)
    assert full >= 1


def test_what_fits_is_found_there_and_pots_do_not_fit_under_a_book() -> None:
    fridge = next(place for place in places_of("FloorPlan7") if place.type == "Fridge")
    weights = dict(fitting_types(fridge, "kitchen", 1))
    assert weights
    assert weights.keys().isdisjoint({"Book", "CD", "CellPhone", "Fork"})
    book = next(place for place in places_of("FloorPlan318") if place.type == "Book")
    assert "Pot" not in dict(fitting_types(book, "kitchen", 1))


def test_fewer_types_fit_several_times() -> None:
    thrice = set()
    for place in places_of("FloorPlan7"):
        counts = [{name for name, _ in fitting_types(place, "kitchen", count)} for count in (1, 2, 3)]
        assert counts[0] >= counts[1] >= counts[2]
        thrice |= counts[2]
    assert thrice
