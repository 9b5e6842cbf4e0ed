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
from remqa_data.assets.electronics import closed_laptop_size
from remqa_data.assets.fronts import FINISHES
from remqa_data.assets.model import F64, Box, Rect, Vec3
from remqa_data.generators.floorplans.building import building
from remqa_data.generators.floorplans.builtin import counter_plan, drawer_housings, stoves, under_counter
from remqa_data.generators.floorplans.plan import HOSTS, RoomShell, facing_right, fit_shell, flat_on_walls, host_of
from remqa_data.generators.floorplans.support import supported
from remqa_data.generators.floorplans.table import RecordedObject, axes_facing, recorded_objects, scene_names
from remqa_data.rotations import quaternion_of
from remqa_data.scene import Scene, SceneObject, StructureBox

__all__ = ["load_scene", "scene_names"]

FLAT_M, MIN_SIZE_M = 0.0035, 0.02
"""Furniture recorded thinner than the first, which are two shelves and two counters, gets the second."""
FIT_TOLERANCE = 0.05
CORNER_DESK_M = 1.25
"""A desk deeper than this goes round a corner."""
OPEN_TYPES = frozenset({"Laptop", "Box"})
"""Types that are recorded open, so that their recorded box is that of the open object."""
SUITES = frozenset(
    [
        "Bathtub",
        "BathtubBasin",
        "Blinds",
        "Cabinet",
        "Chair",
        "CoffeeTable",
        "Curtains",
        "Desk",
        "DiningTable",
        "Drawer",
        "Dresser",
        "HandTowel",
        "HandTowelHolder",
        "LightSwitch",
        "Shelf",
        "ShelvingUnit",
        "ShowerDoor",
        "ShowerGlass",
        "SideTable",
        "Sink",
        "SinkBasin",
        "Sofa",
        "ArmChair",
        "Stool",
        "StoveBurner",
        "StoveKnob",
        "Towel",
        "TowelHolder",
        "TVStand",
        "Window",
    ]
)
"""Types whose pieces in one room share a variant and a seed."""
SUITE_OF = {
    "SinkBasin": "Sink",
    "BathtubBasin": "Bathtub",
    "HandTowelHolder": "TowelHolder",
    "HandTowel": "Towel",
} | dict.fromkeys(("Dresser", "Desk", "SideTable", "TVStand"), "Drawer")
"""Types whose looks go together: what is let into what, and furniture with the drawers in it."""
ONE_FINISH = frozenset(
    [
        "Cabinet",
        "Drawer",
        "Dresser",
        "Desk",
        "SideTable",
        "TVStand",
        "CoffeeTable",
        "Shelf",
        "ShelvingUnit",
        "CounterTop",
    ]
)
"""Types that share one seed in a room, and with it one wood or paint."""
HANGING = frozenset({"Towel", "HandTowel"})
HOLDERS = ("ToiletPaperHanger|", "HandTowelHolder|", "TowelHolder|")
"""What these hold hangs, too."""
LEAN_DEG = 8.0
"""What is recorded more tilted than this leans on something; it stays put until something acts on it."""
LOOSE_FIT = 0.06
"""An oriented box that is this much larger than the recorded axis-aligned one holds something round."""


@lru_cache(maxsize=8)
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
    name, room_type = rows[0].scene, rows[0].room
    rows = flat_on_walls(rows)
    shell = fit_shell(rows)
    upright = [_upright(row) for row in rows]
    tops = [o for o in upright if o.type == "CounterTop"]
    worktops = [rect for top in tops for rect in counter_plan(top, upright, shell, trimmed=False)]
    objects = facing_right(upright, shell, worktops)
    objects = [_at_floor_level(o, shell.floor_z) if o.type == "Floor" else o for o in objects]
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
    x0, y0, x1, y1 = shell.bounds
    ceiling = shell.floor_z + shell.height
    lamp = ((x0 + x1) / 2, (y0 + y1) / 2, ceiling - 0.15)
    scene = Scene(name, room_type, shell.bounds, shell.floor_z, shell.height, (lamp,), tuple(structure), tuple(placed))
    return supported(scene, shell, finish)


def _may_bend(o: RecordedObject) -> bool:
    """Whether an object's box may be the bounding box of an L or a U."""
    return o.type == "CounterTop" or (o.type == "Desk" and float(o.size[:2].min()) > CORNER_DESK_M)


