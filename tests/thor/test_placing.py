import numpy as np
import pytest

from tests.helpers.thor_clients import first, first_id
from tests.thor.test_objects import APPLE, FRIDGE, ISLAND, STOOL, pose

pytestmark = pytest.mark.slow

TOASTER = "Toaster|-01.84|+00.90|+00.13"


def poses(event) -> list[dict]:
    """What SetObjectPoses is given to bring back a state."""
    loose = [o for o in event.metadata["objects"] if o["pickupable"] or o["moveable"]]
    return [{"objectName": o["name"], "position": o["position"], "rotation": o["rotation"]} for o in loose]


def position(event, object_id) -> list[float]:
    return list(event.get_object(object_id)["position"].values())


def assert_at_rest_and_apart(controller, object_ids) -> None:
    world = controller.server.session._simulator.room.world
    assert object_ids
    for name in object_ids:
        assert min((gap for _, gap in world.overlapping(name)), default=0.0) > -0.005, name
    rested = world.save()
    world.settle()
    moved = [np.subtract(world.state(name).position, rested.states[name].position) for name in world.ids]
    assert np.abs(moved).max() < 0.002


def test_poses_bring_an_earlier_state_back(kitchen) -> None:
    start = kitchen.last_event
    assert kitchen.step("SetObjectPoses", objectPoses=poses(start)).metadata["objects"] == start.metadata["objects"]
    kitchen.step("PlaceObjectAtPoint", objectId=STOOL, position={"x": 1.2, "y": 0.0, "z": 1.2})
    kitchen.step("PlaceObjectAtPoint", objectId=APPLE, position={"x": 0.5, "y": 1.13, "z": 1.0})
    kitchen.step("PickupObject", objectId="Bread|-00.52|+01.17|-00.03", forceAction=True)
    assert kitchen.last_event.metadata["inventoryObjects"]
    event = kitchen.step("SetObjectPoses", objectPoses=poses(start))
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []
    for record in start.metadata["objects"]:
        assert position(event, record["objectId"]) == pytest.approx(list(record["position"].values()), abs=0.002)
    assert position(event, STOOL) == position(start, STOOL)


def test_what_has_no_pose_leaves_the_scene(kitchen) -> None:
    start = kitchen.last_event
    apple = {"objectId": APPLE, "position": {"x": -0.35, "y": 1.6, "z": 0.46}, "rotation": {"x": 0, "y": 90, "z": 0}}
    event = kitchen.step("SetObjectPoses", objectPoses=[apple])
    assert event, event.metadata["errorMessage"]
    assert [o["objectId"] for o in event.metadata["objects"] if o["pickupable"] or o["moveable"]] == [APPLE]
    assert event.get_object(APPLE)["parentReceptacles"] == [ISLAND]  # it has fallen onto it
    assert_at_rest_and_apart(kitchen, [APPLE])
    assert not np.array_equal(event.frame, start.frame)
    assert "not in the scene" in kitchen.step("PickupObject", objectId=TOASTER).metadata["errorMessage"]
    event = kitchen.step("SetObjectPoses", objectPoses=poses(start))
    assert {o["objectId"] for o in event.metadata["objects"]} == {o["objectId"] for o in start.metadata["objects"]}


def test_poses_that_are_refused_change_nothing(kitchen) -> None:
    start, all_poses = kitchen.last_event, poses(kitchen.last_event)
    (bread,) = [p for p in all_poses if p["objectName"].startswith("Bread")]
    for wrong, words in (
        ([{**bread, "objectName": "Bread_1"}], "No Pickupable or Moveable object of name Bread_1 found in scene."),
        ([{**bread, "objectName": FRIDGE}], "No Pickupable or Moveable object"),
    ):
        event = kitchen.step("SetObjectPoses", objectPoses=wrong)
        assert words in event.metadata["errorMessage"]
        assert event.metadata["objects"] == start.metadata["objects"]
    with pytest.raises(ValueError, match=r"objectPoses\.0\.position"):
        kitchen.step("SetObjectPoses", objectPoses=[{"objectId": APPLE, "rotation": {"x": 0, "y": 0, "z": 0}}])


def test_what_cannot_be_found_is_told_and_the_rest_is_put_in_its_place(kitchen) -> None:
    (bread,) = [p for p in poses(kitchen.last_event) if p["objectName"].startswith("Bread")]
    event = kitchen.step("SetObjectPoses", objectPoses=[bread, {**bread, "objectName": "Bread_1"}])
    assert event.metadata["errorMessage"] == "No Pickupable or Moveable object of name Bread_1 found in scene."
    assert [o["name"] for o in event.metadata["objects"] if o["pickupable"]] == [bread["objectName"]]


