"""From the surfaces of a room that never move to the light that everything in it receives from everywhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation

from remqa_data.compiled import exact
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F32, F64, U8, Flags, Vec3
from remqa_data.sim.light.gather import gather
from remqa_data.sim.light.volume import (
    BEYOND,
    IN_AIR,
    Volume,
    fill_beyond,
    light_at,
    mean_in_air,
    places_of,
    smooth,
)
from remqa_data.sim.light.voxels import Faces, Points, Voxels, cube_of, lit_by, looks_back, surface_points, voxelise

SETS, FEW_RAYS, RAYS = 8, 32, 128
"""Of directions for neighbouring probes; how many rays each probe casts for the first bounce, and for the second."""
SKY = 1.0
GLOW = 3.0
"""What glows, such as the sky in a window, lights the room by so many times what a picture shows of it."""
LEAST = 0.3
"""Share of the mean light that the darkest corner gets."""
PROBE_M, VOXEL = 0.125, 0.32
"""Probes are so far apart, and cubes are so many times smaller."""
MOST_PROBES = 200_000
BORDER_M = 0.15
_GOLDEN = (5.0**0.5 - 1.0) / 2.0


@dataclass(frozen=True)
class Lamps:
    """Where light comes from: (k, 3) positions, (k,) strength near by, and the distance at which it has halved, metres."""

    positions: F64
    strength: F32
    reach_m: float


def bake(faces: Faces, lamps: Lamps, low: Vec3, high: Vec3, level: float) -> Volume:
    """The indirect light of a room: what lamps, windows and whatever glows send by way of its surfaces, twice reflected.

    Parameters
    ----------
    faces : Faces
        All that never moves.
    lamps : Lamps
        The same that light it directly.
    low, high : tuple of float
        Corners of the room, metres.
    level : float
        Mean light in the air of the room is to be this: the exposure.
    """
    volume = _empty(low, high, LEAST * level)
    voxel_m = volume.spacing_m * VOXEL
    points = surface_points(faces)
    border = BORDER_M + volume.spacing_m
    voxels = voxelise(faces, points, np.asarray(low) - border, np.asarray(high) + border, voxel_m)
    direct = np.zeros(len(points.face), dtype=np.float32)
    for position, strength in zip(lamps.positions, lamps.strength, strict=True):
        direct += _from_lamp(faces, points, lit_by(voxels, faces, points, position), position, strength, lamps.reach_m)
    guess = _even_light(faces, points, direct, GLOW)
    _send(faces, points, voxels, direct, volume, guess, GLOW)
    places = places_of(voxels, volume, np.array(low), np.array(high))
    few = _directions(FEW_RAYS)
    gather(voxels, volume, few, few, SKY, _looked_up(places))
    _send(faces, points, voxels, direct, volume, guess, GLOW)
    gather(voxels, volume, _directions(RAYS), few, SKY, places)
    volume = smooth(volume)
    volume.light[:] *= np.float32(level / max(mean_in_air(volume, places), 1e-9))
    fill_beyond(volume, places)
    return volume


def _empty(low: Vec3, high: Vec3, least: float) -> Volume:
    """Dark probes in a room and a little beyond its walls; coarser in a hall than in a room."""
    origin, end = np.asarray(low) - BORDER_M, np.asarray(high) + BORDER_M
    spacing_m = PROBE_M
    while np.prod((end - origin) / spacing_m) > MOST_PROBES:
        spacing_m *= 1.25
    shape = tuple(int(n) for n in np.ceil((end - origin) / spacing_m) + 1)
    return Volume(origin, np.zeros((*shape, 6, 3), dtype=np.float32), spacing_m, np.zeros(shape, dtype=np.bool_), least)


def _looked_up(places: U8) -> U8:
    """Where each probe is, as if those were beyond the walls from which no surface takes its light.

    A surface looks at most 2.5 `AHEAD_M` before itself, for the eight probes around: no farther than one beside those near it.
    """
    near: Flags = binary_dilation(places != IN_AIR, np.ones((3, 3, 3), dtype=np.bool_))
    return np.where(near, places, np.uint8(BEYOND))


def _directions(count: int) -> F64:
    """(SETS, count, 3) unit vectors: sets that are each a Fibonacci lattice, turned and shifted against the others."""
    ray, number = np.arange(count)[None], np.arange(SETS)[:, None]
    z = 1.0 - 2.0 * (ray + (number + 0.5) / SETS) / count
    sine, cosine = arithmetic.sin_cos(2.0 * np.pi * ((ray * _GOLDEN + number / SETS) % 1.0))
    radius = np.sqrt(1.0 - z * z)
    return np.ascontiguousarray(np.stack([radius * cosine, radius * sine, z], axis=-1))


@exact
def _from_lamp(faces: Faces, points: Points, lit: F32, lamp: F64, strength: float, reach_m: float) -> F32:
    """(k,) light of a lamp at each point, as `shade` has it."""
    received = np.zeros(len(points.face), dtype=np.float32)
    for k in range(len(points.face)):
        if lit[k] > 0:
            normal, p = faces.normals[points.face[k]], points.position[k]
            x, y, z = lamp[0] - p[0], lamp[1] - p[1], lamp[2] - p[2]
            square = x * x + y * y + z * z
            cosine = abs(normal[0] * x + normal[1] * y + normal[2] * z) / np.sqrt(square)
            received[k] = lit[k] * strength * cosine / (1.0 + square / (reach_m * reach_m))
    return received


@exact
def _even_light(faces: Faces, points: Points, direct: F32, glow: float) -> F32:
    """(3,) light that surfaces would receive if all sent the mean of them all: e / (1 - a), of means over their area."""
    sent, albedo = np.zeros(3), np.zeros(3)
    area = 0.0
    for k in range(len(points.face)):
        f = points.face[k]
        area += points.area[k]
        for channel in range(3):
            light = (1.0 - faces.glow[f]) * direct[k] + glow * faces.glow[f]
            sent[channel] += points.area[k] * faces.albedo[f, channel] * light
            albedo[channel] += points.area[k] * faces.albedo[f, channel] * (1.0 - faces.glow[f])
    even = np.zeros(3, dtype=np.float32)
    for channel in range(3):
        even[channel] = sent[channel] / max(area - albedo[channel], 1e-9)
    return even


@exact
def _send(faces: Faces, points: Points, voxels: Voxels, direct: F32, volume: Volume, guess: F32, glow: float) -> None:
    """Work out anew what each cube sends out: of what lamps and the volume give, and of its own.

    Where the volume has no light yet, `guess` is taken.
    """
    voxels.sent[:] = 0.0
    is_dark = not volume.is_valid.any()
    received = np.zeros(3, dtype=np.float32)
    for k in range(len(points.face)):
        i, j, m = cube_of(points.position[k], voxels.origin, voxels.size_m, voxels.number)
        f = points.face[k]
        if i < 0 or looks_back(faces, f):
            continue
        cube, p, normal = voxels.number[i, j, m], points.position[k], faces.normals[f]
        if is_dark or not light_at(volume, p[0], p[1], p[2], normal[0], normal[1], normal[2], received):
            received[0], received[1], received[2] = guess[0], guess[1], guess[2]
        for axis in range(3):
            n = normal[axis]
            for side in range(2):
                if (n > 0) == (side == 0) or faces.is_open[f]:
                    share = abs(n) * points.area[k]
                    whole = voxels.cover[cube, 2 * axis + side]
                    if whole > 0:
                        for channel in range(3):
                            light = (1.0 - faces.glow[f]) * (direct[k] + received[channel]) + glow * faces.glow[f]
                            voxels.sent[cube, 2 * axis + side, channel] += (
                                share / whole * faces.albedo[f, channel] * light
                            )
