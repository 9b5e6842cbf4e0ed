"""Recorded boxes that cannot be taken as they are, and what is made of them."""

import numpy as np
import pytest

from remqa_data.floorplans.ithor.hosting import is_built_in, levels, pockets
from remqa_data.floorplans.ithor.plan import fit_shell
from remqa_data.floorplans.ithor.repairs import at_floor_level, repaired
from remqa_data.floorplans.ithor.table import recorded_objects


def by_id(objects):
    return {o.id: o for o in objects}


def test_shelves_end_under_the_top_of_their_furniture_and_under_the_next_shelf() -> None:
    """The shelves in this desk were recorded from 0.10, 0.31 and 0.51 m to 0.8 and more, the desk up to 0.74 m."""
    rows = recorded_objects("FloorPlan204")
    shelves = sorted((o for o in repaired(rows) if o.id.startswith("Shelf|-01.27")), key=lambda o: o.low[2])
    assert [round(float(o.low[2]), 2) for o in shelves] == [0.10, 0.31, 0.51]
    assert [float(o.high[2]) for o in shelves] == pytest.approx([0.308, 0.514, 0.711], abs=0.002)


def test_worktops_of_no_thickness_grow_downwards() -> None:
    name = "CounterTop|-01.35|+00.97|+02.95"
    recorded, made = (
        by_id(recorded_objects("FloorPlan425"))[name],
        by_id(repaired(recorded_objects("FloorPlan425")))[name],
    )
    assert made.high == pytest.approx(recorded.high)
    assert made.high[2] - made.low[2] == pytest.approx(0.02)
    assert made.size[2] == pytest.approx(0.02)


@pytest.mark.parametrize("scene", ["FloorPlan1", "FloorPlan316"])
def test_the_rest_stays_as_recorded(scene: str) -> None:
    rows = recorded_objects(scene)
    assert rows
    for row, made in zip(rows, repaired(rows), strict=True):
        assert np.array_equal(row.low, made.low), row.id
        assert np.array_equal(row.high, made.high), row.id


def test_the_floor_ends_where_things_stand() -> None:
    rows = recorded_objects("FloorPlan1")
    floor = at_floor_level(next(o for o in rows if o.type == "Floor"), 0.02)
    assert floor.high[2] == 0.02
    assert floor.low[2] < 0.0


def test_cabinets_on_a_wall_and_backs_of_toilets_say_where_the_wall_is() -> None:
    """The recorded floors reach 0.7 m and 1.7 m further than the cabinets and the toilet."""
    rows = recorded_objects("FloorPlan15")
    back = min(float(o.low[0]) for o in rows if o.type == "Cabinet")
    assert fit_shell(rows).bounds[0] == pytest.approx(back, abs=0.15)
    toilet = next(o for o in recorded_objects("FloorPlan422") if o.type == "Toilet")
    assert fit_shell(recorded_objects("FloorPlan422")).bounds[3] == pytest.approx(toilet.high[1], abs=0.1)


def test_a_sink_leaves_its_place_to_the_cabinets_that_carry_it() -> None:
    rows = recorded_objects("FloorPlan4")
    sink = next(o for o in rows if o.type == "Sink")
    beneath = [box for box in pockets(sink, rows) if box[5] < 0.3 * sink.size[2]]
    assert len(beneath) == 2


def test_stacked_cupboards_are_built_in_and_single_shelves_are_not() -> None:
    rows = recorded_objects("FloorPlan422")
    shelves = [o for o in rows if o.type == "Shelf"]
    assert shelves
    assert all(is_built_in(o, rows) for o in shelves)
    alone = [o for o in rows if o.type == "Toilet"]
    assert not is_built_in(alone[0], rows)


def test_levels_are_where_the_contents_rest() -> None:
    rows = recorded_objects("FloorPlan1")
    fridge = next(o for o in rows if o.type == "Fridge")
    inside = [float(o.low[2] - fridge.low[2]) for o in rows if fridge.id in o.parents]
    assert min(levels(fridge, rows)) == pytest.approx(min(inside), abs=0.01)