def test_what_is_put_into_something_goes_to_where_there_is_room(kitchen) -> None:
    all_poses = poses(kitchen.last_event)
    (bread,) = [p for p in all_poses if p["objectName"].startswith("Bread")]
    apple = {**bread, "objectName": APPLE}
    for force in (False, True):
        event = kitchen.step("SetObjectPoses", objectPoses=[apple, bread], forceAction=force)
        assert event, event.metadata["errorMessage"]
        assert_at_rest_and_apart(kitchen, [APPLE, event.objects_by_type("Bread")[0]["objectId"]])
        assert np.linalg.norm(np.subtract(position(event, APPLE), list(bread["position"].values()))) < 0.6


def test_recorded_poses_that_are_a_little_off_are_no_obstacle(kitchen) -> None:
    rng = np.random.default_rng(0)
    loose = [o for o in kitchen.last_event.metadata["objects"] if o["pickupable"]]
    for _ in range(4):
        noisy = [
            {
                "objectName": o["name"],
                "position": {axis: value + rng.normal(0, 0.03) for axis, value in o["position"].items()},
                "rotation": o["rotation"],
            }
            for o in loose
        ]
        event = kitchen.step("SetObjectPoses", objectPoses=noisy, skipMoveable=True)
        assert event, event.metadata["errorMessage"]
        assert {o["name"] for o in event.metadata["objects"] if o["pickupable"]} == {o["name"] for o in loose}


def test_names_that_were_recorded_elsewhere_stand_for_objects_of_their_types(kitchen) -> None:
    """AI2-THOR's digits are not ours, and nothing else of a name says which object is meant."""
    loose = [o for o in kitchen.last_event.metadata["objects"] if o["pickupable"]]
    assert len({o["objectType"] for o in loose}) < len(loose)  # there are several of a type
    foreign = [
        {"objectName": f"{o['objectType']}_{number:08x}", "position": o["position"], "rotation": o["rotation"]}
        for number, o in enumerate(loose)
    ]
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    event = kitchen.step("SetObjectPoses", objectPoses=foreign, skipMoveable=True)
    assert event, event.metadata["errorMessage"]
    for o in loose:
        assert list(event.get_object(o["objectId"])["position"].values()) == pytest.approx(
            list(o["position"].values()), abs=0.002
        )
    mug = next(pose for pose in foreign if pose["objectName"].startswith("Mug"))
    event = kitchen.step("SetObjectPoses", objectPoses=[mug, {**mug, "objectName": "Mug_ffffffff"}])
    assert "Mug_ffffffff" in event.metadata["errorMessage"]  # one mug is no second one
    assert len(event.objects_by_type("Mug")) == 1
    event = kitchen.step("SetObjectPoses", objectPoses=[mug, mug])
    assert len(event.objects_by_type("Mug")) == 2


def test_an_object_with_several_poses_is_copied(kitchen) -> None:
    start = kitchen.last_event
    all_poses = poses(start)
    mug = start.objects_by_type("Mug")[0]
    (pose,) = [p for p in all_poses if p["objectName"] == mug["name"]]
    kitchen.step("DirtyObject", objectId=mug["objectId"], forceAction=True)
    kitchen.step("SetMassProperties", objectId=mug["objectId"], mass=3.0, drag=0.0, angularDrag=0.0)
    beside = [
        {
            **pose,
            "position": {**pose["position"], axis: pose["position"][axis] + 0.15},
            "rotation": {"x": 0, "y": turn, "z": 0},
        }
        for axis, turn in (("x", 90), ("z", 180))
    ]
    event = kitchen.step("SetObjectPoses", objectPoses=[*all_poses, *beside])
    assert event, event.metadata["errorMessage"]
    numbers = (len(all_poses), len(all_poses) + 1)
    copies = [event.get_object(f"{mug['objectId']}_copy_{number}") for number in numbers]
    assert [copy["name"] for copy in copies] == [f"{mug['name']}(Clone)_copy_{number}" for number in numbers]
    original = event.get_object(mug["objectId"])
    assert position(event, mug["objectId"]) == pytest.approx(list(mug["position"].values()), abs=0.002)
    for copy, wanted in zip(copies, beside, strict=True):
        assert list(copy["position"].values()) == pytest.approx(list(wanted["position"].values()), abs=0.01)
        assert copy["rotation"]["y"] == pytest.approx(wanted["rotation"]["y"], abs=1.0)
        assert copy["parentReceptacles"] == original["parentReceptacles"]
        assert all(
            copy[field] == original[field] for field in ("objectType", "assetId", "isDirty", "mass", "pickupable")
        )
        assert copy["isDirty"]
    assert_at_rest_and_apart(kitchen, [copy["objectId"] for copy in copies])
    again = kitchen.step("SetObjectPoses", objectPoses=[*all_poses, *beside])
    assert [o["objectId"] for o in again.metadata["objects"]] == [o["objectId"] for o in event.metadata["objects"]]
    alone = kitchen.step("SetObjectPoses", objectPoses=poses(again)[:-1])  # by the names that copies have
    assert len(alone.metadata["objects"]) == len(again.metadata["objects"]) - 1
    event = kitchen.step("PickupObject", objectId=copies[0]["objectId"], forceAction=True)
    assert event.metadata["inventoryObjects"] == [{"objectId": copies[0]["objectId"], "objectType": "Mug"}]
    assert len(kitchen.reset().metadata["objects"]) == len(start.metadata["objects"])


