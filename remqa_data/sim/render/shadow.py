"""Shadows: the depth that each lamp sees in six directions, and how much of a lamp a point sees."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I32
from remqa_data.sim.render.camera import Scissor, View
from remqa_data.sim.render.pixels import (
    ADDRESS,
    ADDRESS_OF_TILE,
    BLOCK_PX,
    LIMIT,
    LIT,
    NORMAL_X,
    NORMAL_Y,
    NORMAL_Z,
    SHIFT_X,
    SHIFT_Y,
    X,
    Y,
    Z,
)
from remqa_data.sim.render.raster import box_on_screen

# Right, down and forward of +x, -x, +y, -y, +z, -z: always right-handed, so that back faces can be told.
_EAST, _NORTH, _UP = np.eye(3)
_DIRECTIONS = np.array(
    [
        (_NORTH, _UP, _EAST),
        (_UP, _NORTH, -_EAST),
        (_UP, _EAST, _NORTH),
        (_EAST, _UP, -_NORTH),
        (_EAST, _NORTH, _UP),
        (_NORTH, _EAST, -_UP),
    ]
)
_OFFSET_TEXELS = 1.6
"""A point is moved this far along its normal before the look-up, so that a surface does not shade itself."""
_KEY_BIAS = 1.003
_TILE = 4
"""Shifts by 2 below divide by this."""


class Shadows(NamedTuple):
    """Shadow maps of one lamp."""

    maps: F32
    """(6, n, n) 1 / depth as seen from the lamp; empty for no shadows."""
    tiles: F32
    """(6, n / 4, n / 4, 2) least and greatest of the maps in a tile of 4 x 4 and the tiles right, below and between:
    where the maps agree, one comparison replaces sixteen."""
    lamp: F64
    """(3,) metres."""


def empty_shadows(lamp: npt.ArrayLike, size: int) -> Shadows:
    """Maps of `size` x `size` pixels, a multiple of 4, in which nothing is."""
    if size % _TILE:
        msg = f"shadow_size must be a multiple of {_TILE}, not {size}"
        raise ValueError(msg)
    return Shadows(
        np.zeros((6, size, size), dtype=np.float32),
        np.zeros((6, size // _TILE, size // _TILE, 2), dtype=np.float32),
        np.array(lamp, dtype=np.float64),
    )


def lamp_views(lamp: F64, size: int) -> list[View]:
    """Six pinhole views of 90 degrees from a lamp, in the order that `find_shadows` looks them up."""
    views = []
    for directions in _DIRECTIONS:
        axes = directions.copy()
        axes[:2] *= 0.5 * size
        views.append(View.of(lamp, axes, pinhole=True, width=size, height=size))
    return views


@exact
def mark_stale(lamp: F64, axes: F64, size: int, corners: F64, stale: I32) -> None:
    """Widen (6, 4) scissors, one of each map, by what a box covers; `corners` are its (8, 3) world points.

    The maps have (6, 3, 3) axes, see `View`, and so many pixels along each side.
    """
    whole, extent = Scissor(0, size - 1, 0, size - 1), np.empty(7)
    for face in range(6):
        box_on_screen(corners, View(lamp, axes[face], axes[face], True, size, size, whole), extent)
        if extent[0] <= extent[1] and extent[2] <= extent[3]:
            stale[face, 0] = min(stale[face, 0], max(int(extent[0]) - 1, 0))
            stale[face, 1] = max(stale[face, 1], min(int(extent[1]) + 1, size - 1))
            stale[face, 2] = min(stale[face, 2], max(int(extent[2]) - 1, 0))
            stale[face, 3] = max(stale[face, 3], min(int(extent[3]) + 1, size - 1))


@exact
def summarise(shadows: Shadows, face: int, drawn: Scissor) -> None:
    """Bring the tiles of one face up to date with the part of its map that was drawn."""
    pixels, tiles = shadows.maps[face], shadows.tiles[face]
    last = len(tiles) - 1
    left, right = max(drawn.left // _TILE - 1, 0), min(drawn.right // _TILE, last)
    top, bottom = max(drawn.top // _TILE - 1, 0), min(drawn.bottom // _TILE, last)
    # Each tile by itself, one more on the right and below, which the last ones look at.
    rows, columns = min(bottom + 1, last) + 1 - top, min(right + 1, last) + 1 - left
    own = np.empty((rows, columns, 2), dtype=np.float32)
    for j in range(rows):
        for i in range(columns):
            y0, x0 = _TILE * (top + j), _TILE * (left + i)
            low, high = pixels[y0, x0], pixels[y0, x0]
            for y in range(y0, y0 + _TILE):
                for x in range(x0, x0 + _TILE):
                    low, high = min(low, pixels[y, x]), max(high, pixels[y, x])
            own[j, i, 0], own[j, i, 1] = low, high
    for j in range(bottom + 1 - top):
        for i in range(right + 1 - left):
            low, high = own[j, i, 0], own[j, i, 1]
            for y in range(j, min(j + 2, rows)):
                for x in range(i, min(i + 2, columns)):
                    low, high = min(low, own[y, x, 0]), max(high, own[y, x, 1])
            tiles[top + j, left + i, 0], tiles[top + j, left + i, 1] = low, high


@exact
def find_shadows(shadows: Shadows, sheet: F32, fetches: I32, count: int) -> None:
    """Write LIT, how much of the lamp each pixel sees: 0 to 1, smooth over three texels of the map."""
    size = shadows.maps.shape[1]
    if size == 0:
        for i in range(min(count, BLOCK_PX)):
            sheet[LIT + i] = 1.0
        return
    _find_windows(shadows.lamp, size, sheet, fetches, count)
    maps, tiles = shadows.maps.ravel(), shadows.tiles.ravel()
    for i in range(min(count, BLOCK_PX)):
        limit = sheet[LIMIT + i]
        tile = np.uint32(fetches[ADDRESS_OF_TILE + i])
        if limit < 0.0 or tiles[tile] > limit:
            sheet[LIT + i] = 0.0
        elif tiles[tile + 1] <= limit:
            sheet[LIT + i] = 1.0
        else:
            address = fetches[ADDRESS + i]
            sheet[LIT + i] = _window_mean(maps, address, size, limit, sheet[SHIFT_X + i], sheet[SHIFT_Y + i])


@exact
def _find_windows(lamp: F64, size: int, sheet: F32, fetches: I32, count: int) -> None:
    """Write where the 4 x 4 texels around each pixel start, the shift in them, and the key that hides the pixel.

    The key is negative for a pixel that faces away from the lamp.
    """
    one = np.float32(1.0)
    at_x, at_y, at_z = np.float32(lamp[0]), np.float32(lamp[1]), np.float32(lamp[2])
    half = np.float32(0.5 * size)
    last = np.float32(size - 4)
    rows = np.int32(size)
    texels = np.float32(_OFFSET_TEXELS * 2.0 / size)
    for i in range(min(count, BLOCK_PX)):
        nx, ny, nz = sheet[NORMAL_X + i], sheet[NORMAL_Y + i], sheet[NORMAL_Z + i]
        x, y, z = sheet[X + i] - at_x, sheet[Y + i] - at_y, sheet[Z + i] - at_z
        facing = nx * x + ny * y + nz * z < np.float32(0.0)
        offset = max(abs(x), max(abs(y), abs(z))) * texels
        x, y, z = x + nx * offset, y + ny * offset, z + nz * offset
        ax, ay, az = abs(x), abs(y), abs(z)
        along_x = (ax > ay) & (ax > az)
        along_y = ay > az
        along = x if along_x else (y if along_y else z)
        # Right and down of the six views in order: (y, z) (z, y), (z, x) (x, z), (x, y) (y, x).
        second = y if along_x else (z if along_y else x)
        third = z if along_x else (x if along_y else y)
        forth = along > np.float32(0.0)
        right, down = (second if forth else third), (third if forth else second)
        axis = np.float32(0.0) if along_x else (np.float32(2.0) if along_y else np.float32(4.0))
        face = axis if forth else axis + one
        key = one / max(abs(along), np.float32(1e-6))
        column = min(max(right * key * half + half - np.float32(1.5), np.float32(0.0)), last)
        line = min(max(down * key * half + half - np.float32(1.5), np.float32(0.0)), last)
        x0, y0 = np.int32(column), np.int32(line)
        sheet[SHIFT_X + i] = column - np.float32(x0)
        sheet[SHIFT_Y + i] = line - np.float32(y0)
        sheet[LIMIT + i] = key * np.float32(_KEY_BIAS) if facing else -one
        line_start = np.int32(np.int32(np.int32(face) * rows) + y0)
        fetches[ADDRESS + i] = np.int32(line_start * rows) + x0
        tile_line = np.int32(line_start >> np.int32(2))
        fetches[ADDRESS_OF_TILE + i] = np.int32(
            np.int32(np.int32(tile_line * np.int32(rows >> np.int32(2))) + np.int32(x0 >> np.int32(2))) << np.int32(1)
        )


@exact
def _window_mean(maps: F32, address: int, size: int, limit: float, shift_x: float, shift_y: float) -> float:
    """Share of a 3 x 3 texel window, anywhere within 4 x 4 texels, in which nothing is nearer than a key."""
    one, zero = np.float32(1.0), np.float32(0.0)
    total = zero
    for j in range(4):
        start = np.uint32(address + j * size)
        lit = one - shift_x if maps[start] <= limit else zero
        lit += one if maps[start + 1] <= limit else zero
        lit += one if maps[start + 2] <= limit else zero
        lit += shift_x if maps[start + 3] <= limit else zero
        total += lit * (one - shift_y if j == 0 else (shift_y if j == 3 else one))
    return float(total) / 9.0
