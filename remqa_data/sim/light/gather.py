"""What the probes of a volume receive: rays from each of them to the cubes around.

Most probes lie at the same few places within their cubes, as a probe's step is 25 / 8 of a cube. From the same place and in the
same direction a ray crosses the same steps of cubes, whichever cube it starts from. So probes are taken in groups: the way is
worked out once for each direction, and each of them follows it to the first cube that ends it. What lies there is then read
for all of them at once, because nearly all the time goes into waiting for memory.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I32, I64, U8, U64, Flags
from remqa_data.sim.light.volume import BEYOND, IN_AIR, Volume
from remqa_data.sim.light.voxels import OUTSIDE, RIM, SIDES, WALL, Voxels, crossings, marked, sides_against, with_rim

BACKS = 0.25
"""A probe of which more rays meet backs lies inside something."""
_SAME = 9
"""Places within cubes are the same if so many decimals are."""
_EDGE = 1e-6
"""Rays that pass an edge so closely, as a share of a cube's side, are followed from each probe alone."""


class Probes(NamedTuple):
    """Probes in groups: of a group, all cast the same rays from the same place within their cubes."""

    number: I32
    """(n, 3) of each on the lattice, group by group."""
    cube: I64
    """(n,) which bit of `Ends` stands for the cube in which each lies."""
    inside: F64
    """(n, 3) where in that cube, in cubes."""
    first: I64
    """(groups + 1,) of each group, and how many there are in all."""
    rays: I64
    """(groups, 2) from which ray to which."""


class Ends(NamedTuple):
    """Which cubes end a ray, by where it goes."""

    bits: U64
    """(patterns, words) a bit for each cube, as in `Voxels.stops`."""
    pattern: I64
    """(rays,) which of them is that of a ray."""
    cube: I32
    """Number of each cube by its bit; `OUTSIDE` for those of the rim, -1 for empty ones."""
    sides: F32
    """(6, cubes, 4) square metres that look each way, and the mean light that these send out, linear."""


def gather(voxels: Voxels, volume: Volume, directions: F64, in_air: F64, sky: float, places: U8) -> None:
    """Fill a volume with the light that the cubes send out.

    Parameters
    ----------
    directions : (sets, n, 3) array
        Unit vectors, spread evenly; neighbouring probes use different sets, so that what interpolates them averages.
    in_air : (sets, m, 3) array
        Those of probes in free air, where light changes slowly.
    sky : float
        What comes from outside of the room.
    places : (nx, ny, nz) array
        Where each probe is, see `places_of`.
    """
    volume.is_valid[:] = False
    rays = np.concatenate([directions.reshape(-1, 3), in_air.reshape(-1, 3)])
    probes = _grouped(voxels, volume, places, directions.shape[:2], in_air.shape[1])
    _receive(volume, probes, rays, _ends(voxels, rays), np.array(voxels.number.shape), sky)


def _grouped(voxels: Voxels, volume: Volume, places: U8, near: tuple[int, ...], few: int) -> Probes:
    """The probes in free cubes of the room, those that are alike together; `near` sets of so many rays, `few` each in air."""
    at = [
        (volume.origin[axis] + np.arange(count) * volume.spacing_m - voxels.origin[axis]) / voxels.size_m
        for axis, count in enumerate(places.shape)
    ]
    cubes = [np.floor(along).astype(np.int64) for along in at]
    number = np.argwhere((places != BEYOND) & (voxels.number[np.ix_(*cubes)] < 0))
    is_in_air = places[tuple(number.T)] == IN_AIR
    one = (number % 2 * np.array([1, 2, 4])).sum(axis=1) % near[0]
    alike = one * 2 + is_in_air
    for axis in range(3):
        which, of_each = np.unique(np.round(at[axis] - cubes[axis], _SAME), return_inverse=True)
        alike = alike * len(which) + of_each[number[:, axis]]
    order = np.argsort(alike, kind="stable")
    number, begins = number[order], np.flatnonzero(np.diff(alike[order], prepend=-1))
    cube = np.stack([cubes[axis][number[:, axis]] for axis in range(3)], axis=1)
    lot = one[order][begins]
    first_ray = np.where(is_in_air[order][begins], near[0] * near[1] + lot * few, lot * near[1])
    count = np.where(is_in_air[order][begins], few, near[1])
    return Probes(
        number.astype(np.int32),
        np.ravel_multi_index(tuple((cube + RIM).T), tuple(np.array(voxels.number.shape) + 2 * RIM)).astype(np.int64),
        np.stack([at[axis][number[:, axis]] for axis in range(3)], axis=1) - cube,
        np.append(begins, len(number)),
        np.stack([first_ray, first_ray + count], axis=1),
    )


def _ends(voxels: Voxels, rays: F64) -> Ends:
    """What ends rays, and what they find there."""
    signs, pattern = np.unique(np.sign(rays), axis=0, return_inverse=True)
    cube = with_rim(voxels.number).ravel()
    bits = np.stack([marked(cube, _is_end(voxels, sign)) for sign in signs])
    sides = np.concatenate([voxels.cover.T[..., None], voxels.sent.transpose(1, 0, 2)], axis=2)
    return Ends(bits, pattern.ravel(), cube, np.ascontiguousarray(sides))


def _is_end(voxels: Voxels, sign: F64) -> Flags:
    """(cubes,) whether each ends the rays that go so along the axes: by a wall, or by what looks against them."""
    sides = [2 * axis + int(along > 0) for axis, along in enumerate(sign) if along != 0]
    is_met: Flags = (voxels.kind == WALL) | ((voxels.kind > 0) & (voxels.cover[:, sides] > 0).any(axis=1))
    return is_met


