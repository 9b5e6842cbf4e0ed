"""The 120 iTHOR floor plans as scenes.

`load_scene("FloorPlan1")` reads the recorded boxes (`table`), finds the walls and which way things face (`plan`), adds
the built-in furniture that the recording implies (`builtin`) and names an asset for every object, at its recorded place.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from remqa_data.assets import AssetSpec, build, variant_count
from remqa_data.assets.parts.fronts import FINISHES
from remqa_data.assets.types.small.electronics import closed_laptop_size
from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.building import building
from remqa_data.floorplans.ithor.builtin import counter_plan, drawer_housings, stoves, under_counter
from remqa_data.floorplans.ithor.hosting import HANGING, is_built_in, levels, pockets
from remqa_data.floorplans.ithor.openings import with_limits
from remqa_data.floorplans.ithor.plan import RoomShell, facing_right, fit_shell, free_beside
from remqa_data.floorplans.ithor.repairs import at_floor_level, repaired, with_corners
from remqa_data.floorplans.ithor.support import supported
from remqa_data.floorplans.ithor.table import RecordedObject, recorded_objects, scene_names
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import quaternion_of
from remqa_data.geometry.types import F64, Rect, Vec3
from remqa_data.scene import Scene, SceneObject, StructureBox

__all__ = ["load_scene", "scene_names"]

FIT_TOLERANCE = 0.05
CORNER_DESK_M = 1.25
"""A desk deeper than this goes round a corner."""
OPEN_TYPES = types_with("recorded_open")
"""Types that are recorded open, so that their recorded box is that of the open object."""
SUITES = types_with("suite")
"""Types whose pieces in one room share a variant and a seed."""
SUITE_OF = {
    "SinkBasin": "Sink",
    "BathtubBasin": "Bathtub",
    "HandTowelHolder": "TowelHolder",
    "HandTowel": "Towel",
} | dict.fromkeys(("Dresser", "Desk", "SideTable", "TVStand"), "Drawer")
"""Types whose looks go together: what is let into what, and furniture with the drawers in it."""
ONE_FINISH = types_with("one_finish")
"""Types that share one seed in a room, and with it one wood or paint."""
HOLDERS = tuple(f"{name}|" for name in sorted(types_with("holder")))
"""What these hold hangs, too."""
LEAN_DEG = 8.0
"""What is recorded more tilted than this leans on something; it stays put until something acts on it."""


@lru_cache(maxsize=120)  # of 50 kB each
def load_scene(name: str) -> Scene:
    """One of the 120 rooms as recorded.

    Raises
    ------
    UnknownNameError
        If there is no such floor plan; names the nearest.
    FloorPlanError
        If a row of the table is damaged.
    """
    return scene_from(recorded_objects(name))


def scene_from(rows: Sequence[RecordedObject]) -> Scene:
    """A scene from the recorded objects of one room."""
    return furnished(*understood(rows))


def understood(rows: Sequence[RecordedObject]) -> tuple[list[RecordedObject], RoomShell]:
    """The recorded objects of one room, mended and facing the right way, and the room that they stand in."""
    rows = repaired(rows)
    shell = fit_shell(rows)
    tops = [o for o in rows if o.type == "CounterTop"]
    worktops = [rect for top in tops for rect in counter_plan(top, rows, shell, trimmed=False)]
    objects = facing_right(rows, shell, worktops)
    return [at_floor_level(o, shell.floor_z) if o.type == "Floor" else o for o in objects], shell


def furnished(objects: Sequence[RecordedObject], shell: RoomShell) -> Scene:
    """A scene from the objects of one room, of which it is known which way they face, and the room's walls."""
    name, room_type = objects[0].scene, objects[0].room
    style = _Style(name)
    finish = FINISHES[style.suite_seed % len(FINISHES)]
    plans = {o.id: counter_plan(o, objects, shell) for o in objects if _may_bend(o)}
    structure: list[StructureBox] = []
    for counter in (o for o in objects if o.type == "CounterTop"):
        structure += under_counter(counter, plans[counter.id], objects, shell, finish)
    worktops = [rect for o in objects if o.type == "CounterTop" for rect in plans[o.id]]
    structure += stoves(objects, worktops, structure, shell)
    structure += drawer_housings(objects, structure, shell, finish)
    structure += building(objects, shell, style.rng)
    objects = [_with_plan(o, plans[o.id]) if o.type == "CounterTop" else o for o in objects]
    placed = [_place(o, objects, plans.get(o.id, []), shell, style) for o in objects]
    ceiling = shell.floor_z + shell.height
    lamp = (*shell.middle(), ceiling - 0.15)
    scene = Scene(name, room_type, shell.bounds, shell.floor_z, shell.height, (lamp,), tuple(structure), tuple(placed))
    return with_limits(supported(scene, shell, finish))


def _may_bend(o: RecordedObject) -> bool:
    """Whether an object's box may be the bounding box of an L or a U."""
    return o.type == "CounterTop" or (o.type == "Desk" and float(o.size[:2].min()) > CORNER_DESK_M)


