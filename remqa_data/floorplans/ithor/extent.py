"""How far a room reaches: the recorded floor runs on behind windows, fences and half walls, but nothing is recorded there.

AI2-THOR's floor is a plate that was made larger than its room. Things stand along the walls of a room and hang on them,
so a room ends where its things end; the corners of its plan that lie beyond all things on one side are not part of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.backs import BEFORE_WALLS, ON_WALLS, behind_walls
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.geometry.rectangles import edge_rectangles
from remqa_data.geometry.types import F64, Rect

IN_WALLS = types_with("in_wall")
"""Types whose recorded box reaches into or through the wall."""
BACKED = types_with("has_back")
"""Furniture that stands with its back to a wall when it stands at one."""
WALL_SLACK_M = 0.60
"""A floor that reaches no farther than this behind the last things ends at them, too."""
BARE_M = 0.35
"""A floor that reaches farther ends so far behind the last things, unless they have a wall behind them."""
LAST_M, HIGH_M = 0.25, 1.0
"""Things that end this near to where everything ends say whether a wall is there, as do two cabinets this high up."""
IN_LINE_M = 1.5
"""Furniture that ends in one line over so much of a side stands along a wall."""
STRAY_M = 0.5
"""What is farther than this from the floor is not in the room."""
CELL_M = 0.25
ABREAST_M, PAST_M = 1.5, 0.4
"""What is no farther to the side than the first bounds the floor; the second is how far floor reaches past it."""
AROUND_M, BEFORE_DOORS_M = 0.25, 0.9
"""So much around every thing stays part of the room, and so much around what is opened and where one comes in."""
LEAST_NOTCH_M, LEAST_NOTCH_M2, MOST_NOTCHES = 0.75, 1.5, 6
"""A corner that is missing has sides and an area of at least so much."""
SLIVER_M = 0.1
"""What is left of a piece of wall beside another one and is narrower is left out."""
DOORSIDE = "LightSwitch"
"""Beside this a room has its door, which is not recorded."""


def recorded_extent(objects: Sequence[RecordedObject], floor: RecordedObject) -> tuple[Rect, tuple[Rect, ...]]:
    """Inner faces of a room's outer walls, and the corners between them that are not part of the room, metres."""
    things = [o for o in objects if o is not floor and _is_over(o, floor)]
    west, south, east, north = (_end(things, floor, axis, sign) for axis, sign in ((0, -1), (1, -1), (0, 1), (1, 1)))
    return (west, south, east, north), tuple(_notches(things, floor, (west, south, east, north)))


def _is_over(o: RecordedObject, floor: RecordedObject) -> bool:
    """Whether a thing is over the floor or in the walls around it; a faucet of FloorPlan410 was left at the origin."""
    return bool(np.all(o.high[:2] > floor.low[:2] - STRAY_M) and np.all(o.low[:2] < floor.high[:2] + STRAY_M))


def _end(things: Sequence[RecordedObject], floor: RecordedObject, axis: int, sign: int) -> float:
    edge = sign * float((floor.low if sign < 0 else floor.high)[axis])
    reach = max(sign * _outer_face(o, axis, sign) for o in things)
    last = [o for o in things if reach - sign * _outer_face(o, axis, sign) < LAST_M]
    has_wall = any(_has_wall_behind(o, axis, sign) for o in last)
    has_wall |= sum(o.type == "Cabinet" and o.low[2] > floor.high[2] + HIGH_M for o in last) > 1
    has_wall |= _length([(o.low[1 - axis], o.high[1 - axis]) for o in last if not o.pickupable]) > IN_LINE_M
    return sign * (reach if has_wall or edge - reach <= WALL_SLACK_M else reach + BARE_M)


def _length(spans: Sequence[tuple[float, float]]) -> float:
    """How much of a line some spans of it cover."""
    total, reached = 0.0, -np.inf
    for start, end in sorted(spans):
        total += max(0.0, end - max(start, reached))
        reached = max(reached, end)
    return total


def _outer_face(o: RecordedObject, axis: int, sign: int) -> float:
    """Where a box ends towards a wall; what sits in that wall ends in its middle, and a window at a corner nowhere."""
    size = o.high - o.low
    if o.type in IN_WALLS and size[axis] < max(0.6, size[1 - axis]):
        return float(o.low[axis] + o.high[axis]) / 2 if size[axis] < 0.6 else -sign * np.inf
    return float((o.low if sign < 0 else o.high)[axis])


