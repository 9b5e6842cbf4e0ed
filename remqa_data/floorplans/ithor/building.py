"""Walls with window openings, inner walls behind what hangs in the room, ceiling and skirting."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.assets.core.fitting import box_of
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks.materials import CHROME, COLORS
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.floorplans.ithor.backs import ON_WALLS
from remqa_data.floorplans.ithor.plan import SIDES, RoomShell
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Box, Vec3
from remqa_data.scene import StructureBox

WALL_M = 0.12
OUTER_M = 0.60
"""A second skin this far outside closes the view through hairline cracks between wall panels."""
FRAME_M, HANDLE_HEIGHT_M = 0.06, 1.02
SKIRTING_M = (0.012, 0.08)
INNER_WALL_M = 0.08
ON_INNER_WALL_M = 0.14
"""A thing on a wall whose back is farther than this from every outer wall hangs on an inner one."""
FILL_M = 0.75
"""Between an inner wall and an outer one that is nearer than this there is no room: it is filled."""

PAINTS: dict[str, tuple[Vec3, ...]] = {
    "kitchen": ((0.93, 0.90, 0.82), (0.86, 0.89, 0.86), (0.94, 0.93, 0.91), (0.90, 0.84, 0.74)),
    "living_room": ((0.88, 0.86, 0.81), (0.80, 0.83, 0.84), (0.91, 0.88, 0.80), (0.78, 0.80, 0.73)),
    "bedroom": ((0.85, 0.87, 0.90), (0.91, 0.87, 0.84), (0.86, 0.88, 0.82), (0.90, 0.89, 0.86)),
    "bathroom": ((0.92, 0.94, 0.94), (0.84, 0.90, 0.90), (0.93, 0.91, 0.87), (0.88, 0.90, 0.93)),
}
WALLPAPERS = ("plaster", "plaster", "wallpaper_stripe", "wallpaper_damask")


def building(objects: Sequence[RecordedObject], shell: RoomShell, rng: np.random.Generator) -> list[StructureBox]:
    """Outer walls, inner walls, ceiling and skirting of a room."""
    finish = _wall_finish(objects[0].room, rng)
    openings = [_opening(o) for o in objects if o.type == "Window"]
    x0, y0, x1, y1 = shell.bounds
    bottom, top = shell.floor_z - 0.05, shell.floor_z + shell.height
    parts = [StructureBox("ceiling", (x0 - WALL_M, y0 - WALL_M, top, x1 + WALL_M, y1 + WALL_M, top + 0.1), _CEILING)]
    floor = next(o for o in objects if o.type == "Floor")
    parts += [
        StructureBox("floor", box, _SCREED)
        for box in solid_around(
            (x0, y0, bottom - 0.1, x1, y1, shell.floor_z - 0.001), [box_of((*floor.low, *floor.high))]
        )
        if min(box[3] - box[0], box[4] - box[1]) > 0.002
    ]
    for side, inward in SIDES.items():
        axis = int(np.abs(inward).argmax())
        wall = np.array([[x0 - WALL_M, y0 - WALL_M, bottom], [x1 + WALL_M, y1 + WALL_M, top]])
        face = shell.bounds[axis if inward[axis] > 0 else axis + 2]
        wall[:, axis] = sorted((face, face - inward[axis] * WALL_M))
        holes = [_through(opening, axis) for opening in openings if _crosses(opening, wall, 0.3)]
        parts += [StructureBox("wall", box, finish) for box in solid_around(box_of(wall.ravel()), holes)]
        outer = wall.copy()
        outer[:, axis] -= inward[axis] * OUTER_M
        parts.append(StructureBox("outside", box_of(outer.ravel()), finish))
        doors = [] if shell.door is None else [box_of(np.concatenate(shell.door))]
        parts += _skirting(side, objects, [*holes, *doors], shell)
    parts += [StructureBox("wall", (x0, y0, bottom, x1, y1, top), finish) for x0, y0, x1, y1 in shell.notches]
    if shell.door is not None:
        parts += _door(*shell.door)
    parts += _inner_walls(objects, shell, finish)
    return parts + _behind_wall_cabinets(objects, parts, shell, finish)


_CEILING = Material("plaster", "white", (0.97, 0.97, 0.96))
_SCREED = Material("stone", "gray", (0.7, 0.69, 0.67), "concrete", 1.0)
_DOOR = Material("wooden", "white", (0.90, 0.89, 0.86))
_SKIRTING = Material("wooden", "white", (0.95, 0.95, 0.93))


def paints_of(room: str) -> tuple[Vec3, ...]:
    """What the walls of a type of room are painted in: as in bedrooms if nothing else is said of it."""
    return PAINTS.get(room, PAINTS["bedroom"])


def _wall_finish(room: str, rng: np.random.Generator) -> Material:
    paints = paints_of(room)
    rgb = paints[int(rng.integers(len(paints)))]
    color = min(COLORS, key=lambda name: sum(abs(a - b) for a, b in zip(COLORS[name], rgb, strict=True)))
    if room == "bathroom" and rng.random() < 0.7:
        return Material("tiled", color, rgb, "tile" if rng.random() < 0.5 else "subway", 0.8, 0.15)
    texture = "plaster" if room == "kitchen" else WALLPAPERS[int(rng.integers(len(WALLPAPERS)))]
    return Material("painted", color, rgb, texture, 1.2)


def _door(low: F64, high: F64) -> list[StructureBox]:
    """A closed door in its frame, with a handle, on a wall of which the box's long side says how it runs."""
    axis = int(np.argmin((high - low)[:2]))
    across = 1 - axis
    leaf_low, leaf_high = low.copy(), high.copy()
    leaf_low[across] += FRAME_M
    leaf_high[[across, 2]] -= FRAME_M
    frame = solid_around(box_of((*low, *high)), [_through(np.stack([leaf_low - [0, 0, 1], leaf_high]), axis)])
    inset = (high - low)[axis] / 4
    leaf_low[axis] += inset
    leaf_high[axis] -= inset
    handle_low, handle_high = leaf_low.copy(), leaf_high.copy()
    handle_low[[across, 2]] += 0.05, HANDLE_HEIGHT_M
    handle_high[across], handle_high[2] = handle_low[across] + 0.13, handle_low[2] + 0.022
    handle_low[axis], handle_high[axis] = low[axis] - 0.03, high[axis] + 0.03
    return [
        *(StructureBox("fixture", box, _SKIRTING) for box in frame),
        StructureBox("fixture", box_of((*leaf_low, *leaf_high)), _DOOR),
        StructureBox("fixture", box_of((*handle_low, *handle_high)), CHROME),
    ]


