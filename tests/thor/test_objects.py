import math

import numpy as np
import pytest

from remqa_data.catalog import catalog
from remqa_data.yaml_files import template_values

FRIDGE = "Fridge|-02.10|+00.00|+01.07"
APPLE = "Apple|-00.47|+01.15|+00.48"
EGG = "Egg|-02.04|+00.81|+01.24"
ISLAND = "CounterTop|-00.08|+01.15|00.00"
MICROWAVE = "Microwave|-00.24|+01.69|-02.53"
FORK = "Fork|+00.95|+00.77|-02.37"
SINK = "Sink|-01.90|+00.97|-01.50"
STOOL = "Stool|+00.74|+00.00|+00.56"


def pose(x: float, z: float, rotation: float, horizon: float) -> dict:
    """Arguments of TeleportFull."""
    return {"x": x, "y": 0.9, "z": z, "rotation": {"x": 0, "y": rotation, "z": 0}, "horizon": horizon, "standing": True}


BEFORE_FRIDGE = pose(-0.75, 1.5, 270, 30)
BEFORE_APPLE = pose(-1.0, 0.5, 90, 30)
BEFORE_STOOL = pose(1.5, 0.5, 270, 60)


@pytest.fixture
def before_fridge(kitchen):
    assert kitchen.step("TeleportFull", **BEFORE_FRIDGE)
    return kitchen


@pytest.fixture
def before_apple(kitchen):
    assert kitchen.step("TeleportFull", **BEFORE_APPLE)
    return kitchen


def test_opens_and_closes(before_fridge) -> None:
    closed = before_fridge.last_event.get_object(FRIDGE)
    assert (closed["isOpen"], closed["openness"]) == (False, 0.0)
    event = before_fridge.step("OpenObject", objectId=FRIDGE)
    opened = event.get_object(FRIDGE)
    assert (opened["isOpen"], opened["openness"]) == (True, 1.0)
    assert event.metadata["actionReturn"] is None
    assert opened["axisAlignedBoundingBox"]["size"] != closed["axisAlignedBoundingBox"]["size"]
    again = before_fridge.step("OpenObject", objectId=FRIDGE)
    assert again
    assert again.get_object(FRIDGE) == opened
    shut = before_fridge.step("CloseObject", objectId=FRIDGE).get_object(FRIDGE)
    assert shut["axisAlignedBoundingBox"] == closed["axisAlignedBoundingBox"]
    for action in ("CloseObject", "OpenObject"):
        assert before_fridge.step(action, objectId=FRIDGE, **({"openness": 0.0} if action == "OpenObject" else {}))
        assert not before_fridge.last_event.get_object(FRIDGE)["isOpen"]


def test_what_is_open_already_is_opened_by_who_sees_it(before_fridge) -> None:
    assert before_fridge.step("OpenObject", objectId=FRIDGE)
    away = [
        r for r in (0, 90, 180, 270) if not before_fridge.step("Teleport", rotation=r).get_object(FRIDGE)["visible"]
    ]
    assert before_fridge.step("Teleport", rotation=away[0])
    assert not before_fridge.step("OpenObject", objectId=FRIDGE)
    assert "within the specified visibility" in before_fridge.last_event.metadata["errorMessage"]
    assert before_fridge.step("OpenObject", objectId=FRIDGE, forceAction=True)


@pytest.mark.parametrize(
    ("arguments", "openness"), [({"openness": 0.5}, 0.5), ({"moveMagnitude": 0}, 1.0), ({"moveMagnitude": 0.65}, 0.65)]
)
def test_opens_partly(kitchen, arguments, openness) -> None:
    event = kitchen.step("OpenObject", objectId=FRIDGE, forceAction=True, **arguments)
    assert event.get_object(FRIDGE)["openness"] == openness


