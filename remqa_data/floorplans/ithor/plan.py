"""What a room's recorded boxes say about the room itself: floor level, walls, and which way things face."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.backs import ON_WALLS
from remqa_data.floorplans.ithor.extent import recorded_extent
from remqa_data.floorplans.ithor.table import RecordedObject, axes_facing
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Rect

BACKED = types_with("has_back")
"""Furniture that stands with its back to a wall when it stands at one."""
AT_WALL_M = 0.35
AT_NOTCH_M = 0.15
"""So far behind a thing there is no room if it hangs beside a corner that is not part of it."""

SIDES: dict[str, F64] = {
    "west": np.array([1.0, 0.0, 0.0]),
    "east": np.array([-1.0, 0.0, 0.0]),
    "south": np.array([0.0, 1.0, 0.0]),
    "north": np.array([0.0, -1.0, 0.0]),
}
"""The walls of a room and the direction from each into the room."""


@dataclass(frozen=True)
class RoomShell:
    """Floor level, inner faces of the outer walls, ceiling height above the floor; metres.

    Attributes
    ----------
    notches : tuple of Rect
        Corners of the bounds that are not part of the room, such as that of an L.
    door : ((3,) array, (3,) array) or None
        Corners of a closed door in an outer wall: its frame's box, as far as it stands out into the room.
    """

    floor_z: float
    bounds: Rect
    height: float
    notches: tuple[Rect, ...] = ()
    door: tuple[F64, F64] | None = None

    def gap(self, side: str, low: F64, high: F64) -> float:
        """Distance between a box and a wall."""
        x0, y0, x1, y1 = self.bounds
        gaps = {"west": low[0] - x0, "east": x1 - high[0], "south": low[1] - y0, "north": y1 - high[1]}
        return float(gaps[side])

    def middle(self) -> tuple[float, float]:
        """The middle of the bounds, or of the largest part of them that a notch leaves if it lies in that notch."""
        x0, y0, x1, y1 = self.bounds
        for a0, b0, a1, b1 in self.notches:
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            if a0 < x < a1 and b0 < y < b1:
                rests = ((x0, y0, a0, y1), (a1, y0, x1, y1), (x0, y0, x1, b0), (x0, b1, x1, y1))
                x0, y0, x1, y1 = max(rests, key=lambda r: (r[2] - r[0]) * (r[3] - r[1]))
        return (x0 + x1) / 2, (y0 + y1) / 2

    def nearest_side(self, low: F64, high: F64) -> tuple[str, float]:
        """The wall nearest to a box, and how far it is."""
        gaps = {side: self.gap(side, low, high) for side in SIDES}
        side = min(gaps, key=lambda name: gaps[name])
        return side, gaps[side]


def fit_shell(objects: Sequence[RecordedObject]) -> RoomShell:
    """Floor level and walls of a room from its recorded boxes."""
    floor = next(o for o in objects if o.type == "Floor")
    floor_z = float(floor.high[2])
    bounds, notches = recorded_extent(objects, floor)
    top = max(float(o.high[2]) for o in objects if o.type != "Floor")
    return RoomShell(floor_z, bounds, max(2.5, top - floor_z + 0.15), notches)


def facing_right(objects: Sequence[RecordedObject], shell: RoomShell, worktops: Sequence[Rect]) -> list[RecordedObject]:
    """The same objects, each facing the way that the room makes plain; `worktops` are the plans of the counters.

    Things on walls face away from the wall, beds have their head where the recording has its foot, furniture at a wall
    does not face the wall, and doors of cabinets and fronts of drawers face free floor.
    """
    blockers = [o for o in objects if not o.pickupable and o.type not in ON_WALLS | {"Floor", "StoveKnob", "Faucet"}]
    turned = []
    for o in objects:
        front = o.front
        if o.type in ON_WALLS:
            front = _off_the_wall(o, shell)
        elif o.type == "Bed":
            front = -front
        elif o.type in types_with("cupboard_front"):
            front = _towards_free_floor(o, blockers, shell, worktops)
        elif o.type in BACKED:
            front = _not_into_wall(o, shell)
        turned.append(_turned(o, front))
    return turned


def _turned(o: RecordedObject, front: F64) -> RecordedObject:
    if arithmetic.dot(front, o.front) > 0.999:
        return o
    rotation = axes_facing(front)
    swap = bool(abs(arithmetic.dot(rotation[:, 0], o.rotation[:, 0])) < 0.5)
    size = o.size[[1, 0, 2]] if swap else o.size
    along = float(arithmetic.dot(front, o.front))
    if abs(o.rotation[2, 2]) < 0.999 or (abs(along) > 0.01 and along > -0.999):
        size = arithmetic.turned_back(
            o.high - o.low, np.abs(rotation)
        )  # was tilted or oblique: take the axis-aligned box
    return replace(o, rotation=rotation, size=size)


def _off_the_wall(o: RecordedObject, shell: RoomShell) -> F64:
    extent = o.high - o.low
    thin = [axis for axis in (0, 1) if extent[axis] < 0.6 * extent[1 - axis]]
    allowed = [side for side, inward in SIDES.items() if not thin or abs(inward[thin[0]]) > 0.5]
    at_notch = [side for side in allowed if thin and _has_notch_behind(o, SIDES[side], shell)]
    if len(at_notch) == 1:
        return SIDES[at_notch[0]]
    gaps = {side: abs(shell.gap(side, o.low, o.high)) for side in allowed}
    side = min(gaps, key=lambda name: (gaps[name] > AT_WALL_M, gaps[name]))
    if (
        gaps[side] > AT_WALL_M
        and abs(o.rotation[2, 2]) > 0.99
        and any(arithmetic.dot(SIDES[s], o.front) > 0.99 for s in allowed)
    ):
        return o.front  # on an inner wall: trust the recorded yaw
    return SIDES[side]


def _has_notch_behind(o: RecordedObject, front: F64, shell: RoomShell) -> bool:
    """Whether the middle of an object's back, if that is its front, is at a corner that is not part of the room."""
    axis = int(np.abs(front).argmax())
    behind = ((o.low + o.high) / 2)[:2]
    behind[axis] = (o.low if front[axis] > 0 else o.high)[axis] - AT_NOTCH_M * front[axis]
    return any(x0 < behind[0] < x1 and y0 < behind[1] < y1 for x0, y0, x1, y1 in shell.notches)


