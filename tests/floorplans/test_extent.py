"""How far rooms reach: their floor ends where their things end."""

import numpy as np
import pytest

from remqa_data.floorplans.ithor.extent import recorded_extent
from remqa_data.floorplans.ithor.scenes import understood
from remqa_data.floorplans.ithor.table import recorded_objects, scene_names

TOUCH_M = 0.002
"""What hangs on a wall may be recorded this deep in it."""


def extent_of(name: str):
    rows = recorded_objects(name)
    return rows, recorded_extent(rows, next(o for o in rows if o.type == "Floor"))


@pytest.mark.parametrize("name", scene_names()[::6])
def test_a_room_ends_at_its_walls_or_a_step_behind_its_last_things(name: str) -> None:
    rows, ((x0, y0, x1, y1), _) = extent_of(name)
    things = [o for o in rows if o.type != "Floor"]
    low, high = np.min([o.low[:2] for o in things], axis=0), np.max([o.high[:2] for o in things], axis=0)
    assert np.all(low - [x0, y0] <= 0.61)
    assert np.all([x1, y1] - high <= 0.61)


WITH_NOTCHES = ("FloorPlan311", "FloorPlan324")


@pytest.mark.parametrize("name", [*scene_names()[::6], "FloorPlan210", *WITH_NOTCHES])
def test_nothing_was_recorded_in_a_corner_that_is_missing(name: str) -> None:
    rows, (_, notches) = extent_of(name)
    assert rows
    assert notches or name not in WITH_NOTCHES
    for x0, y0, x1, y1 in notches:
        inside = [
            o.id
            for o in rows
            if o.type != "Floor"
            and np.all(o.high[:2] > [x0 + TOUCH_M, y0 + TOUCH_M])
            and np.all(o.low[:2] < [x1 - TOUCH_M, y1 - TOUCH_M])
        ]
        assert inside == []


@pytest.mark.parametrize(
    ("name", "most_m2"),
    [("FloorPlan311", 40), ("FloorPlan213", 42), ("FloorPlan212", 21), ("FloorPlan203", 60), ("FloorPlan404", 14)],
)
def test_floor_that_runs_on_behind_windows_and_half_walls_is_no_room(name: str, most_m2: float) -> None:
    """Of these floors AI2-THOR's agent cannot reach much; their plates measure 90, 87, 43, 86 and 21 square metres."""
    rows, ((x0, y0, x1, y1), notches) = extent_of(name)
    size = (next(o for o in rows if o.type == "Floor").size[:2]).prod()
    area = (x1 - x0) * (y1 - y0) - sum((c - a) * (d - b) for a, b, c, d in notches)
    assert area < most_m2 < 0.75 * size


def test_a_thing_that_was_left_at_the_origin_does_not_widen_its_room() -> None:
    rows, ((_, y0, x1, _), _) = extent_of("FloorPlan410")
    floor = next(o for o in rows if o.type == "Floor")
    assert x1 < floor.high[0] + 0.1
    assert y0 > floor.low[1] - 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["FloorPlan1", "FloorPlan3", "FloorPlan26", "FloorPlan29", "FloorPlan221", "FloorPlan425"]
)
def test_the_floor_is_where_things_stand_and_not_where_a_fridge_was_sunk_in(name: str) -> None:
    rows = recorded_objects(name)
    _, shell = understood(rows)
    bottoms = [float(o.low[2]) for o in rows if o.type in ("GarbageCan", "Stool", "Sofa", "Chair", "Plunger")]
    assert abs(np.median(bottoms) - shell.floor_z) < 0.03
    assert shell.floor_z == pytest.approx(float(next(o for o in rows if o.type == "Floor").high[2]))
