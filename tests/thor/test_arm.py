import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.helpers.thor_arm import APPLE, BEFORE_APPLE, hand, stand_before

pytestmark = pytest.mark.slow


def test_the_shoulder_slides(before_apple) -> None:
    floor = 0.0
    for share, height in ((0.5, 1.126), (0.3, 0.856)):  # of 0.451 to 1.801 m
        event = before_apple.step("MoveArmBase", y=share)
        assert event, event.metadata["errorMessage"]
        assert event.metadata["arm"]["joints"][0]["position"]["y"] == pytest.approx(height + floor, abs=0.002)
    event = before_apple.step("MoveArmBaseUp", distance=0.1)
    assert event.metadata["arm"]["joints"][0]["position"]["y"] == pytest.approx(0.956 + floor, abs=0.002)
    assert before_apple.step("MoveArmBaseDown", distance=0.1)
    assert not before_apple.step("MoveArmBase", y=1.2)


def test_the_hand_goes_where_it_is_sent(before_apple) -> None:
    before_apple.step("RotateAgent", degrees=180)  # away from the island, looking along -x
    assert before_apple.step("MoveArmBase", y=0.5)
    event = before_apple.step("MoveArm", position={"x": 0.1, "y": 0.05, "z": 0.4})
    assert event, event.metadata["errorMessage"]
    shoulder = event.metadata["arm"]["joints"][0]["position"]
    assert event.metadata["arm"]["joints"][3]["rootRelativePosition"] == pytest.approx({"x": 0.1, "y": 0.05, "z": 0.4})
    # Looking along -x: ahead is -x, right is +z.
    assert hand(event)["x"] == pytest.approx(-1.0 - 0.15 - 0.4, abs=0.01)
    assert hand(event)["z"] == pytest.approx(0.5 + 0.1, abs=0.01)
    assert hand(event)["y"] == pytest.approx(shoulder["y"] + 0.05, abs=0.01)
    event = before_apple.step("MoveArmRelative", offset={"x": 0, "y": 0.05, "z": 0})
    assert event
    there = hand(event)
    event = before_apple.step("MoveArm", position=there, coordinateSpace="world")
    assert hand(event) == pytest.approx(there, abs=1e-3)


@pytest.mark.parametrize("yaw", [0, 90, 200])
def test_going_to_where_the_hand_says_it_is_moves_nothing(before_apple, yaw) -> None:
    before_apple.step("RotateAgent", degrees=yaw)
    before_apple.step("MoveArm", position={"x": -0.1, "y": 0.2, "z": 0.4})
    before = before_apple.last_event.metadata["arm"]
    for position, space in (
        (before["joints"][-1]["rootRelativePosition"], "armBase"),
        (before["joints"][-1]["position"], "world"),
        (before["handSphereCenter"], "world"),
    ):
        event = before_apple.step("MoveArm", position=position, coordinateSpace=space)
        assert event
        assert event.metadata["arm"] == before


@pytest.mark.parametrize("thing", [APPLE, "Book|+00.15|+01.10|+00.62", "Bread|-00.52|+01.17|-00.03"])
def test_the_hand_takes_hold_of_what_it_is_sent_into_and_puts_it_back(armed, thing) -> None:
    middle = armed.last_event.get_object(thing)["axisAlignedBoundingBox"]["center"]
    stand_before(armed, middle)
    event = armed.step("MoveArm", position=middle, coordinateSpace="world")
    assert event, event.metadata["errorMessage"]
    assert thing in event.metadata["arm"]["pickupableObjects"]
    assert armed.step("PickupObject", objectIdCandidates=[thing])
    event = armed.step("ReleaseObject")
    assert event, event.metadata["errorMessage"]
    assert event.get_object(thing)["axisAlignedBoundingBox"]["center"] == pytest.approx(middle, abs=0.02)


