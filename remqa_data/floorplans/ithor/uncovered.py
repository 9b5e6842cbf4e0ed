"""What is covered in some rooms, uncovered.

Worktops cover sinks and burners, walls a sink and windows, and doors that hardly open what is in cabinets. Rooms are final
in data of version 1, so the dataset has them as they are; AI2-THOR's clients get to what is there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.assets.core.fitting import box_of
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.assets.types.bathroom.basins import DIVIDED
from remqa_data.assets.types.furniture.storage import LET_IN
from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.backs import ON_WALLS
from remqa_data.floorplans.ithor.hosting import THIN_M
from remqa_data.geometry import arithmetic
from remqa_data.geometry.boxes import corners, intersection_volume
from remqa_data.geometry.rotations import about_z, quaternion_of, rotation_of, snapped_quaternion
from remqa_data.geometry.types import F64, Box
from remqa_data.scene import Scene, SceneObject, StructureBox

BENEATH_M = 0.03
"""What ends no farther than this below a thin worktop is let into it, or stands on it."""
IN_SINK_M = 0.05
"""What is over so much of a sink, both ways, stands in it."""
HALF_OPEN = 0.5
"""A door or drawer that opens less than this would cover what is in it; it opens all the way, through what is in its way."""
DEEP_BASIN_M, UNDIVIDED = 0.2, 1
"""A basin that is deeper than this is not divided, but of that variant."""
DEEP_M = 0.6
"""A piece of inner wall that is no farther from a window than this hides it."""
FRAME_M = 0.006
"""So much of a window is in the wall all around, a little more than where walls are made."""
PROUD_M = 0.004
"""How far what stood in a worktop then stands out of it."""


def uncovered(scene: Scene) -> Scene:
    """The same room with holes over sinks, in worktops and in what is built in below them, and with burners on worktops.

    No wall stands in a sink, and the window that was in it is in the outer wall; none stands before a window, but those that
    bear something. Deep basins have one bowl, and doors and drawers that would open less than half open all the way.
    """
    scene = _without_walls_in_sinks(scene)
    worktops = [o for o in scene.objects if o.type == "CounterTop" and o.asset.size[2] < THIN_M]
    holes = {o.id: found for o in worktops if (found := _missing_holes(o))}
    objects = [_cut_open(o, holes[o.id]) if o.id in holes else o for o in scene.objects]
    objects = [_raised(o, worktops) if o.type in types_with("burner") else o for o in objects]
    free = {
        "fixture": [_in_room(o, hole) for o in worktops for hole in holes.get(o.id, ())],
        "wall": [hole for o in scene.objects if o.type == "Window" and not _bears(hole := _before(o), scene)],
    }
    structure = [replace(p, box=box) for p in scene.structure for box in _around(p.box, free.get(p.kind, []))]
    objects = [_undivided(o) if o.type == "SinkBasin" else o for o in objects]
    objects = [replace(o, most_open=1.0) if o.most_open < HALF_OPEN else o for o in objects]
    return replace(scene, objects=tuple(objects), structure=tuple(structure))


def _undivided(basin: SceneObject) -> SceneObject:
    """A deep basin in one bowl: of two, the farther one is behind what divides them."""
    if basin.asset.variant != DIVIDED or basin.asset.size[2] <= DEEP_BASIN_M:
        return basin
    return replace(basin, asset=replace(basin.asset, variant=UNDIVIDED))


def _around(box: Box, holes: Sequence[Box]) -> list[Box]:
    """A box with holes, of which those that miss it leave it as it is."""
    met = [hole for hole in holes if intersection_volume(box, hole).any()]
    return solid_around(box, met) if met else [box]


def _before(window: SceneObject) -> Box:
    """Where no wall is to be: what a window takes up, and what lies before and behind it."""
    box = _box(window)
    low, high = box[0] + FRAME_M, box[1] - FRAME_M
    axis = int(np.argmin((high - low)[:2]))
    low[axis], high[axis] = low[axis] - DEEP_M, high[axis] + DEEP_M
    return box_of((*low, *high))


def _without_walls_in_sinks(scene: Scene) -> Scene:
    sinks = [_box(o) for o in scene.objects if o.type == "Sink"]
    standing = [part.box for part in scene.structure if any(_stands_in(part, sink) for sink in sinks)]
    for wall in standing:
        axis = int(np.argmin([wall[3] - wall[0], wall[4] - wall[1]]))
        faces = wall[axis], wall[axis + 3]
        structure = [p for p in scene.structure if p.kind != "wall" or (p.box[axis], p.box[axis + 3]) != faces]
        objects = [_moved_back(o, axis, faces, scene) if o.type == "Window" else o for o in scene.objects]
        scene = replace(scene, structure=tuple(structure), objects=tuple(objects))
    return scene


def _stands_in(wall: StructureBox, sink: F64) -> bool:
    """Whether a piece of the building is a wall that begins right above a sink."""
    low, high = np.reshape(wall.box, (2, 3))
    shared = np.minimum(high, sink[1]) - np.maximum(low, sink[0])
    return bool(wall.kind == "wall" and (shared[:2] > IN_SINK_M).all() and abs(low[2] - sink[1, 2]) < BENEATH_M)


def _moved_back(window: SceneObject, axis: int, faces: tuple[float, float], scene: Scene) -> SceneObject:
    """A window right before a wall that there is not, in the outer wall across from it, which it turns its back on."""
    box = _box(window)
    half = float(box[1, axis] - box[0, axis]) / 2
    is_ahead, is_behind = abs(box[0, axis] - faces[1]) < BENEATH_M, abs(box[1, axis] - faces[0]) < BENEATH_M
    if not (is_ahead or is_behind):
        return window
    position = list(window.position)
    position[axis] = scene.bounds[axis + 2] - half if is_ahead else scene.bounds[axis] + half
    turned = quaternion_of(arithmetic.product(about_z(180.0), rotation_of(window.quaternion)))
    return replace(window, position=(position[0], position[1], position[2]), quaternion=snapped_quaternion(turned))


def _box(o: SceneObject) -> F64:
    """(2, 3) box of an object that stands square in the room."""
    half = arithmetic.turned(np.divide(o.asset.size, 2), np.abs(rotation_of(o.quaternion)))
    return np.stack([np.subtract(o.position, half), np.add(o.position, half)])


def _bears(hole: Box, scene: Scene) -> bool:
    """Whether a wall that is where no wall is to be bears anything but curtains and blinds."""
    hung = [_box(o).ravel() for o in scene.objects if o.type in ON_WALLS - types_with("in_wall")]
    return bool(intersection_volume(hole, np.reshape(hung, (-1, 6))).any())


def _missing_holes(worktop: SceneObject) -> list[Box]:
    """What is to be free for the sinks under a worktop that has no hole for any of them, in its own frame."""
    pockets, thickness = worktop.asset.pockets, worktop.asset.size[2]
    if any(z1 > (LET_IN - 0.5) * thickness for *_, z1 in pockets):
        return []
    return [
        (x0, y0, z0, x1, y1, thickness / 2) for x0, y0, z0, x1, y1, z1 in pockets if z1 >= -thickness / 2 - BENEATH_M
    ]


def _cut_open(worktop: SceneObject, holes: Sequence[Box]) -> SceneObject:
    return replace(worktop, asset=replace(worktop.asset, pockets=tuple(holes)))


def _in_room(worktop: SceneObject, hole: Box) -> Box:
    points = arithmetic.turned(corners(np.reshape(hole, (2, 3))), rotation_of(worktop.quaternion)) + worktop.position
    return box_of((*points.min(axis=0), *points.max(axis=0)))


def _raised(burner: SceneObject, worktops: Sequence[SceneObject]) -> SceneObject:
    """A burner on top of the worktop that it is in."""
    x, y, z = burner.position
    top = z + burner.asset.size[2] / 2
    for worktop in worktops:
        surface = worktop.position[2] + worktop.asset.size[2] / 2
        local: F64 = arithmetic.turned_back(
            np.subtract(burner.position, worktop.position), rotation_of(worktop.quaternion)
        )
        is_over = (np.abs(local[:2]) <= np.array(worktop.asset.size[:2]) / 2).all()
        if is_over and surface - BENEATH_M <= top <= surface:
            return replace(burner, position=(x, y, z + surface + PROUD_M - top))
    return burner