class _Style:
    """Which variant and seed each object gets: by scene and object id, or by scene and type for pieces of one suite."""

    def __init__(self, scene: str) -> None:
        self.scene = scene
        self.rng = np.random.default_rng([zlib.crc32(scene.encode()), 1])
        self.suite_seed = int(self.rng.integers(1 << 16))

    def choose(self, o: RecordedObject, *, is_built_in: bool) -> tuple[int, int]:
        """Variant and seed of an object; what is built into a piece of furniture is plain."""
        key = SUITE_OF.get(o.type, o.type) if o.type in SUITES else o.id
        rng = np.random.default_rng([zlib.crc32(self.scene.encode()), zlib.crc32(key.encode())])
        variant = int(rng.integers(variant_count(o.type)))
        seed = int(rng.integers(1 << 16))
        if o.type == "Shelf" and is_built_in:
            variant = 0
        if o.type == "Cabinet":  # even variants hinge left, odd ones right; the recorded pivot is the hinge
            right = float((o.pivot - o.centre) @ o.rotation[:, 0]) > 0
            variant = variant - variant % 2 + int(right)
        return variant, self.suite_seed if o.type in ONE_FINISH else seed


def _upright(o: RecordedObject) -> RecordedObject:
    """Round things lie as their axis-aligned box says, because their oriented box is loose."""
    if not o.is_oriented:
        return o
    recorded = o.high - o.low
    spanned = np.abs(o.rotation) @ o.size
    if np.max(np.abs(spanned - recorded) / np.maximum(recorded, 0.02)) < LOOSE_FIT:
        return o
    front = o.front * [1, 1, 0]
    axis = int(np.abs(front).argmax())
    quarter = np.zeros(3)
    quarter[axis] = np.sign(front[axis]) or 1.0
    rotation = axes_facing(quarter)
    size = np.abs(rotation.T) @ recorded
    return _replaced(o, (o.low + o.high) / 2, size, rotation)


def _replaced(o: RecordedObject, centre: F64, size: F64, rotation: F64) -> RecordedObject:
    return replace(o, centre=centre, size=size, rotation=rotation)


def _with_plan(counter: RecordedObject, plan: Sequence[Rect]) -> RecordedObject:
    """A worktop with the box of its true plan."""
    low, high = counter.low.copy(), counter.high.copy()
    low[:2], high[:2] = np.min([rect[:2] for rect in plan], axis=0), np.max([rect[2:] for rect in plan], axis=0)
    size = np.abs(counter.rotation.T) @ (high - low)
    return replace(counter, low=low, high=high, centre=(low + high) / 2, size=size)


def _at_floor_level(floor: RecordedObject, floor_z: float) -> RecordedObject:
    """The floor with its surface where things stand; in some rooms its recorded box ends a little above or below."""
    high = floor.high.copy()
    high[2] = floor_z
    low = floor.low.copy()
    low[2] = min(low[2], floor_z - 0.05)
    return replace(floor, low=low, high=high, centre=(low + high) / 2, size=np.abs(floor.rotation.T) @ (high - low))


def _place(
    o: RecordedObject, objects: Sequence[RecordedObject], plan: Sequence[Rect], shell: RoomShell, style: _Style
) -> SceneObject:
    variant, seed = style.choose(o, is_built_in=host_of(o, objects) is not None)
    size = np.maximum(o.size, MIN_SIZE_M) if o.size.min() < FLAT_M and not o.pickupable else o.size
    guests = [_in_frame(guest, o) for guest in _guests(o, objects)]
    spec = AssetSpec(
        type=o.type,
        size=_vec(size),
        variant=variant,
        seed=seed,
        levels=_levels(o, objects),
        pockets=tuple(_box(_clip(guest, size, o.type)) for guest in guests),
        footprint=tuple(_rect_in_frame(rect, o) for rect in plan) if len(plan) > 1 else (),
    )
    openness, centre = 0.0, o.centre
    if o.type in OPEN_TYPES and o.openness > 0:
        openness = 1.0
        spec, centre = _closed(spec, o)
    elif o.is_oriented:
        spec = _fitted(spec, o)
    tilt = np.degrees(np.arccos(np.clip(abs(o.rotation[2, 2]), 0, 1)))
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
    closed = replace(spec, size=_vec(size))
    bounds = build(closed).bounds(1.0)
    centre = o.centre - o.rotation @ ((bounds[0] + bounds[1]) / 2)
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