def test_the_arm_comes_back_from_what_it_cannot_do(before_apple) -> None:
    before = hand(before_apple.last_event)
    event = before_apple.step("MoveArm", position={"x": 0, "y": 0, "z": 2.0})
    assert not event
    assert "not within reach" in event.metadata["errorMessage"]
    assert hand(event) == before


def test_the_hand_takes_hold_of_what_it_touches(before_apple) -> None:
    assert not before_apple.step("PickupObject")
    assert before_apple.step("MoveArmBase", y=0.6)
    apple = before_apple.last_event.get_object(APPLE)["position"]
    event = before_apple.step(
        "MoveArm",
        position={"x": apple["x"], "y": apple["y"] + 0.06, "z": apple["z"]},
        coordinateSpace="world",
        returnToStart=False,
    )
    assert APPLE in event.metadata["arm"]["pickupableObjects"], event.metadata["errorMessage"]
    assert not before_apple.step("PickupObject", objectIdCandidates=["Mug|-01.76|+00.90|-00.62"])
    event = before_apple.step("PickupObject", objectIdCandidates=[APPLE])
    assert event
    assert event.metadata["arm"]["heldObjects"] == [APPLE]
    assert event.get_object(APPLE)["position"] == pytest.approx(apple, abs=1e-5)  # where it was taken hold of
    before = {axis: apple[axis] - hand(event)[axis] for axis in "xyz"}
    event = before_apple.step("MoveAgent", ahead=-0.25)
    assert event
    assert {a: event.get_object(APPLE)["position"][a] - hand(event)[a] for a in "xyz"} == pytest.approx(
        before, abs=1e-5
    )
    event = before_apple.step("ReleaseObject")
    assert event
    assert not event.get_object(APPLE)["isPickedUp"]
    assert event.get_object(APPLE)["position"]["y"] < 0.2


def test_the_sphere_grows(before_apple) -> None:
    assert before_apple.step("MoveArmBase", y=0.6)
    few = before_apple.step("SetHandSphereRadius", radius=0.04).metadata["arm"]
    many = before_apple.step("SetHandSphereRadius", radius=0.5).metadata["arm"]
    assert (few["handSphereRadius"], many["handSphereRadius"]) == (0.04, 0.5)
    assert set(few["touchedNotHeldObjects"]) < set(many["touchedNotHeldObjects"])
    assert not before_apple.step("SetHandSphereRadius", radius=0.6)


def test_the_arm_belongs_to_arm_mode(kitchen) -> None:
    with pytest.raises(ValueError, match="Invalid action: MoveArm"):
        kitchen.step("MoveArm", position={"x": 0, "y": 0, "z": 0.4})
    assert kitchen.last_event.metadata["arm"] is None


def palm(event) -> np.ndarray:
    """The hand's rotation, (3, 3), whose columns are its right, up and ahead, as the metadata say it."""
    x, y, z, degrees = event.metadata["arm"]["joints"][3]["rotation"].values()
    return Rotation.from_rotvec(degrees * np.array([x, y, z]), degrees=True).as_matrix()


@pytest.mark.parametrize("turn", [{"roll": 25}, {"yaw": -20}, {"pitch": 15, "yaw": 10, "roll": -30}, {"roll": "90"}])
def test_the_wrist_turns_about_the_hands_own_axes(before_apple, turn) -> None:
    before_apple.step("RotateAgent", degrees=180)
    before = before_apple.step("MoveArm", position={"x": 0.1, "y": 0.05, "z": 0.4})
    after = before_apple.step("RotateWristRelative", **turn)
    assert after, after.metadata["errorMessage"]
    assert hand(after) == pytest.approx(hand(before), abs=1e-5)
    pitch, yaw, roll = (float(turn.get(axis, 0)) for axis in ("pitch", "yaw", "roll"))
    # Unity turns about z, then x, then y, and a roll is a turn the other way about z.
    local = Rotation.from_euler("YXZ", [yaw, pitch, -roll], degrees=True).as_matrix()
    assert np.allclose(palm(before).T @ palm(after), local, atol=1e-4)
    wrist, tip = (after.metadata["arm"]["joints"][k]["position"] for k in (2, 3))
    assert palm(after)[:, 2] @ [tip[axis] - wrist[axis] for axis in "xyz"] > 0.9 * math.dist(
        wrist.values(), tip.values()
    )