def test_what_it_refuses_to_open(before_fridge) -> None:
    for object_id, text in (
        (APPLE, "is not an Openable object"),
        ("Fridge|+99.00|+00.00|+01.07", "is not the objectId on any object"),
    ):
        event = before_fridge.step("OpenObject", objectId=object_id)
        assert text in event.metadata["errorMessage"]
        assert not event
    assert not before_fridge.step("OpenObject", objectId=FRIDGE, openness=1.5, forceAction=True)
    assert not before_fridge.step("OpenObject", x=1.5, y=0.5)
    before_fridge.step("TeleportFull", **pose(-1.4, 1.0, 270, 30), forceAction=True)
    event = before_fridge.step("OpenObject", objectId=FRIDGE)
    assert "Agent is blocking" in event.metadata["errorMessage"]  # it stands in the way of the door
    before_fridge.step("RotateRight", degrees=180)
    event = before_fridge.step("OpenObject", objectId=FRIDGE)
    assert event.metadata["errorMessage"] == "Target object not found within the specified visibility."


def test_acts_on_what_a_point_of_the_frame_shows(before_fridge) -> None:
    for width, height in ((300, 300), (400, 200)):
        before_fridge.step("ChangeResolution", x=width, y=height)
        event = before_fridge.step("Pass", renderInstanceSegmentation=True)
        x1, y1, x2, y2 = event.instance_detections2D[FRIDGE]
        x, y = (x1 + x2 + 1) / 2 / width, (y1 + y2 + 1) / 2 / height
        assert before_fridge.step("GetObjectInFrame", x=x, y=y).metadata["actionReturn"] == FRIDGE
        assert before_fridge.step("OpenObject", x=x, y=y).get_object(FRIDGE)["isOpen"]
        assert before_fridge.step("CloseObject", objectId=FRIDGE)


@pytest.mark.slow
@pytest.mark.parametrize("size", [(300, 300), (640, 240), (120, 120)])
def test_what_is_visible_can_be_picked_up(kitchen, size) -> None:
    """Whatever the frame: `visible` in the metadata is what decides."""
    kitchen.step("ChangeResolution", x=size[0], y=size[1])
    tried = []
    for rotation in (45, 90, 135):
        event = kitchen.step("TeleportFull", **{**BEFORE_APPLE, "rotation": {"x": 0, "y": rotation, "z": 0}})
        for record in [o for o in event.metadata["objects"] if o["pickupable"] and o["distance"] < 2.5]:
            picked = kitchen.step("PickupObject", objectId=record["objectId"])
            assert bool(picked) == record["visible"], picked.metadata["errorMessage"]
            tried.append(record["visible"])
            if picked:
                kitchen.reset(width=size[0], height=size[1])
                kitchen.step("TeleportFull", **{**BEFORE_APPLE, "rotation": {"x": 0, "y": rotation, "z": 0}})
    assert {True, False} <= set(tried)


def test_picks_up_and_puts_down(before_apple) -> None:
    event = before_apple.step("PickupObject", objectId=APPLE)
    assert event
    assert event.get_object(APPLE)["isPickedUp"]
    assert (
        "Agent hand has something in it already!"
        in before_apple.step("PickupObject", objectId=APPLE).metadata["errorMessage"]
    )
    event = before_apple.step("PutObject", objectId=ISLAND)
    assert event
    apple = event.get_object(APPLE)
    assert (apple["isPickedUp"], apple["parentReceptacles"]) == (False, [ISLAND])
    assert event.metadata["inventoryObjects"] == []
    assert not before_apple.step("PutObject", objectId=ISLAND)
    assert before_apple.last_event.metadata["errorMessage"] == "Can't place an object if Agent isn't holding anything"


