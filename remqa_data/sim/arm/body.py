"""What the agent looks like from outside: a round mobile base, a column with a head, and a Kinova Jaco2.

Drawn after photographs and the published dimensions; every part is given in the frame that `robot_poses` puts into the
room. The head is where the camera is and looks where the agent looks; the arm's carriage turns with the column.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from remqa_data.assets.core.fitting import surface, with_uv
from remqa_data.assets.core.model import Material, Surface
from remqa_data.assets.looks.materials import BLACK_PLASTIC, DARK_GLASS, RUBBER, WHITE_PLASTIC, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.postures import BASE_TOP_M, COLUMN_TOP_M, ArmBase, ArmState, foot_poses, link_poses
from remqa_data.sim.navigation.embodiment import AGENT

Drawing = list[tuple[Mesh, Material]]

CARBON = paint("black", "plastic", 0.5, (0.15, 0.155, 0.17))
ALUMINIUM = Material("metal", "gray", (0.72, 0.73, 0.75), gloss=0.5)
ACCENT = paint("blue", "plastic", 0.3, (0.16, 0.45, 0.68))

TUBE_M = 0.036
KNUCKLE_M, KNUCKLE_HALF_M = 0.042, 0.044
"""Radius of the round housings of the joints that bend, and how far they stick out to each side of the tube's middle."""


@lru_cache
def robot_surfaces() -> tuple[tuple[Surface, ...], ...]:
    """Surfaces of each part of the agent: its base, the column, the head, the carriage, the foot and six links."""
    drawings = [_chassis(), _column(), _head(), _carriage(), _foot(), *_links()]
    return tuple(_surfaces(drawing) for drawing in drawings)


def robot_poses(base: ArmBase, state: ArmState, camera_height_m: float) -> F64:
    """(n, 4, 4) poses in the room of the parts of `robot_surfaces`."""
    posture = state.posture()[None]
    links = link_poses(base, posture)[0]
    chassis = base.pose()
    head = chassis.copy()
    head[2, 3] += camera_height_m
    column = replace(base, yaw_deg=base.yaw_deg + state.turn_deg).pose()
    carriage = foot_poses(base, posture)[0]
    return np.stack([chassis, column, head, carriage, *links[: jaco.HAND]])


# ---- the mobile base


def _chassis() -> Drawing:
    body = [
        (0, 0.035),
        (0.175, 0.035),
        (0.19, 0.055),
        (0.19, 0.115),
        (0.178, 0.14),
        (0.15, BASE_TOP_M),
        (0, BASE_TOP_M),
    ]
    stripe = [(0.1905, 0.082), (0.1925, 0.086), (0.1925, 0.094), (0.1905, 0.098)]
    drawing: Drawing = [
        (primitives.revolve(body, 40), WHITE_PLASTIC),
        (primitives.revolve(stripe, 40), ACCENT),
        (primitives.cylinder(0.16, 0.03, sections=32).moved((0, 0, 0.022)), BLACK_PLASTIC),
        (primitives.cylinder(0.062, 0.012, sections=28).moved((0, 0, BASE_TOP_M + 0.006)), BLACK_PLASTIC),
        (primitives.rounded_box((0.02, 0.10, 0.022), 0.008).moved((0.184, 0, 0.125)), DARK_GLASS),
    ]
    for side in (-1, 1):
        wheel = primitives.cylinder(0.045, 0.03, sections=24).pointed("y")
        drawing.append((wheel.moved((0, side * 0.165, 0.045)), RUBBER))
    return drawing


def _column() -> Drawing:
    height = COLUMN_TOP_M - BASE_TOP_M
    middle = BASE_TOP_M + height / 2
    return [
        (primitives.rounded_box((0.07, 0.07, height), 0.012).moved((0, 0, middle)), ALUMINIUM),
        (primitives.box((0.004, 0.026, height - 0.06)).moved((0.0345, 0, middle)), BLACK_PLASTIC),
        (primitives.rounded_box((0.078, 0.078, 0.02), 0.009).moved((0, 0, COLUMN_TOP_M)), BLACK_PLASTIC),
    ]


def _head() -> Drawing:
    drawing: Drawing = [
        (primitives.rounded_box((0.12, 0.19, 0.085), 0.035, 4), WHITE_PLASTIC),
        (primitives.rounded_box((0.02, 0.165, 0.055), 0.009, 3).moved((0.053, 0, 0)), DARK_GLASS),
    ]
    for y in (-0.045, 0.045):
        lens = primitives.cylinder(0.019, 0.012, 0.015, sections=24).pointed("x")
        drawing += [
            (lens.moved((0.066, y, 0)), ALUMINIUM),
            (primitives.disc(0.0125).pointed("x").moved((0.0725, y, 0)), BLACK_PLASTIC),
        ]
    return drawing


def _carriage() -> Drawing:
    length = AGENT.shoulder_ahead_m + 0.05
    return [
        (
            primitives.rounded_box((0.098, 0.098, 0.11), 0.015).moved((-AGENT.shoulder_ahead_m, 0, -0.055)),
            BLACK_PLASTIC,
        ),
        (primitives.rounded_box((length, 0.075, 0.028), 0.012).moved((0.05 - length / 2, 0, -0.014)), BLACK_PLASTIC),
        (primitives.cylinder(0.054, 0.028, sections=28).moved((0, 0, -0.014)), BLACK_PLASTIC),
    ]


