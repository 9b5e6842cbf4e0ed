"""A dresser of a room that was recorded, as a golden one: its drawers are recorded as objects of their own."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.sim.agent import handling
from remqa_data.sim.physics.world import World

DRESSER = "Dresser|-01.33|+00.01|-00.75"


@pytest.fixture
def bedroom():
    with World(load_scene("FloorPlan301")) as world:
        world.settle()
        yield world


def test_a_dresser_is_made_of_its_drawers_and_what_stands_about_is_made_of_nothing(bedroom) -> None:
    parts = bedroom.built_into(DRESSER)
    assert len(parts) == 8
    assert {bedroom.type_of(name) for name in parts} == {"Drawer"}
    others = [name for name in bedroom.ids if bedroom.type_of(name) not in ("Dresser", "Desk")]
    assert not any(bedroom.built_into(name) for name in others)


def test_open_drawers_are_parts_all_the_same() -> None:
    scene = load_scene("FloorPlan301")
    with World(scene.with_objects([replace(o, openness=float(o.type == "Drawer")) for o in scene.objects])) as world:
        assert len(world.built_into(DRESSER)) == 8


def test_what_goes_along_is_moved_as_one_with_what_lies_in_and_on_it(bedroom) -> None:
    parts = bedroom.built_into(DRESSER)
    before = {name: bedroom.state(name).matrix() for name in bedroom.ids}
    x, y, z = bedroom.state(DRESSER).position
    half = (0.0, 0.0, 1.0, 0.0)
    carried = bedroom.move(DRESSER, (x + 0.5, y, z + 0.2), half, along=parts)
    assert set(parts) < set(carried)
    assert any(bedroom.type_of(name) == "Statue" for name in carried)
    motion = bedroom.state(DRESSER).matrix() @ np.linalg.inv(before[DRESSER])
    for name in bedroom.ids:
        expected = motion @ before[name] if name in (DRESSER, *carried) else before[name]
        assert bedroom.state(name).matrix() == pytest.approx(expected, abs=1e-9), name


def test_furniture_is_let_down_to_the_floor_with_its_parts(bedroom) -> None:
    parts = bedroom.built_into(DRESSER)
    assert parts
    heights = {name: bedroom.box(name)[0, 2] for name in (DRESSER, *parts)}
    x, y, z = bedroom.state(DRESSER).position
    bedroom.move(DRESSER, (x + 0.3, y, z + 0.4), along=parts)
    handling.lower(bedroom, DRESSER)
    for name, height in heights.items():
        assert bedroom.box(name)[0, 2] == pytest.approx(height, abs=0.003)


def test_a_part_that_is_away_comes_back_to_where_its_furniture_is_by_then(bedroom) -> None:
    part, *others = bedroom.built_into(DRESSER)
    before = {name: bedroom.state(name).position for name in (part, *others)}
    bedroom.put_away(part)
    x, y, z = bedroom.state(DRESSER).position
    bedroom.move(DRESSER, (x + 0.5, y, z), along=(part, *others))
    assert part in bedroom.away
    bedroom.put_back(part, bedroom.away[part])
    assert not bedroom.away
    for name, (x, y, z) in before.items():
        assert bedroom.state(name).position == pytest.approx((x + 0.5, y, z))


def test_what_is_away_is_saved_and_each_thing_is_there_by_itself(bedroom) -> None:
    first = bedroom.save()
    some = bedroom.ids[:3]
    for name in some:
        bedroom.put_away(name)
        bedroom.put_away(name)  # is away already
    assert bedroom.away == {name: first.states[name] for name in some}
    boxes = [bedroom.box(name) for name in some]
    assert all(box[1, 2] < -900.0 for box in boxes)
    assert all(one[1, 0] < other[0, 0] for one, other in pairwise(boxes))
    away = bedroom.save()
    bedroom.restore(first)
    assert not bedroom.away
    bedroom.restore(away)
    assert bedroom.away.keys() == {*some}
    bedroom.restart(first)
    assert not bedroom.away
