"""What USD's own library makes of a room: the same joints, and prims where our simulator has their links."""

import math

import numpy as np
import pytest

from remqa_data.export.links import joint_range, link_origins
from remqa_data.export.rooms import write_room
from remqa_data.sim.physics.world import World
from tests.helpers.small_rooms import small_room

pytest.importorskip("pxr")
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdValidation

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def stage(kitchen_files):
    return Usd.Stage.Open(str(kitchen_files / "room.usda"))


def named(stage) -> dict[str, Usd.Prim]:
    """Links and their joints by what they are called."""
    return {
        (prim.GetDisplayName(), prim.IsA(UsdPhysics.Joint)): prim
        for prim in stage.Traverse()
        if prim.GetPath().HasPrefix("/Room/Objects") and len(prim.GetPath().GetPrefixes()) == 4
    }


def pose_of(prim) -> np.ndarray:
    return np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())).T


def farthest_apart(stage, world: World) -> float:
    """Metres, and elements of the rotations, between the prims and our links."""
    links, apart = named(stage), []
    for object_id in world.ids:
        asset = world.assets[object_id]
        for link, pose, origin in zip(asset.links, world.link_poses(object_id), link_origins(asset), strict=True):
            found = pose_of(links[object_id if link.joint is None else f"{object_id}/{link.name}", False])
            apart.append(np.abs(found[:3, 3] - (pose @ [*origin, 1.0])[:3]).max())
            apart.append(np.abs(found[:3, :3] - pose[:3, :3]).max())
    return max(apart)


@pytest.mark.slow
def test_links_are_where_they_are_closed_and_open(stage, kitchen, world, tmp_path) -> None:
    assert farthest_apart(stage, world) < 1e-5
    write_room(kitchen, tmp_path / "open.usd", opened=["all"])
    opened = Usd.Stage.Open(str(tmp_path / "open.usd"))
    assert farthest_apart(opened, world) > 0.3
    for object_id in world.ids:
        if world.assets[object_id].is_openable:
            world.open(object_id)
    assert farthest_apart(opened, world) < 1e-5


def test_joints_have_our_types_axes_and_ranges(stage, world) -> None:
    found, checked = named(stage), 0
    for object_id in world.ids:
        for link in world.assets[object_id].links[1:]:
            prim = found[f"{object_id}/{link.name}", True]
            is_hinge = link.joint.kind == "revolute"
            joint = (UsdPhysics.RevoluteJoint if is_hinge else UsdPhysics.PrismaticJoint)(prim)
            assert joint
            low, high = joint_range(link.joint, world.most_open(object_id))
            scale = 180 / math.pi if is_hinge else 1.0
            limits = joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()
            assert limits == pytest.approx((low * scale, high * scale), abs=1e-4)
            axis = Gf.Rotation(Gf.Quatd(joint.GetLocalRot0Attr().Get())).TransformDir(Gf.Vec3d(1, 0, 0))
            assert tuple(axis) == pytest.approx(link.joint.axis, abs=1e-6)
            checked += 1
    assert checked > 20


def test_both_sides_of_a_joint_agree_on_where_it_is(stage) -> None:
    checked = 0
    for (_, is_joint), prim in named(stage).items():
        if is_joint:
            joint = UsdPhysics.Joint(prim)
            (one,), (other,) = joint.GetBody0Rel().GetTargets(), joint.GetBody1Rel().GetTargets()
            at = [
                (pose_of(stage.GetPrimAtPath(path)) @ [*place.Get(), 1.0])[:3]
                for path, place in ((one, joint.GetLocalPos0Attr()), (other, joint.GetLocalPos1Attr()))
            ]
            assert np.allclose(*at, atol=1e-4)
            checked += 1
    assert checked > 20


def test_what_is_seen_fills_the_room_with_textures_that_are_there(stage, kitchen_files, world) -> None:
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    seen = cache.ComputeWorldBound(stage.GetPrimAtPath("/Room/Building")).ComputeAlignedRange()
    low, high = np.array(seen.GetMin()), np.array(seen.GetMax())
    assert (high - low > [2.0, 2.0, 2.0]).all()
    for thing in world.scene.objects[:10]:
        assert (np.array(thing.position) >= low - 0.1).all()
        assert (np.array(thing.position) <= high + 0.1).all()
    files = [
        UsdShade.Shader(prim).GetInput("file").Get()
        for prim in stage.Traverse()
        if prim.IsA(UsdShade.Shader) and UsdShade.Shader(prim).GetInput("file")
    ]
    assert len(files) > 5
    assert all((kitchen_files / file.path).is_file() for file in files)
    meshes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert len(meshes) > 200
    assert all(UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0] for prim in meshes)


def test_free_things_weigh_what_the_catalog_says(stage, world) -> None:
    from remqa_data.catalog import object_type

    found, checked = named(stage), 0
    for thing in world.scene.objects:
        prim = found[thing.id, False]
        assert prim.HasAPI(UsdPhysics.RigidBodyAPI) is not world.state(thing.id).is_fixed
        if not world.state(thing.id).is_fixed and len(world.assets[thing.id].links) == 1:
            mass = UsdPhysics.MassAPI(prim).GetMassAttr().Get()
            assert mass == pytest.approx(object_type(thing.type).mass_kg, rel=1e-5)
            checked += 1
    assert checked > 10


def test_usd_finds_nothing_wrong_with_it(stage) -> None:
    registry = UsdValidation.ValidationRegistry()
    validators = registry.GetOrLoadAllValidators()
    assert len(validators) > 10
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    said = {f"{error.GetName()}: {error.GetMessage()}" for error in errors}
    assert sorted(said)[:5] == []


def test_leaves_are_two_sided_and_what_is_solid_is_not(stage, world) -> None:
    sides = {
        (named_by.GetDisplayName(), UsdGeom.Mesh(prim).GetDoubleSidedAttr().Get())
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Mesh) and (named_by := prim.GetParent())
    }
    plants = [object_id for object_id in world.ids if world.type_of(object_id) == "HousePlant"]
    assert plants
    assert all((plant, True) in sides for plant in plants)
    assert ("Building", False) in {(name or "Building", is_two_sided) for name, is_two_sided in sides}


@pytest.mark.parametrize(
    ("name", "starts"), [("room.txt", b"PXR-USDC"), ("room.USDA", b"#usda"), ("r.USDC", b"PXR-USDC")]
)
def test_usd_can_be_called_anything_and_is_binary_then(tmp_path, name, starts) -> None:
    path = tmp_path / name
    write_room(small_room("Small1", 0), path, "usd")
    assert path.read_bytes().startswith(starts)
    renamed = path.rename(tmp_path / "renamed.usd")
    assert Usd.Stage.Open(str(renamed)).GetPrimAtPath("/Room/Objects")
