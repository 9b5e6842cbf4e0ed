"""Actions as earlier versions of AI2-THOR called them, which public code still does."""

import math

import pytest

from tests.thor.test_arm import stand_before
from tests.thor.test_objects import APPLE, BEFORE_APPLE, ISLAND

pytestmark = pytest.mark.slow


@pytest.fixture
def holding(kitchen):
    assert kitchen.step("TeleportFull", **BEFORE_APPLE)
    assert kitchen.step("PickupObject", objectId=APPLE)
    return kitchen


def held(event) -> dict:
    return event.get_object(APPLE)


def test_what_is_held_is_moved_and_turned(holding) -> None:
    before = held(holding.last_event)["position"]
    event = holding.step("MoveHandDelta", x=0.05, y=0.1, z=0.0)
    assert event, event.metadata["errorMessage"]
    assert held(event)["position"]["y"] > before["y"] + 0.05
    event = holding.step("MoveHandDown", moveMagnitude=0.02)
    assert event, event.metadata["errorMessage"]
    event = holding.step("RotateHand", x=40, y=0, z=0)
    assert event, event.metadata["errorMessage"]
    assert holding.step("RotateHandRelative", y=30)
    event = holding.step("PlaceHeldObject", objectId=ISLAND)
    assert event, event.metadata["errorMessage"]
    assert held(event)["parentReceptacles"] == [ISLAND]


def test_positions_are_those_of_interactable_poses(kitchen) -> None:
    few = {"objectId": APPLE, "horizons": [30], "standings": [True]}
    poses = kitchen.step("GetInteractablePoses", **few).metadata["actionReturn"]
    lists = kitchen.step("PositionsFromWhichItemIsInteractable", **few).metadata["actionReturn"]
    assert len(poses) > 10
    assert [dict(zip(lists, values, strict=True)) for values in zip(*lists.values(), strict=True)] == poses
    assert {type(number) for values in lists.values() for number in values} == {float}
    for wrong in ({"maxPoses": 0}, {"horizon": 0}):
        message = kitchen.step("PositionsFromWhichItemIsInteractable", objectId=APPLE, **wrong).metadata["errorMessage"]
        assert " must be " in message


def test_tilts_to_look_from_are_as_far_apart_as_asked(kitchen) -> None:
    seen = {}
    for apart in (30, 45):
        asked = {"objectId": APPLE, "standings": [True], "horizon": apart}
        seen[apart] = set(
            kitchen.step("PositionsFromWhichItemIsInteractable", **asked).metadata["actionReturn"]["horizon"]
        )
    assert {0.0, 30.0} <= seen[30] <= {-30.0, 0.0, 30.0, 60.0}
    assert {15.0} <= seen[45] <= {-30.0, 15.0, 60.0}


def test_a_hand_goes_up_whichever_way_the_camera_is_tilted(holding) -> None:
    assert holding.step("RotateLook", horizon=30)
    before = held(holding.last_event)["position"]
    after = held(holding.step("MoveHand", y=0.05))["position"]
    assert [after[axis] - before[axis] for axis in "xyz"] == pytest.approx([0.0, 0.05, 0.0], abs=1e-5)
    lifted = held(holding.step("MoveHandDelta", y=0.05))["position"]
    assert lifted["y"] - after["y"] == pytest.approx(0.05 * math.cos(math.radians(30)), abs=1e-5)


def test_the_arm_takes_an_apple_and_lets_it_go(armed) -> None:
    apple = armed.last_event.get_object(APPLE)["axisAlignedBoundingBox"]["center"]
    stand_before(armed, apple)
    assert armed.step("MoveMidLevelArmHeight", y=0.6, speed=1, returnToStart=False, disableRendering=True)
    agent = armed.last_event.metadata["agent"]
    shoulder = armed.last_event.metadata["arm"]["joints"][0]["position"]
    yaw = math.radians(agent["rotation"]["y"])
    dx, dz = apple["x"] - shoulder["x"], apple["z"] - shoulder["z"]
    target = {
        "x": dx * math.cos(yaw) - dz * math.sin(yaw),
        "y": apple["y"] + 0.02 - shoulder["y"],
        "z": dx * math.sin(yaw) + dz * math.cos(yaw),
    }
    event = armed.step("MoveMidLevelArm", position=target, handCameraSpace=False, speed=2, returnToStart=False)
    assert event, event.metadata["errorMessage"]
    event = armed.step("PickUpMidLevelHand")
    assert event, event.metadata["errorMessage"]
    assert event.metadata["arm"]["heldObjects"] == [APPLE]
    assert armed.step("DropMidLevelHand")
    assert armed.last_event.metadata["arm"]["heldObjects"] == []


def test_looks_along_a_heading_and_at_an_angle(kitchen) -> None:
    event = kitchen.step({"action": "Rotate", "rotation": 215.0})
    assert event.metadata["agent"]["rotation"]["y"] == pytest.approx(215.0)
    event = kitchen.step({"action": "Look", "horizon": 30})
    assert event.metadata["agent"]["cameraHorizon"] == pytest.approx(30.0)
    assert not kitchen.step({"action": "Look", "horizon": 80})


@pytest.mark.parametrize("rotation", [0.0, 90.0, 200.0])
def test_steps_along_the_axes_of_the_room(kitchen, rotation) -> None:
    start = {"x": 1.25, "y": 0.9, "z": 1.25}
    assert kitchen.step("Teleport", position=start, rotation=rotation)
    for step, axis in ({"x": 0.25}, "x"), ({"z": -0.25}, "z"), ({"x": -0.25, "moveMagnitude": 0.25}, "x"):
        before = kitchen.last_event.metadata["agent"]["position"]
        event = kitchen.step("Move", **step)
        assert event, event.metadata["errorMessage"]
        assert event.metadata["agent"]["position"] == pytest.approx({**before, axis: before[axis] + step[axis]})


def test_the_agent_walks_and_turns_by_any_amount(armed) -> None:
    before = armed.last_event.metadata["agent"]
    assert armed.step("RotateContinuous", degrees=90, speed=2)
    event = armed.step("RotateContinuous", degrees=-90)
    assert event.metadata["agent"]["rotation"]["y"] == pytest.approx(before["rotation"]["y"])
    moved = armed.step("MoveContinuous", direction={"x": 0.0, "y": 0.0, "z": 0.1}, returnToStart=True)
    assert moved, moved.metadata["errorMessage"]
    now = moved.metadata["agent"]["position"]
    assert math.dist([now["x"], now["z"]], [before["position"]["x"], before["position"]["z"]]) == pytest.approx(0.1)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_what_is_held_turns_about_the_agents_axes(holding, axis) -> None:
    holding.step("RotateLook", horizon=0)  # so that the camera's axes are the agent's
    event = holding.step("RotateHand", x=0, y=0, z=0)
    assert event, event.metadata["errorMessage"]
    event = holding.step("RotateHandRelative", **{axis: 30})
    assert event, event.metadata["errorMessage"]
    assert event.metadata["heldObjectPose"]["localRotation"][axis] == pytest.approx(30.0, abs=0.1)
