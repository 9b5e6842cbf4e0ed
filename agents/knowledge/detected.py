"""Objects that are put together from what the detector finds in one view after the other: boxes in metres, types by vote."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from remqa_data.assets.core.sizes import typical_size
from remqa_data.catalog import object_type, types_with
from remqa_data.geometry.types import F32, F64, Box, Flags
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.sim.render.camera import Camera

EVERY_PX = 2
"""Of every so many pixels across and down one is looked at."""
POINTS = 64
"""Points that are kept of an object that a view shows."""
GOLDEN = (5**0.5 - 1) / 2
FEWEST_POINTS = 3
AGREE_SHARE = 0.1
"""Where fewer cells than this of a box have the object's type, the middle of the box is taken, ..."""
MIDDLE_SHARE = 0.6
"""... that is, so much of its width and height."""
DEEP_SHARE = 0.7
"""What is farther from an object's median depth than this share of its width, or its height, is not of the object."""
EDGE_SHARE = 0.02
"""This share of the points on either side of a box is not believed."""
NEAR_M = 0.04
"""Points so near to a box are in it."""
SAME_SHARE = 0.5
"""Two things are one if each has this share of its points in the other's box; of those of one type, if one of them has."""
LEVEL = 0.6
"""What leans more than this (cosine to the vertical) has no side."""
HEADINGS_DEG = (0.0, 90.0, 180.0, 270.0)
OPENS_FORWARD = types_with("opens_forward")


@dataclass(frozen=True, eq=False)
class Seen:
    """An object that one view shows.

    Attributes
    ----------
    votes : (types,) float32
        How likely it is of each type; together as likely as that it is an object at all.
    points : (n, 3)
        Of its surface, metres.
    sides : (4,) float32
        Shares of its surface that look towards each of `HEADINGS_DEG`.
    """

    votes: F32
    points: F64
    sides: F32


@dataclass(eq=False)
class Thing:
    """An object that was seen once or several times.

    Attributes
    ----------
    votes, sides
        Sums of those of `Seen`.
    points : (n, 3)
        Of all views.
    """

    votes: F32
    points: F64
    sides: F32
    box: F64 = field(init=False)

    def __post_init__(self) -> None:
        self.box = box_around(self.points)

    def add(self, seen: Seen) -> None:
        """Another view of it."""
        self.votes, self.sides = self.votes + seen.votes, self.sides + seen.sides
        self.points = np.concatenate([self.points, seen.points])
        self.box = box_around(self.points)


class Things:
    """All objects that were seen.

    Parameters
    ----------
    types : sequence of str
        What the detector knows.
    """

    def __init__(self, types: Sequence[str]) -> None:
        self.types = tuple(types)
        self.all: list[Thing] = []

    def add(self, found: Iterable[Seen]) -> None:
        """What one view shows: each object is one that is known, or a new one."""
        for seen in found:
            thing = self._known(seen)
            if thing is None:
                self.all.append(Thing(seen.votes, seen.points, seen.sides))
            else:
                thing.add(seen)

    def _known(self, seen: Seen) -> Thing | None:
        if not self.all:
            return None
        boxes = np.array([thing.box for thing in self.all])
        box = box_around(seen.points)
        best, most = None, SAME_SHARE
        for place in np.flatnonzero(
            np.all((boxes[:, :3] <= box[3:] + NEAR_M) & (boxes[:, 3:] >= box[:3] - NEAR_M), axis=1)
        ):
            thing = self.all[place]
            mine, theirs = _share_in(seen.points, thing.box), _share_in(thing.points, box)
            is_one_type = thing.votes.argmax() == seen.votes.argmax()
            share = max(mine, theirs) if is_one_type else min(mine, theirs)
            if share >= most:
                best, most = thing, share
        return best

    def records(self, least: float) -> dict[ObjectMetadata, float]:
        """All that got so many votes for a type, with these; the likeliest first, also by their ids.

        What opens forward is as deep as things of its type are: of a drawer in a cupboard one sees the front alone.
        """
        found = [(float(thing.votes.max()), thing) for thing in self.all]
        order = sorted((one for one in found if one[0] >= least), key=lambda one: -one[0])
        names = [self.types[int(thing.votes.argmax())] for _, thing in order]
        return {
            _record(thing, name, at): votes for at, (name, (votes, thing)) in enumerate(zip(names, order, strict=True))
        }


