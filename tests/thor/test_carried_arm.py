import numpy as np
import pytest

from tests.helpers.thor_arm import APPLE, BEFORE_APPLE, from_shoulder, hand, stand_before

pytestmark = pytest.mark.slow


REACHED_OUT = {"x": 0.05, "y": 0.1, "z": 0.45}


def test_the_arm_is_carried_as_it_is_held(before_apple) -> None:
    assert before_apple.step("Teleport", position={"x": -1.0, "y": 0.9, "z": -0.5}, rotation=180)
    assert before_apple.step("MoveArmBase", y=1.4, normalizedY=False)
    before = before_apple.step("MoveArm", position=REACHED_OUT)
    assert before, before.metadata["errorMessage"]
    for action in (
        {"action": "MoveAgent", "ahead": 0.1},
        {"action": "RotateAgent", "degrees": 30},
        {"action": "MoveAgent", "ahead": -0.1, "right": 0.05},
        {"action": "RotateLeft", "degrees": 50},
        {"action": "MoveBack", "moveMagnitude": 0.05},
        {"action": "LookDown"},
        {"action": "Crouch"},
        {"action": "Teleport", "position": {"x": -1.0, "y": 0.9, "z": -0.25}},
    ):
        event = before_apple.step(**action)
        assert event, (action, event.metadata["errorMessage"])
        assert from_shoulder(event) == pytest.approx(from_shoulder(before), abs=1e-6), action
    assert hand(event) != pytest.approx(hand(before), abs=0.1)


def test_an_arm_that_is_held_out_meets_what_the_agent_would_pass(before_apple) -> None:
    """The worktop of the island is ahead, at 1.1 m."""
    assert before_apple.step("MoveBack", moveMagnitude=0.25)
    assert before_apple.step("MoveArmBase", y=0.9, normalizedY=False)
    assert before_apple.step("MoveArm", position={"x": 0.0, "y": 0.0, "z": 0.3})
    start = before_apple.last_event.metadata["agent"]["position"]
    event = before_apple.step("MoveAgent", ahead=0.25)
    assert not event
    assert "is blocking" in event.metadata["errorMessage"]
    assert event.metadata["agent"]["position"] == start
    event = before_apple.step("MoveAgent", ahead=0.25, returnToStart=False)
    assert not event
    walked = event.metadata["agent"]["position"]["x"] - start["x"]
    assert 0.02 < walked < 0.25
    assert not before_apple.step("MoveAgent", ahead=0.02)
    assert before_apple.step("MoveAgent", ahead=-walked)
    assert before_apple.step("MoveArmBase", y=1.4, normalizedY=False)
    assert before_apple.step("MoveAgent", ahead=0.25), "it passes above"


def test_an_arm_that_is_held_out_does_not_turn_into_things(before_apple) -> None:
    before_apple.step("RotateAgent", degrees=180)
    assert before_apple.step("MoveArmBase", y=0.9, normalizedY=False)
    assert before_apple.step("MoveArm", position={"x": 0.0, "y": 0.0, "z": 0.5})
    before = before_apple.last_event.metadata
    for degrees in (180, -180, 540):
        event = before_apple.step("RotateAgent", degrees=degrees)
        assert not event
        assert "is blocking Agent from turning" in event.metadata["errorMessage"]
        assert event.metadata["agent"] == before["agent"]
        assert event.metadata["arm"] == before["arm"]
    assert before_apple.step("RotateAgent", degrees=20)
    event = before_apple.step("RotateAgent", degrees=180, returnToStart=False)
    assert not event
    assert 20 < (event.metadata["agent"]["rotation"]["y"] - before["agent"]["rotation"]["y"]) % 360 < 180
    assert event.metadata["arm"] != before["arm"]
    assert not before_apple.step("RotateAgent", degrees=1)


def test_the_arm_folds_where_it_would_be_in_something_after_a_teleport(armed) -> None:
    assert armed.step("TeleportFull", **{**BEFORE_APPLE, "rotation": 270})
    folded = from_shoulder(armed.last_event)
    assert armed.step("MoveArmBase", y=0.9, normalizedY=False)
    out = from_shoulder(armed.step("MoveArm", position={"x": 0.0, "y": 0.0, "z": 0.5}))
    assert from_shoulder(armed.step("RotateLook", horizon=0)) == out
    event = armed.step("TeleportFull", **BEFORE_APPLE)  # before the island
    assert event
    assert from_shoulder(event) == pytest.approx(folded, abs=1e-6)


def test_an_arm_that_finds_its_own_way_goes_back(armed) -> None:
    fridge = "Fridge|-02.10|+00.00|+01.07"
    pose = armed.step("GetInteractablePoses", objectId=fridge, standings=[True]).metadata["actionReturn"][0]
    assert armed.step("TeleportFull", **pose)
    before = armed.last_event.metadata["arm"]["joints"]
    event = armed.step("OpenObject", objectId=fridge)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["arm"]["joints"] == before


