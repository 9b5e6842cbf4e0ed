"""The published figures, in PyBullet's hands, are the oracle: its URDF reader and its forward kinematics."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.geometry.rotations import rotation_of
from remqa_data.sim.arm import jaco
from remqa_data.sim.physics.bullet import BulletClient

# Joint origins as in Kinova's j2s6s200 URDF: xyz, then rpy.
PUBLISHED = (
    ("0 0 0.15675", "0 3.14159265359 0"),
    ("0 0.0016 -0.11875", "-1.57079632679 0 3.14159265359"),
    ("0 -0.410 0", "0 3.14159265359 0"),
    ("0 0.2073 -0.0114", "-1.57079632679 0 3.14159265359"),
    ("0 0 -0.10375", "1.57079632679 0 3.14159265359"),
    ("0 0.10375 0", "-1.57079632679 0 3.14159265359"),
    ("0 0 -0.1600", "3.14159265359 0 1.57079632679"),
)


@pytest.fixture(scope="module")
def published_arm(tmp_path_factory):
    body = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    links = "".join(f'<link name="l{i}">{body}</link>' for i in range(8))
    joints = "".join(
        f'<joint name="j{i}" type="{"continuous" if i < 6 else "fixed"}"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<axis xyz="0 0 1"/><origin xyz="{xyz}" rpy="{rpy}"/></joint>'
        for i, (xyz, rpy) in enumerate(PUBLISHED)
    )
    path = tmp_path_factory.mktemp("urdf") / "arm.urdf"
    path.write_text(f'<robot name="arm">{links}{joints}</robot>')
    client = BulletClient()
    yield client, client.loadURDF(str(path), useFixedBase=True)
    client.close()


angles = st.tuples(*(st.floats(low + 0.01, high - 0.01) for low, high in jaco.LIMITS.tolist()))


@given(angles)
def test_links_are_where_pybullet_puts_those_of_the_published_urdf(published_arm, joints) -> None:
    client, arm = published_arm
    for i, angle in enumerate(joints):
        client.resetJointState(arm, i, angle)
    poses = jaco.link_poses(np.array([joints]))[0]
    for i in range(7):
        state = client.getLinkState(arm, i, computeForwardKinematics=True)
        assert poses[i + 1, :3, 3] == pytest.approx(state[4], abs=1e-5)
        assert poses[i + 1, :3, :3] == pytest.approx(rotation_of(state[5]), abs=1e-5)


def test_the_stretched_arm_is_as_long_as_its_data_sheet_says() -> None:
    # 0.2755 m to the shoulder, 0.41 m upper arm, 0.2073 + 2 x 0.10375 m forearm and wrist, 0.16 m hand
    heights = jaco.link_poses(np.array([[0.0, math.pi, math.pi, 0.0, math.pi, 0.0]]))[0, :, 2, 3]
    assert heights == pytest.approx([0, 0.15675, 0.2755, 0.6855, 0.8928, 0.99655, 1.1003, 1.2603])


@pytest.mark.slow
@given(angles)
def test_every_posture_brings_the_hand_there_and_the_one_it_came_from_is_among_them(joints) -> None:
    hand = jaco.link_poses(np.array([joints]))[0, jaco.HAND]
    found = jaco.postures(hand[None, :3, 3], hand[None, :3, 2], joints[5])[0]
    found = found[np.isfinite(found).all(axis=1)]
    again = jaco.link_poses(found)[:, jaco.HAND]
    assert np.allclose(again[:, :3, 3], hand[:3, 3], atol=1e-6)
    assert np.allclose(again[:, :3, 2], hand[:3, 2], atol=1e-5)
    assert np.all((found >= jaco.LIMITS[:, 0]) & (found <= jaco.LIMITS[:, 1]))
    elbows = jaco.link_poses(np.vstack([found, joints]))[:, 3:6:2, :3, 3]  # elbow and wrist tell postures apart
    assert np.abs(elbows[:-1] - elbows[-1]).max(axis=(1, 2)).min() < 1e-5


@pytest.mark.slow
@given(angles)
def test_postures_at_a_pose_bring_the_hand_there_turned_as_it_is(joints) -> None:
    pose = jaco.link_poses(np.array([joints]))[0, jaco.HAND]
    found = jaco.postures_at(pose)
    found = found[np.isfinite(found).all(axis=1)]
    assert len(found)
    assert np.allclose(jaco.link_poses(found)[:, jaco.HAND], pose, atol=1e-5)


def test_there_is_no_posture_beyond_the_stretched_arm() -> None:
    # 0.41 + 0.31105 + 0.26375 m from the shoulder, less what the sideways offset of the wrist takes
    directions = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [-0.6, 0.0, 0.8]])
    shoulder = np.array([0.0, 0.0, jaco.SHOULDER_M])
    assert np.isnan(jaco.postures(shoulder + 0.986 * directions, directions)).all()
    assert np.isfinite(jaco.postures(shoulder + 0.98 * directions, directions)).all(axis=2).any(axis=1).all()
