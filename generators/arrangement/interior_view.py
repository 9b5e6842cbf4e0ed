"""How much of where a thing could lie one sees: what is answered with no or 0 is to be seen, not guessed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.generators.arrangement.areas import Area
from remqa_data.generators.arrangement.hiding_goals import at_height
from remqa_data.generators.arrangement.hiding_rules import hidden_size
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F32, F64, Flags
from remqa_data.sim.navigation.viewpoints import HORIZONS_DEG, AgentPose
from remqa_data.sim.render.camera import Camera, are_outside, scissor_around
from remqa_data.sim.render.view import WorldView

LEAST_SHARE = 0.8
"""Of the ways in which a thing of the asked type could lie there, so many are in view where none is found."""
LEAST_SHOWN = 0.3
"""Who sees so much of a thing's top sees the thing."""
LOOK_M, SURFACE_M = 0.015, 0.01
"""Things are looked for at points so far apart; what is so much nearer than a point hides it."""


def looks_about(goal: AgentPose) -> list[AgentPose]:
    """What who stands at a goal may look at without a step or a turn: standing and crouched, with the camera at any tilt."""
    return [replace(goal, horizon_deg=h, is_standing=s) for s in (True, False) for h in HORIZONS_DEG]


def depth_looks(
    view: WorldView, cameras: Sequence[Camera], interior: Sequence[Area], motion: F64 | None
) -> list[tuple[Camera, F32]]:
    """Those of some cameras that have anything of an interior in their picture, or the first one if none has.

    With each goes its (h, w) depth of the world as it is, of the part of the picture where the interior is.
    """
    if not interior:
        return [(camera, view.depth(camera)) for camera in cameras[:1]]
    around = np.stack([a.corners if motion is None else arithmetic.moved(a.corners, motion[a.link]) for a in interior])
    shown = [c for c in cameras if not are_outside(c.view(), around).all()] or cameras[:1]
    return [(c, view.depth(c, scissor=scissor_around(c.view(), around.reshape(-1, 3)))) for c in shown]


def share_in_view(
    interior: Sequence[Area],
    motion: F64 | None,
    looks: Sequence[tuple[Camera, F32]],
    revealed: Sequence[F64],
    type_: str,
) -> float:
    """Share of the ways in which a thing of a type could lie in a place that looking about shows, 0 to 1.

    It could lie wherever its box fits into the interior beside what lies there, along a side or across it, and would be
    seen if enough of its top is in view. What fits nowhere is nowhere: then the share is 1.

    Parameters
    ----------
    interior : sequence of Area
        Where anything could lie.
    motion : (links, 4, 4) array, optional
        How that has moved with what was opened.
    looks : sequence of (Camera, (h, w) array)
        Depth images of who looks about, with their cameras; those that show nothing of it may be missing.
    revealed : sequence of (2, 3) array
        Boxes of what lies there.
    type_ : str
        Of the thing.
    """
    width, depth, height = hidden_size(type_)
    ways, seen = 0, 0
    for area in interior:
        lattice = area.lattice(LOOK_M)
        points = area.to_room(at_height(lattice.reshape(-1, 2), min(height, area.height_m)))
        if motion is not None:
            points = arithmetic.moved(points, motion[area.link])
        shape = lattice.shape[:2]
        is_free = ~_is_taken(points, height, revealed).reshape(shape)
        shown = np.zeros(len(points), dtype=np.bool_)
        for camera, image in looks:
            rest = np.flatnonzero(~shown)
            shown[rest] = _is_seen(points[rest], camera, image)
        is_seen = shown.reshape(shape)
        pitch = [2 * half / max(n - 1, 1) for half, n in zip(area.half, shape, strict=True)]
        for sides in ((width, depth), (depth, width)):
            window = [round(side / step) + 1 for side, step in zip(sides, pitch, strict=True)]
            if window[0] <= shape[0] and window[1] <= shape[1]:
                fits = _window_means(is_free, window) == 1.0
                ways += int(np.count_nonzero(fits))
                seen += int(np.count_nonzero(fits & (_window_means(is_seen, window) >= LEAST_SHOWN)))
    return seen / ways if ways else 1.0


def _is_taken(tops: F64, height: float, boxes: Sequence[F64]) -> Flags:
    """(n,) whether one of some boxes is where a thing of a height would be that has its top at a point."""
    taken = np.zeros(len(tops), dtype=np.bool_)
    for low, high in boxes:
        level = (tops[:, 2] > low[2]) & (tops[:, 2] - height < high[2])
        taken |= level & ((tops[:, :2] > low[:2]) & (tops[:, :2] < high[:2])).all(axis=1)
    return taken


def _is_seen(points: F64, camera: Camera, depth: F32) -> Flags:
    """(n,) whether a depth image shows points and nothing in front of them."""
    projected = camera.project(points)
    is_ahead = camera.are_framed(projected)
    x, y, z = projected.T
    row, column = np.where(is_ahead, y, 0).astype(int), np.where(is_ahead, x, 0).astype(int)
    return np.asarray(is_ahead & (depth[row, column] > z - SURFACE_M))


def _window_means(mask: Flags, window: Sequence[int]) -> F64:
    """Mean of every window of so many rows and columns of a (rows, columns) mask."""
    rows, columns = window
    up_to = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1), dtype=np.int64)
    up_to[1:, 1:] = mask.cumsum(axis=0).cumsum(axis=1)
    total = up_to[rows:, columns:] - up_to[:-rows, columns:] - up_to[rows:, :-columns] + up_to[:-rows, :-columns]
    return np.asarray(total / (rows * columns))
