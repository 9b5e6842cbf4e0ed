"""Kitchens: worktops along the walls with cabinets and drawers under them, a sink, a stove, a fridge, cabinets above.

Kitchens were recorded as one built-in whole each, so they are not cut into pieces but built unit by unit, as kitchens
are: with as many doors and drawers as a recorded kitchen has.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.floorplans.ithor.table import RecordedObject, axes_facing
from remqa_data.floorplans.sampled.canvas import QUARTERS_AT, Canvas, Wall, before, clearances
from remqa_data.floorplans.sampled.furnishing import UPRIGHT, against
from remqa_data.floorplans.sampled.furniture_sets import FurnitureSet, moved
from remqa_data.floorplans.sampled.kitchen_plan import DEPTH_M, Unit, lay_out
from remqa_data.floorplans.sampled.statistics import Inventory, flags_by_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

TOP_M, SLAB_M = 0.92, 0.03
FRONT_M, KICK_M = 0.60, 0.10
"""Doors end this far from the wall, and begin this high."""
DRAWERS_IN_STACK = 4
HIGH_M, HIGH_DEPTH_M = (1.48, 2.14), 0.34
BURNER_M, KNOB_M = 0.20, 0.05
FREE_M = 0.015
"""Neighbours may be this near to a cabinet on the wall."""
ISLAND_CHANCE = 0.4
"""Of an island in a kitchen with a dining table; a kitchen without one has an island wherever there is room."""
ISLAND_TRIES = 300
ISLAND_M, ISLAND_DEPTH_M, AROUND_ISLAND_M = (1.2, 2.0), (0.65, 0.95), 0.7
"""Islands are so long and deep, and have so much free floor around them."""


def build_kitchen(
    canvas: Canvas,
    inventory: Inventory,
    fridges: Sequence[FurnitureSet],
    windows: list[FurnitureSet],
    rng: np.random.Generator,
) -> bool:
    """Build a kitchen into an empty room; takes one of the windows for the wall above the sink.

    Returns False if the room's walls are too short for it.
    """
    kitchen = _Kitchen(canvas, rng)
    doors, drawers = inventory.types["Cabinet"], inventory.types["Drawer"]
    stacks = -(-drawers // DRAWERS_IN_STACK)
    low_doors = max(round(0.45 * doors) - 2, 1)
    fridge = fridges[int(rng.integers(len(fridges)))]
    units = lay_out(canvas, stacks, low_doors, float((fridge.high - fridge.low)[0]) + 0.04, rng)
    if units is None:
        return False
    sink = next(unit for unit in units if unit.kind == "sink")
    if windows and sink.wall.is_outer and _put_window(canvas, windows[0], sink):
        windows.pop(0)
    left = drawers
    builders = {"sink": kitchen.sink, "stove": kitchen.stove, "cabinet": kitchen.cabinet}
    for unit in units:
        if unit.kind == "fridge":
            if not kitchen.fridge(unit, fridge):
                return False
        elif unit.kind == "drawers":
            kitchen.drawers(unit, min(DRAWERS_IN_STACK, left))
            left -= DRAWERS_IN_STACK
        elif unit.kind in builders:
            builders[unit.kind](unit)
    kitchen.worktops(units)
    kitchen.high_cabinets(units, doors - low_doors - 2)
    if not inventory.kinds["DiningTable"] or rng.random() < ISLAND_CHANCE:
        kitchen.island()
    return canvas.is_walkable()


def _put_window(canvas: Canvas, window: FurnitureSet, sink: Unit) -> bool:
    """A window over the sink."""
    turned = window.turned(QUARTERS_AT[sink.wall.side])
    shift = against(sink.wall, turned, (sink.start + sink.end) / 2, window.gaps.get("back", 0.0))
    if turned.low[2] < TOP_M + 0.1:
        shift[2] = TOP_M + 0.15 - turned.low[2]
    low, high = turned.low + shift, turned.high + shift
    if high[2] > canvas.height - 0.05 or not canvas.fits(low, high, (), 0.3):
        return False
    canvas.add([moved(row, UPRIGHT, shift) for row in turned.rows])
    return True


class _Kitchen:
    """Builds units."""

    def __init__(self, canvas: Canvas, rng: np.random.Generator) -> None:
        self.canvas, self.rng = canvas, rng
        self.flags = flags_by_type()

    def cabinet(self, unit: Unit) -> None:
        """One door with the space behind it."""
        hinge_left = bool(self.rng.random() < 0.5)
        self._door(unit.wall, unit.start, unit.end, (KICK_M, TOP_M - SLAB_M - 0.02), (0.06, FRONT_M), hinge_left)

    def sink(self, unit: Unit) -> None:
        """A sink with its tap, and two doors under it."""
        middle, half = (unit.start + unit.end) / 2, (unit.end - unit.start) / 2
        z = TOP_M - 0.005
        for start, end, left in ((unit.start, middle, True), (middle, unit.end, False)):
            self._door(
                unit.wall, start, end, (KICK_M, 0.64), (0.06, FRONT_M), left == (unit.wall.side in ("north", "east"))
            )
        across = (middle - 0.72 * half, middle + 0.72 * half)
        self._add(unit.wall, "Sink", across, (0.12, 0.56), (z - 0.22, z))
        basin = (across[0] + 0.05, across[1] - 0.05)
        self._add(unit.wall, "SinkBasin", basin, (0.20, 0.51), (z - 0.18, z - 0.015))
        self._add(unit.wall, "Faucet", (middle - 0.09, middle + 0.09), (0.10, 0.30), (z + 0.005, z + 0.27))

    def stove(self, unit: Unit) -> None:
        """Four burners and their knobs; what carries them follows from where they are."""
        middle = (unit.start + unit.end) / 2
        for row, away in enumerate((0.16, 0.41)):
            for column, side in enumerate((-0.14, 0.14)):
                along = (middle + side - BURNER_M / 2, middle + side + BURNER_M / 2)
                self._add(
                    unit.wall, "StoveBurner", along, (away - 0.1 + 0.02, away + 0.1 + 0.02), (TOP_M, TOP_M + 0.025)
                )
                x = middle + (row * 2 + column - 1.5) * 0.12
                knob = (x - KNOB_M / 2, x + KNOB_M / 2)
                self._add(unit.wall, "StoveKnob", knob, (0.578, 0.63), (TOP_M - 0.08, TOP_M - 0.03))
        low, high = unit.wall.box((unit.start + 0.02, unit.end - 0.02), (0.0, 0.6), (0.0, TOP_M))
        self.canvas.solids.append((low, high))

    def drawers(self, unit: Unit, count: int) -> None:
        """Drawers one above the other; a door takes the rest where they are few."""
        top, tall = TOP_M - SLAB_M - 0.02, TOP_M - SLAB_M - 0.02 - KICK_M
        each = tall / max(count, 3)
        gap = 0.008
        for number in range(count):
            z = (top - (number + 1) * each + gap, top - number * each)
            self._add(unit.wall, "Drawer", (unit.start + gap, unit.end - gap), (0.14, FRONT_M), z, True)
        if count < 3:
            z = (KICK_M, top - count * each - gap)
            self._door(unit.wall, unit.start, unit.end, z, (0.06, FRONT_M), bool(self.rng.random() < 0.5))

    def fridge(self, unit: Unit, pattern: FurnitureSet) -> bool:
        """A fridge as recorded."""
        turned = pattern.turned(QUARTERS_AT[unit.wall.side])
        shift = against(unit.wall, turned, (unit.start + unit.end) / 2, 0.02)
        low, high, clear = turned.low + shift, turned.high + shift, clearances(turned)
        placed = [(a + shift, b + shift) for a, b in clear]
        if not self.canvas.fits(low, high, placed):
            return False
        self.canvas.add([moved(row, UPRIGHT, shift) for row in turned.rows], placed)
        return True

    def worktops(self, units: Sequence[Unit]) -> None:
        """One worktop on each row of units between stove, fridge and corner."""
        pieces: list[tuple[Wall, float, float]] = []
        for unit in sorted(units, key=lambda u: (u.wall.side, u.start)):
            if unit.kind in ("stove", "fridge"):
                continue
            if pieces and pieces[-1][0] is unit.wall and abs(pieces[-1][2] - unit.start) < 1e-6:
                pieces[-1] = (unit.wall, pieces[-1][1], unit.end)
            else:
                pieces.append((unit.wall, unit.start, unit.end))
        for wall, start, end in pieces:
            self._add(wall, "CounterTop", (start, end), (0.0, DEPTH_M), (TOP_M - SLAB_M, TOP_M))
            self.canvas.solids.append(wall.box((start, end), (0.0, DEPTH_M - 0.04), (0.0, TOP_M)))

    def island(self) -> None:
        """A worktop in the middle of the room, where there is room for it, with two doors on its front."""
        x0, y0, x1, y1 = self.canvas.bounds
        for _ in range(ISLAND_TRIES):
            length, depth = float(self.rng.uniform(*ISLAND_M)), float(self.rng.uniform(*ISLAND_DEPTH_M))
            side = ("south", "west")[int(self.rng.integers(2))]
            x, y = float(self.rng.uniform(x0, x1)), float(self.rng.uniform(y0, y1))
            back, start = (y, x) if side == "south" else (x, y)
            wall = Wall(side, back, start, start + length, False)  # no wall, but the plane of the island's back
            low, high = wall.box((start, start + length), (0.0, depth), (0.0, TOP_M))
            around = np.array([AROUND_ISLAND_M, AROUND_ISLAND_M, 0.0])
            if self.canvas.fits(low, high, [(low - around, high + around)]):
                break
        else:
            return
        middle, z = start + length / 2, (KICK_M, TOP_M - SLAB_M - 0.02)
        for a, b, at_start in ((start + 0.04, middle, True), (middle, start + length - 0.04, False)):
            self._door(wall, a, b, z, (depth - FRONT_M + 0.06, depth - 0.02), at_start)
        self._add(wall, "CounterTop", (start, start + length), (0.0, depth), (TOP_M - SLAB_M, TOP_M))
        self.canvas.solids.append((low, high))

    def high_cabinets(self, units: Sequence[Unit], doors: int) -> None:
        """Cabinets on the wall above the worktops, where there is no window."""
        for unit in units:
            count = 2 if unit.end - unit.start > 0.7 else 1
            edges = np.linspace(unit.start, unit.end, count + 1)
            for index in range(count):
                start, end = float(edges[index]), float(edges[index + 1])
                low, high = unit.wall.box((start, end), (0.005, HIGH_DEPTH_M), HIGH_M)
                if (
                    doors <= 0
                    or unit.kind in ("fridge", "stove", "corner")
                    or not self.canvas.fits(low + FREE_M, high - FREE_M)
                ):
                    continue
                self._door(unit.wall, start, end, HIGH_M, (0.012, HIGH_DEPTH_M), index == 0)
                doors -= 1

    def _door(
        self,
        wall: Wall,
        start: float,
        end: float,
        z: tuple[float, float],
        away: tuple[float, float],
        hinge_at_start: bool,
    ) -> None:
        gap = 0.006
        row = self._add(wall, "Cabinet", (start + gap, end - gap), away, z, z[0] < 1.0)
        pivot = (row.low + row.high) / 2
        pivot[wall.axis] = wall.face + wall.inward * (away[1] - 0.01)
        pivot[1 - wall.axis] = start + gap if hinge_at_start else end - gap
        self.canvas.rows[-1] = replace(self.canvas.rows[-1], pivot=pivot)

    def _add(
        self,
        wall: Wall,
        type_: str,
        along: tuple[float, float],
        away: tuple[float, float],
        z: tuple[float, float],
        opens: bool = False,
    ) -> RecordedObject:
        low, high = wall.box(along, away, z)
        row = new_row(self.flags[type_], low, high, wall)
        self.canvas.add([row], [before(row)] if opens else [])
        return self.canvas.rows[-1]


def new_row(flags: RecordedObject, low: F64, high: F64, wall: Wall) -> RecordedObject:
    """An object of a type with its back to a wall."""
    front = np.zeros(3)
    front[wall.axis] = wall.inward
    rotation = axes_facing(front)
    centre = (low + high) / 2
    return replace(
        flags,
        pivot=centre.copy(),
        low=low,
        high=high,
        centre=centre,
        size=arithmetic.turned_back(high - low, np.abs(rotation)),
        rotation=rotation,
        is_oriented=False,
        openness=0.0,
        parents=(),
    )
