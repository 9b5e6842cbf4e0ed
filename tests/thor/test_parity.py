"""What actions take, return and say as AI2-THOR does it; each a line of its public sources or documentation."""

import math

import numpy as np
import pytest

from tests.helpers.thor_clients import first_id, stands_at
from tests.thor.test_objects import APPLE

pytestmark = pytest.mark.slow


def test_nobody_is_forced_through_a_wall(kitchen) -> None:
    corners = np.array(kitchen.last_event.metadata["sceneBounds"]["cornerPoints"])[:, [0, 2]]
    for turn in range(4):
        kitchen.step("Teleport", rotation=90 * turn)
        walked = [kitchen.step("MoveAhead", forceAction=True) for _ in range(40)]
        assert not walked[-1]
        assert (corners.min(axis=0) < stands_at(walked[-1])).all()
        assert (corners.max(axis=0) > stands_at(walked[-1])).all()
    assert kitchen.last_event.metadata["collided"]
    x, z = (round(math.sin(math.radians(angle)), 9) * 0.25 for angle in (270, 0))
    assert f"is blocking Agent 0 from moving by ({x:.4f}, 0.0000," in kitchen.last_event.metadata["errorMessage"]
    assert z == 0.0


@pytest.mark.parametrize(
    ("action", "arguments", "turned", "tilted"),
    [
        ("RotateRight", {"degrees": -30}, -30, 0),
        ("RotateLeft", {"degrees": 45}, -45, 0),
        ("RotateRight", {"degrees": 0}, None, None),
        ("LookDown", {"degrees": 0}, 0, 30),
        ("LookUp", {"degrees": 10, "foo": 1}, 0, -10),
        ("LookDown", {"degrees": -10}, None, None),
        ("MoveAhead", {"moveMagnitude": 0}, None, None),
        ("MoveAhead", {"moveMagnitude": -0.25}, None, None),
    ],
)
def test_numbers_mean_what_they_do_there(kitchen, action, arguments, turned, tilted) -> None:
    before = kitchen.step("TeleportFull", x=1.0, y=0.9, z=0.0, rotation=180, horizon=0, standing=True)
    event = kitchen.step(action, **arguments)
    agents = [e.metadata["agent"] for e in (before, event)]
    assert event.metadata["lastActionSuccess"] == (turned is not None)
    assert agents[0]["position"] == agents[1]["position"]
    difference = (agents[1]["rotation"]["y"] - agents[0]["rotation"]["y"] + 180) % 360 - 180
    assert difference == pytest.approx(turned or 0)
    assert agents[1]["cameraHorizon"] == pytest.approx(tilted or 0)


def test_arguments_that_are_known_there_are_taken(kitchen) -> None:
    kitchen.step("TeleportFull", x=1.0, y=0.9, z=0.0, rotation=0, horizon=0, standing=True)
    ways = ("MoveAhead", "MoveBack", "MoveLeft", "MoveRight")
    assert any(kitchen.step(way, objectId="", maxAgentsDistance=-1.0) for way in ways)
    assert kitchen.step("InitialRandomSpawn", randomSeed=1, allowFloor=False)
    kitchen.reset()
    there = kitchen.last_event.get_object(APPLE)["position"]
    event = kitchen.step(
        "TeleportObject", objectId=APPLE, x=there["x"] + 0.1, y=there["y"], z=there["z"], rotation=None
    )
    assert event, event.metadata["errorMessage"]
    assert event.get_object(APPLE)["position"]["x"] == pytest.approx(there["x"] + 0.1, abs=0.03)
    table = kitchen.last_event.get_object(APPLE)["parentReceptacles"]
    wall = {"x": 9.0, "y": 1.0, "z": 9.0}
    free = kitchen.step("GetSpawnCoordinatesAboveReceptacle", objectId=table[0], anywhere=True).metadata["actionReturn"]
    event = kitchen.step("PlaceObjectAtPoint", objectId=APPLE, positions=[wall, free[0]])
    assert event, event.metadata["errorMessage"]
    with pytest.raises(ValueError, match="missing the following arguments: position"):
        kitchen.step("PlaceObjectAtPoint", objectId=APPLE)


