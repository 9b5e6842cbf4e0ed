"""Noise that repeats without a seam, and other small tools that textures are made of."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from remqa_data.geometry.types import F64, U8

SIZE_PX = 256

Y, X = np.mgrid[0:SIZE_PX, 0:SIZE_PX].astype(np.float64) / SIZE_PX
"""Texture coordinates v and u of the pixels, 0 to 1."""


def fractal(
    rng: np.random.Generator, fall: float = 1.6, stretch: tuple[float, float] = (1.0, 1.0), size: int = SIZE_PX
) -> F64:
    """Seamless noise with mean 0 and standard deviation 1.

    Parameters
    ----------
    rng : Generator
        Source of the phases.
    fall : float
        The spectrum falls with frequency to this power: 0 is white noise, 1 rough, 2 cloudy.
    stretch : tuple of float
        How many times longer the grains are along x and y.
    size : int
        Pixels.
    """
    spectrum = np.fft.fft2(rng.standard_normal((size, size)))
    fy, fx = np.meshgrid(np.fft.fftfreq(size) * size, np.fft.fftfreq(size) * size, indexing="ij")
    radius = np.hypot(fx * stretch[0], fy * stretch[1])
    radius[0, 0] = 1.0
    spectrum *= radius**-fall
    spectrum[0, 0] = 0.0
    noise = np.fft.ifft2(spectrum).real
    result: F64 = noise / noise.std()
    return result


def cells(rng: np.random.Generator, count: int, size: int = SIZE_PX) -> tuple[F64, F64, npt.NDArray[np.int64]]:
    """Seamless Voronoi cells: distance to the nearest and second nearest seed (0..1 units), and the nearest's index."""
    seeds = rng.random((count, 2))
    y, x = np.mgrid[0:size, 0:size] / size
    first, second = np.full((size, size), np.inf), np.full((size, size), np.inf)
    nearest = np.zeros((size, size), dtype=np.int64)
    for index, (sx, sy) in enumerate(seeds):
        dx, dy = np.abs(x - sx), np.abs(y - sy)
        distance = np.hypot(np.minimum(dx, 1 - dx), np.minimum(dy, 1 - dy))
        nearer = distance < first
        second = np.where(nearer, first, np.minimum(second, distance))
        nearest = np.where(nearer, index, nearest)
        first = np.where(nearer, distance, first)
    return first, second, nearest


def shift(image: F64, dx: F64, dy: F64) -> F64:
    """Read an image at moved coordinates (in texture widths), wrapping around, nearest pixel."""
    size = len(image)
    columns = np.floor((X + dx) * size).astype(np.int64) % size
    rows = np.floor((Y + dy) * size).astype(np.int64) % size
    moved: F64 = image[rows, columns]
    return moved


def smoothstep(low: float, high: float, value: F64) -> F64:
    """0 below `low`, 1 above `high`, smooth between."""
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    result: F64 = t * t * (3 - 2 * t)
    return result


def grey(value: F64, mean: float = 0.9) -> U8:
    """(h, w) brightness or (h, w, 3) colour to uint8, scaled to a mean; brightness gets three equal channels."""
    scaled = np.clip(value * (mean / value.mean()), 0.0, 1.0)
    pixels = (scaled * 255 + 0.5).astype(np.uint8)
    return pixels if pixels.ndim == 3 else np.repeat(pixels[..., None], 3, axis=2)
