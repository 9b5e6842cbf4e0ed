"""InitialRandomSpawn, as AI2-THOR documents it."""

from collections.abc import Iterator

import numpy as np
import pytest

from remqa_data.thor import Controller
from tests.thor.test_placing import assert_at_rest_and_apart

pytestmark = pytest.mark.slow

EGG, FRIDGE, APPLE = "Egg|-02.04|+00.81|+01.24", "Fridge|-02.10|+00.00|+01.07", "Apple|-00.47|+01.15|+00.48"
COUNTERS = ("CounterTop|-00.08|+01.15|00.00", "CounterTop|-01.87|+00.95|-01.21", "CounterTop|+00.69|+00.95|-02.48")


@pytest.fixture(scope="module")
def bathroom() -> Iterator[Controller]:
    with Controller(scene="FloorPlan401") as controller:
        yield controller


def things(event) -> dict[str, dict]:
    return {o["objectId"]: o for o in event.metadata["objects"] if o["pickupable"]}


def moved(event, before) -> set[str]:
    """What is elsewhere than before by more than a centimetre."""
    then = things(before)
    return {
        name
        for name, o in things(event).items()
        if np.linalg.norm(np.subtract(list(o["position"].values()), list(then[name]["position"].values()))) > 0.01
    }


def test_things_lie_elsewhere_at_rest_and_apart(kitchen, bathroom) -> None:
    for controller in (kitchen, bathroom):
        for seed in (0, 1):
            before = controller.reset()
            event = controller.step("InitialRandomSpawn", randomSeed=seed)
            assert event, event.metadata["errorMessage"]
            there = things(event)
            assert set(there) == set(things(before))
            elsewhere = moved(event, before)
            assert len(elsewhere) > 0.5 * len(there)
            assert all(there[name]["parentReceptacles"] for name in elsewhere)
            assert_at_rest_and_apart(controller, elsewhere)
            fixed = [o for o in before.metadata["objects"] if not o["pickupable"]]
            assert fixed
            for o in fixed:
                assert event.get_object(o["objectId"])["position"] == o["position"]


def test_after_a_reset_it_is_as_in_a_room_that_was_just_loaded(kitchen) -> None:
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True, renderImage=False)
    kitchen.step("ThrowObject", moveMagnitude=80.0, renderImage=False)
    kitchen.reset()
    with Controller(scene="FloorPlan1") as fresh:
        told = [one.step("InitialRandomSpawn", randomSeed=0, renderImage=False) for one in (kitchen, fresh)]
    assert told[0].metadata["objects"] == told[1].metadata["objects"]


def test_the_seed_decides(kitchen) -> None:
    first = kitchen.step("InitialRandomSpawn", randomSeed=5)
    kitchen.step("RandomizeColors")  # draws from other random numbers
    kitchen.reset()
    assert kitchen.step("InitialRandomSpawn", randomSeed=5).metadata["objects"] == first.metadata["objects"]
    kitchen.reset()
    assert kitchen.step("InitialRandomSpawn", randomSeed=6).metadata["objects"] != first.metadata["objects"]
    kitchen.reset()
    assert kitchen.step("InitialRandomSpawn", randomSeed=-6)


def test_things_come_out_of_what_is_closed_and_go_into_it(kitchen) -> None:
    before, came_out, went_in = things(kitchen.last_event), False, False
    closed = {o["objectId"] for o in kitchen.last_event.metadata["objects"] if o["openable"] and o["receptacle"]}
    for seed in range(4):
        kitchen.reset()
        for name, o in things(kitchen.step("InitialRandomSpawn", randomSeed=seed)).items():
            was, now = (set(x["parentReceptacles"] or ()) for x in (before[name], o))
            came_out |= bool(was & closed - now)
            went_in |= bool(now & closed - was)
    assert came_out
    assert went_in


def test_force_visible_puts_nothing_into_what_is_closed(kitchen) -> None:
    closed = {o["objectId"] for o in kitchen.last_event.metadata["objects"] if o["openable"] and o["receptacle"]}
    before = kitchen.last_event
    event = kitchen.step("InitialRandomSpawn", randomSeed=1, forceVisible=True)
    elsewhere = moved(event, before)
    assert elsewhere
    assert not closed & {parent for name in elsewhere for parent in things(event)[name]["parentReceptacles"]}


def test_what_is_excluded_stays_and_stays_free(kitchen) -> None:
    before = kitchen.last_event
    event = kitchen.step(
        "InitialRandomSpawn", randomSeed=2, excludedObjectIds=[EGG, APPLE], excludedReceptacles=["CounterTop"]
    )
    assert event, event.metadata["errorMessage"]
    elsewhere = moved(event, before)
    assert elsewhere
    for name in (EGG, APPLE):
        assert event.get_object(name)["position"] == before.get_object(name)["position"]
    parents = {parent for name in elsewhere for parent in things(event)[name]["parentReceptacles"]}
    assert not parents & set(COUNTERS)