def test_a_pose_without_a_rotation_is_that_of_0_and_other_arguments_mean_nothing(kitchen) -> None:
    whole = [
        {**pose, "rotation": {"x": 0, "y": 0, "z": 0}} if "Apple" in pose["objectName"] else pose
        for pose in poses(kitchen.last_event)
    ]
    event = kitchen.step("SetObjectPoses", objectPoses=whole)
    assert event, event.metadata["errorMessage"]
    kitchen.reset()
    short = [{k: v for k, v in pose.items() if k != "rotation" or "Apple" not in pose["objectName"]} for pose in whole]
    again = kitchen.step("SetObjectPoses", objectPoses=short, forceRigidbodySleep=True, skipMoveable=True)
    assert again.metadata["objects"] == event.metadata["objects"]


def test_an_object_is_placed_where_there_is_room(kitchen) -> None:
    points = kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=ISLAND, anywhere=True).metadata["actionReturn"]
    assert len(points) > 100
    near = kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=ISLAND).metadata["actionReturn"]
    assert 0 < len(near) < len(points)
    assert all(point in points for point in near)
    for point in points[:: len(points) // 4]:
        event = kitchen.step("PlaceObjectAtPoint", objectId=APPLE, position=point)
        if event:
            box = event.get_object(APPLE)["axisAlignedBoundingBox"]
            assert box["center"]["y"] - box["size"]["y"] / 2 == pytest.approx(point["y"], abs=0.01)
            assert (box["center"]["x"], box["center"]["z"]) == pytest.approx((point["x"], point["z"]), abs=0.02)
            assert event.get_object(APPLE)["parentReceptacles"] == [ISLAND]
            assert_at_rest_and_apart(kitchen, [APPLE])
        else:
            assert "spawn area not clear" in event.metadata["errorMessage"]
    assert position(kitchen.last_event, APPLE) != position(kitchen.reset(), APPLE)


def test_furniture_falls_to_rest_and_stands_still(kitchen) -> None:
    event = kitchen.step(
        "PlaceObjectAtPoint",
        objectId=TOASTER,
        position={"x": 1.2, "y": 0.5, "z": 0.0},
        rotation={"x": 0, "y": 45, "z": 0},
    )
    assert event, event.metadata["errorMessage"]
    assert position(event, TOASTER)[1] < 0.05
    assert event.get_object(TOASTER)["rotation"]["y"] == pytest.approx(45.0, abs=1.0)
    assert kitchen.server.session._simulator.room.world.state(TOASTER).is_fixed
    assert_at_rest_and_apart(kitchen, [TOASTER])


def test_what_is_held_is_placed_too(kitchen) -> None:
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    event = kitchen.step("PlaceObjectAtPoint", objectId=APPLE, position={"x": 1.2, "y": 0.3, "z": 0.0})
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []
    assert position(event, APPLE)[1] < 0.1


def test_what_is_in_the_way_of_a_point(kitchen) -> None:
    start = kitchen.last_event
    box = start.get_object(FRIDGE)["axisAlignedBoundingBox"]
    front = {**box["center"], "x": box["center"]["x"] + box["size"]["x"] / 2}
    event = kitchen.step("PlaceObjectAtPoint", objectId=STOOL, position={**front, "y": 0.0})
    assert event.metadata["errorMessage"].startswith("spawn area not clear (")
    assert event.metadata["objects"] == start.metadata["objects"]
    event = kitchen.step("PlaceObjectAtPoint", objectId=FRIDGE, position={"x": 1.2, "y": 0.0, "z": 0.0})
    assert "neither pickupable nor moveable" in event.metadata["errorMessage"]


def test_points_above_a_receptacle(kitchen) -> None:
    kitchen.step("TeleportFull", **pose(-1.0, 0.5, 90, 30))
    anywhere = kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=ISLAND, anywhere=True).metadata[
        "actionReturn"
    ]
    near = kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=ISLAND, anywhere=False).metadata["actionReturn"]
    assert 0 < len(near) < len(anywhere)
    eye = np.array(list(kitchen.last_event.metadata["cameraPosition"].values()))
    assert all(np.linalg.norm(np.array(list(point.values())) - eye) <= 1.5 for point in near)
    assert (
        kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=FRIDGE, anywhere=True).metadata["actionReturn"]
        == []
    )
    assert not kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=APPLE)


