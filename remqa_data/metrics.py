"""The measures of the benchmark, shared by the evaluator and the environment. Pure numpy.

Every function takes whole columns, one entry for each episode, and returns a column; docs/METRICS.md has the definitions
with their sources. Boxes are x1, y1, x2, y2 in pixels, half open; lengths are metres.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.boxes import is_hit
from remqa_data.geometry.types import F64, Flags

SUCCESS_DISTANCE_M = 1.0
"""The agent must stop this near to a goal pose, straight and in plan."""
DISTANCE_SLACK_M = 1e-6
"""So that four steps of 0.25 m away is near enough, whatever their rounding."""
LOCALISED_IOU = 0.5
"""The predicted box of the target must overlap the true one this much."""
BLOCK = 1 << 15
"""Pairs of boxes that are compared at a time: what fits into a core's cache."""


Condition = Literal["navigated", "localised", "manipulated", "answered"]
"""What can be asked of an episode: it is there and sees the target; its box is right; it did what had to be done
(`remqa_data.sim.agent.outcome`); its answer is right."""


@dataclass(frozen=True)
class ChainedSuccess:
    """A success that asks several things at once; its mean is a ratio over all episodes.

    Attributes
    ----------
    name : str
    conditions : tuple of str
        All of which it asks.
    meaning : str
        For people; docs/METRICS.md has the definition.
    """

    name: str
    conditions: tuple[Condition, ...]
    meaning: str


CHAIN: tuple[ChainedSuccess, ...] = (
    ChainedSuccess(
        "S_N",
        ("navigated",),
        "navigated: the agent has stopped at most 1 m from a pose that reaches the target, and sees the target",
    ),
    ChainedSuccess(
        "S_L",
        ("navigated", "localised"),
        "S_N, and its box of the target overlaps the true one with an IoU of at least 0.5",
    ),
    ChainedSuccess(
        "S_QA",
        ("navigated", "localised", "answered"),
        "S_L, and its answer is right, whether it has manipulated or not",
    ),
    ChainedSuccess(
        "S_M",
        ("navigated", "localised", "manipulated"),
        "S_L, and it has done to the target what the question takes, so that what was hidden lies open",
    ),
    ChainedSuccess(
        "S_MQA",
        ("navigated", "localised", "manipulated", "answered"),
        "S_M, and its answer is right; submissions are ranked by this",
    ),
)
"""The published three, then the two of the strict chain, which credits no answer that was not looked for."""