def _has_wall_behind(o: RecordedObject, axis: int, sign: int) -> bool:
    """Whether something hangs flat on a wall on one side, or stands with its back to it."""
    flat = (o.high - o.low)[axis] < 0.6 * (o.high - o.low)[1 - axis]
    is_backed = o.type in BEFORE_WALLS and float(sign * o.front[axis]) < -0.9
    return is_backed or (o.type in ON_WALLS | BACKED and bool(flat))


def _notches(things: Sequence[RecordedObject], floor: RecordedObject, bounds: Rect) -> list[Rect]:
    """Rectangles in corners of the bounds on which nothing was recorded, and past which nothing was on one side."""
    counts = [max(1, int(np.ceil((bounds[axis + 2] - bounds[axis]) / CELL_M))) for axis in (0, 1)]
    x, y = (bounds[axis] + (np.arange(count) + 0.5) * CELL_M for axis, count in enumerate(counts))
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    low, high = np.array([o.low[:2] for o in things]), np.array([o.high[:2] for o in things])
    inside = _is_bounded(points, low, high)
    inside &= np.all((points > floor.low[:2] - 0.1) & (points < floor.high[:2] + 0.1), axis=-1)
    has_use = [(o.openable and not o.pickupable) or o.type == DOORSIDE for o in things]
    around = np.where(has_use, BEFORE_DOORS_M, AROUND_M)[:, None]
    for corner, opposite in zip(low - around, high + around, strict=True):
        inside |= np.all((points > corner) & (points < opposite), axis=-1)
    behind = behind_walls(things, bounds)
    for rect in behind:
        inside &= ~np.all((points > rect[:2]) & (points < rect[2:]), axis=-1)
    least = round(LEAST_NOTCH_M / CELL_M)
    found = []
    for i0, j0, i1, j1 in edge_rectangles(inside, (least, least), MOST_NOTCHES):
        (x0, x1), (y0, y1) = (
            _drawn_in(start, end, axis, bounds, counts[axis]) for axis, start, end in ((0, i0, i1), (1, j0, j1))
        )
        is_corner = (i0 == 0 or i1 == counts[0]) and (j0 == 0 or j1 == counts[1])  # else it might cut the room in two
        if is_corner and (x1 - x0) * (y1 - y0) >= LEAST_NOTCH_M2:
            found.append((x0, y0, x1, y1))
    return found + [rest for rect in behind for rest in _without(rect, found)]


def _without(rect: Rect, others: Sequence[Rect]) -> list[Rect]:
    """What some rectangles leave of another one."""
    holes = [(x0, y0, -1.0, x1, y1, 1.0) for x0, y0, x1, y1 in others]
    rests = solid_around((rect[0], rect[1], 0.0, rect[2], rect[3], 0.5), holes)
    return [(x0, y0, x1, y1) for x0, y0, _, x1, y1, _ in rests if min(x1 - x0, y1 - y0) > SLIVER_M]


def _drawn_in(start: int, end: int, axis: int, bounds: Rect, count: int) -> tuple[float, float]:
    """Where a range of cells begins and ends; half a cell less where it does not end at a wall."""
    low = bounds[axis] if start == 0 else bounds[axis] + (start + 0.5) * CELL_M
    high = bounds[axis + 2] if end == count else bounds[axis] + (end - 0.5) * CELL_M
    return low, high


def _is_bounded(points: F64, low: F64, high: F64) -> npt.NDArray[np.bool_]:
    """(n, m) whether there are things about abreast of each of (n, m, 2) points that it is not past, on all four sides."""
    is_bounded = np.ones(points.shape[:2], dtype=np.bool_)
    for axis in (0, 1):
        along, across = points[..., axis, None], points[..., 1 - axis, None]
        abreast = (low[:, 1 - axis] < across + ABREAST_M) & (high[:, 1 - axis] > across - ABREAST_M)
        ahead = np.any(abreast & (high[:, axis] + PAST_M >= along), axis=-1)
        behind = np.any(abreast & (low[:, axis] - PAST_M <= along), axis=-1)
        is_bounded &= ahead & behind
    return is_bounded
