"""What the recorded rooms of a type say about such rooms: their sizes, what is in them together, and where things lie."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.extent import IN_WALLS
from remqa_data.floorplans.ithor.plan import RoomShell
from remqa_data.floorplans.ithor.scenes import understood
from remqa_data.floorplans.ithor.table import RecordedObject, recorded_objects, scene_names
from remqa_data.floorplans.sampled.furniture_sets import CABIN, WET, FurnitureSet, groups_of, kind_of, piece_from
from remqa_data.floorplans.sampled.naming import ROOM_TYPES
from remqa_data.geometry.types import F64

ROOMS_OF_A_TYPE = 30
AT_WALLS = types_with("at_wall") | {"Cupboard", "ShelfOnWall", "Shower", "Washstand"}
"""Pieces of these kinds serve as patterns only where their back was at a wall."""
BACKED = types_with("recorded_at_wall") | {"Cupboard", "Washstand"}
"""Of these it is sure that their back was at some wall."""
BACK_GAP_M = 0.01
WINDOW_DEPTH_M = 0.35
"""Windows with deeper curtains than this stood in niches."""
WET_BULKY_M = 1.7
BULKY_M = (2.75, 1.5)
"""Longer and deeper pieces are no patterns, but beds and sofas: they were made for their room."""
STORING = types_with("built_in")
"""A cupboard has one of these; else it is a tap on a wall, or a worktop alone."""
CABIN_M = 0.9
"""The least width of a shower cabin."""
ON_FLOORS = types_with("stands_about")
"""What can be carried and was recorded standing about on the floor, in a way of its own."""
ON_SURFACES = types_with("stands_on_furniture")
"""What stands on furniture, even where the recording does not say on which."""


@dataclass(frozen=True, eq=False)
class Inventory:
    """What is in one recorded room.

    Attributes
    ----------
    size : (2,) array
        Longer and shorter side of the floor, metres.
    height : float
        Of the ceiling above the floor, metres.
    kinds : Counter of str
        Number of pieces of each kind.
    things : Counter of str
        Number of things of each type that lie on or in pieces.
    types : Counter of str
        Number of objects of each type.
    """

    size: F64
    height: float
    kinds: Counter[str]
    things: Counter[str]
    types: Counter[str]


@dataclass(frozen=True, eq=False)
class RecordedRooms:
    """The 30 recorded rooms of a type.

    Attributes
    ----------
    inventories : tuple of Inventory
        One for each room.
    patterns : mapping of str to tuple of FurnitureSet
        Pieces by kind, from which new ones are made.
    things : mapping of str to tuple of RecordedObject
        Upright things by type, from which new ones are made.
    heights : mapping of str to (n,) array
        By type of receptacle, how high things lie in it, as shares of its height.
    """

    inventories: tuple[Inventory, ...]
    patterns: Mapping[str, tuple[FurnitureSet, ...]]
    things: Mapping[str, tuple[RecordedObject, ...]]
    heights: Mapping[str, F64]


@lru_cache(maxsize=len(ROOM_TYPES))
def recorded_rooms(room_type: str) -> RecordedRooms:
    """What the recorded rooms of a type say; takes a second or two the first time."""
    first = ROOM_TYPES.index(room_type) * ROOMS_OF_A_TYPE
    inventories: list[Inventory] = []
    patterns: dict[str, list[FurnitureSet]] = {}
    things: dict[str, list[RecordedObject]] = {}
    heights: dict[str, list[float]] = {}
    for name in scene_names()[first : first + ROOMS_OF_A_TYPE]:
        objects, shell = understood(recorded_objects(name))
        groups = [group for group in groups_of(objects) if _is_piece(group)]
        taken = {o.id for group in groups for o in group} | {o.id for o in objects if o.type == "Floor"}
        loose = [o for o in objects if o.id not in taken]
        for piece in (piece_from(group, objects, shell) for group in groups):
            pattern = _pattern(piece)
            if pattern is not None:
                patterns.setdefault(piece.kind, []).append(pattern)
        for thing in loose:
            if thing.rotation[2, 2] > 0.99:
                things.setdefault(thing.type, []).append(thing)
        for receptacle_type, share in _rests(objects):
            heights.setdefault(receptacle_type, []).append(share)
        inventories.append(_inventory(objects, shell, (kind_of(group) for group in groups), loose))
    return RecordedRooms(
        tuple(inventories),
        {kind: tuple(pieces) for kind, pieces in patterns.items()},
        {type_: tuple(found) for type_, found in things.items()},
        {type_: np.array(shares) for type_, shares in heights.items()},
    )


@lru_cache(maxsize=1)
def flags_by_type() -> Mapping[str, RecordedObject]:
    """One recorded object of each type, which says what can be done with such objects."""
    return {o.type: o for name in scene_names() for o in recorded_objects(name)}


def _is_piece(group: Sequence[RecordedObject]) -> bool:
    """Whether a group is a piece, and not something that happens to lie on the floor or on what was not recorded."""
    main = group[0]
    if main.pickupable and main.type not in ON_FLOORS:
        return False
    return main.type not in ON_SURFACES


def _pattern(piece: FurnitureSet) -> FurnitureSet | None:
    """A piece as it can stand in other rooms, too; None if it cannot."""
    sides, types = set(piece.gaps), {row.type for row in piece.rows}
    long, short = sorted((piece.high - piece.low)[:2], reverse=True)
    if "front" in sides and piece.kind in AT_WALLS:
        return None
    if piece.kind in BACKED and "back" not in sides:  # its wall was an inner one, which was not recorded
        piece = replace(piece, gaps={"back": BACK_GAP_M})
    elif {"left", "right"} <= sides:
        piece = replace(piece, gaps={side: gap for side, gap in piece.gaps.items() if side != "right"})
    if piece.kind in AT_WALLS and "back" not in piece.gaps and not (piece.kind in WET and piece.gaps):
        return None
    if piece.kind == "Cupboard" and (piece.is_hung or not types & STORING):
        return None
    if piece.kind == "Shower" and not (types >= CABIN and len(piece.gaps) > 1 and short > CABIN_M):
        return None  # it was in a niche, or recorded in several pieces
    if piece.kind in IN_WALLS and (piece.high - piece.low)[1] > WINDOW_DEPTH_M:
        return None
    is_bulky = long > BULKY_M[0] or short > (BULKY_M[1] if piece.kind not in WET else WET_BULKY_M)
    return piece if piece.kind in ("Bed", "Sofa") or not is_bulky else None


def _rests(objects: Sequence[RecordedObject]) -> Iterable[tuple[str, float]]:
    """Type of receptacle, and how high something lies in it."""
    by_id = {o.id: o for o in objects}
    for o in objects:
        for parent in (by_id[p] for p in o.parents if p in by_id):
            share = float((o.low - parent.low)[2] / (parent.high - parent.low)[2])
            if o.pickupable and parent.type != "Floor" and -0.05 < share < 1.1:
                yield parent.type, share


def _inventory(
    objects: Sequence[RecordedObject], shell: RoomShell, kinds: Iterable[str], loose: Sequence[RecordedObject]
) -> Inventory:
    x0, y0, x1, y1 = shell.bounds
    return Inventory(
        np.array(sorted((x1 - x0, y1 - y0), reverse=True)),
        shell.height,
        Counter(kinds),
        Counter(o.type for o in loose),
        Counter(o.type for o in objects),
    )
