"""Smooth edges in the colour image: more samples, but only in the pixels where an edge runs.

A pixel is an edge pixel when a neighbour shows another surface, or another side of it. There, all faces that were drawn
are sampled again at four points, and the pixel becomes the mean of what they show. Samples are not shaded: a sample takes
the colour of the nearest pixel that shows the same face, or at least the same surface.

Most faces touch no edge pixel, or lie behind what the edge pixels are known to show, and the time goes into finding that
out: first each tile that a face may touch is asked, then the edge pixels of each row, then the samples of each pixel.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, I32, U8, Flags
from remqa_data.sim.render.camera import Scissor, View
from remqa_data.sim.render.outline import face_bounds, side
from remqa_data.sim.render.raster import (
    FAR_M,
    Buffers,
    Geometry,
    edge_functions,
    find_candidates,
    nearest_key,
    part_faces,
)

_NEAR_FIRST = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
_CREASE = 0.004
"""Two faces of a surface meet in an edge when one, continued to the next pixel, misses the other by more than this
share of the key; neighbours on a curved surface miss by less."""
_CREASE_M = 0.02
"""The same for a parallel projection, whose key is metres."""
_SAMPLE_BITS = 2
_SAMPLES = 1 << _SAMPLE_BITS
"""At (-1, -3), (3, -1), (-3, 1) and (1, 3) eighths of a pixel from the pixel's centre: no two in a row or a column, so
that steep and flat edges get four steps alike. The last two mirror the first two, see `_to_samples`."""
_FARTHEST_PX = 0.375
"""How far sideways, or up or down, a sample may lie from the pixel's centre."""
_TILE_BITS = 3
_SLACK = 4e-3
"""Bounding boxes are this much wider, in distances between samples, so that rounding loses no sample."""
_BEHIND = 1e-5
"""Only what is farther than its surroundings by this share of the key counts as hidden by them."""
_NARROW_PX = 4
"""In faces up to this wide every edge pixel of the bounding box is tested; in wider ones, those between the sides."""


class _Samples(NamedTuple):
    """The edge pixels, row by row, and what their samples show. Keys as in `raster`."""

    first: I32
    """(h, w + 1) how many edge pixels come before each pixel."""
    column: I32
    """(n,) of each edge pixel."""
    reach: F32
    """(h / 8, w / 8) of each tile: how far its edge pixels let one see, metres; 0 in a tile without edge pixels."""
    least: F32
    """(n,) least of the pixel's four keys."""
    key: F32
    """(n, 4) of the nearest face found at each sample; before one is, what the pixel and those beside it suggest."""
    face: I32
    """(n, 4) the nearest face found at each sample, -1 for none."""


@exact
def smooth_edges(geometry: Geometry, buffers: Buffers, view: View, rgb: U8) -> None:
    """Blend the edge pixels of the (h, w, 3) uint8 picture in place.

    The pixels along the border of a scissor stay as they were drawn, as those beside it have no colour.
    """
    height, width = buffers.slot.shape
    is_edge = np.zeros((height, width), dtype=np.bool_)
    _find_edges(geometry, buffers, view, is_edge)
    samples = _sample_edges(geometry, buffers, view, is_edge)
    _blend(geometry, buffers, view.scissor, samples, rgb)


