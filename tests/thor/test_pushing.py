import math

import numpy as np
import pytest

from remqa_data.sim.physics.bodies import FRICTION, GRAVITY_M_S2

APPLE = "Apple|-00.47|+01.15|+00.48"
FRIDGE = "Fridge|-02.10|+00.00|+01.07"
STOOL = "Stool|+00.74|+00.00|+00.56"
BEFORE_STOOL = {"x": 1.5, "y": 0.9, "z": 0.5, "rotation": {"x": 0, "y": 270, "z": 0}, "horizon": 60, "standing": True}
"""Arguments of TeleportFull."""


def slid(event, before) -> float:
    now, then = event.get_object(STOOL)["position"], before.get_object(STOOL)["position"]
    return math.dist([now["x"], now["z"]], [then["x"], then["z"]])


def point_of_stool(event) -> tuple[float, float]:
    x0, y0, x1, y1 = event.instance_detections2D[STOOL]
    rows, columns = np.nonzero(event.instance_masks[STOOL])
    middle = np.argmin(np.hypot(columns - (x0 + x1) / 2, rows - (y0 + y1) / 2))
    height, width = event.frame.shape[:2]
    return (float(columns[middle]) + 0.5) / width, (float(rows[middle]) + 0.5) / height


def test_pushes_along_the_heading(kitchen) -> None:
    before = kitchen.step("TeleportFull", **BEFORE_STOOL).get_object(STOOL)["position"]
    event = kitchen.step("DirectionalPush", objectId=STOOL, moveMagnitude=400.0, pushAngle=90)
    assert event, event.metadata["errorMessage"]
    after = event.get_object(STOOL)["position"]
    assert after["z"] - before["z"] > 0.05  # facing -x, clockwise by 90 degrees is +z
    assert abs(after["x"] - before["x"]) < 0.02
    event = kitchen.step("PullObject", objectId=STOOL, moveMagnitude=300.0)
    assert event, event.metadata["errorMessage"]
    assert event.get_object(STOOL)["position"]["x"] > after["x"]
    assert not kitchen.step("PushObject", objectId=FRIDGE, moveMagnitude=100.0)
    assert "incompatible with push/pull" in kitchen.last_event.metadata["errorMessage"]
    assert not kitchen.step("PushObject", objectId=STOOL, moveMagnitude=-5)
    event = kitchen.step("PushObject", objectId=STOOL)
    assert event.metadata["actionReturn"] == event.get_object(STOOL)["position"]


@pytest.mark.slow
def test_reaches_for_what_it_sees_and_pushes_it(kitchen) -> None:
    before = kitchen.step("TeleportFull", **BEFORE_STOOL, renderInstanceSegmentation=True)
    x, y = point_of_stool(before)
    event = kitchen.step("TouchThenApplyForce", x=x, y=y, handDistance=5.0)
    touched = event.metadata["actionReturn"]
    assert (touched["didHandTouchSomething"], touched["objectId"]) == (True, STOOL)
    assert slid(event, before) == 0.0
    at = kitchen.step("GetCoordinateFromRaycast", x=x, y=y).metadata["actionReturn"]
    eye = event.metadata["cameraPosition"]
    assert touched["armsLength"] == pytest.approx(math.dist(list(at.values()), list(eye.values())), abs=0.01)
    event = kitchen.step("TouchThenApplyForce", x=x, y=y, handDistance=touched["armsLength"] - 0.1, moveMagnitude=900)
    assert event.metadata["actionReturn"] == {
        "didHandTouchSomething": False,
        "objectId": "",
        "armsLength": touched["armsLength"] - 0.1,
    }
    force = {"direction": {"x": 0.0, "y": 0.5, "z": -1.0}, "moveMagnitude": 400}
    event = kitchen.step("TouchThenApplyForce", x=x, y=y, handDistance=5.0, **force)
    assert slid(event, before) > 0.02
    assert (
        event.get_object(STOOL)["position"]["x"] > before.get_object(STOOL)["position"]["x"]
    )  # towards who looks along -x
    there = event.get_object(STOOL)["position"]["x"]
    backwards = kitchen.step("TouchThenApplyForce", x=x, y=y, handDistance=5.0, **{**force, "moveMagnitude": -400})
    assert backwards.get_object(STOOL)["position"]["x"] < there
    far = kitchen.step("TouchThenApplyForce", x=0.02, y=0.02, handDistance=20.0, **force)
    assert far.metadata["errorMessage"] == "Object successfully hit, but it is outside of the Agent's interaction range"
    assert not far.metadata["actionReturn"]["didHandTouchSomething"]
    kitchen.step("LookUp")
    wall = kitchen.step("TouchThenApplyForce", x=0.5, y=0.02, handDistance=20.0, **force)
    assert wall.metadata["actionReturn"]["didHandTouchSomething"], wall.metadata["errorMessage"]


