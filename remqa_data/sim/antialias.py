"""Smooth edges in the colour image: more samples, but only in the pixels where an edge runs.

A pixel is an edge pixel when a neighbour shows another surface, or another side of it. There, all faces that were drawn
are sampled again at eight points, and the pixel becomes the mean of what they show. Samples are not shaded: a sample
takes the colour of the nearest pixel that shows the same face, or at least the same surface.
"""

from __future__ import annotations

import math

import numpy as np

from remqa_data.assets.model import F32, I32
from remqa_data.sim.compiled import exact, relaxed
from remqa_data.sim.mipmap import U8
from remqa_data.sim.raster import (
    Buffers,
    Flags,
    Geometry,
    clip_span,
    edge_functions,
    face_bounds,
    nearest_key,
    part_faces,
)

_SAMPLES = 8
_SAMPLE_X = np.array([1, -3, 5, -5, -7, 3, 7, -1]) / 16
"""Sideways offset of each sample, in pixels from the pixel's centre; downwards they follow each other at 1/8 pixel. No two
are in a column either, so that steep and flat edges get eight steps alike."""
_SLACK = 1e-3
_NEAR_FIRST = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
_CREASE = 0.004
"""Two faces of a surface meet in an edge when one, continued to the next pixel, misses the other by more than this
share of the key; neighbours on a curved surface miss by less."""
_CREASE_M = 0.02
"""The same for a parallel projection, whose key is metres."""


@relaxed
def smooth_edges(geometry: Geometry, buffers: Buffers, pinhole: bool, rgb: U8) -> None:
    """Blend the edge pixels of the (h, w, 3) uint8 picture in place."""
    height, width = buffers.slot.shape
    is_edge = np.zeros((height, width), dtype=np.bool_)
    _find_edges(geometry, buffers, pinhole, is_edge)
    first_edge, columns = _number_edges(is_edge)
    keys = np.zeros((len(columns), _SAMPLES), dtype=np.float32)
    found = np.full((len(columns), _SAMPLES), -1, dtype=np.int32)
    for i in range(len(buffers.drawn)):
        part = buffers.drawn[i, 0]
        if part < 0:
            break
        first, last = part_faces(geometry, part)
        cull = buffers.drawn[i, 1] > 0
        _sample_faces(geometry, first, last, cull, pinhole, buffers.image, first_edge, columns, keys, found)
    _blend(geometry, buffers, first_edge, columns, found, rgb)


@relaxed
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


@relaxed
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
    return miss > (key * np.float32(_CREASE) if pinhole else np.float32(_CREASE_M))


@exact
def _number_edges(is_edge: Flags) -> tuple[I32, I32]:
    """(h, w + 1) how many edge pixels come before each pixel, row by row; and the column of each edge pixel."""
    height, width = is_edge.shape
    first_edge = np.empty((height, width + 1), dtype=np.int32)
    columns = np.empty(height * width, dtype=np.int32)
    count = 0
    for y in range(height):
        for x in range(width):
            first_edge[y, x] = count
            columns[count] = x
            count += is_edge[y, x]
        first_edge[y, width] = count
    return first_edge, columns[:count]


@exact
def _sample_faces(
    geometry: Geometry,
    start: int,
    stop: int,
    cull: bool,
    pinhole: bool,
    image: F32,
    first_edge: I32,
    columns: I32,
    keys: F32,
    found: I32,
) -> None:
    """Find the nearest face at each sample of the edge pixels, among a range of faces and those found before.

    Eight sample lines cross a row of pixels, and every pixel has one sample on each: a face is drawn as if the image
    were eight times as high, with every line shifted sideways.
    """
    height, width = len(first_edge), first_edge.shape[1] - 1
    half_width, half_height = 0.5 * width, 0.5 * height
    limit = np.float32(nearest_key(pinhole))
    for face in range(start, stop):
        a, b, c = geometry.faces[face, 0], geometry.faces[face, 1], geometry.faces[face, 2]
        skip_back = cull and geometry.face_of_solid[face]
        x_least, x_most, y_least, y_most = face_bounds(image, a, b, c, skip_back, pinhole, half_width, half_height)
        first_line = int(math.ceil((y_least + half_height) * _SAMPLES - 0.5 - _SLACK))
        last_line = min(int(math.floor((y_most + half_height) * _SAMPLES - 0.5 + _SLACK)), height * _SAMPLES - 1)
        is_set_up = False
        ax = ay = ac = ia = bx = by = bc = ib = cx = cy = cc = ic = kx = ky = kc = 0.0
        for line in range(max(first_line, 0), last_line + 1):
            row, sample = line // _SAMPLES, line % _SAMPLES
            # x of the line's sample in column 0, from the image centre.
            origin = 0.5 + _SAMPLE_X[sample] - half_width
            first = max(int(math.ceil(x_least - origin - _SLACK)), 0)
            last = min(int(math.floor(x_most - origin + _SLACK)), width - 1)
            if first > last or first_edge[row, first] == first_edge[row, last + 1]:
                continue
            if not is_set_up:
                # Most faces meet no sample of an edge pixel: they never come here.
                is_set_up = True
                scale, ax, ay, ac, bx, by, bc, cx, cy, cc, kx, ky, kc = edge_functions(image, a, b, c, pinhole)
                if scale == 0.0:
                    break
                ia, ib, ic = 1.0 / ax if ax else 0.0, 1.0 / bx if bx else 0.0, 1.0 / cx if cx else 0.0
            y = (line + 0.5) / _SAMPLES - half_height
            low, high = first + origin, last + origin
            low, high = clip_span(low, high, ax, ia, ay * y + ac)
            low, high = clip_span(low, high, bx, ib, by * y + bc)
            low, high = clip_span(low, high, cx, ic, cy * y + cc)
            if low > high:
                continue
            first, last = int(math.ceil(low - origin)), int(math.floor(high - origin))
            if first > last:
                continue
            for edge in range(first_edge[row, first], first_edge[row, last + 1]):
                key = np.float32(kx * (columns[edge] + origin) + (ky * y + kc))
                if key > keys[edge, sample] and key <= limit:
                    keys[edge, sample] = key
                    found[edge, sample] = face


@relaxed
def _blend(geometry: Geometry, buffers: Buffers, first_edge: I32, columns: I32, found: I32, rgb: U8) -> None:
    """Mix the colours of the samples, as linear light."""
    height, width = buffers.slot.shape
    sharp = rgb.copy()
    for y in range(height):
        for edge in range(first_edge[y, 0], first_edge[y, width]):
            x = columns[edge]
            slot = buffers.slot[y, x]
            own = buffers.record_face[slot] if slot >= 0 else -1
            last, row, column = own, y, x
            red, green, blue = 0, 0, 0
            for sample in range(_SAMPLES):
                face = found[edge, sample]
                if face != last:
                    last = face
                    row, column = _nearest_like(geometry, buffers, face, y, x) if face != own else (y, x)
                r, g, b = sharp[row, column, 0], sharp[row, column, 1], sharp[row, column, 2]
                red, green, blue = red + r * r, green + g * g, blue + b * b
            rgb[y, x, 0] = np.uint8(math.sqrt(red / _SAMPLES) + 0.5)
            rgb[y, x, 1] = np.uint8(math.sqrt(green / _SAMPLES) + 0.5)
            rgb[y, x, 2] = np.uint8(math.sqrt(blue / _SAMPLES) + 0.5)


@relaxed
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
