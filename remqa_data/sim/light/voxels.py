"""The surfaces of a room in small cubes, which rays cross quickly: how much light each side of a cube sends out.

A cube keeps a colour for each of the six directions in which its surfaces look, so that the underside of a shelf is not
lit by its top. Cubes that hold nothing but the closed front of something that opens let light out: what lies behind a
door gets the light that it would get with the door open.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I32, U8, U64, Flags

SPACING_M = 0.02
"""Surfaces are looked at in points about so far apart."""
SIDES = 6
"""+x, -x, +y, -y, +z, -z."""
GATE, WALL = 1, 2
"""A cube that lets light pass from behind, and one that does not."""
RIM = 2
"""So many cubes lie around a room on every side, and rays end there: those of lamps may begin in the first of them."""
OUTSIDE = -2
"""Number of the cubes of the rim."""
_NEVER = 1e30
_STARTS = 1.5
"""A ray leaves the surface that it starts from for so many cubes before anything stops it."""


class Faces(NamedTuple):
    """The triangles that light falls on, in the world."""

    corners: F32
    """(n, 3, 3) metres."""
    normals: F32
    """(n, 3) unit vectors."""
    albedo: F32
    """(n, 3) linear, textures included."""
    glow: F32
    """(n,) light that they send out themselves, as a share of their colour."""
    is_open: Flags
    """(n,) whether both sides of a face are seen."""
    front: F32
    """(n, 3) where the front of a thing that opens looks; 0 for what does not open."""


class Points(NamedTuple):
    """The points in which faces are looked at."""

    position: F32
    """(k, 3)."""
    face: I32
    """(k,)."""
    area: F32
    """(k,) square metres that each stands for."""


class Voxels(NamedTuple):
    """A room in cubes."""

    origin: F64
    """(3,) low corner, metres."""
    size_m: float
    """Edge of a cube."""
    number: I32
    """(nx, ny, nz) of each cube that holds surfaces, -1 for the others."""
    kind: U8
    """(cubes,) GATE or WALL."""
    cover: F32
    """(cubes, 6) square metres that look each way."""
    sent: F32
    """(cubes, 6, 3) mean light that these send out, linear."""
    stops: U64
    """A bit for each cube, those of the rim too, z first: whether a ray may end there. They fit into a processor's cache."""


