"""What PyBullet makes of a room's URDF."""

import numpy as np
import pytest

from remqa_data.export.links import inertias, joint_range, link_origins
from remqa_data.export.numbers import roll_pitch_yaw
from remqa_data.geometry.rotations import quaternion_of
from remqa_data.sim.physics.bullet import BulletClient, pybullet

pytestmark = pytest.mark.slow

KINDS = {"revolute": pybullet.JOINT_REVOLUTE, "prismatic": pybullet.JOINT_PRISMATIC}


@pytest.fixture(scope="module")
def bullet(kitchen_files):
    client = BulletClient()
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    body = client.loadURDF(str(kitchen_files / "room.urdf"), useFixedBase=True, flags=flags)
    infos = [client.getJointInfo(body, number) for number in range(client.getNumJoints(body))]
    yield client, body, {info[12].decode(): info for info in infos}
    client.close()


def test_joints_have_our_types_ranges_and_masses(bullet, world) -> None:
    client, body, infos = bullet
    assert set(infos) == {
        object_id if link.joint is None else f"{object_id}/{link.name}"
        for object_id in world.ids
        for link in world.assets[object_id].links
    }
    for object_id in world.ids:
        asset = world.assets[object_id]
        for link, inertia in list(zip(asset.links, inertias(asset), strict=True))[1:]:
            info = infos[f"{object_id}/{link.name}"]
            assert info[2] == KINDS[link.joint.kind]
            assert (info[8], info[9]) == pytest.approx(joint_range(link.joint, world.most_open(object_id)))
            assert client.getDynamicsInfo(body, info[0])[0] == pytest.approx(inertia.mass_kg)


@pytest.mark.parametrize("openness", [0.0, 0.37, 1.0])
def test_a_moved_joint_moves_the_link_to_where_our_simulator_puts_it(bullet, world, openness) -> None:
    client, body, infos = bullet
    checked, start = 0, world.save()
    for object_id in world.ids:
        asset = world.assets[object_id]
        if asset.is_openable:
            world.open(object_id, openness)
        for link in asset.links[1:]:
            position = link.joint.upper * world.state(object_id).openness
            client.resetJointState(body, infos[f"{object_id}/{link.name}"][0], position)
        for link, pose, origin in list(zip(asset.links, world.link_poses(object_id), link_origins(asset), strict=True))[
            1:
        ]:
            state = client.getLinkState(body, infos[f"{object_id}/{link.name}"][0], computeForwardKinematics=True)
            turn = np.array(client.getMatrixFromQuaternion(state[5])).reshape(3, 3)
            assert state[4] == pytest.approx((pose @ [*origin, 1.0])[:3], abs=0.001)
            assert turn == pytest.approx(pose[:3, :3], abs=1e-5)
            checked += 1
        world.restore(start)
    assert checked > 20


def test_closed_things_are_where_they_stand(bullet, world) -> None:
    client, body, infos = bullet
    for object_id in world.ids:
        for link in world.assets[object_id].links[1:]:
            client.resetJointState(body, infos[f"{object_id}/{link.name}"][0], 0.0)
    assert world.ids
    for object_id in world.ids:
        state, ours = (
            client.getLinkState(body, infos[object_id][0], computeForwardKinematics=True),
            world.state(object_id),
        )
        assert state[4] == pytest.approx(ours.position, abs=0.001)
        assert abs(np.dot(state[5], ours.quaternion)) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("rpy", [(0.3, -0.4, 2.0), (0.0, 0.0, -3.0), (0.7, np.pi / 2, 0.0), (-0.2, -np.pi / 2, 0.0)])
def test_angles_are_those_that_pybullet_turns_by(rpy) -> None:
    rotation = np.array(pybullet.getMatrixFromQuaternion(pybullet.getQuaternionFromEuler(rpy))).reshape(3, 3)
    again = pybullet.getQuaternionFromEuler(roll_pitch_yaw(rotation))
    assert abs(np.dot(again, quaternion_of(rotation))) == pytest.approx(1.0, abs=1e-9)
