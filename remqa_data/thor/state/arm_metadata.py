"""The `arm` of AI2-THOR's metadata: its joints, its hand, and what that touches."""

from __future__ import annotations

import numpy as np

from remqa_data.catalog import object_type
from remqa_data.geometry.rotations import quaternion_of
from remqa_data.geometry.types import F64
from remqa_data.sim.arm import jaco
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.frames import SWAP, facing, to_thor
from remqa_data.thor.state.objects import Metadata

JOINTS = {"robot_arm_2_jnt": 3, "robot_arm_3_jnt": 5}
"""AI2-THOR's names of elbow and wrist, and the links of our six-joint arm that begin there. The first joint is the
shoulder, which faces where the agent does, as in AI2-THOR; the fourth is the hand, which faces where the palm does."""


def hand_facing(pose: F64) -> F64:
    """(3, 3) rotation whose columns are the hand's right, ahead (out of the palm) and up in the room, of its (4, 4) pose."""
    return np.column_stack([pose[:3, 0], pose[:3, 2], -pose[:3, 1]])


def arm_metadata(room: LoadedFloorPlan) -> Metadata:
    """Joints, hand and what it touches."""
    agent = room.agent
    arm, base = agent.arm, agent.base
    links, hand = arm.link_poses(base), arm.hand(base)
    touched = arm.touched(hand)
    root = np.eye(4)
    root[:3, :3], root[:3, 3] = facing(agent.yaw_deg), arm.shoulder(base)
    palm = np.eye(4)
    palm[:3, :3], palm[:3, 3] = hand_facing(links[jaco.HAND]), hand
    poses = {
        "robot_arm_1_jnt": root,
        **{name: links[link] for name, link in JOINTS.items()},
        "robot_arm_4_jnt": palm,
    }
    parent, joints = root, []
    for name, pose in poses.items():
        joints.append(
            {
                "name": name,
                "position": to_thor(pose[:3, 3]),
                "rootRelativePosition": to_thor(root[:3, :3].T @ (pose[:3, 3] - root[:3, 3])),
                "rotation": _axis_angle(pose[:3, :3]),
                "rootRelativeRotation": _axis_angle(root[:3, :3].T @ pose[:3, :3]),
                "localRotation": _axis_angle(parent[:3, :3].T @ pose[:3, :3]),
                "armBaseHeight": float(root[2, 3]),
                "elbowOrientation": 0.0,
            }
        )
        parent = pose
    return {
        "joints": joints,
        "heldObjects": agent.in_hand,
        "pickupableObjects": [name for name in touched if object_type(room.world.type_of(name)).pickupable],
        "touchedNotHeldObjects": touched,
        "handSphereCenter": to_thor(hand),
        "handSphereRadius": float(arm.hand_radius_m),
    }


def _axis_angle(rotation: F64) -> Metadata:
    """Axis (x, y, z) and angle (w, degrees) of a rotation of the room, in AI2-THOR's frame."""
    x, y, z, w = quaternion_of(SWAP @ rotation @ SWAP)
    angle = 2.0 * np.arccos(np.clip(w, -1.0, 1.0))
    sine = np.sin(angle / 2.0)
    axis = np.array([x, y, z]) / sine if sine > 1e-9 else np.array([1.0, 0.0, 0.0])
    return dict(zip("xyzw", [*axis.tolist(), float(np.degrees(angle))], strict=True))