@pytest.mark.parametrize("action", ["RemoveFromScene", "DisableObject"])
def test_what_is_removed_is_gone_and_comes_back(kitchen, action) -> None:
    start = kitchen.step("TeleportFull", **pose(-1.0, 0.5, 90, 30), renderInstanceSegmentation=True)
    assert APPLE in start.instance_masks
    gone = kitchen.step(action, objectId=APPLE, renderInstanceSegmentation=True)
    assert gone
    assert APPLE not in gone.instance_masks
    assert APPLE not in {o["objectId"] for o in gone.metadata["objects"]}
    assert not kitchen.step(action, objectId=APPLE)
    back = kitchen.step("EnableObject", objectId=APPLE)
    assert position(back, APPLE) == pytest.approx(position(start, APPLE), abs=0.001)
    assert np.array_equal(back.frame, start.frame)


def test_what_lay_on_what_is_removed_falls(kitchen) -> None:
    height = position(kitchen.last_event, APPLE)[1]
    event = kitchen.step("RemoveFromScene", objectId=ISLAND)
    assert position(event, APPLE)[1] < height - 0.01
    assert_at_rest_and_apart(kitchen, [APPLE])


def test_nothing_comes_back_into_something_else(kitchen) -> None:
    place = kitchen.last_event.get_object(APPLE)["position"]
    kitchen.step("DisableObject", objectId=APPLE)
    event = kitchen.step("PlaceObjectAtPoint", objectId="Bread|-00.52|+01.17|-00.03", position={**place, "y": 1.13})
    assert event, event.metadata["errorMessage"]
    assert "cannot come back: Bread" in kitchen.step("EnableObject", objectId=APPLE).metadata["errorMessage"]
    assert {o["objectId"] for o in kitchen.reset().metadata["objects"]} > {APPLE}


def test_teleports_an_object_to_where_there_is_room(kitchen) -> None:
    there = {"x": -0.35, "y": 1.25, "z": 0.2}
    event = kitchen.step("TeleportObject", objectId=APPLE, position=there, rotation={"x": 0, "y": 90, "z": 0})
    assert event, event.metadata["errorMessage"]
    assert position(event, APPLE)[::2] == pytest.approx([there["x"], there["z"]], abs=0.02)
    assert event.get_object(APPLE)["parentReceptacles"] == [ISLAND]
    before = event.metadata["objects"]
    event = kitchen.step("TeleportObject", objectId=APPLE, position={"x": -0.35, "y": 0.8, "z": 0.2})
    assert "is in the way" in event.metadata["errorMessage"]
    assert event.metadata["objects"] == before
    inside, above = {"x": -0.35, "y": 0.8, "z": 0.2}, {"x": -0.35, "y": 1.3, "z": -0.4}
    event = kitchen.step("TeleportObject", objectId=APPLE, positions=[inside, above], forceKinematic=True)
    assert event, event.metadata["errorMessage"]
    assert position(event, APPLE)[2] == pytest.approx(-0.4, abs=0.05)
    assert_at_rest_and_apart(kitchen, [APPLE])


