"""Loose things find a new place: on open receptacles, as likely as such things were recorded there."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.assets.core.model import Space
from remqa_data.catalog import object_type
from remqa_data.floorplans.ithor.placements import receptacle_weights
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import quaternion_of, rotation_of
from remqa_data.geometry.types import F64, Box
from remqa_data.sim.physics.world import World

TRIES = 12
SKIN_M = 0.001
"""Room left between a thing and what it is put on."""
TOUCH_M = 0.001
"""Things that are set down may be this deep in others."""
EDGE_M = 0.01


@dataclass(frozen=True)
class OpenSurface:
    """An open space of a receptacle."""

    owner: str
    space: Space


def open_surfaces(world: World, never: Collection[str]) -> list[OpenSurface]:
    """Where loose things can be put: open spaces of furniture and fittings, but not of the floor nor of some objects."""
    return [
        OpenSurface(object_id, space)
        for object_id in world.ids
        if object_id not in never
        and world.type_of(object_id) != "Floor"
        and not object_type(world.type_of(object_id)).pickupable
        for space in world.assets[object_id].spaces
        if not space.enclosed
    ]


def put_anew(
    world: World,
    object_id: str,
    room_type: str,
    surfaces: Sequence[OpenSurface],
    keep_out: Sequence[Box],
    rng: np.random.Generator,
    tries: int = TRIES,
    weights: Mapping[str, float] | None = None,
) -> bool:
    """Put a loose thing, with what is in it, somewhere else; False, and nothing has changed, if no room was found.

    Parameters
    ----------
    world : World
        The room.
    object_id : str
        The thing.
    room_type : str
        Kind of room, for the priors.
    surfaces : sequence of OpenSurface
        Where it may be put.
    keep_out : sequence of Box
        Boxes in the room, metres, that stay free.
    rng : numpy.random.Generator
        Draws receptacle, place and turn.
    tries : int
        How many places are tried.
    weights : mapping of str to float, optional
        How likely each type of receptacle is that has a surface; by default as such things were recorded in such rooms.
    """
    by_type: dict[str, list[OpenSurface]] = {}
    for surface in surfaces:
        by_type.setdefault(world.type_of(surface.owner), []).append(surface)
    if weights is None:
        weights = receptacle_weights(world.type_of(object_id), room_type, by_type)
    if not weights:
        return False
    names = sorted(weights)
    shares = np.array([weights[name] for name in names])
    snapshot = world.save()
    for _ in range(tries):
        options = by_type[names[int(rng.choice(len(names), p=shares / shares.sum()))]]
        areas = np.array([_area(option.space) for option in options])
        surface = options[int(rng.choice(len(options), p=areas / areas.sum()))]
        moved = _set_down(world, object_id, surface, rng)
        if moved is not None and not _is_in_the_way(world, moved, keep_out):
            return True
        world.restore(snapshot)
    return False


def _area(space: Space) -> float:
    return max(1e-6, (space.box[3] - space.box[0]) * (space.box[4] - space.box[1]))


def _set_down(world: World, object_id: str, surface: OpenSurface, rng: np.random.Generator) -> list[str] | None:
    """Put a thing on a surface, turned at random; the ids that moved, or None if it does not fit."""
    state = world.state(object_id)
    angle = float(rng.uniform(0, 2 * math.pi))
    sin, cos = arithmetic.sin_cos(angle)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    quaternion = quaternion_of(arithmetic.product(turn, rotation_of(state.quaternion)))
    low, high = np.array(surface.space.box[:3]), np.array(surface.space.box[3:])
    pose = world.link_poses(surface.owner)[surface.space.link]
    offset, half, height = _turned(world, object_id, turn)
    local_half = arithmetic.dot(np.abs(pose[:2, :2].T), half)
    room = (high - low)[:2] / 2 - local_half - EDGE_M
    shift = rng.uniform(-1, 1, 2)
    if room.min() < 0 or height > high[2] - low[2] + 0.3:
        return None
    local = np.append((low + high)[:2] / 2 + shift * room, low[2])
    x, y, z = arithmetic.moved(local, pose) - offset + [0.0, 0.0, SKIN_M]
    carried = world.move(object_id, (float(x), float(y), float(z)), quaternion)
    return [object_id, *carried]


def _turned(world: World, object_id: str, turn: F64) -> tuple[F64, F64, float]:
    """Of a thing turned about its centre: from the centre to the middle of its bottom, half its plan, its height."""
    position = np.array(world.state(object_id).position)
    points = world.assets[object_id].vertices_at(world.link_poses(object_id))
    turned = arithmetic.turned(points - position, turn)
    low, high = turned.min(axis=0), turned.max(axis=0)
    return np.append((low + high)[:2] / 2, low[2]), (high - low)[:2] / 2, float(high[2] - low[2])


def _is_in_the_way(world: World, moved: Sequence[str], keep_out: Sequence[Box]) -> bool:
    for object_id in moved:
        low, high = world.box(object_id)
        if any(np.all(low < box[3:]) and np.all(high > box[:3]) for box in map(np.asarray, keep_out)):
            return True
        if any(depth < -TOUCH_M and other not in moved for other, depth in world.overlapping(object_id)):
            return True
    return False
