"""What changes how things look, as AI2-THOR's pages on domain randomization say, and how allenact marks objects."""

from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

from remqa_data.thor import Controller
from remqa_data.thor.actions.looks import randomize_materials

pytestmark = pytest.mark.slow

APPLE, ISLAND = "Apple|-00.47|+01.15|+00.48", "CounterTop|-00.08|+01.15|00.00"
MAGENTA = np.array([255, 0, 255])


@pytest.fixture(scope="module")
def bathroom() -> Iterator[Controller]:
    with Controller(scene="FloorPlan401") as controller:
        yield controller


@pytest.fixture
def rooms(kitchen, bathroom) -> list[Controller]:
    """Two rooms with all pictures, as they were loaded."""
    for controller in (kitchen, bathroom):
        controller.initialization_parameters = {}
        controller.reset(renderDepthImage=True, renderInstanceSegmentation=True, renderSemanticSegmentation=True)
        controller.step("SetRandomSeed", seed=0)
    return [kitchen, bathroom]


def assert_only_colours_differ(event, before) -> None:
    assert not np.array_equal(event.frame, before.frame)
    for image in ("depth_frame", "instance_segmentation_frame", "semantic_segmentation_frame"):
        assert np.array_equal(getattr(event, image), getattr(before, image)), image
    assert event.metadata["objects"] == before.metadata["objects"]


def most_seen(event) -> str:
    objects = [name for name in event.instance_masks if event.get_object(name) and name[:5] != "Floor"]
    return max(objects, key=lambda name: event.instance_masks[name].sum())


def test_a_masked_object_is_magenta_and_nothing_else_changes(rooms) -> None:
    assert rooms
    for controller in rooms:
        before = controller.last_event
        name = most_seen(before)
        event = controller.step("MaskObject", objectId=name)
        assert_only_colours_differ(event, before)
        is_marked = (event.frame == MAGENTA).all(axis=2)
        mask = event.instance_masks[name]
        assert not (is_marked & ~mask).any()
        assert is_marked.sum() > 0.9 * mask.sum()  # smoothed edges are a mixture
        assert np.array_equal(controller.step("UnmaskObject", objectId=name).frame, before.frame)


def test_an_emphasized_object_is_alone_in_the_picture(rooms) -> None:
    assert rooms
    for controller in rooms:
        before = controller.last_event
        name = most_seen(before)
        event = controller.step("EmphasizeObject", objectId=name)
        assert list(event.instance_masks) == [name]
        assert not (before.instance_masks[name] & ~event.instance_masks[name]).any()  # nothing is in front of it
        is_marked = (event.frame == MAGENTA).all(axis=2)
        assert not (is_marked & ~event.instance_masks[name]).any()
        assert is_marked.sum() > 0.9 * event.instance_masks[name].sum()
        assert event.metadata["objects"] == before.metadata["objects"]
        controller.step("MaskObject", objectId=name)
        undone = controller.step("UnemphasizeAll")
        assert np.array_equal(undone.frame, before.frame)
        assert np.array_equal(undone.depth_frame, before.depth_frame)


def test_masks_name_what_is_wrong(kitchen) -> None:
    for action in ("MaskObject", "UnmaskObject", "EmphasizeObject"):
        assert "is not the objectId on any object" in kitchen.step(action, objectId="Apple|0").metadata["errorMessage"]
        with pytest.raises(ValueError, match="objectId"):
            kitchen.step(action)
    kitchen.step("RemoveFromScene", objectId=APPLE)
    assert kitchen.step("EmphasizeObject", objectId=APPLE).metadata["errorMessage"] == f"{APPLE} is not in the scene"
    assert kitchen.step("UnemphasizeAll")


@pytest.mark.parametrize("what", ["Materials", "Colors", "Lighting"])
def test_looks_are_random_by_seed_and_change_only_colours(rooms, what) -> None:
    assert rooms
    for controller in rooms:
        before = controller.last_event
        first = controller.step(f"Randomize{what}")
        assert_only_colours_differ(first, before)
        again = controller.step(f"Randomize{what}")
        assert not np.array_equal(again.frame, first.frame)
        assert np.array_equal(controller.step(f"Reset{what}").frame, before.frame)
        controller.step("SetRandomSeed", seed=0)
        assert np.array_equal(controller.step(f"Randomize{what}").frame, first.frame)
        controller.step("SetRandomSeed", seed=-1)
        assert not np.array_equal(controller.step(f"Randomize{what}").frame, first.frame)
        reset = controller.reset()
        assert np.array_equal(reset.frame, before.frame)
        assert not np.array_equal(controller.step(f"Randomize{what}").frame, first.frame)  # another room, another look


def test_materials_say_where_they_are_from(rooms) -> None:
    kitchen, bathroom = rooms
    value = kitchen.step("RandomizeMaterials").metadata["actionReturn"]
    assert set(value["chosenRoomTypes"]) == {"kitchen", "livingroom", "bedroom", "bathroom", "robothor"}
    assert (value["useTrainMaterials"], value["useValMaterials"], value["useTestMaterials"]) == (True, False, False)
    more = kitchen.step("RandomizeMaterials", useValMaterials=True).metadata["actionReturn"]
    assert more["totalMaterialsConsidered"] > value["totalMaterialsConsidered"] > 100
    value = bathroom.step("RandomizeMaterials", inRoomTypes=["Bathroom", "Bedroom"]).metadata["actionReturn"]
    assert value["chosenRoomTypes"] == ["bathroom", "bedroom"]


