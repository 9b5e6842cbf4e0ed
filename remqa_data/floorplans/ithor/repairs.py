"""Recorded boxes that cannot be taken as they are, mended before anything is made of them.

Corner windows were recorded with the box of the whole corner, some boards with no thickness, round things with an
oriented box that is too loose, and shelves in furniture with the room above their board, which reaches through the top.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.floorplans.ithor.extent import IN_WALLS
from remqa_data.floorplans.ithor.plan import HOSTS
from remqa_data.floorplans.ithor.table import RecordedObject, axes_facing
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

CORNER_M, IN_WALL_DEPTH_M = 0.6, 0.15
"""What is in a wall and wider than the first both ways goes round a corner; it is drawn in to the second."""
FLAT_M, BOARD_M = 0.0035, 0.02
"""Furniture recorded thinner than the first gets the second."""
LOOSE_FIT = 0.06
"""An oriented box that is this much larger than the recorded axis-aligned one holds something round."""
TOP_BOARD_M = 0.025
"""A shelf in a piece of furniture ends this far below the furniture's top."""
TOPMOST_M = 0.10
"""A shelf that begins no deeper than this below the furniture's top is the top itself and stays."""


def repaired(objects: Sequence[RecordedObject]) -> list[RecordedObject]:
    """The same objects with boxes that can be drawn."""
    return [_upright(_under_the_top(_thick_enough(_flat_on_wall(o)), objects)) for o in objects]


def at_floor_level(floor: RecordedObject, floor_z: float) -> RecordedObject:
    """The floor with its surface where things stand; in some rooms its recorded box ends a little above or below."""
    low, high = floor.low.copy(), floor.high.copy()
    high[2] = floor_z
    low[2] = min(low[2], floor_z - 0.05)
    return with_corners(floor, low, high)


def with_corners(o: RecordedObject, low: F64, high: F64) -> RecordedObject:
    """An object that is turned by quarters, with another box in the room."""
    return replace(
        o, low=low, high=high, centre=(low + high) / 2, size=arithmetic.turned_back(high - low, np.abs(o.rotation))
    )


def _flat_on_wall(o: RecordedObject) -> RecordedObject:
    """A corner window, drawn in to the wall that it faces from."""
    axis = int(np.abs(o.front).argmax())
    if o.type not in IN_WALLS or (o.high - o.low)[:2].min() <= CORNER_M or abs(o.front[axis]) <= 0.9:
        return o
    low, high = o.low.copy(), o.high.copy()
    if o.front[axis] > 0:
        high[axis] = low[axis] + IN_WALL_DEPTH_M
    else:
        low[axis] = high[axis] - IN_WALL_DEPTH_M
    return with_corners(o, low, high)


def _thick_enough(o: RecordedObject) -> RecordedObject:
    """A board of no thickness, which is six worktops and two shelves, made thicker; downwards, as things rest on it."""
    extent = o.high - o.low
    if o.pickupable or extent.min() >= FLAT_M:
        return o
    growth = np.where(extent < FLAT_M, BOARD_M - extent, 0.0)
    return with_corners(o, o.low - growth * [0.5, 0.5, 1.0], o.high + growth * [0.5, 0.5, 0.0])


def _under_the_top(shelf: RecordedObject, objects: Sequence[RecordedObject]) -> RecordedObject:
    """A shelf inside a piece of furniture, ending under the furniture's top and under the next shelf above it."""
    if shelf.type != "Shelf":
        return shelf
    begins = np.append((shelf.low + shelf.high)[:2] / 2, shelf.low[2])
    hosts = [h for h in objects if h.type in HOSTS and np.all(begins > h.low) and np.all(begins < h.high)]
    host = min(hosts, key=lambda h: float(np.prod(h.high - h.low)), default=None)
    if host is None or shelf.high[2] <= host.high[2] or shelf.low[2] > host.high[2] - TOPMOST_M:
        return shelf
    high = shelf.high.copy()
    high[2] = min([host.high[2] - TOP_BOARD_M, *(o.low[2] for o in objects if _is_next_above(o, shelf))])
    return with_corners(shelf, shelf.low, high)


def _is_next_above(other: RecordedObject, shelf: RecordedObject) -> bool:
    """Whether another shelf begins over a shelf, clearly higher."""
    middle = (other.low + other.high)[:2] / 2
    over = np.all(middle > shelf.low[:2]) and np.all(middle < shelf.high[:2])
    return bool(other.type == "Shelf" and over and other.low[2] > shelf.low[2] + 0.05)


def _upright(o: RecordedObject) -> RecordedObject:
    """Round things lie as their axis-aligned box says, because their oriented box is loose."""
    if not o.is_oriented:
        return o
    recorded = o.high - o.low
    spanned = arithmetic.turned(o.size, np.abs(o.rotation))
    if np.max(np.abs(spanned - recorded) / np.maximum(recorded, 0.02)) < LOOSE_FIT:
        return o
    front = o.front * [1, 1, 0]
    axis = int(np.abs(front).argmax())
    quarter = np.zeros(3)
    quarter[axis] = np.sign(front[axis]) or 1.0
    return with_corners(replace(o, rotation=axes_facing(quarter)), o.low, o.high)
