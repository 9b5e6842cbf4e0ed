"""How the arm is held, and where that puts its links in the room.

The column with the arm turns on the agent's base; the arm's foot stands on a carriage in front of the column, upright.
A *posture* is a vector of eight numbers: the shoulder's height above the floor (metres), the column's turn, and the six
joints (radians).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from remqa_data.errors import ActionError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import about_z
from remqa_data.geometry.types import F64
from remqa_data.sim.arm import jaco
from remqa_data.sim.navigation.embodiment import AGENT


@dataclass(frozen=True)
class ArmBase:
    """Where the agent stands.

    Attributes
    ----------
    x, y : float
        The middle of its base, metres.
    yaw_deg : float
        Its heading, degrees counter-clockwise from +x.
    floor_z : float
        Height of the floor, metres.
    """

    x: float
    y: float
    yaw_deg: float
    floor_z: float

    def pose(self) -> F64:
        """(4, 4) of its middle on the floor in the room, x ahead."""
        pose = np.eye(4)
        pose[:3, :3] = about_z(self.yaw_deg)
        pose[:3, 3] = self.x, self.y, self.floor_z
        return pose


@dataclass(frozen=True)
class ArmState:
    """How the arm is held.

    Attributes
    ----------
    base_height_m : float
        Height of the shoulder above the floor.
    joints : tuple of float
        Angles of the six joints, radians.
    turn_deg : float
        How far the column is turned from the agent's heading, counter-clockwise.

    Raises
    ------
    ActionError
        If there are not six joints, or a number is not finite.
    """

    base_height_m: float
    joints: tuple[float, ...]
    turn_deg: float = 0.0

    def __post_init__(self) -> None:
        if len(self.joints) != jaco.JOINTS or not np.isfinite(self.posture()).all():
            raise ActionError(f"the arm has a height, a turn and {jaco.JOINTS} joints, all finite; found {self}")

    def posture(self) -> F64:
        """(8,) the state as a vector."""
        return np.array([self.base_height_m, math.radians(self.turn_deg), *self.joints])

    @classmethod
    def of(cls, posture: F64) -> ArmState:
        """The state that a vector stands for."""
        height, turn, *joints = posture.tolist()
        return cls(height, tuple(joints), math.degrees(turn))


BASE_TOP_M, COLUMN_TOP_M = 0.155, 1.66
"""Heights above the floor of the agent's round base and of its column."""
HOME = ArmState(0.75, tuple(math.radians(angle) for angle in (-124.0, 180.0, 335.0, 0.0, 155.0, 0.0)))
"""Folded: the whole arm is above the agent's base, so that it passes wherever the agent does."""


def foot_poses(base: ArmBase, postures: F64) -> F64:
    """(n, 4, 4) poses of the arm's foot in the room for (n, 8) postures; the first two numbers of each are enough."""
    heading = math.radians(base.yaw_deg) + postures[:, 1]
    sin, cos = arithmetic.sin_cos(heading)
    poses = np.zeros((len(postures), 4, 4))
    poses[:, 0, 0] = poses[:, 1, 1] = cos
    poses[:, 1, 0], poses[:, 0, 1] = sin, -sin
    poses[:, 2, 2] = poses[:, 3, 3] = 1.0
    poses[:, 0, 3] = base.x + AGENT.shoulder_ahead_m * cos
    poses[:, 1, 3] = base.y + AGENT.shoulder_ahead_m * sin
    poses[:, 2, 3] = base.floor_z + postures[:, 0] - jaco.SHOULDER_M
    return poses


def link_poses(base: ArmBase, postures: F64) -> F64:
    """(n, 8, 4, 4) poses in the room of the arm's foot, its six links and its hand for (n, 8) postures."""
    return arithmetic.product(foot_poses(base, postures)[:, None], jaco.link_poses(postures[:, 2:]))


def shoulders(base: ArmBase, postures: F64) -> F64:
    """(n, 3) the shoulder in the room for (n, 8) postures; the first two numbers of each are enough."""
    return foot_poses(base, postures)[:, :3, 3] + [0.0, 0.0, jaco.SHOULDER_M]


