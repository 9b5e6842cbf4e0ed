"""Puts pieces into a room: each kind where such pieces were recorded, or where people put them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.backs import ON_WALLS
from remqa_data.floorplans.ithor.extent import IN_WALLS
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.floorplans.sampled.canvas import QUARTERS_AT, Canvas, Wall, clearances
from remqa_data.floorplans.sampled.furniture_sets import QUARTERS, FurnitureSet, moved
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

TRIES = 60
"""Places that are looked at for one piece."""
SEAT_GAP_M, SOFA_TO_TABLE_M, SOFA_TO_TV_M = 0.03, (0.4, 0.6), (1.8, 3.2)
FROM_DOOR_M = (0.06, 0.3)
NEXT_TO_M = (0.03, 0.12)
SEATS = types_with("drawn_up_seat")
CORNER_CHANCE = 0.45
UPRIGHT, FORWARD = np.eye(3), np.array([0.0, -1.0, 0.0])
"""No turn at all, and where pieces face in their own frame."""

Placement = tuple[FurnitureSet, F64]
"""A piece, turned, and where its origin goes."""


def furnish(canvas: Canvas, pieces: Sequence[FurnitureSet], rng: np.random.Generator) -> list[FurnitureSet]:
    """Put pieces into a room, those that need most room first; returns those for which there was none."""
    left = []
    for piece in sorted(pieces, key=_turn):
        if not put(canvas, piece, _places(canvas, piece, rng)):
            left.append(piece)
    return left


def put(canvas: Canvas, piece: FurnitureSet, places: Iterator[Placement]) -> bool:
    """Put a piece at the first of some places where it fits and leaves the room walkable."""
    into_wall_m = 0.3 if piece.kind in IN_WALLS else 0.0
    for turned, shift in islice(places, TRIES):
        low, high = turned.low + shift, turned.high + shift
        rows = [moved(row, UPRIGHT, shift) for row in turned.rows]
        clear = [(a + shift, b + shift) for a, b in clearances(turned)]
        if not canvas.fits(low, high, clear, into_wall_m):
            continue
        if turned.is_hung or canvas.is_walkable([(low, high)], clear):
            canvas.add(rows, clear, [replace(spot, point=spot.point + shift) for spot in turned.spots])
            canvas.solids += [(a + shift, b + shift) for a, b in turned.bases]
            return True
    return False


def at_wall(
    canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator, walls: Sequence[Wall] | None = None
) -> Iterator[Placement]:
    """Places at walls, with the sides that were recorded at one at one."""
    side = next((name for name in ("back", "left", "right") if name in piece.gaps), "back")
    others = [name for name in piece.gaps if name in ("left", "right") and name != side]
    walls = canvas.walls() if walls is None else walls
    walls = [wall for wall in walls if wall.is_outer or not (others or piece.kind in ON_WALLS)]
    while walls:
        wall = walls[int(rng.choice(len(walls), p=np.array([w.length for w in walls]) / sum(w.length for w in walls)))]
        turned = piece.turned(QUARTERS_AT[wall.side] + {"back": 0, "right": 1, "left": 3}[side])
        half = float((turned.high - turned.low)[1 - wall.axis]) / 2
        gap = piece.gaps.get(others[0], 0.0) if others else float(rng.uniform(0.01, 0.04))
        ends = (wall.start + half + max(gap, 0.004), wall.end - half - max(gap, 0.004))
        if others:
            to_end = (others[0] == "right") == (wall.side in ("north", "west"))
            along = ends[1] if to_end else ends[0]
        elif ends[1] <= ends[0]:
            yield piece, np.array([99.0, 99.0, 0.0])
            continue
        elif rng.random() < CORNER_CHANCE and not piece.is_hung:
            along = ends[int(rng.integers(2))]
        else:
            along = float(rng.uniform(*ends))
        yield turned, against(wall, turned, along, piece.gaps.get(side, 0.01))


def against(wall: Wall, turned: FurnitureSet, along: float, gap: float) -> F64:
    """Where a turned piece goes to stand at a wall with its middle somewhere along it."""
    shift = np.zeros(3)
    reach = turned.low if wall.inward > 0 else turned.high
    shift[wall.axis] = wall.face + wall.inward * gap - reach[wall.axis]
    shift[1 - wall.axis] = along - (turned.low + turned.high)[1 - wall.axis] / 2
    return shift


def anywhere(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    """Places on the floor, turned any way by quarters."""
    x0, y0, x1, y1 = canvas.bounds
    while True:
        turned = piece.turned(int(rng.integers(4)))
        yield turned, np.array([rng.uniform(x0, x1), rng.uniform(y0, y1), 0.0])


def beside(
    piece: FurnitureSet,
    row: RecordedObject,
    sides: Sequence[str],
    gap: tuple[float, float],
    rng: np.random.Generator,
    facing: str,
    spread: float = 0.0,
) -> Iterator[Placement]:
    """Places at some sides of an object, looking "at" it, "away" from it or the "same" way."""
    right, front = row.rotation[:, 0].round(), row.front.round()
    directions = {"front": front, "back": -front, "left": -right, "right": right}
    while True:
        side = sides[int(rng.integers(len(sides)))]
        out = directions[side]
        wanted = {"at": -out, "away": out, "same": front}[facing]
        quarters = next(
            (q for q in range(4) if arithmetic.dot(arithmetic.turned(FORWARD, QUARTERS[q]), wanted) > 0.9), 0
        )
        turned = piece.turned(quarters)
        axis = int(np.abs(out[:2]).argmax())
        middle, half = (row.low + row.high) / 2, (row.high - row.low) / 2
        own = (turned.high - turned.low) / 2
        shift = np.zeros(3)
        shift[axis] = middle[axis] + out[axis] * (half[axis] + own[axis] + rng.uniform(*gap))
        shift[1 - axis] = middle[1 - axis] + rng.uniform(-1, 1) * spread * max(half[1 - axis] - own[1 - axis], 0.0)
        if facing == "same" and side in ("left", "right"):  # backs in line
            back = int(np.abs(front[:2]).argmax())
            edge = row.low if front[back] > 0 else row.high
            mine = turned.low if front[back] > 0 else turned.high
            shift[back] = edge[back] - mine[back]
        yield turned, shift


# ---- what goes where


def _places(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    rule = _RULES.get(piece.kind)
    if rule is not None:
        yield from islice(rule(canvas, piece, rng), TRIES // 2)
    if piece.kind in SEATS and _found(canvas, "StoveBurner"):
        return  # in a kitchen nobody sits but at a table
    if piece.kind == "DiningTable" and not piece.gaps:
        yield from anywhere(canvas, piece, rng)
    yield from at_wall(canvas, piece, rng)


def _found(canvas: Canvas, *types: str) -> list[RecordedObject]:
    return [row for row in canvas.rows if row.type in types]


def _some(rows: Sequence[RecordedObject], rng: np.random.Generator) -> list[RecordedObject]:
    return [rows[int(i)] for i in rng.permutation(len(rows))]


def _seat(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    tables = _found(canvas, "DiningTable")
    for desk in _some(_found(canvas, "Desk"), rng):
        yield from islice(beside(piece, desk, ["front"], (SEAT_GAP_M, 0.1), rng, "at", 0.8), 6)
    for table in _some(tables, rng):
        sides = ["front", "back", "left", "right"]
        yield from islice(beside(piece, table, sides, (SEAT_GAP_M, 0.1), rng, "at", 0.8), 16)
    for worktop in _found(canvas, "CounterTop") if piece.kind == "Stool" or not tables else ():
        yield from islice(beside(piece, worktop, ["back", "left", "right"], (SEAT_GAP_M, 0.1), rng, "at", 0.8), 8)


def _coffee_table(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    width, depth = (piece.high - piece.low)[:2]
    for sofa in _some(_found(canvas, "Sofa"), rng):
        yield from islice(
            beside(piece if width >= depth else piece.turned(1), sofa, ["front"], SOFA_TO_TABLE_M, rng, "same", 0.3), 12
        )


def _arm_chair(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    if piece.gaps:
        return
    for table in _some(_found(canvas, "CoffeeTable"), rng):
        sides = ["front", "back", "left", "right"]
        yield from islice(beside(piece, table, sides, (0.35, 0.6), rng, "at", 0.8), 14)


def _sofa(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    for screen in _found(canvas, "TVStand", "Television", "Dresser")[:1]:
        if "back" not in piece.gaps:
            yield from islice(beside(piece, screen, ["front"], SOFA_TO_TV_M, rng, "at"), 12)
        else:
            axis = int(np.abs(screen.front[:2]).argmax())
            opposite = [w for w in canvas.walls() if w.axis == axis and w.inward * screen.front[axis] < 0]
            yield from islice(at_wall(canvas, piece, rng, opposite), 16)


def _side_table(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    if set(piece.gaps) & {"left", "right"}:
        return
    for seat in _some(_found(canvas, "Bed", "Sofa", "ArmChair"), rng):
        yield from islice(beside(piece, seat, ["left", "right"], NEXT_TO_M, rng, "same"), 6)


def _near(types: Sequence[str], gap: tuple[float, float]) -> Rule:
    """A rule that puts pieces next to what stands at a wall, their backs in line."""

    def rule(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
        for row in _some(_found(canvas, *types), rng):
            yield from islice(beside(piece, row, ["left", "right"], gap, rng, "same"), 8)

    return rule


def _mirror(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    for row in _some(_found(canvas, "Sink", "Dresser", "Desk"), rng):
        for wall in canvas.walls():
            axis = wall.axis
            if wall.is_outer and float(row.front[axis] * wall.inward) > 0.9:
                turned = piece.turned(QUARTERS_AT[wall.side])
                middle = float((row.low + row.high)[1 - axis]) / 2
                if abs(float((row.low if wall.inward > 0 else row.high)[axis]) - wall.face) < 0.5:
                    yield turned, against(wall, turned, middle, piece.gaps.get("back", 0.01))


def _hanger(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    for toilet in _found(canvas, "Toilet"):
        middle = (toilet.low + toilet.high) / 2
        for wall in canvas.walls():
            if wall.is_outer and abs(middle[wall.axis] - wall.face) < 1.0:
                turned = piece.turned(QUARTERS_AT[wall.side])
                for away in rng.uniform(-0.8, 0.8, 8):
                    along = float(middle[1 - wall.axis] + away)
                    yield turned, against(wall, turned, along, piece.gaps.get("back", 0.01))


def _light_switch(canvas: Canvas, piece: FurnitureSet, rng: np.random.Generator) -> Iterator[Placement]:
    if canvas.door is None:
        return
    low, high = canvas.door
    for wall in (wall for wall in canvas.walls() if wall.is_outer and _is_in(canvas.door, wall)):
        turned = piece.turned(QUARTERS_AT[wall.side])
        half = float((turned.high - turned.low)[1 - wall.axis]) / 2
        for gap in rng.uniform(*FROM_DOOR_M, 4):
            for along in (low[1 - wall.axis] - gap - half, high[1 - wall.axis] + gap + half):
                if wall.start + half < along < wall.end - half:
                    yield turned, against(wall, turned, float(along), piece.gaps.get("back", 0.01))


def _is_in(door: tuple[F64, F64], wall: Wall) -> bool:
    return bool(min(abs(corner[wall.axis] - wall.face) for corner in door) < 1e-6)


Rule = Callable[[Canvas, FurnitureSet, np.random.Generator], Iterator[Placement]]
_RULES: dict[str, Rule] = {
    "Chair": _seat,
    "Stool": _seat,
    "CoffeeTable": _coffee_table,
    "ArmChair": _arm_chair,
    "Sofa": _sofa,
    "SideTable": _side_table,
    "LightSwitch": _light_switch,
    "Mirror": _mirror,
    "ToiletPaperHanger": _hanger,
    "Plunger": _near(["Toilet"], (0.03, 0.3)),
    "ScrubBrush": _near(["Toilet"], (0.03, 0.3)),
    "FloorLamp": _near(["Sofa", "ArmChair"], NEXT_TO_M),
}
_FIRST = [
    "Window",
    "Curtains",
    "Bathtub",
    "Shower",
    "Washstand",
    "Toilet",
    "Bed",
    "TVStand",
    "Desk",
    "Dresser",
    "ShelvingUnit",
    "Cupboard",
    "Television",
    "Fridge",
    "Sofa",
    "DiningTable",
    "CoffeeTable",
    "SideTable",
    "ArmChair",
]


def _turn(piece: FurnitureSet) -> tuple[int, float]:
    """When it is a piece's turn: what other things depend on first, then the larger ones."""
    place = _FIRST.index(piece.kind) if piece.kind in _FIRST else len(_FIRST)
    return place, -float(np.prod((piece.high - piece.low)[:2]))
