import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.thor.test_objects import APPLE, BEFORE_APPLE

pytestmark = pytest.mark.slow


@pytest.fixture
def holding(kitchen):
    """The apple is held, on open floor."""
    assert kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    assert kitchen.step("Teleport", position={"x": 1.5, "y": 0.9, "z": 0.0}, rotation=180, horizon=0)
    return kitchen


def place(event) -> np.ndarray:
    """Middle of the apple, metres in AI2-THOR's frame."""
    return np.array(list(event.get_object(APPLE)["axisAlignedBoundingBox"]["center"].values()))


def degrees(event) -> list[float]:
    """The apple's rotation, from -90 to 270."""
    return [(angle + 90.0) % 360.0 - 90.0 for angle in event.get_object(APPLE)["rotation"].values()]


@pytest.mark.parametrize(
    ("direction", "expected"),
    [
        ("Ahead", (0, 0, -0.1)),  # it looks along -z
        ("Back", (0, 0, 0.1)),
        ("Right", (-0.1, 0, 0)),
        ("Left", (0.1, 0, 0)),
        ("Up", (0, 0.1, 0)),
        ("Down", (0, -0.1, 0)),
    ],
)
def test_moves_what_it_holds(holding, direction, expected) -> None:
    before = place(holding.last_event)
    event = holding.step(f"MoveHeldObject{direction}", moveMagnitude=0.1)
    assert event, event.metadata["errorMessage"]
    assert place(event) - before == pytest.approx(expected, abs=1e-5)
    pose = event.metadata["heldObjectPose"]
    assert list(pose["position"].values()) == pytest.approx(place(event), abs=1e-5)
    assert event.get_object(APPLE)["isPickedUp"]