@exact
def _find_edges(geometry: Geometry, buffers: Buffers, view: View, is_edge: Flags) -> None:
    pinhole, scissor, top, left = view.pinhole, view.scissor, view.scissor.top, view.scissor.left
    # Of what is within, indices start at 0: the compiler sees that none is negative.
    within = buffers.slot[top : scissor.bottom + 1, left : scissor.right + 1]
    is_edge = is_edge[top : scissor.bottom + 1, left : scissor.right + 1]
    height, width = within.shape
    for j in range(height):
        for i in range(width):
            here, y, x = within[j, i], top + j, left + i
            if i + 1 < width and within[j, i + 1] != here and _differ(geometry, buffers, pinhole, y, x, y, x + 1):
                is_edge[j, i] = is_edge[j, i + 1] = True
            if j + 1 < height and within[j + 1, i] != here and _differ(geometry, buffers, pinhole, y, x, y + 1, x):
                is_edge[j, i] = is_edge[j + 1, i] = True


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
def _sample_edges(geometry: Geometry, buffers: Buffers, view: View, is_edge: Flags) -> _Samples:
    """Find the nearest face at each sample of the flagged pixels, among the faces of all parts that were drawn.

    A face counts as hidden where the planes that a pixel and the four beside it show are all nearer. So what shows only
    through a gap so narrow that no centre of these pixels lies in it is missed.
    """
    pinhole = view.pinhole
    first, column, least, reach = _list_edges(buffers, pinhole, is_edge)
    key = np.empty((len(column), _SAMPLES), dtype=np.float32)
    for edge in range(len(column)):
        key[edge] = least[edge]
    samples = _Samples(first, column, reach, least, key, np.full((len(column), _SAMPLES), -1, dtype=np.int32))
    for i in range(len(buffers.drawn)):
        part = int(np.int64(buffers.drawn[i, 0]))
        if part < 0:
            break
        start, stop = part_faces(geometry, part)
        cull = buffers.drawn[i, 1] > 0
        candidates = find_candidates(geometry, start, stop, cull, buffers, view.scissor, float(_SAMPLES))
        _draw_faces(geometry, buffers.candidates[:candidates], cull, pinhole, buffers.image, samples)
    return samples


@exact
def _list_edges(buffers: Buffers, pinhole: bool, is_edge: Flags) -> tuple[I32, I32, F32, F32]:
    """First, column, least and reach of `_Samples`, for those of the flagged pixels that may show more than one face."""
    slots, records = buffers.slot, buffers.records
    height, width = is_edge.shape
    flagged = np.count_nonzero(is_edge)
    first = np.empty((height, width + 1), dtype=np.int32)
    column = np.empty(flagged, dtype=np.int32)
    least = np.empty(flagged, dtype=np.float32)
    reach = np.zeros(((height >> _TILE_BITS) + 1, (width >> _TILE_BITS) + 1), dtype=np.float32)
    count = 0
    for y in range(height):
        for x in range(width):
            first[y, x] = count
            if not is_edge[y, x]:
                continue
            is_mixed, far = _look_around(slots, records, pinhole, y, x)
            if not is_mixed:
                continue
            column[count], least[count] = x, far
            count += 1
            depth = 1.0 / far if pinhole else FAR_M - far
            tile_y, tile_x = y >> _TILE_BITS, x >> _TILE_BITS
            reach[tile_y, tile_x] = max(reach[tile_y, tile_x], np.float32(depth))
        first[y, width] = count
    return first, column[:count], least[:count], reach


@exact
def _look_around(slots: I32, records: F32, pinhole: bool, y: int, x: int) -> tuple[bool, float]:
    """Whether a pixel may show more than its own face, and the least key that may show there.

    It may not where its own face covers all samples and none of the planes beside it comes in front.
    """
    height, width = slots.shape
    across, down = x + 0.5 - 0.5 * width, y + 0.5 - 0.5 * height
    own = slots[y, x]
    if own < 0:
        return True, 0.0
    own_least, _ = _keys(records, own, across, down)
    least, most = own_least, 0.0
    for direction in range(4):
        row, column = y + (direction == 3) - (direction == 2), x + (direction == 1) - (direction == 0)
        if 0 <= row < height and 0 <= column < width:
            slot = slots[row, column]
            if slot < 0:
                least = 0.0
            elif slot != own:
                low, high = _keys(records, slot, across, down)
                least, most = min(least, low), max(most, high)
    is_mixed = most >= own_least or not _covers(records, own, pinhole, across, down)
    return is_mixed, max(least, 0.0) * (1.0 - _BEHIND)


@exact
def _keys(records: F32, slot: int, across: float, down: float) -> tuple[float, float]:
    """Least and greatest key of a record's plane at the samples of a pixel, or a little beyond."""
    kx, ky = records[slot, 6], records[slot, 7]
    key, change = kx * across + ky * down + records[slot, 8], _FARTHEST_PX * (abs(kx) + abs(ky))
    return key - change, key + change