@pytest.mark.parametrize("action", ["MoveArm", "MoveArmRelative"])
def test_from_the_wrist_the_hand_moves_along_its_own_axes(before_apple, action) -> None:
    before_apple.step("RotateAgent", degrees=180)
    assert before_apple.step("MoveArm", position={"x": 0.1, "y": 0.05, "z": 0.4})
    before = before_apple.step("RotateWristRelative", yaw=-20)
    argument = "position" if action == "MoveArm" else "offset"
    for offset in ([0.0, 0.0, 0.0], [0.02, 0.03, -0.05]):
        after = before_apple.step(action, coordinateSpace="wrist", **{argument: dict(zip("xyz", offset, strict=True))})
        assert after, after.metadata["errorMessage"]
        moved = [hand(after)[axis] - hand(before)[axis] for axis in "xyz"]
        assert moved == pytest.approx((palm(before) @ offset).tolist(), abs=1e-3)


def test_what_is_held_turns_with_the_wrist(before_apple) -> None:
    assert before_apple.step("MoveArmBase", y=0.6)
    apple = before_apple.last_event.get_object(APPLE)["position"]
    above = {**apple, "y": apple["y"] + 0.06}
    before_apple.step("MoveArm", position=above, coordinateSpace="world", returnToStart=False)
    assert before_apple.step("PickupObject", objectIdCandidates=[APPLE])
    before_apple.step("RotateAgent", degrees=180)
    before = before_apple.step("MoveArm", position={"x": 0.1, "y": 0.05, "z": 0.4})
    assert before, before.metadata["errorMessage"]
    turned = before_apple.step("RotateWristRelative", pitch=20)
    assert turned, turned.metadata["errorMessage"]
    turn = palm(turned) @ palm(before).T
    was, now = (
        {axis: event.get_object(APPLE)["position"][axis] - hand(event)[axis] for axis in "xyz"}
        for event in (before, turned)
    )
    assert list(now.values()) == pytest.approx((turn @ list(was.values())).tolist(), abs=2e-3)
    assert list(now.values()) != pytest.approx(list(was.values()), abs=2e-3)
    rotations = [
        Rotation.from_euler("YXZ", [event.get_object(APPLE)["rotation"][axis] for axis in "yxz"], degrees=True)
        for event in (before, turned)
    ]
    assert np.allclose((rotations[1] * rotations[0].inv()).as_matrix(), turn, atol=1e-3)
    back = before_apple.step("RotateWristRelative", pitch=-20)
    assert back.get_object(APPLE)["position"] == pytest.approx(before.get_object(APPLE)["position"], abs=1e-4)


def test_a_hand_that_cannot_be_turned_stays_as_it_is(before_apple) -> None:
    before_apple.step("RotateAgent", degrees=180)
    assert before_apple.step("MoveArmBase", y=0.5)
    event = before_apple.step("MoveArm", position={"x": 0.0, "y": 0.0, "z": 0.62})
    assert event, event.metadata["errorMessage"]
    before = event.metadata["arm"]
    event = before_apple.step("RotateWristRelative", yaw=180)  # the wrist would be beyond the stretched arm
    assert not event
    assert "not within reach" in event.metadata["errorMessage"]
    assert event.metadata["arm"] == before