def test_what_initialize_takes(kitchen) -> None:
    event = kitchen.reset("FloorPlan6", gridSize=0.5, fieldOfView=0, visibilityDistance=0, agentMode="Default")
    assert np.allclose(np.array(stands_at(event)) / 0.5, np.round(np.array(stands_at(event)) / 0.5))
    assert event.metadata["fov"] == 90.0
    places = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    assert all(abs(place["x"] / 0.5 - round(place["x"] / 0.5)) < 1e-6 for place in places)
    assert len(places) > 10
    kitchen.initialization_parameters = {}
    event = kitchen.reset("FloorPlan1", maxUpwardLookAngle=60.0, maxDownwardLookAngle=30.0)
    done = [bool(kitchen.step(action)) for action in ("LookUp", "LookUp", "LookUp", "LookDown", "LookDown", "LookDown")]
    assert done == [True, True, False, True, True, True]
    assert not kitchen.step("LookDown")
    kitchen.initialization_parameters = {}
    with pytest.raises(RuntimeError, match="rotateStepDegrees must be positive"):
        kitchen.reset("FloorPlan1", rotateStepDegrees=-90)
    kitchen.initialization_parameters = {}


def test_what_is_taken_is_named_and_what_is_turned_over_is_empty(kitchen) -> None:
    mug = first_id(kitchen, "Mug")
    assert kitchen.step("PickupObject", objectId=mug, forceAction=True).metadata["actionReturn"] == mug
    assert kitchen.step("FillObjectWithLiquid", objectId=mug, fillLiquid="water", forceAction=True)
    assert kitchen.step("RotateHeldObject", pitch=60).get_object(mug)["isFilledWithLiquid"]
    event = kitchen.step("RotateHeldObject", pitch=60)
    assert not event.get_object(mug)["isFilledWithLiquid"]
    assert event.get_object(mug)["fillLiquid"] is None


def test_rolls_to_the_right(kitchen) -> None:
    assert kitchen.step("Teleport", rotation=0)
    assert kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    event = kitchen.step("RotateHeldObject", roll=30)
    assert event.get_object(APPLE)["rotation"]["z"] == pytest.approx(330, abs=0.1)
    assert event.metadata["heldObjectPose"]["localRotation"]["z"] == pytest.approx(330, abs=0.1)


def test_burners_are_on_with_their_knobs_and_all_switches_have_a_list(kitchen) -> None:
    knob = first_id(kitchen, "StoveKnob")
    event = kitchen.step("ToggleObjectOn", objectId=knob, forceAction=True)
    (burner,) = event.get_object(knob)["controlledObjects"]
    assert event.get_object(burner)["isToggled"]
    assert not kitchen.step("ToggleObjectOff", objectId=knob, forceAction=True).get_object(burner)["isToggled"]
    for record in event.metadata["objects"]:
        assert isinstance(record["controlledObjects"], list) == record["toggleable"]


def test_parents_and_contents_are_mutual(kitchen) -> None:
    for scene in ("FloorPlan3", "FloorPlan11", "FloorPlan215"):
        records = {o["objectId"]: o for o in kitchen.reset(scene).metadata["objects"]}
        links = [(name, parent) for name, o in records.items() for parent in o["parentReceptacles"] or []]
        assert links
        for name, parent in links:
            assert records[parent]["receptacle"]
            assert name in records[parent]["receptacleObjectIds"]


def test_the_words_that_clients_look_for(kitchen) -> None:
    knob, tv = first_id(kitchen, "StoveKnob"), None
    kitchen.step("ToggleObjectOn", objectId=knob, forceAction=True)
    for action, arguments, words in (
        ("PickupObject", {"objectId": APPLE}, "Target object not found within the specified visibility."),
        ("PickupObject", {"objectId": "Mug|9"}, "objectId: Mug|9 is not the objectId on any object in the scene!"),
        ("OpenObject", {"objectId": APPLE, "forceAction": True}, f"{APPLE} is not an Openable object"),
        ("PickupObject", {"objectId": knob}, f"{knob} must have the property CanPickup to be picked up."),
        ("ToggleObjectOn", {"objectId": knob, "forceAction": True}, "can't toggle object on if it's already on!"),
        ("PutObject", {"objectId": APPLE}, "Can't place an object if Agent isn't holding anything"),
    ):
        kitchen.step("TeleportFull", x=1.0, y=0.9, z=-1.5, rotation=90, horizon=-30, standing=True)
        event = kitchen.step(action, **arguments)
        assert event.metadata["errorMessage"] == words
    kitchen.reset("FloorPlan203")
    tv = first_id(kitchen, "Television")
    assert kitchen.step("BreakObject", objectId=tv, forceAction=True)
    broken = kitchen.step("ToggleObjectOn", objectId=tv, forceAction=True)
    assert broken.metadata["errorMessage"] == "Target is broken and cannot be Toggled On!"


