"""Smooth edges in the colour image: more samples, but only in the pixels where an edge runs.

A pixel is an edge pixel when a neighbour shows another surface, or another side of it. There, all faces that were drawn
are sampled again at four points, and the pixel becomes the mean of what they show. Samples are not shaded: a sample
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
    edge_functions,
    face_bounds,
    nearest_key,
    part_faces,
    rows_of_side,
    side,
)

_SAMPLE_BITS = 2
_SAMPLES = 1 << _SAMPLE_BITS
_SAMPLE_X = np.array([-1, 3, -3, 1]) / 8
"""Sideways offset of each sample, in pixels from the pixel's centre; downwards they follow each other at 1/4 pixel. No
two are in a column either, so that steep and flat edges get four steps alike."""
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
    is_crease: bool = miss > (key * np.float32(_CREASE) if pinhole else np.float32(_CREASE_M))
    return is_crease


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

    Four sample lines cross a row of pixels, and every pixel has one sample on each: a face is drawn as if the image
    were four times as high, with every line shifted sideways.
    """
    height, width = len(first_edge), first_edge.shape[1] - 1
    half_width, half_height = 0.5 * width, 0.5 * height
    limit = np.float32(nearest_key(pinhole))
    for face in range(start, stop):
        a, b, c = geometry.faces[face, 0], geometry.faces[face, 1], geometry.faces[face, 2]
        skip_back = cull and geometry.face_of_solid[face]
        x_least, x_most, y_least, y_most = face_bounds(image, a, b, c, skip_back, pinhole, half_width, half_height)
        x_least, x_most = x_least - _SLACK, x_most + _SLACK
        first_line = math.ceil((y_least + half_height) * _SAMPLES - 0.5 - _SLACK)
        last_line = min(math.floor((y_most + half_height) * _SAMPLES - 0.5 + _SLACK), height * _SAMPLES - 1)
        if x_least > x_most or first_line > last_line:
            continue
        is_set_up = False
        least = most = kx = ky = kc = 0.0
        low_a = low_a_slope = high_a = high_a_slope = 0.0
        low_b = low_b_slope = high_b = high_b_slope = 0.0
        low_c = low_c_slope = high_c = high_c_slope = 0.0
        left, right = max(int(x_least + half_width), 0), min(int(x_most + half_width), width - 1)
        line = max(first_line, 0) - 1
        while line < last_line:
            line += 1
            row, sample = line >> _SAMPLE_BITS, line & (_SAMPLES - 1)
            if first_edge[row, left] == first_edge[row, right + 1]:
                line |= _SAMPLES - 1
                continue
            # x of the line's sample in column 0, from the image centre.
            origin = 0.5 + _SAMPLE_X[sample] - half_width
            if not is_set_up:
                first, last = _columns(x_least, x_most, origin, width)
                if first > last or first_edge[row, first] == first_edge[row, last + 1]:
                    continue
                # Most faces meet no sample of an edge pixel: they never come here.
                is_set_up = True
                scale, ax, ay, ac, bx, by, bc, cx, cy, cc, kx, ky, kc = edge_functions(image, a, b, c, pinhole)
                if scale == 0.0:
                    break
                low_a, low_a_slope, high_a, high_a_slope = side(ax, ay, ac)
                low_b, low_b_slope, high_b, high_b_slope = side(bx, by, bc)
                low_c, low_c_slope, high_c, high_c_slope = side(cx, cy, cc)
                least_a, most_a = rows_of_side(ax, ay, ac)
                least_b, most_b = rows_of_side(bx, by, bc)
                least_c, most_c = rows_of_side(cx, cy, cc)
                least, most = max(least_a, max(least_b, least_c)), min(most_a, min(most_b, most_c))
            y = (line + 0.5) / _SAMPLES - half_height
            low = max(max(x_least, low_a + low_a_slope * y), max(low_b + low_b_slope * y, low_c + low_c_slope * y))
            high = min(
                min(x_most, high_a + high_a_slope * y), min(high_b + high_b_slope * y, high_c + high_c_slope * y)
            )
            if low > high or y < least or y > most:
                continue
            first, last = _columns(low, high, origin, width)
            if first > last:
                continue
            for edge in range(first_edge[row, first], first_edge[row, last + 1]):
                key = np.float32(kx * (columns[edge] + origin) + (ky * y + kc))
                if key > keys[edge, sample] and key <= limit:
                    keys[edge, sample] = key
                    found[edge, sample] = face


@exact
def _columns(low: float, high: float, origin: float, width: int) -> tuple[int, int]:
    """First and last pixel column whose sample, at `origin` in column 0, lies between two x."""
    return max(math.ceil(low - origin), 0), min(math.floor(high - origin), width - 1)


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
