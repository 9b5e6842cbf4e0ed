"""A room while it is being furnished: where its walls are, what is taken, and whether one can still walk through it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.plan import SIDES
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.floorplans.sampled.furniture_sets import FurnitureSet, RestingSpot
from remqa_data.geometry.types import F64, Flags, Rect
from remqa_data.opencv import cv2
from remqa_data.sim.navigation.embodiment import AGENT

GAP_M = 0.012
"""Between pieces."""
HEAD_M = 1.85
"""What is higher than this is in nobody's way."""
SWEEP_M = 0.5
"""Room before doors and drawers into which they open and where the agent stands."""
MARGIN_M = 0.03
STEP_M = AGENT.step_m / 2
DOOR_CLEAR_M = 0.7
OPENS_FORWARD = types_with("opens_forward")

FACING = {side: (int(np.abs(inward).argmax()), float(inward.sum())) for side, inward in SIDES.items()}
"""Axis across each wall, and the sign of the direction from it into the room."""
QUARTERS_AT = {"north": 0, "west": 1, "south": 2, "east": 3}
"""How often a piece, whose front faces -y, is turned to have its back to a wall."""


@dataclass(frozen=True)
class Wall:
    """A straight piece of wall: its inner face, from `start` to `end` along it; metres."""

    side: str
    face: float
    start: float
    end: float
    is_outer: bool = True

    @property
    def axis(self) -> int:
        """Axis across the wall."""
        return FACING[self.side][0]

    @property
    def inward(self) -> float:
        """Sign of the direction into the room."""
        return FACING[self.side][1]

    @property
    def length(self) -> float:
        """From end to end."""
        return self.end - self.start

    def box(self, along: tuple[float, float], away: tuple[float, float], z: tuple[float, float]) -> tuple[F64, F64]:
        """Corners of a box by its ranges along the wall, away from it and in height."""
        low, high = np.zeros(3), np.zeros(3)
        depth = sorted(self.face + self.inward * distance for distance in away)
        low[self.axis], high[self.axis] = depth
        low[1 - self.axis], high[1 - self.axis] = along
        low[2], high[2] = z
        return low, high


