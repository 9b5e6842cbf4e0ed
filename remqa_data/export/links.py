"""The links of an asset as robot formats want them: a frame on each joint, how far it goes, what it weighs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from remqa_data.assets.core.model import Asset, CollisionBox, Joint, Link
from remqa_data.catalog import object_type
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64

DENSITY_KG_M3 = 600.0
"""Of what has no mass in the catalog, as what is built in: that of wood."""
GRAVITY_M_S2 = 9.81
HOLD = 1.25
"""Friction of a joint beside the least with which it stays where it is left, as in our simulator."""
SLIDING = 0.1
"""Friction of a slide, as a share of the weight on it."""

_ZERO = np.zeros(3)


@dataclass(frozen=True)
class Inertia:
    """What physics asks of a rigid body.

    Attributes
    ----------
    mass_kg : float
    centre : (3,) array
        Its centre of mass, metres, from the origin of the link's frame.
    about_centre : (3, 3) array
        Moments about that centre, kg m^2.
    """

    mass_kg: float
    centre: F64
    about_centre: F64


def link_origins(asset: Asset) -> F64:
    """(links, 3) where the frame of each link is while the asset is closed: on its joint, turned as the asset is."""
    return np.array([(0.0, 0.0, 0.0) if link.joint is None else link.joint.origin for link in asset.links])


def relative_poses(asset: Asset, openness: float) -> F64:
    """(links, 4, 4) pose of the frame of each link at an openness, in that of its parent; of the base, in the asset's."""
    frames = asset.link_poses(openness)
    for pose, origin in zip(frames, link_origins(asset), strict=True):
        pose[:3, 3] += pose[:3, :3] @ origin
    return np.stack(
        [
            frame if link.joint is None else np.linalg.inv(frames[link.parent]) @ frame
            for link, frame in zip(asset.links, frames, strict=True)
        ]
    )


def joint_range(joint: Joint, most_open: float) -> tuple[float, float]:
    """Least and greatest position of a joint of what opens so far (0 to 1) where it stands; radians or metres."""
    end = joint.upper * most_open
    return min(0.0, end), max(0.0, end)


def inertia_of(boxes: tuple[CollisionBox, ...], density: float = DENSITY_KG_M3, origin: F64 = _ZERO) -> Inertia:
    """Of full boxes of a density, kg/m^3, in a frame at a (3,) origin."""
    masses = np.array([density * float(np.prod(box.size)) for box in boxes])
    centres = np.array([box.centre for box in boxes]) - origin
    centre = masses @ centres / masses.sum()
    moments = np.zeros((3, 3))
    for box, mass, off in zip(boxes, masses, centres - centre, strict=True):
        rotation, sides = rotation_of(box.quaternion), np.square(box.size)
        own = np.diag(mass / 12 * (sides.sum() - sides))
        moments += rotation @ own @ rotation.T + mass * (off @ off * np.eye(3) - np.outer(off, off))
    return Inertia(float(masses.sum()), centre, moments)


def inertias(asset: Asset) -> list[Inertia]:
    """Mass and moments of each link, as if its collision boxes were full, and all of the same stuff."""
    boxes = [link.boxes or (_box_around(link),) for link in asset.links]
    volumes = [sum(float(np.prod(box.size)) for box in of_link) for of_link in boxes]
    mass_kg = object_type(asset.spec.type).mass_kg
    density = DENSITY_KG_M3 if mass_kg is None else mass_kg / sum(volumes)
    return [inertia_of(of_link, density, origin) for of_link, origin in zip(boxes, link_origins(asset), strict=True)]


def holding_friction(joint: Joint, inertia: Inertia, rotation: F64) -> float:
    """Friction with which a joint stays where it is left, N or N m; (3, 3) `rotation` is how its object is turned.

    A hinge bears its weight times the lever on which gravity can act: none about a vertical axis.
    """
    weight = inertia.mass_kg * GRAVITY_M_S2
    if joint.kind == "prismatic":
        return weight * max(SLIDING, HOLD * abs(float((rotation @ joint.axis)[2])))
    axis = np.asarray(joint.axis)
    lever = float(np.linalg.norm(np.cross(axis, inertia.centre)))
    tilt = float(np.linalg.norm(np.cross(rotation @ axis, (0.0, 0.0, 1.0))))
    return weight * lever * max(SLIDING, HOLD * tilt)


def _box_around(link: Link) -> CollisionBox:
    """Of a link that physics does not meet, such as the frame of a drawer; a speck of one that is not even seen."""
    points = np.vstack([np.zeros((0 if link.surfaces else 1, 3)), *(surface.vertices for surface in link.surfaces)])
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = ((low + high) / 2).tolist()
    w, d, h = np.maximum(high - low, 1e-3).tolist()
    return CollisionBox((x, y, z), (w, d, h))
