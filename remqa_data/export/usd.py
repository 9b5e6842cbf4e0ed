"""A room as USD, with the joints, masses and collision shapes of UsdPhysics: for Omniverse, Isaac Sim, Houdini and Blender.

Names of prims hold no `|` and `/`, so objects are named as far as they can be; `displayName` has the id.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from remqa_data.assets.core.model import CollisionBox, Material, Surface
from remqa_data.export.links import Inertia
from remqa_data.export.looks import upward_uv
from remqa_data.export.model import ModelLink, ModelObject, RoomModel, Visual
from remqa_data.extras import require
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64

Gf, Sdf, Tf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade = (
    require(f"pxr.{name}", "usd") for name in ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdLux", "UsdPhysics", "UsdShade")
)

ROOM = "/Room"
LAMP_M, LAMP_INTENSITY = 0.05, 4000.0
"""Radius and brightness of a lamp."""


def write_usd(room: RoomModel, path: Path, suffix: str) -> None:
    """Write a room as the kind of USD that a suffix tells: .usda is text, .usd and .usdc are binary.

    Raises
    ------
    MissingExtraError
        If the extra `usd` is not installed.
    """
    with TemporaryDirectory(dir=path.parent) as folder:
        made = Path(folder) / f"room{suffix}"  # USD goes by the suffix
        usd_stage(room).Export(str(made))
        made.replace(path)


def usd_stage(room: RoomModel) -> Any:
    """The stage: /Room/Building, /Room/Objects, /Room/Looks, and each mesh once under /Meshes."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, ROOM).GetPrim()
    root.SetDisplayName(room.name)
    Usd.ModelAPI(root).SetKind("assembly")
    stage.SetDefaultPrim(root)
    UsdPhysics.Scene.Define(stage, f"{ROOM}/Physics")
    looks = {
        name: _material(stage, f"{ROOM}/Looks/{_word(name)}", m, room.meshes) for name, m in room.materials.items()
    }
    # Defined in no place of their own: they are seen where they are referred to.
    stage.CreateClassPrim("/Meshes")
    for name, surface in room.surfaces.items():
        _mesh(stage, f"/Meshes/{_word(name)}", surface, name in room.two_sided)
    for number, place in enumerate(room.lights):
        lamp = UsdLux.SphereLight.Define(stage, f"{ROOM}/Lights/Lamp{number}")
        lamp.CreateRadiusAttr(LAMP_M)
        lamp.CreateIntensityAttr(LAMP_INTENSITY)
        lamp.AddTranslateOp().Set(Gf.Vec3d(*place))
    building = UsdGeom.Xform.Define(stage, f"{ROOM}/Building").GetPrim()
    _parts(stage, building, room.visuals, room.boxes, looks)
    UsdGeom.Scope.Define(stage, f"{ROOM}/Objects")
    for name, thing in zip(_words(thing.id for thing in room.objects), room.objects, strict=True):
        _object(stage, f"{ROOM}/Objects/{name}", thing, looks)
    return stage


def _object(stage: Any, path: str, thing: ModelObject, looks: dict[str, Any]) -> None:
    """An object; links lie beside each other, as bodies of UsdPhysics must not be inside each other."""
    whole = UsdGeom.Xform.Define(stage, path)
    whole.GetPrim().SetDisplayName(thing.id)
    Usd.ModelAPI(whole.GetPrim()).SetKind("component")
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation_of(thing.quaternion), thing.position
    _place(whole, pose)
    poses: list[F64] = []
    prims: list[Any] = []
    for name, link in zip(_words(link.name.rpartition("/")[2] for link in thing.links), thing.links, strict=True):
        above = np.eye(4) if link.joint is None else poses[link.parent]
        poses.append(above @ _pose_in_parent(link))
        made = UsdGeom.Xform.Define(stage, f"{path}/{'Base' if link.joint is None else name}")
        made.GetPrim().SetDisplayName(link.name)
        _place(made, poses[-1])
        prims.append(made.GetPrim())
        _parts(stage, prims[-1], link.visuals, link.boxes, looks)
        if thing.is_free or link.joint is not None:
            _body(prims[-1], link.inertia)
        if link.joint is not None:
            _joint(stage, f"{path}/{name}Joint", prims[link.parent], prims[-1], link)


def _pose_in_parent(link: ModelLink) -> F64:
    """(4, 4) of a link's frame where its joint stands, in its parent's; of the base, in the object's."""
    pose = np.eye(4)
    pose[:3, 3] = link.origin
    if link.joint is None:
        return pose
    axis, position = np.asarray(link.joint.joint.axis, dtype=np.float64), link.joint.position
    if link.joint.joint.kind == "prismatic":
        pose[:3, 3] += axis * position
        return pose
    turn = Gf.Matrix3d(Gf.Rotation(Gf.Vec3d(*axis.tolist()), float(np.degrees(position))))
    pose[:3, :3] = np.array(turn).T  # USD's matrices act on rows
    return pose


def _body(prim: Any, inertia: Inertia) -> None:
    UsdPhysics.RigidBodyAPI.Apply(prim)
    mass = UsdPhysics.MassAPI.Apply(prim)
    moments, axes = np.linalg.eigh(inertia.about_centre)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    mass.CreateMassAttr(inertia.mass_kg)
    mass.CreateCenterOfMassAttr(Gf.Vec3f(*inertia.centre.tolist()))
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*moments.tolist()))
    mass.CreatePrincipalAxesAttr(Gf.Quatf(Gf.Matrix3d(*axes.T.ravel().tolist()).ExtractRotation().GetQuat()))