def test_what_is_held_is_put_down_too(kitchen) -> None:
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    refused = kitchen.step("InitialRandomSpawn", numRepeats=[{"objectType": "Mug", "count": 500}])
    assert refused.metadata["inventoryObjects"]
    event = kitchen.step("InitialRandomSpawn", randomSeed=1)
    assert event, event.metadata["errorMessage"]
    assert event.metadata["inventoryObjects"] == []
    assert event.get_object(APPLE)["parentReceptacles"]
    kitchen.step("RemoveFromScene", objectId=APPLE)
    event = kitchen.step("InitialRandomSpawn", randomSeed=1)
    assert event.get_object(APPLE) is None


def test_what_there_is_too_little_of_is_copied(kitchen) -> None:
    before = kitchen.last_event
    wishes = [
        {"objectType": "Apple", "count": 5},
        {"objectType": "Mug", "count": 4},
        {"objectType": "Fridge", "count": 3},
    ]
    event = kitchen.step("InitialRandomSpawn", randomSeed=1, numDuplicatesOfType=wishes)
    assert event, event.metadata["errorMessage"]
    assert len(event.objects_by_type("Apple")) == 5
    assert len(event.objects_by_type("Mug")) == 4
    assert len(event.objects_by_type("Fridge")) == 1
    copies = {
        o["objectId"]: o for o in event.metadata["objects"] if o["objectId"] not in things(before) and o["pickupable"]
    }
    assert f"{APPLE}_copy_0" in copies
    assert len(copies) == 7
    for o in copies.values():
        original = before.get_object(o["objectId"].rpartition("_copy_")[0])
        assert o["name"].startswith(f"{original['name']}(Clone)_random_copy_")
        assert o["parentReceptacles"]
    assert_at_rest_and_apart(kitchen, copies)
    again = kitchen.step("InitialRandomSpawn", randomSeed=2, numRepeats=wishes)
    assert {o["objectId"] for o in again.metadata["objects"]} == {o["objectId"] for o in event.metadata["objects"]}
    kitchen.reset()
    same = kitchen.step("InitialRandomSpawn", randomSeed=1, numDuplicatesOfType=wishes)
    assert same.metadata["objects"] == event.metadata["objects"]


def test_copies_that_find_no_place_are_not_there(kitchen) -> None:
    wishes = [{"objectType": "Pot", "count": 60}]
    others = sorted(
        {o["objectType"] for o in kitchen.last_event.metadata["objects"] if o["receptacle"]} - {"StoveBurner"}
    )
    event = kitchen.step("InitialRandomSpawn", numDuplicatesOfType=wishes, excludedReceptacles=others)
    assert event, event.metadata["errorMessage"]
    pots = event.objects_by_type("Pot")
    assert 1 <= len(pots) < 60
    assert_at_rest_and_apart(kitchen, [o["objectId"] for o in pots])
    again = kitchen.step("InitialRandomSpawn", numDuplicatesOfType=wishes, randomSeed=3)
    assert len(again.objects_by_type("Pot")) > len(pots)
    room = kitchen.server.session._simulator.room
    assert sum(room.world.type_of(name) == "Pot" for name in room.world.ids) == 60  # those of before were taken again


def test_so_many_receptacles_stay_free(kitchen) -> None:
    for count, expected in ((0, 0), (2, 2), (100, len(COUNTERS))):
        before = kitchen.reset()
        free = [{"objectType": "CounterTop", "count": count}]
        event = kitchen.step("InitialRandomSpawn", randomSeed=1, minFreePerReceptacleType=free)
        assert event, event.metadata["errorMessage"]
        elsewhere = moved(event, before)  # what finds no place elsewhere stays
        assert len(elsewhere) > 5
        holding = {parent for name in elsewhere for parent in event.get_object(name)["parentReceptacles"] or ()}
        assert len(set(COUNTERS) - holding) == expected


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"numPlacementAttempts": 0}, "positive integer"),
        ({"numDuplicatesOfType": [{"objectType": "Apple", "count": 500}]}, "no more than 100 are made at once"),
        ({"numDuplicatesOfType": [{"objectType": "Aple", "count": 2}]}, "did you mean"),
        ({"excludedObjectIds": ["Apple|0"]}, "is not the objectId on any object"),
        ({"excludedReceptacles": ["CounterTopp"]}, "did you mean"),
    ],
)
def test_what_is_refused_changes_nothing(kitchen, arguments, words) -> None:
    before = kitchen.last_event
    event = kitchen.step("InitialRandomSpawn", **arguments)
    assert not event
    assert words in event.metadata["errorMessage"]
    assert event.metadata["objects"] == before.metadata["objects"]
    assert kitchen.step("InitialRandomSpawn", numDuplicatesOfType=[{"objectType": "Apple", "count": 1}])
