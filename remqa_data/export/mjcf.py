"""A room as MJCF, MuJoCo's format."""

from __future__ import annotations

from itertools import combinations
from xml.etree.ElementTree import Element, SubElement

from remqa_data.assets.core.model import CollisionBox, Material
from remqa_data.export.model import ModelLink, ModelObject, RoomModel, Visual
from remqa_data.export.numbers import spaced
from remqa_data.scene import Quaternion
from remqa_data.sim.physics.bodies import FRICTION

DAMPING = {"revolute": 0.2, "prismatic": 5.0}
"""Of joints, N m s/rad and N s/m: what is opened does not swing on."""
JOINT_TYPES = {"revolute": "hinge", "prismatic": "slide"}
KEYFRAME = "room"


def mjcf(room: RoomModel) -> Element:
    """A model whose bodies are named as the objects are, and their moving links and joints ID/LINK.

    What physics leaves where it is in our simulator is part of the world, and does not collide with itself, doors
    included; the rest is free. The keyframe `room` has every joint where it stands in the room; without it all is closed.
    """
    root = Element("mujoco", model=room.name)
    SubElement(root, "compiler", angle="radian", meshdir=room.meshes, texturedir=room.meshes, autolimits="true")
    SubElement(root, "option", timestep="0.002", integrator="implicitfast")
    _defaults(root)
    _assets(root, room)
    world = SubElement(root, "worldbody")
    for place in room.lights:
        SubElement(world, "light", pos=spaced(place), dir="0 0 -1", diffuse="0.5 0.5 0.5", castshadow="false")
    _geoms(world, room.visuals, room.boxes, "fixed")
    for thing in room.objects:
        _object(world, thing)
    contact = SubElement(root, "contact")
    for thing in room.objects:
        for one, other in combinations(thing.links if thing.is_free else (), 2):
            SubElement(contact, "exclude", body1=one.name, body2=other.name)
    frame = SubElement(root, "keyframe")
    SubElement(frame, "key", name=KEYFRAME, qpos=spaced(number for thing in room.objects for number in _qpos(thing)))
    return root


def _defaults(root: Element) -> None:
    default = SubElement(root, "default")
    SubElement(default, "joint", solimpfriction="0.9999 0.9999 0.001 0.5 2")  # else what is left open creeps
    seen = SubElement(default, "default", {"class": "seen"})
    SubElement(seen, "geom", type="mesh", group="2", contype="0", conaffinity="0", mass="0")
    for name, affinity in (("fixed", "0"), ("free", "1")):
        met = SubElement(default, "default", {"class": name})
        SubElement(
            met,
            "geom",
            type="box",
            group="3",
            contype="1",
            conaffinity=affinity,
            mass="0",
            friction=f"{FRICTION} 0.005 1e-4",
        )


def _assets(root: Element, room: RoomModel) -> None:
    assets = SubElement(root, "asset")
    for texture in dict.fromkeys(m.texture for m in room.materials.values() if m.texture is not None):
        SubElement(assets, "texture", name=texture, type="2d", file=f"{texture}.png")
    for name, material in room.materials.items():
        _material(assets, name, material)
    for name in room.mesh_names():
        SubElement(assets, "mesh", name=name, file=f"{name}.obj", inertia="shell")  # pictures are flat


def _material(assets: Element, name: str, material: Material) -> None:
    gloss = f"{material.gloss:.4g}"
    made = SubElement(assets, "material", name=name, rgba=spaced((*material.rgb, 1.0)), specular=gloss, shininess=gloss)
    if material.texture is not None:
        made.set("texture", material.texture)
    if material.glow:
        made.set("emission", f"{material.glow:.4g}")


def _object(world: Element, thing: ModelObject) -> None:
    kind, bodies = "free" if thing.is_free else "fixed", list[Element]()
    for link in thing.links:
        if link.joint is None:
            body = SubElement(
                world, "body", name=link.name, pos=spaced(thing.position), quat=_w_first(thing.quaternion)
            )
            if thing.is_free:
                SubElement(body, "freejoint", name=link.name)
                _inertial(body, link)
        else:
            body = SubElement(bodies[link.parent], "body", name=link.name, pos=spaced(link.origin))
            SubElement(
                body,
                "joint",
                name=link.name,
                type=JOINT_TYPES[link.joint.joint.kind],
                axis=spaced(link.joint.joint.axis),
                range=spaced(link.joint.limits),
                damping=f"{DAMPING[link.joint.joint.kind]:g}",
                frictionloss=f"{link.joint.friction:.4g}",
            )
            _inertial(body, link)
        _geoms(body, link.visuals, link.boxes, kind)
        bodies.append(body)


def _inertial(body: Element, link: ModelLink) -> None:
    m = link.inertia.about_centre
    moments = (m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2])
    mass = spaced([link.inertia.mass_kg])
    SubElement(body, "inertial", pos=spaced(link.inertia.centre), mass=mass, fullinertia=spaced(moments))


def _geoms(body: Element, visuals: tuple[Visual, ...], boxes: tuple[CollisionBox, ...], kind: str) -> None:
    for visual in visuals:
        SubElement(body, "geom", {"class": "seen", "mesh": visual.mesh, "material": visual.material})
    for box in boxes:
        half, turn = spaced(side / 2 for side in box.size), _w_first(box.quaternion)
        SubElement(body, "geom", {"class": kind, "size": half, "pos": spaced(box.centre), "quat": turn})


def _qpos(thing: ModelObject) -> list[float]:
    """In MuJoCo's order, that of the bodies: a free one has its pose, a joint its position."""
    x, y, z, w = thing.quaternion
    pose = [*thing.position, w, x, y, z] if thing.is_free else []
    return pose + [link.joint.position for link in thing.links if link.joint is not None]


def _w_first(quaternion: Quaternion) -> str:
    x, y, z, w = quaternion
    return spaced((w, x, y, z))
