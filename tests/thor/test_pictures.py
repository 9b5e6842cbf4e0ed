import random

import numpy as np
import pytest
from ai2thor._quality_settings import QUALITY_SETTINGS

from remqa_data.thor import Controller
from tests.helpers.random_calls import call_at_random

pytestmark = pytest.mark.slow

TOASTER = "Toaster|-01.84|+00.90|+00.13"


def drawn_now(controller: Controller) -> np.ndarray:
    """What the agent's camera sees, drawn anew."""
    simulator = controller.server.session._simulator
    room, quality = simulator.room, simulator.quality
    camera, how = room.frame_camera(), {"shadows": quality.shadows, "antialias": quality.smooth_edges}
    with room.view.showing(room._figures(camera, room.agent)):
        return room.view.render(camera, only=room.shown_to(camera), **how).rgb


def test_a_place_that_is_seen_again_is_not_drawn_again(kitchen, monkeypatch) -> None:
    room = kitchen.server.session._simulator.room
    drawn = []
    render = room.view.render
    monkeypatch.setattr(room.view, "render", lambda camera, **kw: drawn.append(camera) or render(camera, **kw))
    frames = [kitchen.step("RotateRight").frame for _ in range(8)]
    assert len(drawn) == 3  # the first was drawn when the room was loaded
    assert all(np.array_equal(a, b) for a, b in zip(frames[:4], frames[4:], strict=True))
    assert np.array_equal(kitchen.step("RotateLeft").frame, frames[6])


@pytest.mark.parametrize(
    ("action", "arguments"),
    [
        ("RemoveFromScene", {"objectId": TOASTER}),
        ("MaskObject", {"objectId": TOASTER}),
        ("RandomizeMaterials", {}),
        ("RandomizeLighting", {"synchronized": True}),
        ("ToggleObjectOn", {"objectId": TOASTER, "forceAction": True}),
        ("ToggleMapView", {}),
    ],
)
def test_what_changes_the_room_changes_its_pictures(kitchen, action, arguments) -> None:
    (pose, *_) = kitchen.step("GetInteractablePoses", objectId=TOASTER, maxPoses=1).metadata["actionReturn"]
    before = kitchen.step("TeleportFull", **pose).frame
    event = kitchen.step(action, **arguments)
    assert event
    assert not np.array_equal(event.frame, before)
    assert np.array_equal(event.frame, drawn_now(kitchen))


def test_a_quality_says_what_pictures_are_drawn_with(kitchen) -> None:
    arguments = {"position": {"x": 0, "y": 2, "z": 0}, "rotation": {"x": 90, "y": 0, "z": 0}, "fieldOfView": 90}
    kitchen.step("AddThirdPartyCamera", **arguments)
    kinds = {}
    for quality in sorted(QUALITY_SETTINGS.keys() - {"DONOTUSE"}):
        event = kitchen.step("ChangeQuality", quality=quality, renderDepthImage=True)
        assert event, quality
        assert np.array_equal(event.frame, drawn_now(kitchen))
        kinds.setdefault(event.frame.tobytes(), []).append((quality, event))
    assert {frozenset(quality for quality, _ in alike) for alike in kinds.values()} == {
        frozenset({"Very Low", "Low"}),
        frozenset({"Medium", "MediumCloseFitShadows", "High"}),
        frozenset({"Very High", "Ultra", "High WebGL"}),
    }
    first, *others = [alike[0][1] for alike in kinds.values()]
    assert others
    for event in others:
        assert np.array_equal(event.depth_frame, first.depth_frame)
        assert not np.array_equal(event.third_party_camera_frames[0], first.third_party_camera_frames[0])
    event = kitchen.step("ChangeQuality", quality="Best")
    assert "choose one of Very Low, Low" in event.metadata["errorMessage"]
    with Controller(scene="FloorPlan1", quality="Medium") as controller:
        assert np.array_equal(controller.last_event.frame, drawn_now(controller))
        assert not controller.server.session._simulator.quality.smooth_edges
        assert np.array_equal(controller.reset("FloorPlan401").frame, drawn_now(controller))


def test_memory_is_bounded(kitchen, monkeypatch) -> None:
    size = 300 * 300 * 19
    kept = kitchen.server.session._simulator.room.pictures
    monkeypatch.setattr(kept, "most_bytes", 3 * size)
    for _ in range(6):
        kitchen.step("RotateRight", degrees=30)
    assert len(kept) == 3
    assert kept._bytes == 3 * size


@pytest.mark.parametrize("mode", ["default", "arm"])
def test_whatever_is_called_the_picture_is_that_of_the_room_as_it_is(mode, monkeypatch) -> None:
    with Controller(scene="FloorPlan401", agentMode=mode, width=96, height=96) as controller:
        step, compared = controller.step, []

        def step_and_compare(*args, **kwargs):
            kwargs.pop("renderImage", None)
            event = step(*args, **kwargs)
            compared.append(np.array_equal(event.frame, drawn_now(controller)))
            assert compared[-1], (args, kwargs)
            return event

        monkeypatch.setattr(controller, "step", step_and_compare)
        call_at_random(controller, random.Random(2), 400)
    assert len(compared) > 200


def test_a_wider_field_of_view_shows_more(kitchen) -> None:
    narrow = kitchen.last_event
    event = kitchen.step("ChangeFOV", fieldOfView=110, camera="FirstPersonCharacter")
    assert event.metadata["fov"] == 110
    seen = kitchen.step("Pass", renderInstanceSegmentation=True)
    before = kitchen.step("ChangeFOV", fieldOfView=narrow.metadata["fov"], renderInstanceSegmentation=True)
    shown = {name for name in before.instance_masks if before.get_object(name)}
    assert shown
    assert shown <= set(seen.instance_masks)
    assert np.array_equal(before.frame, narrow.frame)
    for arguments, text in (({"fieldOfView": 190}, "not in"), ({"fieldOfView": 60, "camera": "Drone"}, "FirstPerson")):
        assert text in kitchen.step("ChangeFOV", **arguments).metadata["errorMessage"]


def test_every_pixel_of_a_room_has_a_name(kitchen) -> None:
    kitchen.reset(renderInstanceSegmentation=True, renderSemanticSegmentation=True)
    panels: set[str] = set()
    for _ in range(4):
        event = kitchen.step("RotateRight")
        colors = np.unique(event.instance_segmentation_frame.reshape(-1, 3), axis=0)
        names = {event.color_to_object_id[tuple(color.tolist())] for color in colors}
        building = {name for name in names if event.get_object(name) is None}
        assert {name.partition("|")[0] for name in building} <= {"Wall", "Ceiling", "Floor", "Fixture"}
        walls = [mask for name, mask in event.instance_masks.items() if name.startswith("Wall|")]
        assert walls
        assert (event.class_masks["Wall"] == np.any(walls, axis=0)).all()
        panels |= building
    assert sum(name.startswith("Wall|") for name in panels) >= 4
    assert sum(name.startswith("Ceiling|") for name in panels) == 1
