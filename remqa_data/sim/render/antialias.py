"""Smooth edges in the colour image: more samples, but only in the pixels where an edge runs.

A pixel is an edge pixel when a neighbour shows another surface, or another side of it. There, all faces that were drawn
are sampled again at four points (`supersample`), and the pixel becomes the mean of what they show. Samples are not
shaded: a sample takes the colour of the nearest pixel that shows the same face, or at least the same surface.
"""

from __future__ import annotations

import math

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import U8, Flags
from remqa_data.sim.render.raster import Buffers, Geometry
from remqa_data.sim.render.supersample import SAMPLES, Samples, sample_edges

_NEAR_FIRST = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
_CREASE = 0.004
"""Two faces of a surface meet in an edge when one, continued to the next pixel, misses the other by more than this
share of the key; neighbours on a curved surface miss by less."""
_CREASE_M = 0.02
"""The same for a parallel projection, whose key is metres."""


@exact
def smooth_edges(geometry: Geometry, buffers: Buffers, pinhole: bool, rgb: U8) -> None:
    """Blend the edge pixels of the (h, w, 3) uint8 picture in place."""
    height, width = buffers.slot.shape
    is_edge = np.zeros((height, width), dtype=np.bool_)
    _find_edges(geometry, buffers, pinhole, is_edge)
    samples = sample_edges(geometry, buffers, pinhole, is_edge)
    _blend(geometry, buffers, samples, rgb)


@exact
def _find_edges(geometry: Geometry, buffers: Buffers, pinhole: bool, is_edge: Flags) -> None:
    height, width = is_edge.shape
    slot = buffers.slot
    for y in range(height):
        for x in range(width):
            here = slot[y, x]
            if x + 1 < width and slot[y, x + 1] != here and _differ(geometry, buffers, pinhole, y, x, y, x + 1):
                is_edge[y, x] = is_edge[y, x + 1] = True
            if y + 1 < height and slot[y + 1, x] != here and _differ(geometry, buffers, pinhole, y, x, y + 1, x):
                is_edge[y, x] = is_edge[y + 1, x] = True


@exact
def _differ(geometry: Geometry, buffers: Buffers, pinhole: bool, ya: int, xa: int, yb: int, xb: int) -> bool:
    """Whether an edge runs between two pixels of different faces."""
    a, b = buffers.slot[ya, xa], buffers.slot[yb, xb]
    if a < 0 or b < 0:
        return True
    if geometry.face_surface[buffers.record_face[a]] != geometry.face_surface[buffers.record_face[b]]:
        return True
    height, width = buffers.slot.shape
    record = buffers.records[a]
    x, y = np.float32(xb + 0.5 - 0.5 * width), np.float32(yb + 0.5 - 0.5 * height)
    key = buffers.key[yb, xb]
    miss = abs(record[6] * x + record[7] * y + record[8] - key)
    is_crease: bool = miss > (key * np.float32(_CREASE) if pinhole else np.float32(_CREASE_M))
    return is_crease


@exact
def _blend(geometry: Geometry, buffers: Buffers, samples: Samples, rgb: U8) -> None:
    """Mix the colours of the samples, as linear light."""
    slots, record_face = buffers.slot, buffers.record_face
    first, columns, found = samples.first, samples.column, samples.face
    height, width = slots.shape
    sharp = rgb.copy()
    for y in range(height):
        for edge in range(first[y, 0], first[y, width]):
            x = columns[edge]
            slot = slots[y, x]
            own = record_face[slot] if slot >= 0 else -1
            if found[edge, 0] == own and found[edge, 1] == own and found[edge, 2] == own and found[edge, 3] == own:
                continue
            last, row, column = own, y, x
            red, green, blue = 0, 0, 0
            for sample in range(SAMPLES):
                face = found[edge, sample]
                if face != last:
                    last = face
                    row, column = _nearest_like(geometry, buffers, face, y, x) if face != own else (y, x)
                r, g, b = sharp[row, column, 0], sharp[row, column, 1], sharp[row, column, 2]
                red, green, blue = red + r * r, green + g * g, blue + b * b
            rgb[y, x, 0] = np.uint8(math.sqrt(red / SAMPLES) + 0.5)
            rgb[y, x, 1] = np.uint8(math.sqrt(green / SAMPLES) + 0.5)
            rgb[y, x, 2] = np.uint8(math.sqrt(blue / SAMPLES) + 0.5)


@exact
def _nearest_like(geometry: Geometry, buffers: Buffers, face: int, y: int, x: int) -> tuple[int, int]:
    """Row and column of the pixel next to (y, x) that shows a face, else its surface; else of the pixel itself."""
    height, width = buffers.slot.shape
    surface = geometry.face_surface[face] if face >= 0 else -1
    like_y, like_x, is_found = y, x, False
    for dy, dx in _NEAR_FIRST:
        row, column = y + dy, x + dx
        if 0 <= row < height and 0 <= column < width:
            slot = buffers.slot[row, column]
            other = buffers.record_face[slot] if slot >= 0 else -1
            if other == face:
                return row, column
            if not is_found and other >= 0 and geometry.face_surface[other] == surface:
                like_y, like_x, is_found = row, column, True
    return like_y, like_x