def _opening(o: RecordedObject) -> F64:
    return np.stack([o.low + 0.004, o.high - 0.004])


def _crosses(hole: F64, wall: F64, slack: float) -> bool:
    low, high = wall[0] - slack, wall[1] + slack
    thin = int(np.argmin((wall[1] - wall[0])[:2]))
    inside = (hole[0] + hole[1]) / 2
    across = (hole[1] - hole[0])[thin] < (hole[1] - hole[0])[1 - thin]
    return bool(across and np.all(inside > low) and np.all(inside < high))


def _through(hole: F64, axis: int) -> Box:
    cut = hole.copy()
    cut[:, axis] = (-99.0, 99.0)
    return box_of(cut.ravel())


def _skirting(
    side: str, objects: Sequence[RecordedObject], holes: Sequence[Box], shell: RoomShell
) -> list[StructureBox]:
    x0, y0, x1, y1 = shell.bounds
    inward = SIDES[side]
    axis = int(np.abs(inward).argmax())
    thickness, height = SKIRTING_M
    board = np.array([[x0, y0, shell.floor_z], [x1, y1, shell.floor_z + height]])
    face = shell.bounds[axis if inward[axis] > 0 else axis + 2]
    board[:, axis] = sorted((face, face + inward[axis] * thickness))
    pockets = [box_of((*(o.low - 0.005), *(o.high + 0.005))) for o in objects if o.type != "Floor" and not o.pickupable]
    boxes = solid_around(box_of(board.ravel()), [*pockets, *holes])
    return [StructureBox("fixture", box, _SKIRTING) for box in boxes if (box[5] - box[2]) > 0.9 * height]


def _inner_walls(objects: Sequence[RecordedObject], shell: RoomShell, finish: Material) -> list[StructureBox]:
    """A piece of wall behind everything that hangs away from the outer walls, so that nothing floats."""
    parts: list[StructureBox] = []
    others = [o for o in objects if o.type not in ON_WALLS and o.type != "Floor"]
    for o in objects:
        if o.type not in ON_WALLS:
            continue
        axis = int(np.abs(o.front).argmax())
        back = float((o.low if o.front[axis] > 0 else o.high)[axis])
        side = next(s for s, inward in SIDES.items() if arithmetic.dot(inward, o.front) > 0.9)
        gap = shell.gap(side, o.low, o.high)
        if gap < ON_INNER_WALL_M:
            continue
        depth = gap if gap < FILL_M else INNER_WALL_M
        stub = np.array([[*o.low[:2], shell.floor_z], [*o.high[:2], shell.floor_z + shell.height]])
        across = 1 - axis
        stub[0, across] -= 0.12
        stub[1, across] += 0.12
        stub[:, axis] = sorted((back - o.front[axis] * 0.001, back - o.front[axis] * depth))
        pockets = [box_of((*(b.low - 0.004), *(b.high + 0.004))) for b in others] + [p.box for p in parts]
        pieces = solid_around(box_of(stub.ravel()), pockets)
        parts += [StructureBox("wall", box, finish) for box in pieces if _min_edge(box) > 0.02]
    return parts


def _behind_wall_cabinets(
    objects: Sequence[RecordedObject], built: Sequence[StructureBox], shell: RoomShell, finish: Material
) -> list[StructureBox]:
    """Masonry between a cabinet that hangs on a wall and the wall, where the recording leaves a gap."""
    parts: list[StructureBox] = []
    others = [box_of((*(o.low - 0.003), *(o.high + 0.003))) for o in objects if o.type != "Floor"]
    for o in objects:
        if o.type != "Cabinet" or o.low[2] < shell.floor_z + 1.0:
            continue
        side = next((s for s, inward in SIDES.items() if arithmetic.dot(inward, o.front) > 0.9), None)
        if side is None or not 0.02 < shell.gap(side, o.low, o.high) < FILL_M:
            continue
        axis = int(np.abs(o.front).argmax())
        gap = np.stack([o.low, o.high])
        face = shell.bounds[axis if o.front[axis] > 0 else axis + 2]
        gap[:, axis] = sorted((face, float((o.low if o.front[axis] > 0 else o.high)[axis])))
        pieces = solid_around(box_of(gap.ravel()), others + [p.box for p in (*built, *parts) if p.kind != "outside"])
        parts += [StructureBox("wall", box, finish) for box in pieces if _min_edge(box) > 0.015]
    return parts


def _min_edge(box: Box) -> float:
    return min(box[3] - box[0], box[4] - box[1], box[5] - box[2])