def test_a_forced_door_opens_as_far_as_it_is_told(kitchen) -> None:
    cabinet = "Cabinet|+01.75|+02.02|-01.03"
    kitchen.reset("FloorPlan5")
    event = kitchen.step("OpenObject", objectId=cabinet, forceAction=True)
    assert event.get_object(cabinet)["openness"] == 1.0
    assert kitchen.step("CloseObject", objectId=cabinet, forceAction=True).get_object(cabinet)["openness"] == 0.0


def test_what_is_let_go_by_force_is_out_of_the_hand_and_the_agent_can_walk_on(kitchen) -> None:
    dropped = shut_in = 0
    for scene in ("FloorPlan203", "FloorPlan305"):
        kitchen.reset(scene)
        names = [o["objectId"] for o in kitchen.last_event.metadata["objects"] if o["pickupable"]]
        for name in names[:12]:
            if not kitchen.step("PickupObject", objectId=name, forceAction=True):
                continue
            event = kitchen.step("DropHandObject", forceAction=True)
            assert event, event.metadata["errorMessage"]
            assert event.metadata["inventoryObjects"] == []
            dropped += 1
            if not kitchen.step("Teleport", horizon=30):  # a bat that lay there has rolled to its feet
                shut_in += 1
                kitchen.reset()
    assert dropped > 15
    assert shut_in <= 1


def test_pushes_are_forced_and_say_where_things_are_then(kitchen) -> None:
    kitchen.step("Teleport", position={"x": 1.5, "y": 0.9, "z": 0.0}, rotation=0)
    for action, more in (("PushObject", {}), ("PullObject", {}), ("DirectionalPush", {"pushAngle": 20})):
        kitchen.reset()
        mug = first_id(kitchen, "Mug")
        assert not kitchen.last_event.get_object(mug)["visible"]
        assert not kitchen.step(action, objectId=mug, moveMagnitude=10, **more)
        event = kitchen.step(action, objectId=mug, moveMagnitude=10, forceAction=True, **more)
        assert event, event.metadata["errorMessage"]
        assert event.metadata["actionReturn"] == event.get_object(mug)["position"]
    kitchen.step("PickupObject", objectId=mug, forceAction=True)
    refused = kitchen.step("PushObject", objectId=mug, moveMagnitude=10, forceAction=True)
    assert "use Throw" in refused.metadata["errorMessage"]


@pytest.mark.parametrize(
    ("action", "arguments"),
    [
        ("TouchThenApplyForce", {"x": 0.5, "y": 0.6, "direction": {"x": 0.1, "z": 0.4}, "moveMagnitude": 0.4}),
        ("DirtyObject", {"objectId": "Mug", "forceAction": True}),
        ("FillObjectWithLiquid", {"objectId": "Mug", "fillLiquid": "COFFEE", "forceAction": True}),
        ("BreakObject", {"objectId": "Mug", "forceAction": True}),
        ("SliceObject", {"objectId": "Bread", "forceAction": True}),
        ("MaskObject", {"objectId": "Mug"}),
        ("EmphasizeObject", {"objectId": "Mug"}),
        ("GetSpawnCoordinatesAboveReceptacle", {"objectId": "Fridge", "anywhere": True}),
        ("ChangeFOV", {"fieldOfView": 80}),
        ("RotateLook", {"horizon": 30}),
    ],
)
def test_what_takes_all_arguments_that_there_are_takes_any(kitchen, action, arguments) -> None:
    if "objectId" in arguments:
        arguments = {**arguments, "objectId": first_id(kitchen, arguments["objectId"])}
    assert kitchen.step(action, force_magnitude=20, unheardOf={}, **arguments), kitchen.last_event.metadata


