"""Built-in furniture that the recording implies but does not list: what carries counters, drawers and stove burners.

Worktops are recorded as thin slabs, some as the bounding box of an L or a U; drawers come without a carcass and burners
without a stove. Here worktops get their true plan, and boxes are put under and around them that leave every recorded
object its place.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.assets.core.fitting import box_of
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.plan import HOSTS, SIDES, RoomShell
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rectangles import edge_rectangles
from remqa_data.geometry.types import F64, Box, Rect
from remqa_data.scene import StructureBox

CELL_M = 0.05
STRIP_DEPTH_M = 0.64
"""Depth of a worktop along a wall."""
STRAIGHT_COUNTER_M = 0.85
"""A worktop's box that is no deeper than this is a straight one."""
ISLAND_M = 1.3
"""A worktop's box away from walls and no deeper than this is an island."""
MIN_HOLE_M, MOST_HOLES = 0.35, 3
KICK_HEIGHT_M, KICK_INSET_M, OVERHANG_M = 0.10, 0.07, 0.025
GAP_M = 0.003
DEEP_OVERHANG_M = 0.05
FRONT_M = 0.03
"""A carcass ends this far behind the fronts of its doors and drawers, handles included."""
WAY_OUT_M = 0.6
GROUP_M = 0.75
"""Burners nearer to each other than this belong to one hob."""
SLIVER_M = 0.012
"""Boxes thinner than this are left out."""

BASE_TYPES = types_with("kitchen_base")
PLACELESS = types_with("takes_no_place")


def counter_plan(
    counter: RecordedObject, objects: Sequence[RecordedObject], shell: RoomShell, *, trimmed: bool = True
) -> list[Rect]:
    """Rectangles (x0, y0, x1, y1) in the room that make up a worktop's plan, if wanted without its deep overhangs.

    A box deeper than a worktop is the bounding box of an L or a U: kept are the strips along walls that cabinets, sinks
    or things on the worktop back, and whatever stands on or under it elsewhere.
    """
    whole: Rect = (*map(float, counter.low[:2]), *map(float, counter.high[:2]))  # type: ignore[assignment]
    if trimmed:
        whole = _trimmed(counter, objects, shell)
    low, high = np.array(whole[:2]), np.array(whole[2:])
    extent = high - low
    at_wall = [side for side in SIDES if abs(shell.gap(side, counter.low, counter.high)) < 0.30]
    if extent.min() <= STRAIGHT_COUNTER_M or (not at_wall and extent.min() <= ISLAND_M):
        return [whole]
    shape = np.maximum(np.round(extent / CELL_M).astype(int), 1)
    needed = np.zeros(shape, dtype=bool)
    for o in objects:
        if o is counter or not _uses(o, counter):
            continue
        a = np.clip(((o.low[:2] - low) / extent * shape).round().astype(int), 0, shape)
        b = np.clip(((o.high[:2] - low) / extent * shape).round().astype(int), 0, shape)
        needed[a[0] : max(b[0], a[0] + 1), a[1] : max(b[1], a[1] + 1)] = True
    kept = needed.copy()
    depth = np.minimum(np.ceil(STRIP_DEPTH_M / extent * shape).astype(int), shape)
    for side in at_wall:
        axis = int(np.abs(SIDES[side]).argmax())
        strip = [slice(None), slice(None)]
        strip[axis] = slice(0, depth[axis]) if SIDES[side][axis] > 0 else slice(shape[axis] - depth[axis], None)
        used = np.flatnonzero(needed[tuple(strip)].any(axis=axis))
        if len(used):
            strip[1 - axis] = slice(used[0], used[-1] + 1)
            kept[tuple(strip)] = True
    _reach_the_edges(kept)
    least_x, least_y = (max(1, round(MIN_HOLE_M / e * s)) for e, s in zip(extent, shape, strict=True))
    holes = edge_rectangles(kept, (least_x, least_y), MOST_HOLES)
    step = extent / shape
    pockets = [
        (low[0] + i0 * step[0], low[1] + j0 * step[1], -1.0, low[0] + i1 * step[0], low[1] + j1 * step[1], 1.0)
        for i0, j0, i1, j1 in holes
    ]
    cut = solid_around((whole[0], whole[1], 0.0, whole[2], whole[3], 0.5), [box_of(p) for p in pockets])
    return [(x0, y0, x1, y1) for x0, y0, _, x1, y1, _ in cut] or [whole]