@exact
def _covers(records: F32, slot: int, pinhole: bool, across: float, down: float) -> bool:
    """Whether the face of a record covers all samples of a pixel."""
    ax, ay, ac = records[slot, 0], records[slot, 1], records[slot, 2]
    bx, by, bc = records[slot, 3], records[slot, 4], records[slot, 5]
    # The three barycentric coordinates add up to 1, and over w to the key of a pinhole camera.
    sum_x, sum_y, sum_c = 0.0, 0.0, 1.0
    if pinhole:
        sum_x, sum_y, sum_c = float(records[slot, 6]), float(records[slot, 7]), float(records[slot, 8])
    return (
        _least_at_samples(ax, ay, ac, across, down) >= 0.0
        and _least_at_samples(bx, by, bc, across, down) >= 0.0
        and _least_at_samples(sum_x - ax - bx, sum_y - ay - by, sum_c - ac - bc, across, down) >= 0.0
    )


@exact
def _least_at_samples(slope: float, fall: float, constant: float, across: float, down: float) -> float:
    first, second = _to_samples(slope, fall)
    return slope * across + fall * down + constant - max(abs(first), abs(second))


@exact
def _draw_faces(geometry: Geometry, candidates: I32, cull: bool, pinhole: bool, image: F32, samples: _Samples) -> None:
    """Draw some faces into the samples."""
    first_edge, columns, reach, least = samples.first, samples.column, samples.reach, samples.least
    keys, found = samples.key, samples.face
    faces, is_solid = geometry.faces, geometry.face_of_solid
    height, width = len(first_edge), first_edge.shape[1] - 1
    half_width, half_height = 0.5 * width, 0.5 * height
    limit = np.float32(nearest_key(pinhole))
    for face in candidates:
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        skip_back = cull and is_solid[face]
        x_least, x_most, y_least, y_most = face_bounds(image, a, b, c, skip_back, pinhole, half_width, half_height)
        left, right = _pixels_between(x_least + half_width, x_most + half_width, width)
        top, bottom = _pixels_between(y_least + half_height, y_most + half_height, height)
        if left > right or top > bottom:
            continue
        if not _is_in_reach(reach, min(image[2, a], min(image[2, b], image[2, c])), left, right, top, bottom):
            continue
        scale, ax, ay, ac, bx, by, bc, cx, cy, cc, kx, ky, kc = edge_functions(image, a, b, c, pinhole)
        if scale == 0.0:
            continue
        a0, a1 = _to_samples(ax, ay)
        b0, b1 = _to_samples(bx, by)
        c0, c1 = _to_samples(cx, cy)
        k0, k1 = _to_samples(kx, ky)
        k_most = max(abs(k0), abs(k1))
        is_wide = right - left >= _NARROW_PX
        low_a = low_a_slope = high_a = high_a_slope = 0.0
        low_b = low_b_slope = high_b = high_b_slope = 0.0
        low_c = low_c_slope = high_c = high_c_slope = 0.0
        if is_wide:
            low_a, low_a_slope, high_a, high_a_slope = side(ax, ay, ac + max(abs(a0), abs(a1)))
            low_b, low_b_slope, high_b, high_b_slope = side(bx, by, bc + max(abs(b0), abs(b1)))
            low_c, low_c_slope, high_c, high_c_slope = side(cx, cy, cc + max(abs(c0), abs(c1)))
        for row in range(top, bottom + 1):
            y = row + 0.5 - half_height
            first, last = left, right
            if is_wide:
                low = max(low_a + low_a_slope * y, max(low_b + low_b_slope * y, low_c + low_c_slope * y))
                high = min(high_a + high_a_slope * y, min(high_b + high_b_slope * y, high_c + high_c_slope * y))
                first = math.ceil(max(low + half_width - 0.5, np.float64(left)))
                last = math.floor(min(high + half_width - 0.5, np.float64(right)))
                if first > last:
                    continue
            ra, rb, rc, rk = ay * y + ac, by * y + bc, cy * y + cc, ky * y + kc
            for edge in range(first_edge[row, first], first_edge[row, last + 1]):
                x = columns[edge] + 0.5 - half_width
                k = kx * x + rk
                if k + k_most <= least[edge]:
                    continue
                # No branches: which samples a face covers is hard to foretell.
                at_a, at_b, at_c = ax * x + ra, bx * x + rb, cx * x + rc
                old0, old1, old2, old3 = keys[edge, 0], keys[edge, 1], keys[edge, 2], keys[edge, 3]
                new0, new1, new2, new3 = np.float32(k + k0), np.float32(k + k1), np.float32(k - k1), np.float32(k - k0)
                is0 = (min(min(at_a + a0, at_b + b0), at_c + c0) >= 0.0) & (new0 > old0) & (new0 <= limit)
                is1 = (min(min(at_a + a1, at_b + b1), at_c + c1) >= 0.0) & (new1 > old1) & (new1 <= limit)
                is2 = (min(min(at_a - a1, at_b - b1), at_c - c1) >= 0.0) & (new2 > old2) & (new2 <= limit)
                is3 = (min(min(at_a - a0, at_b - b0), at_c - c0) >= 0.0) & (new3 > old3) & (new3 <= limit)
                new0, new1 = new0 if is0 else old0, new1 if is1 else old1
                new2, new3 = new2 if is2 else old2, new3 if is3 else old3
                keys[edge, 0], keys[edge, 1], keys[edge, 2], keys[edge, 3] = new0, new1, new2, new3
                least[edge] = min(min(new0, new1), min(new2, new3))
                found0, found1, found2, found3 = found[edge, 0], found[edge, 1], found[edge, 2], found[edge, 3]
                found[edge, 0], found[edge, 1] = face if is0 else found0, face if is1 else found1
                found[edge, 2], found[edge, 3] = face if is2 else found2, face if is3 else found3


