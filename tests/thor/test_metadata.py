"""The metadata against AI2-THOR's own: its schema, and what it recorded in FloorPlan1 (figures typed in by hand)."""

import copy
import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.floorplans.ithor.table import recorded_objects, unity_rotation
from remqa_data.sim.physics.world import World
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.objects import ObjectRecords
from tests.helpers.bare_rooms import first_of

SCHEMA = json.loads((Path(__file__).parent / "ai2thor_schema.json").read_text())
TYPES = {
    "bool": bool,
    "float": float,
    "str": str,
    "str|None": (str, type(None)),
    "list[str]|None": (list, type(None)),
    "dict": dict,
    "dict|None": (dict, type(None)),
}
ROUND_TRIP = (
    {"action": "Pass"},
    {"action": "MoveAhead", "moveMagnitude": 100.0},
    {"action": "RotateLeft"},
    {"action": "GetReachablePositions"},
    {"action": "PickupObject", "objectId": "Apple|-00.47|+01.15|+00.48", "forceAction": True},
    {"action": "OpenObject", "objectId": "Fridge|-02.10|+00.00|+01.07", "forceAction": True},
    {"action": "DropHandObject"},
)


def check(metadata: dict) -> None:
    assert set(metadata) == set(SCHEMA["event"])
    assert set(metadata["agent"]) == set(SCHEMA["agent"])
    assert metadata["objects"]
    for record in metadata["objects"]:
        assert set(record) == {name for names in SCHEMA["object"].values() for name in names}
        for kind, names in SCHEMA["object"].items():
            for name in names:
                assert isinstance(record[name], TYPES[kind]), (name, record[name])
        assert (record["receptacleObjectIds"] is not None) == record["receptacle"]
        assert (record["objectOrientedBoundingBox"] is not None) == (record["pickupable"] or record["moveable"])
        assert set(record["axisAlignedBoundingBox"]) == {"center", "size", "cornerPoints"}
        assert len(record["axisAlignedBoundingBox"]["cornerPoints"]) == 8
        assert 0 <= record["openness"] <= 1
    assert json.loads(json.dumps(metadata)) == metadata


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["default", "arm"])
def test_every_event_follows_the_schema(kitchen, mode) -> None:
    check(kitchen.reset(agentMode=mode, renderInstanceSegmentation=True).metadata)
    for action in ROUND_TRIP:
        request = {k: v for k, v in action.items() if mode == "default" or k not in ("objectId", "forceAction")}
        if mode == "arm" and action["action"] == "OpenObject":
            request = action
        check(kitchen.step(**request).metadata)


def test_the_arm_follows_the_schema(armed) -> None:
    arm = armed.last_event.metadata["arm"]
    assert set(arm) == set(SCHEMA["arm"])
    assert [joint["name"] for joint in arm["joints"]] == [f"robot_arm_{k}_jnt" for k in (1, 2, 3, 4)]
    for joint in arm["joints"]:
        assert set(joint["position"]) == set("xyz")
        assert set(joint["rotation"]) == set("xyzw")


@pytest.mark.parametrize(
    ("object_id", "position", "rotation_y", "parent"),
    [
        ("Fridge|-02.10|+00.00|+01.07", (-2.097, 0.0, 1.072), 90.0, "Floor|+00.00|+00.00|+00.00"),
        ("StoveBurner|-00.04|+00.92|-02.37", (-0.0361, 0.9151, -2.3722), 0.0, None),
        ("Book|+00.15|+01.10|+00.62", (0.155, 1.0993, 0.617), 315.8263, "CounterTop|-00.08|+01.15|00.00"),
    ],
)
def test_objects_are_where_ai2thor_recorded_them(kitchen, object_id, position, rotation_y, parent) -> None:
    record = kitchen.last_event.get_object(object_id)
    assert tuple(record["position"].values()) == pytest.approx(position, abs=0.005)
    assert record["rotation"]["y"] == pytest.approx(rotation_y, abs=1.0)
    if parent is not None:
        assert record["parentReceptacles"] == [parent]
        assert object_id in kitchen.last_event.get_object(parent)["receptacleObjectIds"]