def _trimmed(counter: RecordedObject, objects: Sequence[RecordedObject], shell: RoomShell) -> Rect:
    """A worktop's plan without a deep overhang, which would hide the drawers under it; what lies on it keeps its place."""
    low, high = counter.low[:2].copy(), counter.high[:2].copy()
    on_top = [o for o in objects if counter.id in o.parents]
    for side, inward in SIDES.items():
        axis = int(np.abs(inward).argmax())
        edge, outward = (low if inward[axis] > 0 else high), -inward
        rect = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
        fronts = [_front_face(o, axis) for o in objects if _opens_on(o, rect, outward) and o.low[2] < counter.low[2]]
        if not fronts or shell.gap(side, counter.low, counter.high) < 0.3:
            continue
        reach = [face * outward[axis] + OVERHANG_M for face in fronts]
        reach += [float((o.high if outward[axis] > 0 else o.low)[axis] * outward[axis]) for o in on_top]
        if edge[axis] * outward[axis] - max(reach) > DEEP_OVERHANG_M:
            edge[axis] = max(reach) * outward[axis]
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _uses(o: RecordedObject, counter: RecordedObject) -> bool:
    """Whether an object stands on a worktop or is built in under it."""
    if not (np.all(o.high[:2] > counter.low[:2]) and np.all(o.low[:2] < counter.high[:2])):
        return False
    if o.type in BASE_TYPES:
        return bool(o.low[2] < counter.high[2] and o.high[2] > counter.low[2] - 0.75)
    return counter.id in o.parents or (abs(float(o.low[2] - counter.high[2])) < 0.03 and o.type != "Floor")


def _reach_the_edges(kept: npt.NDArray[np.bool_]) -> None:
    """Extend what is kept straight to each edge of the box that it does not reach: the box was recorded for a reason."""
    for axis in (0, 1):
        used = np.flatnonzero(kept.any(axis=1 - axis))
        if not len(used):
            kept[:] = True
            return
        first = [slice(None), slice(None)]
        first[axis] = slice(0, used[0])
        last = [slice(None), slice(None)]
        last[axis] = slice(used[-1] + 1, None)
        kept[tuple(first)] = np.expand_dims(np.take(kept, used[0], axis=axis), axis)
        kept[tuple(last)] = np.expand_dims(np.take(kept, used[-1], axis=axis), axis)


def under_counter(
    counter: RecordedObject, plan: Sequence[Rect], objects: Sequence[RecordedObject], shell: RoomShell, finish: Material
) -> list[StructureBox]:
    """The carcass between a worktop and the floor, around the cabinets, drawers and whatever else stands there."""
    bottom = float(counter.low[2])
    if bottom < shell.floor_z + 0.3:
        return []
    pockets = _places(objects, skip={counter.id}, below=bottom)
    parts: list[StructureBox] = []
    for x0, y0, x1, y1 in plan:
        for z0, z1, inset, material in (
            (shell.floor_z, shell.floor_z + KICK_HEIGHT_M, KICK_INSET_M, materials.SHADOW_GAP),
            (shell.floor_z + KICK_HEIGHT_M, bottom, OVERHANG_M, finish),
        ):
            box = _inset((x0, y0, x1, y1), z0, z1, inset, plan, shell, objects)
            if box is not None:
                parts += [StructureBox("fixture", part, material) for part in _usable(solid_around(box, pockets))]
    return parts


def _inset(
    rect: Rect,
    z0: float,
    z1: float,
    inset: float,
    plan: Sequence[Rect],
    shell: RoomShell,
    objects: Sequence[RecordedObject],
) -> Box | None:
    """A rectangle drawn in on the sides that are open: not at a wall and not joined to another rectangle of the plan.

    On a side with doors or drawers it is drawn in to just behind their fronts.
    """
    x0, y0, x1, y1 = rect
    low, high = np.array([x0, y0, z0]), np.array([x1, y1, z1])
    for side, inward in SIDES.items():
        axis = int(np.abs(inward).argmax())
        edge = (low if inward[axis] > 0 else high)[axis]
        joined = any(other is not rect and _touches(rect, other, axis, edge) for other in plan)
        if not joined and shell.gap(side, low, high) > 0.1:
            fronts = [_front_face(o, axis) for o in objects if _opens_on(o, rect, -inward)]
            behind = min((abs(face - edge) + FRONT_M for face in fronts), default=OVERHANG_M)
            (low if inward[axis] > 0 else high)[axis] += (inset - OVERHANG_M + behind) * inward[axis]
    if np.any(high - low < 0.02):
        return None
    return box_of((*low, *high))


