"""What should show of the inside of a cupboard and of a drawer, worked out by hand."""

import math

import numpy as np
import pytest

from remqa_data.agents.knowledge.inside import POINTS, WALL_M, Inside, looks_inside
from remqa_data.agents.knowledge.instance import Instance, choose_instance
from remqa_data.geometry.types import Flags
from remqa_data.language.referring import program_of
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.room_records import thing
from tests.helpers.walked_rooms import memory_of

BOUNDS = (-1.5, -2.0, 1.5, 0.5)
BOX = (-0.4, -0.3, 0.0, 0.4, 0.5, 2.0)
"""0.8 m wide and deep, 2 m high."""
MIDDLE, UP = np.array([0.0, 0.1, 1.0]), np.array([0.0, 0.0, 3.0])
FACING = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


def inside(kind: str, facing_deg: float | None) -> Inside | None:
    return Inside.of(Instance(kind, BOX, facing_deg, "graph"))


@pytest.mark.parametrize("facing_deg", FACING)
def test_a_cupboard_is_looked_into_through_its_front(facing_deg: float) -> None:
    space = inside("Cabinet", facing_deg)
    ahead = np.array([*FACING[facing_deg], 0.0])
    assert space.shows_to(MIDDLE + 2 * ahead, space.points).all()  # straight from the front
    assert not space.shows_to(MIDDLE - 2 * ahead, space.points).any()
    assert not space.shows_to(MIDDLE + UP, space.points).any()  # from above
    aside = MIDDLE + 0.8 * ahead + 0.8 * np.array([-ahead[1], ahead[0], 0.0])
    shown = space.shows_to(aside, space.points)
    assert 0 < shown.mean() < 1  # past the near post
    across = (space.points - MIDDLE) @ np.array([-ahead[1], ahead[0], 0.0])
    assert across[shown].mean() < across[~shown].mean()  # what lies behind that post is hidden


@pytest.mark.parametrize("facing_deg", FACING)
def test_a_drawer_is_looked_into_from_above_where_it_has_slid_to(facing_deg: float) -> None:
    space = inside("Drawer", facing_deg)
    moved = space.points.mean(axis=0) - MIDDLE
    assert moved[:2] @ FACING[facing_deg] == pytest.approx(0.9 * 0.8)
    assert space.shows_to(space.points.mean(axis=0) + UP, space.points).all()
    level = space.points.mean(axis=0) + 2 * np.array([*FACING[facing_deg], 0.0])
    assert not space.shows_to(level, space.points).any()  # its front hides it


def test_the_inside_begins_behind_walls() -> None:
    space = inside("Cabinet", 0.0)
    assert space.low == pytest.approx(np.array(BOX[:3]) + WALL_M)
    assert space.high == pytest.approx(np.array(BOX[3:]) - WALL_M)
    assert space.points.shape == (POINTS**3, 3)
    assert np.all((space.points > space.low) & (space.points < space.high))


def test_what_does_not_open_into_the_room_or_has_no_known_front_has_none() -> None:
    assert inside("GarbageCan", 0.0) is None
    assert inside("Cabinet", None) is None


def test_the_pixels_that_show_it_are_those_whose_depth_lies_within() -> None:
    space = inside("Cabinet", 270.0)
    camera = AgentPose((0, -8), 90).camera_above(0.0)  # its eye is at y = -2, and 1.6 m high

    def at(metres: float) -> Flags:
        return space.seen(np.full((300, 300), metres, dtype=np.float32), camera)

    assert not at(1.7).any()  # its front is at y = -0.3
    shown = at(2.0)
    assert shown[150, 150]
    wide = 300 * (0.8 - 2 * WALL_M) / (2 * 2.0 * math.tan(math.radians(camera.fov_deg / 2)))
    assert shown[150].sum() == pytest.approx(wide, abs=2)
    assert not at(0.0).any()  # where nothing is


@pytest.mark.slow
def test_most_should_show_from_before_it_and_near_it() -> None:
    memory = memory_of([thing("Fridge|1", (0.0, 0.1, 0.0), (0.8, 0.8, 1.8))], BOUNDS)
    fridge = choose_instance(program_of("the fridge"), memory)
    space = Inside.of(fridge)
    grid = memory.plan.navigation_grid()

    def best(cell: tuple[int, int]) -> float:
        return max(look.share for look in looks_inside(space, fridge, memory, grid, [cell]))

    assert best((0, -5)) > best((0, -7)) > best((5, -4)) >= 0
    screen = thing("ShowerCurtain|1", (0.0, -0.6, 0.0), (2.0, 0.1, 1.9))
    behind = memory_of([thing("Fridge|1", (0.0, 0.1, 0.0), (0.8, 0.8, 1.8)), screen], BOUNDS)
    looks = list(looks_inside(space, fridge, behind, grid, [(0, -5)]))
    assert looks
    assert all(look.share == 0 for look in looks)
