"""Sees to it that everything loose rests on something, and that nothing is stuck in anything.

Recorded heights are off by millimetres, and the mantels and ledges of some rooms were not recorded at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.assets.core.model import Material
from remqa_data.catalog import object_type
from remqa_data.floorplans.ithor.plan import SIDES, RoomShell
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Box
from remqa_data.scene import Scene, SceneObject, StructureBox
from remqa_data.sim.physics.world import World

SNAP_M = 0.04
"""A thing is lifted or lowered at most this far to rest on what is under it."""
LOOK_M = 0.07
"""How far above and below a thing's bottom a surface is looked for."""
SKIN_M = 0.0005
"""Room left between a thing and what it rests on, so that physics has nothing to push apart."""
LEVEL_M = 0.012
"""Hits this close in height belong to one surface."""
OFF_CENTRE = 0.2
"""A surface carries a thing if it reaches at least this near to below its middle, as a share of its half width."""
STUCK_M, TOUCH_M = 0.012, 0.004
ASIDE_M = (0.015, 0.03, 0.045, 0.07, 0.10, 0.13)
"""What is stuck deeper than the first is moved aside by one of these until it touches by no more than the second."""
OFF_FLOOR_M = 0.1
LEDGE_MARGIN_M, LEDGE_M = 0.04, 0.02
TO_WALL_M = 0.45


def supported(scene: Scene, shell: RoomShell, finish: Material) -> Scene:
    """The same scene with every loose thing, and what is pushed about on worktops, on top of what is under it.

    A ledge is built where there is nothing.
    """
    with World(scene) as world:
        probe = _Probe(world)
        loose = [o for o in scene.objects if not o.is_fixed]
        lowest = {o.id: float(world.box(o.id)[0, 2]) for o in scene.objects}
        moved: dict[str, SceneObject] = {}
        for o in scene.objects:  # appliances were recorded up to 2 cm deep in their worktops
            if object_type(o.type).moveable and lowest[o.id] > shell.floor_z + OFF_FLOOR_M:
                surface = probe.surface_under(o.id, world.box(o.id))
                lift = 0.0 if surface is None else surface + SKIN_M - lowest[o.id]
                if 0.0 < lift <= SNAP_M and (lifted := _lifted(world, o, lift)) is not None:
                    moved[o.id] = lifted
        bare: list[F64] = []
        for o in sorted(loose, key=lambda item: (lowest[item.id], item.id)):
            box = world.box(o.id)
            surface = probe.surface_under(o.id, box)
            if surface is None:
                bare.append(box)
                continue
            lift = surface + SKIN_M - lowest[o.id]
            if lift < -SNAP_M:
                bare.append(box)
            elif lift <= SNAP_M and (lifted := _lifted(world, o, lift)) is not None:
                moved[o.id] = lifted
        for o in loose:
            freed = _freed(world, probe, moved.get(o.id, o))
            if freed is not None:
                moved[o.id] = freed
    ledges = [StructureBox("fixture", ledge, finish) for ledge in _ledges(bare, shell)]
    objects = tuple(moved.get(o.id, o) for o in scene.objects)
    return replace(scene, objects=objects, structure=scene.structure + tuple(ledges))


def _lifted(world: World, o: SceneObject, lift: float) -> SceneObject | None:
    """A thing lifted or lowered, unless it would be stuck there deeper than where it was."""
    x, y, z = o.position
    before = _depth(world, o.id)
    world.move_alone(o.id, (x, y, z + lift))
    if _depth(world, o.id) > max(before, STUCK_M):
        world.move_alone(o.id, o.position)
        return None
    return replace(o, position=(x, y, z + lift))


def _freed(world: World, probe: _Probe, o: SceneObject) -> SceneObject | None:
    """A thing that is stuck in another, moved aside a little; where there is no room, held so that physics leaves it."""
    if _depth(world, o.id) < STUCK_M:
        return None
    x, y, z = o.position
    ground = probe.surface_under(o.id, world.box(o.id))
    for radius in ASIDE_M:
        for angle in np.arange(8) * np.pi / 4:
            sine, cosine = arithmetic.sin_cos(angle)
            aside = (x + radius * float(cosine), y + radius * float(sine), z)
            world.move_alone(o.id, aside)
            if _depth(world, o.id) < TOUCH_M and _is_level(probe.surface_under(o.id, world.box(o.id)), ground):
                return replace(o, position=aside)
    world.move_alone(o.id, o.position)
    return replace(o, is_fixed=True)


def _is_level(surface: float | None, ground: float | None) -> bool:
    """Whether a thing that was carried at one height is carried at the same height."""
    return ground is None or (surface is not None and abs(surface - ground) < LEVEL_M)


def _depth(world: World, object_id: str) -> float:
    """How deep an object is in anything else, metres."""
    return max((-distance for _, distance in world.overlapping(object_id)), default=0.0)


class _Probe:
    """Looks for surfaces with rays, past the thing itself."""

    def __init__(self, world: World) -> None:
        self.world = world

    def surface_under(self, object_id: str, box: F64) -> float | None:
        """Height of the highest surface near an object's bottom that would carry it, or None."""
        low, high = box
        middle, half = (low + high)[:2] / 2, (high - low)[:2] / 2
        starts = [
            (middle[0] + a * half[0], middle[1] + b * half[1], low[2] + min(LOOK_M, 0.9 * (high[2] - low[2]) + 0.03))
            for a in (-0.6, -0.25, 0.0, 0.25, 0.6)
            for b in (-0.6, -0.25, 0.0, 0.25, 0.6)
        ]
        ends = [(x, y, float(low[2]) - LOOK_M) for x, y, _ in starts]
        with self.world.without_collisions(object_id):
            hits = self.world.client.rayTestBatch(starts, ends)
        points = np.array([hit[3] for hit in hits if hit[0] >= 0 and hit[2] > 0]).reshape(-1, 3)
        while len(points):
            top = points[points[:, 2] > points[:, 2].max() - LEVEL_M]
            reach = OFF_CENTRE * half
            if np.all(top[:, :2].min(axis=0) <= middle + reach) and np.all(top[:, :2].max(axis=0) >= middle - reach):
                return float(top[:, 2].max())
            points = points[points[:, 2] <= points[:, 2].max() - LEVEL_M]
        return None


def _ledges(boxes: Sequence[F64], shell: RoomShell) -> list[Box]:
    """One board under each group of things at one height that nothing carries, back to the wall where it is near."""
    groups: list[F64] = []
    for box in boxes:
        if box[0, 2] < shell.floor_z + 0.1:
            continue
        for i, group in enumerate(groups):
            near = np.all(box[0, :2] < group[1, :2] + 0.25) and np.all(box[1, :2] > group[0, :2] - 0.25)
            if near and abs(group[0, 2] - box[0, 2]) < 0.015:
                groups[i] = np.stack([np.minimum(group[0], box[0]), np.maximum(group[1], box[1])])
                break
        else:
            groups.append(box.copy())
    ledges: list[Box] = []
    for group in groups:
        low, high = group[0] - LEDGE_MARGIN_M, group[1] + LEDGE_MARGIN_M
        side, gap = shell.nearest_side(low, high)
        inward = SIDES[side]
        axis = int(np.abs(inward).argmax())
        if gap < TO_WALL_M:
            (low if inward[axis] > 0 else high)[axis] = shell.bounds[axis if inward[axis] > 0 else axis + 2]
        top = float(group[0, 2]) - SKIN_M
        ledges.append((float(low[0]), float(low[1]), top - LEDGE_M, float(high[0]), float(high[1]), top))
    return ledges