# ---- the arm


def _foot() -> Drawing:
    top = jaco.CHAIN[0].origin[2]
    shape = [(0, 0), (0.05, 0), (0.05, 0.012), (0.0425, 0.02), (0.0425, top - 0.008), (0, top - 0.008)]
    return [(primitives.revolve(shape, 28), CARBON), _ring(0.0435, (0, 0, top - 0.004))]


def _links() -> list[Drawing]:
    """Links 1 to 6, each in the frame of its own joint."""
    arm, forearm, wrist = jaco.UPPER_ARM_M, jaco.CHAIN[3].origin[1], jaco.CHAIN[5].origin[1]
    knuckle = 0.9 * KNUCKLE_M
    return [
        [_tube((0, 0, 0), (0, 0, jaco.CHAIN[1].origin[2]), 0.0415), *_near_half(1, KNUCKLE_M)],
        [_far_half(KNUCKLE_M), *_limb((0, 0, 0), (0, -arm, 0), TUBE_M), *_near_half(2, KNUCKLE_M)],
        [
            _far_half(KNUCKLE_M),
            *_limb((0, 0, -0.0057), (0, forearm, -0.0114), 0.033),
            _ring(0.034, (0, forearm - 0.004, -0.0114), "y"),
        ],
        [_tube((0, 0, 0), (0, 0, -wrist), 0.031), *_near_half(4, knuckle)],
        [_far_half(knuckle), _tube((0, 0, 0), (0, wrist, 0), 0.031), _ring(0.033, (0, wrist - 0.004, 0), "y")],
        _hand(),
    ]


def _hand() -> Drawing:
    """A palm that widens from the wrist, and two fingers of two phalanges each; the hand points along -z."""
    palm = [(0, 0), (0.032, 0), (0.034, 0.02), (0.046, 0.06), (0.047, 0.085), (0.036, 0.1), (0, 0.1)]
    drawing: Drawing = [
        (primitives.revolve(palm, 24).scaled((1.0, 0.78, 1.0)).pointed("-z"), CARBON),
        (primitives.rounded_box((0.03, 0.074, 0.03), 0.008).moved((0, 0, -0.05)), ALUMINIUM),
    ]
    for side in (-1, 1):
        bend = [(side * x, 0.0, -z) for x, z in ((0.034, 0.085), (0.05, 0.11), (0.052, 0.135))]
        tip = [(side * x, 0.0, -z) for x, z in ((0.052, 0.132), (0.044, 0.155), (0.028, 0.178))]
        drawing += [
            (primitives.tube(bend, (0.014, 0.0135, 0.0125), 12), CARBON),
            (primitives.tube(tip, (0.0125, 0.011, 0.007), 12), BLACK_PLASTIC),
            (primitives.ellipsoid((0.029, 0.029, 0.029)).moved(bend[-1]), ALUMINIUM),
            (primitives.ellipsoid((0.016, 0.016, 0.016)).moved(tip[-1]), RUBBER),
        ]
    return drawing


def _tube(start: Vec3, end: Vec3, radius: float) -> tuple[Mesh, Material]:
    return primitives.tube([start, end], radius, 24), CARBON


def _limb(start: Vec3, end: Vec3, radius: float) -> Drawing:
    """A tube that is slimmer in the middle."""
    share = np.array([[0.0], [0.2], [0.3], [0.7], [0.8], [1.0]])
    path = np.asarray(start) * (1 - share) + np.asarray(end) * share
    radii = [radius * factor for factor in (1.0, 1.0, 0.9, 0.9, 1.0, 1.0)]
    return [(primitives.tube(path, radii, 24), CARBON)]


def _far_half(radius: float) -> tuple[Mesh, Material]:
    """The half of a bending joint's housing that belongs to the link after it, in that link's frame."""
    return _half_housing(radius), CARBON


def _near_half(link: int, radius: float) -> Drawing:
    """The other half and the ring between them, in the frame of the link before the joint, whose number is given."""
    joint = jaco.CHAIN[link]
    rotation = jaco.rotation_of_rpy(joint.rpy)
    meshes = [(_half_housing(radius).pointed("-z"), CARBON), _ring(1.03 * radius, (0, 0, 0))]
    return [(mesh.turned(rotation).moved(joint.origin), material) for mesh, material in meshes]


def _half_housing(radius: float) -> Mesh:
    h = KNUCKLE_HALF_M * radius / KNUCKLE_M
    return primitives.revolve([(0, 0), (radius, 0), (radius, 0.8 * h), (0.8 * radius, h), (0, h)], 28)


def _ring(radius: float, at: Vec3, axis: primitives.Axis = "z") -> tuple[Mesh, Material]:
    return primitives.cylinder(radius, 0.009, sections=28).pointed(axis).moved(at), ALUMINIUM


def _surfaces(drawing: Drawing) -> tuple[Surface, ...]:
    by_material: dict[Material, list[Mesh]] = {}
    for mesh, material in drawing:
        by_material.setdefault(material, []).append(with_uv(mesh, material, None))
    return tuple(surface(primitives.joined(meshes), material) for material, meshes in by_material.items())
