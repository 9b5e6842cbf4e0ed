"""Pieces: things that belong together and keep their places to each other, such as a dresser, its drawers and its knobs.

A piece is cut out of a recorded room and put into its own frame: the middle of its box is the origin, the floor is at
z = 0 and its front faces -y. So the drawers in a desk and the curtains before a window are as they were recorded, while
the room around them is new.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import networkx as nx
import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.backs import ON_WALLS
from remqa_data.floorplans.ithor.extent import IN_WALLS
from remqa_data.floorplans.ithor.plan import SIDES, RoomShell, host_of
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

BUILT = types_with("cupboard_part")
"""Types of which cupboards and washstands are made."""
BATHING = types_with("bathing")
CABIN = types_with("shower_cabin")
"""What a shower cabin has."""
WORKTOPS = types_with("worktop")
"""What has a base on the floor, recorded or not."""
WET = frozenset({"Bathtub", "Shower"})
HANGS_ON = types_with("holder")
UNEVEN = types_with("uneven")
"""What things stand on only at certain points."""
SPOT_SLACK_M = 0.02
TOUCHING_M = 0.06
UNDER_M = 0.35
"""Between a washbasin or worktop and the cabinets under it."""
SHOWER_M = 1.2
"""Between the head, the pane and the door of one shower."""
AT_WALL_M = 0.16
"""What ends this near to a wall is at the wall."""
ON_FLOOR_M = 0.25
"""What begins lower than this takes up floor."""
QUARTERS: tuple[F64, ...] = tuple(
    np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    for s, c in ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))
)
"""Rotations by quarters about z, (3, 3) each."""
LOCAL_SIDES = {"back": (1, 1), "front": (1, -1), "right": (0, 1), "left": (0, -1)}
"""Axis and sign of the sides of a piece in its own frame."""


@dataclass(frozen=True, eq=False)
class RestingSpot:
    """A point on which something stood, on an object of a piece; with the greatest half width of things that fit there."""

    host: str
    point: F64
    half_m: float


@dataclass(frozen=True, eq=False)
class FurnitureSet:
    """Things that belong together.

    Attributes
    ----------
    kind : str
        Type of the main thing, or "Cupboard", "Washstand", "Shower" or "ShelfOnWall".
    rows : tuple of RecordedObject
        The things, in the piece's frame, the main one first.
    low, high : (3,) arrays
        Corners of the box around them.
    gaps : mapping of str to float
        For each of the sides "back", "front", "left" and "right" that is at a wall: how far it is from the wall, metres;
        negative for what is let into the wall.
    spots : tuple of RestingSpot
        Where things were recorded to stand on it.
    """

    kind: str
    rows: tuple[RecordedObject, ...]
    low: F64
    high: F64
    gaps: dict[str, float]
    spots: tuple[RestingSpot, ...] = ()

    @property
    def is_hung(self) -> bool:
        """Whether it takes up no floor."""
        return bool(self.low[2] > ON_FLOOR_M) or self.kind in ON_WALLS

    @property
    def bases(self) -> list[tuple[F64, F64]]:
        """What worktops and washbasins stand on, recorded or not: boxes from the floor up."""
        return [(row.low * [1, 1, 0], row.high) for row in self.rows if row.type in WORKTOPS]

    def turned(self, quarters: int) -> FurnitureSet:
        """The same piece, turned counter-clockwise by quarters; its sides keep their names."""
        spin = QUARTERS[quarters % 4]
        rows = tuple(moved(row, spin, np.zeros(3)) for row in self.rows)
        spots = tuple(replace(spot, point=arithmetic.turned(spot.point, spin)) for spot in self.spots)
        low, high = _corners(rows)
        return replace(self, rows=rows, spots=spots, low=low, high=high)


def groups_of(objects: Sequence[RecordedObject]) -> list[list[RecordedObject]]:
    """The objects of each piece, the main one first."""
    standing = [o for o in objects if o.type != "Floor" and _stands_alone(o)]
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(standing)))
    for i, a in enumerate(standing):
        host = host_of(a, standing) if a.type in BUILT else None
        for j, b in enumerate(standing):
            if b is host or (j < i and _belong_together(a, b)):
                graph.add_edge(i, j)
    groups = [[standing[i] for i in sorted(part)] for part in nx.connected_components(graph)]
    for group in groups:
        ids = {o.id for o in group}
        group += [o for o in objects if o.pickupable and ids.intersection(o.parents) and group[0].type in HANGS_ON]
        group.sort(key=lambda o: (o.pickupable, o.type in BUILT, -float(np.prod(o.high - o.low))))
    return groups


def piece_from(group: Sequence[RecordedObject], objects: Sequence[RecordedObject], shell: RoomShell) -> FurnitureSet:
    """A piece in its own frame, of objects of a recorded room."""
    kind, front = kind_of(group), _front_of(group)
    low, high = np.min([o.low for o in group], axis=0), np.max([o.high for o in group], axis=0)
    if kind in WET and shell.gap(_wall_towards(front), low, high) < AT_WALL_M:
        front = -front  # neither bathtubs nor showers have a front; their pieces have their back at a wall
    to_front = next(k for k, spin in enumerate(QUARTERS) if arithmetic.turned(front, spin)[1] < -0.9)
    ground = low[2] if group[0].pickupable else shell.floor_z  # what is loose may have stood on a rug
    middle = np.append((low + high)[:2] / 2, ground)
    spin = QUARTERS[to_front]
    rows = tuple(moved(row, spin, -arithmetic.turned(middle, spin)) for row in group)
    gaps = {}
    for name, (axis, sign) in LOCAL_SIDES.items():
        outward = np.zeros(3)
        outward[axis] = sign
        gap = shell.gap(_wall_towards(arithmetic.turned_back(outward, spin)), low, high)
        if gap < AT_WALL_M or (kind in ON_WALLS and name == "back"):
            limit = -0.3 if kind in IN_WALLS else 0.004
            gaps[name] = float(np.clip(gap, limit, 0.03))
    spots = tuple(_spots(group, objects, spin, -arithmetic.turned(middle, spin)))
    return FurnitureSet(kind, rows, *_corners(rows), gaps, spots)


def _spots(
    group: Sequence[RecordedObject], objects: Sequence[RecordedObject], spin: F64, shift: F64
) -> Iterator[RestingSpot]:
    hosts = {o.id: o for o in group}
    for o in objects:
        for host in (hosts[parent] for parent in o.parents if parent in hosts and o.id not in hosts):
            if host.type in UNEVEN:
                foot = np.append((o.low + o.high)[:2] / 2, o.low[2])
                reach = float((o.high - o.low)[:2].max()) / 2 + SPOT_SLACK_M
                yield RestingSpot(host.id, arithmetic.turned(foot, spin) + shift, reach)


def kind_of(group: Sequence[RecordedObject]) -> str:
    """What a piece is called."""
    types = {o.type for o in group}
    if types & (BATHING - {"Faucet"}):
        return "Bathtub" if "Bathtub" in types else "Shower"
    if "Sink" in types:
        return "Washstand"
    if types == {"Shelf"}:
        return "ShelfOnWall"
    return "Cupboard" if types <= BUILT else group[0].type


def moved(o: RecordedObject, spin: F64, shift: F64) -> RecordedObject:
    """An object turned by quarters about the origin's z axis, then shifted."""
    corners = np.stack([arithmetic.turned(o.low, spin), arithmetic.turned(o.high, spin)])
    return replace(
        o,
        pivot=arithmetic.turned(o.pivot, spin) + shift,
        low=corners.min(axis=0) + shift,
        high=corners.max(axis=0) + shift,
        centre=arithmetic.turned(o.centre, spin) + shift,
        rotation=arithmetic.product(spin, o.rotation),
    )


