import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.geometry.rotations import quaternion_of, rotation_of
from remqa_data.thor.state.frames import (
    corners_to_thor,
    euler_to_thor,
    to_room,
    to_thor,
    turn_to_thor,
    whole,
    yaw_to_room,
    yaw_to_thor,
)

ANGLES = st.floats(-720, 720)
# Away from straight up and down, where only the sum of two angles is defined.
TILTS = st.one_of(st.floats(-85, 85), st.floats(275, 355))
METRES = st.floats(-100, 100)


def quaternion_to_room(rotation):
    """The pose of an asset (front -y, up z) that Unity turns about z, then x, then y; in AI2-THOR's frame it looks along
    +z, with its right side at -x."""
    x, y, z = (math.radians(rotation[axis]) for axis in "xyz")
    turn_x = np.array([[1, 0, 0], [0, math.cos(x), -math.sin(x)], [0, math.sin(x), math.cos(x)]])
    turn_y = np.array([[math.cos(y), 0, math.sin(y)], [0, 1, 0], [-math.sin(y), 0, math.cos(y)]])
    turn_z = np.array([[math.cos(z), -math.sin(z), 0], [math.sin(z), math.cos(z), 0], [0, 0, 1]])
    to_thor_axes = np.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]])
    swap = np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0]])
    return quaternion_of(swap @ turn_y @ turn_x @ turn_z @ to_thor_axes)


def test_axes_swap() -> None:
    assert to_thor((1, 2, 3)) == {"x": 1.0, "y": 3.0, "z": 2.0}
    assert corners_to_thor([[1, 2, 3]]) == [[1.0, 3.0, 2.0]]


@given(METRES, METRES, METRES)
def test_points_come_back(x: float, y: float, z: float) -> None:
    assert to_room(to_thor((x, y, z))) == (x, y, z)


@pytest.mark.parametrize(
    ("rotation_y", "step"),
    # AI2-THOR: 0 looks along +z, 90 along +x, clockwise from above. A step ahead in the room's x, y, which are its x, z.
    [(0, (0, 1)), (90, (1, 0)), (180, (0, -1)), (270, (-1, 0))],
)
def test_headings(rotation_y: float, step: tuple[int, int]) -> None:
    yaw = math.radians(yaw_to_room(rotation_y))
    assert (round(math.cos(yaw)), round(math.sin(yaw))) == step
    assert yaw_to_thor(yaw_to_room(rotation_y)) == rotation_y


@given(ANGLES)
def test_yaw_comes_back(rotation_y: float) -> None:
    gap = (yaw_to_thor(yaw_to_room(rotation_y)) - rotation_y + 180) % 360 - 180
    assert abs(gap) < 1e-9


@given(TILTS, ANGLES, ANGLES)
def test_rotations_come_back(x: float, y: float, z: float) -> None:
    rotation = whole({"x": x, "y": y, "z": z})
    quaternion = quaternion_to_room(rotation)
    again = quaternion_to_room(euler_to_thor(turn_to_thor(quaternion)))
    np.testing.assert_allclose(rotation_of(again), rotation_of(quaternion), atol=1e-6)


def test_an_object_faces_where_its_rotation_says() -> None:
    front = np.array([0.0, -1.0, 0.0])  # of every asset
    faces = rotation_of(quaternion_to_room({"x": 0.0, "y": 90.0, "z": 0.0})) @ front
    np.testing.assert_allclose(faces, [1, 0, 0], atol=1e-12)
    assert euler_to_thor(turn_to_thor(quaternion_of(np.eye(3))))["y"] == 180.0


def test_tilted_about_unitys_x_looks_down() -> None:
    front = rotation_of(quaternion_to_room({"x": 30.0, "y": 0.0, "z": 0.0})) @ [0.0, -1.0, 0.0]
    np.testing.assert_allclose(front, [0, math.cos(math.radians(30)), -0.5], atol=1e-12)


def test_upright_is_looking_up() -> None:
    assert euler_to_thor(turn_to_thor(quaternion_to_room({"x": 270.0, "y": 40.0, "z": 0.0}))) == {
        "x": 270.0,
        "y": 40.0,
        "z": 0.0,
    }