def _opens_on(o: RecordedObject, rect: Rect, front: F64) -> bool:
    """Whether a door or drawer under a rectangle of a worktop faces a side."""
    middle = (o.low + o.high) / 2
    under = rect[0] < middle[0] < rect[2] and rect[1] < middle[1] < rect[3]
    return o.type in types_with("cupboard_front") and under and bool(arithmetic.dot(o.front, front) > 0.9)


def _front_face(o: RecordedObject, axis: int) -> float:
    return float((o.high if o.front[axis] > 0 else o.low)[axis])


def _touches(rect: Rect, other: Rect, axis: int, edge: float) -> bool:
    meets = abs(other[axis] - edge) < 1e-6 or abs(other[axis + 2] - edge) < 1e-6
    across = 1 - axis
    return meets and min(rect[across + 2], other[across + 2]) - max(rect[across], other[across]) > 0.05


def drawer_housings(
    objects: Sequence[RecordedObject], built: Sequence[StructureBox], shell: RoomShell, finish: Material
) -> list[StructureBox]:
    """A carcass for each drawer that is neither in a piece of furniture nor under a worktop."""
    hosts = [o for o in objects if o.type in HOSTS and o.type != "Cabinet"]
    parts: list[StructureBox] = []
    for drawer in objects:
        if drawer.type != "Drawer":
            continue
        middle = (drawer.low + drawer.high) / 2
        if any(np.all(middle > h.low - 0.03) and np.all(middle < h.high + 0.03) for h in hosts):
            continue
        around = [b.box for b in built if b.kind == "fixture"]
        if any(_meets(drawer, box, 0.02) for box in around):
            continue
        low, high = drawer.low - 0.015, drawer.high + 0.015
        axis = int(np.abs(drawer.front).argmax())
        if drawer.front[axis] > 0:
            high[axis] = drawer.high[axis] - 0.03
        else:
            low[axis] = drawer.low[axis] + 0.03
        if low[2] < shell.floor_z + 0.35:
            low[2] = shell.floor_z
        x0, y0, x1, y1 = shell.bounds
        low[:2], high[:2] = np.maximum(low[:2], (x0, y0)), np.minimum(high[:2], (x1, y1))
        pockets = _places(objects, skip=set(), below=np.inf) + around
        boxes = _usable(solid_around(box_of((*low, *high)), pockets))
        parts += [StructureBox("fixture", box, finish) for box in boxes]
        around += boxes
    return parts


def stoves(
    objects: Sequence[RecordedObject], plans: Sequence[Rect], built: Sequence[StructureBox], shell: RoomShell
) -> list[StructureBox]:
    """A cooker under each group of burners, or a glass plate where the burners lie on a worktop."""
    parts: list[StructureBox] = []
    for burners in _groups([o for o in objects if o.type == "StoveBurner"]):
        low = np.min([o.low for o in burners], axis=0) - 0.05
        high = np.max([o.high for o in burners], axis=0) + 0.05
        top = min(float(o.low[2]) for o in burners)
        middle = (low + high)[:2] / 2
        on_worktop = any(x0 < middle[0] < x1 and y0 < middle[1] < y1 for x0, y0, x1, y1 in plans)
        if on_worktop:
            plate = box_of((low[0], low[1], top - 0.008, high[0], high[1], top - 0.0005))
            parts.append(StructureBox("fixture", plate, materials.DARK_GLASS))
            continue
        front = _stove_front(burners, objects, shell)
        axis = int(np.abs(front).argmax())
        side, gap = shell.nearest_side(low, high)
        if gap < 0.3 and abs(SIDES[side][axis]) > 0.5:  # reach back to the wall
            wall = shell.bounds[axis if SIDES[side][axis] > 0 else axis + 2]
            (low if SIDES[side][axis] > 0 else high)[axis] = wall
        for knob in (o for o in objects if o.type == "StoveKnob"):
            if abs(knob.centre[1 - axis] - middle[1 - axis]) < 0.5 and knob.centre[2] < top + 0.02:
                if front[axis] > 0:
                    high[axis] = max(high[axis], knob.low[axis] + 0.012)
                else:
                    low[axis] = min(low[axis], knob.high[axis] - 0.012)
        pockets = _places(objects, skip=set(), below=top) + [b.box for b in built]
        pockets += [(x0, y0, -9.0, x1, y1, 9.0) for x0, y0, x1, y1 in plans]
        body = box_of((low[0], low[1], shell.floor_z, high[0], high[1], top - 0.0005))
        steel = _usable(solid_around(body, pockets))
        parts += [StructureBox("fixture", box, materials.STEEL) for box in steel]
        parts += _oven_door(body, front)
    return parts