def surface_points(faces: Faces) -> Points:
    """Points spread evenly over faces, at least one on each."""
    a, b, c = (faces.corners[:, corner].astype(np.float64) for corner in range(3))
    longest = np.sqrt(np.max([np.square(q - p).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0))
    areas = np.sqrt(np.square(np.cross(b - a, c - a)).sum(axis=1)) / 2
    # Long and thin faces have points along their length, too.
    counts = np.ceil(np.maximum(areas / SPACING_M**2, longest / SPACING_M)).astype(np.int32)
    counts = np.clip(counts, 1, None).astype(np.int32)
    return Points(*_spread(faces.corners, counts, areas.astype(np.float32)))


@exact
def _spread(corners: F32, counts: I32, areas: F32) -> tuple[F32, I32, F32]:
    """So many points in each face, at multiples of two irrational steps (Roberts' R2 sequence), folded into the triangle."""
    total = counts.sum()
    position = np.empty((total, 3), dtype=np.float32)
    face = np.empty(total, dtype=np.int32)
    area = np.empty(total, dtype=np.float32)
    k = 0
    for f in range(len(counts)):
        for i in range(counts[f]):
            u, v = (0.5 + i * 0.7548776662466927) % 1.0, (0.5 + i * 0.5698402909980532) % 1.0
            if u + v > 1.0:
                u, v = 1.0 - u, 1.0 - v
            for axis in range(3):
                a, b, c = corners[f, 0, axis], corners[f, 1, axis], corners[f, 2, axis]
                position[k, axis] = a + u * (b - a) + v * (c - a)
            face[k], area[k] = f, areas[f] / np.float32(counts[f])
            k += 1
    return position, face, area


def voxelise(faces: Faces, points: Points, low: npt.ArrayLike, high: npt.ArrayLike, size_m: float) -> Voxels:
    """The cubes between two corners of the room, as yet dark."""
    origin = np.asarray(low, dtype=np.float64)
    shape = np.ceil((np.asarray(high) - origin) / size_m).astype(np.int64)
    number = np.full(shape, -1, dtype=np.int32)
    count = _occupy(points, origin, size_m, number)
    voxels = Voxels(
        origin,
        size_m,
        number,
        np.zeros(count, dtype=np.uint8),
        np.zeros((count, SIDES), dtype=np.float32),
        np.zeros((count, SIDES, 3), dtype=np.float32),
        np.zeros(0, dtype=np.uint64),
    )
    _cover(faces, points, voxels)
    return voxels._replace(stops=marked(with_rim(number).ravel(), voxels.kind > 0))


@exact
def _occupy(points: Points, origin: F64, size_m: float, number: I32) -> int:
    """Number the cubes in which points lie, so that neighbours are near each other in memory; returns how many."""
    for k in range(len(points.face)):
        i, j, m = cube_of(points.position[k], origin, size_m, number)
        if i >= 0:
            number[i, j, m] = 0
    count = 0
    nx, ny, nz = number.shape
    for i in range(nx):
        for j in range(ny):
            for m in range(nz):
                if number[i, j, m] == 0:
                    number[i, j, m] = count
                    count += 1
    return count


@exact
def cube_of(position: F32, origin: F64, size_m: float, number: I32) -> tuple[int, int, int]:
    """Place of the cube that holds a point; -1 outside of the room."""
    i = math.floor((position[0] - origin[0]) / size_m)
    j = math.floor((position[1] - origin[1]) / size_m)
    m = math.floor((position[2] - origin[2]) / size_m)
    nx, ny, nz = number.shape
    if i < 0 or j < 0 or m < 0 or i >= nx or j >= ny or m >= nz:
        return -1, -1, -1
    return i, j, m


@exact
def _cover(faces: Faces, points: Points, voxels: Voxels) -> None:
    """Sum up which way the surfaces of each cube look, and find the cubes that light passes from behind."""
    for k in range(len(points.face)):
        i, j, m = cube_of(points.position[k], voxels.origin, voxels.size_m, voxels.number)
        if i < 0:
            continue
        cube, f = voxels.number[i, j, m], points.face[k]
        if looks_back(faces, f):
            continue
        opens = faces.front[f, 0] != 0 or faces.front[f, 1] != 0 or faces.front[f, 2] != 0
        voxels.kind[cube] = max(voxels.kind[cube], GATE if opens else WALL)
        for axis in range(3):
            n = faces.normals[f, axis]
            if n > 0 or faces.is_open[f]:
                voxels.cover[cube, 2 * axis] += abs(n) * points.area[k]
            if n < 0 or faces.is_open[f]:
                voxels.cover[cube, 2 * axis + 1] += abs(n) * points.area[k]


def with_rim(number: I32) -> I32:
    """(nx + 4, ny + 4, nz + 4) numbers of a room's cubes, and of those of its rim, which are `OUTSIDE`."""
    whole = np.full(np.array(number.shape) + 2 * RIM, OUTSIDE, dtype=np.int32)
    whole[RIM:-RIM, RIM:-RIM, RIM:-RIM] = number
    return whole


@exact
def marked(cube: I32, is_end: Flags) -> U64:
    """A bit for each of the cubes of `with_rim`, one after the other: set for those that end rays, and those outside."""
    bits = np.zeros(len(cube) // 64 + 1, dtype=np.uint64)
    for at in range(len(cube)):
        if cube[at] == OUTSIDE or (cube[at] >= 0 and is_end[cube[at]]):
            bits[at >> 6] |= np.uint64(1) << np.uint64(at & 63)
    return bits


@exact
def looks_back(faces: Faces, f: int) -> bool:
    """Whether a face belongs to what opens and does not look to its front: it moves away from where it is."""
    # Three numbers are read one by one: numba takes ten times as long to unpack a row.
    x, y, z = faces.front[f, 0], faces.front[f, 1], faces.front[f, 2]
    if x == 0 and y == 0 and z == 0:
        return False
    return bool(faces.normals[f, 0] * x + faces.normals[f, 1] * y + faces.normals[f, 2] * z < np.float32(0.5))


@exact
def cast(
    voxels: Voxels, px: float, py: float, pz: float, dx: float, dy: float, dz: float, longest: float, skip: float
) -> tuple[int, float]:
    """The first cube that a ray meets, and whether it is met from behind.

    Parameters
    ----------
    px, py, pz, dx, dy, dz : float
        Where it starts, in cubes from the origin, and its direction, a unit vector.
    longest, skip : float
        It is followed so far, and meets nothing before that, in cubes.

    Returns
    -------
    Number of the cube, -1 if there is none, -2 if the ray leaves the room; and the surface that looks against the ray,
    square metres, 0 from behind.
    """
    number, stops = voxels.number, voxels.stops
    nx, ny, nz = number.shape
    i, j, m = math.floor(px), math.floor(py), math.floor(pz)
    si, sj, sl = (1 if dx > 0 else -1), (1 if dy > 0 else -1), (1 if dz > 0 else -1)
    step_x, tx = crossings(dx, px - i)
    step_y, ty = crossings(dy, py - j)
    step_z, tz = crossings(dz, pz - m)
    side_x, side_y, side_z = sides_against(dx, dy, dz)
    # From farther out than beside the room, the first step leads into no cube of it.
    if i < -1 or j < -1 or m < -1 or i > nx or j > ny or m > nz:
        return (-1 if min(tx, ty, tz) > longest else -2), 0.0
    row, plane = nz + 2 * RIM, (nz + 2 * RIM) * (ny + 2 * RIM)
    along_x, along_y = si * plane, sj * row
    at = (i + RIM) * plane + (j + RIM) * row + m + RIM
    while True:
        if tx < ty and tx < tz:
            t, tx, i, at = tx, tx + step_x, i + si, at + along_x
        elif ty < tz:
            t, ty, j, at = ty, ty + step_y, j + sj, at + along_y
        else:
            t, tz, m, at = tz, tz + step_z, m + sl, at + sl
        if not stops[at >> 6] >> np.uint64(at & 63) & np.uint64(1):
            continue
        if t > longest:
            return -1, 0.0
        if i < 0 or j < 0 or m < 0 or i >= nx or j >= ny or m >= nz:
            return -2, 0.0
        cube = number[i, j, m]
        if t >= skip:
            facing = (
                abs(dx) * voxels.cover[cube, side_x]
                + abs(dy) * voxels.cover[cube, side_y]
                + abs(dz) * voxels.cover[cube, side_z]
            )
            if facing > 0.0 or voxels.kind[cube] == WALL:
                return cube, facing


@exact
def crossings(along: float, inside: float) -> tuple[float, float]:
    """How far a ray goes from one side of a cube to the next along an axis, and at first from a place inside, in cubes."""
    if along == 0:
        return _NEVER, _NEVER
    step = abs(1.0 / along)
    return step, ((1.0 - inside) if along > 0 else inside) * step


@exact
def sides_against(dx: float, dy: float, dz: float) -> tuple[int, int, int]:
    """The sides of a cube that look against a direction."""
    return 1 if dx > 0 else 0, 3 if dy > 0 else 2, 5 if dz > 0 else 4


@exact
def lit_by(voxels: Voxels, faces: Faces, points: Points, lamp: F64) -> F32:
    """(k,) cosine over nothing: 1 where a lamp shines on a point, 0 in its shadow or behind it."""
    lit = np.zeros(len(points.face), dtype=np.float32)
    for k in range(len(points.face)):
        normal = faces.normals[points.face[k]]
        x, y, z = lamp[0] - points.position[k, 0], lamp[1] - points.position[k, 1], lamp[2] - points.position[k, 2]
        distance = math.sqrt(x * x + y * y + z * z)
        x, y, z = x / distance, y / distance, z / distance
        cosine = normal[0] * x + normal[1] * y + normal[2] * z
        if faces.is_open[points.face[k]]:
            cosine = abs(cosine)
        if cosine <= 0.0:
            continue
        px = (points.position[k, 0] - voxels.origin[0]) / voxels.size_m
        py = (points.position[k, 1] - voxels.origin[1]) / voxels.size_m
        pz = (points.position[k, 2] - voxels.origin[2]) / voxels.size_m
        # Near a surface that it grazes, a ray would meet the cubes of that surface itself.
        skip = min(_STARTS / max(cosine, 0.2), 4.0)
        cube, _ = cast(voxels, px, py, pz, x, y, z, distance / voxels.size_m - 2.0, skip)
        lit[k] = 1.0 if cube < 0 else 0.0
    return lit