def _joint(stage: Any, path: str, parent: Any, child: Any, link: ModelLink) -> None:
    """A joint about or along the x axis of frames that are turned so that this is the link's axis."""
    joint = link.joint
    assert joint is not None
    is_hinge = joint.joint.kind == "revolute"
    made = (UsdPhysics.RevoluteJoint if is_hinge else UsdPhysics.PrismaticJoint).Define(stage, path)
    made.GetPrim().SetDisplayName(link.name)
    made.CreateBody0Rel().SetTargets([parent.GetPath()])
    made.CreateBody1Rel().SetTargets([child.GetPath()])
    turn = Gf.Quatf(Gf.Rotation(Gf.Vec3d(1, 0, 0), Gf.Vec3d(*joint.joint.axis)).GetQuat())
    made.CreateLocalPos0Attr(Gf.Vec3f(*link.origin))
    made.CreateLocalRot0Attr(turn)
    made.CreateLocalPos1Attr(Gf.Vec3f(0.0))
    made.CreateLocalRot1Attr(turn)
    made.CreateAxisAttr(UsdPhysics.Tokens.x)
    low, high = np.degrees(joint.limits) if is_hinge else joint.limits
    made.CreateLowerLimitAttr(float(low))
    made.CreateUpperLimitAttr(float(high))


def _parts(
    stage: Any, prim: Any, visuals: tuple[Visual, ...], boxes: tuple[CollisionBox, ...], looks: dict[str, Any]
) -> None:
    """What is seen of a prim, and the boxes that physics meets, which are not."""
    for number, visual in enumerate(visuals):
        seen = stage.DefinePrim(f"{prim.GetPath()}/Mesh{number}")
        seen.GetReferences().AddInternalReference(f"/Meshes/{_word(visual.mesh)}")
        UsdShade.MaterialBindingAPI.Apply(seen).Bind(looks[visual.material])
    for number, box in enumerate(boxes):
        cube = UsdGeom.Cube.Define(stage, f"{prim.GetPath()}/Box{number}")
        cube.CreateSizeAttr(1.0)
        cube.CreateExtentAttr([Gf.Vec3f(-0.5), Gf.Vec3f(0.5)])
        cube.CreatePurposeAttr(UsdGeom.Tokens.guide)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = rotation_of(box.quaternion) * np.asarray(box.size), box.centre
        _place(cube, pose)
        UsdPhysics.CollisionAPI.Apply(cube.GetPrim())


def _mesh(stage: Any, path: str, surface: Surface, is_two_sided: bool) -> None:
    made = UsdGeom.Mesh.Define(stage, path)
    points = surface.vertices.astype(np.float32)
    made.CreatePointsAttr(points)
    made.CreateFaceVertexCountsAttr([3] * len(surface.faces))
    made.CreateFaceVertexIndicesAttr(surface.faces.ravel().astype(np.int32))
    made.CreateNormalsAttr(surface.normals.astype(np.float32))
    made.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    made.CreateDoubleSidedAttr(is_two_sided)
    made.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    made.CreateExtentAttr(np.stack([points.min(axis=0), points.max(axis=0)]))
    coordinates = UsdGeom.PrimvarsAPI(made).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex
    )
    coordinates.Set(upward_uv(surface))


def _material(stage: Any, path: str, material: Material, folder: str) -> Any:
    """UsdPreviewSurface, with the texture if there is one."""
    made = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1.0 - material.gloss)
    linear = Gf.Vec3f(*(float(channel) ** 2.2 for channel in material.rgb))
    colour = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    if material.texture is None:
        colour.Set(linear)
    else:
        reader = UsdShade.Shader.Define(stage, f"{path}/Coordinates")
        reader.CreateIdAttr("UsdPrimvarReader_float2")
        reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
        picture = UsdShade.Shader.Define(stage, f"{path}/Picture")
        picture.CreateIdAttr("UsdUVTexture")
        picture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(f"./{folder}/{material.texture}.png")
        picture.CreateInput("scale", Sdf.ValueTypeNames.Float4).Set(Gf.Vec4f(*linear, 1.0))
        for axis in "ST":
            picture.CreateInput(f"wrap{axis}", Sdf.ValueTypeNames.Token).Set("repeat")
        coordinates = reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
        picture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(coordinates)
        colour.ConnectToSource(picture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
    if material.glow:
        shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(linear * material.glow)
    made.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", Sdf.ValueTypeNames.Token))
    return made


def _place(made: Any, pose: F64) -> None:
    """Put a prim where a (4, 4) pose says, in its parent."""
    made.AddTransformOp().Set(Gf.Matrix4d(*pose.T.ravel().tolist()))


def _word(name: str) -> str:
    return str(Tf.MakeValidIdentifier(name))


def _words(names: Iterable[str]) -> list[str]:
    """Names that USD takes, in the same order, no two alike."""
    found: dict[str, None] = {}
    for name in map(_word, names):
        number, unique = 1, name
        while unique in found:
            number, unique = number + 1, f"{name}_{number}"
        found[unique] = None
    return list(found)
