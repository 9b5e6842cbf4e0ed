import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

FRIDGE = "Fridge|-02.10|+00.00|+01.07"
BEFORE_FRIDGE = {"position": {"x": -0.75, "y": 0.9, "z": 1.5}, "rotation": 270, "horizon": 30}


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(row=st.integers(0, 299), column=st.integers(0, 299), rotation=st.sampled_from([0.0, 45.0, 200.0, 270.0]))
def test_a_point_of_the_frame_is_where_its_depth_says(kitchen, row, column, rotation) -> None:
    event = kitchen.step("Teleport", **{**BEFORE_FRIDGE, "rotation": rotation}, renderDepthImage=True)
    depth = event.depth_frame[row, column]
    assert depth < 19.0
    event = kitchen.step("GetCoordinateFromRaycast", x=(column + 0.5) / 300, y=(row + 0.5) / 300)
    point, eye = event.metadata["actionReturn"], event.metadata["cameraPosition"]
    away = np.array([point[axis] - eye[axis] for axis in "xyz"])
    pitch, yaw = np.radians([30.0, rotation])
    ahead = np.array([np.cos(pitch) * np.sin(yaw), -np.sin(pitch), np.cos(pitch) * np.cos(yaw)])
    right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
    assert away @ ahead == pytest.approx(depth, rel=1e-4)
    assert away @ right == pytest.approx(depth * ((column + 0.5) / 150 - 1), abs=1e-3)
    assert away @ np.cross(ahead, right) == pytest.approx(depth * (1 - (row + 0.5) / 150), abs=1e-3)


def test_the_middle_of_the_frame_shows_the_floor(kitchen) -> None:
    kitchen.step("Teleport", position={"x": 1.0, "y": 0.9, "z": 0.0}, rotation=90, horizon=60)
    floor_y = kitchen.last_event.metadata["cameraPosition"]["y"] - 1.576
    point = kitchen.step("GetCoordinateFromRaycast", x=0.5, y=0.5).metadata["actionReturn"]
    assert point["y"] == pytest.approx(floor_y, abs=0.01)
    assert point["x"] == pytest.approx(1.0 + 1.576 / np.tan(np.radians(60)), abs=0.03)
    event = kitchen.step("GetCoordinateFromRaycast", x=1.2, y=0.5)
    assert event.metadata["errorMessage"] == "x and y must be in [0:1] not (x=1.2, y=0.5)."


@pytest.mark.parametrize(("x", "y"), [(0.5, 0.5), (0.1, 0.8), (0.93, 0.31)])
def test_where_the_frame_shows_a_point_is_where_that_was_read(kitchen, x, y) -> None:
    kitchen.step("Teleport", **BEFORE_FRIDGE)
    point = kitchen.step("GetCoordinateFromRaycast", x=x, y=y).metadata["actionReturn"]
    shown = kitchen.step("WorldToViewportPoint", position=point, renderDepthImage=True)
    found = shown.metadata["actionReturn"]
    assert (found["x"], found["y"]) == (pytest.approx(x, abs=1 / 300), pytest.approx(y, abs=1 / 300))
    assert found["z"] == pytest.approx(shown.depth_frame[int(y * 300), int(x * 300)], rel=1e-4)


@pytest.mark.parametrize("position", [{"x": 1.0, "y": 0.9, "z": 1.5}, {"x": -0.8, "y": 2.3, "z": 1.5}])
def test_what_is_behind_or_above_the_frame_is_not_in_it(kitchen, position) -> None:
    kitchen.step("Teleport", **BEFORE_FRIDGE)
    event = kitchen.step("WorldToViewportPoint", position=position)
    assert (event.metadata["errorMessage"], event.metadata["actionReturn"]) == ("Point not in viewport.", None)


def test_a_ray_meets_what_stands_in_its_way(kitchen) -> None:
    kitchen.step("TeleportFull", **BEFORE_FRIDGE, standing=True)
    eye, behind = {"x": -0.75, "y": 1.0, "z": 1.07}, {"x": -2.1, "y": 1.0, "z": 1.07}
    hit = kitchen.step("PerformRaycast", origin=eye, destination=behind).metadata["actionReturn"]
    assert hit["objectId"] == FRIDGE
    box = kitchen.last_event.get_object(FRIDGE)["axisAlignedBoundingBox"]
    front = box["center"]["x"] + box["size"]["x"] / 2
    assert hit["hitPoint"]["x"] == pytest.approx(front, abs=0.1)
    assert hit["hitDistance"] == pytest.approx(-0.75 - hit["hitPoint"]["x"], abs=1e-6)
    assert kitchen.step("GetObjectHitFromRaycast", origin=eye, destination=behind).metadata["actionReturn"] == FRIDGE
    wall = kitchen.step("PerformRaycast", origin={"x": 1.0, "y": 2.3, "z": 0.0}, destination={"x": 9, "y": 2.3, "z": 0})
    assert "a part of the building" in wall.metadata["errorMessage"]
    event = kitchen.step("PerformRaycast", origin=eye, destination={**eye, "x": -0.7})
    assert (
        "no object is hit from (-0.75, 1, 1.07) towards (-0.7, 1, 1.07), but a part" in event.metadata["errorMessage"]
    )
    near = kitchen.step("PerformRaycast", origin=eye, destination={**eye, "x": -0.8}).metadata["actionReturn"]
    assert near["objectId"] == FRIDGE  # the ray goes on
    assert near["hitPoint"]["x"] == pytest.approx(hit["hitPoint"]["x"])
    assert "the same point" in kitchen.step("PerformRaycast", origin=eye, destination=eye).metadata["errorMessage"]


