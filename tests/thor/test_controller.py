import numpy as np
import pytest
from ai2thor.controller import Controller as ThorController
from ai2thor.server import DepthFormat

from remqa_data.thor import Controller
from tests.helpers.thor_clients import first


def test_it_is_ai2thors_controller(kitchen) -> None:
    assert isinstance(kitchen, ThorController)
    assert len(kitchen.scenes_in_build) == 120
    assert kitchen.scenes_in_build == set(kitchen.ithor_scenes())


@pytest.mark.slow
def test_scenes_are_loaded_by_name(kitchen) -> None:
    event = kitchen.reset("FloorPlan402")
    assert event.metadata["sceneName"] == "FloorPlan402_physics"
    assert event.objects_by_type("Toilet")
    with pytest.raises(ValueError, match="not contained in build"):
        kitchen.reset("FloorPlan99")
    with pytest.raises(ValueError, match="Invalid action: CreateHouse"):
        kitchen.step("CreateHouse", house={"rooms": []})  # ProcTHOR
    assert kitchen.step("Pass").objects_by_type("Toilet")


def test_reset_restores_everything(kitchen) -> None:
    start = kitchen.last_event
    kitchen.step("PickupObject", objectId="Apple|-00.47|+01.15|+00.48", forceAction=True)
    kitchen.step("OpenObject", objectId="Fridge|-02.10|+00.00|+01.07", forceAction=True)
    kitchen.step("MoveRight")
    again = kitchen.reset()
    assert again.metadata == start.metadata
    assert np.array_equal(again.frame, start.frame)


@pytest.mark.slow
def test_the_same_actions_give_the_same_events(kitchen) -> None:
    actions = ["RotateLeft", "MoveAhead", "MoveAhead", "LookDown", "MoveRight", "Crouch", "RotateRight"]
    first = [kitchen.step(action) for action in actions]
    assert len({event.frame.tobytes() for event in first}) > 3
    with Controller(scene="FloorPlan1") as other:
        for event, action in zip(first, actions, strict=True):
            again = other.step(action)
            assert again.metadata == event.metadata
            assert np.array_equal(again.frame, event.frame)


def test_frames_are_as_asked_for(kitchen) -> None:
    event = kitchen.reset(width=128, height=64)
    assert event.frame.shape == (64, 128, 3)
    assert event.depth_frame is event.instance_segmentation_frame is event.semantic_segmentation_frame is None
    event = kitchen.step("ChangeResolution", x=50, y=40)
    assert event.frame.shape == (40, 50, 3)
    assert (event.screen_width, event.screen_height) == (50, 40)
    assert not kitchen.step("ChangeResolution", x=0, y=40)
    event = kitchen.step("Pass", renderInstanceSegmentation=True)
    assert event.instance_segmentation_frame.shape == (40, 50, 3)
    assert kitchen.step("Pass").instance_segmentation_frame is None
    assert kitchen.step("Pass", renderImage=False).frame is None
    with pytest.raises(ValueError, match="0 x 10"):
        kitchen.reset(width=0, height=10)
    for width in (-1, "wide", None, 10**6):
        with pytest.raises(ValueError, match=r"give whole numbers from 1 to 4096"):
            kitchen.reset(width=width)
    with pytest.raises(ValueError, match="NoSuchScene"):
        kitchen.reset("NoSuchScene", width=64)
    event = kitchen.reset()
    assert (event.screen_width, event.screen_height) == (128, 64)
    assert kitchen.reset(width="300").frame.shape == (64, 300, 3)


def test_pictures_change_nothing_in_the_metadata(kitchen) -> None:
    for _ in range(4):
        seen = kitchen.step("RotateRight").metadata
        assert {**kitchen.step("Pass", renderImage=False).metadata, "lastAction": "RotateRight"} == seen


def test_all_is_at_rest_after_an_action(kitchen) -> None:
    events = kitchen.multi_step_physics({"action": "RotateRight"})
    assert [event.metadata["lastAction"] for event in events] == ["RotateRight"]


