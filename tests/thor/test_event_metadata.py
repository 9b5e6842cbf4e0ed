"""The objects of an event are worked out when they are read, and are those of the moment of the event all the same."""

import copy
import json
import pickle
import random

import pytest

from remqa_data.thor.session import LEAVES_ROOM_AS_IT_IS
from remqa_data.thor.state.objects import ObjectRecords

pytestmark = pytest.mark.slow

FRIDGE = "Fridge|-02.10|+00.00|+01.07"
APPLE = "Apple|-00.47|+01.15|+00.48"
CHANGES = (
    {"action": "OpenObject", "objectId": FRIDGE, "forceAction": True},
    {"action": "PickupObject", "objectId": APPLE, "forceAction": True},
    {"action": "RemoveFromScene", "objectId": APPLE},
    {"action": "Initialize", "visibilityDistance": 5.0},
    {"action": "Reset", "sceneName": "FloorPlan402"},
)
WAYS = {
    "json": lambda metadata: json.loads(json.dumps(metadata)),
    "dict": dict,
    "unpacked": lambda metadata: {**metadata},
    "copy": lambda metadata: metadata.copy(),
    "deepcopy": copy.deepcopy,
    "pickle": lambda metadata: pickle.loads(pickle.dumps(metadata)),
    "items": lambda metadata: dict(metadata.items()),
    "keys and values": lambda metadata: dict(zip(metadata.keys(), metadata.values(), strict=True)),
    "iterated": lambda metadata: {name: metadata[name] for name in metadata},
    "or": lambda metadata: metadata | {},
    "ror": lambda metadata: {} | metadata,
    "get": lambda metadata: {name: metadata.get(name) for name in [*metadata]},
    "set by default": lambda metadata: {**metadata, "objects": metadata.setdefault("objects", [])},
    "popped": lambda metadata: dict(metadata.popitem() for _ in range(len(metadata))),
}


def counted(monkeypatch) -> list[int]:
    """How many listings have been made since."""
    made, listing = [], ObjectRecords.listing

    def count(*arguments):
        made.append(1)
        return listing(*arguments)

    monkeypatch.setattr(ObjectRecords, "listing", count)
    return made


def test_what_nobody_reads_is_not_worked_out(kitchen, monkeypatch) -> None:
    made = counted(monkeypatch)
    for action in ("RotateRight", "MoveAhead", "Pass"):
        event = kitchen.step(action, renderImage=False)
        assert event.metadata["agent"]["name"] == "agent"
        assert event.metadata.get("lastAction") == action
        assert "objects" in event.metadata
        assert "reachablePositions" not in event.metadata
    assert not made
    assert event.metadata["objects"] is event.metadata["objects"]
    assert len(made) == 1


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change["action"])
@pytest.mark.parametrize("sees", [True, False], ids=["pictures", "no pictures"])
def test_a_kept_event_tells_of_the_room_as_it_was(kitchen, change, sees) -> None:
    rng, kept, known = random.Random(1), [], []
    places = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    for place in rng.sample(places, 4):
        for heading in (0, 180):
            pose = {"position": place, "rotation": heading, "renderImage": sees}
            kept.append(kitchen.step("Teleport", **pose))
            known.append(copy.deepcopy(kitchen.step("Teleport", **pose).metadata["objects"]))
    assert kitchen.step(**change)
    assert [event.metadata["objects"] for event in kept] == known


@pytest.mark.parametrize("mode", ["default", "arm"])
def test_what_is_said_to_leave_the_room_as_it_is_does_so_even_with_something_in_the_hand(kitchen, mode) -> None:
    """Kept events rely on it: they are not read before such an action."""
    kitchen.reset(agentMode=mode)
    room = kitchen.server.session._simulator.room
    room.agent.pick_up(APPLE, force=True)
    kitchen.step("Pass")
    place = kitchen.step("GetReachablePositions").metadata["actionReturn"][5]
    assert len(LEAVES_ROOM_AS_IT_IS) > 10
    for action in [*sorted(LEAVES_ROOM_AS_IT_IS)] * 2:
        request = {"position": place, "rotation": 90} if action.startswith("Teleport") else {}
        kept = kitchen.step("Pass", renderImage=False)
        known = copy.deepcopy(kitchen.step("Pass", renderImage=False).metadata["objects"])
        before = room.view.version
        kitchen.step(action, renderImage=False, **request)
        assert room.view.version == before, action
        assert kept.metadata["objects"] == known, action


def test_an_event_outlives_its_controller(kitchen) -> None:
    from remqa_data.thor import Controller

    with Controller(scene="FloorPlan402", width=64, height=64, headless=True) as controller:
        kept = controller.step("RotateRight")
        known = copy.deepcopy(controller.step("Pass").metadata["objects"])
    assert kept.metadata["objects"] == known


@pytest.mark.parametrize("way", WAYS)
def test_it_is_a_dictionary_with_its_objects_however_it_is_read(kitchen, way) -> None:
    event, again = (kitchen.step("Pass", renderImage=False) for _ in range(2))
    whole = {name: again.metadata[name] for name in {*again.metadata, "objects"}}
    read = WAYS[way](event.metadata)
    assert len(read["objects"]) > 50
    assert read == whole


def test_equal_events_are_equal_whichever_was_read(kitchen) -> None:
    one, other = (kitchen.step("Pass", renderImage=False).metadata for _ in range(2))
    assert one == other
    assert (one != other) is False
    assert len(one) == len(other)


def test_a_client_may_put_something_else_there(kitchen) -> None:
    metadata = kitchen.step("Pass", renderImage=False).metadata
    metadata["objects"] = []
    assert dict(metadata)["objects"] == metadata["objects"] == []
    other = kitchen.step("Pass", renderImage=False).metadata
    del other["objects"]
    assert "objects" not in other
    with pytest.raises(KeyError):
        other["objects"]


def test_each_of_several_agents_has_its_own(kitchen) -> None:
    event = kitchen.reset(agentCount=2)
    kitchen.step("RotateRight", agentId=1)
    event = kitchen.step("MoveAhead", agentId=0)
    listed = [one.metadata["objects"] for one in event.events]
    assert [record["objectId"] for record in listed[0]] == [record["objectId"] for record in listed[1]]
    assert [record["distance"] for record in listed[0]] != [record["distance"] for record in listed[1]]
    assert event.metadata is event.events[0].metadata
