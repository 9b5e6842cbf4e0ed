"""What MuJoCo makes of a room: the same joints, and bodies where our simulator has them."""

import numpy as np
import pytest

from remqa_data.export.links import joint_range, link_origins
from remqa_data.export.mjcf import KEYFRAME
from remqa_data.export.rooms import write_room
from remqa_data.sim.physics.world import World

pytestmark = pytest.mark.slow

mujoco = pytest.importorskip("mujoco")
KINDS = {"revolute": mujoco.mjtJoint.mjJNT_HINGE, "prismatic": mujoco.mjtJoint.mjJNT_SLIDE}


@pytest.fixture(scope="module")
def model(kitchen_files):
    return mujoco.MjModel.from_xml_path(str(kitchen_files / "room.xml"))


def joints(world: World) -> list[tuple[str, str]]:
    """Objects and their moving links."""
    return [(object_id, link.name) for object_id in world.ids for link in world.assets[object_id].links[1:]]


def at_rest(model):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(KEYFRAME).id)
    mujoco.mj_forward(model, data)
    return data


def place_of(model, name: str) -> int:
    return int(model.joint(name).qposadr[0])


def farthest_apart(data, world: World) -> float:
    """Metres, and elements of the rotations, between the bodies and our links."""
    apart = []
    for object_id in world.ids:
        asset = world.assets[object_id]
        for link, pose, origin in zip(asset.links, world.link_poses(object_id), link_origins(asset), strict=True):
            body = data.body(object_id if link.joint is None else f"{object_id}/{link.name}")
            apart.append(np.abs(body.xpos - (pose @ [*origin, 1.0])[:3]).max())
            apart.append(np.abs(body.xmat.reshape(3, 3) - pose[:3, :3]).max())
    return max(apart)


def test_joints_have_our_types_axes_and_ranges(model, world) -> None:
    assert len(joints(world)) > 20
    for object_id in world.ids:
        for link in world.assets[object_id].links[1:]:
            joint = model.joint(f"{object_id}/{link.name}")
            assert joint.type[0] == KINDS[link.joint.kind]
            assert joint.axis == pytest.approx(link.joint.axis)
            assert tuple(joint.range) == pytest.approx(joint_range(link.joint, world.most_open(object_id)))
    assert model.njnt == len(joints(world)) + sum(not thing.is_fixed for thing in world.scene.objects)


@pytest.mark.parametrize("openness", [0.0, 0.37, 1.0])
def test_a_moved_joint_moves_the_body_to_where_our_simulator_puts_it(model, world, openness) -> None:
    data = at_rest(model)
    start = world.save()
    for object_id, link in joints(world):
        world.open(object_id, openness)
        joint = next(part.joint for part in world.assets[object_id].links if part.name == link)
        data.qpos[place_of(model, f"{object_id}/{link}")] = joint.upper * world.state(object_id).openness
    for thing in world.scene.objects:  # the forks that went with the drawer
        if not thing.is_fixed:
            state, address = world.state(thing.id), place_of(model, thing.id)
            x, y, z, w = state.quaternion
            data.qpos[address : address + 7] = [*state.position, w, x, y, z]
    mujoco.mj_forward(model, data)
    assert farthest_apart(data, world) < 0.001
    world.restore(start)
    assert openness == 0.0 or farthest_apart(data, world) > 0.1


def test_a_room_with_open_doors_has_them_open_in_its_keyframe(kitchen, world, tmp_path) -> None:
    write_room(kitchen, tmp_path / "open.xml", opened=["all"])
    for object_id, _ in joints(world):
        world.open(object_id)
    assert farthest_apart(at_rest(mujoco.MjModel.from_xml_path(str(tmp_path / "open.xml"))), world) < 0.001


def test_what_lies_at_rest_stays_there_and_a_door_stays_as_it_is_left(model, world) -> None:
    data = at_rest(model)
    before = {thing.id: data.body(thing.id).xpos.copy() for thing in world.scene.objects}
    half = {}
    for object_id, link in joints(world):
        if world.state(object_id).is_fixed:
            name = f"{object_id}/{link}"
            half[name] = sum(model.joint(name).range) / 2
            data.qpos[place_of(model, name)] = half[name]
    assert len(half) > 20
    inside = {rider for object_id, _ in joints(world) for rider in world.contents(object_id)}
    for _ in range(round(0.5 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    for object_id, position in before.items():
        if object_id not in inside:  # a drawer went away below those
            assert np.linalg.norm(data.body(object_id).xpos - position) < 0.005, object_id
    for name, position in half.items():
        assert data.qpos[place_of(model, name)] == pytest.approx(position, abs=0.02), name


def test_free_things_weigh_what_the_catalog_says(model, world) -> None:
    from remqa_data.catalog import object_type

    assert not all(thing.is_fixed for thing in world.scene.objects)
    for thing in world.scene.objects:
        if not thing.is_fixed:
            assert model.body_subtreemass[model.body(thing.id).id] == pytest.approx(object_type(thing.type).mass_kg)
