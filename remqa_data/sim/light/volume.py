"""Indirect light on a lattice of probes, as cubes of six colours, and what a surface receives of it.

Each probe keeps the light that a small surface there would receive for the six directions in which it could look
("ambient cube"; McTaggart, Half-Life 2 / Valve Source Shading, 2004). A surface takes it from the eight probes around it
that lie before it, so that no light comes through walls (as in Majercik et al., Dynamic Diffuse Global Illumination with
Ray-Traced Irradiance Fields, 2019).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, U8, Flags
from remqa_data.sim.light.voxels import SIDES, Voxels

AHEAD_M = 0.06
"""A surface looks up its light so far before itself."""
BEYOND, NEAR_SURFACE, IN_AIR = 0, 1, 2
NEAR = 2.0
"""Surfaces take their light from probes that are at most so many steps of the lattice away."""


class Volume(NamedTuple):
    """Probes on a lattice."""

    origin: F64
    """(3,) of probe (0, 0, 0), metres."""
    light: F32
    """(nx, ny, nz, 6, 3) linear."""
    spacing_m: float
    """From one probe to the next along each axis."""
    is_valid: Flags
    """(nx, ny, nz) whether a probe lies in free space."""
    least: float
    """Nothing is darker, so that the insides of what is opened can be seen."""


@exact
def places_of(voxels: Voxels, volume: Volume, low: F64, high: F64) -> U8:
    """(nx, ny, nz) where each probe is: near a surface, in free air, or beyond the walls between two corners of the room.

    Those beyond are left out: between the wall and the pane of a window it is brighter than anything that is seen.
    """
    nx, ny, nz = volume.is_valid.shape
    places = np.full((nx, ny, nz), IN_AIR, dtype=np.uint8)
    share = voxels.size_m / volume.spacing_m
    shift = (voxels.origin - volume.origin) / volume.spacing_m
    mx, my, mz = voxels.number.shape
    for i in range(mx):
        for j in range(my):
            for m in range(mz):
                if voxels.number[i, j, m] < 0:
                    continue
                x, y, z = (i + 0.5) * share + shift[0], (j + 0.5) * share + shift[1], (m + 0.5) * share + shift[2]
                for a in range(max(math.ceil(x - NEAR), 0), min(math.floor(x + NEAR) + 1, nx)):
                    for b in range(max(math.ceil(y - NEAR), 0), min(math.floor(y + NEAR) + 1, ny)):
                        for c in range(max(math.ceil(z - NEAR), 0), min(math.floor(z + NEAR) + 1, nz)):
                            places[a, b, c] = NEAR_SURFACE
    for i in range(nx):
        for j in range(ny):
            for m in range(nz):
                x, y, z = i * volume.spacing_m, j * volume.spacing_m, m * volume.spacing_m
                x, y, z = x + volume.origin[0], y + volume.origin[1], z + volume.origin[2]
                is_in = low[0] <= x <= high[0] and low[1] <= y <= high[1] and low[2] <= z <= high[2]
                if not is_in:
                    places[i, j, m] = BEYOND
    return places


@exact
def fill_beyond(volume: Volume, places: U8) -> None:
    """Give the probes beyond the walls the mean light of those beside them, so that edges and niches find some, too."""
    nx, ny, nz = volume.is_valid.shape
    for _ in range(2):
        was = volume.is_valid.copy()
        for i in range(nx):
            for j in range(ny):
                for m in range(nz):
                    if was[i, j, m] or places[i, j, m] != BEYOND:
                        continue
                    total, count = np.zeros((SIDES, 3)), 0
                    for a in range(max(i - 1, 0), min(i + 2, nx)):
                        for b in range(max(j - 1, 0), min(j + 2, ny)):
                            for c in range(max(m - 1, 0), min(m + 2, nz)):
                                if was[a, b, c]:
                                    count += 1
                                    for side in range(SIDES):
                                        for channel in range(3):
                                            total[side, channel] += volume.light[a, b, c, side, channel]
                    if count > 0:
                        volume.is_valid[i, j, m] = True
                        for side in range(SIDES):
                            for channel in range(3):
                                volume.light[i, j, m, side, channel] = total[side, channel] / count


@exact
def mean_in_air(volume: Volume, places: U8) -> float:
    """Mean light of the probes in free air, and of all where there are few such."""
    nx, ny, nz = volume.is_valid.shape
    total, count = np.zeros(2), np.zeros(2)
    for i in range(nx):
        for j in range(ny):
            for m in range(nz):
                if volume.is_valid[i, j, m] and places[i, j, m] != BEYOND:
                    which = 0 if places[i, j, m] == IN_AIR else 1
                    count[which] += 3 * SIDES
                    for side in range(SIDES):
                        for channel in range(3):
                            total[which] += volume.light[i, j, m, side, channel]
    if count[0] > 0.1 * count[1]:
        return float(total[0] / count[0])
    return float((total[0] + total[1]) / max(count[0] + count[1], 1.0))


@exact
def smooth(volume: Volume) -> Volume:
    """The same without most of its noise: each probe's light averaged with that of the probes beside it.

    For each direction, those beside it are those at the same distance before a surface that looks that way.
    """
    nx, ny, nz = volume.is_valid.shape
    light = np.zeros_like(volume.light)
    for i in range(nx):
        for j in range(ny):
            for m in range(nz):
                if not volume.is_valid[i, j, m]:
                    continue
                for side in range(SIDES):
                    axis = side // 2
                    total, weights = np.zeros(3), 0.0
                    for first in range(-1, 2):
                        for second in range(-1, 2):
                            a = i + (0 if axis == 0 else first)
                            b = j + (first if axis == 0 else (0 if axis == 1 else second))
                            c = m + (0 if axis == 2 else second)
                            if 0 <= a < nx and 0 <= b < ny and 0 <= c < nz and volume.is_valid[a, b, c]:
                                weight = (2.0 - abs(first)) * (2.0 - abs(second))
                                weights += weight
                                for channel in range(3):
                                    total[channel] += weight * volume.light[a, b, c, side, channel]
                    for channel in range(3):
                        light[i, j, m, side, channel] = total[channel] / weights
    return Volume(volume.origin, light, volume.spacing_m, volume.is_valid, volume.least)


@exact
def light_at(volume: Volume, x: float, y: float, z: float, nx: float, ny: float, nz: float, out: F32) -> bool:
    """Write the (3,) light that a surface at a point receives; False, and nothing written, where no probe is near.

    `nx, ny, nz` is where the surface looks, a unit vector.
    """
    return _mixed(volume, x, y, z, nx, ny, nz, AHEAD_M, out) or _mixed(volume, x, y, z, nx, ny, nz, 2.5 * AHEAD_M, out)


@exact
def _mixed(
    volume: Volume, x: float, y: float, z: float, nx: float, ny: float, nz: float, ahead_m: float, out: F32
) -> bool:
    """As `light_at`, of the eight probes around a point so far before the surface."""
    sx, sy, sz = volume.is_valid.shape
    fx = (x + ahead_m * nx - volume.origin[0]) / volume.spacing_m
    fy = (y + ahead_m * ny - volume.origin[1]) / volume.spacing_m
    fz = (z + ahead_m * nz - volume.origin[2]) / volume.spacing_m
    fx, fy, fz = min(max(fx, 0.0), sx - 1.001), min(max(fy, 0.0), sy - 1.001), min(max(fz, 0.0), sz - 1.001)
    i, j, m = math.floor(fx), math.floor(fy), math.floor(fz)
    ax, ay, az = fx - i, fy - j, fz - m
    at_x, at_y, at_z = (x - volume.origin[0]) / volume.spacing_m, (y - volume.origin[1]) / volume.spacing_m, 0.0
    at_z = (z - volume.origin[2]) / volume.spacing_m
    side_x, side_y, side_z = (0 if nx > 0 else 1), (2 if ny > 0 else 3), (4 if nz > 0 else 5)
    wx, wy, wz = nx * nx, ny * ny, nz * nz
    red = green = blue = sum_of_weights = 0.0
    for corner in range(8):
        di, dj, dl = corner & 1, (corner >> 1) & 1, corner >> 2
        if not volume.is_valid[i + di, j + dj, m + dl]:
            continue
        ahead = nx * (i + di - at_x) + ny * (j + dj - at_y) + nz * (m + dl - at_z)
        if ahead <= 0.0:
            continue
        weight = (ax if di else 1.0 - ax) * (ay if dj else 1.0 - ay) * (az if dl else 1.0 - az)
        weight = (weight + 1e-4) * min(1.0, 4.0 * ahead)
        light = volume.light[i + di, j + dj, m + dl]
        red += weight * (wx * light[side_x, 0] + wy * light[side_y, 0] + wz * light[side_z, 0])
        green += weight * (wx * light[side_x, 1] + wy * light[side_y, 1] + wz * light[side_z, 1])
        blue += weight * (wx * light[side_x, 2] + wy * light[side_y, 2] + wz * light[side_z, 2])
        sum_of_weights += weight
    if sum_of_weights <= 0.0:
        return False
    out[0], out[1], out[2] = red / sum_of_weights, green / sum_of_weights, blue / sum_of_weights
    return True
