"""Several agents in a room: each has its own events, and they are in each other's way."""

import numpy as np
import pytest

from remqa_data.thor import Controller
from tests.helpers.thor_clients import first_id, stands_at

pytestmark = pytest.mark.slow

APPLE, FRIDGE = "Apple|-00.47|+01.15|+00.48", "Fridge|-02.10|+00.00|+01.07"
EGG, ISLAND = "Egg|-02.04|+00.81|+01.24", "CounterTop|-00.08|+01.15|00.00"


@pytest.fixture
def two(kitchen) -> Controller:
    kitchen.reset("FloorPlan1", agentCount=2)
    yield kitchen
    kitchen.initialization_parameters.pop("agentCount")
    kitchen.initialization_parameters.pop("makeAgentsVisible", None)


def test_there_is_an_event_for_each(two) -> None:
    event = two.step("RotateRight", agentId=1)
    first, second = event.events
    assert [e.metadata["agentId"] for e in event.events] == [0, 1]
    assert event.metadata == second.metadata
    assert (first.metadata["lastAction"], second.metadata["lastAction"]) == ("Initialize", "RotateRight")
    turn = [e.metadata["agent"]["rotation"]["y"] for e in event.events]
    assert (turn[1] - turn[0]) % 360 == pytest.approx(90)
    assert not np.array_equal(first.frame, second.frame)
    assert two.step("RotateLeft").metadata["agentId"] == 0


def test_what_one_does_the_other_finds(two) -> None:
    event = two.step("OpenObject", objectId=FRIDGE, forceAction=True, agentId=1)
    assert [e.get_object(FRIDGE)["isOpen"] for e in event.events] == [True, True]
    assert two.step("PickupObject", objectId=APPLE, forceAction=True, agentId=1)
    held = [[o["objectId"] for o in e.metadata["inventoryObjects"]] for e in two.last_event.events]
    assert held == [[], [APPLE]]
    records = [e.get_object(APPLE) for e in two.last_event.events]
    assert records[0]["isPickedUp"]
    assert records[0]["position"] == records[1]["position"]
    hand = two.last_event.events[1].metadata["heldObjectPose"]["position"]
    assert sum(abs(records[0]["position"][axis] - hand[axis]) for axis in "xyz") < 0.1


def inventories(event) -> list[list[str]]:
    return [[o["objectId"] for o in e.metadata["inventoryObjects"]] for e in event.events]


def test_each_holds_a_thing_of_its_own(two) -> None:
    assert two.step("PickupObject", objectId=APPLE, forceAction=True, agentId=1)
    assert not two.step("PickupObject", objectId=APPLE, forceAction=True, agentId=0)
    assert two.last_event.metadata["errorMessage"] == f"agent 1 holds {APPLE}"
    for action in ("DropHandObject", "ThrowObject", "MoveHeldObjectAhead"):
        arguments = {"moveMagnitude": 1.0} if action == "ThrowObject" else {}
        assert not two.step(action, agentId=0, **arguments)
    event = two.step("PickupObject", objectId=EGG, forceAction=True, agentId=0, renderInstanceSegmentation=True)
    assert event, event.metadata["errorMessage"]
    assert inventories(event) == [[EGG], [APPLE]]
    for number, name in enumerate((EGG, APPLE)):
        assert name in event.events[number].instance_masks
        hand = event.events[number].metadata["heldObjectPose"]["position"]
        for seen_by in event.events:
            record = seen_by.get_object(name)
            assert record["isPickedUp"]
            assert sum(abs(record["position"][axis] - hand[axis]) for axis in "xyz") < 0.1
    assert two.step("MoveHeldObjectUp", moveMagnitude=0.05, agentId=1)
    assert two.step("PutObject", objectId=ISLAND, forceAction=True, agentId=1)
    assert inventories(two.last_event) == [[EGG], []]
    assert two.last_event.events[0].get_object(APPLE)["parentReceptacles"] == [ISLAND]
    assert two.step("DropHandObject", agentId=0)
    assert inventories(two.last_event) == [[], []]


def test_one_slices_while_both_hold_something(two) -> None:
    knife = first_id(two, "Knife")
    assert two.step("PickupObject", objectId=knife, forceAction=True, agentId=0)
    assert two.step("PickupObject", objectId=EGG, forceAction=True, agentId=1)
    event = two.step("MoveHeldObjectUp", moveMagnitude=0.05, agentId=1)
    hand = event.metadata["heldObjectPose"]
    event = two.step("SliceObject", objectId=APPLE, forceAction=True, agentId=0)  # loads the room anew
    assert event, event.metadata["errorMessage"]
    assert inventories(event) == [[knife], [EGG]]
    assert event.events[1].metadata["heldObjectPose"] == hand


