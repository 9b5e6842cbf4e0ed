"""Rooms without end: new floor plans after the statistics of the 120 recorded ones.

`sampled_scene(7, seed=0)` is a room of its own, the same in every process. A new room takes the size and the inventory of
recorded ones, pieces of furniture as they were recorded with the drawers that are in them, and arranges all of it anew:
kitchens are built unit by unit along the walls, other furniture is put where it was recorded (at walls, in corners) or
where people put it (chairs at tables), and things lie on what such things were recorded on. Every door and drawer can
be reached.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.catalog import object_type, types_with
from remqa_data.errors import ArrangementError
from remqa_data.floorplans.ithor.plan import RoomShell
from remqa_data.floorplans.ithor.scenes import furnished
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.floorplans.sampled.canvas import DOOR_CLEAR_M, Canvas, Wall
from remqa_data.floorplans.sampled.furnishing import SEATS, furnish
from remqa_data.floorplans.sampled.furniture_sets import BUILT, FurnitureSet
from remqa_data.floorplans.sampled.kitchen import build_kitchen, new_row
from remqa_data.floorplans.sampled.naming import ROOM_TYPES, room_type_of, sampled_name
from remqa_data.floorplans.sampled.small_objects import put_small_objects
from remqa_data.floorplans.sampled.statistics import (
    ROOMS_OF_A_TYPE,
    Inventory,
    RecordedRooms,
    flags_by_type,
    recorded_rooms,
)
from remqa_data.geometry.types import Rect
from remqa_data.scene import Scene
from remqa_data.sim.navigation.grid import cells_in_reach, reachable_grid
from remqa_data.sim.navigation.viewpoints import front_points
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

ATTEMPTS = 40
"""So many rooms are drawn for one index before it counts as impossible."""
ATTEMPTS_PER_MODEL = 10
"""After so many the room is modelled on another recorded one."""
FROM_SECOND = 0.25
"""Of each kind, the number comes from a second recorded room with this chance, from the first one else."""
TOGETHER = {"Chair": "DiningTable", "Stool": "DiningTable"}
"""Kinds whose number comes from the same room as that of others."""
SIZE_SPREAD = 0.06
FLOOR_IN_USE = {"kitchen": 0.9, "living_room": 0.97, "bedroom": 1.0, "bathroom": 0.9}
"""Share of a recorded room's floor that a new one has: some were recorded with niches and stairs behind inner walls."""
L_SHAPED = 0.3
NOTCH_SHARE = (0.25, 0.42)
MIN_NOTCH_SIDE_M = 3.0
"""Rooms with a shorter side than this stay rectangular."""
DOOR_M = (0.9, 0.035, 2.03)
LARGER = 0.08
"""For each drawer and shelf in it, a pattern is drawn so much more often."""
MOST_LEFT = 0.1
"""A room is drawn anew when more than this share of its pieces found no place, or one with any of the following; seats do
not count, as there can be fewer."""
NEVER_LEFT = BUILT | types_with("makes_the_room")
KITCHEN_UNITS = BUILT - {"Shelf"} | {"StoveBurner", "StoveKnob", "Fridge", "Washstand", "Cupboard"}