def yaw_off(record, row) -> float:
    """Degrees between two rotations in AI2-THOR's frame."""
    told = unity_rotation(tuple(record["rotation"].values()))
    turn = told.T @ unity_rotation(row.angles)
    return float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["FloorPlan1", "FloorPlan301"])
def test_rotations_are_those_that_ai2thor_recorded_whichever_side_is_the_front(name) -> None:
    """Cabinets, drawers and windows were made with their front on any side of their own frame."""
    with World(load_scene(name)) as world:
        records = ObjectRecords(world)
        records.update()
        told = {r["objectId"]: r for r in records.listing((0, 0, 0), (), (0, 0, 0), None)}
        for row in recorded_objects(name):
            assert yaw_off(told[row.id], row) < 0.05, row.id
        drawer = first_of(world, "Drawer")
        before = told[drawer]["rotation"]["y"]
        x, y, z, w = world.state(drawer).quaternion
        half = 0.5**0.5
        world.move(
            drawer, world.state(drawer).position, (half * (x + y), half * (y - x), half * (z + w), half * (w - z))
        )
        records.update()
        turned = records.listing((0, 0, 0), (), (0, 0, 0), {drawer})[0]["rotation"]["y"]
        assert (before - turned) % 360 == pytest.approx(90, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "height"), [("FloorPlan1", 0.901), ("FloorPlan3", 1.124), ("FloorPlan12", 0.98), ("FloorPlan221", 0.998)]
)
def test_the_agent_stands_on_the_floor_of_its_room_wherever_that_is(name, height) -> None:
    """Heights as AI2-THOR 5 recorded them."""
    scene = load_scene(name)
    room = SimpleNamespace(world=SimpleNamespace(scene=scene))
    assert LoadedFloorPlan.agent_y.fget(room) == pytest.approx(height, abs=0.003)


def test_facts_of_one_object(kitchen) -> None:
    book = kitchen.last_event.get_object("Book|+00.15|+01.10|+00.62")
    assert (book["mass"], book["salientMaterials"], book["objectType"]) == (0.5, ["Paper"], "Book")
    assert book["pickupable"]
    assert not book["moveable"]
    size = book["axisAlignedBoundingBox"]["size"]
    assert (size["x"], size["y"], size["z"]) == pytest.approx((0.5339, 0.062, 0.5321), abs=0.02)


def test_the_agent_is_described_as_in_ai2thor(kitchen) -> None:
    metadata = kitchen.last_event.metadata
    assert metadata["sceneName"] == "FloorPlan1_physics"
    assert metadata["agent"]["position"]["y"] == 0.900999
    assert metadata["agent"]["rotation"]["x"] == metadata["agent"]["rotation"]["z"] == 0.0
    assert metadata["agent"]["isStanding"] is True
    assert metadata["cameraPosition"]["y"] == pytest.approx(1.576, abs=0.05)
    assert metadata["errorCode"] is None
    assert metadata["fov"] == 90.0


def test_distance_is_from_the_middle_of_the_agent_to_the_pivot(kitchen) -> None:
    event = kitchen.step("RotateRight")
    here = event.metadata["agent"]["position"]
    assert event.metadata["objects"]
    for record in event.metadata["objects"]:
        there = record["position"]
        expected = sum((here[axis] - there[axis]) ** 2 for axis in "xyz") ** 0.5
        assert record["distance"] == pytest.approx(expected, abs=1e-9)