def _stands_alone(o: RecordedObject) -> bool:
    """Whether nothing but the floor, a wall or a piece of furniture that it is built into holds an object."""
    if o.type in ON_WALLS or o.type in BUILT | BATHING:
        return not o.pickupable
    return not o.parents or any(parent.startswith("Floor|") for parent in o.parents)


def _belong_together(a: RecordedObject, b: RecordedObject) -> bool:
    types = {a.type, b.type}
    if types <= BATHING:
        return _touch(a, b, 2) or (types <= CABIN and len(types) == 2 and _touch(a, b, 2, SHOWER_M))
    if types <= BUILT:
        return _touch(a, b, 3) or (bool(types & WORKTOPS) and _touch(a, b, 2, 0.0) and _touch(a, b, 3, UNDER_M))
    if types <= IN_WALLS and len(types) == 2:
        return _touch(a, b, 3)
    return False


def _touch(a: RecordedObject, b: RecordedObject, axes: int, within_m: float = TOUCHING_M) -> bool:
    apart = np.maximum(a.low - b.high, b.low - a.high)[:axes]
    return bool(np.all(apart < within_m))


def _front_of(group: Sequence[RecordedObject]) -> F64:
    """The quarter direction that the main thing, or most of what opens, faces."""
    main = [o for o in group if o.type not in BUILT] or [o for o in group if o.type in ("Cabinet", "Drawer", "Sink")]
    votes: Counter[int] = Counter()
    sides = list(SIDES.values())
    for o in main[:1] if main and main[0].type not in BUILT else main or group:
        votes[int(np.argmax([float(arithmetic.dot(o.front, inward)) for inward in sides]))] += 1
    return sides[votes.most_common(1)[0][0]]


def _wall_towards(direction: F64) -> str:
    return next(side for side, inward in SIDES.items() if arithmetic.dot(inward, direction) < -0.9)


def _corners(rows: Sequence[RecordedObject]) -> tuple[F64, F64]:
    """The box around what takes up room; a shower head does not, above a bathtub."""
    has_bathtub = any(row.type == "Bathtub" for row in rows)
    solid = [row for row in rows if not (has_bathtub and row.type == "ShowerHead")]
    low, high = np.min([o.low for o in solid], axis=0), np.max([o.high for o in solid], axis=0)
    if any(row.type in WORKTOPS for row in rows):
        low[2] = 0.0
    return low, high