def test_things_go_where_such_things_go_unless_they_must(before_apple) -> None:
    stool = before_apple.last_event.get_object(STOOL)["axisAlignedBoundingBox"]["center"]
    before_apple.step("PickupObject", objectId=APPLE)
    done(before_apple.step("TeleportFull", **BEFORE_STOOL))
    event = before_apple.step("PutObject", objectId=STOOL)
    assert event.metadata["errorMessage"] == f"{APPLE} cannot be placed in {STOOL}"
    assert event.get_object(APPLE)["isPickedUp"]
    event = done(before_apple.step("PutObject", objectId=STOOL, forceAction=True))
    assert event.get_object(APPLE)["parentReceptacles"] == [STOOL]
    assert event.get_object(APPLE)["position"]["x"] == pytest.approx(stool["x"], abs=0.3)


@pytest.mark.parametrize(
    ("thing", "receptacle", "words"),
    [(EGG, STOOL, "not found within"), (EGG, EGG, "NOT a receptacle"), (EGG, "Stool|9", "is not the objectId on any")],
)
def test_what_else_is_wrong_with_a_place_is_said_first(kitchen, thing, receptacle, words) -> None:
    done(kitchen.step("TeleportFull", **BEFORE_FRIDGE))
    done(kitchen.step("PickupObject", objectId=thing, forceAction=True))
    assert words in kitchen.step("PutObject", objectId=receptacle).metadata["errorMessage"]


def test_every_name_of_the_compatible_receptacles_is_a_type() -> None:
    rules = template_values("thor_receptacles.yaml")
    slices = {kind.slices.type for kind in catalog().values() if kind.slices is not None}
    receptacles = {"Sink", *(name for name, kind in catalog().items() if kind.receptacle)}
    assert len(rules["compatible"]) == 66
    assert set(rules["compatible"]) <= {name for name, kind in catalog().items() if kind.pickupable} | slices
    assert {name for names in rules["compatible"].values() for name in names} <= receptacles | {"tables"}
    assert set(rules["tables"]) <= receptacles


@pytest.mark.slow
def test_says_what_clients_look_for_when_there_is_no_place(kitchen) -> None:
    kitchen.step("PickupObject", objectId="Book|+00.15|+01.10|+00.62", forceAction=True)
    event = kitchen.step("PutObject", objectId="Bowl|+00.27|+01.10|-00.75", forceAction=True)
    assert event.metadata["errorMessage"] == "No valid positions to place object found"


@pytest.mark.slow
def test_drops(before_apple) -> None:
    before_apple.step("PickupObject", objectId=APPLE)
    before_apple.step("Teleport", position={"x": 1.5, "y": 0.9, "z": 0.0}, rotation={"x": 0, "y": 180, "z": 0})
    event = before_apple.step("DropHandObject")
    assert event
    assert event.get_object(APPLE)["position"]["y"] < 0.15
    assert not before_apple.step("DropHeldObject")


def test_switches_on_and_off(kitchen) -> None:
    switch = "LightSwitch|+02.33|+01.31|-00.16"
    kitchen.step("TeleportFull", position={"x": 1.5, "y": 0.9, "z": 0.0}, rotation=90, horizon=0, standing=True)
    assert kitchen.step("ToggleObjectOn", objectId=switch).get_object(switch)["isToggled"]
    assert not kitchen.step("ToggleObjectOn", objectId=switch)
    assert not kitchen.step("ToggleObjectOff", objectId=switch).get_object(switch)["isToggled"]
    assert not kitchen.step("ToggleObjectOn", objectId=APPLE, forceAction=True)
    kitchen.step("RotateRight")
    assert not kitchen.step("ToggleObjectOn", objectId=switch)


def test_what_is_in_the_fridge_comes_out(before_fridge) -> None:
    assert not before_fridge.step("PickupObject", objectId=EGG)
    assert before_fridge.step("OpenObject", objectId=FRIDGE)
    (pose,) = before_fridge.step("GetInteractablePoses", objectId=EGG, maxPoses=1).metadata["actionReturn"]
    assert before_fridge.step("TeleportFull", **pose).get_object(EGG)["visible"]
    assert before_fridge.step("PickupObject", objectId=EGG).get_object(EGG)["isPickedUp"]


