"""AI2-THOR's frame and the room's: the only place of the facade that knows both.

AI2-THOR is left-handed, y up, and turns clockwise from +z as seen from above; the room is right-handed, z up, and turns
counter-clockwise from +x. Swapping y and z is the whole change of handedness.

>>> to_thor((1.0, 2.0, 0.5))
{'x': 1.0, 'y': 0.5, 'z': 2.0}
>>> yaw_to_thor(90.0), yaw_to_room(90.0)
(0.0, 0.0)
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from typing_extensions import TypedDict

from remqa_data.floorplans.load import recorded_poses
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import quaternion_of, rotation_of, snapped_quaternion
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Quaternion, Scene


class Vector(TypedDict):
    """A point, size or triple of angles in AI2-THOR's metadata."""

    x: float
    y: float
    z: float


class PartialVector(TypedDict, total=False):
    """A point or triple of angles in an action; what is left out is 0."""

    x: float
    y: float
    z: float


def whole(vector: PartialVector) -> Vector:
    """A vector with all its parts."""
    return {"x": vector.get("x", 0.0), "y": vector.get("y", 0.0), "z": vector.get("z", 0.0)}


def to_thor(point: npt.ArrayLike) -> Vector:
    """AI2-THOR's point for (3,) metres in the room."""
    x, y, z = (float(value) for value in np.asarray(point, dtype=np.float64))
    return {"x": x, "y": z, "z": y}


def to_room(point: Vector) -> Vec3:
    """A point of AI2-THOR in the room, metres."""
    return point["x"], point["z"], point["y"]


def corners_to_thor(points: npt.ArrayLike) -> list[list[float]]:
    """(n, 3) points of the room as AI2-THOR lists corners."""
    corners: list[list[float]] = np.asarray(points, dtype=np.float64)[:, [0, 2, 1]].tolist()
    return corners


def yaw_to_thor(yaw_deg: float) -> float:
    """Degrees clockwise from +z in [0, 360), from degrees counter-clockwise from +x."""
    return (90.0 - yaw_deg) % 360.0


def yaw_to_room(rotation_y: float) -> float:
    """Degrees counter-clockwise from +x in [0, 360), from degrees clockwise from +z."""
    return (90.0 - rotation_y) % 360.0


def facing(yaw_deg: float) -> F64:
    """(3, 3) rotation whose columns are an agent's right, ahead and up in the room."""
    sine, cosine = arithmetic.sin_cos_deg(yaw_deg)
    return np.array([[sine, cosine, 0.0], [-cosine, sine, 0.0], [0.0, 0.0, 1.0]])


def turn_to_thor(quaternion: Quaternion) -> F64:
    """(3, 3) rotation in AI2-THOR's frame of an object whose front is +z there, and -y in its asset's frame.

    What looks along the room's +y is not turned at all.
    """
    return np.asarray(SWAP @ rotation_of(quaternion) @ _ASSET_TO_THOR.T)


def turn_to_room(turn: F64) -> Quaternion:
    """The inverse of `turn_to_thor`, snapped."""
    return snapped_quaternion(quaternion_of(arithmetic.product(arithmetic.product(SWAP, turn), _ASSET_TO_THOR)))


def turn_of_euler(rotation: Vector) -> F64:
    """(3, 3) rotation in AI2-THOR's frame of its three angles, degrees; the inverse of `euler_to_thor`.

    >>> euler_to_thor(turn_of_euler({"x": 30.0, "y": 200.0, "z": 350.0}))
    {'x': 30.0, 'y': 200.0, 'z': 350.0}
    """
    (sx, cx), (sy, cy), (sz, cz) = (arithmetic.sin_cos_deg(rotation[axis]) for axis in ("x", "y", "z"))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
    return arithmetic.product(arithmetic.product(about_y, about_x), about_z)


def turn_of_look(yaw_deg: float, horizon_deg: float = 0.0) -> F64:
    """(3, 3) rotation in AI2-THOR's frame of an agent that looks along a heading of the room, and of its camera if tilted."""
    return turn_of_euler({"x": horizon_deg, "y": yaw_to_thor(yaw_deg), "z": 0.0})


def euler_to_thor(m: F64) -> Vector:
    """AI2-THOR's rotation, degrees in [0, 360), of a (3, 3) rotation in its frame.

    Notes
    -----
    Unity turns about z, then x, then y.
    """
    sin_x = float(np.clip(-m[1, 2], -1.0, 1.0))
    if abs(sin_x) < _UPRIGHT:
        y, z = math.atan2(m[0, 2], m[2, 2]), math.atan2(m[1, 0], m[1, 1])
    else:  # looking straight up or down, only the sum of y and z is defined
        y, z = math.atan2(-m[2, 0], m[0, 0]), 0.0
    return {"x": _degrees(math.asin(sin_x)), "y": _degrees(y), "z": _degrees(z)}


def _degrees(radians: float) -> float:
    return round(math.degrees(radians), 5) % 360.0 + 0.0


SWAP: F64 = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
_ASSET_TO_THOR: F64 = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""An asset's axes (right, back, up) in AI2-THOR's frame of the object (its front is +z)."""
_UPRIGHT = 1.0 - 1e-9


class ObjectFrame(NamedTuple):
    """AI2-THOR's own frame of an object: `pivot`, where it is in the asset's frame, and `turn`, how it is turned there."""

    pivot: F64
    turn: F64


def object_frames(scene: Scene) -> dict[str, ObjectFrame]:
    """The frames of the objects that were recorded, by their ids."""
    recorded = recorded_poses(scene.name)
    return {
        o.id: ObjectFrame(
            rotation_of(o.quaternion).T @ (recorded[o.id].pivot - np.asarray(o.position)),
            turn_to_thor(o.quaternion).T @ recorded[o.id].turn,
        )
        for o in scene.objects
        if o.id in recorded
    }