@pytest.mark.parametrize("degrees", [15.0, -10.0])
def test_the_elbow_turns_about_the_line_from_shoulder_to_hand(armed, degrees) -> None:
    def at(event, joint: int) -> np.ndarray:
        return np.array(list(event.metadata["arm"]["joints"][joint]["position"].values()))

    assert armed.step("MoveArmBase", y=0.6)
    before = armed.step("MoveArm", position={"x": 0.1, "y": 0.1, "z": 0.5})
    assert before, before.metadata["errorMessage"]
    event = armed.step("RotateElbowRelative", degrees=degrees)
    assert event, event.metadata["errorMessage"]
    assert list(hand(event).values()) == pytest.approx(list(hand(before).values()), abs=1e-5)
    shoulder = at(event, 0)
    assert shoulder.tolist() == at(before, 0).tolist()
    moved = [np.linalg.norm(at(event, joint) - at(before, joint)) for joint in range(4)]
    elbow = int(np.argmax(moved))
    assert moved[elbow] > 0.02
    away = armed.step("RotateElbowRelative", degrees=-degrees)
    assert np.linalg.norm(at(away, elbow) - at(before, elbow)) < 0.3 * moved[elbow]  # the hand may point elsewhere then


def test_an_elbow_that_cannot_be_turned_so_far_stays(armed) -> None:
    assert armed.step("MoveArm", position={"x": 0.1, "y": 0.1, "z": 0.5})
    before = armed.last_event.metadata["arm"]
    event = armed.step("RotateElbowRelative", degrees=175.0)
    assert not event
    assert event.metadata["errorMessage"]
    assert event.metadata["arm"] == before


def test_the_agent_sees_its_arm(armed) -> None:
    armed.step("TeleportFull", x=1.0, y=0.9, z=-1.5, rotation=270, horizon=30, standing=True)
    folded = armed.step("Pass")
    event = armed.step("MoveArm", position={"x": 0.0, "y": 0.2, "z": 0.5}, coordinateSpace="armBase")
    assert event, event.metadata["errorMessage"]
    changed = np.abs(event.frame.astype(int) - folded.frame).max(axis=2) > 30
    assert changed.sum() > 800
    assert {o["objectId"] for o in event.metadata["objects"] if o["visible"]} == {
        o["objectId"] for o in folded.metadata["objects"] if o["visible"]
    }
    hidden = armed.reset(agentMode="arm", makeAgentsVisible=False)
    armed.initialization_parameters.pop("makeAgentsVisible")
    hidden = armed.step("TeleportFull", x=1.0, y=0.9, z=-1.5, rotation=270, horizon=30, standing=True)
    event = armed.step("MoveArm", position={"x": 0.0, "y": 0.2, "z": 0.5}, coordinateSpace="armBase")
    assert event, event.metadata["errorMessage"]
    assert np.array_equal(event.frame, hidden.frame)


def take_apple(controller) -> None:
    """Take the apple from the island, lift it, and step back."""
    middle = controller.last_event.get_object(APPLE)["axisAlignedBoundingBox"]["center"]
    assert controller.step("MoveArmBase", y=middle["y"] + 0.1, normalizedY=False)
    assert controller.step("MoveArm", position=middle, coordinateSpace="world")
    assert controller.step("PickupObject", objectIdCandidates=[APPLE])
    assert controller.step("MoveArmRelative", offset={"x": 0.0, "y": 0.2, "z": 0.0})
    assert controller.step("MoveAgent", ahead=-0.2)


def test_what_the_arm_holds_turns_with_the_agent(before_apple) -> None:
    armed, world = before_apple, before_apple.server.session._simulator.room.world
    take_apple(armed)
    before = armed.step("Pass")
    from_hand = np.subtract(place(before), list(hand(before).values()))
    quaternion = world.state(APPLE).quaternion
    turned = armed.step("RotateRight", degrees=90)
    assert turned, turned.metadata["errorMessage"]
    x, y, z = np.subtract(place(turned), list(hand(turned).values()))
    assert (x, y, z) == pytest.approx((from_hand[2], from_hand[1], -from_hand[0]), abs=2e-3)
    armed.step("RotateLeft", degrees=90)
    assert world.state(APPLE).quaternion == pytest.approx(quaternion, abs=1e-6)


def place(event) -> list[float]:
    return list(event.get_object(APPLE)["axisAlignedBoundingBox"]["center"].values())


