"""Furniture that is put somewhere, or taken away, with the drawers that it is made of and the chairs under it."""

import numpy as np
import pytest

from remqa_data.thor import Controller
from tests.thor.test_placing import poses, position

pytestmark = pytest.mark.slow

DRESSER = "Dresser|-01.33|+00.01|-00.75"


@pytest.fixture(scope="module")
def bedroom_controller():
    with Controller(scene="FloorPlan301") as controller:
        yield controller


@pytest.fixture
def bedroom(bedroom_controller):
    bedroom_controller.reset("FloorPlan301")
    return bedroom_controller


@pytest.mark.parametrize("action", ["PlaceObjectAtPoint", "TeleportObject", "SetObjectPoses"])
def test_furniture_goes_with_its_drawers(bedroom, action) -> None:
    start, world = bedroom.last_event, bedroom.server.session._simulator.room.world
    drawers = world.built_into(DRESSER)
    assert len(drawers) == 8
    before, record = {name: position(start, name) for name in (DRESSER, *drawers)}, start.get_object(DRESSER)
    there = {**record["position"], "x": record["position"]["x"] + 0.3}
    if action == "SetObjectPoses":
        wanted = [
            pose if pose["objectName"] != record["name"] else {**pose, "position": there} for pose in poses(start)
        ]
        event = bedroom.step(action, objectPoses=wanted)
    elif action == "TeleportObject":
        event = bedroom.step(action, objectId=DRESSER, position=there)
    else:
        box = record["axisAlignedBoundingBox"]
        floor = {**box["center"], "x": box["center"]["x"] + 0.3, "y": box["center"]["y"] - box["size"]["y"] / 2}
        event = bedroom.step(action, objectId=DRESSER, position=floor)
    assert event, event.metadata["errorMessage"]
    for name, (x, y, z) in before.items():
        assert position(event, name) == pytest.approx([x + 0.3, y, z], abs=0.003), name
    assert bedroom.step("SetObjectPoses", objectPoses=poses(start))
    assert {name: position(bedroom.last_event, name) for name in before} == {
        name: pytest.approx(there) for name, there in before.items()
    }


def test_a_table_is_moved_among_the_chairs_that_stand_under_it(bedroom_controller) -> None:
    """As recorded the chairs are 4 cm in the table; who moves it must not think that it is stuck, and lift it over them."""
    table = "DiningTable|-04.30|+00.01|-00.38"
    start = bedroom_controller.reset("FloorPlan203")
    record, depths = start.get_object(table), bedroom_controller.server.session._simulator.room.depths
    assert sum(depth > 0.03 for (name, _), depth in depths.items() if name == table) == 3
    along = {table, *record["receptacleObjectIds"]}
    for shift in (0.05, -0.05, 0.2):
        wanted = [
            {"objectId": o["objectId"], "position": dict(o["position"]), "rotation": o["rotation"]}
            for o in start.metadata["objects"]
            if o["pickupable"] or o["moveable"]
        ]
        for one in wanted:
            one["position"]["x"] += shift if one["objectId"] in along else 0.0
        event = bedroom_controller.step("SetObjectPoses", objectPoses=wanted)
        if shift == 0.2:  # the chairs' backs are there
            assert event.metadata["errorMessage"].startswith(f"the poses put {table} into Chair|")
            continue
        assert event, event.metadata["errorMessage"]
        x, y, z = position(start, table)
        assert position(event, table) == pytest.approx([x + shift, y, z], abs=0.021)
        assert event.get_object(table)["rotation"] == pytest.approx(record["rotation"], abs=0.1)


@pytest.mark.parametrize("action", ["RemoveFromScene", "DisableObject", "SetObjectPoses"])
def test_furniture_leaves_and_comes_back_with_its_drawers(bedroom, action) -> None:
    start, world = bedroom.step("ToggleMapView"), bedroom.server.session._simulator.room.world
    whole = {DRESSER, *world.built_into(DRESSER)}
    name = start.get_object(DRESSER)["name"]
    if action == "SetObjectPoses":
        event = bedroom.step(action, objectPoses=[pose for pose in poses(start) if pose["objectName"] != name])
    else:
        event = bedroom.step(action, objectId=DRESSER)
        on_it = start.get_object(DRESSER)["receptacleObjectIds"]
        assert {start.get_object(one)["objectType"] for one in on_it} == {"AlarmClock", "DeskLamp", "Statue"}
        assert all(position(event, one)[1] < 0.3 for one in on_it)
    ids = {o["objectId"] for o in start.metadata["objects"]}
    assert {o["objectId"] for o in event.metadata["objects"]} == ids - whole
    assert not np.array_equal(event.frame, start.frame)
    event = bedroom.step("SetObjectPoses", objectPoses=poses(start))
    assert event, event.metadata["errorMessage"]
    assert {o["objectId"] for o in event.metadata["objects"]} == ids
    for one in whole:
        assert position(event, one) == pytest.approx(position(start, one), abs=0.002)


def test_furniture_is_enabled_with_its_drawers(bedroom) -> None:
    start = bedroom.last_event
    desk = next(o["objectId"] for o in start.metadata["objects"] if o["objectType"] == "Dresser")
    on_it = start.get_object(desk)["receptacleObjectIds"]
    assert bedroom.step("RemoveFromScene", objectIds=on_it)  # else they fall to where it was
    assert bedroom.step("DisableObject", objectId=desk)
    event = bedroom.step("EnableObject", objectId=desk)
    assert event, event.metadata["errorMessage"]
    assert {o["objectId"] for o in start.metadata["objects"]} - {o["objectId"] for o in event.metadata["objects"]} == {
        *on_it
    }
