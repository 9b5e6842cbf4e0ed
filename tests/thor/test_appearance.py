"""What objects are in is seen in pictures, and not for longer than they are in it."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from remqa_data.assets.core.sizes import typical_size
from remqa_data.floorplans.ithor.table import recorded_objects
from remqa_data.thor import Controller
from remqa_data.thor.object_states.appearance import liquid_in
from tests.helpers.thor_clients import act, first, first_id

pytestmark = pytest.mark.slow

ROOMS = {"kitchen": "FloorPlan4", "living room": "FloorPlan222", "bedroom": "FloorPlan305", "bathroom": "FloorPlan402"}


def in_rooms(*cases: tuple[str | None, ...]) -> list:
    """Each case in each kind of room that has anything of the type that it is about."""
    return [
        pytest.param(name, *case, id="-".join(map(str, (kind, *case))))
        for kind, name in ROOMS.items()
        for case in cases
        if any(row.type in case for row in recorded_objects(name))
    ]


@pytest.fixture(scope="module")
def room(request):
    settings = {"renderInstanceSegmentation": True, "makeAgentsVisible": False}  # it stands where things are put
    with Controller(scene=request.param, width=96, height=96, **settings) as controller:
        yield controller


def seen(controller: Controller, object_id: str) -> np.ndarray:
    """(4, h, w, 3) an object from above, from near, from four sides."""
    box = next(o for o in controller.last_event.metadata["objects"] if o["objectId"] == object_id)
    middle, size = (box["axisAlignedBoundingBox"][name] for name in ("center", "size"))
    away = 0.7 * max(size.values()) + 0.15
    pictures = []
    for yaw, x, z in ((225.0, 1, 1), (315.0, 1, -1), (45.0, -1, -1), (135.0, -1, 1)):
        position = {"x": middle["x"] + x * away, "y": middle["y"] + away, "z": middle["z"] + z * away}
        view = {"position": position, "rotation": {"x": 35.3, "y": yaw, "z": 0.0}, "fieldOfView": 50.0}
        if not controller.last_event.metadata["thirdPartyCameras"]:
            event = controller.step("AddThirdPartyCamera", **view)
        else:
            event = controller.step("UpdateThirdPartyCamera", thirdPartyCameraId=0, **view)
        pictures.append(event.third_party_camera_frames[0][..., :3].astype(int))
    return np.stack(pictures)


def seen_alone(controller: Controller, type_name: str) -> str:
    """Put the first object of a type that can be carried where it is seen."""
    record = first(controller, type_name)
    if record["pickupable"]:
        agent = controller.last_event.metadata["agent"]["position"]
        above = {"x": agent["x"], "y": agent["y"] + 0.3, "z": agent["z"]}
        controller.step("PlaceObjectAtPoint", objectId=record["objectId"], position=above)
        assert controller.last_event.metadata["lastActionSuccess"], controller.last_event.metadata["errorMessage"]
    return record["objectId"]


@pytest.mark.parametrize(
    ("room", "action", "type_name", "back"),
    in_rooms(
        ("BreakObject", "Window", None),
        ("CookObject", "Potato", None),
        ("DirtyObject", "Bed", "CleanObject"),
        ("DirtyObject", "Mirror", "CleanObject"),
        ("FillObjectWithLiquid", "Mug", "EmptyLiquidFromObject"),
        ("FillObjectWithLiquid", "Pot", "EmptyLiquidFromObject"),
        ("ToggleObjectOn", "Candle", "ToggleObjectOff"),
        ("ToggleObjectOn", "Faucet", None),  # what was under it stays wet
        ("ToggleObjectOn", "Toaster", "ToggleObjectOff"),
    ),
    indirect=["room"],
)
def test_a_condition_is_seen_while_it_lasts(room, action, type_name, back) -> None:
    room.reset()
    object_id = seen_alone(room, type_name)
    before = seen(room, object_id)
    act(room, action, object_id)
    after = seen(room, object_id)
    assert (np.abs(after - before).max(axis=-1) > 12).mean() > 0.001
    if back is not None:
        act(room, back, object_id)
        assert np.array_equal(seen(room, object_id), before)
    room.reset()
    assert first_id(room, type_name) == seen_alone(room, type_name) == object_id
    assert np.array_equal(seen(room, object_id), before)


@pytest.mark.parametrize(
    ("room", "type_name"), in_rooms(("Television",), ("Laptop",), ("FloorLamp",)), indirect=["room"]
)
def test_what_is_on_shines(room, type_name) -> None:
    room.reset()
    object_id = first_id(room, type_name)
    pictures = []
    for action in ("ToggleObjectOn", "ToggleObjectOff"):
        act(room, action, object_id)
        pictures.append(seen(room, object_id))
    brighter = (pictures[0] - pictures[1]).mean(axis=-1)
    assert (brighter > 20).mean() > 0.001
    assert not (brighter < -20).any()


def test_a_knob_lights_the_burner_that_it_is_for() -> None:
    with Controller(scene="FloorPlan4", width=96, height=96) as kitchen:
        knob = first(kitchen, "StoveKnob")
        (burner,) = knob["controlledObjects"]
        before = seen(kitchen, burner)
        act(kitchen, "ToggleObjectOn", knob["objectId"])
        lit = seen(kitchen, burner)
        assert (np.abs(lit - before).max(axis=-1) > 40).mean() > 0.01
        act(kitchen, "ToggleObjectOff", knob["objectId"])
        assert np.array_equal(seen(kitchen, burner), before)


def test_liquids_differ_and_stay_in_the_vessel() -> None:
    mug = build(AssetSpec("Mug", typical_size("Mug")))
    low, high = mug.bounds()
    for liquid in ("water", "coffee", "wine"):
        surface = liquid_in(mug, liquid)
        assert surface is not None
        assert (surface.vertices > low).all()
        assert (surface.vertices < high).all()
    assert len({liquid_in(mug, liquid).material.rgb for liquid in ("water", "coffee", "wine")}) == 3


def test_a_closed_vessel_and_a_thing_without_a_hollow_show_no_liquid() -> None:
    assert liquid_in(build(AssetSpec("Kettle", typical_size("Kettle"))), "water") is None
    assert liquid_in(build(AssetSpec("Book", typical_size("Book"))), "water") is None


def test_marks_and_randomised_colours_survive_a_change_of_condition() -> None:
    with Controller(scene="FloorPlan4", width=96, height=96, renderInstanceSegmentation=True) as kitchen:
        bowl, pan = first_id(kitchen, "Bowl"), first_id(kitchen, "Pan")
        kitchen.step("RandomizeColors")
        coloured = seen(kitchen, pan)
        kitchen.step("MaskObject", objectId=bowl)
        act(kitchen, "FillObjectWithLiquid", bowl)
        assert (seen(kitchen, bowl) == [255, 0, 255]).all(axis=-1).mean() > 0.02
        kitchen.step("UnmaskObject", objectId=bowl)
        act(kitchen, "EmptyLiquidFromObject", bowl)
        assert np.array_equal(seen(kitchen, pan), coloured)
        kitchen.step("RemoveFromScene", objectId=pan)
        act(kitchen, "FillObjectWithLiquid", bowl)
        assert pan not in [o["objectId"] for o in kitchen.last_event.metadata["objects"]]
        assert not (seen(kitchen, bowl) == [255, 0, 255]).all(axis=-1).any()


def test_what_is_built_lit_is_dark_until_it_is_switched_on(kitchen) -> None:
    kitchen.reset("FloorPlan301", renderInstanceSegmentation=True)
    laptop = first_id(kitchen, "Laptop")
    poses = kitchen.step("GetInteractablePoses", objectId=laptop, horizons=[30], standings=[True], renderImage=False)
    views = [kitchen.step("TeleportFull", **pose) for pose in poses.metadata["actionReturn"][::4]]
    seen = [int(view.instance_masks[laptop].sum()) if laptop in view.instance_masks else 0 for view in views]
    before = kitchen.step("TeleportFull", **poses.metadata["actionReturn"][::4][int(np.argmax(seen))])
    assert not before.get_object(laptop)["isToggled"]
    lit = kitchen.step("ToggleObjectOn", objectId=laptop)
    mask = before.instance_masks[laptop]
    assert lit.frame[mask].mean() > before.frame[mask].mean() + 5
    assert np.array_equal(kitchen.step("ToggleObjectOff", objectId=laptop).frame, before.frame)