def test_depth_is_in_metres_along_the_camera(kitchen) -> None:
    kitchen.reset(renderDepthImage=True)
    event = kitchen.step(
        "Teleport", position={"x": 1.0, "y": 0.9, "z": 0.0}, rotation={"x": 0, "y": 90, "z": 0}, horizon=60
    )
    # 60 degrees down, the middle of the picture shows the floor 1.576 m below, at a distance of 1.576 / sin 60.
    height = event.metadata["cameraPosition"]["y"] + 0.0083
    assert event.depth_frame.dtype == np.float32
    assert event.depth_frame[150, 150] == pytest.approx(height / np.sin(np.radians(60)), rel=0.02)
    assert event.depth_frame.max() <= 20.0


@pytest.mark.slow
def test_depth_formats() -> None:
    with Controller(scene="FloorPlan401", renderDepthImage=True, width=32, height=32) as metres:
        expected = metres.last_event.depth_frame
    with Controller(
        scene="FloorPlan401", renderDepthImage=True, width=32, height=32, depth_format=DepthFormat.Millimeters
    ) as millimetres:
        np.testing.assert_allclose(millimetres.last_event.depth_frame, 1000 * expected, rtol=1e-5)


def test_masks_flags_and_boxes_agree(kitchen) -> None:
    kitchen.reset(renderInstanceSegmentation=True, renderSemanticSegmentation=True)
    for _ in range(4):
        event = kitchen.step("RotateRight")
        assert any(record["visible"] for record in event.metadata["objects"])
        for record in event.metadata["objects"]:
            mask = event.instance_masks.get(record["objectId"])
            if record["visible"]:
                assert mask.sum() >= 10
                x1, y1, x2, y2 = event.instance_detections2D[record["objectId"]]
                rows, columns = np.nonzero(mask)
                assert (x1, y1, x2, y2) == (columns.min(), rows.min(), columns.max(), rows.max())
            if mask is not None:
                color = event.object_id_to_color[record["objectId"]]
                assert (event.instance_segmentation_frame[mask] == color).all()
                assert (event.semantic_segmentation_frame[mask] == event.object_id_to_color[record["objectType"]]).all()
        masks = np.array([event.instance_masks[name] for name in event.instance_masks])
        assert masks.sum(axis=0).max() == 1


def test_colors_have_one_meaning(kitchen) -> None:
    event = kitchen.step("Pass", renderInstanceSegmentation=True)
    colors = [tuple(entry["color"]) for entry in event.metadata["colors"]]
    assert len(set(colors)) == len(colors)
    names = {entry["name"] for entry in event.metadata["colors"]}
    assert {record["objectId"] for record in event.metadata["objects"]} <= names
    # MD5("Apple") begins with these bytes.
    assert event.object_id_to_color["Apple"] == (159, 98, 144)


def test_third_party_cameras(kitchen) -> None:
    kitchen.reset(renderDepthImage=True, renderInstanceSegmentation=True, renderSemanticSegmentation=True)
    # The agent's own eye, seen through another camera.
    own = kitchen.last_event
    event = kitchen.step(
        "AddThirdPartyCamera",
        position=own.metadata["cameraPosition"],
        rotation=own.metadata["agent"]["rotation"],
        fieldOfView=90,
    )
    assert np.array_equal(event.third_party_camera_frames[0], own.frame)
    assert np.array_equal(event.third_party_depth_frames[0], own.depth_frame)
    assert np.array_equal(event.third_party_instance_segmentation_frames[0], own.instance_segmentation_frame)
    assert np.array_equal(event.third_party_semantic_segmentation_frames[0], own.semantic_segmentation_frame)
    event = kitchen.step("UpdateThirdPartyCamera", thirdPartyCameraId=0, rotation={"x": 30, "y": 40, "z": 0})
    (camera,) = event.metadata["thirdPartyCameras"]
    assert camera["rotation"] == {"x": 30.0, "y": 40.0, "z": 0.0}
    assert camera["position"] == own.metadata["cameraPosition"]
    assert not np.array_equal(event.third_party_camera_frames[0], own.frame)
    assert not kitchen.step("UpdateThirdPartyCamera", thirdPartyCameraId=1)
    assert kitchen.reset().metadata["thirdPartyCameras"] == []