def test_who_slices_is_told_so(two) -> None:
    event = two.step("SliceObject", objectId=APPLE, forceAction=True, agentId=1)
    assert event.metadata["agentId"] == 1
    assert [one.metadata["lastAction"] for one in event.events] == ["Initialize", "SliceObject"]
    assert two.step("RotateRight").metadata["agentId"] == 0


def test_what_one_was_answered_is_its_own_in_every_event(two) -> None:
    positions = two.step("GetReachablePositions", agentId=1).metadata["actionReturn"]
    count = len(positions)
    positions.clear()
    event = two.step("RotateRight", agentId=0)
    assert len(event.events[1].metadata["actionReturn"]) == count > 100


def test_who_stands_where_another_came_turns_and_looks(two) -> None:
    x, z = stands_at(two.last_event.events[1])
    assert two.step("Teleport", position={"x": x, "y": 0.9, "z": z}, forceAction=True, agentId=0)
    assert two.step("RotateLook", rotation={"x": 0, "y": 90, "z": 0}, horizon=30, agentId=0)
    assert not two.step("Teleport", position={"x": x, "y": 0.9, "z": z + 0.05}, agentId=0)


def test_they_begin_apart_and_do_not_walk_through_each_other(two) -> None:
    event = two.last_event
    gap = np.subtract(stands_at(event.events[1]), stands_at(event.events[0]))
    assert 0.5 <= np.linalg.norm(gap) < 1.0
    axis = int(np.argmax(np.abs(gap)))
    ahead = {0: 90.0, 1: 0.0}[axis] + (180.0 if gap[axis] < 0 else 0.0)
    two.step("TeleportFull", rotation={"x": 0.0, "y": ahead, "z": 0.0}, agentId=0)
    refused = [two.step("MoveAhead", agentId=0) for _ in range(3)][-1]
    assert not refused
    assert refused.metadata["errorMessage"].startswith("Agent 1 is blocking Agent 0 from moving by (")
    assert refused.metadata["collidedObjects"] == ["Agent 1"]
    onto = two.last_event.events[1].metadata["agent"]["position"]
    assert not two.step("Teleport", position=onto, agentId=0)
    assert two.step("Teleport", position=onto, agentId=0, forceAction=True)


def test_an_agent_that_is_not_there_is_an_error(two) -> None:
    with pytest.raises(ValueError, match="agentId 2 is not an agent here: there are 2, from number 0"):
        two.step("Pass", agentId=2)
    for number in (1, 1.0, "1"):  # as Unity reads JSON
        assert two.step("Pass", agentId=number).metadata["agentId"] == 1
    with pytest.raises(ValueError, match="agentCount 9 is not between 1 and 8"):
        two.reset("FloorPlan1", agentCount=9)


def test_what_an_agent_held_that_is_gone_falls(two) -> None:
    assert two.step("PickupObject", objectId=EGG, forceAction=True, agentId=0)
    assert two.step("PickupObject", objectId=APPLE, forceAction=True, agentId=1)
    event = two.step("Initialize", agentCount=1)
    assert inventories(event) == [[EGG]]
    assert not event.events[0].get_object(APPLE)["isPickedUp"]
    assert two.step("DropHandObject")


def test_one_agent_again(two) -> None:
    event = two.reset("FloorPlan1", agentCount=1)
    assert event.metadata["agentId"] == 0
    assert [e.metadata["agentId"] for e in event.events] == [0]


def facing(two, **settings):
    """The event after agent 0 has turned to the fridge, and agent 1 has come between them, with all images of both."""
    two.reset("FloorPlan1", agentCount=2, renderDepthImage=True, renderInstanceSegmentation=True, **settings)
    poses = two.step("GetInteractablePoses", objectId=FRIDGE, horizons=[0], standings=[True], rotations=[270]).metadata[
        "actionReturn"
    ]
    far = max(poses, key=lambda pose: pose["x"])
    two.step("TeleportFull", **far, agentId=0)
    between = {"x": far["x"] - 0.75, "y": far["y"], "z": far["z"]}
    event = two.step("Teleport", position=between, agentId=1, forceAction=True)
    assert event, event.metadata["errorMessage"]
    return event


def pose_of(event, number: int) -> dict:
    agent = event.events[number].metadata["agent"]
    return {
        **agent["position"],
        "rotation": agent["rotation"],
        "horizon": 0.0,
        "standing": True,
    }