def sampled_scene(index: int, seed: int, draw: int = 0) -> Scene:
    """A new room.

    Parameters
    ----------
    index : int
        Which; the room's type is that of the index modulo 4.
    seed : int
        Of the dataset.
    draw : int
        Another room for the same index, when one cannot be used.

    Raises
    ------
    ArrangementError
        If no room could be made; one draw in many thousands.
    ValueError
        If the index or the seed is negative.
    """
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng(np.random.SeedSequence([seed, index, draw, attempt]))
        made = sampled_rows(index, rng, model_of(index, seed, draw + attempt // ATTEMPTS_PER_MODEL))
        if made is None:
            continue
        scene = furnished(*made)
        if not out_of_reach(scene):
            return scene
    msg = f"{sampled_name(index)}: no room could be made in {ATTEMPTS} attempts; use another seed"
    raise ArrangementError(msg, "", "", ())


def model_of(index: int, seed: int, turn: int = 0) -> int:
    """Which recorded room of its type, 0 to 29, an index takes size and inventory from.

    In 30 rooms of a type each is once, so even few rooms are as the recorded ones are. A `turn` says how many did not do.
    """
    cycle, place = divmod(index // len(ROOM_TYPES), ROOMS_OF_A_TYPE)
    order = np.random.default_rng(np.random.SeedSequence([seed, index % len(ROOM_TYPES), cycle]))
    return int(order.permutation(ROOMS_OF_A_TYPE)[(place + turn) % ROOMS_OF_A_TYPE])


def sampled_rows(index: int, rng: np.random.Generator, model: int) -> tuple[list[RecordedObject], RoomShell] | None:
    """The floor plan of a new room, as rows of the same form as the recorded ones, and its walls; None if it failed.

    `model` is as `model_of` gives it.
    """
    room_type = room_type_of(index)
    rooms = recorded_rooms(room_type)
    second = rooms.inventories[int(rng.integers(len(rooms.inventories)))]
    inventory = _mixed(rooms.inventories[model], second, rng)
    canvas = _empty_room(sampled_name(index), inventory, rng)
    if not _put_door(canvas, rng):
        return None
    pieces = _chosen(inventory.kinds, rooms, rng, room_type)
    if room_type == "kitchen":
        windows = [piece for piece in pieces if piece.kind == "Window"]
        pieces = [piece for piece in pieces if piece.kind != "Window"]
        if not build_kitchen(canvas, inventory, rooms.patterns["Fridge"], windows, rng):
            return None
        pieces += windows
    left = furnish(canvas, pieces, rng)
    left = furnish(canvas, [_pattern(rooms.patterns[piece.kind], rng) for piece in left], rng)
    missing = [piece for piece in left if piece.kind not in SEATS]
    if len(missing) > MOST_LEFT * len(pieces) or any(row.type in NEVER_LEFT for piece in left for row in piece.rows):
        return None
    put_small_objects(canvas, inventory.things, rooms, rng)
    shell = RoomShell(0.0, canvas.bounds, canvas.height, () if canvas.notch is None else (canvas.notch,), canvas.door)
    return [replace(row, room=room_type) for row in canvas.rows], shell


def out_of_reach(scene: Scene) -> list[str]:
    """What can be opened in a room but not be reached."""
    with World(scene) as world:
        world.settle()
        grid, view = reachable_grid(world), WorldView(world)
        openable = [name for name in world.ids if object_type(world.type_of(name)).is_container]
        return [name for name in openable if not cells_in_reach(grid, front_points(view, name))]


def _mixed(first: Inventory, second: Inventory, rng: np.random.Generator) -> Inventory:
    """The inventory of one recorded room, with some kinds as another has them."""

    def mix(a: Counter[str], b: Counter[str]) -> Counter[str]:
        keys = sorted(a.keys() | b.keys())
        from_second = {key: bool(rng.random() < FROM_SECOND) for key in keys}
        return Counter({key: (b if from_second.get(TOGETHER.get(key, key), False) else a)[key] for key in keys})

    size = first.size * rng.uniform(1 - SIZE_SPREAD, 1 + SIZE_SPREAD, 2)
    types = first.types if rng.random() > FROM_SECOND else second.types
    return Inventory(size, first.height, mix(first.kinds, second.kinds), mix(first.things, second.things), types)


def _empty_room(name: str, inventory: Inventory, rng: np.random.Generator) -> Canvas:
    size = inventory.size * np.sqrt(FLOOR_IN_USE[name.split("-")[1]])
    notch: Rect | None = None
    is_l_shaped = rng.random() < L_SHAPED and size.min() >= MIN_NOTCH_SIDE_M
    share = rng.uniform(*NOTCH_SHARE, size=2)
    if is_l_shaped:
        size /= np.sqrt(1 - np.prod(share))
    if rng.random() < 0.5:
        size = size[::-1]
    size = np.round(size, 2)
    x1, y1 = size / 2
    bounds = (-float(x1), -float(y1), float(x1), float(y1))
    if is_l_shaped:
        w, d = np.round(size * share, 2)
        at_west, at_south = rng.random(2) < 0.5
        x = (-x1, -x1 + w) if at_west else (x1 - w, x1)
        y = (-y1, -y1 + d) if at_south else (y1 - d, y1)
        notch = (float(x[0]), float(y[0]), float(x[1]), float(y[1]))
    canvas = Canvas(name, bounds, float(np.clip(inventory.height, 2.4, 3.2)), notch)
    low, high = np.array([*bounds[:2], -0.05]), np.array([*bounds[2:], 0.0])
    canvas.add([new_row(flags_by_type()["Floor"], low, high, Wall("north", 0.0, 0.0, 1.0))])
    return canvas


def _put_door(canvas: Canvas, rng: np.random.Generator) -> bool:
    """Put a closed door into an outer wall, with free floor before it; whether there was room for one."""
    width, depth, height = DOOR_M
    walls = [wall for wall in canvas.walls() if wall.is_outer and wall.length > width + 0.3]
    for _ in range(20):
        wall = walls[int(rng.integers(len(walls)))]
        start = float(rng.uniform(wall.start + 0.12, wall.end - width - 0.12))
        box = wall.box((start, start + width), (0.0, depth), (0.0, height))
        clear = wall.box((start + 0.05, start + width - 0.05), (depth + 0.02, DOOR_CLEAR_M), (0.0, height))
        if canvas.fits(*box, [clear]):
            canvas.door = box
            canvas.solids.append(box)
            canvas.kept_clear.append(clear)
            return True
    return False


def _chosen(kinds: Counter[str], rooms: RecordedRooms, rng: np.random.Generator, room_type: str) -> list[FurnitureSet]:
    """A pattern for each piece of an inventory."""
    skipped = KITCHEN_UNITS if room_type == "kitchen" else ()
    kinds_left = [kind for kind in kinds.elements() if kind in rooms.patterns and kind not in skipped]
    return [_pattern(rooms.patterns[kind], rng) for kind in kinds_left]


def _pattern(patterns: Sequence[FurnitureSet], rng: np.random.Generator) -> FurnitureSet:
    """One of some patterns; large ones somewhat more often, as they find a place less often."""
    weights = np.array([1 + LARGER * (len(piece.rows) - 1) for piece in patterns])
    return patterns[int(rng.choice(len(patterns), p=weights / weights.sum()))]