@pytest.mark.parametrize(
    ("action", "arguments", "words"),
    [
        ("RandomizeMaterials", {"useTrainMaterials": False}, "useTrainMaterials cannot be false"),
        ("RandomizeMaterials", {"inRoomTypes": []}, "must be some of kitchen"),
        ("RandomizeMaterials", {"inRoomTypes": ["Kitchen", "Garage"]}, "['garage'] must be some of kitchen"),
        ("RandomizeMaterials", {"inRoomTypes": ["Bedroom"]}, "must include kitchen"),
        ("RandomizeLighting", {"randomizeColor": False, "hue": [0, 1]}, "hue is given"),
        ("RandomizeLighting", {"brightness": [-1, 1]}, "brightness must be 0 or more"),
        ("RandomizeLighting", {"hue": [0, 1.5]}, "hue must be in [0:1]"),
        ("RandomizeLighting", {"saturation": [1]}, "saturation must have 2 values"),
        ("RandomizeLighting", {"brightness": []}, "brightness must have 2 values"),
    ],
)
def test_looks_that_are_refused_change_nothing(kitchen, action, arguments, words) -> None:
    before = kitchen.last_event
    event = kitchen.step(action, **arguments)
    assert not event
    assert words in event.metadata["errorMessage"]
    assert np.array_equal(event.frame, before.frame)


def test_a_type_of_room_that_is_none_of_ai2_thors_is_named_like_the_others() -> None:
    world = SimpleNamespace(scene=SimpleNamespace(room_type="tool_shed"))
    simulator = SimpleNamespace(room=SimpleNamespace(scene="FloorPlan301", world=world))
    refused = randomize_materials(simulator, inRoomTypes=["Kitchen"])
    assert refused.error == "inRoomTypes must include toolshed in FloorPlan301, which is one"


def test_light_is_as_bright_and_as_coloured_as_asked_for(rooms) -> None:
    assert rooms
    for controller in rooms:
        before = controller.last_event.frame.mean(axis=(0, 1))
        same = controller.step("RandomizeLighting", brightness=[1, 1], randomizeColor=False).frame.mean(axis=(0, 1))
        assert same == pytest.approx(before)
        dark = controller.step("RandomizeLighting", brightness=[0.4, 0.3], randomizeColor=False).frame
        assert (dark.mean(axis=(0, 1)) < 0.8 * before).all()
        red = controller.step(
            "RandomizeLighting", brightness=[1, 1], hue=[0, 0], saturation=[1, 1], synchronized=True
        ).frame.mean(axis=(0, 1))
        assert red[0] == pytest.approx(before[0], rel=0.02)
        assert (red[1:] < 0.85 * before[1:]).all()


def test_looks_outlast_what_happens_in_the_room(kitchen) -> None:
    kitchen.step("RandomizeMaterials")
    look = kitchen.step("RandomizeLighting").frame
    kitchen.step("PlaceObjectAtPoint", objectId=APPLE, position={"x": 0.0, "y": 1.0, "z": 0.0})  # refused: rolled back
    kitchen.step("OpenObject", objectId="Fridge|-02.10|+00.00|+01.07", forceAction=True)
    kitchen.step("CloseObject", objectId="Fridge|-02.10|+00.00|+01.07", forceAction=True)
    kitchen.step("RotateRight")
    assert np.array_equal(kitchen.step("RotateLeft").frame, look)


def test_a_hidden_object_is_in_no_picture_and_is_there(rooms) -> None:
    assert rooms
    for controller in rooms:
        before = controller.last_event
        name = most_seen(before)
        event = controller.step("HideObject", objectId=name)
        assert name not in event.instance_masks
        behind = before.instance_masks[name]
        assert (event.depth_frame[behind] > before.depth_frame[behind]).mean() > 0.9
        assert np.array_equal(event.instance_segmentation_frame[~behind], before.instance_segmentation_frame[~behind])
        assert event.metadata["objects"] == before.metadata["objects"]
        controller.step("ToggleMapView")
        above = controller.step("ToggleMapView")
        assert np.array_equal(above.frame, event.frame)
        event = controller.step("UnhideObject", objectId=name)
        assert np.array_equal(event.frame, before.frame)
    kitchen = rooms[0]
    fridge, egg = "Fridge|-02.10|+00.00|+01.07", "Egg|-02.04|+00.81|+01.24"
    before_fridge = {"x": -0.75, "y": 0.9, "z": 1.2, "rotation": 270, "horizon": 30, "standing": True}
    kitchen.step("TeleportFull", **before_fridge)
    shown = kitchen.step("OpenObject", objectId=fridge, forceAction=True)
    assert egg in shown.instance_masks
    event = kitchen.step("HideObject", objectId=fridge)
    assert not {egg, fridge} & set(event.instance_masks)
    assert {egg, fridge} <= set(kitchen.step("UnhideObject", objectId=fridge).instance_masks)
    kitchen.step("HideObject", objectId=fridge)
    kitchen.reset()
    assert fridge in kitchen.step("TeleportFull", **before_fridge).instance_masks
    assert not kitchen.step("HideObject", objectId="Fridge|0")
