"""Whether anything of what is hidden shows from anywhere in the room, standing or crouched, before it is brought to light."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, I64, Flags, Vec3
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import FRAME_PX
from remqa_data.sim.render.camera import Windows
from remqa_data.sim.render.view import WorldView

MOST_PIXELS = 3
"""Of what is hidden so many may show in the middle of a 300 x 300 image; at its edges they are up to three times as many."""
MARGIN_M = 0.02
NEAREST_M = 0.15
FAR = 3.0
"""Farther than so many radii of a ball around all of them one looks at all at once."""


def most_pixels_anywhere(
    view: WorldView,
    grid: ReachableGrid,
    object_ids: Sequence[str],
    hidden_by: Sequence[str] = (),
    limit: int = MOST_PIXELS,
) -> int:
    """The most pixels that one of some objects shows to an agent on any cell that looks straight at them.

    Parameters
    ----------
    view : WorldView
        The room as it is.
    grid : ReachableGrid
        Where the agent can stand.
    object_ids : sequence of str
        Objects that lie near to one another, as in one drawer.
    hidden_by : sequence of str
        What hides them. Where that alone hides them, nothing else is drawn, which is several times quicker.
    limit : int
        More pixels are too many, and one looks no further.

    Returns
    -------
    Pixels of images as sharp as the agent's of 300 x 300 in their middle; 0 if none of the objects shows at all. Up to
    the limit, those that show past what hides the objects, and past all else those are fewer; beyond, the first that
    are found.
    """
    world = view.world
    boxes = {object_id: world.box(object_id) for object_id in object_ids}
    low = np.min([box[0] for box in boxes.values()], axis=0)
    high = np.max([box[1] for box in boxes.values()], axis=0)
    index = {object_id: world.ids.index(object_id) for object_id in object_ids}
    looks = _looks(
        grid,
        _Target(*_ball(low, high), list(index.values())),
        [_Target(*_ball(*box), [index[object_id]]) for object_id, box in boxes.items()],
    )
    hiding = view.parts_of((*hidden_by, *object_ids)) if hidden_by else None
    most = _most(view, looks, hiding)
    if hiding is not None:
        for i in np.flatnonzero(most > limit).tolist():
            most[i] = _most(view, looks[i : i + 1])[0]
            if most[i] > limit:
                break
    too_many = np.flatnonzero(most > limit)
    return int(most[: too_many[0] + 1].max() if len(too_many) else most.max(initial=0))


class _Target(NamedTuple):
    """A ball around objects, and which these are."""

    middle: Vec3
    radius: float
    objects: list[int]


class _Look(NamedTuple):
    """From where one looks straight at what."""

    eye: Vec3
    target: _Target
    half_px: int


def _looks(grid: ReachableGrid, together: _Target, apart: Sequence[_Target]) -> list[_Look]:
    """From each cell, standing and crouched: at all at once from afar, and at one after the other from near by."""
    looks = []
    for cell in grid.cells:
        px, py = grid.position(cell)
        for height in (AGENT.camera_height_m, AGENT.crouched_camera_height_m):
            eye = (px, py, grid.floor_z + height)
            for target in [together] if math.dist(eye, together.middle) > FAR * together.radius else apart:
                away = max(math.dist(eye, target.middle) - target.radius, NEAREST_M)
                half_px = min(math.ceil(FRAME_PX / 2 * target.radius / away), FRAME_PX // 2)
                looks.append(_Look(eye, target, half_px))
    return looks


def _most(view: WorldView, looks: Sequence[_Look], only: Flags | None = None) -> I64:
    """(looks,) the most pixels that one of the objects shows that are looked at, in the middle of the agent's picture."""
    eyes = np.array([look.eye for look in looks]).reshape(-1, 3)
    targets = np.array([look.target.middle for look in looks]).reshape(-1, 3)
    side = np.array([2 * look.half_px for look in looks], dtype=np.int64)
    counts = view.pixels_in_windows(Windows.looking_at(eyes, targets, side, FRAME_PX / 2), only)
    return np.array([counts[i, look.target.objects].max() for i, look in enumerate(looks)], dtype=np.int64)


def _ball(low: F64, high: F64) -> tuple[Vec3, float]:
    """Middle and radius of a ball around a box."""
    x, y, z = (float(v) for v in (low + high) / 2)
    return (x, y, z), float(arithmetic.length(high - low)) / 2 + MARGIN_M