@exact
def _receive(volume: Volume, probes: Probes, rays: F64, ends: Ends, shape: I64, sky: float) -> None:
    """Fill the probes with what their rays meet in a room of so many cubes along each axis."""
    most = 0
    for group in range(len(probes.rays)):
        most = max(most, probes.first[group + 1] - probes.first[group])
    total, weight = np.zeros((most, SIDES, 3)), np.zeros(SIDES)
    backs, met = np.zeros(most, dtype=np.int64), np.zeros(most, dtype=np.int64)
    found = np.zeros((most, 3, 4), dtype=np.float32)
    way = np.zeros(shape.sum() + 6 * RIM, dtype=np.int64)
    for group in range(len(probes.rays)):
        first, last = probes.first[group], probes.first[group + 1]
        total[:], weight[:], backs[:] = 0.0, 0.0, 0
        for ray in range(probes.rays[group, 0], probes.rays[group, 1]):
            bits = ends.bits[ends.pattern[ray]]
            if not _follow(rays[ray], probes.inside[first], probes.cube[first:last], bits, shape, way, met):
                for n in range(last - first):
                    place = first + n
                    _follow(rays[ray], probes.inside[place], probes.cube[place : place + 1], bits, shape, way, met[n:])
            _look_up(rays[ray], met[: last - first], ends, found)
            _add(rays[ray], met[: last - first], found, sky, total, weight, backs)
        for n in range(last - first):
            if backs[n] > BACKS * (probes.rays[group, 1] - probes.rays[group, 0]):
                continue
            i, j, m = probes.number[first + n, 0], probes.number[first + n, 1], probes.number[first + n, 2]
            volume.is_valid[i, j, m] = True
            for side in range(SIDES):
                for channel in range(3):
                    volume.light[i, j, m, side, channel] = total[n, side, channel] / max(weight[side], 1e-9)


@exact
def _follow(ray: F64, inside: F64, cubes: I64, bits: U64, shape: I64, way: I64, met: I64) -> bool:
    """Write which bit stands for the cube that ends the ray of each probe; `way` is room for the steps.

    False, if the ray passes an edge of a cube so closely that roundings decide on which side, which they do for each probe in
    its own way; of one probe alone it is written all the same.
    """
    dx, dy, dz = ray[0], ray[1], ray[2]
    row, plane = shape[2] + 2 * RIM, (shape[2] + 2 * RIM) * (shape[1] + 2 * RIM)
    along_x, along_y, along_z = (plane if dx > 0 else -plane), (row if dy > 0 else -row), (1 if dz > 0 else -1)
    step_x, tx = crossings(dx, inside[0])
    step_y, ty = crossings(dy, inside[1])
    step_z, tz = crossings(dz, inside[2])
    known = gone = 0
    for n in range(len(cubes)):
        k = 0
        while True:
            if k == known:
                if len(cubes) > 1 and min(abs(tx - ty), abs(ty - tz), abs(tx - tz)) < _EDGE:
                    return False
                if tx < ty and tx < tz:
                    tx, gone = tx + step_x, gone + along_x
                elif ty < tz:
                    ty, gone = ty + step_y, gone + along_y
                else:
                    tz, gone = tz + step_z, gone + along_z
                way[known] = gone
                known += 1
            at = cubes[n] + way[k]
            if bits[at >> 6] >> np.uint64(at & 63) & np.uint64(1):
                break
            k += 1
        met[n] = at
    return True


@exact
def _look_up(ray: F64, met: I64, ends: Ends, found: F32) -> None:
    """Turn bits into numbers of cubes, and write the (3, 4) that their sides against the ray show.

    Nothing here waits for anything else, so that a processor fetches much at once.
    """
    side_x, side_y, side_z = sides_against(ray[0], ray[1], ray[2])
    for n in range(len(met)):
        met[n] = ends.cube[met[n]]
    for n in range(len(met)):
        cube = max(met[n], 0)
        for k in range(4):
            found[n, 0, k] = ends.sides[side_x, cube, k]
            found[n, 1, k] = ends.sides[side_y, cube, k]
            found[n, 2, k] = ends.sides[side_z, cube, k]


@exact
def _add(ray: F64, met: I64, found: F32, sky: float, total: F64, weight: F64, backs: I64) -> None:
    """Add the light that comes along a ray to what each probe receives on the sides that look towards it."""
    ax, ay, az = abs(ray[0]), abs(ray[1]), abs(ray[2])
    against_x, against_y, against_z = sides_against(ray[0], ray[1], ray[2])
    side_x, side_y, side_z = against_x ^ 1, against_y ^ 1, against_z ^ 1
    weight[side_x] += ax
    weight[side_y] += ay
    weight[side_z] += az
    for n in range(len(met)):
        red = green = blue = 0.0
        x, y, z = found[n, 0], found[n, 1], found[n, 2]
        facing = ax * x[0] + ay * y[0] + az * z[0]
        if met[n] == OUTSIDE:
            red = green = blue = sky
        elif facing > 0.0:
            a, b, c = ax * x[0] / facing, ay * y[0] / facing, az * z[0] / facing
            red = a * x[1] + b * y[1] + c * z[1]
            green = a * x[2] + b * y[2] + c * z[2]
            blue = a * x[3] + b * y[3] + c * z[3]
        else:
            backs[n] += 1
        for side, share in ((side_x, ax), (side_y, ay), (side_z, az)):
            total[n, side, 0] += share * red
            total[n, side, 1] += share * green
            total[n, side, 2] += share * blue
