"""PutObject finds a place where AI2-THOR would, and what was put lies there without being in anything else."""

import math
from collections.abc import Iterator
from typing import Any

import pytest

from remqa_data.floorplans.load import load_scene
from remqa_data.sim.agent.handling import OVERLAP_M
from remqa_data.thor import Controller
from tests.helpers.thor_clients import first_id

pytestmark = pytest.mark.slow

KITCHEN, BATHROOM = "FloorPlan10", "FloorPlan401"
CUP, CABINET = "Cup|+01.08|+00.90|-00.77", "Cabinet|+00.95|+02.16|-02.38"
CUPBOARD_POSE = {"x": 0.0, "z": -1.25, "rotation": 90.0, "horizon": 0.0}
BATHTUB, SOAP_BOTTLE = "Bathtub|-00.21|+00.36|+00.92", "SoapBottle|-03.41|+01.02|+01.29"


@pytest.fixture(scope="module")
def controller() -> Iterator[Controller]:
    with Controller(scene=KITCHEN, width=300, height=300) as controller:
        yield controller


def put(controller: Controller, scene: str, thing: str, receptacle: str, pose: dict[str, Any]) -> Any:
    """The event after an expert has put a thing somewhere from a pose."""
    controller.reset(scene)
    for action in (
        {"action": "PickupObject", "objectId": thing, "forceAction": True},
        {"action": "TeleportFull", "y": controller.last_event.metadata["agent"]["position"]["y"], "standing": True}
        | pose,
    ):
        assert controller.step(action, renderImage=False), controller.last_event
    if controller.last_event.get_object(receptacle)["openable"]:
        assert controller.step("OpenObject", objectId=receptacle, renderImage=False)
    event = controller.step("PutObject", objectId=receptacle, renderImage=False)
    assert event, event.metadata["errorMessage"]
    near = controller.server.session._simulator.room.world.overlapping(thing, 0.02)
    assert all(gap >= -OVERLAP_M for _, gap in near), near
    return event.get_object(thing)


def test_who_sees_the_rim_of_a_bathtub_puts_things_into_it(controller) -> None:
    bathing = {"x": -2.25, "z": 0.75, "rotation": 0.0, "horizon": 30.0}
    bottle = put(controller, BATHROOM, SOAP_BOTTLE, BATHTUB, bathing)
    assert not controller.last_event.get_object(f"{BATHTUB}|BathtubBasin")["visible"]
    assert bottle["parentReceptacles"] == [f"{BATHTUB}|BathtubBasin"]


def test_a_salt_shaker_lies_on_a_knife_that_covers_the_floor_of_a_drawer(controller) -> None:
    drawer, pose = "Drawer|+00.64|+00.76|-00.65", {"x": 0.0, "z": -0.5, "rotation": 90.0, "horizon": 30.0}
    assert put(controller, KITCHEN, "SaltShaker|+01.19|+00.90|-01.80", drawer, pose)["parentReceptacles"] == [drawer]


def test_what_was_put_before_does_not_let_a_knife_through_a_bowl(controller) -> None:
    put(controller, KITCHEN, CUP, CABINET, CUPBOARD_POSE)  # moves the bowl a micrometre, for PyBullet
    bowl, pose = "Bowl|+00.79|+00.90|-00.12", {"x": 0.0, "z": -1.5, "rotation": 0.0, "horizon": 30.0}
    knife = put(controller, KITCHEN, "ButterKnife|-01.33|+00.92|-00.88", bowl, pose)
    assert knife["parentReceptacles"] == [bowl]
    rim = max(y for _, y, _ in controller.last_event.get_object(bowl)["axisAlignedBoundingBox"]["cornerPoints"])
    assert knife["position"]["y"] == pytest.approx(rim, abs=0.02)


@pytest.mark.parametrize("room", ["FloorPlan1", "FloorPlan7"])
def test_a_mug_on_a_plate_is_carried_and_put_down_with_it(controller, room: str) -> None:
    controller.reset(room)
    mug, plate, counter = (first_id(controller, name) for name in ("Mug", "Plate", "CounterTop"))
    for action, object_id in (("PickupObject", mug), ("PutObject", plate)):
        assert controller.step(action, objectId=object_id, forceAction=True, renderImage=False)
    get = controller.last_event.get_object
    assert get(mug)["parentReceptacles"] == [plate]
    assert mug not in (get(plate)["parentReceptacles"] or [])  # though its middle is where the mug's inside is
    for action, object_id in (("PickupObject", plate), ("PutObject", counter)):
        event = controller.step(action, objectId=object_id, forceAction=True, renderImage=False)
        assert event, event.metadata["errorMessage"]
    get = event.get_object
    assert (get(mug)["parentReceptacles"], get(plate)["parentReceptacles"]) == ([plate], [counter])