def _not_into_wall(o: RecordedObject, shell: RoomShell) -> F64:
    for side, inward in SIDES.items():
        faces_it = bool(arithmetic.dot(o.front, inward) < -0.9)
        if faces_it and shell.gap(side, o.low, o.high) < AT_WALL_M:
            opposite = next(s for s, d in SIDES.items() if arithmetic.dot(d, inward) < -0.9)
            if shell.gap(opposite, o.low, o.high) > 0.5:
                return -o.front
    return o.front


def _towards_free_floor(
    o: RecordedObject, blockers: Sequence[RecordedObject], shell: RoomShell, worktops: Sequence[Rect]
) -> F64:
    """Front of a cabinet or drawer: room to open it, floor to stand on before it, a wall or furniture behind it.

    The recorded yaw, the hinge (which is at the front, at one end of it), the front of the piece of furniture that it is
    built into and the longer side count too.
    """
    host = host_of(o, blockers)
    half = (o.high - o.low) / 2
    middle = (o.high + o.low) / 2
    on_floor = o.low[2] < shell.floor_z + 1.2
    score: dict[str, float] = {}
    for side, inward in SIDES.items():
        axis = int(np.abs(inward).argmax())
        free = _freedom(o, inward, (0.05, 0.45), blockers, host, shell)
        total = 1.5 * free
        total += 0.5 * (1 - _freedom(o, -inward, (0.02, 0.15), blockers, host, shell))
        total += 0.4 * float(arithmetic.dot(o.front, inward) > 0.9)
        total += 0.3 * float(half[1 - axis] > 1.3 * half[axis])
        total += 0.5 * float(np.clip((o.pivot - middle)[axis] / max(half[axis], 1e-6) * inward[axis], -1, 1))
        if on_floor:
            total += 1.5 * _freedom(o, inward, (0.30, 0.80), blockers, host, shell, worktops)
        if host is not None:
            edge = (host.high if inward[axis] > 0 else host.low)[axis]
            face = (o.high if inward[axis] > 0 else o.low)[axis]
            total += 0.6 * float(abs(edge - face) < 0.08) + 1.0 * float(arithmetic.dot(host.front, inward) > 0.9)
        score[side] = total
    return SIDES[max(score, key=lambda side: score[side])]


