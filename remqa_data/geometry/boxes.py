"""Boxes: volume, overlap, distance and IoU. Pure numpy.

A box is x0, y0, z0, x1, y1, z1 in metres, axis-aligned in the world frame. Functions of two sets of boxes compare every box
of the first with every box of the second: (n, 6) and (m, 6) give (n, m). One box, of shape (6,), counts as a set of one.
The IoU of boxes in pictures is `remqa_data.metrics.box_iou`.

>>> iou_3d([0, 0, 0, 2, 2, 1], [0, 0, 0, 1, 1, 1])
array([[0.25]])
"""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Box

PRECISION_SLACK = 1e-9
"""Prec@X counts a hit when IoU >= X - 1e-9, so that an IoU that is X but for rounding is a hit."""


def volume(boxes: npt.ArrayLike) -> F64:
    """(n,) volume of 3D boxes in cubic metres; 0 for a box that is flat or turned inside out."""
    return _content(_boxes(boxes))


def intersection_volume(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """(n, m) volume that 3D boxes share, cubic metres."""
    return _shared(_boxes(a), _boxes(b))


def iou_3d(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """(n, m) intersection over union of 3D boxes, 0 to 1; 0 if either box has no volume."""
    one, other = _boxes(a), _boxes(b)
    shared = _shared(one, other)
    return _ratio(shared, _content(one)[:, None] + _content(other)[None] - shared)


def corners(box: npt.ArrayLike) -> F64:
    """(8, 3) corners of a box that is given by its least and its greatest, (2, 3).

    >>> corners([[0, 0, 0], [1, 2, 3]])[[0, 1, -1]].tolist()
    [[0.0, 0.0, 0.0], [0.0, 0.0, 3.0], [1.0, 2.0, 3.0]]
    """
    return np.array(list(product(*np.asarray(box, dtype=np.float64).T.tolist())))


def is_hit(iou: npt.ArrayLike, threshold: float) -> npt.NDArray[np.bool_]:
    """Whether an IoU counts as a hit for Prec@threshold.

    >>> bool(is_hit(0.1 + 0.2 + 0.2, 0.5)), bool(is_hit(0.7 - 1e-12, 0.7)), bool(is_hit(0.4999, 0.5))
    (True, True, False)
    """
    return np.asarray(np.asarray(iou, dtype=np.float64) >= threshold - PRECISION_SLACK)


def centres(boxes: npt.ArrayLike) -> F64:
    """(n, 3) centres of 3D boxes, metres."""
    low, high = _corners(_boxes(boxes))
    return np.asarray((low + high) / 2)


def centre_distance(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """(n, m) distance between the centres of 3D boxes, metres."""
    return arithmetic.length(centres(a)[:, None] - centres(b)[None])


def gap(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """(n, m) shortest distance between 3D boxes, metres; 0 when they touch or overlap."""
    return arithmetic.length(np.maximum(_axis_gaps(a, b), 0.0))


def horizontal_gap(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """(n, m) shortest distance between the plans of 3D boxes, metres; 0 when one is above the other."""
    return arithmetic.length(np.maximum(_axis_gaps(a, b)[..., :2], 0.0))


def vertical_gap(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """(n, m) height between the bottom of each box of `a` and the top of each of `b`, metres.

    Positive when `a` is above `b`; negative when it starts below the top of `b`.
    """
    return np.asarray(_boxes(a)[:, 2][:, None] - _boxes(b)[:, 5][None])


def overlap_share(a: npt.ArrayLike, b: npt.ArrayLike, axes: tuple[int, ...] = (0, 1)) -> F64:
    """(n, m) share of the smaller of two 3D boxes that lies over the other along some axes, 0 to 1.

    With the default axes: how much of the smaller plan the two plans have in common. With ``(2,)``: how much of the
    lower box's height. 0 if either box has no extent along these axes.
    """
    columns = [*axes, *(axis + 3 for axis in axes)]
    first, second = _boxes(a)[:, columns], _boxes(b)[:, columns]
    smaller = np.minimum(_content(first)[:, None], _content(second)[None])
    return _ratio(_shared(first, second), smaller)


def side_share(a: Box, b: Box, axis: int) -> float:
    """`overlap_share` of two boxes along one axis, many times as fast: for who asks of pairs, one after the other."""
    low, high = max(a[axis], b[axis]), min(a[axis + 3], b[axis + 3])
    smaller = min(a[axis + 3] - a[axis], b[axis + 3] - b[axis])
    return min((high - low) / smaller, 1.0) if smaller > 0 and high > low else 0.0


def _boxes(boxes: npt.ArrayLike) -> F64:
    array = np.asarray(boxes, dtype=np.float64)
    if array.ndim not in (1, 2) or array.shape[-1] != 6:
        msg = f"expected boxes of shape (n, 6), found {array.shape}"
        raise ValueError(msg)
    return array.reshape(-1, 6)


def _corners(boxes: F64) -> tuple[F64, F64]:
    half = boxes.shape[1] // 2
    return boxes[:, :half], boxes[:, half:]


def _content(boxes: F64) -> F64:
    low, high = _corners(boxes)
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=1))


def _shared(a: F64, b: F64) -> F64:
    (low_a, high_a), (low_b, high_b) = _corners(a), _corners(b)
    sides = np.minimum(high_a[:, None], high_b[None]) - np.maximum(low_a[:, None], low_b[None])
    return np.asarray(np.prod(np.maximum(sides, 0.0), axis=2))


def _ratio(part: F64, whole: F64) -> F64:
    ratio = np.divide(part, whole, out=np.zeros(part.shape), where=(whole > 0) & (part > 0))
    return np.minimum(ratio, 1.0)  # a box with itself may come to 1 + 1e-16


def _axis_gaps(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    (low_a, high_a), (low_b, high_b) = _corners(_boxes(a)), _corners(_boxes(b))
    return np.asarray(np.maximum(low_a[:, None] - high_b[None], low_b[None] - high_a[:, None]))