def test_an_agent_looks_from_where_it_can_turn_to(kitchen) -> None:
    apple = {"objectId": APPLE, "standings": [True], "horizons": [30]}
    kitchen.reset(rotateStepDegrees=45)
    kitchen.step("Teleport", rotation={"x": 0, "y": 30, "z": 0})
    poses = kitchen.step("GetInteractablePoses", **apple).metadata["actionReturn"]
    headings = {pose["rotation"] for pose in poses}
    assert len(headings) > 4
    assert headings <= {30.0 + 45 * k for k in range(7)} | {345.0}
    few = kitchen.step("GetInteractablePoses", **apple, maxPoses=3).metadata["actionReturn"]
    assert few == poses[:3]
    for wrong in ({"horizons": [90]}, {"horizons": []}, {"positions": []}, {"maxDistance": -1}, {"maxPoses": 0}):
        event = kitchen.step("GetInteractablePoses", **{**apple, **wrong})
        assert not event
        assert "must " in event.metadata["errorMessage"]


@pytest.mark.parametrize(
    ("action", "code", "words"),
    [
        ("LookDown", "LookDownCantExceedMin", "can't look down beyond 60 degrees below the forward horizon"),
        ("LookUp", "LookUpCantExceedMax", "can't look up beyond 30 degrees above the forward horizon"),
    ],
)
def test_the_end_of_how_far_one_looks_has_a_code(kitchen, action, code, words) -> None:
    events = [kitchen.step(action) for _ in range(4)]
    assert events[0].metadata["errorCode"] is None
    assert events[-1].metadata["errorCode"] == code
    assert events[-1].metadata["errorMessage"] == words


@pytest.mark.parametrize("axis", ["x", "z"])
def test_no_agent_is_pitched_or_rolled(kitchen, axis) -> None:
    before = kitchen.last_event.metadata["agent"]
    event = kitchen.step("Teleport", rotation={"x": 0, "y": 90, "z": 0, axis: 20})
    assert "pitch or roll" in event.metadata["errorMessage"]
    assert event.metadata["agent"] == before
    assert kitchen.step("Teleport", rotation={"x": 0, "y": 90, "z": 0, axis: 20}, forceAction=True)


def test_what_breaks_in_the_hand_falls(kitchen) -> None:
    mug = first_id(kitchen, "Mug")
    kitchen.step("PickupObject", objectId=mug, forceAction=True)
    event = kitchen.step("BreakObject", objectId=mug)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []
    assert event.get_object(mug)["isBroken"]
    assert not event.get_object(mug)["isPickedUp"]


def test_furniture_that_has_no_pose_may_be_left_alone(kitchen) -> None:
    toaster, mug = (first_id(kitchen, name) for name in ("Toaster", "Mug"))
    record = kitchen.last_event.get_object(mug)
    poses = [{"objectName": record["name"], "position": record["position"], "rotation": record["rotation"]}]
    assert kitchen.step("SetObjectPoses", objectPoses=poses, skipMoveable=True)
    assert kitchen.last_event.get_object(toaster) is not None
    assert kitchen.last_event.get_object(APPLE) is None
    assert kitchen.step("SetObjectPoses", objectPoses=poses)
    assert kitchen.last_event.get_object(toaster) is None
    assert kitchen.last_event.get_object(mug) is not None


def test_types_are_listed_and_taken_away(kitchen) -> None:
    listed = kitchen.step("SetObjectFilterForType", objectTypes=["Mug", "Fridge"]).metadata["objects"]
    assert {o["objectType"] for o in listed} == {"Mug", "Fridge"}
    left = kitchen.step("ResetObjectFilter").metadata["objects"]
    after = kitchen.step("DisableAllObjectsOfType", objectType="Cabinet").metadata["objects"]
    assert {o["objectId"] for o in left} - {o["objectId"] for o in after} == {
        o["objectId"] for o in left if o["objectType"] == "Cabinet"
    }
    assert len(after) < len(left)
    assert kitchen.step("DisableAllObjectsOfType", objectType="Cabinet")  # there is none any more
    for action in ("MakeObjectBreakable", "HideTranslucentObjects", "EnableTemperatureDecay", "NoOp"):
        assert kitchen.step(action, **({"objectId": APPLE} if action == "MakeObjectBreakable" else {}))