def _fitted(spec: AssetSpec, o: RecordedObject) -> AssetSpec:
    """A turned or tilted asset grown until the box around it is the recorded one: round ones do not reach their corners."""
    recorded = o.high - o.low
    for _ in range(4):
        bounds = [s.vertices @ o.rotation.T for link in build(spec).links for s in link.surfaces]
        points = np.vstack(bounds)
        ratio = recorded / np.maximum(points.max(axis=0) - points.min(axis=0), 1e-6)
        if np.all(np.abs(ratio - 1) < FIT_TOLERANCE):
            break
        growth = np.clip((o.rotation.T**2) @ ratio, 0.8, 1.3)
        spec = replace(spec, size=_vec(np.array(spec.size) * growth))
    return spec


def _guests(o: RecordedObject, objects: Sequence[RecordedObject]) -> list[RecordedObject]:
    """Fixed objects that have their place inside another's box: drawers in a dresser, a basin in a sink."""
    wanted = {
        "Sink": {"SinkBasin"},
        "Bathtub": {"BathtubBasin"},
        "CounterTop": _SUNK if o.size[2] < 0.2 else _SUNK | {"Cabinet", "Drawer"},
    }.get(o.type, {"Drawer", "Shelf", "Cabinet"} if o.type in HOSTS - {"Cabinet"} else set())
    if o.type == "Cabinet":
        return [guest for guest in objects if guest.type in ("Sink", "SinkBasin") and _hangs_into(guest, o)]
    found = []
    for guest in objects:
        if guest is o or guest.type not in wanted:
            continue
        middle = (guest.low + guest.high) / 2
        slack = np.array([0.02, 0.02, 0.3 if o.type == "CounterTop" else 0.05])
        if np.all(middle > o.low - slack) and np.all(middle < o.high + slack):
            found.append(guest)
    return found


def _hangs_into(sink: RecordedObject, cabinet: RecordedObject) -> bool:
    """Whether a sink reaches into a cabinet from above."""
    meets = np.all(sink.high > cabinet.low + 0.01) and np.all(sink.low < cabinet.high - 0.01)
    return bool(meets and sink.low[2] > cabinet.low[2] + 0.3 * cabinet.size[2])


_SUNK = {"Sink", "SinkBasin", "Bathtub", "BathtubBasin"}
"""What is let into a worktop."""


def _in_frame(guest: RecordedObject, o: RecordedObject) -> F64:
    """(2, 3) box of a guest in the host's asset frame."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2 * guest.size
    points = (guest.centre + corners @ guest.rotation.T - o.centre) @ o.rotation
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _clip(box: F64, size: F64, host: str) -> F64:
    """A pocket never takes a piece of furniture's top board away, but for a sink in a cabinet."""
    clipped = box.copy()
    if host in HOSTS and host != "Cabinet":
        clipped[1, 2] = min(clipped[1, 2], size[2] / 2 - 0.02)
        clipped[0, 2] = min(clipped[0, 2], clipped[1, 2] - 0.01)
    return clipped


def _rect_in_frame(rect: Rect, o: RecordedObject) -> Rect:
    corners = np.array([[rect[0], rect[1], o.centre[2]], [rect[2], rect[3], o.centre[2]]])
    local = (corners - o.centre) @ o.rotation
    low, high = local.min(axis=0), local.max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _levels(o: RecordedObject, objects: Sequence[RecordedObject]) -> tuple[float, ...]:
    """Heights above an object's bottom at which its recorded contents rest, lowest first, at least 8 cm apart."""
    if not o.receptacle or o.type in ("Floor", "CounterTop"):
        return ()
    bottoms = sorted(
        float(item.low[2] - o.low[2])
        for item in objects
        if o.id in item.parents and item.pickupable and item.type not in HANGING
    )
    bottoms = [z for z in bottoms if -0.02 < z < o.size[2] + 0.02]
    if o.type in ("Sofa", "ArmChair", "Bed", "Chair", "Stool", "Ottoman", "DogBed") and bottoms:
        upright = [z for z in bottoms if z < 0.8 * o.size[2]] or bottoms
        return (float(np.median(upright)),)
    levels: list[float] = []
    for z in bottoms:
        if not levels or z - levels[-1] > 0.08:
            levels.append(max(z, 0.004))
    return tuple(levels)


def _vec(values: F64) -> Vec3:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _box(corners: F64) -> Box:
    x0, y0, z0, x1, y1, z1 = (float(v) for v in corners.ravel())
    return x0, y0, z0, x1, y1, z1