@pytest.mark.slow
def test_a_rolled_camera_turns_its_picture(kitchen) -> None:
    """A quarter counter-clockwise, as Unity's positive z is, turns what is seen clockwise; two quarters are upside down."""
    event = kitchen.reset(renderInstanceSegmentation=True)
    own = event.instance_segmentation_frame
    place, rotation = event.metadata["cameraPosition"], event.metadata["agent"]["rotation"]
    for turns, x in ((1, 0), (2, 0), (-1, 360)):
        kitchen.step("AddThirdPartyCamera", position=place, rotation={**rotation, "x": x, "z": 90 * turns})
    over_its_back = {"x": 180, "y": rotation["y"] + 180, "z": 0}  # that it looks over its own back is half a roll
    event = kitchen.step("AddThirdPartyCamera", position=place, rotation=over_its_back)
    seen = event.third_party_instance_segmentation_frames
    for frame, turns in zip(seen, (1, 2, -1, 2), strict=True):
        assert (frame == np.rot90(own, -turns)).all(axis=2).mean() > 0.99
        assert (frame == own).all(axis=2).mean() < 0.8
    assert event.metadata["thirdPartyCameras"][0]["rotation"]["z"] == 90.0


@pytest.mark.slow
def test_an_orthographic_camera_looks_anywhere(kitchen) -> None:
    """From the side a mug is as many pixels high as its box, however far away the camera is."""
    kitchen.reset(renderInstanceSegmentation=True)
    box = first(kitchen, "Fridge")
    name, middle, size = box["objectId"], *(box["axisAlignedBoundingBox"][key] for key in ("center", "size"))
    for away in (1.0, 1.5):
        place = {**middle, "x": middle["x"] + size["x"] / 2 + away}
        kitchen.step(
            "AddThirdPartyCamera",
            position=place,
            rotation={"x": 0, "y": 270, "z": 0},
            orthographic=True,
            orthographicSize=2.0,
        )
    seen = [masks[name] for masks in kitchen.last_event.third_party_instance_masks]
    assert len(seen) == 2
    for mask in seen:
        rows, columns = np.nonzero(mask)
        assert np.ptp(rows) + 1 == pytest.approx(size["y"] * 300 / 4, abs=2)
        assert np.ptp(columns) + 1 == pytest.approx(size["z"] * 300 / 4, abs=2)
    flat = {"position": middle, "rotation": {"x": 0}, "orthographic": True, "orthographicSize": 0}
    assert "not positive" in kitchen.step("AddThirdPartyCamera", **flat).metadata["errorMessage"]
    assert not kitchen.step("AddThirdPartyCamera", position=middle, rotation={}, fieldOfView=180)
    kitchen.reset()


def test_map_camera_sees_every_piece_of_furniture_on_the_floor(kitchen) -> None:
    kitchen.reset(renderInstanceSegmentation=True)
    properties = kitchen.step("GetMapViewCameraProperties").metadata["actionReturn"]
    event = kitchen.step("AddThirdPartyCamera", **properties)
    seen = event.third_party_instance_masks[0]
    for name in ("Fridge|-02.10|+00.00|+01.07", "CounterTop|-00.08|+01.15|00.00", "GarbageCan|-01.94|00.00|+02.03"):
        assert seen[name].sum() > 100
    rows, columns = np.nonzero(seen["Fridge|-02.10|+00.00|+01.07"])  # x = -2.1 is left, z = 1.07 is above the middle
    assert columns.mean() < 150
    assert rows.mean() < 150


def test_parameters_that_are_not_supported(kitchen) -> None:
    for parameters in ({"agentMode": "drone"}, {"renderNormalsImage": True}):
        kitchen.initialization_parameters = {}
        with pytest.raises(ValueError, match="not supported"):
            kitchen.reset(**parameters)
    kitchen.initialization_parameters = {}
    with pytest.raises(RuntimeError, match="gridSize"):
        kitchen.reset(gridSize=6)
    kitchen.initialization_parameters = {}
    with pytest.warns(UserWarning, match="visibilityDistanc has no effect") as warned:
        kitchen.reset(visibilityDistanc=3)
    assert warned[0].filename == __file__


def test_field_of_view(kitchen) -> None:
    event = kitchen.reset(fieldOfView=60)
    assert event.metadata["fov"] == 60.0
    assert not np.array_equal(event.frame, kitchen.reset(fieldOfView=90).frame)