def host_of(o: RecordedObject, blockers: Sequence[RecordedObject]) -> RecordedObject | None:
    """The piece of furniture whose box contains an object's centre, if any."""
    middle = (o.low + o.high) / 2
    hosts = [
        b
        for b in blockers
        if b is not o
        and b.type in HOSTS
        and np.all(middle > b.low - 0.02)
        and np.all(middle < b.high + 0.02)
        and np.prod(b.high - b.low) > np.prod(o.high - o.low)
    ]
    return min(hosts, key=lambda b: float(np.prod(b.high - b.low)), default=None)


HOSTS = types_with("houses_built_in")
"""Furniture that may contain drawers, shelves and cabinets recorded as objects of their own."""


def _freedom(
    o: RecordedObject,
    direction: F64,
    reach: tuple[float, float],
    blockers: Sequence[RecordedObject],
    host: RecordedObject | None,
    shell: RoomShell,
    worktops: Sequence[Rect] = (),
) -> float:
    """Share of the room before one side of a box, between two distances, that is neither wall, furniture nor worktop."""
    axis = int(np.abs(direction).argmax())
    across = 1 - axis
    face = (o.high if direction[axis] > 0 else o.low)[axis]
    distance, along = (grid.ravel() for grid in np.meshgrid(np.linspace(*reach, 4), (0.2, 0.5, 0.8)))
    points = np.tile((o.low + o.high) / 2, (len(along), 1))
    points[:, axis] = face + direction[axis] * distance
    points[:, across] = o.low[across] + along * (o.high - o.low)[across]
    free = _within(points[:, :2], np.array([shell.bounds]))
    if worktops:
        free &= ~_within(points[:, :2], np.array(worktops))
    others = [b for b in blockers if b is not o and b is not host and b.type != "CounterTop"]
    if others:
        free &= ~_within(points, np.array([[*b.low, *b.high] for b in others]))
    return float(np.mean(free))


def free_beside(o: RecordedObject, side: int, objects: Sequence[RecordedObject], shell: RoomShell) -> float:
    """Share of the floor before an object, to its left (-1) or right (1), on which nothing stands: there one goes past.

    A door has its hinge on the other side.
    """
    right, half = o.rotation[:, 0], o.size / 2
    ahead, along = (grid.ravel() for grid in np.meshgrid(np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.8, 5)))
    points = o.centre + np.outer(half[1] + ahead, o.front) + np.outer(side * (half[0] + along), right)
    standing = [b for b in objects if b is not o and not b.pickupable and b.low[2] < shell.floor_z + 1.0]
    free = _within(points[:, :2], np.array([shell.bounds]))
    free &= ~_within(points[:, :2], np.array([[*b.low[:2], *b.high[:2]] for b in standing if b.type != "Floor"]))
    return float(np.mean(free))


def _within(points: F64, boxes: F64) -> npt.NDArray[np.bool_]:
    """(n,) whether each of (n, k) points lies in any of some boxes, (m, 2 k): their low corners, then their high ones."""
    k = points.shape[1]
    inside = (points[:, None] > boxes[:, :k]) & (points[:, None] < boxes[:, k:])
    return np.asarray(np.any(np.all(inside, axis=2), axis=1))
