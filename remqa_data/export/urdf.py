"""A room as URDF: one robot that stands still but for its doors and drawers."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

import numpy as np

from remqa_data.assets.core.model import CollisionBox, Material
from remqa_data.export.links import Inertia, inertia_of
from remqa_data.export.model import ModelLink, ModelObject, RoomModel, Visual
from remqa_data.export.numbers import roll_pitch_yaw, spaced
from remqa_data.geometry.rotations import rotation_of
from remqa_data.scene import Quaternion

ROOT = "room"
EFFORT = 100.0
"""Most a motor may do at a joint, N or N m; URDF wants to know."""
VELOCITY = 3.0
"""rad/s or m/s."""


def urdf(room: RoomModel) -> Element:
    """A robot whose links are named as the objects are, and their moving links and joints ID/LINK, on the link `room`.

    URDF holds no joint positions, so all is closed, and knows nothing that moves freely, so whatever does not open is fixed.
    """
    root = Element("robot", name=room.name)
    for name, material in room.materials.items():
        _material(root, name, material)
    building = SubElement(root, "link", name=ROOT)
    if room.boxes:
        _inertial(building, inertia_of(room.boxes))
    _parts(building, room.meshes, room.visuals, room.boxes)
    for thing in room.objects:
        _object(root, room.meshes, thing)
    return root


def _material(root: Element, name: str, material: Material) -> None:
    made = SubElement(root, "material", name=name)
    SubElement(made, "color", rgba=spaced((*material.rgb, 1.0)))


def _object(root: Element, meshes: str, thing: ModelObject) -> None:
    for link in thing.links:
        made = SubElement(root, "link", name=link.name)
        _inertial(made, link.inertia)
        _parts(made, meshes, link.visuals, link.boxes)
        _joint(root, thing, link)


def _joint(root: Element, thing: ModelObject, link: ModelLink) -> None:
    joint, parent = link.joint, ROOT if link.joint is None else thing.links[link.parent].name
    made = SubElement(root, "joint", name=link.name, type="fixed" if joint is None else joint.joint.kind)
    if joint is None:
        _origin(made, thing.position, thing.quaternion)
    else:
        _origin(made, link.origin)
        SubElement(made, "axis", xyz=spaced(joint.joint.axis))
        low, high = joint.limits
        SubElement(
            made, "limit", lower=spaced([low]), upper=spaced([high]), effort=f"{EFFORT:g}", velocity=f"{VELOCITY:g}"
        )
        SubElement(made, "dynamics", damping="0", friction=f"{joint.friction:.4g}")
    SubElement(made, "parent", link=parent)
    SubElement(made, "child", link=link.name)


def _inertial(link: Element, inertia: Inertia) -> None:
    made, m = SubElement(link, "inertial"), inertia.about_centre
    _origin(made, inertia.centre)
    SubElement(made, "mass", value=spaced([inertia.mass_kg]))
    names = {"ixx": m[0, 0], "iyy": m[1, 1], "izz": m[2, 2], "ixy": m[0, 1], "ixz": m[0, 2], "iyz": m[1, 2]}
    SubElement(made, "inertia", {name: spaced([moment]) for name, moment in names.items()})


def _parts(link: Element, meshes: str, visuals: tuple[Visual, ...], boxes: tuple[CollisionBox, ...]) -> None:
    for visual in visuals:
        made = SubElement(link, "visual")
        SubElement(SubElement(made, "geometry"), "mesh", filename=f"{meshes}/{visual.mesh}.obj")
        SubElement(made, "material", name=visual.material)
    for box in boxes:
        made = SubElement(link, "collision")
        _origin(made, box.centre, box.quaternion)
        SubElement(SubElement(made, "geometry"), "box", size=spaced(box.size))


def _origin(above: Element, position: object, quaternion: Quaternion = (0.0, 0.0, 0.0, 1.0)) -> None:
    rpy = roll_pitch_yaw(rotation_of(quaternion))
    SubElement(above, "origin", xyz=spaced(np.asarray(position, dtype=np.float64)), rpy=spaced(rpy))
