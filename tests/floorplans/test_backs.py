"""Floor behind what hangs on inner walls: none, where nothing was recorded."""

import numpy as np
import pytest

from remqa_data.floorplans.ithor.backs import behind_walls
from remqa_data.floorplans.ithor.extent import recorded_extent
from remqa_data.floorplans.ithor.table import RecordedObject, parse_row, recorded_objects
from tests.floorplans.test_table import row

BOUNDS = (0.0, 0.0, 6.0, 5.0)


def thing(
    kind: str, low: tuple[float, float], high: tuple[float, float], yaw: float = 0.0, **changes
) -> RecordedObject:
    """A thing from 1.0 to 1.8 m; yaw 0 looks along y, 90 along x."""
    (x0, y0), (x1, y1) = low, high
    box = {"aabb_cx": (x0 + x1) / 2, "aabb_cz": (y0 + y1) / 2, "aabb_sx": x1 - x0, "aabb_sz": y1 - y0}
    told = {"objectType": kind, "rot_y": yaw, "pickupable": False, "aabb_cy": 1.4, "aabb_sy": 0.8} | changes
    return parse_row(row(**box, **told), kind)


BED = thing("Bed", (2.0, 1.0), (4.0, 3.0))
MIRROR = thing("Mirror", (2.0, 3.5), (4.0, 3.6))


def test_the_floor_behind_a_mirror_is_none_if_all_things_are_before_it() -> None:
    assert behind_walls([MIRROR, BED], BOUNDS) == [pytest.approx((1.85, 3.6, 4.15, 5.0))]


def test_a_room_with_things_on_both_sides_of_a_mirror_stays_whole() -> None:
    behind = thing("Chair", (2.8, 4.2), (3.2, 4.6))
    assert behind_walls([MIRROR, BED, behind], BOUNDS) == []


def test_a_light_switch_that_looks_the_other_way_says_that_there_is_a_room() -> None:
    switch = thing("LightSwitch", (4.5, 3.58), (4.6, 3.6), yaw=0.0)
    assert behind_walls([MIRROR, BED, switch], BOUNDS) == []
    turned = thing("LightSwitch", (4.5, 3.58), (4.6, 3.6), yaw=180.0)
    assert behind_walls([MIRROR, BED, turned], BOUNDS) == [pytest.approx((1.85, 3.6, 4.75, 5.0))]


def test_nobody_walks_behind_a_fridge() -> None:
    fridge = thing("Fridge", (0.0, 2.0), (0.8, 3.0), yaw=90.0)
    moved = thing("Fridge", (1.5, 2.0), (2.3, 3.0), yaw=90.0)
    assert behind_walls([fridge], BOUNDS) == []
    assert behind_walls([moved], BOUNDS) == [pytest.approx((0.0, 1.85, 1.5, 3.15))]


def test_a_wall_goes_on_to_a_near_corner_unless_something_is_there() -> None:
    mirror = thing("Mirror", (2.0, 3.5), (5.2, 3.6))
    assert behind_walls([mirror, BED], BOUNDS)[0][2] == 6.0
    lamp = thing("FloorLamp", (5.5, 4.3), (5.8, 4.6))
    assert behind_walls([mirror, BED, lamp], BOUNDS)[0][2] == pytest.approx(5.35)


@pytest.mark.parametrize("name", ["FloorPlan311", "FloorPlan325", "FloorPlan218", "FloorPlan204"])
def test_what_is_behind_walls_is_no_floor_and_nothing_recorded_stands_there(name: str) -> None:
    rows = recorded_objects(name)
    floor = next(o for o in rows if o.type == "Floor")
    _, notches = recorded_extent(rows, floor)
    assert notches
    for x0, y0, x1, y1 in notches:
        middles = {o.id: (o.low + o.high)[:2] / 2 for o in rows if o is not floor}
        assert [i for i, m in middles.items() if np.all(m > [x0, y0]) and np.all(m < [x1, y1])] == []


def test_a_room_reaches_as_far_as_the_windows_in_its_walls() -> None:
    """The glass doors of this kitchen end at x = -4.13; the first thing east of that is at -2.4."""
    rows = recorded_objects("FloorPlan10")
    (west, *_), _ = recorded_extent(rows, next(o for o in rows if o.type == "Floor"))
    assert west < -4.1
