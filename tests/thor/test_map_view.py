"""The map as AI2-THOR's clients use it: to draw paths on, and to find objects in it."""

from collections.abc import Iterator

import numpy as np
import pytest

from remqa_data.thor import Controller

FRIDGE, ISLAND = "Fridge|-02.10|+00.00|+01.07", "CounterTop|-00.08|+01.15|00.00"


@pytest.fixture(scope="module")
def bathroom() -> Iterator[Controller]:
    with Controller(scene="FloorPlan401") as controller:
        yield controller


def pixel_of(position, camera_position, orthographic_size, shape) -> tuple[int, int]:
    """Row and column of a point, as AI2-THOR's example of drawing a path on a map finds them."""
    left, bottom = camera_position["x"] - orthographic_size, camera_position["z"] - orthographic_size
    across, up = ((position["x"] - left) / 2, (position["z"] - bottom) / 2)
    return round(shape[0] * (1 - up / orthographic_size)), round(shape[1] * across / orthographic_size)


@pytest.mark.slow
@pytest.mark.parametrize("size", [(300, 300), (320, 200)])
def test_the_map_is_what_a_camera_at_its_properties_sees(kitchen, bathroom, size) -> None:
    for controller in (kitchen, bathroom):
        controller.reset(
            width=size[0],
            height=size[1],
            renderDepthImage=True,
            renderInstanceSegmentation=True,
            makeAgentsVisible=False,  # it would be in the other camera's pictures
        )
        properties = controller.step("GetMapViewCameraProperties").metadata["actionReturn"]
        own = controller.step("AddThirdPartyCamera", **properties)
        event = controller.step("ToggleMapView")
        assert event, event.metadata["errorMessage"]
        assert np.array_equal(event.frame, own.third_party_camera_frames[0])
        assert np.array_equal(event.depth_frame, own.third_party_depth_frames[0])
        assert np.array_equal(event.instance_segmentation_frame, own.third_party_instance_segmentation_frames[0])
        assert event.metadata["cameraPosition"] == properties["position"]
        assert event.metadata["cameraOrthSize"] == properties["orthographicSize"]
        assert event.metadata["actionReturn"]["y"] > event.metadata["cameraPosition"]["y"]
        back = controller.step("ToggleMapView")
        for image in ("frame", "depth_frame", "instance_segmentation_frame"):
            assert np.array_equal(getattr(back, image), getattr(own, image))
        assert back.metadata["cameraOrthSize"] == -1.0
        assert back.metadata["cameraPosition"] == own.metadata["cameraPosition"]


def test_objects_are_where_the_map_says(kitchen) -> None:
    kitchen.reset(renderInstanceSegmentation=True)
    event = kitchen.step("ToggleMapView")
    camera, size = event.metadata["cameraPosition"], event.metadata["cameraOrthSize"]
    for name in (FRIDGE, ISLAND):
        box = event.get_object(name)["axisAlignedBoundingBox"]
        row, column = pixel_of(box["center"], camera, size, event.frame.shape)
        assert event.instance_masks[name][row, column]
        x, y = (column + 0.5) / 300, (row + 0.5) / 300
        assert kitchen.step("GetObjectInFrame", x=x, y=y).metadata["actionReturn"] == name
        point = kitchen.step("GetCoordinateFromRaycast", x=x, y=y).metadata["actionReturn"]
        assert point["x"] == pytest.approx(box["center"]["x"], abs=0.02)
        assert point["z"] == pytest.approx(box["center"]["z"], abs=0.02)


def test_the_agent_acts_and_sees_as_without_a_map(kitchen) -> None:
    plain = [kitchen.step(action) for action in ("RotateRight", "LookDown", "MoveAhead")]
    kitchen.reset()
    start = kitchen.step("ToggleMapView")
    for action, before in zip(("RotateRight", "LookDown", "MoveAhead"), plain, strict=True):
        event = kitchen.step(action)
        assert event.metadata["objects"] == before.metadata["objects"]
        assert event.metadata["agent"] == before.metadata["agent"]
        assert np.array_equal(event.frame, start.frame)  # the agent is not drawn
    assert kitchen.reset().metadata["cameraOrthSize"] == -1.0


@pytest.mark.slow
def test_ceilings_do_not_hide_a_room_from_above(kitchen, bathroom) -> None:
    for controller in (kitchen, bathroom):
        controller.reset(renderInstanceSegmentation=True)
        below = controller.step("GetMapViewCameraProperties").metadata["actionReturn"]
        own = controller.step("AddThirdPartyCamera", **below)
        above = {**below, "position": {**below["position"], "y": below["position"]["y"] + 4.0}}
        event = controller.step("AddThirdPartyCamera", **above)
        masks = event.third_party_instance_masks
        large = [name for name in masks[0] if masks[0][name].sum() > 2000]
        assert large
        for name in large:
            assert masks[1][name].sum() > 0.8 * masks[0][name].sum(), name
        # A perspective camera far above, as AI2-THOR's example of a top-down frame has it.
        pose = {**above, "orthographic": False, "fieldOfView": 50}
        del pose["orthographicSize"]
        seen = controller.step("AddThirdPartyCamera", **pose).third_party_instance_masks[2]
        assert len(seen) > 10
        # From below, the ceiling is there.
        assert np.array_equal(own.frame, controller.last_event.frame)
        up = {"position": {**below["position"], "y": 1.0}, "rotation": {"x": -90, "y": 0, "z": 0}}
        assert len(controller.step("AddThirdPartyCamera", **up).third_party_instance_masks[3]) < len(seen)


def test_a_third_party_camera_loses_and_gets_its_perspective(kitchen) -> None:
    camera = kitchen.step("GetMapViewCameraProperties").metadata["actionReturn"]
    above = kitchen.step("AddThirdPartyCamera", **camera, skyboxColor="white", farClippingPlane=50)
    assert above, above.metadata["errorMessage"]
    pose = {name: camera[name] for name in ("position", "rotation")}
    changed = kitchen.step("UpdateThirdPartyCamera", **pose, orthographic=False, fieldOfView=100)
    assert not np.array_equal(changed.third_party_camera_frames[0], above.third_party_camera_frames[0])
    again = kitchen.step("UpdateThirdPartyCamera", orthographic=True, orthographicSize=camera["orthographicSize"])
    assert np.array_equal(again.third_party_camera_frames[0], above.third_party_camera_frames[0])