@pytest.mark.slow
def test_what_is_put_down_goes_near_what_the_frame_shows_or_anywhere(kitchen) -> None:
    places = {}
    for key, how in {
        "nearest": {"objectId": ISLAND},
        "same": {"objectId": ISLAND, "randomSeed": 0},
        "seed 1": {"objectId": ISLAND, "randomSeed": 1},
        "seed 1 again": {"objectId": ISLAND, "randomSeed": 1},
        "seed 2": {"objectId": ISLAND, "randomSeed": 2},
        "left": {"x": 0.25, "y": 0.62, "putNearXY": True},
        "right": {"x": 0.75, "y": 0.62, "putNearXY": True},
    }.items():
        kitchen.reset()
        kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
        assert kitchen.step("Teleport", position={"x": -1.0, "y": 0.9, "z": 0.0}, rotation=90, horizon=30)
        shown = kitchen.step("GetCoordinateFromRaycast", x=how["x"], y=how["y"]) if "x" in how else None
        event = kitchen.step("PutObject", **how)
        assert event, (key, event.metadata["errorMessage"])
        places[key] = tuple(event.get_object(APPLE)["position"].values())
        assert event.get_object(APPLE)["parentReceptacles"] == [ISLAND]
        if shown is not None:
            at = shown.metadata["actionReturn"]
            assert math.dist((at["x"], at["z"]), (places[key][0], places[key][2])) < 0.2
    assert places["same"] == places["nearest"]
    assert places["seed 1"] == places["seed 1 again"]
    assert len({places[key] for key in ("nearest", "seed 1", "seed 2", "left", "right")}) == 5
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    refused = kitchen.step("PutObject", objectId=ISLAND, putNearXY=True)
    assert "needs x and y" in refused.metadata["errorMessage"]


@pytest.mark.slow
def test_what_is_for_some_things_takes_no_others(kitchen) -> None:
    kitchen.step("PickupObject", objectId=APPLE, forceAction=True)
    for name in ("CoffeeMachine", "StoveBurner", "Toaster"):
        target = kitchen.last_event.objects_by_type(name)[0]["objectId"]
        event = kitchen.step("PutObject", objectId=target, forceAction=True)
        assert event.metadata["errorMessage"] == f"{APPLE} is not a valid Object Type to be placed in {target}"
    kitchen.reset()
    mug = kitchen.last_event.objects_by_type("Mug")[0]["objectId"]
    kitchen.step("PickupObject", objectId=mug, forceAction=True)
    machine = kitchen.last_event.objects_by_type("CoffeeMachine")[0]["objectId"]
    assert kitchen.step("PutObject", objectId=machine, forceAction=True)


def done(event):
    assert event, event.metadata["errorMessage"]
    return event


@pytest.fixture
def before_microwave(kitchen):
    """The agent before the microwave, with the apple in its hand."""
    done(kitchen.step("PickupObject", objectId=APPLE, forceAction=True))
    box = kitchen.last_event.get_object(MICROWAVE)["axisAlignedBoundingBox"]["center"]
    poses = done(kitchen.step("GetInteractablePoses", objectId=MICROWAVE, horizons=[0], standings=[True])).metadata[
        "actionReturn"
    ]
    straight = [pose for pose in poses if abs(pose["x"] - box["x"]) < 0.2]
    done(kitchen.step("TeleportFull", **max(straight, key=lambda pose: abs(pose["z"] - box["z"]))))
    return kitchen


@pytest.mark.slow
def test_a_microwave_heats_what_was_put_in_and_gives_it_back(before_microwave) -> None:
    controller = before_microwave
    closed = controller.step("PutObject", objectId=MICROWAVE)
    assert "CLOSED" in closed.metadata["errorMessage"]
    done(controller.step("OpenObject", objectId=MICROWAVE))
    inside = done(controller.step("PutObject", objectId=MICROWAVE)).get_object(APPLE)
    assert inside["parentReceptacles"] == [MICROWAVE]
    assert inside["visible"]
    for action in ("CloseObject", "ToggleObjectOn", "ToggleObjectOff", "OpenObject"):
        event = done(controller.step(action, objectId=MICROWAVE))
    assert event.get_object(APPLE)["temperature"] == "Hot"
    done(controller.step("PickupObject", objectId=APPLE))


