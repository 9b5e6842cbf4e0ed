import math

import numpy as np
import pytest

from remqa_data.agents.knowledge.instance import Instance, choose_instance
from remqa_data.agents.knowledge.outlook import frontality, is_in_the_way, outlooks, points_of
from remqa_data.language.referring import program_of
from tests.helpers.room_records import thing
from tests.helpers.walked_rooms import memory_of

BOUNDS = (-1.5, -2.0, 1.5, 0.5)
FRIDGE = thing("Fridge|1", (0.0, 0.1, 0.0), (0.8, 0.8, 1.8))


def share_from(cell: tuple[int, int], *others) -> float:
    """What should be seen of the fridge from a cell, at best."""
    memory = memory_of([FRIDGE, *others], BOUNDS)
    instance = choose_instance(program_of("the fridge"), memory)
    return max(look.share for look in outlooks(instance, memory, memory.plan.navigation_grid(), [cell]))


def test_most_is_seen_from_straight_ahead() -> None:
    assert share_from((0, -6)) > share_from((-5, -4)) > 0


@pytest.mark.slow
def test_what_stands_between_hides() -> None:
    screen = thing("ShowerCurtain|1", (0.0, -0.8, 0.0), (2.0, 0.1, 1.9))
    assert share_from((0, -6), screen) < 0.2 * share_from((0, -6))


def test_a_pose_looks_towards_the_object() -> None:
    memory = memory_of([FRIDGE], BOUNDS)
    instance = choose_instance(program_of("the fridge"), memory)
    best = max(outlooks(instance, memory, memory.plan.navigation_grid(), [(0, -5)]), key=lambda look: look.share)
    assert best.pose.yaw_deg == 90


def test_points_are_those_of_the_labelled_voxels_in_the_box() -> None:
    other = thing("Fridge|2", (1.2, -1.5, 0.0), (0.4, 0.4, 1.0))
    memory = memory_of([FRIDGE, other], BOUNDS)
    points = points_of(choose_instance(program_of("the fridge"), memory_of([FRIDGE], BOUNDS)), memory)
    assert len(points) > 20
    assert np.all(points[:, 0] < 0.5)


def test_an_object_without_labelled_voxels_is_looked_for_in_all_of_its_box() -> None:
    unseen = Instance("Mug", (0.0, -1.0, 0.5, 0.1, -0.9, 0.6), None, "graph")
    points = points_of(unseen, memory_of([FRIDGE], BOUNDS))
    assert points.min(axis=0).tolist() == [0.0, -1.0, 0.5]
    assert points.max(axis=0) == pytest.approx([0.1, -0.9, 0.6])


def test_who_stands_before_the_front_stands_squarely() -> None:
    cupboard = Instance("Cabinet", (-0.5, -0.5, 0.0, 0.5, 0.5, 1.0), 270.0, "graph")
    assert frontality(cupboard, (0.0, -2.0)) == pytest.approx(1.0)
    assert frontality(cupboard, (1.0, -1.0)) == pytest.approx(math.cos(math.radians(45.0)))
    assert frontality(cupboard, (2.0, -1.0)) == 0.0  # 63 degrees
    assert frontality(cupboard, (0.0, 2.0)) == 0.0
    assert frontality(Instance("Stool", cupboard.box, None, "graph"), (0.0, 2.0)) == 1.0


def test_a_drawer_slides_out_to_its_front_by_nine_tenths_of_its_depth() -> None:
    drawer = Instance("Drawer", (-0.25, -0.25, 0.3, 0.25, 0.25, 0.5), 270.0, "graph")  # to y = -0.7
    assert is_in_the_way(drawer, (0.0, -0.85), 0.2)
    assert not is_in_the_way(drawer, (0.0, -0.95), 0.2)
    assert not is_in_the_way(drawer, (0.5, -0.5), 0.2)


def test_a_door_needs_its_width_before_the_front_and_two_doors_half_of_it() -> None:
    fridge = Instance("Fridge", (-0.35, -0.3, 0.0, 0.35, 0.3, 1.8), 270.0, "graph")  # to y = -1.0
    assert is_in_the_way(fridge, (0.0, -1.15), 0.2)
    assert not is_in_the_way(fridge, (0.0, -1.25), 0.2)
    assert not is_in_the_way(fridge, (0.6, -0.6), 0.2)
    wide = Instance("Fridge", (-0.5, -0.3, 0.0, 0.5, 0.3, 1.8), 270.0, "graph")  # to y = -0.8
    assert is_in_the_way(wide, (0.0, -0.95), 0.2)
    assert not is_in_the_way(wide, (0.0, -1.05), 0.2)
    assert not is_in_the_way(Instance("Box", wide.box, 270.0, "graph"), (0.0, -0.5), 0.2)
