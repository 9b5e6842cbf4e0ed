"""Seamless textures of materials, near white: a material's colour multiplies them. Grain and boards run along u."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from remqa_data.assets.looks.noise import SIZE_PX, X, Y, cells, fractal, grey, shift, smoothstep
from remqa_data.geometry.types import F64, U8

Rng = np.random.Generator


def wood(rng: Rng) -> U8:
    """Straight grain along u with a few darker streaks."""
    return grey(_grain(rng), 0.88)


def planks(rng: Rng) -> U8:
    """Six floor boards along u, each of its own shade, with staggered ends."""
    rows = 6
    board = np.floor(Y * rows).astype(np.int64)
    ends = rng.random(rows)
    along = (X - ends[board]) % 1.0
    piece = board * 2 + (along > 0.5)
    tone = rng.uniform(0.86, 1.06, rows * 2)[piece]
    grain = shift(_grain(rng), rng.random(rows * 2)[piece], rng.random(rows * 2)[piece])
    gap_v = np.minimum(Y * rows % 1.0, 1 - Y * rows % 1.0) * SIZE_PX / rows
    gap_u = np.minimum(along % 0.5, 0.5 - along % 0.5) * SIZE_PX
    gap = smoothstep(0.2, 1.6, np.minimum(gap_v, gap_u))
    return grey(grain * tone * (0.55 + 0.45 * gap), 0.86)


def parquet(rng: Rng) -> U8:
    """Herringbone of blocks four times as long as wide."""
    length, width = 4, 32
    size = SIZE_PX
    column, row = (X * size / width).astype(np.int64), (Y * size / width).astype(np.int64)
    step = (column - row) % (2 * length)
    lies = step < length
    across = np.where(lies, Y * size / width % 1.0, X * size / width % 1.0)
    fraction = np.where(lies, X * size / width % 1.0, Y * size / width % 1.0)
    along = np.where(lies, step, 2 * length - 1 - step) + fraction
    # The first cell of a block names it.
    first_column = np.where(lies, column - step, column)
    first_row = np.where(lies, row, row - (2 * length - 1 - step))
    name = (first_column % 8) * 8 + first_row % 8 + 64 * lies
    tone = rng.uniform(0.84, 1.08, 128)[name]
    plain = _grain(rng)
    u = np.where(lies, X, Y) + rng.random(128)[name]
    v = np.where(lies, Y, X) + rng.random(128)[name]
    grain = plain[(v * size).astype(np.int64) % size, (u * size).astype(np.int64) % size]
    border = np.minimum(np.minimum(across, 1 - across), np.minimum(along, length - along)) * width
    return grey(grain * tone * (0.6 + 0.4 * smoothstep(0.2, 1.5, border)), 0.87)


def tile(rng: Rng) -> U8:
    """4 x 4 square tiles with grout."""
    return _bricks(rng, columns=4, rows=4, stagger=0.0, grout_px=1.8, grout=0.72, spread=0.03)


def subway(rng: Rng) -> U8:
    """Glazed wall tiles twice as wide as high, in a running bond."""
    return _bricks(rng, columns=4, rows=8, stagger=0.5, grout_px=1.5, grout=0.76, spread=0.02)


def brick(rng: Rng) -> U8:
    """Rough bricks with light mortar."""
    size = SIZE_PX
    rows, columns = 8, 3
    wobble = fractal(rng, 1.3) * 0.004
    y = (Y + wobble) % 1.0
    row = np.floor(y * rows).astype(np.int64) % rows
    x = (X + wobble + 0.5 / columns * (row % 2)) % 1.0
    column = np.floor(x * columns).astype(np.int64) % columns
    edge_u = np.minimum(x * columns % 1.0, 1 - x * columns % 1.0) * size / columns
    edge_v = np.minimum(y * rows % 1.0, 1 - y * rows % 1.0) * size / rows
    face = smoothstep(1.2, 3.2, np.minimum(edge_u, edge_v))
    tone = rng.uniform(0.72, 1.0, (rows, columns))[row, column]
    stone = tone + 0.035 * fractal(rng, 0.6) + 0.02 * fractal(rng, 1.6)
    mortar = 1.12 + 0.03 * fractal(rng, 0.5)
    return grey(stone * face + mortar * (1 - face), 0.86)


def marble(rng: Rng) -> U8:
    """White stone with soft clouds and thin bent veins."""
    bend = fractal(rng, 1.9)
    vein = np.abs(fractal(rng, 1.7) + 0.7 * bend)
    fine = np.abs(fractal(rng, 1.6) + 0.4 * bend)
    value = 0.97 - 0.2 * np.exp(-vein * 18) - 0.09 * np.exp(-fine * 26) + 0.018 * bend
    return grey(np.stack([value, value, value * 1.0 + 0.006 * (1 - value)], axis=2), 0.93)


def granite(rng: Rng) -> U8:
    """Speckled stone with dark and light grains."""
    value = 0.86 + 0.03 * fractal(rng, 0.6) + 0.012 * fractal(rng, 1.2)
    value -= 0.2 * smoothstep(1.3, 1.7, fractal(rng, 0.75)) + 0.09 * smoothstep(0.9, 1.2, fractal(rng, 0.6))
    value += 0.1 * smoothstep(1.2, 1.6, fractal(rng, 0.7))
    return grey(value, 0.86)


def concrete(rng: Rng) -> U8:
    """Cloudy grey with small pores."""
    value = 0.9 + 0.03 * fractal(rng, 1.5) + 0.015 * fractal(rng, 0.3)
    return grey(value - 0.12 * (fractal(rng, 0.5) > 2.8), 0.89)


def plaster(rng: Rng) -> U8:
    """Painted wall: hardly any structure."""
    return grey(0.95 + 0.006 * fractal(rng, 1.3) + 0.004 * fractal(rng, 0.4), 0.95)


def wallpaper_stripe(rng: Rng) -> U8:
    """Four wide and four narrow vertical stripes."""
    phase = X * 4 % 1.0
    wide = smoothstep(0.0, 0.02, phase) * (1 - smoothstep(0.5, 0.52, phase))
    line = np.exp(-(((phase - 0.76) / 0.022) ** 2)) + np.exp(-(((phase - 0.26) / 0.016) ** 2)) * 0.5
    return grey(0.97 - 0.1 * wide - 0.09 * line + 0.005 * fractal(rng, 0.6), 0.91)


def wallpaper_damask(rng: Rng) -> U8:
    """Leaf-and-flower ornaments, every second column half a step lower."""
    column = np.floor(X * 4)
    x = (X * 4 % 1.0 - 0.5) * 2
    y = ((Y * 2 + 0.5 * (column % 2)) % 1.0 - 0.5) * 2
    figure = np.zeros_like(x)
    for cy, radius, petals, sharp in ((-0.05, 0.62, 6, 0.42), (0.0, 0.26, 8, 0.3)):
        r, angle = np.hypot(x, (y - cy) * 0.85), np.arctan2(y - cy, x)
        outline = radius * (1 - sharp + sharp * np.abs(np.cos(angle * petals / 2)))
        figure = np.maximum(figure, smoothstep(-0.02, 0.05, outline - r) * (0.65 if petals == 6 else 1.0))
    stem = np.exp(-(((x - 0.12 * np.sin(y * np.pi * 2)) / 0.05) ** 2)) * (np.abs(y) > 0.5)
    for side in (-1, 1):
        leaf = 1 - ((x - side * 0.42) * 0.8 + side * (y - 0.68) * 0.6) ** 2 / 0.012
        leaf = np.minimum(leaf, 1 - ((x - side * 0.42) * 0.6 * side - (y - 0.68) * 0.8) ** 2 / 0.09)
        figure = np.maximum(figure, smoothstep(0.0, 0.3, leaf) * 0.8)
    figure = np.maximum(figure, stem * 0.7)
    return grey(0.97 - 0.14 * figure + 0.004 * fractal(rng, 0.6), 0.91)


def fabric(rng: Rng) -> U8:
    """Plain weave."""
    threads = 32
    u, v = X * threads, Y * threads
    over = (np.floor(u) + np.floor(v)) % 2
    warp, weft = np.sin(np.pi * (u % 1.0)), np.sin(np.pi * (v % 1.0))
    height = np.where(over > 0, warp * (0.55 + 0.45 * weft), weft * (0.55 + 0.45 * warp))
    return grey(0.8 + 0.2 * height + 0.02 * fractal(rng, 0.4) + 0.012 * fractal(rng, 1.5), 0.87)


def knit(rng: Rng) -> U8:
    """Columns of V-shaped stitches."""
    u, v = X * 12 % 1.0, Y * 16
    lean = np.abs(u - 0.5) * 2
    stitch = np.sin(np.pi * ((v - 0.9 * (1 - lean)) % 1.0)) ** 0.7
    strand = np.sin(np.pi * np.clip((lean - 0.02) / 0.94, 0, 1)) ** 0.6
    return grey(0.68 + 0.32 * stitch * strand + 0.02 * fractal(rng, 0.4), 0.86)


def carpet(rng: Rng) -> U8:
    """Short pile."""
    return grey(0.86 + 0.055 * fractal(rng, 0.25) + 0.025 * fractal(rng, 1.2), 0.86)


def leather(rng: Rng) -> U8:
    """Small rounded grains with creases between."""
    # Smaller than the texture and repeated: a few hundred cells are enough.
    half = SIZE_PX // 2
    first, second, _ = cells(rng, 330, half)
    crease = np.tile(smoothstep(0.0, 0.02, second - first), (2, 2))
    return grey(0.86 + 0.1 * crease + 0.01 * fractal(rng, 1.4) + 0.008 * fractal(rng, 0.4), 0.9)


def wicker(rng: Rng) -> U8:
    """Basket weave of flat canes over upright stakes."""
    columns, rows = 8, 16
    u, v = X * columns, Y * rows
    phase = u + np.floor(v) % 2
    bulge = 0.5 + 0.5 * np.cos(np.pi * 2 * (phase / 2))
    cane = np.sin(np.pi * (v % 1.0)) ** 0.6
    value = (0.5 + 0.5 * bulge**0.7) * (0.5 + 0.5 * cane)
    return grey(value + 0.03 * fractal(rng, 0.8, (6, 1)), 0.78)


def rattan(rng: Rng) -> U8:
    """Cane webbing: strips in three directions around dark holes."""
    n = 8
    u, v = X * n, Y * n
    strips: F64 = np.zeros_like(u)
    for coordinate, width in ((u, 0.16), (v, 0.16), ((u + v), 0.1), ((u - v), 0.1)):
        off = np.abs((coordinate + 0.5) % 1.0 - 0.5)
        strips = np.maximum(strips, (1 - smoothstep(width - 0.04, width, off)) * (1 - 0.5 * off / width))
    return grey(0.42 + 0.55 * strips + 0.02 * fractal(rng, 0.6), 0.8)


def brushed(rng: Rng) -> U8:
    """Metal with fine scratches along u."""
    return grey(0.92 + 0.022 * fractal(rng, 0.45, (40, 1)) + 0.012 * fractal(rng, 1.4, (3, 1)), 0.92)


def cardboard(rng: Rng) -> U8:
    """Brown paper with faint flutes along v and fibres."""
    flutes = 0.012 * np.sin(2 * np.pi * 32 * X)
    fibres = 0.02 * fractal(rng, 0.7, (4, 1)) - 0.06 * (fractal(rng, 0.8, (5, 1)) > 2.5)
    return grey(0.92 + flutes + fibres + 0.015 * fractal(rng, 1.4), 0.91)


def terrazzo(rng: Rng) -> U8:
    """Chips of coloured stone in light cement."""
    first, second, nearest = cells(rng, 260)
    chip_size = rng.uniform(0.25, 0.62, 260)[nearest]
    inside = smoothstep(0.0, 0.01, second - first - 0.045 + 0.03 * chip_size) * (chip_size > 0.36)
    palette = np.array(
        [(0.55, 0.53, 0.52), (0.8, 0.66, 0.56), (0.7, 0.74, 0.74), (1.0, 0.98, 0.95), (0.86, 0.78, 0.66)]
    )
    chips = palette[rng.integers(len(palette), size=260)][nearest]
    cement = np.stack([0.95 + 0.012 * fractal(rng, 0.6)] * 3, axis=2)
    return grey(cement * (1 - inside[..., None]) + chips * inside[..., None], 0.88)


def towel(rng: Rng) -> U8:
    """Terry loops, with two smooth bands across."""
    loops = 0.85 + 0.06 * fractal(rng, 0.5) + 0.05 * np.sin(2 * np.pi * 48 * X) * np.sin(2 * np.pi * 48 * Y)
    band = np.exp(-(((Y - 0.82) / 0.02) ** 4)) + np.exp(-(((Y - 0.9) / 0.02) ** 4))
    woven = 0.78 + 0.04 * np.sin(2 * np.pi * 64 * X)
    return grey(loops * (1 - band) + woven * band, 0.87)


def soiled(rng: Rng) -> U8:
    """Brown stains with ragged edges, on what is dirty."""
    stains = smoothstep(0.25, 0.75, fractal(rng, 1.5) + 0.3 * fractal(rng, 0.8))[..., None]
    return grey(1.0 - stains * (1.0 - np.array([0.44, 0.31, 0.18])), 0.75)


def cracked(rng: Rng) -> U8:
    """Dark cracks between shards, on what is broken."""
    first, second, _ = cells(rng, 40)
    return grey(0.12 + 0.88 * smoothstep(0.002, 0.008, second - first), 0.9)


def _grain(rng: Rng) -> F64:
    """Wood brightness around 0.9."""
    bend = fractal(rng, 2.0, (3, 1)) * 0.018
    rings = np.sin(2 * np.pi * (7 * (Y + bend))) + 0.6 * np.sin(2 * np.pi * (17 * (Y + bend * 1.4)) + 1.3)
    fibres = fractal(rng, 0.6, (26, 1))
    pores = fractal(rng, 0.5, (14, 1)) > 2.1
    value: F64 = 0.9 + 0.045 * rings + 0.035 * fibres - 0.1 * pores
    return value


def _bricks(rng: Rng, *, columns: int, rows: int, stagger: float, grout_px: float, grout: float, spread: float) -> U8:
    """Smooth tiles in rows."""
    row = np.floor(Y * rows).astype(np.int64)
    x = (X + stagger / columns * (row % 2)) % 1.0
    column = np.floor(x * columns).astype(np.int64)
    u, v = x * columns % 1.0, Y * rows % 1.0
    edge = np.minimum(
        np.minimum(u, 1 - u) * SIZE_PX / columns,
        np.minimum(v, 1 - v) * SIZE_PX / rows,
    )
    face = smoothstep(grout_px * 0.6, grout_px * 1.2, edge)
    bevel = 0.04 * np.exp(-edge / 3.0) * np.where(v > 0.5, -1, 1)
    tone = rng.uniform(1 - spread, 1 + spread, (rows, columns))[row, column]
    glaze = tone * (0.95 + 0.01 * fractal(rng, 1.7)) + bevel
    return grey(glaze * face + grout * (1 - face), 0.91)


TILES: dict[str, Callable[[Rng], U8]] = {
    function.__name__: function
    for function in (
        wood,
        planks,
        parquet,
        tile,
        subway,
        brick,
        marble,
        granite,
        concrete,
        plaster,
        wallpaper_stripe,
        wallpaper_damask,
        fabric,
        knit,
        carpet,
        leather,
        wicker,
        rattan,
        brushed,
        cardboard,
        terrazzo,
        towel,
        soiled,
        cracked,
    )
}
