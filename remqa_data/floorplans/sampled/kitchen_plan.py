"""Where the units of a kitchen go: sink, stove, fridge, doors and drawers in a row along one wall or round a corner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.floorplans.sampled.canvas import Canvas, Wall

DEPTH_M = 0.62
"""Of a worktop."""
CORNER_M = 0.66
"""Of a wall's run, in a corner where another run begins: no door there could open."""
UNITS_M = {"sink": 0.92, "stove": 0.62, "drawers": 0.48, "cabinet": 0.50}
STRAIGHT_CHANCE = 0.3
"""Other kitchens go round a corner."""
FILL_CHANCE = 0.6
"""A worktop goes on for one more door with this chance, as long as there is wall left."""
SPREAD = 0.12
"""Widths of units in different kitchens differ by at most this share."""


@dataclass(frozen=True)
class Unit:
    """A piece of a run of units: what it is and where along its wall."""

    kind: str
    wall: Wall
    start: float
    end: float


def lay_out(canvas: Canvas, stacks: int, doors: int, fridge_m: float, rng: np.random.Generator) -> list[Unit] | None:
    """Units along one wall, or round a corner; None if the room has no wall for them.

    Parameters
    ----------
    canvas : Canvas
        The empty room.
    stacks, doors : int
        Number of units with drawers, and with a door.
    fridge_m : float
        Width of the fridge's place, metres.
    rng : numpy.random.Generator
        Draws walls and the order of units.
    """
    scale = 1 + rng.uniform(-SPREAD, SPREAD)
    widths = {kind: width * scale for kind, width in UNITS_M.items()} | {"fridge": fridge_m, "corner": CORNER_M}
    widths["stove"] = UNITS_M["stove"]
    outer = [wall for wall in canvas.walls() if wall.is_outer and wall.length > 1.8]
    for _ in range(30):
        more = [*["drawers"] * stacks, *["cabinet"] * doors]
        first = outer[int(rng.integers(len(outer)))]
        second = [wall for wall in outer if wall.axis != first.axis and _meet(first, wall)]
        is_straight = rng.random() < STRAIGHT_CHANCE or not second
        runs = [first] if is_straight else [first, second[int(rng.integers(len(second)))]]
        order = ["sink", *(more[i] for i in rng.permutation(len(more)))]
        cut = int(rng.integers(1, len(order) + 1))
        order.insert(cut, "stove")
        if rng.random() < 0.5:
            order.insert(max(cut, 1), order.pop())
        units = _along(runs, [*order, "fridge"], widths, canvas, rng)
        if units is not None:
            return units
    return None


def _along(
    runs: Sequence[Wall],
    kinds: Sequence[str],
    widths: dict[str, float],
    canvas: Canvas,
    rng: np.random.Generator,
) -> list[Unit] | None:
    """Units one after the other, from the corner of two walls or from a wall's end; None if they do not fit."""
    waiting = list(kinds)
    units: list[Unit] = []
    for index, wall in enumerate(runs):
        other = runs[1 - index].face if len(runs) == 2 else wall.start
        forward = abs(other - wall.start) < abs(other - wall.end)
        at = 0.0
        placed: list[tuple[str, float, float]] = []
        if len(runs) == 2:
            at = CORNER_M
            if index == 0:
                placed.append(("corner", 0.0, CORNER_M))
        last = index == len(runs) - 1
        fridge_m = widths["fridge"] if last else 0.0
        while waiting and waiting[0] != "fridge":
            width = widths[waiting[0]]
            if at + width + fridge_m > wall.length - 0.01:
                break
            placed.append((waiting.pop(0), at, at + width))
            at += width
        while rng.random() < FILL_CHANCE and at + widths["cabinet"] + fridge_m <= wall.length - 0.01:
            placed.append(("cabinet", at, at + widths["cabinet"]))
            at += widths["cabinet"]
        if last and at + fridge_m <= wall.length:
            placed.append(("fridge", at, at + fridge_m))
        for kind, a, b in placed:
            start, end = (wall.start + a, wall.start + b) if forward else (wall.end - b, wall.end - a)
            units.append(Unit(kind, wall, start, end))
    kinds_placed = {unit.kind for unit in units}
    if not {"sink", "stove", "fridge"} <= kinds_placed or len([k for k in waiting if k != "fridge"]) > 1:
        return None
    for unit in units:
        depth = DEPTH_M if unit.kind != "fridge" else 0.8
        low, high = unit.wall.box((unit.start, unit.end), (0.0, depth), (0.0, 2.2))
        ahead = unit.wall.box((unit.start, unit.end), (depth, depth + 0.5), (0.0, 1.8))
        if not canvas.fits(low, high, [] if unit.kind == "corner" else [ahead]):
            return None
    return units


def _meet(a: Wall, b: Wall) -> bool:
    """Whether two walls meet in a corner of the room."""
    return b.face in (a.start, a.end) and a.face in (b.start, b.end)