@pytest.mark.slow
def test_what_is_heavier_slides_less_far(kitchen) -> None:
    way = []
    for mass in (None, 60.0):
        kitchen.reset()
        before = kitchen.step("TeleportFull", **BEFORE_STOOL)
        if mass is not None:
            event = kitchen.step("SetMassProperties", objectId=STOOL, mass=mass, drag=15.9, angularDrag=5.6)
            assert event.get_object(STOOL)["mass"] == mass
        event = kitchen.step("PullObject", objectId=STOOL, moveMagnitude=300)
        assert event, event.metadata["errorMessage"]
        way.append(slid(event, before))
    assert way[0] > 0.01
    assert way[1] == pytest.approx(0.001)  # friction swallows the push but for a millimetre
    kitchen.reset()
    assert kitchen.last_event.get_object(STOOL)["mass"] != 60.0
    assert "moveable" in kitchen.step("SetMassProperties", objectId=FRIDGE, mass=1.0).metadata["errorMessage"]
    assert "negative" in kitchen.step("SetMassProperties", objectId=APPLE, mass=-1.0).metadata["errorMessage"]
    assert kitchen.step("SetMassProperties", objectId=APPLE, mass=0.0)


@pytest.mark.parametrize("newtons", [1.0, 20.0, 40.0])  # for each kilogram
def test_a_push_goes_as_far_as_friction_lets_it(kitchen, newtons: float) -> None:
    before = kitchen.last_event.get_object(STOOL)
    assert kitchen.step("PushObject", objectId=STOOL, moveMagnitude=newtons * before["mass"], forceAction=True)
    after = kitchen.last_event.get_object(STOOL)["position"]
    gone = math.dist(*((place["x"], place["z"]) for place in (before["position"], after)))
    speed = newtons * 0.02
    assert gone == pytest.approx(max(speed**2 / (2 * FRICTION * -GRAVITY_M_S2), 0.001), abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "pushed", "angle", "blocker"),
    [
        ("FloorPlan322", "Bed|-00.75|-00.02|+00.11", 270, "structure"),
        ("FloorPlan4", "DiningTable|-00.62|+00.02|+02.49", 90, "structure"),
        ("FloorPlan205", "FloorLamp|-04.72|00.00|+03.69", 0, "Sofa|-04.43|+00.01|+05.06"),
        ("FloorPlan16", "Microwave|+01.94|+01.75|-01.83", 90, "what holds it"),
    ],
)
def test_what_touches_something_is_not_pushed_through_it(kitchen, scene, pushed, angle, blocker) -> None:
    """All but the microwave, which hangs, are in that by a few millimetres."""
    before = kitchen.reset(scene).get_object(pushed)
    turned = angle - kitchen.last_event.metadata["agent"]["rotation"]["y"]
    event = kitchen.step("DirectionalPush", objectId=pushed, pushAngle=turned, moveMagnitude=6000, forceAction=True)
    assert event.metadata["errorMessage"] == f"{blocker} is blocking {pushed}"
    assert event.get_object(pushed)["position"] == before["position"]


@pytest.mark.slow
def test_furniture_takes_its_shelves_along_and_what_is_on_them(kitchen) -> None:
    unit = "ShelvingUnit|+01.59|+00.00|-02.33"
    kitchen.reset("FloorPlan303")
    before = {o["objectId"]: o for o in kitchen.last_event.metadata["objects"]}
    corners = np.array(before[unit]["axisAlignedBoundingBox"]["cornerPoints"])
    low, high = corners.min(axis=0), corners.max(axis=0)
    within = [
        name
        for name, o in before.items()
        if name != unit and o["objectType"] != "Floor" and (low < (m := middle(o))).all() and (m < high).all()
    ]
    assert sum(before[name]["objectType"] == "Shelf" for name in within) == 4
    assert any(before[name]["pickupable"] for name in within)
    turned = 270 - kitchen.last_event.metadata["agent"]["rotation"]["y"]
    event = kitchen.step("DirectionalPush", objectId=unit, pushAngle=turned, moveMagnitude=6000, forceAction=True)
    way = middle(event.get_object(unit)) - middle(before[unit])
    assert way[0] < -0.1
    for name in within:
        assert middle(event.get_object(name)) - middle(before[name]) == pytest.approx(way, abs=0.005)


def middle(record) -> np.ndarray:
    return np.array(list(record["axisAlignedBoundingBox"]["center"].values()))