def test_what_is_held_is_teleported_only_if_that_is_asked_for(kitchen) -> None:
    assert kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    there = {"x": -0.35, "y": 1.25, "z": 0.2}
    refused = kitchen.step("TeleportObject", objectId=APPLE, position=there)
    assert "Cannot teleport object in hand" in refused.metadata["errorMessage"]
    event = kitchen.step("TeleportObject", objectId=APPLE, position=there, allowTeleportOutOfHand=True)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []
    for wrong, text in ((FRIDGE, "is in the way"), ("Apple|9", "is not the objectId on any object")):
        assert text in kitchen.step("TeleportObject", objectId=wrong, position=there).metadata["errorMessage"]
    with pytest.raises(ValueError, match="missing the following arguments: position"):
        kitchen.step("TeleportObject", objectId=APPLE)


def test_what_is_built_in_stays_where_it_is_put(kitchen) -> None:
    start = kitchen.last_event
    fridge = start.get_object(FRIDGE)
    inside = fridge["receptacleObjectIds"]
    assert inside
    pose = {"position": fridge["position"], "rotation": fridge["rotation"]}
    event = kitchen.step("TeleportObject", objectId=FRIDGE, **pose)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["objects"] == start.metadata["objects"]
    away = {**fridge["position"], "x": fridge["position"]["x"] + 1.0}
    event = kitchen.step(
        "TeleportObject", objectId=FRIDGE, position=away, rotation=fridge["rotation"], forceAction=True
    )
    assert event, event.metadata["errorMessage"]
    assert position(event, FRIDGE) == pytest.approx(list(away.values()), abs=1e-4)
    assert event.get_object(FRIDGE)["receptacleObjectIds"] == inside
    for name in inside:
        assert position(event, name)[0] - position(start, name)[0] == pytest.approx(1.0, abs=0.05)


def test_nothing_is_put_out_of_the_room(kitchen) -> None:
    start = kitchen.last_event
    for action in ("PlaceObjectAtPoint", "TeleportObject"):
        event = kitchen.step(action, objectId=APPLE, position={"x": 50, "y": 1, "z": 0})
        assert event.metadata["errorMessage"] == "Position coordinate (50, 1, 0) is not within scene bounds"
        assert event.metadata["objects"] == start.metadata["objects"]
    for wrong in ([], None):
        assert "must not be empty" in kitchen.step("RemoveFromScene", objectIds=wrong or []).metadata["errorMessage"]


def test_what_is_sent_to_the_floor_stands_on_it(kitchen) -> None:
    event = kitchen.step("TeleportObjectToFloor", objectId=APPLE, x=1.2, z=0.0)
    assert event, event.metadata["errorMessage"]
    assert position(event, APPLE)[1] < 0.1
    assert (position(event, APPLE)[0], position(event, APPLE)[2]) == (
        pytest.approx(1.2, abs=0.1),
        pytest.approx(0, abs=0.1),
    )
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    refused = kitchen.step("TeleportObjectToFloor", objectId=APPLE, x=1.2, z=0.0)
    assert refused.metadata["errorMessage"] == "Cannot teleport object in hand."


def test_what_is_not_there_answers_no_question(kitchen) -> None:
    mug = first_id(kitchen, "Mug")
    assert kitchen.step("RemoveFromScene", objectId=mug)
    for action in ("DistanceToObject", "GetShortestPath", "GetVisibilityPoints", "GetInteractablePoses"):
        event = kitchen.step(action, objectId=mug)
        assert event.metadata["errorMessage"] == f"{mug} is not in the scene", action
        assert event.metadata["actionReturn"] is None
    event = kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=mug, anywhere=True)
    assert event.metadata["errorMessage"] == f"{mug} is not in the scene"


def test_a_load_that_leaves_with_what_holds_it_comes_back_to_where_it_was(kitchen) -> None:
    plate, fork = (first(kitchen, name) for name in ("Plate", "Fork"))
    centre = plate["axisAlignedBoundingBox"]["center"]
    assert kitchen.step("PlaceObjectAtPoint", objectId=fork["objectId"], position={**centre, "y": centre["y"] + 0.05})
    assert kitchen.step("PickupObject", objectId=plate["objectId"], forceAction=True)
    held = kitchen.last_event.get_object(fork["objectId"])["position"]
    assert kitchen.step("RemoveFromScene", objectIds=[plate["objectId"], fork["objectId"]])
    event = kitchen.step("EnableObject", objectId=fork["objectId"])
    assert abs(event.get_object(fork["objectId"])["position"]["y"] - held["y"]) < 3.0, event.metadata["errorMessage"]