def box_iou(a: npt.ArrayLike, b: npt.ArrayLike) -> F64:
    """Intersection over union of boxes, 0 to 1; 0 where a box has no area or a coordinate is NaN (there is no box).

    Parameters
    ----------
    a, b : (..., 4) array
        Broadcast against each other: (n, 4) and (n, 4) give (n,), (n, 1, 4) and (m, 4) give all (n, m) pairs.

    Examples
    --------
    >>> box_iou([0, 0, 100, 100], [[0, 0, 50, 50], [5, 5, 5, 9]])
    array([0.25, 0.  ])
    """
    first, second = _boxes(a), _boxes(b)
    shape = np.broadcast_shapes(first.shape[:-1], second.shape[:-1])
    if len(shape) < 2:
        return _box_iou(first, second)
    iou = np.empty(shape)
    rows = max(1, BLOCK * shape[0] // max(iou.size, 1))
    for start in range(0, shape[0], rows):
        part = slice(start, start + rows)
        mine, others = (x if x.ndim <= len(shape) or len(x) == 1 else x[part] for x in (first, second))
        iou[part] = _box_iou(mine, others)
    return iou


def spl(success: npt.ArrayLike, shortest_m: npt.ArrayLike, walked_m: npt.ArrayLike) -> F64:
    """(n,) success weighted by path length: S * l / max(p, l), and S where nothing had to be and nothing was walked.

    Anderson et al., On Evaluation of Embodied Navigation Agents, 2018 (arXiv:1807.06757), whose SPL is the mean of this.

    Parameters
    ----------
    success : (n,) bool
    shortest_m, walked_m : (n,) float
        l and p: length of the shortest path, and of the path taken.

    Examples
    --------
    >>> spl([True, True, False], [5.0, 10.0, 3.0], [10.0, 8.0, 3.0])
    array([0.5, 1. , 0. ])
    """
    succeeded = np.asarray(success, dtype=bool)
    shortest = np.asarray(shortest_m, dtype=np.float64)
    longest = np.maximum(np.asarray(walked_m, dtype=np.float64), shortest)
    return np.where(succeeded, np.divide(shortest, longest, out=np.ones_like(longest), where=longest > 0), 0.0)


def path_lengths_m(positions: npt.ArrayLike, counts: npt.ArrayLike) -> F64:
    """(n,) metres of paths in plan; 0 for one position.

    Parameters
    ----------
    positions : (sum of counts, 2) array
        The positions of all paths, one path after the other, metres.
    counts : (n,) int
        How many positions each path has.

    Examples
    --------
    >>> path_lengths_m([(0, 0), (0, 0.25), (0, 0.25), (0.25, 0.25), (9, 9)], [4, 1])
    array([0.5, 0. ])
    """
    points = np.asarray(positions, dtype=np.float64).reshape(-1, 2)
    lengths = np.asarray(counts, dtype=np.int64)
    paths = np.repeat(np.arange(len(lengths)), lengths)
    steps = arithmetic.length(np.diff(points, axis=0))
    own = paths[1:] == paths[:-1]  # the others lead from one path to the next
    return np.asarray(np.bincount(paths[1:][own], weights=steps[own], minlength=len(lengths)), dtype=np.float64)


def distance_to_goal_m(positions: npt.ArrayLike, goals: npt.ArrayLike) -> F64:
    """(...,) straight distance in plan from positions to the nearest of their goals; infinite where there is none.

    Parameters
    ----------
    positions : (..., 2) array
    goals : (..., k, 2) array
        Positions of goal poses; NaN pads where there are fewer than k.

    Examples
    --------
    >>> distance_to_goal_m([(0, 0), (1, 0)], [[(3, 4), (1, 0)], [(2, 0), (np.nan, np.nan)]])
    array([1., 1.])
    """
    gaps = np.asarray(goals, dtype=np.float64) - np.asarray(positions, dtype=np.float64)[..., None, :]
    distances = arithmetic.length(gaps)
    return np.asarray(np.min(np.where(np.isnan(distances), np.inf, distances), axis=-1, initial=np.inf))


def navigation_success(distance_m: npt.ArrayLike, is_visible: npt.ArrayLike) -> Flags:
    """(n,) whether the agent has stopped at most 1.0 m from a goal pose, with the target in its final view.

    Parameters
    ----------
    distance_m : (n,) float
        To the nearest goal pose, see `distance_to_goal_m`; NaN (no prediction) is no success.
    is_visible : (n,) bool
        Whether the target shows at least `remqa_data.sim.metadata.scaled_min_pixels` pixels (50 in 300 x 300) in the view
        after the last navigation action, before any manipulation.

    Examples
    --------
    >>> navigation_success([1.0, 0.2, 1.1], [True, False, True])
    array([ True, False, False])
    """
    near = np.asarray(distance_m, dtype=np.float64) <= SUCCESS_DISTANCE_M + DISTANCE_SLACK_M
    return np.asarray(near & np.asarray(is_visible, dtype=bool))


def is_localised(iou: npt.ArrayLike) -> Flags:
    """(n,) whether a box is near enough to that of the target in the final view before the manipulation.

    >>> is_localised([0.5, 0.4])
    array([ True, False])
    """
    return np.asarray(is_hit(iou, LOCALISED_IOU))


def chained(conditions: Mapping[Condition, npt.ArrayLike]) -> dict[str, Flags]:
    """By name, the (n,) successes of `CHAIN`.

    Parameters
    ----------
    conditions : mapping of (n,) bool
        Which episodes fulfil each condition.

    Examples
    --------
    >>> yes = [True, True]
    >>> found = chained({"navigated": yes, "localised": yes, "manipulated": [True, False], "answered": yes})
    >>> found["S_QA"], found["S_MQA"]
    (array([ True,  True]), array([ True, False]))
    """
    return {
        success.name: np.logical_and.reduce([np.asarray(conditions[name], dtype=bool) for name in success.conditions])
        for success in CHAIN
    }


def is_right_answer(answers: Sequence[str | None], truths: Sequence[str]) -> Flags:
    """(n,) whether each answer is the true one, but for case and spaces around it; None (no answer) is not.

    >>> is_right_answer(["Yes ", "2", None], ["yes", "3", "no"])
    array([ True, False, False])
    """
    pairs = zip(answers, truths, strict=True)
    return np.array([given is not None and given.strip().lower() == truth for given, truth in pairs], dtype=bool)


def _box_iou(a: F64, b: F64) -> F64:
    first, second = _columns(a), _columns(b)
    width = np.asarray(np.minimum(first[2], second[2]) - np.maximum(first[0], second[0]))
    height = np.asarray(np.minimum(first[3], second[3]) - np.maximum(first[1], second[1]))
    shared = np.maximum(width, 0.0, out=width)
    shared *= np.maximum(height, 0.0, out=height)
    union = np.add(_area(first), _area(second), out=height)
    union -= shared
    iou = np.divide(shared, np.maximum(union, _TINY, out=union), out=shared)
    return np.asarray(np.minimum(iou, 1.0, out=iou))  # a box with itself may come to 1 + 1e-16


_TINY = np.finfo(np.float64).tiny
"""Makes 0 / 0 a 0."""


def _columns(boxes: F64) -> F64:
    """(4, ...) x1, y1, x2, y2, each in one piece of memory; a box with NaN has no area."""
    columns = np.array(np.moveaxis(boxes, -1, 0), order="C")
    columns[:, np.isnan(columns).any(axis=0)] = 0.0
    return columns


def _area(columns: F64) -> F64:
    return np.asarray(np.maximum(columns[2] - columns[0], 0.0) * np.maximum(columns[3] - columns[1], 0.0))


def _boxes(boxes: npt.ArrayLike) -> F64:
    array = np.asarray(boxes, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 4:
        msg = f"expected boxes of shape (..., 4), found {array.shape}"
        raise ValueError(msg)
    return array