@exact
def _pixels_between(least: float, most: float, size: int) -> tuple[int, int]:
    """First and last pixel, of a row or a column, with a sample between two positions; first > last for none."""
    first = math.ceil(least * _SAMPLES - (0.5 + _SLACK))
    last = math.floor(most * _SAMPLES - (0.5 - _SLACK))
    if first > last:
        return 1, 0
    return max(first >> _SAMPLE_BITS, 0), min(last >> _SAMPLE_BITS, size - 1)


@exact
def _is_in_reach(reach: F32, depth: float, left: int, right: int, top: int, bottom: int) -> bool:
    """Whether the edge pixels of any tile in a rectangle of pixels let one see as far as a depth."""
    least = max(depth, 0.0)
    for y in range(top >> _TILE_BITS, (bottom >> _TILE_BITS) + 1):
        for x in range(left >> _TILE_BITS, (right >> _TILE_BITS) + 1):
            if reach[y, x] > least:
                return True
    return False


@exact
def _to_samples(slope: float, fall: float) -> tuple[float, float]:
    """How much slope * x + fall * y grows from a pixel's centre to its first two samples.

    To the last two it grows by minus the second, and by minus the first.
    """
    return -0.125 * slope - 0.375 * fall, 0.375 * slope - 0.125 * fall


@exact
def _blend(geometry: Geometry, buffers: Buffers, scissor: Scissor, samples: _Samples, rgb: U8) -> None:
    """Mix the colours of the samples, as linear light, where those of all pixels around are known."""
    slots, record_face = buffers.slot, buffers.record_face
    first, columns, found = samples.first, samples.column, samples.face
    height, width = slots.shape
    sharp = rgb.copy()
    top, bottom = scissor.top + (scissor.top > 0), scissor.bottom - (scissor.bottom < height - 1)
    left, right = scissor.left + (scissor.left > 0), scissor.right - (scissor.right < width - 1)
    for y in range(height):
        if y < top or y > bottom:
            continue
        for edge in range(first[y, 0], first[y, width]):
            x = columns[edge]
            if x < left or x > right:
                continue
            slot = slots[y, x]
            own = record_face[slot] if slot >= 0 else -1
            if found[edge, 0] == own and found[edge, 1] == own and found[edge, 2] == own and found[edge, 3] == own:
                continue
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