def test_events_share_nothing_that_can_be_changed(kitchen) -> None:
    kept, spoilt = kitchen.step("Pass"), kitchen.step("Pass")
    known = copy.deepcopy(kept.metadata["objects"])
    containers = [
        value for record in spoilt.metadata["objects"] for value in record.values() if isinstance(value, dict | list)
    ]
    assert len(containers) > 4 * len(known)
    for container in containers:
        for inner in container.values() if isinstance(container, dict) else []:
            if isinstance(inner, dict | list):
                inner.clear()
        container.clear()
    for record in spoilt.metadata["objects"]:
        record["visible"] = "spoilt"
    assert kept.metadata["objects"] == known
    assert kitchen.step("Pass").metadata["objects"] == known


def test_what_is_held_is_in_the_hand(kitchen) -> None:
    apple = "Apple|-00.47|+01.15|+00.48"
    event = kitchen.step("PickupObject", objectId=apple, forceAction=True)
    record = event.get_object(apple)
    hand = event.metadata["heldObjectPose"]["position"]
    assert record["isPickedUp"]
    assert record["parentReceptacles"] is None
    assert record["axisAlignedBoundingBox"]["center"] == pytest.approx(hand)
    assert event.metadata["inventoryObjects"] == [{"objectId": apple, "objectType": "Apple"}]
    moved = kitchen.step("RotateLeft")
    assert moved.get_object(apple)["position"] != record["position"]


def test_metadata_of_some_objects_are_those_of_the_event(kitchen) -> None:
    event = kitchen.step("PickupObject", objectId="Mug|-01.76|+00.90|-00.62", forceAction=True)
    some = [record["objectId"] for record in event.metadata["objects"]][40:20:-4]
    some.append("Mug|-01.76|+00.90|-00.62")
    wanted = [event.get_object(object_id) for object_id in some]
    assert len(wanted) == 6
    kitchen.step("SetObjectFilter", objectIds=[])
    event = kitchen.step("GetObjectMetadata", objectIds=some)
    assert event.metadata["actionReturn"] == wanted
    assert event.metadata["objects"] == []
    assert kitchen.step("GetObjectMetadata", objectIds=[]).metadata["actionReturn"] == []
    kitchen.step("RemoveFromScene", objectId=some[0])
    kitchen.step("ResetObjectFilter")
    event = kitchen.step("GetObjectMetadata", objectIds=[*some[:2], "Mugg"])
    assert [record["objectId"] for record in event.metadata["actionReturn"]] == some[1:2]
    event = kitchen.step("GetObjectMetadata")
    assert event.metadata["actionReturn"] == event.metadata["objects"]


def test_the_distance_of_an_object_is_to_its_box_in_plan(kitchen) -> None:
    fridge = "Fridge|-02.10|+00.00|+01.07"
    event = kitchen.step("Teleport", position={"x": -0.75, "y": 0.9, "z": 1.5}, rotation=0)
    assert event
    box = event.get_object(fridge)["axisAlignedBoundingBox"]
    beside, before = (abs(at - box["center"][axis]) - box["size"][axis] / 2 for axis, at in (("z", 1.5), ("x", -0.75)))
    assert before > 0.5
    event = kitchen.step("DistanceToObject", objectId=fridge)
    assert event.metadata["actionReturn"] == pytest.approx(math.hypot(max(beside, 0.0), before))


def test_filter(kitchen) -> None:
    some = [record["objectId"] for record in kitchen.last_event.metadata["objects"][:3]]
    event = kitchen.step("SetObjectFilter", objectIds=some)
    assert [record["objectId"] for record in event.metadata["objects"]] == some
    assert kitchen.step("SetObjectFilter", objectIds=[]).metadata["objects"] == []
    assert len(kitchen.step("ResetObjectFilter").metadata["objects"]) > 3


@pytest.mark.slow
def test_what_is_taller_than_the_space_it_stands_in_has_a_parent(kitchen) -> None:
    event = kitchen.reset("FloorPlan217")
    laptop, dresser = "Laptop|-04.87|+00.98|+03.44", "Dresser|-04.74|00.00|+02.60"
    assert event.get_object(laptop)["parentReceptacles"] == [dresser]
    assert laptop in event.get_object(dresser)["receptacleObjectIds"]
