"""What lies behind things that hang on walls or stand with their backs to one: no floor, if nothing was recorded there.

In the middle of a plate, a mirror or a fridge is all that the recording tells of an inner wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.geometry.types import Rect

ON_WALLS = types_with("on_wall")
"""Types that hang on a wall: their back is the wall."""
BEFORE_WALLS = types_with("back_is_no_sight")
"""Furniture whose back is no sight: there is a wall behind it."""
FACES_AWAY = types_with("faces_away")
"""Types whose recorded front is away from their wall; paintings, mirrors and windows were made facing either way."""
FLAT = 0.6
"""What is thinner than so many times its width lies along its wall."""
ASIDE_M = 0.15
"""A wall goes on so far beside what hangs on it."""
IN_LINE_M, BETWEEN_M = 0.25, 1.5
"""Things whose backs lie in one line, and no farther apart than this, have one wall."""
CORNER_M = 1.0
"""A wall goes on to a corner of the room that is nearer than this."""
TOUCH_M = 0.2
"""What reaches no farther behind a wall than this stands before it, or in it."""
NEARER = 0.5
"""Where there is nothing on either side, the room ends on the one that is so many times shallower."""
LEAST_M, LEAST_DEPTH_M = 0.5, 0.3
"""A piece of wall is at least so wide, and there is at least so much floor behind it to be taken away."""


@dataclass(frozen=True)
class _Back:
    """A piece of wall: at `at` along `axis`, from `start` to `end` across it; what is behind it lies towards `sign`."""

    axis: int
    sign: int
    at: float
    start: float
    end: float

    def behind(self, bounds: Rect) -> Rect:
        """The floor behind it, as far as the bounds of the room."""
        end = bounds[self.axis] if self.sign < 0 else bounds[self.axis + 2]
        along, across = sorted((self.at, end)), (self.start, self.end)
        low, high = ((along[k], across[k]) if self.axis == 0 else (across[k], along[k]) for k in (0, 1))
        return (*low, *high)

    def depth(self, bounds: Rect) -> float:
        """How far it is from there to the bound behind it."""
        return abs(self.at - bounds[self.axis if self.sign < 0 else self.axis + 2])


def behind_walls(things: Sequence[RecordedObject], bounds: Rect) -> list[Rect]:
    """Rectangles of the bounds that lie behind pieces of wall, empty of things, metres.

    None in a bathroom, where things hang on the glass of showers.
    """
    if any(o.room == "bathroom" for o in things):
        return []
    told = [back for o in things if o.type in FACES_AWAY for back in _backs(o)]
    found: list[_Back] = []
    for o in things:
        backs = [back for back in _backs(o) if _is_empty(back, things, bounds)]
        backs = sorted(backs, key=lambda back: back.depth(bounds))
        is_plain = len(backs) == 1 or (len(backs) == 2 and backs[0].depth(bounds) < NEARER * backs[1].depth(bounds))
        if is_plain and not any(_is_other_face(other, backs[0]) for other in told):
            found.append(backs[0])
    pieces = [_to_corners(piece, things, bounds) for piece in _joined(found, things, bounds)]
    pieces = [_beside(piece, things, bounds) for piece in pieces]
    return [p.behind(bounds) for p in pieces if p.end - p.start >= LEAST_M and p.depth(bounds) >= LEAST_DEPTH_M]


def _backs(o: RecordedObject) -> list[_Back]:
    """The walls that a thing may have behind it: one that is told, or either along its long side."""
    size = o.high - o.low
    if o.pickupable:
        return []
    if o.type in FACES_AWAY:
        axis = int(np.abs(o.front[:2]).argmax())
        signs = [-1 if o.front[axis] > 0 else 1] if abs(o.front[axis]) > 0.9 else []
    elif o.type in ON_WALLS | BEFORE_WALLS:
        axis = int(size[0] > size[1])
        signs = [-1, 1] if size[axis] < FLAT * size[1 - axis] else []
    else:
        return []
    start, end = float(o.low[1 - axis]) - ASIDE_M, float(o.high[1 - axis]) + ASIDE_M
    return [_Back(axis, sign, float((o.low if sign < 0 else o.high)[axis]), start, end) for sign in signs]


def _is_empty(back: _Back, things: Sequence[RecordedObject], bounds: Rect) -> bool:
    """Whether nothing stands or hangs behind a wall, but for what reaches a little into it."""
    low, high = np.array(back.behind(bounds)).reshape(2, 2)
    if back.sign < 0:
        high[back.axis] -= TOUCH_M
    else:
        low[back.axis] += TOUCH_M
    low[1 - back.axis] += ASIDE_M
    high[1 - back.axis] -= ASIDE_M
    return not any(np.all(o.high[:2] > low) and np.all(o.low[:2] < high) for o in things)


def _is_other_face(other: _Back, back: _Back) -> bool:
    """Whether one piece of wall has the room on the side on which the other one has none."""
    is_beside = other.start < back.end + BETWEEN_M and back.start < other.end + BETWEEN_M
    faces_other_way = other.axis == back.axis and other.sign == -back.sign
    return is_beside and faces_other_way and abs(other.at - back.at) < IN_LINE_M


def _joined(backs: Sequence[_Back], things: Sequence[RecordedObject], bounds: Rect) -> list[_Back]:
    """Pieces in one line put together, where what lies between them is empty, too."""
    joined: list[_Back] = []
    for back in sorted(backs, key=lambda b: (b.axis, b.sign, b.start)):
        for k, other in enumerate(joined):
            is_near = (back.axis, back.sign) == (other.axis, other.sign) and abs(back.at - other.at) < IN_LINE_M
            at = (min if back.sign < 0 else max)(back.at, other.at)
            both = replace(other, at=at, start=min(other.start, back.start), end=max(other.end, back.end))
            if is_near and back.start - other.end < BETWEEN_M and _is_empty(both, things, bounds):
                joined[k] = both
                break
        else:
            joined.append(back)
    return joined


def _to_corners(piece: _Back, things: Sequence[RecordedObject], bounds: Rect) -> _Back:
    """A piece of wall that goes on to the corners of the room near to it."""
    across = 1 - piece.axis
    first, last = bounds[across], bounds[across + 2]
    longer = replace(piece, start=first)
    if abs(piece.start - first) < CORNER_M and _is_empty(longer, things, bounds):
        piece = longer
    longer = replace(piece, end=last)
    if abs(piece.end - last) < CORNER_M and _is_empty(longer, things, bounds):
        piece = longer
    return piece


def _beside(piece: _Back, things: Sequence[RecordedObject], bounds: Rect) -> _Back:
    """A piece of wall drawn in until it leaves the things around it their places."""
    axis, across = piece.axis, 1 - piece.axis
    for o in sorted(things, key=lambda o: o.id):
        low, high = np.array(piece.behind(bounds)).reshape(2, 2)
        if not (np.all(o.high[:2] > low) and np.all(o.low[:2] < high)):
            continue
        back = float(o.high[axis] if piece.sign > 0 else o.low[axis])
        if piece.sign * (back - piece.at) <= TOUCH_M:
            piece = replace(piece, at=back)
        elif o.high[across] - low[across] < high[across] - o.low[across]:
            piece = replace(piece, start=float(o.high[across]))
        else:
            piece = replace(piece, end=float(o.low[across]))
    return piece