def test_what_the_hand_holds_stops_before_the_fridge(armed) -> None:
    bread, fridge = "Bread|-00.52|+01.17|-00.03", "Fridge|-02.10|+00.00|+01.07"
    middle = armed.last_event.get_object(bread)["axisAlignedBoundingBox"]["center"]
    stand_before(armed, middle)
    assert armed.step("MoveArm", position=middle, coordinateSpace="world")
    assert armed.step("PickupObject", objectIdCandidates=[bread])
    assert armed.step("MoveArmRelative", offset={"x": 0.0, "y": 0.15, "z": -0.1})
    assert armed.step("Teleport", position={"x": -1.0, "y": 0.9, "z": 1.0}, rotation=270)
    reaches = [armed.step("MoveArm", position={"x": 0.0, "y": 0.0, "z": z}) for z in np.arange(0.3, 0.65, 0.05)]
    assert [bool(event) for event in reaches] == sorted((bool(event) for event in reaches), reverse=True)
    stopped = armed.last_event
    assert f"{fridge} is blocking" in stopped.metadata["errorMessage"]
    load, wall = (stopped.get_object(name)["axisAlignedBoundingBox"] for name in (bread, fridge))
    front = wall["center"]["x"] + wall["size"]["x"] / 2
    assert load["center"]["x"] - load["size"]["x"] / 2 > front - 0.06  # its handle stands out
    assert hand(stopped)["x"] > front + 0.05
    fell = armed.step("ReleaseObject")
    assert fell.get_object(bread)["position"]["y"] < stopped.get_object(bread)["position"]["y"]


def test_what_the_hand_holds_does_not_turn_into_the_worktop(armed) -> None:
    knife = "ButterKnife|-00.41|+01.11|-00.46"
    middle = armed.last_event.get_object(knife)["axisAlignedBoundingBox"]["center"]
    stand_before(armed, middle)
    assert armed.step("MoveArm", position=middle, coordinateSpace="world")
    before = armed.step("PickupObject", objectIdCandidates=[knife])
    assert before, before.metadata["errorMessage"]
    for turn in ({"pitch": 90}, {"roll": 90}, {"roll": -90}):
        event = armed.step("RotateWristRelative", **turn, returnToStart=False)
        assert "CounterTop|-00.08|+01.15|00.00 is blocking" in event.metadata["errorMessage"], turn
        assert event.metadata["arm"] == before.metadata["arm"]
        assert event.get_object(knife)["rotation"] == before.get_object(knife)["rotation"]
    assert armed.step("MoveArmRelative", offset={"x": 0.0, "y": 0.2, "z": 0.0})
    event = armed.step("RotateWristRelative", roll=90)
    assert event, event.metadata["errorMessage"]
    assert event.get_object(knife)["rotation"] != before.get_object(knife)["rotation"]


def test_an_arm_does_not_reach_into_another_agent(armed) -> None:
    armed.reset(agentMode="arm", agentCount=2)
    for number, z in enumerate((0.5, 1.0)):
        assert armed.step("TeleportFull", **{**BEFORE_APPLE, "z": z, "rotation": 0}, agentId=number)
    event = armed.step("MoveArm", position={"x": 0.0, "y": 0.1, "z": 0.35}, agentId=0)
    assert not event
    assert "another Agent is blocking" in event.metadata["errorMessage"]
    armed.initialization_parameters.pop("agentCount")


def test_an_agent_does_not_walk_into_the_arm_of_another_one(armed) -> None:
    """The first one holds its arm out across the way of the second one, which passes beside its body."""
    armed.reset(agentMode="arm", agentCount=2)
    armed.initialization_parameters.pop("agentCount")
    assert armed.step("TeleportFull", **{**BEFORE_APPLE, "x": 1.25, "z": -0.5, "rotation": 0}, agentId=0)
    start = {**BEFORE_APPLE, "x": 1.75, "z": 1.0, "rotation": 180}
    ways = {}
    for out in (False, True):
        if out:
            assert armed.step("MoveArmBase", y=1.0, normalizedY=False, agentId=0)
            assert armed.step("MoveArm", position={"x": 0.4, "y": 0.1, "z": 0.3}, agentId=0)
        assert armed.step("TeleportFull", **start, agentId=1)
        ways[out] = [armed.step("MoveAgent", ahead=0.1, agentId=1) for _ in range(15)]
    assert all(ways[False])
    errors = [event.events[1].metadata["errorMessage"] for event in ways[True] if not event.events[1]]
    assert errors
    assert all("Agent 0 is blocking Agent" in error for error in errors)
    assert armed.step("MoveAgent", ahead=-0.1, agentId=1), "it may walk away from it"
    assert not armed.step("Teleport", position={"x": 1.7, "y": 0.9, "z": -0.1}, agentId=1)


def test_what_a_folded_arm_holds_is_in_the_way(armed) -> None:
    """The hand's ball is made so large that the folded arm takes what stands before the agent."""
    apple = armed.last_event.get_object(APPLE)["axisAlignedBoundingBox"]["center"]
    stand_before(armed, apple)
    assert armed.step("MoveArmBase", y=apple["y"], normalizedY=False)
    assert armed.step("SetHandSphereRadius", radius=0.5)
    assert armed.step("PickupObject", objectIdCandidates=[APPLE])
    agent = armed.server.session._simulator.agent
    assert agent.arm.is_folded
    wall = np.array(agent.held_at()) - agent.position
    ahead = next(k * 0.02 for k in range(1, 200) if not armed.step("MoveAgent", ahead=0.02))
    assert ahead
    assert "is blocking" in armed.last_event.metadata["errorMessage"]
    assert np.allclose(np.array(agent.held_at()) - agent.position, wall, atol=1e-6)


def test_a_door_that_opens_to_where_the_hand_is_folds_the_arm(armed) -> None:
    fridge = "Fridge|-02.10|+00.00|+01.07"
    assert armed.step("TeleportFull", x=-1.5, y=0.9, z=2.0, rotation=180, horizon=0, standing=True)
    assert armed.step("MoveArm", position={"x": 0.0, "y": 0.1, "z": 0.35})
    assert armed.step("OpenObject", objectId=fridge)
    agent = armed.server.session._simulator.agent
    assert agent.arm.is_free(agent.base)
    assert agent.arm.is_folded