def test_a_question_moves_neither_the_arm_nor_what_it_holds(armed) -> None:
    fridge = next(o["objectId"] for o in armed.last_event.metadata["objects"] if o["objectType"] == "Fridge")
    before = armed.step("MoveArm", position={"x": 0.0, "y": 0.1, "z": 0.4})
    assert before, before.metadata["errorMessage"]
    poses = armed.step("GetInteractablePoses", objectId=fridge, maxPoses=3).metadata["actionReturn"]
    assert len(poses) == 3
    assert armed.last_event.metadata["arm"] == before.metadata["arm"]
    assert armed.last_event.metadata["agent"] == before.metadata["agent"]


def test_the_hand_sphere_stays_as_large_when_the_room_is_loaded_anew(armed) -> None:
    assert armed.step("SetHandSphereRadius", radius=0.2)
    apple = next(o["objectId"] for o in armed.last_event.metadata["objects"] if o["objectType"] == "Apple")
    event = armed.step("SliceObject", objectId=apple, forceAction=True)
    assert event.metadata["arm"]["handSphereRadius"] == pytest.approx(0.2)


def test_what_an_arm_does_otherwise(before_apple) -> None:
    shoulder = [before_apple.step("MoveArmBaseUp", distance=by).metadata["arm"]["joints"][0] for by in (5, -5, 0.2)]
    heights = [joint["position"]["y"] for joint in shoulder]
    assert heights == pytest.approx([1.801, 0.451, 0.651], abs=0.002)
    event = before_apple.step("MoveArm", position={"x": 0.0, "y": 0.0, "z": 0.4}, coordinateSpace="foo")
    assert event.metadata["errorMessage"] == "Invalid coordinateSpace: foo"
    assert not before_apple.step("PickupObject", x=0.5, y=0.5)
    event = before_apple.step("ReleaseObject")
    assert (event.metadata["lastActionSuccess"], event.metadata["actionReturn"]) == (True, None)
    assert before_apple.step("MoveAgent").metadata["errorMessage"] == "Must specify ahead or right!"
    before = before_apple.step("TeleportFull", **BEFORE_APPLE).metadata["agent"]
    assert before_apple.step("RotateRight", degrees=0).metadata["agent"] == before
    event = before_apple.step("MoveAhead", moveMagnitude=-0.25)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["agent"]["position"]["x"] == pytest.approx(before["position"]["x"] - 0.25)


def test_the_hand_takes_all_that_it_touches(before_apple) -> None:
    start = before_apple.step("TeleportFull", **BEFORE_APPLE)
    assert before_apple.step("MoveArmBase", y=1.25, normalizedY=False)
    event = before_apple.step("MoveArm", position=start.get_object(APPLE)["position"], coordinateSpace="world")
    assert event, event.metadata["errorMessage"]
    event = before_apple.step("SetHandSphereRadius", radius=0.5)
    touched = event.metadata["arm"]["pickupableObjects"]
    assert len(touched) > 1
    before = {name: event.get_object(name)["position"] for name in touched}
    event = before_apple.step("PickupObject")
    assert event, event.metadata["errorMessage"]
    assert event.metadata["arm"]["heldObjects"] == touched
    assert event.metadata["inventoryObjects"] == []
    assert all(event.get_object(name)["isPickedUp"] for name in touched)
    assert not any(event.get_object(name)["parentReceptacles"] for name in touched)
    for name in touched:
        assert list(event.get_object(name)["position"].values()) == pytest.approx(list(before[name].values()), abs=0.01)
    event = before_apple.step("ReleaseObject")
    assert event, event.metadata["errorMessage"]
    assert event.metadata["arm"]["heldObjects"] == []
    assert not any(event.get_object(name)["isPickedUp"] for name in touched)
    assert all(event.get_object(name)["parentReceptacles"] for name in touched)
    event = before_apple.step("PickupObject", objectIdCandidates=touched[:1])
    assert event.metadata["arm"]["heldObjects"] == touched[:1]
