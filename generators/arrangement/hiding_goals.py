"""From where the agent acts on a hiding place: poses that reach it, and what they see of it before and after."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.generators.arrangement.areas import Area, largest_rectangle
from remqa_data.generators.arrangement.hiding_rules import HidingRules
from remqa_data.generators.arrangement.sightlines import Sightlines
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.geometry.types import F32, F64, Flags
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Outline, nearest_cells_in_reach, outline_distance
from remqa_data.sim.navigation.viewpoints import AgentPose, facing_poses

Depths = Mapping[AgentPose, F32]

AROUND_M = (0.3, 3.0)
AROUND_POSES = 16
"""From about so many cells in this range around a thing one must not see what it hides."""
IN_IMAGE = 0.5
"""A pose looks at a place when this share of its points is in the image."""
FRONT_DEG = 60.0
"""Who stands farther round than this does not stand before the front of a thing."""


@dataclass(frozen=True)
class Front:
    """Where the front of a thing looks: from its middle in the plan, metres, in degrees counter-clockwise from +x."""

    middle: tuple[float, float]
    facing_deg: float

    def faces(self, position: tuple[float, float]) -> bool:
        """Whether somebody at a position stands before it."""
        dx, dy = position[0] - self.middle[0], position[1] - self.middle[1]
        bearing = math.degrees(arithmetic.arctan2(dy, dx))
        return degrees_apart(bearing, self.facing_deg) <= FRONT_DEG


@dataclass(frozen=True)
class GoalPose:
    """A pose from which the agent acts on a place, and what it sees of it afterwards.

    Attributes
    ----------
    pose : AgentPose
        Where it stands and looks.
    parts : tuple of Area
        The rectangles of which all is hidden before and seen after.
    shares : tuple of float
        For each height of sight, the share of all areas that is seen after, and was hidden before.
    """

    pose: AgentPose
    parts: tuple[Area, ...]
    shares: tuple[float, ...]


def poses_that_reach(
    sight: Sightlines,
    points: F64,
    areas: Sequence[Area],
    count: int,
    outlines: Sequence[Outline] = (),
    front: Front | None = None,
) -> list[AgentPose]:
    """Poses from which the arm reaches one of some points and that look towards them and some areas, nearest first.

    At none of them does anything with one of some outlines meet the agent, and all of them are before a front, if there
    is one.
    """
    middles = np.array([area.centre for area in areas])
    target = 0.5 * points.mean(axis=0) + 0.5 * middles.mean(axis=0)
    found: list[AgentPose] = []
    cells = [
        cell
        for cell in nearest_cells_in_reach(sight.grid, points, AGENT.reach_m)
        if outline_distance(outlines, sight.grid.position(cell)) > AGENT.radius_m
        and (front is None or front.faces(sight.grid.position(cell)))
    ]
    for pose in facing_poses(sight.grid, cells, target):
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y, z = sight.camera(pose).project(np.vstack([points, middles])).T
        inside = (z > 0.05) & (x > 0) & (x < sight.size_px) & (y > 0) & (y < sight.size_px)
        if np.mean(inside) >= IN_IMAGE:
            found.append(pose)
        if len(found) == count:
            break
    return found


def best_goals(
    sight: Sightlines,
    rules: HidingRules,
    areas: Sequence[Area],
    before: Depths,
    after: Depths,
    motion: F64,
) -> list[GoalPose]:
    """The poses that see something of some areas, the best first.

    First come those that see enough even of what is flat, then those that see enough of what is higher, and of these those
    to which things look largest, and which see most.

    Parameters
    ----------
    sight : Sightlines
        Knows the cameras.
    rules : HidingRules
        Thresholds.
    areas : sequence of Area
        Where hidden things might lie.
    before, after : mapping of AgentPose to (h, w) array
        Depth before and after the manipulation. Poses are those of `after`.
    motion : (links, 4, 4) array
        How the manipulation moves what lies on each link.
    """
    probes = [_probe(rules, area, motion[area.link]) for area in areas]
    ranked: list[tuple[int, float, GoalPose]] = []
    for pose in after:
        seen = _seen(sight, pose, probes, before[pose], after[pose])
        parts = tuple(_parts(rules, areas, seen))
        if not parts:
            continue
        points = sum(masks[0].size for masks in seen)
        levels = range(len(rules.sight_heights_m))
        shares = tuple(sum(int(masks[min(i, len(masks) - 1)].sum()) for masks in seen) / points for i in levels)
        rank = next((i for i in levels if shares[i] >= rules.min_share_seen), len(levels))
        clear = _clearness(sight, pose, parts, motion)
        share = max(shares) if rank == len(levels) else shares[rank]
        worth = share * share * clear
        ranked.append((rank, -worth, GoalPose(pose, parts, shares)))
    return [goal for _, _, goal in sorted(ranked, key=lambda entry: (entry[:2], entry[2].pose))]


def _clearness(sight: Sightlines, pose: AgentPose, parts: Sequence[Area], motion: F64) -> float:
    """How large low things look that lie on some areas, and how near to the middle of the image they are, on average.

    A small face at distance r fills a solid angle of its area times cos(a) / r^2, where a is the angle to its normal; low
    things show their top and about half as much of a side. At the edges of an image things take more pixels, and are
    stretched: the cosine of the angle to the camera's axis is a factor.
    """
    camera = sight.camera(pose)
    points = np.concatenate(
        [arithmetic.moved(a.to_room(at_height(a.lattice(0.1).reshape(-1, 2), 0.01)), motion[a.link]) for a in parts]
    )
    away = points - np.asarray(camera.position)
    distance, depth = arithmetic.length(away), np.maximum(camera.project(points)[:, 2], 0.0)
    face = np.maximum(-away[:, 2], 0.0) + 0.5 * arithmetic.length(away[:, :2])
    return float(np.mean(face * depth / distance**4))


def out_of_sight(sight: Sightlines, rules: HidingRules, area: Area) -> Area | None:
    """The largest part of an area that one sees from nowhere around, standing or crouched, up to the area's height.

    Not between legs, nor below a rim or a seat. The world is looked at as it is.
    """
    grid = sight.grid
    x, y, _ = area.centre
    near = [c for c in grid.cells if AROUND_M[0] <= math.dist(grid.position(c), (x, y)) <= AROUND_M[1]]
    lattice = area.lattice(rules.pitch_m)
    flat = lattice.reshape(-1, 2)
    levels = [area.to_room(at_height(flat, share * area.height_m)) for share in (0.1, 0.5, 0.9)]
    hidden = np.ones(len(flat), dtype=np.bool_)
    for cell in near[:: max(1, len(near) // AROUND_POSES)]:
        for is_standing in (True, False):
            pose = next(facing_poses(grid, [cell], np.array(area.centre), is_standing=is_standing))
            depth = sight.depth(pose, area.corners)
            for points in levels:
                hidden &= sight.hides(pose, depth, points)
    return _largest_part(rules, area, hidden.reshape(lattice.shape[:2]))


def at_height(flat: F64, height_m: float) -> F64:
    """(n, 3) points above (n, 2) points of an area."""
    return np.column_stack([flat, np.full(len(flat), height_m)])


@dataclass(frozen=True, eq=False)
class _Probe:
    """The points of an area at which is looked.

    Attributes
    ----------
    shape : tuple of int
        Of the area's lattice.
    closed : (k, n, 3) array
        Its points in the room at k heights, while everything is closed.
    opened : (heights, n, 3) array
        Those at the heights of sight, where the manipulation takes them.
    """

    shape: tuple[int, ...]
    closed: F64
    opened: F64


def _probe(rules: HidingRules, area: Area, motion: F64) -> _Probe:
    lattice = area.lattice(rules.pitch_m)
    flat = lattice.reshape(-1, 2)
    heights = [h for h in rules.sight_heights_m if h <= 0.8 * area.height_m] or [0.5 * area.height_m]
    levels = [at_height(flat, height) for height in (*heights, 0.9 * area.height_m)]
    closed = area.to_room(np.concatenate(levels)).reshape(len(levels), -1, 3)
    return _Probe(lattice.shape[:2], closed, arithmetic.moved(closed[:-1], motion))


def _seen(sight: Sightlines, pose: AgentPose, probes: Sequence[_Probe], before: F32, after: F32) -> list[list[Flags]]:
    """For each area and height of sight: the lattice points that are seen after, and hidden at all heights before."""
    hidden = sight.hides(pose, before, np.concatenate([probe.closed.reshape(-1, 3) for probe in probes]))
    seen = sight.sees(pose, after, np.concatenate([probe.opened.reshape(-1, 3) for probe in probes]))
    found = []
    for probe in probes:
        levels, points = probe.closed.shape[:2]
        is_hidden = hidden[: levels * points].reshape(levels, points).all(axis=0)
        is_seen = seen[: (levels - 1) * points].reshape(levels - 1, points)
        found.append([mask.reshape(probe.shape) for mask in is_hidden & is_seen])
        hidden, seen = hidden[levels * points :], seen[(levels - 1) * points :]
    return found


def _parts(rules: HidingRules, areas: Sequence[Area], seen: Sequence[Sequence[Flags]]) -> list[Area]:
    """The largest rectangle of each area that is seen, from the lowest height from which enough is."""
    parts = []
    for area, masks in zip(areas, seen, strict=True):
        for level, mask in enumerate(masks):
            part = _largest_part(rules, area, mask, rules.sight_heights_m[level] if level else 0.0)
            if part is not None:
                parts.append(part)
                break
    return parts


def _largest_part(rules: HidingRules, area: Area, mask: Flags, seen_from_m: float = 0.0) -> Area | None:
    """The largest rectangle of true lattice points, if it is large enough for anything."""
    found = largest_rectangle(mask)
    if found is None:
        return None
    lattice = area.lattice(rules.pitch_m)
    low, high = lattice[found[0], found[1]], lattice[found[2], found[3]]
    is_enough = np.all(high - low >= rules.min_area_side_m - 1e-9)
    return area.part(low, high, seen_from_m) if is_enough else None