def _oven_door(body: Box, front: F64) -> list[StructureBox]:
    """Dark glass and a bar handle on the front of a cooker."""
    low, high = np.array(body[:3]), np.array(body[3:])
    axis = int(np.abs(front).argmax())
    across, tall = 1 - axis, high[2] - low[2]
    if tall < 0.4 or high[across] - low[across] < 0.3:
        return []
    face = (high if front[axis] > 0 else low)[axis]
    door_low, door_high = low.copy(), high.copy()
    door_low[across] += 0.07
    door_high[across] -= 0.07
    door_low[2] += 0.25 * tall
    door_high[2] -= 0.28 * tall
    bar_low, bar_high = door_low.copy(), door_high.copy()
    bar_low[2], bar_high[2] = high[2] - 0.20 * tall, high[2] - 0.20 * tall + 0.018
    parts = []
    for a, b, start, end, finish in (
        (door_low, door_high, 0.0, 0.004, materials.DARK_GLASS),
        (bar_low, bar_high, 0.012, 0.026, materials.CHROME),
    ):
        ends = sorted((face + front[axis] * start, face + front[axis] * end))
        a[axis], b[axis] = ends
        parts.append(StructureBox("fixture", box_of((*a, *b)), finish))
    return parts


def _stove_front(burners: Sequence[RecordedObject], objects: Sequence[RecordedObject], shell: RoomShell) -> F64:
    """The side where the knobs are; else away from the nearest wall."""
    middle = np.mean([o.centre for o in burners], axis=0)
    knobs = [o.centre for o in objects if o.type == "StoveKnob" and arithmetic.length((o.centre - middle)[:2]) < 0.9]
    if knobs:
        away = np.mean(knobs, axis=0) - middle
        axis = int(np.abs(away[:2]).argmax())
        if abs(away[axis]) > 0.15:
            front = np.zeros(3)
            front[axis] = np.sign(away[axis])
            side = next(s for s, inward in SIDES.items() if arithmetic.dot(inward, front) < -0.9)
            if shell.gap(side, middle, middle) > 0.6:
                return front
    low, high = np.min([o.low for o in burners], axis=0), np.max([o.high for o in burners], axis=0)
    return SIDES[shell.nearest_side(low, high)[0]]


def _groups(objects: Sequence[RecordedObject]) -> list[list[RecordedObject]]:
    """Objects grouped so that each is nearer than `GROUP_M` to another of its group."""
    groups: list[list[RecordedObject]] = []
    for o in objects:
        near = [g for g in groups if any(arithmetic.length(o.centre - other.centre) < GROUP_M for other in g)]
        groups = [g for g in groups if g not in near] + [[o, *(other for g in near for other in g)]]
    return groups


def _places(objects: Sequence[RecordedObject], skip: set[str], below: float) -> list[Box]:
    """Boxes that built-in furniture must leave to recorded objects, a little larger than recorded."""
    placed = [o for o in objects if o.type not in PLACELESS and not o.pickupable]
    kept = [o for o in placed if o.id not in skip and o.low[2] < below]
    return [_with_way_out(o) for o in kept]


def _with_way_out(o: RecordedObject) -> Box:
    """An object's place; before a door or a drawer also the room that it opens into."""
    low, high = o.low - GAP_M, o.high + GAP_M
    if o.type in types_with("cupboard_front"):
        low, high = np.minimum(low, low + WAY_OUT_M * o.front), np.maximum(high, high + WAY_OUT_M * o.front)
    return box_of((*low, *high))


def _usable(boxes: Sequence[Box]) -> list[Box]:
    """Without slivers, thinner than `SLIVER_M`: they would only flicker."""
    return [b for b in boxes if min(b[3] - b[0], b[4] - b[1], b[5] - b[2]) >= SLIVER_M]


def _meets(o: RecordedObject, box: Box, margin: float) -> bool:
    low, high = np.asarray(box[:3]), np.asarray(box[3:])
    return bool(np.all(o.high + margin > low) and np.all(o.low - margin < high))