class _Style:
    """Which variant and seed each object gets: by scene and object id, or by scene and type for pieces of one suite."""

    def __init__(self, scene: str) -> None:
        self.scene = scene
        self.rng = np.random.default_rng([zlib.crc32(scene.encode()), 1])
        self.suite_seed = int(self.rng.integers(1 << 16))

    def choose(self, o: RecordedObject, *, is_built_in: bool, hinges_right: bool) -> tuple[int, int]:
        """Variant and seed of an object; what is built into a piece of furniture is plain."""
        key = SUITE_OF.get(o.type, o.type) if o.type in SUITES else o.id
        rng = np.random.default_rng([zlib.crc32(self.scene.encode()), zlib.crc32(key.encode())])
        variant = int(rng.integers(variant_count(o.type)))
        seed = int(rng.integers(1 << 16))
        if o.type == "Shelf" and is_built_in:
            variant = 0
        if o.type == "Cabinet":  # even variants hinge left, odd ones right; the recorded pivot is the hinge
            right = arithmetic.dot(o.pivot - o.centre, o.rotation[:, 0]) > 0
            variant = variant - variant % 2 + int(right)
        if o.type == "Fridge":  # even seeds hinge left, odd ones right
            seed += int(hinges_right) - seed % 2
        return variant, self.suite_seed if o.type in ONE_FINISH else seed


def _with_plan(counter: RecordedObject, plan: Sequence[Rect]) -> RecordedObject:
    """A worktop with the box of its true plan."""
    low, high = counter.low.copy(), counter.high.copy()
    low[:2], high[:2] = np.min([rect[:2] for rect in plan], axis=0), np.max([rect[2:] for rect in plan], axis=0)
    return with_corners(counter, low, high)


def _place(
    o: RecordedObject, objects: Sequence[RecordedObject], plan: Sequence[Rect], shell: RoomShell, style: _Style
) -> SceneObject:
    right = o.type == "Fridge" and free_beside(o, 1, objects, shell) < free_beside(o, -1, objects, shell)
    variant, seed = style.choose(o, is_built_in=is_built_in(o, objects), hinges_right=right)
    centre, openness = o.centre, 0.0
    spec = AssetSpec(
        type=o.type,
        size=_vec(o.size),
        variant=variant,
        seed=seed,
        levels=levels(o, objects),
        pockets=pockets(o, objects),
        footprint=tuple(_rect_in_frame(rect, o) for rect in plan) if len(plan) > 1 else (),
    )
    if o.type in OPEN_TYPES and o.openness > 0:
        openness = 1.0
        spec, centre = _closed(spec, o)
    elif o.is_oriented:
        spec, centre = _fitted(spec, o)
    tilt = np.degrees(arithmetic.arccos(np.clip(abs(o.rotation[2, 2]), 0, 1)))
    leans = tilt > LEAN_DEG and o.size.max() > 0.3
    hangs = o.type in HANGING or any(parent.startswith(HOLDERS) for parent in o.parents)
    is_fixed = not o.pickupable or hangs or leans
    return SceneObject(o.id, spec, _vec(centre), quaternion_of(o.rotation), openness, bool(is_fixed), o.parents)


def _closed(spec: AssetSpec, o: RecordedObject) -> tuple[AssetSpec, F64]:
    """The closed asset, and where its centre is, of an object whose recorded box is that of the open one."""
    target = np.array(spec.size)
    if spec.type == "Laptop":
        size = np.array(closed_laptop_size(spec.size))
    else:
        spec = replace(spec, variant=_opens_sideways(spec))
        size = 0.8 * target
        for _ in range(6):
            bounds = build(replace(spec, size=_vec(size))).bounds(1.0)
            size = size * target / (bounds[1] - bounds[0])
    closed = replace(spec, size=_vec(arithmetic.snapped(size)))
    bounds = build(closed).bounds(1.0)
    centre = o.centre - arithmetic.turned((bounds[0] + bounds[1]) / 2, o.rotation)
    centre[2] = o.centre[2] - target[2] / 2 - bounds[0, 2]  # what is open stands on the same ground
    return closed, centre


def _opens_sideways(spec: AssetSpec) -> int:
    """The wanted variant of a box, or the next one whose lid does not stand up high when it is open."""
    count = variant_count(spec.type)
    for step in range(count):
        variant = (spec.variant + step) % count
        asset = build(replace(spec, variant=variant))
        opened = asset.bounds(1.0)
        if opened[1, 2] - opened[0, 2] < 1.3 * spec.size[2]:
            return variant
    return spec.variant


def _fitted(spec: AssetSpec, o: RecordedObject) -> tuple[AssetSpec, F64]:
    """A turned or tilted asset grown and moved until the box around it is the recorded one.

    Round ones do not reach the corners of their oriented box.
    """
    recorded = o.high - o.low
    for _ in range(4):
        low, high = _turned_bounds(spec, o.rotation)
        ratio = recorded / np.maximum(high - low, 1e-6)
        if np.all(np.abs(ratio - 1) < FIT_TOLERANCE):
            break
        growth = np.clip(arithmetic.turned_back(ratio, o.rotation * o.rotation), 0.8, 1.3)
        spec = replace(spec, size=_vec(np.array(spec.size) * growth))
    low, high = _turned_bounds(spec, o.rotation)
    return spec, (o.low + o.high) / 2 - (low + high) / 2


def _turned_bounds(spec: AssetSpec, rotation: F64) -> tuple[F64, F64]:
    """Least and greatest corner of a turned asset, relative to its centre."""
    points = np.vstack([arithmetic.turned(s.vertices, rotation) for link in build(spec).links for s in link.surfaces])
    return points.min(axis=0), points.max(axis=0)


def _rect_in_frame(rect: Rect, o: RecordedObject) -> Rect:
    corners = np.array([[rect[0], rect[1], o.centre[2]], [rect[2], rect[3], o.centre[2]]])
    local = arithmetic.turned_back(corners - o.centre, o.rotation)
    low, high = local.min(axis=0), local.max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _vec(values: F64) -> Vec3:
    x, y, z = (float(v) for v in values)
    return x, y, z
