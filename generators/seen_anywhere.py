"""Whether anything of what is hidden shows from anywhere in the room, standing or crouched, before it is brought to light."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import FRAME_PX, pixels_per_object
from remqa_data.sim.render.camera import Camera
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
    the limit, those that show past what hides the objects, and past all else those are fewer; beyond, as soon as so
    many are found.
    """
    world = view.world
    boxes = {object_id: world.box(object_id) for object_id in object_ids}
    low = np.min([box[0] for box in boxes.values()], axis=0)
    high = np.max([box[1] for box in boxes.values()], axis=0)
    index = {object_id: world.ids.index(object_id) for object_id in object_ids}
    together = (_ball(low, high), list(index.values()))
    apart = [(_ball(*box), [index[object_id]]) for object_id, box in boxes.items()]
    hiding = view.parts_of((*hidden_by, *object_ids)) if hidden_by else None
    most = 0
    for cell in grid.cells:
        px, py = grid.position(cell)
        for height in (AGENT.camera_height_m, AGENT.crouched_camera_height_m):
            eye = (px, py, grid.floor_z + height)
            ball = together[0]
            for (middle, radius), shown in [together] if math.dist(eye, ball[0]) > FAR * ball[1] else apart:
                half_px = math.ceil(FRAME_PX / 2 * radius / max(math.dist(eye, middle) - radius, NEAREST_M))
                window = _window(eye, middle, min(half_px, FRAME_PX // 2))
                pixels = int(pixels_per_object(view, window, hiding)[shown].max())
                if pixels > limit and hiding is not None:
                    pixels = int(pixels_per_object(view, window)[shown].max())
                most = max(most, pixels)
            if most > limit:
                return most
    return most


def _ball(low: F64, high: F64) -> tuple[Vec3, float]:
    """Middle and radius of a ball around a box."""
    x, y, z = (float(v) for v in (low + high) / 2)
    return (x, y, z), float(arithmetic.length(high - low)) / 2 + MARGIN_M


def _window(eye: Vec3, target: Vec3, half_px: int) -> Camera:
    """The middle of what the agent's camera shows, looking straight at a point."""
    half_deg = math.degrees(arithmetic.arctan2(half_px, FRAME_PX / 2))
    return Camera.look_at(eye, target, fov_deg=2 * half_deg, width=2 * half_px, height=2 * half_px)
