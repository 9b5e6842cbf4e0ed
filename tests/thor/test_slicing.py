"""Slices take the place of what is sliced: new objects of AI2-THOR's types that one can pick up, cook and put away."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from remqa_data.catalog import catalog, object_type
from remqa_data.thor import Controller
from tests.helpers.thor_clients import act

pytestmark = pytest.mark.slow

SLICEABLE = ("Apple", "Bread", "Egg", "Lettuce", "Potato", "Tomato")
BOXES = ("axisAlignedBoundingBox", "objectOrientedBoundingBox")
SPREAD_M = 0.15
"""No slice comes to rest farther than this from the middle of the whole one."""


@pytest.fixture(scope="module", params=["FloorPlan3", "FloorPlan17"])
def started(request):
    with Controller(scene=request.param, width=64, height=64) as controller:
        yield controller


@pytest.fixture
def kitchen(started) -> Controller:
    started.reset()
    return started


def of_type(controller: Controller, type_name: str) -> list[dict]:
    return [o for o in controller.last_event.metadata["objects"] if o["objectType"] == type_name]


def test_what_has_slices_is_what_can_be_sliced() -> None:
    assert tuple(name for name, kind in catalog().items() if kind.slices) == SLICEABLE
    assert tuple(name for name, kind in catalog().items() if kind.sliceable) == SLICEABLE


@pytest.mark.parametrize("variant", range(4))
@pytest.mark.parametrize("type_name", [object_type(name).slices.type for name in SLICEABLE])
def test_a_slice_is_built_in_the_size_that_is_asked_for(type_name, variant) -> None:
    size = (0.11, 0.09, 0.03) if type_name == "EggCracked" else (0.012, 0.08, 0.07)
    asset = build(AssetSpec(type_name, size, variant, seed=variant))
    low, high = asset.bounds()
    assert np.allclose(high - low, size, atol=1e-6)


@pytest.mark.parametrize("type_name", SLICEABLE)
def test_slices_lie_where_the_whole_one_was(kitchen, type_name) -> None:
    whole = of_type(kitchen, type_name)[0]
    count = len(kitchen.last_event.metadata["objects"])
    slices = object_type(type_name).slices
    act(kitchen, "SliceObject", whole["objectId"])
    pieces = of_type(kitchen, slices.type)
    assert [piece["objectId"] for piece in pieces] == [
        f"{whole['objectId']}|{slices.type}_{number}" for number in range(slices.count)
    ]
    assert len(kitchen.last_event.metadata["objects"]) == count + slices.count
    for piece in pieces:
        assert piece["pickupable"]
        assert not piece["sliceable"]
        assert piece["parentReceptacles"] is not None
        offset = [piece["position"][axis] - whole["position"][axis] for axis in "xyz"]
        assert np.linalg.norm(offset) < SPREAD_M
    left = next(o for o in of_type(kitchen, type_name) if o["objectId"] == whole["objectId"])
    assert left["isSliced"]
    assert not left["visible"]
    assert left["position"] == whole["position"]
    assert not kitchen.step("SliceObject", objectId=whole["objectId"], forceAction=True)
    assert "has been sliced" in kitchen.last_event.metadata["errorMessage"]


def test_a_slice_is_a_thing_like_any_other(kitchen) -> None:
    act(kitchen, "SliceObject", of_type(kitchen, "Potato")[0]["objectId"])
    piece = of_type(kitchen, "PotatoSliced")[2]["objectId"]
    act(kitchen, "PickupObject", piece)
    assert [o["objectType"] for o in kitchen.last_event.metadata["inventoryObjects"]] == ["PotatoSliced"]
    microwave = of_type(kitchen, "Microwave")[0]["objectId"]
    act(kitchen, "OpenObject", microwave)
    act(kitchen, "PutObject", microwave)
    act(kitchen, "CloseObject", microwave)
    act(kitchen, "ToggleObjectOn", microwave)
    cooked = [o["objectId"] for o in of_type(kitchen, "PotatoSliced") if o["isCooked"]]
    assert cooked == [piece]


@pytest.mark.parametrize(
    ("scene", "slots"), [("FloorPlan5", 2), ("FloorPlan10", 2), ("FloorPlan29", 4)]
)  # the narrowest slots, the thickest slices
def test_a_toaster_takes_a_slice_of_bread_in_each_slot(kitchen, scene, slots) -> None:
    kitchen.reset(scene)
    act(kitchen, "SliceObject", of_type(kitchen, "Bread")[0]["objectId"])
    toaster = of_type(kitchen, "Toaster")[0]
    box = toaster["axisAlignedBoundingBox"]
    taken = 0
    for piece in of_type(kitchen, "BreadSliced"):
        act(kitchen, "PickupObject", piece["objectId"])
        if not kitchen.step("PutObject", objectId=toaster["objectId"], forceAction=True):
            break
        taken += 1
        placed = kitchen.last_event.get_object(piece["objectId"])["axisAlignedBoundingBox"]
        above = placed["center"]["y"] - placed["size"]["y"] / 2 - (box["center"]["y"] - box["size"]["y"] / 2)
        assert above < 0.4 * box["size"]["y"]  # it stands in the slot, and does not lie on the rim
    assert taken == slots
    act(kitchen, "ToggleObjectOn", toaster["objectId"])
    assert [o["isCooked"] for o in of_type(kitchen, "BreadSliced")].count(True) == slots


def test_slices_are_put_and_posed_like_other_things(kitchen) -> None:
    potato = of_type(kitchen, "Potato")[0]["objectId"]
    act(kitchen, "SliceObject", potato)
    piece = of_type(kitchen, "PotatoSliced")[0]
    at = piece["axisAlignedBoundingBox"]["center"]
    for action in ("TeleportObject", "PlaceObjectAtPoint"):
        event = kitchen.step(action, objectId=piece["objectId"], position={**at, "y": at["y"] + 0.2})
        assert event, event.metadata["errorMessage"]
    poses = [
        {"objectId": o["objectId"], "position": o["position"], "rotation": o["rotation"]}
        for o in kitchen.last_event.metadata["objects"]
        if (o["pickupable"] or o["moveable"]) and o["objectId"] != potato
    ]
    event = kitchen.step("SetObjectPoses", objectPoses=poses)
    assert event, event.metadata["errorMessage"]
    assert len(of_type(kitchen, "PotatoSliced")) == 6


def test_what_has_been_sliced_is_not_there_any_more(kitchen) -> None:
    potato = of_type(kitchen, "Potato")[0]
    act(kitchen, "SliceObject", potato["objectId"])
    assert kitchen.step("RemoveFromScene", objectIds=[o["objectId"] for o in of_type(kitchen, "PotatoSliced")])
    pose = {"objectId": potato["objectId"], "position": potato["position"]}
    for action, arguments in (
        ("EnableObject", {"objectId": potato["objectId"]}),
        ("SetObjectPoses", {"objectPoses": [pose]}),
        ("DistanceToObject", {"objectId": potato["objectId"]}),
        ("GetShortestPath", {"objectId": potato["objectId"]}),
        ("MaskObject", {"objectId": potato["objectId"]}),
    ):
        error = kitchen.step(action, **arguments).metadata["errorMessage"]
        assert error == f"{potato['objectId']} has been sliced", action


def test_slices_are_as_done_as_the_whole_one_and_gone_after_a_reset(kitchen) -> None:
    before = [o["objectId"] for o in kitchen.last_event.metadata["objects"]]
    first = kitchen.last_event.frame
    potato = of_type(kitchen, "Potato")[0]["objectId"]
    act(kitchen, "CookObject", potato)
    act(kitchen, "SliceObject", potato)
    slices = of_type(kitchen, "PotatoSliced")
    assert len(slices) == 6
    assert all(o["isCooked"] for o in slices)
    kitchen.reset()
    assert [o["objectId"] for o in kitchen.last_event.metadata["objects"]] == before
    assert not any(o["isSliced"] for o in kitchen.last_event.metadata["objects"])
    assert np.array_equal(kitchen.last_event.frame, first)


def test_all_else_stays_as_it_was(kitchen) -> None:
    for action in ("MoveAhead", "RotateRight", "LookDown"):
        kitchen.step(action)
    knife = of_type(kitchen, "Knife")[0]["objectId"]
    act(kitchen, "PickupObject", knife)
    assert kitchen.step("RemoveFromScene", objectId=of_type(kitchen, "Mug")[0]["objectId"])
    act(kitchen, "OpenObject", of_type(kitchen, "Fridge")[0]["objectId"])
    act(kitchen, "DirtyObject", of_type(kitchen, "Plate")[0]["objectId"])
    before = kitchen.last_event.metadata
    act(kitchen, "SliceObject", of_type(kitchen, "Tomato")[0]["objectId"])
    after = kitchen.last_event.metadata
    assert after["agent"] == before["agent"]
    assert after["inventoryObjects"] == before["inventoryObjects"] == [{"objectId": knife, "objectType": "Knife"}]
    now = {o["objectId"]: o for o in after["objects"]}
    places = {"position", "rotation", "distance", "receptacleObjectIds", "parentReceptacles", *BOXES}
    seen = {"isSliced", "visible", "isInteractable"}
    for record in before["objects"]:
        other = now[record["objectId"]]
        assert {k: other[k] for k in record if k not in places | seen} == {
            k: record[k] for k in record if k not in places | seen
        }
        if record["objectId"] != knife:
            assert other["position"] == pytest.approx(record["position"], abs=0.002)  # all has come to rest again


def test_an_egg_that_breaks_is_cracked_and_what_is_held_is_not_sliced(kitchen) -> None:
    egg = of_type(kitchen, "Egg")[0]["objectId"]
    act(kitchen, "BreakObject", egg)
    assert [o["objectId"] for o in of_type(kitchen, "EggCracked")] == [f"{egg}|EggCracked_0"]
    assert of_type(kitchen, "Egg")[0]["isBroken"]
    bread = of_type(kitchen, "Bread")[0]["objectId"]
    act(kitchen, "PickupObject", bread)
    assert not kitchen.step("SliceObject", objectId=bread, forceAction=True)
    assert "put it down" in kitchen.last_event.metadata["errorMessage"]
    assert not kitchen.step("SliceObject", objectId=of_type(kitchen, "Fork")[0]["objectId"], forceAction=True)
    assert "Does not have the CanBeSliced" in kitchen.last_event.metadata["errorMessage"]


def test_slicing_gives_the_same_each_time(kitchen) -> None:
    """The same actions give the same events, bit for bit."""
    events = []
    for _ in range(2):
        kitchen.reset()
        for name in ("Apple", "Lettuce"):
            act(kitchen, "SliceObject", of_type(kitchen, name)[0]["objectId"])
        events.append(kitchen.last_event)
    assert events[0].metadata["objects"] == events[1].metadata["objects"]
    assert np.array_equal(events[0].frame, events[1].frame)
