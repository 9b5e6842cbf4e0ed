"""The recorded floor plans as typed rows, in our own frame.

The table that ships with the package holds the start-of-episode metadata of the 120 iTHOR rooms in AI2-THOR's frame
(left-handed, y up, yaw clockwise from +z). This module is one of the two places that know that frame: swapping y and z
is the whole change of handedness, and an object that AI2-THOR turns by a yaw t faces (sin t, cos t) in our xy plane.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

import numpy as np
import pandas as pd

from remqa_data.errors import FloorPlanError, UnknownNameError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

TABLE = "ithor_floorplans.parquet"
MIN_SIZE_M = 0.003
"""Recorded boxes of no thickness (two shelves, two counters) get at least this."""
RIGHT_ANGLE_TOLERANCE_DEG = 2.0


@dataclass(frozen=True, eq=False)
class RecordedObject:
    """One object of a floor plan, in our frame (z up, metres).

    Attributes
    ----------
    id : str
        AI2-THOR's objectId.
    type, room : str
        Object type, and kind of room: kitchen, living_room, bedroom or bathroom.
    pivot : (3,) array
        AI2-THOR's `position` (for a door that is its hinge).
    low, high : (3,) arrays
        Corners of the axis-aligned box.
    centre, size : (3,) arrays
        Of the oriented box, along its own axes: x to the right as seen from the front, front at -y, z up.
    rotation : (3, 3) array
        Columns are the oriented box's axes in the room.
    angles : tuple of float
        AI2-THOR's `rotation`: degrees about its x, y and z axes. They turn a frame of the object's maker, which need not
        have its front anywhere; what faces where is told by `rotation`.
    """

    scene: str
    room: str
    id: str
    type: str
    pivot: F64
    low: F64
    high: F64
    centre: F64
    size: F64
    rotation: F64
    angles: Vec3
    is_oriented: bool
    openable: bool
    pickupable: bool
    moveable: bool
    receptacle: bool
    openness: float
    parents: tuple[str, ...]

    @property
    def front(self) -> F64:
        """(3,) direction that the object faces."""
        return -self.rotation[:, 1]


def scene_names() -> tuple[str, ...]:
    """The 120 scenes, in iTHOR's order: kitchens 1-30, living rooms 201-230, bedrooms 301-330, bathrooms 401-430.

    >>> len(scene_names()), scene_names()[0], scene_names()[-1]
    (120, 'FloorPlan1', 'FloorPlan430')
    """
    return tuple(sorted(_by_scene(), key=lambda name: int(name.removeprefix("FloorPlan"))))


def recorded_objects(scene: str) -> list[RecordedObject]:
    """All objects of one scene, in the table's order.

    Raises
    ------
    UnknownNameError
        If there is no such scene.
    FloorPlanError
        If a row is damaged: says which row and field, and why.
    """
    by_scene = _by_scene()
    if scene not in by_scene:
        raise UnknownNameError("scene", scene, by_scene)
    return [parse_row(row, where) for where, row in by_scene[scene]]


@lru_cache(maxsize=1)
def _by_scene() -> dict[str, list[tuple[str, dict[str, Any]]]]:
    with resources.as_file(resources.files("remqa_data.templates") / TABLE) as path:
        frame = pd.read_parquet(path)
    grouped: dict[str, list[tuple[str, dict[str, Any]]]] = {}
    for index, row in enumerate(frame.to_dict("records")):
        named = {str(key): value for key, value in row.items()}
        grouped.setdefault(str(named["scene"]), []).append((f"{TABLE} row {index}", named))
    return grouped


def parse_row(row: Mapping[str, Any], where: str) -> RecordedObject:
    """One row of the table as a typed record.

    Parameters
    ----------
    row : mapping
        Column name to value, as in the shipped table.
    where : str
        What to call the row in an error.
    """
    read = _Reader(row, where)
    pivot = read.vector("x", "y", "z")
    centre, size = read.vector("aabb_cx", "aabb_cy", "aabb_cz"), read.vector("aabb_sx", "aabb_sy", "aabb_sz")
    if size.min() < 0:
        read.fail("aabb_sx, aabb_sy, aabb_sz", f"a size is negative: {size.tolist()}")
    if size.max() > 50:
        read.fail("aabb_sx, aabb_sy, aabb_sz", f"larger than any room: {size.tolist()} m")
    size = np.maximum(size, MIN_SIZE_M)
    angles = read.angles("rot_x", "rot_y", "rot_z")
    openness = read.number("openness")
    if not 0 <= openness <= 1:
        read.fail("openness", f"{openness} is not between 0 and 1")
    corners = row.get("oobb")
    oriented = _from_corners(read, corners, angles) if corners is not None else _from_yaw(centre, size, angles[1])
    parents = row.get("parentReceptacles")
    return RecordedObject(
        scene=read.text("scene"),
        room=read.text("room"),
        id=read.text("objectId"),
        type=read.text("objectType"),
        pivot=pivot,
        low=centre - size / 2,
        high=centre + size / 2,
        centre=oriented[0],
        size=np.maximum(oriented[1], MIN_SIZE_M),
        rotation=oriented[2],
        angles=angles,
        is_oriented=corners is not None,
        openable=bool(row["openable"]),
        pickupable=bool(row["pickupable"]),
        moveable=bool(row["moveable"]),
        receptacle=bool(row["receptacle"]),
        openness=openness,
        parents=() if parents is None else tuple(str(parent) for parent in parents),
    )


class _Reader:
    """Reads fields of a row and names the row and the field when one is wrong."""

    def __init__(self, row: Mapping[str, Any], where: str) -> None:
        self.row, self.where = row, where

    def fail(self, field: str, why: str) -> None:
        name = self.row.get("objectId", "?")
        raise FloorPlanError(f"{self.where} ({self.row.get('scene', '?')}, {name}): field {field}: {why}")

    def text(self, field: str) -> str:
        value = self.row.get(field)
        if not isinstance(value, str) or not value:
            self.fail(field, f"expected a name, found {value!r}")
        return str(value)

    def number(self, field: str) -> float:
        value = self.row.get(field)
        try:
            number = float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            self.fail(field, f"expected a number, found {value!r}")
        if not np.isfinite(number):
            self.fail(field, f"{number} is not finite")
        return number

    def vector(self, x: str, y: str, z: str) -> F64:
        """Three AI2-THOR fields as a vector in our frame."""
        return np.array([self.number(x), self.number(z), self.number(y)])

    def angles(self, *fields: str) -> Vec3:
        x, y, z = (self.number(field) for field in fields)
        return x, y, z


def _from_yaw(centre: F64, size: F64, yaw_deg: float) -> tuple[F64, F64, F64]:
    """Oriented box of an object of which only the axis-aligned box and the yaw are recorded."""
    quarter = round(yaw_deg / 90.0)
    off = yaw_deg - 90.0 * quarter
    c, s = (abs(float(share)) for share in reversed(arithmetic.sin_cos_deg(yaw_deg)))
    along = np.array([size[0], size[1], size[2]])
    if abs(off) > RIGHT_ANGLE_TOLERANCE_DEG and abs(c * c - s * s) > 0.1:
        # sx = w c + d s and sy = w s + d c, solved for the box's own width and depth
        width = (size[0] * c - size[1] * s) / (c * c - s * s)
        depth = (size[1] * c - size[0] * s) / (c * c - s * s)
        if min(width, depth) > 0.3 * min(size[0], size[1]):
            return centre, np.array([width, depth, size[2]]), _facing(yaw_deg)
    if quarter % 2:
        along[[0, 1]] = along[[1, 0]]
    return centre, along, _facing(90.0 * quarter)


@lru_cache(maxsize=1024)  # most objects are turned by quarters
def _facing(thor_yaw_deg: float) -> F64:
    """Axes (as columns) of an object that AI2-THOR turns by a yaw; nobody may change them."""
    sine, cosine = arithmetic.sin_cos_deg(thor_yaw_deg)
    axes = axes_facing(np.array([sine, cosine, 0.0]))
    axes.flags.writeable = False
    return axes


def axes_facing(front: F64) -> F64:
    """Rotation whose -y axis points along a horizontal direction and whose z axis is up."""
    y = -front / arithmetic.length(front)
    z = np.array([0.0, 0.0, 1.0])
    return np.column_stack([arithmetic.cross(y, z), y, z])


def _from_corners(read: _Reader, corners: Any, angles: Vec3) -> tuple[F64, F64, F64]:
    """Oriented box from its eight recorded corners: bottom face 0-3, top face 4-7 above them."""
    flat = np.asarray(corners, dtype=np.float64).ravel()
    if flat.shape != (24,) or not np.isfinite(flat).all():
        read.fail("oobb", f"expected 8 finite corners, found {flat.size} numbers")
    points = flat.reshape(8, 3)[:, [0, 2, 1]]
    edges = [points[1] - points[0], points[3] - points[0], points[4] - points[0]]
    lengths = [float(arithmetic.length(edge)) for edge in edges]
    up = max(range(3), key=lambda i: abs(edges[i][2]) / max(lengths[i], 1e-9))
    z = edges[up] * np.sign(edges[up][2] or 1.0)
    z = z / max(float(arithmetic.length(z)), 1e-9)
    others = [i for i in range(3) if i != up]
    wanted = _forward(angles)
    front_edge = max(others, key=lambda i: abs(arithmetic.dot(edges[i], wanted)) / max(lengths[i], 1e-9))
    side_edge = next(i for i in others if i != front_edge)
    y = -edges[front_edge] * np.sign(arithmetic.dot(edges[front_edge], wanted) or 1.0)
    y = y - z * arithmetic.dot(y, z)
    if arithmetic.length(y) < 1e-9:
        read.fail("oobb", "the corners do not span a box")
    y = y / arithmetic.length(y)
    rotation = np.column_stack([arithmetic.cross(y, z), y, z])
    size = np.array([lengths[side_edge], lengths[front_edge], lengths[up]])
    return points.mean(axis=0), size, rotation


def unity_rotation(angles: Vec3) -> F64:
    """(3, 3) rotation of AI2-THOR's frame by degrees about x, y and z: Unity turns about z, then x, then y."""
    (sx, sy, sz), (cx, cy, cz) = arithmetic.sin_cos_deg(angles)
    rz = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    rx = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    ry = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    return arithmetic.product(arithmetic.product(ry, rx), rz)


@lru_cache(maxsize=1024)
def _forward(angles: Vec3) -> F64:
    """Where AI2-THOR's forward axis points in our frame; where that is vertical, its up axis. Nobody may change it."""
    turned = unity_rotation(angles)[[0, 2, 1]]
    forward = turned[:, 2]
    axis = np.array(turned[:, 1] if abs(forward[2]) > 0.75 else forward)
    axis.flags.writeable = False
    return axis