def test_they_see_each_other(two) -> None:
    hidden = facing(two, makeAgentsVisible=False).events
    seen = facing(two, makeAgentsVisible=True).events
    is_body = seen[0].depth_frame < hidden[0].depth_frame - 0.01
    assert 0.03 < is_body.mean() < 0.6
    gap = float(np.linalg.norm(np.subtract(stands_at(two.last_event.events[0]), stands_at(two.last_event.events[1]))))
    assert gap - 0.3 < seen[0].depth_frame[is_body].min() < gap
    # A body is no object, and hides those that are behind it.
    behind = {name for name, mask in hidden[0].instance_masks.items() if (mask & is_body).any()}
    assert FRIDGE in behind
    assert not any((mask & is_body).any() for mask in seen[0].instance_masks.values())
    # Nobody sees itself, nor anything else than before where no body is.
    assert np.array_equal(seen[1].depth_frame, hidden[1].depth_frame)
    assert np.array_equal(seen[0].depth_frame[~is_body], hidden[0].depth_frame[~is_body])


def test_what_one_holds_the_other_sees_in_its_hand(two) -> None:
    facing(two)
    event = two.step("PickupObject", objectId=APPLE, forceAction=True, agentId=1)
    towards = (event.events[0].metadata["agent"]["rotation"]["y"] + 180) % 360
    event = two.step("TeleportFull", **pose_of(event, 1) | {"rotation": towards}, agentId=1)
    assert event, event.metadata["errorMessage"]
    assert APPLE in event.events[0].instance_masks
    assert APPLE in event.events[1].instance_masks
    rows, columns = np.nonzero(event.events[0].instance_masks[APPLE])
    assert abs(columns.mean() - 150) < 30
    hand, eye = (event.events[n].metadata[key] for n, key in ((1, "heldObjectPose"), (0, "cameraPosition")))
    depth = event.events[0].depth_frame[rows, columns].mean()
    assert depth == pytest.approx(np.hypot(hand["position"]["x"] - eye["x"], hand["position"]["z"] - eye["z"]), abs=0.1)
    gone = two.step("DropHandObject", agentId=1)
    assert not gone.events[0].get_object(APPLE)["isPickedUp"]


def test_a_camera_in_the_room_sees_the_agent_and_one_in_its_eye_does_not(two) -> None:
    event = two.reset("FloorPlan1", agentCount=1, renderDepthImage=True)
    own = event.metadata["cameraPosition"], event.metadata["agent"]["rotation"]
    above = two.step("GetMapViewCameraProperties").metadata["actionReturn"]
    two.step("AddThirdPartyCamera", **above)
    event = two.step("AddThirdPartyCamera", position=own[0], rotation={**own[1], "x": 0})
    assert np.array_equal(event.third_party_depth_frames[1], event.depth_frame)
    before = event.third_party_depth_frames[0]
    moved = next(e for e in (two.step(f"Move{way}") for way in ("Ahead", "Back", "Left", "Right")) if e)
    changed = np.abs(moved.third_party_depth_frames[0] - before) > 0.05
    assert 0.001 < changed.mean() < 0.05
    two.step("Initialize", makeAgentsVisible=False, renderDepthImage=True)
    assert (two.last_event.third_party_depth_frames[0] >= np.maximum(before, moved.third_party_depth_frames[0])).all()


def test_agents_may_be_let_through_each_other(two) -> None:
    x, z = stands_at(two.last_event.events[1])
    start = two.step("TeleportFull", x=x, y=0.9, z=z, rotation=0, horizon=0, standing=True, forceAction=True, agentId=0)
    assert start, start.metadata["errorMessage"]
    free = [a for a in ("MoveAhead", "MoveBack", "MoveLeft", "MoveRight") if two.step(a, agentId=0)]
    two.step("TeleportFull", x=x, y=0.9, z=z, rotation=0, horizon=0, standing=True, forceAction=True, agentId=0)
    assert free
    back = {"MoveAhead": "MoveBack", "MoveBack": "MoveAhead", "MoveLeft": "MoveRight", "MoveRight": "MoveLeft"}[free[0]]
    for _ in range(2):
        assert two.step(free[0], agentId=0)
    blocked = two.step(back, moveMagnitude=0.5, agentId=0)
    assert blocked.metadata["errorMessage"].startswith("Agent 1 is blocking Agent 0")
    through = two.step(back, moveMagnitude=0.5, allowAgentsToIntersect=True, agentId=0)
    assert through, through.metadata["errorMessage"]
    assert stands_at(through.events[0]) == pytest.approx((x, z))