def seen_in(boxes: F32, votes: F32, cells: np.ndarray, stride: int, depth: F32, camera: Camera) -> list[Seen]:
    """The objects of one view in metres.

    Parameters
    ----------
    boxes : (m, 4) float32
        x1, y1, x2, y2 in pixels.
    votes : (m, types) float32
        See `Seen`.
    cells : (h', w') int64
        What each square of `stride` x `stride` pixels shows: index of its type + 1, or 0.
    stride : int
    depth : (h, w) float32
        Metres along the camera's forward axis, 0 where nothing is.
    camera : Camera
        From where it was seen.
    """
    points, sides = camera.unproject(depth)[::EVERY_PX, ::EVERY_PX], sides_of(depth, camera)
    depth = depth[::EVERY_PX, ::EVERY_PX]
    rows, columns = (np.arange(length) * EVERY_PX // stride for length in depth.shape)
    shown = cells[rows[:, None], columns[None]]
    found = []
    for box, vote in zip(boxes, votes, strict=True):
        x1, y1, x2, y2 = np.rint(box / EVERY_PX).astype(int).tolist()
        part = slice(max(y1, 0), max(y2, y1 + 1)), slice(max(x1, 0), max(x2, x1 + 1))
        is_own = shown[part] == int(vote.argmax()) + 1
        if is_own.mean() < AGREE_SHARE:
            is_own = _middle(is_own.shape)
        is_own &= depth[part] > 0
        if is_own.sum() < FEWEST_POINTS:
            continue
        far = float(np.median(depth[part][is_own]))
        wide = max(x2 - x1, y2 - y1) * EVERY_PX * far / camera.focal_px
        is_own &= np.abs(depth[part] - far) <= DEEP_SHARE * wide
        own, looks = points[part][is_own], sides[part][is_own]
        if len(own) < FEWEST_POINTS:
            continue
        counts = np.bincount(looks[looks >= 0], minlength=len(HEADINGS_DEG)) / len(looks)
        found.append(Seen(vote, own[_evenly(len(own))], counts.astype(np.float32)))
    return found


def _evenly(count: int) -> np.ndarray:
    """`POINTS` of so many places, or all of them; not every third or so: in rows of three these would be a column."""
    return np.flatnonzero(np.arange(count) * GOLDEN % 1.0 < POINTS / count)


def sides_of(depth: F32, camera: Camera) -> np.ndarray:
    """(h', w') for every `EVERY_PX` pixels towards which of `HEADINGS_DEG` the surface looks there; -1 for what is level."""
    points = camera.unproject(depth)[::EVERY_PX, ::EVERY_PX]
    across, down = np.zeros_like(points), np.zeros_like(points)
    across[:, 1:-1], down[1:-1] = points[:, 2:] - points[:, :-2], points[2:] - points[:-2]
    normals = np.cross(down, across)  # towards the eye
    lengths = np.linalg.norm(normals, axis=-1)
    is_upright = (lengths > 0) & (np.abs(normals[..., 2]) < LEVEL * lengths)
    quarter = np.rint(np.degrees(np.arctan2(normals[..., 1], normals[..., 0])) / 90.0).astype(int) % len(HEADINGS_DEG)
    return np.where(is_upright, quarter, -1)


def box_around(points: F64) -> F64:
    """(6,) box of (n, 3) points, without the outermost."""
    ordered, left_out = np.sort(points, axis=0), int(EDGE_SHARE * len(points))
    return np.concatenate([ordered[left_out], ordered[-1 - left_out]])


def _share_in(points: F64, box: F64) -> float:
    """Share of (n, 3) points that are in a box, or near to it."""
    return float(np.all((points >= box[:3] - NEAR_M) & (points <= box[3:] + NEAR_M), axis=1).mean())


def _middle(size: tuple[int, ...]) -> Flags:
    flags = np.zeros(size, dtype=np.bool_)
    low, high = ([round(length * (0.5 + sign * MIDDLE_SHARE / 2)) for length in size] for sign in (-1, 1))
    flags[low[0] : max(high[0], low[0] + 1), low[1] : max(high[1], low[1] + 1)] = True
    return flags


def _record(thing: Thing, kind: str, number: int) -> ObjectMetadata:
    facing = HEADINGS_DEG[int(thing.sides.argmax())] if thing.sides.any() and object_type(kind).has_front else None
    box = _deepened(thing.box, kind, facing) if facing is not None and kind in OPENS_FORWARD else thing.box
    return ObjectMetadata(
        id=f"{kind}|{number:04d}",
        type=kind,
        color="",
        substance="",
        box=_as_box(box),
        openness=0.0,
        is_picked_up=False,
        support=None,
        support_kind=None,
        facing_deg=facing,
    )


def _deepened(box: F64, kind: str, facing: float) -> F64:
    """A box of which only the front was seen, as deep as things of its type are."""
    axis, is_low = (0, facing == 0.0) if facing in (0.0, 180.0) else (1, facing == 90.0)
    deep = box.copy()
    depth = typical_size(kind)[1]
    if is_low:
        deep[axis] = min(box[axis], box[axis + 3] - depth)
    else:
        deep[axis + 3] = max(box[axis + 3], box[axis] + depth)
    return deep


def _as_box(box: F64) -> Box:
    x0, y0, z0, x1, y1, z1 = box.tolist()
    return x0, y0, z0, x1, y1, z1
