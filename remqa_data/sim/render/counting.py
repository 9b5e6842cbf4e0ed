"""How many pixels show what? Kernels that count them, without an image, and say what need not be drawn for that."""

from __future__ import annotations

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F64, I32, I64, Flags
from remqa_data.sim.render.camera import Scissor, View, Windows
from remqa_data.sim.render.raster import Buffers, Geometry, Placed, box_on_screen, rasterise

_SLACK_M = 1e-3
"""Vertices are rounded to float32, boxes are not."""


@exact
def mark_relevant(corners: F64, view: View, wanted: Flags, relevant: Flags) -> None:
    """Set which parts, by their (p, 8, 3) boxes, may be seen of the wanted ones, or before them."""
    parts = len(corners)
    extents = np.empty((parts, 7))
    for part in range(parts):
        box_on_screen(corners[part], view, extents[part])
        relevant[part] = wanted[part] and extents[part, 0] <= extents[part, 1] and extents[part, 2] <= extents[part, 3]
    shown = np.flatnonzero(relevant)
    for part in range(parts):
        x_low, x_high, y_low, y_high, nearest = extents[part, :5]
        if wanted[part] or x_low > x_high or y_low > y_high:
            continue
        for other in shown:
            meets = (x_low <= extents[other, 1]) & (extents[other, 0] <= x_high)
            meets &= (y_low <= extents[other, 3]) & (extents[other, 2] <= y_high)
            if meets and nearest <= extents[other, 6] + _SLACK_M:
                relevant[part] = True
                break


@exact
def write_labels(geometry: Geometry, labels: I32, buffers: Buffers, scissor: Scissor, image: I32) -> None:
    """Fill the (h, w) image within the scissor with the labels of (s,) surfaces, -1 where nothing is.

    The look-up stands here and in `count_labels`: as a function of its own it makes both take twice as long.
    """
    slots = buffers.slot
    last = label = np.int32(-1)
    for row in range(scissor.top, scissor.bottom + 1):
        for column in range(scissor.left, scissor.right + 1):
            slot = slots[row, column]
            if slot != last:
                last = slot
                label = labels[geometry.face_surface[buffers.record_face[slot]]] if slot >= 0 else np.int32(-1)
            image[row, column] = label


@exact
def count_labels(geometry: Geometry, labels: I32, buffers: Buffers, scissor: Scissor, counts: I64) -> None:
    """Add to each label of (s,) surfaces how many pixels within a scissor show it; those of label -1 are not counted."""
    slots = buffers.slot
    last = label = np.int32(-1)
    for row in range(scissor.top, scissor.bottom + 1):
        for column in range(scissor.left, scissor.right + 1):
            slot = slots[row, column]
            if slot != last:
                last = slot
                label = labels[geometry.face_surface[buffers.record_face[slot]]] if slot >= 0 else np.int32(-1)
            if label >= 0:
                counts[label] += 1


@exact
def count_in_windows(
    geometry: Geometry, placed: Placed, windows: Windows, buffers: Buffers, pinhole: bool, labels: I32, counts: I64
) -> None:
    """The same for the pixels of each of some windows, into (n, labels) counts; `pinhole` is True."""
    keys, slots = buffers.key.ravel(), buffers.slot.ravel()
    for i in range(len(windows.side)):
        side = int(windows.side[i])
        window = Buffers(
            keys[: side * side].reshape(side, side),
            slots[: side * side].reshape(side, side),
            buffers.records,
            buffers.record_face,
            buffers.drawn,
            buffers.candidates,
            buffers.image,
        )
        whole = Scissor(0, side - 1, 0, side - 1)
        view = View(windows.eye[i], windows.axes[i], windows.inverse[i], pinhole, side, side, whole)
        rasterise(geometry, placed, view, window)
        count_labels(geometry, labels, window, whole, counts[i])