@dataclass
class Canvas:
    """A room with what is in it so far.

    Attributes
    ----------
    scene : str
        Its name.
    bounds : Rect
        Inner faces of the outer walls.
    height : float
        Of the ceiling, metres.
    notch : Rect or None
        The corner that is missing in an L-shaped room.
    rows : list of RecordedObject
        What is in the room.
    solids, kept_clear : lists of (low, high) corners
        What takes up room, and what must stay free: before doors and drawers, and before the room's door.
    spots : list of RestingSpot
        Where things can stand on what is uneven.
    door : (low, high) corners or None
        The room's door.
    """

    scene: str
    bounds: Rect
    height: float
    notch: Rect | None = None
    rows: list[RecordedObject] = field(default_factory=list)
    solids: list[tuple[F64, F64]] = field(default_factory=list)
    kept_clear: list[tuple[F64, F64]] = field(default_factory=list)
    spots: list[RestingSpot] = field(default_factory=list)
    door: tuple[F64, F64] | None = None

    def walls(self) -> list[Wall]:
        """All walls, those of the notch too."""
        x0, y0, x1, y1 = self.bounds
        walls = [
            Wall("west", x0, y0, y1),
            Wall("east", x1, y0, y1),
            Wall("south", y0, x0, x1),
            Wall("north", y1, x0, x1),
        ]
        return (
            walls if self.notch is None else [*(_shortened(wall, self.notch) for wall in walls), *self._inner_walls()]
        )

    def _inner_walls(self) -> list[Wall]:
        assert self.notch is not None
        x0, y0, x1, y1 = self.notch
        at_west, at_south = x0 == self.bounds[0], y0 == self.bounds[1]
        across = Wall("west", x1, y0, y1, False) if at_west else Wall("east", x0, y0, y1, False)
        along = Wall("south", y1, x0, x1, False) if at_south else Wall("north", y0, x0, x1, False)
        return [across, along]

    def fits(self, low: F64, high: F64, clear: Sequence[tuple[F64, F64]] = (), into_wall_m: float = 0.0) -> bool:
        """Whether a box is in the room and meets nothing, nor what must be free before it; some reach into walls."""
        if not self._is_inside(low, high, into_wall_m):
            return False
        if any(_overlap(low - GAP_M, high + GAP_M, a, b) for a, b in self.solids):
            return False
        if any(_overlap(low, high, a, b) for a, b in self.kept_clear):
            return False
        return all(
            self._is_inside(a, b, 0.0) and not any(_overlap(a, b, c, d) for c, d in self.solids) for a, b in clear
        )

    def add(
        self, rows: Sequence[RecordedObject], clear: Iterable[tuple[F64, F64]] = (), spots: Iterable[RestingSpot] = ()
    ) -> None:
        """Put things into the room; they get ids of their own, also where they name what holds them."""
        known = {row.id for row in self.rows}
        renamed: dict[str, str] = {}
        for row in rows:
            x, y, z = row.pivot
            name = f"{row.type}|{x:+06.2f}|{z:+06.2f}|{y:+06.2f}"
            while name in known:
                name += "|1"
            known.add(name)
            renamed[row.id] = name
        floor = next((row.id for row in self.rows if row.type == "Floor"), "")
        for row in rows:
            holders = (renamed.get(p, floor if p.startswith("Floor|") else p) for p in row.parents)
            parents = tuple(p for p in holders if p in known)
            self.rows.append(replace(row, scene=self.scene, id=renamed[row.id], parents=parents))
            if row.type != "Floor":
                self.solids.append((row.low, row.high))
        self.kept_clear += clear
        self.spots += [replace(spot, host=renamed[spot.host]) for spot in spots]

    def _is_inside(self, low: F64, high: F64, slack: float) -> bool:
        x0, y0, x1, y1 = self.bounds
        if low[0] < x0 - slack or low[1] < y0 - slack or high[0] > x1 + slack or high[1] > y1 + slack:
            return False
        if self.notch is None:
            return True
        a, b = np.array([*self.notch[:2], -9.0]), np.array([*self.notch[2:], 9.0])
        return not _overlap(low, high, a, b)

    def is_walkable(self, more: Sequence[tuple[F64, F64]] = (), clear: Sequence[tuple[F64, F64]] = ()) -> bool:
        """Whether all of the floor that is left hangs together, with all the places before doors and drawers.

        Parameters
        ----------
        more, clear : sequences of boxes
            What would be put into the room, and what would have to be reached before it.
        """
        free, xs, ys = self.free_floor(more)
        count, labels = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
        if count < 2:
            return False
        sizes = np.bincount(labels.ravel())[1:]
        main = labels == 1 + int(sizes.argmax())
        if sizes.max() < 0.9 * sizes.sum():
            return False
        cells = main & _on_grid(xs)[:, None] & _on_grid(ys)[None, :]
        return all(_holds(cells, xs, ys, box) for box in (*self.kept_clear, *clear))

    def free_floor(self, more: Sequence[tuple[F64, F64]] = ()) -> tuple[Flags, F64, F64]:
        """Cells that are free, and halves of steps between them, (n, m) bool; with coordinates of its rows and columns."""
        x0, y0, x1, y1 = self.bounds
        xs = np.arange(np.ceil(x0 / STEP_M), np.floor(x1 / STEP_M) + 1) * STEP_M
        ys = np.arange(np.ceil(y0 / STEP_M), np.floor(y1 / STEP_M) + 1) * STEP_M
        reach = AGENT.radius_m + MARGIN_M
        inside_x, inside_y = (xs > x0 + reach) & (xs < x1 - reach), (ys > y0 + reach) & (ys < y1 - reach)
        free = inside_x[:, None] & inside_y[None, :] & (_on_grid(xs)[:, None] | _on_grid(ys)[None, :])
        boxes = [(low, high) for low, high in (*self.solids, *more) if low[2] < HEAD_M and high[2] > 0.05]
        if self.notch is not None:
            boxes.append((np.array([*self.notch[:2], 0.0]), np.array([*self.notch[2:], 1.0])))
        for low, high in boxes:
            dx = np.maximum(np.maximum(low[0] - xs, xs - high[0]), 0.0)
            dy = np.maximum(np.maximum(low[1] - ys, ys - high[1]), 0.0)
            free &= (dx**2)[:, None] + (dy**2)[None, :] > reach**2
        return free, xs, ys


def clearances(piece: FurnitureSet) -> list[tuple[F64, F64]]:
    """The room that must stay free before what opens in a piece."""
    boxes = []
    for row in piece.rows:
        if row.type in OPENS_FORWARD and not (row.type in types_with("cupboard_front") and row.low[2] > 1.3):
            boxes.append(before(row))
    return boxes


def before(row: RecordedObject, depth: float = SWEEP_M) -> tuple[F64, F64]:
    """The room on the floor right before an object."""
    axis = int(np.abs(row.front[:2]).argmax())
    low, high = row.low.copy(), row.high.copy()
    low[2], high[2] = 0.05, HEAD_M
    if row.front[axis] > 0:
        low[axis], high[axis] = row.high[axis] + 0.05, row.high[axis] + depth
    else:
        low[axis], high[axis] = row.low[axis] - depth, row.low[axis] - 0.05
    return low, high


def _shortened(wall: Wall, notch: Rect) -> Wall:
    """What a notch leaves of an outer wall."""
    a, b = (notch[1 - wall.axis], notch[3 - wall.axis])
    if wall.face not in (notch[wall.axis], notch[wall.axis + 2]):
        return wall
    if a == wall.start:
        return Wall(wall.side, wall.face, b, wall.end)
    return Wall(wall.side, wall.face, wall.start, a)


def _on_grid(values: F64) -> Flags:
    """Which coordinates, multiples of half a step, are those of cells."""
    return np.equal(np.round(values / STEP_M) % 2, 0)


def _holds(cells: Flags, xs: F64, ys: F64, box: tuple[F64, F64]) -> bool:
    """Whether one can stand in or next to a box."""
    low, high = box
    in_x, in_y = (xs > low[0] - 0.15) & (xs < high[0] + 0.15), (ys > low[1] - 0.15) & (ys < high[1] + 0.15)
    return bool(np.any(cells & in_x[:, None] & in_y[None, :]))


def _overlap(a: F64, b: F64, c: F64, d: F64) -> bool:
    return bool(np.all(b > c) and np.all(d > a))
