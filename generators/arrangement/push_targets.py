"""Where a piece of furniture or an appliance can be pushed: along what it stands on, to where there is room."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.physics.bodies import STRUCTURE_NAME
from remqa_data.sim.physics.world import World

MAX_OVERLAP_M = 0.005
LEVEL_M = 0.015
"""What carries an object may be this much higher or lower at its new place."""
CARRIED = (-0.7, 0.0, 0.7)
"""Where, as shares of half its sides, an object is carried."""


def push_targets(world: World, object_id: str, gaps_m: Sequence[float]) -> list[Vec3]:
    """For each of the object's four directions, where its centre is after the smallest shift to free room, if any.

    It is shifted by more than its own length in that direction, so that all that it covered comes to light.

    Parameters
    ----------
    world : World
        The room; it is the same afterwards.
    object_id : str
        What is to be moved. What is in or on it goes with it.
    gaps_m : sequence of float
        How much farther than its own length it may go, smallest first.

    Notes
    -----
    Free room: nothing fixed is overlapped by more than 5 mm, and there is something level to stand on. Loose things do not
    count: they are put elsewhere where they are in the way.
    """
    snapshot = world.save()
    state = world.state(object_id)
    start, turn = np.array(state.position), state.matrix()[:3, :3]
    low, high = world.box(object_id)
    half = (high - low)[:2] / 2
    carried = set(world.contents(object_id))
    offset = (low + high)[:2] / 2 - start[:2]
    found: list[Vec3] = []
    width, depth, _ = world.assets[object_id].spec.size
    for direction, own in ((turn[:, 0], width), (-turn[:, 0], width), (-turn[:, 1], depth), (turn[:, 1], depth)):
        level = direction * [1.0, 1.0, 0.0]
        for shift in (own + gap for gap in gaps_m if own + gap < AGENT.push_m):
            x, y, z = start + shift * level / arithmetic.length(level)
            target = (float(x), float(y), float(z))
            world.move_alone(object_id, target)
            met = [other for other, d in world.overlapping(object_id) if d < -MAX_OVERLAP_M and other not in carried]
            blocked = any(other == STRUCTURE_NAME or world.state(other).is_fixed for other in met)
            if not blocked and _is_carried(world, object_id, np.array([x, y])[:2] + offset, half, float(low[2])):
                found.append(target)
                break
    world.restore(snapshot)
    return found


def _is_carried(world: World, object_id: str, centre: F64, half: F64, bottom: float) -> bool:
    starts = [
        (float(centre[0] + a * half[0]), float(centre[1] + b * half[1]), bottom + 0.03)
        for a in CARRIED
        for b in CARRIED
    ]
    ends = [(x, y, bottom - LEVEL_M) for x, y, _ in starts]
    with world.without_collisions(object_id):
        hits = world.client.rayTestBatch(starts, ends)
    return all(hit[0] >= 0 and abs(hit[3][2] - bottom) <= LEVEL_M for hit in hits)
