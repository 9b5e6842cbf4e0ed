"""From which poses an object should be seen and reached, by what the agent remembers of the room."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.catalog import types_with
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.geometry.types import F64, Flags
from remqa_data.mapping.semantic_map import UNKNOWN
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose, facing_poses
from remqa_data.sim.render.camera import Camera

FRONT_DEG = 60.0
"""Who stands farther round than this does not stand before the front of a thing."""
OPENS_FORWARD = types_with("opens_forward")
SLIDES_OUT = types_with("slides_out")
"""What opens into the room; of that, what slides out. All else has doors."""
SLIDE_SHARE = 0.9
"""How far it slides, as a share of its depth."""
TWO_DOORS_M = 0.9
"""What is so wide has two doors."""
MOST_POINTS = 96
"""Points of an object that are looked for; more tell nothing new."""
FEWEST_VOXELS = 4
"""An object of which the map has fewer is looked for in all of its box."""
FREE_M = 0.12
"""So near to a point nothing is looked for that hides it: the map is no finer, and neighbours touch."""
ALONG_M = 0.04
"""Rays are looked along in such steps, a little less than a voxel."""


@dataclass(frozen=True)
class Outlook:
    """A pose, and how well an object should be seen from there.

    Attributes
    ----------
    pose : AgentPose
    share : float
        Of the object's remembered surface that is in the image and not hidden, 0 to 1.
    """

    pose: AgentPose
    share: float


def points_of(instance: Instance, memory: WalkMemory) -> F64:
    """(n, 3) points of an object's remembered surface, metres: middles of voxels with its label in its box."""
    low, high = np.array(instance.box[:3]), np.array(instance.box[3:])
    half = memory.plan.voxel_m / 2
    found = np.empty((0, 3))
    if instance.type in memory.plan.names:
        voxels = np.argwhere(memory.labels == memory.plan.names.index(instance.type))
        middles = memory.corner_of(voxels + 0.5)
        found = middles[np.all((middles >= low - half) & (middles <= high + half), axis=1)]
    if len(found) < FEWEST_VOXELS:
        steps = [np.linspace(a, b, 4) for a, b in zip(low, high, strict=True)]
        found = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    return found[:: math.ceil(len(found) / MOST_POINTS)]


def frontality(instance: Instance, position: tuple[float, float]) -> float:
    """How squarely somebody at a position stands before the front of an object: the cosine of how far round, at most 1.

    0 for who stands farther round than `FRONT_DEG`; 1 everywhere if the object has no front.
    """
    if instance.facing_deg is None:
        return 1.0
    x, y, _ = instance.centre.tolist()
    bearing = math.degrees(math.atan2(position[1] - y, position[0] - x))
    round_deg = float(degrees_apart(bearing, instance.facing_deg))
    return math.cos(math.radians(round_deg)) if round_deg <= FRONT_DEG else 0.0


def is_in_the_way(instance: Instance, position: tuple[float, float], radius_m: float) -> bool:
    """Whether a drawer that slides out, or a door hinged on either side, may meet somebody of a radius at a position."""
    if instance.type not in OPENS_FORWARD or instance.facing_deg is None:
        return False
    ahead = np.array([math.cos(math.radians(instance.facing_deg)), math.sin(math.radians(instance.facing_deg))])
    low, high = np.array(instance.box[:2]), np.array(instance.box[3:5])
    depth, width = float(np.abs(ahead) @ (high - low)), float(np.abs(ahead[::-1]) @ (high - low))
    door = width / 2 if width >= TWO_DOORS_M else width
    way = ahead * (SLIDE_SHARE * depth if instance.type in SLIDES_OUT else door)
    low, high = low + np.minimum(way, 0.0), high + np.maximum(way, 0.0)
    nearest = np.clip(position, low, high)
    return math.dist(position, nearest.tolist()) <= radius_m


def outlooks(instance: Instance, memory: WalkMemory, grid: ReachableGrid, cells: Iterable[Cell]) -> list[Outlook]:
    """For each cell the poses that look towards an object, two headings by two horizons, and what they should see of it."""
    points, hiding = points_of(instance, memory), hiding_voxels(instance, memory)
    return [
        Outlook(pose, float(in_view(pose.camera(grid), points, memory, hiding).mean()))
        for pose in facing_poses(grid, cells, points.mean(axis=0))
    ]


def in_view(camera: Camera, points: F64, memory: WalkMemory, hiding: Flags) -> Flags:
    """(n,) which of (n, 3) points are in a camera's image, with none of the voxels that hide them before them."""
    with np.errstate(divide="ignore", invalid="ignore"):  # points beside the camera have depth 0
        is_seen = camera.are_framed(camera.project(points))
    is_seen[is_seen] = _is_in_sight(np.array(camera.position), points[is_seen], memory, hiding)
    return is_seen


def hiding_voxels(instance: Instance, memory: WalkMemory) -> Flags:
    """(nx, ny, nz) which voxels may hide an object: all that something was seen in, but for those of its label."""
    is_solid = memory.labels != UNKNOWN
    if instance.type in memory.plan.names:
        is_solid &= memory.labels != memory.plan.names.index(instance.type)
    return np.asarray(is_solid)


def _is_in_sight(eye: F64, points: F64, memory: WalkMemory, hiding: Flags) -> Flags:
    """(n,) whether none of the voxels that hide lies between the eye and each of (n, 3) points."""
    way = points - eye
    far = np.sqrt((way**2).sum(axis=1))
    steps = np.arange(ALONG_M, max(float(far.max(initial=0.0)), ALONG_M), ALONG_M)
    along = eye + way[:, None] * (steps[None, :, None] / np.maximum(far, 1e-9)[:, None, None])
    is_hit = memory.at(hiding, along) & (steps[None] < (far - FREE_M)[:, None])
    return np.asarray(~is_hit.any(axis=1))
