"""Kinematics of the Kinova Jaco2 arm with six joints, a spherical wrist and two fingers (j2s6s200).

The figures are those that Kinova publishes in `kinova_description/urdf/j2s6s200.xacro` of its ROS package
(https://github.com/Kinovarobotics/kinova-ros, BSD licence): joint origins, and the limits of the three joints that do
not turn freely. The frame of link 0 stands on the arm's foot, z up; every joint turns about the z axis of its link.

Because the axes of the last three joints meet in one point, the wrist, the inverse has a closed form: the first three
joints put the wrist where it has to be, the other three point the hand (Pieper 1968).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

JOINTS = 6
HAND = JOINTS + 1
"""Index of the hand among `link_poses`; its frame lies between the finger tips, z pointing out of the palm."""


@dataclass(frozen=True)
class JacoJoint:
    """Where a joint sits in the frame of the link before it.

    Attributes
    ----------
    origin : tuple of float
        Metres.
    rpy : tuple of float
        Roll, pitch, yaw of URDF, radians: turned about the fixed x, then y, then z axis.
    limits : tuple of float
        Least and greatest angle, radians.
    """

    origin: Vec3
    rpy: Vec3
    limits: tuple[float, float] = (-2 * math.pi, 2 * math.pi)


_QUARTER, _HALF = math.pi / 2, math.pi
CHAIN = (
    JacoJoint((0.0, 0.0, 0.15675), (0.0, _HALF, 0.0)),
    JacoJoint((0.0, 0.0016, -0.11875), (-_QUARTER, 0.0, _HALF), (math.radians(47), math.radians(313))),
    JacoJoint((0.0, -0.410, 0.0), (0.0, _HALF, 0.0), (math.radians(19), math.radians(341))),
    JacoJoint((0.0, 0.2073, -0.0114), (-_QUARTER, 0.0, _HALF)),
    JacoJoint((0.0, 0.0, -0.10375), (_QUARTER, 0.0, _HALF), (math.radians(30), math.radians(330))),
    JacoJoint((0.0, 0.10375, 0.0), (-_QUARTER, 0.0, _HALF)),
)
TO_HAND = JacoJoint((0.0, 0.0, -0.16), (_HALF, 0.0, _QUARTER), (0.0, 0.0))
LIMITS = np.array([joint.limits for joint in CHAIN])

SHOULDER_M = CHAIN[0].origin[2] - CHAIN[1].origin[2]
"""Height of the second joint, which lifts the upper arm, above the foot."""
UPPER_ARM_M = -CHAIN[2].origin[1]
FOREARM_M = CHAIN[3].origin[1] - CHAIN[4].origin[2]
"""From the elbow to the wrist."""
WRIST_TO_HAND_M = CHAIN[5].origin[1] - TO_HAND.origin[2]
_SIDE_M = CHAIN[1].origin[1] + CHAIN[3].origin[2]
"""How far the wrist lies beside the plane in which shoulder and elbow bend."""


def link_poses(joints: F64) -> F64:
    """Poses of all links for a number of postures.

    Parameters
    ----------
    joints : (n, 6) array
        Joint angles in radians.

    Returns
    -------
    (n, 8, 4, 4) poses in the frame of the arm's foot: the foot, six links, the hand.
    """
    turned = np.zeros((len(joints), JOINTS, 4, 4))
    turned[..., 2, 2] = turned[..., 3, 3] = 1.0
    sines, cosines = arithmetic.sin_cos(joints)
    turned[..., 0, 0] = turned[..., 1, 1] = cosines
    turned[..., 1, 0] = sines
    turned[..., 0, 1] = -turned[..., 1, 0]
    steps = arithmetic.product(_ORIGINS[:JOINTS], turned)
    poses = np.empty((len(joints), HAND + 1, 4, 4))
    poses[:, 0] = np.eye(4)
    for i in range(JOINTS):
        poses[:, i + 1] = arithmetic.product(poses[:, i], steps[:, i])
    poses[:, HAND] = arithmetic.product(poses[:, JOINTS], _ORIGINS[JOINTS])
    return poses


def postures(points: F64, axes: F64, roll: float = 0.0) -> F64:
    """All postures that bring the hand somewhere and point it somewhere.

    Parameters
    ----------
    points : (n, 3) array
        Where the hand's frame goes, metres, in the frame of the foot.
    axes : (n, 3) array
        Unit vectors out of the palm, in the same frame.
    roll : float
        Angle of the last joint, which turns the hand about its axis, radians.

    Returns
    -------
    (n, 8, 6) joint angles in radians: two shoulders times two elbows times two wrists. NaN where there is none: out of
    reach, or beyond a joint's limits.
    """
    x, y, z = (points - WRIST_TO_HAND_M * axes).T[:, :, None]
    with np.errstate(invalid="ignore"):
        ahead = np.sqrt(x * x + y * y - _SIDE_M**2) * np.array([1.0, 1.0, -1.0, -1.0])
        up = z - SHOULDER_M
        stretch = (ahead**2 + up**2 - UPPER_ARM_M**2 - FOREARM_M**2) / (2 * UPPER_ARM_M * FOREARM_M)
        bend = arithmetic.arccos(stretch) * np.array([1.0, -1.0, 1.0, -1.0])
    joints = np.empty((len(points), 4, 2, JOINTS))
    arm = np.empty((len(points), 4, 3))
    arm[..., 0] = arithmetic.arctan2(_SIDE_M, ahead) - arithmetic.arctan2(y, x)
    sine, cosine = arithmetic.sin_cos(bend)
    lean = arithmetic.arctan2(ahead, up) - arithmetic.arctan2(FOREARM_M * sine, UPPER_ARM_M + FOREARM_M * cosine)
    arm[..., 1] = math.pi - lean
    arm[..., 2] = math.pi + bend
    joints[..., :3] = arm[:, :, None]
    # The wrist's frame before joints 4 and 5 turn; they have to point its -z axis along the hand's axis.
    wrist = link_poses(np.concatenate([arm, np.zeros_like(arm)], axis=2).reshape(-1, JOINTS))[:, 4, :3, :3]
    local = arithmetic.turned_back(axes[:, None], wrist.reshape(-1, 4, 3, 3))
    tilt = arithmetic.arccos(np.clip(local[..., 2], -1.0, 1.0))
    turn = arithmetic.arctan2(local[..., 1], local[..., 0])
    joints[..., 0, 3], joints[..., 0, 4] = turn, tilt
    joints[..., 1, 3], joints[..., 1, 4] = turn + math.pi, -tilt
    joints[..., 5] = roll
    return within_limits(joints.reshape(-1, 8, JOINTS))


def postures_at(pose: F64) -> F64:
    """All postures that bring the hand's frame to a (4, 4) pose in the frame of the foot; (8, 6), as `postures`."""
    found = postures(pose[None, :3, 3], pose[None, :3, 2])[0]
    sideways = link_poses(found)[:, HAND, :3, 0]
    angle = arithmetic.arctan2(
        arithmetic.dot(arithmetic.cross(sideways, pose[:3, 0]), pose[:3, 2]), arithmetic.dot(sideways, pose[:3, 0])
    )
    found[:, 5] += _ORIGINS[JOINTS][2, 2] * angle  # the last joint's axis points into the palm, the hand's out of it
    return within_limits(found)


def within_limits(joints: F64) -> F64:
    """The same postures (..., 6) with angles near the middle of their limits; NaN where one is beyond them."""
    middle = LIMITS.mean(axis=1)
    wrapped = middle + (joints - middle + math.pi) % (2 * math.pi) - math.pi
    with np.errstate(invalid="ignore"):
        is_allowed = np.all((wrapped >= LIMITS[:, 0]) & (wrapped <= LIMITS[:, 1]), axis=-1)
    return np.where(is_allowed[..., None], wrapped, np.nan)


def rotation_of_rpy(rpy: Vec3) -> F64:
    """(3, 3) rotation of URDF's roll, pitch, yaw."""
    (sr, sp, sy), (cr, cp, cy) = arithmetic.sin_cos(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _origin(joint: JacoJoint) -> F64:
    pose = np.eye(4)
    pose[:3, :3] = rotation_of_rpy(joint.rpy)
    pose[:3, 3] = joint.origin
    return pose


_ORIGINS = np.stack([_origin(joint) for joint in (*CHAIN, TO_HAND)])
