"""Textures in the form the shader reads: every level of every texture in one array of packed pixels."""

from __future__ import annotations

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, I32, U8
from remqa_data.sim.render.pixels import (
    ACROSS,
    ADDRESS,
    ALONG,
    BLOCK_PX,
    BLUE,
    COARSE,
    GREEN,
    RED,
    STRETCH,
    TEXTURE,
    U,
    V,
)

SIZE_BITS = 8
"""Every texture is 2 ** 8 pixels wide and high, so that repeating is a bit mask."""
_STRIDE = 2 << (2 * SIZE_BITS)
"""The level of 2 ** b pixels starts at 4 ** b inside a texture: cheaper to find than a dense packing."""
_BIAS = -0.35
"""Slightly sharper than the theory asks for: pictures look crisp and still do not shimmer."""
CLAMPED = 1 << 12
"""Added to the number of a texture that does not repeat: its border goes on beyond 0..1."""


def levels(texture: U8) -> I32:
    """All levels of a (256, 256, 3) picture, whose first row is its top, v = 0, as `apply_textures` reads them.

    Texels are packed red | green << 8 | blue << 16.
    """
    texels = np.zeros(_STRIDE, dtype=np.int32)
    level = np.asarray(texture, dtype=np.float64)
    for bits in range(SIZE_BITS, -1, -1):
        rounded = (level + 0.5).astype(np.int32)
        packed = rounded[..., 0] | rounded[..., 1] << 8 | rounded[..., 2] << 16
        texels[1 << (2 * bits) : 2 << (2 * bits)] = packed.ravel()
        if bits > 0:
            # Sums of four bytes, of which no bit is lost.
            level = (level[::2, ::2] + level[::2, 1::2] + level[1::2, ::2] + level[1::2, 1::2]) / 4
    return texels


@exact
def apply_textures(texels: I32, sheet: F32, fetches: I32, count: int) -> None:
    """Multiply the linear colours of `count` pixels by their textures (trilinear look-up).

    Addresses, loads and blends are loops of their own, because then the compiler turns the first and the last into
    vector instructions.

    Parameters
    ----------
    texels : (n,) array
        `levels` of plain white, which is number 0, and of the other textures, joined.
    sheet : (FLOATS,) array
        Read: TEXTURE, the number of the texture, plus `CLAMPED` for one that does not repeat; U and V in repeats, v
        points down; STRETCH, the square of the distance in repeats that the pixel covers. Changed: RED, GREEN, BLUE.
    fetches : (INTS,) array
        Scratch: addresses of four texels of the finer level and four of the coarser one, replaced by the texels; and
        the weights, in 1 / 256, of the right texels, the lower texels and the coarser level.
    count : int
        How many pixels.
    """
    _find_texels(sheet, fetches, count)
    for i in range(min(count, BLOCK_PX)):
        for corner in range(8):
            at = ADDRESS + corner * BLOCK_PX + i
            fetches[at] = texels[np.uint32(fetches[at])]
    _blend_texels(sheet, fetches, count)