def postures_to(base: ArmBase, point: F64, columns: F64, axes: F64, near: F64) -> F64:
    """Postures that bring the hand to a point.

    Parameters
    ----------
    base : ArmBase
        Where the agent stands.
    point : (3,) array
        Metres, in the room.
    columns, axes : (n, 2), (n, 3) arrays
        Height and turn of the column with the direction of the hand, a unit vector in the room.
    near : (8,) array
        The posture from which to count.

    Returns
    -------
    (m, 8) postures, up to eight for each pair; those that are nearest to `near` first.
    """
    feet = foot_poses(base, columns)
    points, directions = arithmetic.moved_back(point, feet), arithmetic.turned_back(axes, feet[:, :3, :3])
    joints = jaco.postures(points, directions, float(near[7]))
    pair, branch = np.nonzero(np.isfinite(joints).all(axis=2))
    return _nearest_first(columns[pair], joints[pair, branch], near)


def postures_at(base: ArmBase, pose: F64, near: F64) -> F64:
    """(m, 8) postures with the same column as `near` that bring the hand's frame to a (4, 4) pose in the room."""
    foot = foot_poses(base, near[None])[0]
    local = np.eye(4)
    local[:3, :3] = arithmetic.product(foot[:3, :3].T, pose[:3, :3])
    local[:3, 3] = arithmetic.moved_back(pose[:3, 3], foot)
    joints = jaco.postures_at(local)
    joints = joints[np.isfinite(joints).all(axis=1)]
    return _nearest_first(np.tile(near[:2], (len(joints), 1)), joints, near)


def _nearest_first(columns: F64, joints: F64, near: F64) -> F64:
    found = np.column_stack([columns, _unwound(joints, near[2:])])
    travel = np.abs(found - near).max(axis=1, initial=0.0)
    return found[np.argsort(travel, kind="stable")]


def _unwound(joints: F64, start: F64) -> F64:
    """The same postures with whole turns added where that makes the movement shorter and the limits allow it."""
    nearer = joints + np.round((start - joints) / (2 * math.pi)) * 2 * math.pi
    allowed = (nearer >= jaco.LIMITS[:, 0]) & (nearer <= jaco.LIMITS[:, 1])
    return np.where(allowed, nearer, joints)


def _balls_along(link: int, end: tuple[float, float, float], radius: float, count: int) -> list[tuple[float, ...]]:
    return [(link, *(t * np.array(end)), radius) for t in np.linspace(0.0, 1.0, count)]


_BALLS = np.array(
    [
        *_balls_along(2, (0.0, -0.41, 0.0), 0.040, 10),
        *_balls_along(3, (0.0, 0.2073, -0.0114), 0.037, 6),
        *_balls_along(4, (0.0, 0.0, -0.10375), 0.035, 4),
        *_balls_along(5, (0.0, 0.10375, 0.0), 0.035, 4),
        *((jaco.HAND, 0.0, 0.0, z, r) for z, r in ((-0.16, 0.038), (-0.12, 0.044), (-0.09, 0.044), (-0.06, 0.04))),
        *((jaco.HAND, 0.0, 0.0, z, r) for z, r in ((-0.03, 0.033), (0.0, 0.02))),
    ]
)
_LINK, _LOCAL = _BALLS[:, 0].astype(np.int64), _BALLS[:, 1:4]
_BY_LINK = [(link, link == _LINK, _LOCAL[link == _LINK]) for link in range(2, jaco.HAND + 1) if link in _LINK]
BALL_RADII_M = np.ascontiguousarray(_BALLS[:, 4])
"""(balls,) radii of the balls that stand for the arm: with the gaps between them, capsules along its links. The foot and
the first link never leave the room above the agent's base, which is free where the agent stands."""
HAND_BALLS = _LINK == jaco.HAND
"""(balls,) which of them belong to the hand."""


def balls(poses: F64) -> F64:
    """(n, balls, 3) middles of the arm's balls for (n, 8, 4, 4) poses of its links."""
    placed = np.empty((len(poses), len(_LINK), 3))
    for link, rows, local in _BY_LINK:
        placed[:, rows] = arithmetic.moved(local, poses[:, link, None])
    return placed


def hand_balls(points: F64, axes: F64) -> F64:
    """(n, hand balls, 3) middles of the hand's balls when the hand is at some points and points along unit axes."""
    return np.asarray(points[:, None] + axes[:, None] * _LOCAL[HAND_BALLS][:, 2:])
