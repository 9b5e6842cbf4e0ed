import json
import struct

import cv2
import numpy as np
import pytest
import trimesh

from remqa_data.assets.looks.textures import texture
from remqa_data.export.glb import Y_UP, glb_bytes, room_scene
from remqa_data.export.links import link_origins
from remqa_data.sim.physics.world import World
from tests.helpers.bare_rooms import first_of

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def opened(kitchen):
    with World(kitchen) as world:
        for object_id in world.ids:
            if world.assets[object_id].is_openable:
                world.open(object_id)
        yield world


@pytest.fixture(scope="module")
def read_back(opened, tmp_path_factory) -> trimesh.Scene:
    path = tmp_path_factory.mktemp("glb") / "open.glb"
    path.write_bytes(glb_bytes(room_scene(opened)))
    return trimesh.load(path)


def header(path) -> tuple[dict, bytes]:
    """The JSON of a .glb and its binary part, by the standard: 12 bytes, then chunks of length, kind and data."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def test_every_link_is_where_the_opened_world_has_it(opened, read_back) -> None:
    moved = 0
    for object_id in opened.ids:
        asset = opened.assets[object_id]
        for link, pose, origin in zip(asset.links, opened.link_poses(object_id), link_origins(asset), strict=True):
            frame, _ = read_back.graph[f"{object_id}/{link.name}"]
            frame = np.linalg.inv(Y_UP) @ frame
            assert frame[:3, :3] == pytest.approx(pose[:3, :3], abs=1e-6)
            assert frame[:3, 3] == pytest.approx((pose @ [*origin, 1.0])[:3], abs=1e-6)
            for number, surface in enumerate(link.surfaces):
                place, name = read_back.graph[f"{object_id}/{link.name}/{number}"]
                corners = trimesh.transform_points(read_back.geometry[name].bounds, np.eye(4)) + origin
                assert corners == pytest.approx(np.array([surface.vertices.min(0), surface.vertices.max(0)]), abs=1e-5)
                assert place == pytest.approx(read_back.graph[f"{object_id}/{link.name}"][0])
            moved += link.joint is not None
    assert moved > 20


@pytest.mark.slow
def test_the_room_is_as_large_as_its_building_and_stands_on_its_floor(kitchen, kitchen_files) -> None:
    low, high = trimesh.load(kitchen_files / "room.glb").bounds
    boxes = np.array([part.box for part in kitchen.structure])
    assert (low[0], -high[2]) == pytest.approx(boxes[:, :2].min(axis=0), abs=1e-4)  # x, and y as -z
    assert (high[0], -low[2]) == pytest.approx(boxes[:, 3:5].max(axis=0), abs=1e-4)
    assert high[1] == pytest.approx(boxes[:, 5].max(), abs=1e-4)


def test_joints_are_told_to_viewers(kitchen, kitchen_files) -> None:
    nodes = {node["name"]: node.get("extras", {}) for node in header(kitchen_files / "room.glb")[0]["nodes"]}
    with World(kitchen) as world:
        joints = {
            f"{object_id}/{link.name}": link.joint
            for object_id in world.ids
            for link in world.assets[object_id].links[1:]
        }
    assert {name for name, extras in nodes.items() if "joint" in extras} == set(joints)
    assert joints
    for name, joint in joints.items():
        assert (nodes[name]["joint"], nodes[name]["position"]) == (joint.kind, 0.0)
        assert nodes[name]["axis"] == pytest.approx(joint.axis)
    assert {nodes[thing.id]["type"] for thing in kitchen.objects} == {thing.type for thing in kitchen.objects}


def test_textures_are_there_pixel_for_pixel_and_upright(kitchen_files) -> None:
    tree, binary = header(kitchen_files / "room.glb")
    pictures = []
    for image in tree["images"]:
        view = tree["bufferViews"][image["bufferView"]]
        data = binary[view.get("byteOffset", 0) :][: view["byteLength"]]
        pictures.append(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR_RGB))
    wood = texture("wood")  # its first row is the top, as glTF's
    assert any(np.array_equal(picture, wood) for picture in pictures)
    with_texture = [mat for mat in tree["materials"] if "baseColorTexture" in mat["pbrMetallicRoughness"]]
    assert len(with_texture) > 10
    assert any(np.any(mat["emissiveFactor"]) for mat in tree["materials"] if "emissiveFactor" in mat)


def test_texture_coordinates_are_those_of_the_assets(kitchen, kitchen_files) -> None:
    scene = trimesh.load(kitchen_files / "room.glb")
    with World(kitchen) as world:
        window = first_of(world, "Window")
        surfaces = world.assets[window].links[0].surfaces
        assert any(surface.material.texture is not None for surface in surfaces)
        for number, surface in enumerate(surfaces):
            mesh = scene.geometry[scene.graph[f"{window}/base/{number}"][1]]
            if surface.material.texture is not None:
                uv = mesh.visual.uv * [1, -1] + [0, 1]  # trimesh counts v from below
                assert uv == pytest.approx(surface.uv, abs=1e-5)


def test_the_same_room_gives_the_same_bytes(kitchen, kitchen_files) -> None:
    with World(kitchen) as world:
        assert glb_bytes(room_scene(world)) == (kitchen_files / "room.glb").read_bytes()