def test_what_is_visible_is_named_nearest_first(kitchen) -> None:
    event = kitchen.step("TeleportFull", **BEFORE_FRIDGE, standing=True)
    eye = np.array([event.metadata["cameraPosition"][axis] for axis in "xyz"])

    def away(name: str) -> float:
        return float(np.linalg.norm(eye - [event.get_object(name)["position"][axis] for axis in "xyz"]))

    seen = kitchen.step("GetVisibleObjects", maxDistance=3.0).metadata["actionReturn"]
    assert len(seen) > 5
    assert [away(name) for name in seen] == sorted(map(away, seen))
    some = kitchen.step("GetVisibleObjects", maxDistance=3.0, objectIds=[seen[3], seen[1], "Mug|1"]).metadata[
        "actionReturn"
    ]
    assert some == [seen[1], seen[3]]
    camera = {"position": event.metadata["cameraPosition"], "rotation": {"x": 30, "y": 270, "z": 0}}
    kitchen.step("AddThirdPartyCamera", **camera)
    for action in ("GetVisibleObjects", "ObjectsVisibleFromThirdPartyCamera"):
        third = kitchen.step(action, maxDistance=3.0, thirdPartyCameraIndex=0).metadata["actionReturn"]
        assert third == seen
    assert not kitchen.step("GetVisibleObjects", thirdPartyCameraIndex=1)


def test_what_is_held_is_in_no_rays_way(kitchen) -> None:
    apple = "Apple|-00.47|+01.15|+00.48"
    place = kitchen.last_event.get_object(apple)["position"]
    ray = {"origin": {**place, "y": place["y"] + 0.5}, "destination": place}
    assert kitchen.step("PerformRaycast", **ray).metadata["actionReturn"]["objectId"] == apple
    kitchen.step("PickupObject", objectId=apple, forceAction=True)
    assert kitchen.step("PerformRaycast", **ray).metadata["actionReturn"]["objectId"].startswith("CounterTop")


@pytest.mark.slow
def test_points_of_an_object_are_on_its_surface_and_apart(kitchen) -> None:
    for object_id in ("Fridge|-02.10|+00.00|+01.07", "Fork|+00.95|+00.77|-02.37"):
        record = kitchen.last_event.get_object(object_id)
        points = kitchen.step("GetVisibilityPoints", objectId=object_id).metadata["actionReturn"]
        found = np.array([[p["x"], p["y"], p["z"]] for p in points])
        assert 4 <= len(found) <= 30
        corners = np.array(record["axisAlignedBoundingBox"]["cornerPoints"])
        assert (found >= corners.min(axis=0) - 0.005).all()
        assert (found <= corners.max(axis=0) + 0.005).all()
        apart = np.linalg.norm(found[:, None] - found[None], axis=2)[~np.eye(len(found), dtype=bool)]
        assert apart.min() > 0.005
        assert np.ptp(found, axis=0) == pytest.approx(np.ptp(corners, axis=0), abs=0.1)


def test_hulls_from_above_are_in_the_boxes_and_reach_their_sides(kitchen) -> None:
    event = kitchen.step("Get2DSemanticHulls")
    hulls = event.metadata["actionReturn"]
    assert set(hulls) == {o["objectId"] for o in event.metadata["objects"]}
    for object_id in (FRIDGE, "Apple|-00.47|+01.15|+00.48"):
        corners = np.array(event.get_object(object_id)["axisAlignedBoundingBox"]["cornerPoints"])[:, [0, 2]]
        hull = np.array(hulls[object_id])
        assert hull.shape[1] == 2
        assert len(hull) >= 4
        assert hull.min(axis=0) == pytest.approx(corners.min(axis=0), abs=0.01)
        assert hull.max(axis=0) == pytest.approx(corners.max(axis=0), abs=0.01)
        assert kitchen.step("Get2DSemanticHull", objectId=object_id).metadata["actionReturn"] == hulls[object_id]
    some = kitchen.step("Get2DSemanticHulls", objectTypes=["Drawer"]).metadata["actionReturn"]
    assert len(some) > 3
    assert all(name.startswith("Drawer|") for name in some)
    one = kitchen.step("Get2DSemanticHulls", objectIds=[FRIDGE]).metadata["actionReturn"]
    assert one == {FRIDGE: hulls[FRIDGE]}
    assert not kitchen.step("Get2DSemanticHulls", objectIds=[FRIDGE], objectTypes=["Fridge"])
    assert "Fridge|0" in kitchen.step("Get2DSemanticHulls", objectIds=["Fridge|0"]).metadata["errorMessage"]


def test_ids_of_a_type(kitchen) -> None:
    every = [o["objectId"] for o in kitchen.last_event.metadata["objects"] if o["objectType"] == "Drawer"]
    assert len(every) > 3
    assert kitchen.step("ObjectTypeToObjectIds", objectType="Drawer").metadata["actionReturn"] == every
    assert kitchen.step("ObjectTypeToObjectIds", objectType="Bathtub").metadata["actionReturn"] == []
    assert "Drawr" in kitchen.step("ObjectTypeToObjectIds", objectType="Drawr").metadata["errorMessage"]