@pytest.mark.parametrize(
    ("room", "cabinet"),
    [("FloorPlan403", "Cabinet|-02.42|+00.43|+02.87"), ("FloorPlan30", "Cabinet|-00.19|+01.67|-01.34")],
)
def test_a_cabinet_that_opens_a_crack_in_the_dataset_opens_here(controller, room: str, cabinet: str) -> None:
    assert next(o for o in load_scene(room).objects if o.id == cabinet).most_open < 0.15
    controller.reset(room)
    event = controller.step("OpenObject", objectId=cabinet, forceAction=True, renderImage=False)
    assert event.get_object(cabinet)["openness"] == 1.0


def test_what_is_put_into_a_deep_sink_is_seen_from_nearby(controller) -> None:
    controller.reset("FloorPlan3")
    egg, basin = first_id(controller, "Egg"), first_id(controller, "SinkBasin")
    assert controller.step("PickupObject", objectId=egg, forceAction=True, renderImage=False)
    y = controller.last_event.metadata["agent"]["position"]["y"]
    before = {"x": -1.0, "y": y, "z": -0.5, "rotation": {"x": 0, "y": 270, "z": 0}, "horizon": 30, "standing": True}
    assert controller.step("TeleportFull", **before, renderImage=False)
    assert controller.step("PutObject", objectId=basin, renderImage=False).get_object(egg)["visible"]


def test_a_near_place_that_is_not_seen_is_better_than_a_far_one_that_is(controller) -> None:
    controller.reset("FloorPlan8")
    cup, counter = first_id(controller, "Cup"), "CounterTop|+01.17|+00.95|-00.65"
    assert controller.step("PickupObject", objectId=cup, forceAction=True, renderImage=False)
    before = {"x": -0.75, "y": 0.9, "z": 1.0, "rotation": {"x": 0, "y": 180, "z": 0}, "horizon": 0, "standing": True}
    assert controller.step("TeleportFull", **before, renderImage=False)
    assert controller.step("PutObject", objectId=counter, renderImage=False).get_object(cup)["distance"] < 1.75


def test_a_mug_stands_under_the_spout_and_not_on_the_cup_rail(controller) -> None:
    controller.reset("FloorPlan7")
    mug, machine = first_id(controller, "Mug"), first_id(controller, "CoffeeMachine")
    for action, object_id in (("PickupObject", mug), ("PutObject", machine)):
        event = controller.step(action, objectId=object_id, forceAction=True, renderImage=False)
    boxes = [event.get_object(name)["axisAlignedBoundingBox"] for name in (mug, machine)]
    assert boxes[0]["center"]["y"] < boxes[1]["center"]["y"]


def test_a_plate_is_not_put_into_the_hollow_foot_of_a_machine(controller) -> None:
    controller.reset("FloorPlan12")
    plate, counter = first_id(controller, "Plate"), "CounterTop|+01.51|+00.97|+02.31"
    assert controller.step("PickupObject", objectId=plate, forceAction=True, renderImage=False)
    y = controller.last_event.metadata["agent"]["position"]["y"]
    before = {"x": 0.75, "y": y, "z": 1.5, "rotation": {"x": 0, "y": 90, "z": 0}, "horizon": 30, "standing": True}
    assert controller.step("TeleportFull", **before, renderImage=False)
    assert controller.step("PutObject", objectId=counter, renderImage=False).get_object(plate)["visible"]


def test_what_is_put_into_a_drawer_sticks_in_nothing_when_it_is_closed(kitchen) -> None:
    thing, drawer = "PepperShaker|+00.47|+01.31|-03.00", "Drawer|+00.65|+01.07|+01.02"
    kitchen.reset("FloorPlan3")
    poses = kitchen.step("GetInteractablePoses", objectId=drawer, maxPoses=1, horizons=[30, 45])
    assert kitchen.step("TeleportFull", **poses.metadata["actionReturn"][0])
    assert kitchen.step("PickupObject", objectId=thing, forceAction=True)
    assert kitchen.step("OpenObject", objectId=drawer)
    assert kitchen.step("PutObject", objectId=drawer, forceAction=True)
    closed = kitchen.step("CloseObject", objectId=drawer)
    assert closed.get_object(thing)["parentReceptacles"] == [drawer]
    world = kitchen.server.session._simulator.room.world
    assert min((gap for _, gap in world.overlapping(thing)), default=0.0) > -0.01


def test_a_pot_is_picked_up_with_what_metadata_say_is_in_it_and_nothing_else_moves(kitchen) -> None:
    """The spatula is so near to the burner, through the pot's floor, that it would seem to rest on that."""
    before = kitchen.reset("FloorPlan14")
    pot = next(o for o in before.metadata["objects"] if o["objectType"] == "Pot" and o["receptacleObjectIds"])
    [spatula] = pot["receptacleObjectIds"]
    event = kitchen.step("PickupObject", objectId=pot["objectId"], forceAction=True)
    assert event.get_object(pot["objectId"])["receptacleObjectIds"] == [spatula]
    away = [
        math.dist(*(at.get_object(name)["position"].values() for name in (pot["objectId"], spatula)))
        for at in (before, event)
    ]
    assert away[0] == pytest.approx(away[1], abs=1e-4)
    for was in before.metadata["objects"]:
        if was["objectId"] not in (pot["objectId"], spatula):
            assert event.get_object(was["objectId"])["position"] == was["position"]
