"""Indirect light in samples spread over faces, so that a pixel's light costs three look-ups, however large its face is.

Samples lie on a triangular lattice in each face, as in Yuksel, Keyser and House, Mesh Colors, 2010: no map of a surface to a
picture is needed, and small faces have just one sample in each corner.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, I32, Flags
from remqa_data.sim.light.volume import Volume, light_at

SPACING_M = 0.2
MOST_STEPS = 64


class Patches(NamedTuple):
    """Samples of all faces."""

    start: I32
    """(m + 1,) first sample of each face."""
    steps: I32
    """(m,) samples along each side of it, without the first."""
    light: F32
    """(k, 3) linear."""


def patches(vertices: F32, faces: I32) -> Patches:
    """Room for the samples of faces.

    Parameters
    ----------
    vertices : (3, n) array
    faces : (m, 3) array
    """
    longest = np.zeros(len(faces), dtype=np.float32)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        x, y, z = vertices[:, faces[:, a]] - vertices[:, faces[:, b]]
        np.maximum(longest, x * x + y * y + z * z, out=longest)
    steps = np.clip(np.ceil(np.sqrt(longest) / SPACING_M), 1, MOST_STEPS).astype(np.int32)
    counts = (steps + 1) * (steps + 2) // 2
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return Patches(start, steps, np.zeros((int(start[-1]), 3), dtype=np.float32))


@exact
def sample_of(steps: np.int32, i: np.int32, j: np.int32) -> np.int32:
    """Number of a face's sample that is i steps from its third corner to the first, and j to the second.

    The row i + 1 has one sample less than the row i. All in 32 bits, so that loops that ask for it can be vectorised.
    """
    one = np.int32(1)
    before = np.int32(np.int32(i * np.int32(i - one)) >> one)
    return np.int32(np.int32(np.int32(i * np.int32(steps + one)) - before) + j)


@exact
def light_faces(
    made: Patches,
    volume: Volume,
    vertices: F32,
    normals: F32,
    faces: I32,
    is_solid: Flags,
    first: int,
    stop: int,
) -> None:
    """Look up the light of all samples of a range of faces, where they are now; both sides of what is no solid count.

    What a vertex receives is looked up once for all faces that meet there, of solids and of others.
    """
    light, other = np.zeros(3, dtype=np.float32), np.zeros(3, dtype=np.float32)
    low = high = faces[first, 0] if first < stop else 0
    for face in range(first, stop):
        low = min(low, faces[face, 0], faces[face, 1], faces[face, 2])
        high = max(high, faces[face, 0], faces[face, 1], faces[face, 2])
    at_vertex = np.full((high + 1 - low, 2), -1, dtype=np.int32)
    for face in range(first, stop):
        solid = 1 if is_solid[face] else 0
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        n = made.steps[face]
        place = made.start[face]
        for i in range(n + 1):
            for j in range(n - i + 1):
                vertex = c if i + j == 0 else (a if i == n else (b if j == n else low - 1))
                known = at_vertex[vertex - low, solid] if vertex >= low else -1
                if known >= 0:
                    for channel in range(3):
                        made.light[place, channel] = made.light[known, channel]
                    place += 1
                    continue
                if vertex >= low:
                    at_vertex[vertex - low, solid] = place
                u, v = i / n, j / n
                w = 1.0 - u - v
                x = u * vertices[0, a] + v * vertices[0, b] + w * vertices[0, c]
                y = u * vertices[1, a] + v * vertices[1, b] + w * vertices[1, c]
                z = u * vertices[2, a] + v * vertices[2, b] + w * vertices[2, c]
                nx = u * normals[a, 0] + v * normals[b, 0] + w * normals[c, 0]
                ny = u * normals[a, 1] + v * normals[b, 1] + w * normals[c, 1]
                nz = u * normals[a, 2] + v * normals[b, 2] + w * normals[c, 2]
                scale = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz + 1e-20)
                nx, ny, nz = nx * scale, ny * scale, nz * scale
                found = light_at(volume, x, y, z, nx, ny, nz, light)
                if not is_solid[face] and light_at(volume, x, y, z, -nx, -ny, -nz, other):
                    for channel in range(3):
                        light[channel] = (light[channel] + other[channel]) / 2 if found else other[channel]
                    found = True
                if not found:
                    light[:] = volume.least
                for channel in range(3):
                    made.light[place, channel] = max(light[channel], volume.least)
                place += 1