def test_what_stands_on_a_microwave_is_not_in_it(kitchen) -> None:
    low, high = np.array(kitchen.last_event.get_object(MICROWAVE)["axisAlignedBoundingBox"]["cornerPoints"])[[7, 0]]
    top = {"x": (low[0] + high[0]) / 2, "y": max(low[1], high[1]), "z": (low[2] + high[2]) / 2}
    event = done(kitchen.step("PlaceObjectAtPoint", objectId=EGG, position=top))
    assert event.get_object(EGG)["position"]["y"] > top["y"]
    assert event.get_object(MICROWAVE)["receptacleObjectIds"] == []
    event = done(kitchen.step("ToggleObjectOn", objectId=MICROWAVE, forceAction=True))
    assert event.get_object(EGG)["temperature"] == "Cold"  # as in the fridge, from where it was taken


@pytest.mark.slow
def test_a_fork_of_few_pixels_is_taken_from_as_far_as_ai2thor_allows(kitchen) -> None:
    taken = []
    done(kitchen.step("PickupObject", objectId=FORK, forceAction=True))
    done(kitchen.step("PutObject", objectId=ISLAND, forceAction=True))
    poses = done(kitchen.step("GetInteractablePoses", objectId=FORK, horizons=[30], standings=[True])).metadata[
        "actionReturn"
    ]
    start = kitchen.last_event.get_object(FORK)
    as_before = {"position": start["axisAlignedBoundingBox"]["center"], "rotation": start["rotation"]}
    for pose in poses[::3]:
        event = done(kitchen.step("TeleportFull", renderInstanceSegmentation=True, **pose))
        pixels = int(event.instance_masks[FORK].sum())
        assert pixels >= 10
        if pixels < 50:
            done(kitchen.step("PickupObject", objectId=FORK))
            done(kitchen.step("PlaceObjectAtPoint", objectId=FORK, **as_before))
            taken.append(pose)
    assert len(taken) >= 3


def test_what_is_held_leaves_its_place_free(kitchen) -> None:
    box = kitchen.last_event.get_object(APPLE)["axisAlignedBoundingBox"]
    place = box["center"] | {"y": box["center"]["y"] - box["size"]["y"] / 2}
    assert not kitchen.step("PlaceObjectAtPoint", objectId=EGG, position=place)
    done(kitchen.step("PickupObject", objectId=APPLE, forceAction=True))
    event = done(kitchen.step("PlaceObjectAtPoint", objectId=EGG, position=place))
    assert event.get_object(EGG)["parentReceptacles"] == [ISLAND]


def test_what_is_put_into_a_sink_lies_in_its_basin(kitchen) -> None:
    done(kitchen.step("PickupObject", objectId=APPLE, forceAction=True))
    event = done(kitchen.step("PutObject", objectId=SINK, forceAction=True))
    assert event.get_object(APPLE)["parentReceptacles"] == [f"{SINK}|SinkBasin"]


def test_the_box_of_what_is_open_has_all_of_it(kitchen) -> None:
    assert kitchen.step("OpenObject", objectId=MICROWAVE, forceAction=True)
    record = kitchen.last_event.get_object(MICROWAVE)
    oriented = np.array(record["objectOrientedBoundingBox"]["cornerPoints"])
    aligned = np.array(record["axisAlignedBoundingBox"]["cornerPoints"])
    assert np.allclose(oriented.min(axis=0), aligned.min(axis=0), atol=0.002)  # it stands square in the room
    assert np.allclose(oriented.max(axis=0), aligned.max(axis=0), atol=0.002)
