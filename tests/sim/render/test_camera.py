"""Expected values are worked out by hand from the conventions in remqa_data.sim.render.camera."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.geometry.arithmetic import arctan2
from remqa_data.sim.render.camera import Camera, OrthographicCamera, TopDownCamera, Windows
from remqa_data.thor.state.frames import turn_of_euler


def test_point_straight_ahead_is_in_the_middle_at_its_distance():
    camera = Camera((1.0, 2.0, 1.5), yaw_deg=90)
    np.testing.assert_allclose(camera.project([(1.0, 5.0, 1.5)]), [(150, 150, 3)], atol=1e-9)


def test_right_of_the_camera_is_right_in_the_image_and_up_is_up():
    camera = Camera((0.0, 0.0, 0.0), yaw_deg=0)
    # Looking along +x, right is -y. 90 degrees over 300 pixels: one metre at two metres' depth is 75 pixels.
    np.testing.assert_allclose(camera.project([(2.0, -1.0, 0.5)]), [(225, 112.5, 2)], atol=1e-9)


def test_positive_horizon_looks_down():
    camera = Camera((0.0, 0.0, 1.0), yaw_deg=0, horizon_deg=45)
    np.testing.assert_allclose(camera.project([(1.0, 0.0, 0.0)]), [(150, 150, np.sqrt(2))], atol=1e-9)


def test_field_of_view_is_vertical():
    camera = Camera((0.0, 0.0, 0.0), yaw_deg=0, fov_deg=60, width=400, height=200)
    top = camera.project([(1.0, 0.0, np.tan(np.radians(30)))])
    np.testing.assert_allclose(top, [(200, 0, 1)], atol=1e-9)


@pytest.mark.parametrize("yaw", [0, 37, 180, 271])
@pytest.mark.parametrize("horizon", [-30, 0, 60])
def test_axes_are_a_right_handed_frame(yaw, horizon):
    right, up, forward = Camera((0, 0, 0), yaw, horizon).rotation()
    np.testing.assert_allclose(np.cross(right, forward), up, atol=1e-12)
    assert right[2] == 0.0


def test_look_at_puts_the_target_in_the_middle():
    camera = Camera.look_at((1.0, 1.0, 1.6), (3.0, 0.2, 0.4), width=320, height=240)
    x, y, depth = camera.project([(3.0, 0.2, 0.4)])[0]
    assert (x, y) == pytest.approx((160, 120))
    assert depth == pytest.approx(np.linalg.norm([2.0, -0.8, -1.2]))


@pytest.mark.slow
@given(
    st.lists(st.tuples(*[st.floats(-8, 8)] * 6, st.integers(1, 150)), min_size=1, max_size=30),
    st.sampled_from([150.0, 231.7]),
)
def test_windows_are_cameras_that_look_at_their_targets_to_the_last_bit(looks, focal_px):
    looks = [(*(value + 0.0 for value in look[:6]), look[6]) for look in looks]  # of -0.0 the sign is not kept
    points = np.array([look[:6] for look in looks])
    side = np.array([2 * look[6] for look in looks])
    windows = Windows.looking_at(points[:, :3], points[:, 3:], side, focal_px)
    assert len(windows.side) == len(looks)
    for i, (*eye, tx, ty, tz, half_px) in enumerate(looks):
        fov_deg = 2 * math.degrees(arctan2(half_px, focal_px))
        camera = Camera.look_at(tuple(eye), (tx, ty, tz), fov_deg=fov_deg, width=2 * half_px, height=2 * half_px)
        for one, other in zip(windows[:3], camera.view()[:3], strict=True):
            assert one[i].tobytes() == other.tobytes()


def test_views_of_windows_lie_in_memory_as_those_of_cameras_do():
    """Else the rasteriser would be compiled once more."""
    eyes = np.zeros((3, 3))
    windows = Windows.looking_at(eyes, np.ones((3, 3)) * 0.4, np.array([10, 20, 30]), 150.0)
    view = Camera((0.0, 0.0, 0.0), 0, 0, 90, width=10, height=10).view()
    assert windows.axes.flags.c_contiguous
    assert windows.inverse.flags.c_contiguous
    assert view.axes.flags.c_contiguous
    assert view.inverse.flags.c_contiguous


@pytest.mark.parametrize(
    "camera",
    [
        Camera((0.3, -1.0, 1.5), 210, 30, 75, width=64, height=48),
        Camera((0.3, -1.0, 1.5), 210, 30, 75, width=64, height=48, roll_deg=-50),
        TopDownCamera((1.0, 2.0), 2.5, 4.0, width=64, height=48),
        OrthographicCamera((1.0, 2.0, 0.5), 1.5, 30, 20, 70, width=64, height=48),
    ],
    ids=["pinhole", "rolled", "map", "orthographic"],
)
def test_unproject_undoes_project(camera):
    depth = np.random.default_rng(0).uniform(0.5, 4.0, (48, 64))
    pixels = camera.project(camera.unproject(depth).reshape(-1, 3)).reshape(48, 64, 3)
    np.testing.assert_allclose(pixels[..., 0], np.tile(np.arange(64) + 0.5, (48, 1)), atol=1e-9)
    np.testing.assert_allclose(pixels[..., 1], np.tile(np.arange(48) + 0.5, (64, 1)).T, atol=1e-9)
    np.testing.assert_allclose(pixels[..., 2], depth, atol=1e-9)


def test_map_has_x_to_the_right_and_y_up():
    camera = TopDownCamera((2.0, 1.0), height_m=2.4, extent_m=6.0)
    # 300 pixels over 6 metres: 50 pixels a metre.
    np.testing.assert_allclose(camera.project([(3.0, 2.0, 0.4)]), [(200, 100, 2.0)], atol=1e-9)


def test_a_roll_turns_the_picture_the_other_way():
    camera = Camera((0.0, 0.0, 0.0), yaw_deg=0, roll_deg=90)
    # Its right is up now: what is above is at the right side, and what is to the right is below.
    np.testing.assert_allclose(camera.project([(2.0, 0.0, 1.0), (2.0, -1.0, 0.0)]), [(225, 150, 2), (150, 225, 2)])


def test_an_orthographic_camera_from_above_is_the_map():
    camera = OrthographicCamera((2.0, 1.0, 2.4), half_height_m=3.0)
    np.testing.assert_allclose(camera.project([(3.0, 2.0, 0.4)]), [(200, 100, 2.0)], atol=1e-9)


@given(*[st.floats(-400, 400)] * 3)
def test_rotations_are_unitys(x, y, z):
    """AI2-THOR's columns are right, up and ahead; its y and z are our z and y, and its 0 degrees look along our +y."""
    right, up, ahead = turn_of_euler({"x": x, "y": y, "z": z}).T[:, [0, 2, 1]]
    for camera in (Camera((0, 0, 0), 90 - y, x, roll_deg=z), OrthographicCamera((0, 0, 0), 1.0, 90 - y, x, z)):
        np.testing.assert_allclose(camera.rotation(), [right, up, ahead], atol=1e-9)


@pytest.mark.parametrize(
    "camera",
    [
        *(Camera((0.0, 0.0, 1.5), 0.0, fov_deg=fov) for fov in (0.0, 180.0, 200.0, math.nan)),
        Camera((0.0, 0.0, 1.5), math.nan),
        Camera((math.inf, 0.0, 1.5), 0.0),
        Camera((0.0, 0.0, 1.5), 0.0, width=0),
        *(TopDownCamera((0.0, 0.0), 2.0, extent_m) for extent_m in (math.inf, 0.0, -4.0)),
        *(OrthographicCamera((0.0, 0.0, 2.0), half_m) for half_m in (math.nan, 0.0, -1.0)),
    ],
)
def test_a_camera_that_cannot_be_is_refused(camera):
    with pytest.raises(ValueError, match=r"no camera|fov_deg is"):
        camera.view()


def test_a_position_may_be_an_array():
    at = np.array([1.0, 2.0, 1.5])
    assert Camera(at, 90) == Camera((1.0, 2.0, 1.5), 90)  # type: ignore[arg-type]
    assert Camera(at, 90).view() is Camera((1.0, 2.0, 1.5), 90).view()  # type: ignore[arg-type]