@settings(max_examples=8, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(right=st.floats(-0.2, 0.2), up=st.floats(-0.2, 0.2), ahead=st.floats(0.0, 0.4))  # it stays in the frame
def test_there_and_back_again(holding, right, up, ahead) -> None:
    before = place(holding.last_event)
    event = holding.step("MoveHeldObject", right=right, up=up, ahead=ahead)
    assert place(event) - before == pytest.approx((-right, up, -ahead), abs=1e-5)
    event = holding.step("MoveHeldObject", right=-right, up=-up, ahead=-ahead)
    assert place(event) == pytest.approx(before, abs=1e-5)


def test_a_hand_goes_so_far_and_no_farther(holding) -> None:
    before = place(holding.last_event)
    assert "out of range" in holding.step("MoveHeldObjectAhead", moveMagnitude=2.0).metadata["errorMessage"]
    event = holding.step("MoveHeldObjectUp", moveMagnitude=0.6)
    assert "outside of the agent's viewport" in event.metadata["errorMessage"]
    assert place(event) == pytest.approx(before, abs=1e-6)
    event = holding.step("MoveHeldObjectUp", moveMagnitude=0.5)
    assert event, event.metadata["errorMessage"]


@pytest.mark.parametrize("way", ["MoveAhead", "MoveBack", "RotateRight", "LookDown", "Teleport"])
def test_who_walks_turns_or_looks_has_the_hand_where_it_usually_is(holding, way) -> None:
    usual = holding.last_event.metadata["heldObjectPose"]
    for stays in (True, False):
        assert holding.step("MoveHeldObject", ahead=0.1, up=0.05)
        assert holding.step("RotateHeldObject", pitch=40)
        moved = holding.last_event.metadata["heldObjectPose"]
        assert moved["localPosition"] != usual["localPosition"]
        event = holding.step(way, **({"manualInteract": True} if stays else {}))
        assert event, event.metadata["errorMessage"]
        pose = event.metadata["heldObjectPose"]
        if stays and way != "Teleport":
            assert pose["localPosition"] == moved["localPosition"]
            assert holding.step("Teleport", position={"x": 1.5, "y": 0.9, "z": 0.0}, rotation=180, horizon=0)
        elif way != "LookDown":  # what is held does not follow the camera's tilt
            assert list(pose["localPosition"].values()) == pytest.approx(list(usual["localPosition"].values()))
            now, then = pose["localRotation"], usual["localRotation"]
            turned = [(now[axis] - then[axis] + 90) % 360 for axis in "xyz"]
            assert turned == pytest.approx([90] * 3, abs=1e-3)
    assert holding.step("Teleport", horizon=0).metadata["heldObjectPose"]["localPosition"] == usual["localPosition"]
    assert degrees(holding.last_event)[0] == pytest.approx(0.0, abs=0.1)


def test_who_lets_go_has_the_hand_where_it_usually_is(holding) -> None:
    usual = holding.last_event.metadata["heldObjectPose"]["localPosition"]
    assert holding.step("MoveHeldObject", ahead=0.1, up=0.05)
    dropped = holding.step("DropHandObject")
    assert dropped.metadata["heldObjectPose"]["localPosition"] == usual
    assert dropped.metadata["actionReturn"] == dropped.get_object(APPLE)["position"]


def test_what_is_in_the_way_is_named(kitchen) -> None:
    kitchen.step("TeleportFull", **BEFORE_APPLE)
    kitchen.step("PickupObject", objectId=APPLE)
    before = place(kitchen.step("RotateLook", horizon=0))
    event = kitchen.step("MoveHeldObject", ahead=0.5, up=-0.6)
    assert not event
    assert f"is blocking {APPLE} from moving" in event.metadata["errorMessage"]
    assert place(event) == pytest.approx(before, abs=1e-6)


def test_the_hand_starts_anew(holding) -> None:
    usual = holding.last_event.metadata["heldObjectPose"]["localPosition"]
    assert usual == {"x": 0.0, "y": -0.16, "z": 0.38}
    assert holding.step("MoveHeldObjectLeft", moveMagnitude=0.2)
    assert holding.step("DropHandObject")
    event = holding.step("PickupObject", objectId=APPLE, forceAction=True)
    assert event.metadata["heldObjectPose"]["localPosition"] == usual


def test_an_object_is_held_where_it_was(kitchen) -> None:
    before = place(kitchen.step("TeleportFull", **BEFORE_APPLE))
    event = kitchen.step("PickupObject", objectId=APPLE, manualInteract=True)
    assert event.get_object(APPLE)["isPickedUp"]
    assert place(event) == pytest.approx(before, abs=1e-4)
    event = kitchen.step(
        "MoveHeldObjectUp", moveMagnitude=0.1
    )  # along the camera's axis, which looks down by 30 degrees
    assert place(event)[1] - before[1] == pytest.approx(0.1 * np.cos(np.radians(30)), abs=1e-4)


def test_what_is_dropped_falls_from_the_hand(holding) -> None:
    holding.step("MoveHeldObject", right=0.3, ahead=0.2)
    before = place(holding.last_event)
    after = place(holding.step("DropHandObject"))
    assert after[1] < 0.1
    assert np.hypot(*(after - before)[[0, 2]]) < 0.25  # it rolls a little


def test_turns_what_it_holds(holding) -> None:
    start = holding.last_event.get_object(APPLE)["rotation"]
    event = holding.step("RotateHeldObject", yaw=30)
    assert (event.get_object(APPLE)["rotation"]["y"] - start["y"]) % 360 == pytest.approx(30.0, abs=1e-3)
    event = holding.step("RotateHeldObject", rotation={"x": 0, "y": 15, "z": 0})
    assert degrees(event) == pytest.approx([0.0, 195.0, 0.0], abs=1e-3)
    event = holding.step("RotateHeldObject", pitch=90)
    assert degrees(event)[0] == pytest.approx(75.0, abs=1e-3)  # its front was 15 degrees beside the agent's
    for _ in range(3):
        event = holding.step("RotateHeldObject", pitch="90")
    assert degrees(event) == pytest.approx([0.0, 195.0, 0.0], abs=1e-3)
    with pytest.raises(ValueError, match="Ambiguous action"):
        holding.step("RotateHeldObject", pitch=10, rotation={"x": 0, "y": 0, "z": 0})


def in_body(event) -> list[float]:
    """The local rotation of what is held with the camera's tilt taken away, 90 degrees more."""
    x, y, z = event.metadata["heldObjectPose"]["localRotation"].values()
    return [(angle + 90.0) % 360.0 for angle in (x + event.metadata["agent"]["cameraHorizon"], y, z)]


def test_what_is_held_faces_as_the_agent_does_and_turns_with_it(kitchen) -> None:
    for rotation in (90, 210):
        assert kitchen.step("Teleport", rotation=rotation)
        event = kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
        assert degrees(event) == pytest.approx([0.0, rotation, 0.0], abs=0.1)  # it lies a little tilted
        before = degrees(event)
        assert in_body(event) == pytest.approx([90] * 3, abs=0.1)
        for turn in (50, 40, 270):
            event = kitchen.step("RotateRight", degrees=turn)
        assert degrees(event) == pytest.approx(before, abs=1e-3)
        event = kitchen.step("RotateLeft", degrees=60)
        assert degrees(event)[1] == pytest.approx((before[1] - 60 + 90) % 360 - 90, abs=1e-3)
        pose = event.metadata["heldObjectPose"]
        assert pose["rotation"] == event.get_object(APPLE)["rotation"]
        assert in_body(event) == pytest.approx([90] * 3, abs=0.1)
        assert degrees(kitchen.step("LookDown")) == degrees(event)  # a cup stays upright
        assert kitchen.step("DropHandObject")


def test_what_is_held_is_in_the_picture_where_the_metadata_say(holding) -> None:
    event = holding.step("Initialize", renderInstanceSegmentation=True, renderDepthImage=True)
    assert event.get_object(APPLE)["visible"]
    rows, columns = np.nonzero(event.instance_masks[APPLE])
    height, width = event.depth_frame.shape
    focal = height / 2 / np.tan(np.radians(event.metadata["fov"] / 2))
    # Of a thing that is 0.38 m ahead and 0.16 m below the eye.
    assert (columns.min() + columns.max()) / 2 == pytest.approx(width / 2 - 0.5, abs=5)
    assert (rows.min() + rows.max()) / 2 == pytest.approx(height / 2 + focal * 0.16 / 0.38, abs=15)
    assert 0.30 < event.depth_frame[rows, columns].min() < 0.38
    event = holding.step("MoveHeldObjectRight", moveMagnitude=0.1)
    assert np.nonzero(event.instance_masks[APPLE])[1].mean() == pytest.approx(
        columns.mean() + focal * 0.1 / 0.38, abs=8
    )
    assert holding.step("DropHandObject")
    event = holding.step("RotateRight", degrees=180)
    event = holding.step("PickupObject", objectId=APPLE, forceAction=True, manualInteract=True)  # behind its back
    assert APPLE not in event.instance_detections2D
    assert not event.get_object(APPLE)["visible"]


def test_what_is_held_hides_nothing_from_the_metadata(kitchen) -> None:
    kitchen.step("TeleportFull", **{**BEFORE_APPLE, "horizon": 0})
    before = {o["objectId"] for o in kitchen.last_event.metadata["objects"] if o["visible"]} - {APPLE}
    event = kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    assert before
    assert {o["objectId"] for o in event.metadata["objects"] if o["visible"]} == before | {APPLE}
    without = kitchen.step("Pass", renderImage=False)
    assert {o["objectId"] for o in without.metadata["objects"] if o["visible"]} == before | {APPLE}


def test_pictures_are_as_before_when_the_hand_is_empty_again(holding) -> None:
    world = holding.server.session._simulator.room.world
    held = holding.step("Pass")
    turned = [holding.step("RotateRight").frame for _ in range(4)]
    assert np.array_equal(turned[3], held.frame)
    put = holding.step("DropHandObject")
    assert not np.array_equal(put.frame, held.frame)
    state = world.save()
    assert holding.step("PickupObject", objectId=APPLE, forceAction=True)
    assert holding.step("RotateRight")
    assert holding.step("RotateLeft")
    world.restore(state)
    assert np.array_equal(holding.step("Pass").frame, put.frame)


def test_what_is_thrown_flies_where_the_camera_looks(holding) -> None:
    before, agent = place(holding.last_event), holding.last_event.metadata["agent"]["position"]
    event = holding.step("ThrowObject", moveMagnitude=10.0)
    assert event, event.metadata["errorMessage"]
    after = place(event)
    assert not event.get_object(APPLE)["isPickedUp"]
    assert agent["z"] - after[2] > agent["z"] - before[2] + 0.3
    assert after[1] < 0.2
    world = holding.server.session._simulator.room.world
    rested = world.save()
    world.settle()
    moved = [np.subtract(world.state(name).position, rested.states[name].position) for name in world.ids]
    assert np.abs(moved).max() < 0.002  # all is at rest


@pytest.mark.parametrize("newtons", [2.0, 30.0, 5000.0])
@pytest.mark.parametrize("rotation", [0, 90, 225])
def test_what_is_thrown_stays_in_the_room_and_in_nothing(holding, newtons, rotation) -> None:
    start = holding.step("Teleport", rotation=rotation)
    event = holding.step("ThrowObject", moveMagnitude=newtons)
    assert event, event.metadata["errorMessage"]
    world = holding.server.session._simulator.room.world
    corners = np.array(event.metadata["sceneBounds"]["cornerPoints"])
    assert (place(event) > corners.min(axis=0)).all()
    assert (place(event) < corners.max(axis=0)).all()
    moved = [
        o["objectId"] for o in event.metadata["objects"] if o["position"] != start.get_object(o["objectId"])["position"]
    ]
    assert APPLE in moved
    for name in moved:
        assert min((gap for _, gap in world.overlapping(name)), default=0.0) > -0.005, name


def test_the_same_throw_ends_in_the_same_place(holding) -> None:
    saved = holding.server.session._simulator.room.world.save()
    first = holding.step("ThrowObject", moveMagnitude=20.0).metadata
    holding.server.session._simulator.room.world.restore(saved)
    assert holding.step("ThrowObject", moveMagnitude=20.0).metadata == first


def test_what_takes_something_in_the_hand(kitchen) -> None:
    for action in ("MoveHeldObject", "MoveHeldObjectAhead", "RotateHeldObject"):
        assert kitchen.step(action).metadata["errorMessage"] == "nothing is held"
    assert kitchen.step("ThrowObject", moveMagnitude=50.0).metadata["errorMessage"] == "Nothing in Hand to Throw!"
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    assert "newtons" in kitchen.step("ThrowObject", moveMagnitude=-1).metadata["errorMessage"]
    event = kitchen.step("ThrowObject", moveMagnitude=0)  # without a force it falls
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []


def test_an_arm_moves_what_it_holds_itself(armed) -> None:
    assert "MoveArm" in armed.step("MoveHeldObjectAhead").metadata["errorMessage"]


@pytest.mark.parametrize(("holder", "thing"), [("Plate", "Egg"), ("Pot", "Potato")])
def test_what_lies_in_it_comes_along(kitchen, holder, thing) -> None:
    ids = {o["objectType"]: o["objectId"] for o in kitchen.last_event.metadata["objects"]}
    holder, thing, counter = ids[holder], ids[thing], ids["CounterTop"]
    assert kitchen.step("PickupObject", objectId=thing, forceAction=True)
    assert kitchen.step("PutObject", objectId=holder, forceAction=True)
    start = kitchen.step("PickupObject", objectId=holder, forceAction=True, renderInstanceSegmentation=True)
    assert [o["objectId"] for o in start.metadata["inventoryObjects"]] == [holder]
    for action in ("Pass", "RotateRight", "LookDown"):
        event = kitchen.step(action, renderInstanceSegmentation=True)
        one, other = event.get_object(holder), event.get_object(thing)
        assert (one["isPickedUp"], other["isPickedUp"]) == (True, False)
        assert one["receptacleObjectIds"] == [thing]
        assert other["parentReceptacles"] == [holder]
        assert one["visible"]
        assert other["visible"]
        assert from_middle(event, holder, thing) == pytest.approx(from_middle(start, holder, thing), abs=2e-3)
        assert event.instance_masks[thing].sum() > 20
    assert not kitchen.step("PickupObject", objectId=thing, forceAction=True)
    event = kitchen.step("PutObject", objectId=counter, forceAction=True)
    assert event, event.metadata["errorMessage"]
    assert event.get_object(holder)["parentReceptacles"] == [counter]
    assert event.get_object(thing)["parentReceptacles"] == [holder]
    assert kitchen.step("PickupObject", objectId=thing, forceAction=True)
    assert kitchen.last_event.get_object(holder)["receptacleObjectIds"] == []


def test_a_thing_on_a_plate_in_the_hand_leaves_the_scene_with_it(kitchen) -> None:
    ids = {o["objectType"]: o["objectId"] for o in kitchen.last_event.metadata["objects"]}
    for action, name in (("PickupObject", "Egg"), ("PutObject", "Plate"), ("PickupObject", "Plate")):
        assert kitchen.step(action, objectId=ids[name], forceAction=True)
    event = kitchen.step("RemoveFromScene", objectId=ids["Plate"])
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []
    assert not {ids["Plate"], ids["Egg"]} & {o["objectId"] for o in event.metadata["objects"]}
    assert kitchen.reset().get_object(ids["Egg"])["parentReceptacles"] != [ids["Plate"]]


def from_middle(event, one, other) -> tuple[float, float]:
    """How far one thing is beside and above another one."""
    a, b = (
        np.array(list(event.get_object(name)["axisAlignedBoundingBox"]["center"].values())) for name in (one, other)
    )
    x, y, z = b - a
    return float(np.hypot(x, z)), float(y)


def test_a_question_turns_nothing_that_is_held_and_a_hand_that_is_empty_rests(kitchen) -> None:
    bowl, counter = "Bowl|+00.27|+01.10|-00.75", "CounterTop|-00.08|+01.15|00.00"
    kitchen.step("PickupObject", objectId=bowl, forceAction=True)
    usual = kitchen.last_event.metadata["heldObjectPose"]["localPosition"]
    kitchen.step("RotateHeldObject", pitch=20)
    before = kitchen.step("MoveHeldObjectUp", moveMagnitude=0.05)
    assert before.metadata["heldObjectPose"]["localPosition"] != usual
    event = kitchen.step("GetInteractablePoses", objectId=counter, maxPoses=2)
    assert len(event.metadata["actionReturn"]) == 2
    assert event.get_object(bowl) == before.get_object(bowl)
    event = kitchen.step("PutObject", objectId=counter, forceAction=True)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["heldObjectPose"]["localPosition"] == usual