@exact
def _find_texels(sheet: F32, fetches: I32, count: int) -> None:
    sheet_bits = sheet.view(np.int32)
    one, byte = np.int32(1), np.int32(255)
    for i in range(min(count, BLOCK_PX)):
        # A float's bits are 2 ** 23 times its base-2 logarithm, nearly; half of that undoes the square.
        log_stretch = np.float32(sheet_bits[STRETCH + i]) * np.float32(0.5 / (1 << 23))
        level = log_stretch + np.float32(SIZE_BITS + _BIAS - 0.5 * 127)
        level = min(max(level, np.float32(0.0)), np.float32(SIZE_BITS - 0.001))
        finer = np.int32(level)
        fetches[COARSE + i] = np.int32((level - np.float32(finer)) * np.float32(256.0))
        texture = np.int32(sheet[TEXTURE + i])
        clamped = texture >= CLAMPED
        base = np.int32(np.int32(texture & np.int32(CLAMPED - 1)) * np.int32(_STRIDE))
        for step in range(2):
            bits = np.int32(np.int32(SIZE_BITS) - finer - np.int32(step))
            mask = np.int32(np.int32(one << bits) - one)
            # 24.8 fixed point.
            fixed = np.float32(np.int32(np.int32(256) << bits))
            low = np.float32(0.0) if clamped else np.float32(-1e9)
            high = fixed - np.float32(256.0) if clamped else np.float32(1e9)
            x = _floor(min(max(sheet[U + i] * fixed - np.float32(128.0), low), high))
            y = _floor(min(max(sheet[V + i] * fixed - np.float32(128.0), low), high))
            fetches[ACROSS + step * BLOCK_PX + i] = x & byte
            fetches[ALONG + step * BLOCK_PX + i] = y & byte
            x, y = np.int32(x >> np.int32(8)), np.int32(y >> np.int32(8))
            start = np.int32(base + np.int32(one << np.int32(bits + bits)))
            x0, x1 = np.int32(x & mask), np.int32(np.int32(x + one) & mask)
            row0 = np.int32(start + np.int32(np.int32(y & mask) << bits))
            row1 = np.int32(start + np.int32(np.int32(np.int32(y + one) & mask) << bits))
            first = ADDRESS + 4 * step * BLOCK_PX + i
            fetches[first] = row0 + x0
            fetches[first + BLOCK_PX] = row0 + x1
            fetches[first + 2 * BLOCK_PX] = row1 + x0
            fetches[first + 3 * BLOCK_PX] = row1 + x1


@exact
def _floor(value: np.float32) -> np.int32:
    whole = np.int32(value)
    return np.int32(whole - np.int32(np.float32(whole) > value))


@exact
def _blend_texels(sheet: F32, fetches: I32, count: int) -> None:
    """Weights are whole numbers that add up to 256, so that two 8-bit channels blend in one multiplication."""
    eight, byte, whole = np.int32(8), np.int32(255), np.int32(256)
    pair = np.int32(0x00FF00FF)
    unit = np.float32(1.0 / 255.0)
    for i in range(min(count, BLOCK_PX)):
        rb = np.int32(0)
        g = np.int32(0)
        far = fetches[COARSE + i]
        for step in range(2):
            fx, fy = fetches[ACROSS + step * BLOCK_PX + i], fetches[ALONG + step * BLOCK_PX + i]
            w11 = np.int32(np.int32(fx * fy) >> eight)
            w01, w10 = np.int32(fx - w11), np.int32(fy - w11)
            w00 = np.int32(np.int32(whole - fx) - w10)
            first = ADDRESS + 4 * step * BLOCK_PX + i
            t00, t01 = fetches[first], fetches[first + BLOCK_PX]
            t10, t11 = fetches[first + 2 * BLOCK_PX], fetches[first + 3 * BLOCK_PX]
            level_rb = np.int32(
                np.int32(np.int32(t00 & pair) * w00)
                + np.int32(np.int32(t01 & pair) * w01)
                + np.int32(np.int32(t10 & pair) * w10)
                + np.int32(np.int32(t11 & pair) * w11)
            )
            level_g = np.int32(
                np.int32(np.int32(np.int32(t00 >> eight) & byte) * w00)
                + np.int32(np.int32(np.int32(t01 >> eight) & byte) * w01)
                + np.int32(np.int32(np.int32(t10 >> eight) & byte) * w10)
                + np.int32(np.int32(np.int32(t11 >> eight) & byte) * w11)
            )
            weight = far if step == 1 else np.int32(whole - far)
            rb = np.int32(rb + np.int32(np.int32(np.int32(level_rb >> eight) & pair) * weight))
            g = np.int32(g + np.int32(np.int32(level_g >> eight) * weight))
        r_value = np.float32(np.int32(np.int32(rb >> eight) & byte)) * unit
        g_value = np.float32(np.int32(np.int32(g >> eight) & byte)) * unit
        b_value = np.float32(np.int32(np.int32(rb >> np.int32(24)) & byte)) * unit
        sheet[RED + i] *= r_value * r_value
        sheet[GREEN + i] *= g_value * g_value
        sheet[BLUE + i] *= b_value * b_value
