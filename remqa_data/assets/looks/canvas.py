"""A canvas for pictures: twice as large as the texture that comes of it, which smooths all edges."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from remqa_data.assets.looks.noise import SIZE_PX, fractal
from remqa_data.geometry.types import U8
from remqa_data.opencv import cv2

Rng = np.random.Generator
Color = tuple[int, int, int]

CANVAS_PX = 2 * SIZE_PX
INK: Color = (36, 36, 42)
CREAM: Color = (244, 238, 224)
_FONT = cv2.FONT_HERSHEY_DUPLEX


def plain(color: Color) -> U8:
    """A canvas of one colour."""
    return np.full((CANVAS_PX, CANVAS_PX, 3), color, dtype=np.uint8)


def gradient(top: Color, bottom: Color, until: float) -> U8:
    """From one colour to another on the way down; the second is reached at a share of the height."""
    t = np.clip(np.arange(CANVAS_PX) / (CANVAS_PX * until), 0, 1)[:, None, None]
    column = np.array(top) * (1 - t) + np.array(bottom) * t
    return np.ascontiguousarray(np.broadcast_to(column, (CANVAS_PX, CANVAS_PX, 3))).astype(np.uint8)


def polygon(image: U8, points: Sequence[tuple[int, int]], color: Color) -> None:
    """Fill a polygon; points are x, y in canvas pixels."""
    cv2.fillPoly(image, [np.array(points, dtype=np.int32)], color, cv2.LINE_AA)


def blend(image: U8, draw: Callable[[U8], object], opacity: float) -> None:
    """Draw onto a copy and mix it in."""
    layer = image.copy()
    draw(layer)
    image[:] = (image * (1 - opacity) + layer * opacity).astype(np.uint8)


def ridge(rng: Rng, height: int, swing: float, fall: float) -> list[tuple[int, int]]:
    """A line of hills across the picture."""
    line = height + swing * fractal(rng, fall, size=128)[0]
    return [(x * CANVAS_PX // 127, int(y)) for x, y in enumerate(line)]


def fill_below(image: U8, ridge: list[tuple[int, int]], color: Color) -> None:
    """Fill everything below a line of hills."""
    polygon(image, [*ridge, (CANVAS_PX, CANVAS_PX), (0, CANVAS_PX)], color)


def write(image: U8, text: str, centre: tuple[int, int], width: int, color: Color, thickness: int) -> None:
    """Write text of a width in pixels around a point."""
    (unit, _), _ = cv2.getTextSize(text, _FONT, 1.0, thickness)
    scale = width / max(unit, 1)
    (w, h), _ = cv2.getTextSize(text, _FONT, scale, thickness)
    cv2.putText(image, text, (centre[0] - w // 2, centre[1] + h // 2), _FONT, scale, color, thickness, cv2.LINE_AA)


def painted(image: U8, rng: Rng, strength: float = 1.0) -> U8:
    """Ragged edges and uneven colour, as from a brush."""
    ragged = 1.8 * strength
    y, x = np.mgrid[0:CANVAS_PX, 0:CANVAS_PX].astype(np.float32)
    dx, dy = (fractal(rng, 1.0, size=CANVAS_PX) * ragged for _ in range(2))
    moved = cv2.remap(
        image, (x + dx).astype(np.float32), (y + dy).astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT
    )
    tone = 1 + strength * (0.025 * fractal(rng, 1.2, size=CANVAS_PX) + 0.03 * fractal(rng, 0.8, (1, 7), size=CANVAS_PX))
    return to_bytes(moved * tone[..., None])


def framed(image: U8) -> U8:
    """A print with a white margin."""
    margin = CANVAS_PX // 16
    inner = cv2.resize(image, (CANVAS_PX - 2 * margin, CANVAS_PX - 2 * margin), interpolation=cv2.INTER_AREA)
    sheet = plain((250, 248, 243))
    sheet[margin:-margin, margin:-margin] = inner
    return halved(sheet)


def halved(image: U8) -> U8:
    """The finished texture: every four pixels of the canvas become one."""
    return to_bytes(image.reshape(SIZE_PX, 2, SIZE_PX, 2, 3).mean(axis=(1, 3)))


def to_bytes(image: npt.NDArray[np.float64]) -> U8:
    """Round to 0..255."""
    return np.clip(image + 0.5, 0, 255).astype(np.uint8)
