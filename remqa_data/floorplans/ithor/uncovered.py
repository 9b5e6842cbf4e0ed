"""What worktops cover in some rooms, uncovered: sinks that are let in from below, and burners.

Rooms are final in data of version 1, so the dataset keeps such worktops; AI2-THOR's clients get to what is under them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.assets.core.fitting import box_of
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.assets.types.furniture.storage import LET_IN
from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.hosting import THIN_M
from remqa_data.geometry import arithmetic
from remqa_data.geometry.boxes import corners
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Box
from remqa_data.scene import Scene, SceneObject

BENEATH_M = 0.03
"""What ends no farther than this below a thin worktop is let into it, or stands on it."""
PROUD_M = 0.004
"""How far what stood in a worktop then stands out of it."""


def uncovered(scene: Scene) -> Scene:
    """The same room with holes over sinks, in worktops and in what is built in below them, and with burners on worktops."""
    worktops = [o for o in scene.objects if o.type == "CounterTop" and o.asset.size[2] < THIN_M]
    holes = {o.id: found for o in worktops if (found := _missing_holes(o))}
    objects = [_cut_open(o, holes[o.id]) if o.id in holes else o for o in scene.objects]
    objects = [_raised(o, worktops) if o.type in types_with("burner") else o for o in objects]
    in_room = [_in_room(o, hole) for o in worktops for hole in holes.get(o.id, ())]
    structure = [
        replace(part, box=box)
        for part in scene.structure
        for box in (solid_around(part.box, in_room) if in_room and part.kind == "fixture" else [part.box])
    ]
    return replace(scene, objects=tuple(objects), structure=tuple(structure))


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
