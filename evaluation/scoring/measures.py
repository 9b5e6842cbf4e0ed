"""The measures: of each its name, what it tells people, in which tracks it counts, and how it is worked out.

To add one, add its record to `MEASURES`, and its definition to docs/METRICS.md. Those that ask several conditions of an
episode at once are records of `remqa_data.metrics.CHAIN`, which the environment reads too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import numpy.typing as npt

from remqa_data.evaluation.scoring.ground_truth import GroundTruth
from remqa_data.evaluation.submission.tracks import Track
from remqa_data.geometry.boxes import is_hit
from remqa_data.geometry.types import F64, I64, Flags
from remqa_data.metrics import (
    CHAIN,
    ChainedSuccess,
    box_iou,
    chained,
    is_localised,
    is_right_answer,
    navigation_success,
    spl,
)

STEP_LIMITS = (25, 50)
"""Steps within which the track `nav` asks for success, beside any number of them."""
IOU_THRESHOLDS = (0.5, 0.6, 0.7, 0.8, 0.9)


@dataclass(frozen=True, eq=False)
class Answers:
    """What is known of all answers of a submission, one entry for each row of the truth; missing rows are failures.

    Attributes
    ----------
    truth : GroundTruth
    answered : (n,) bool
        Whether the submission has a row for it.
    boxes, target_boxes : (n, 4) float
        The predicted box and that of the target in the final view; NaN where there is none.
    texts : list of str or None
        The answers.
    steps : (n,) int
    walked_m, distance_m : (n,) float
        Length of the path, and from its end to the nearest goal pose.
    is_manipulated : (n,) bool
        Whether the agent has done what had to be done; means nothing where nothing was replayed.
    """

    truth: GroundTruth
    answered: Flags
    boxes: F64
    target_boxes: F64
    texts: list[str | None]
    steps: I64
    walked_m: F64
    distance_m: F64
    is_manipulated: Flags

    @cached_property
    def is_visible(self) -> Flags:
        """Whether the target is in the final view."""
        return np.asarray(~np.isnan(self.target_boxes[:, 0]))

    @cached_property
    def navigated(self) -> Flags:
        """Whether the agent has got to a goal pose and sees the target."""
        return np.asarray(self.answered & navigation_success(self.distance_m, self.is_visible))

    @cached_property
    def iou(self) -> F64:
        """Of the predicted box and that of the target: in the final view, or in the stored frame of an expression."""
        return box_iou(self.boxes, self.truth.boxes if self.truth.track == "rec" else self.target_boxes)

    @cached_property
    def is_right(self) -> Flags:
        """Whether the answer is right."""
        return is_right_answer(self.texts, self.truth.texts("answer"))

    @cached_property
    def chained(self) -> dict[str, Flags]:
        """The conjunctive successes, by name."""
        return chained(
            {
                "navigated": self.navigated,
                "localised": is_localised(self.iou),
                "manipulated": self.is_manipulated,
                "answered": self.is_right,
            }
        )

    def success(self, limit: int | None) -> Flags:
        """Whether the agent has navigated, in at most so many steps."""
        return self.navigated if limit is None else np.asarray(self.navigated & (self.steps <= limit))

    def spl(self, limit: int | None) -> F64:
        """Success weighted by path length."""
        return spl(self.success(limit), self.truth.path_lengths_m, self.walked_m)

    def precision(self, threshold: float) -> Flags:
        """Whether the boxes overlap at least so much."""
        return np.asarray(is_hit(self.iou, threshold))


@dataclass(frozen=True)
class Measure:
    """A measure of each row, of which results are the means. Higher is better.

    Attributes
    ----------
    name : str
        In results.json; what stands after an @ is a limit.
    meaning : str
        For people; docs/METRICS.md has the definition.
    tracks : tuple of str
        In which it counts.
    of : callable
        From all answers to its (n,) bool or float values.
    words : str
        Its name for people, if that is not its name with spaces.
    plotted : tuple of str
        Tracks whose plots show it.
    takes_replay : bool
        Whether only the simulator knows it.
    """

    name: str
    meaning: str
    tracks: tuple[Track, ...]
    of: Callable[[Answers], npt.NDArray[np.generic]]
    words: str = ""
    plotted: tuple[Track, ...] = ()
    takes_replay: bool = False


def _success(limit: int | None) -> Measure:
    return Measure(
        "success" if limit is None else f"success@{limit}",
        "the agent has stopped at most 1 m from a pose that reaches the target, and sees the target; with @, in at most "
        "that many steps",
        ("nav",),
        partial(Answers.success, limit=limit),
        plotted=("nav",) if limit == max(STEP_LIMITS) else (),
    )


def _spl(limit: int | None) -> Measure:
    return Measure(
        "SPL" if limit is None else f"SPL@{limit}",
        "success weighted by path length, 1 for walks no longer than the shortest path to the first goal pose: "
        "success * shortest / max(walked, shortest)",
        ("nav",),
        partial(Answers.spl, limit=limit),
        plotted=("nav",) if limit == max(STEP_LIMITS) else (),
    )


def _precision(threshold: float) -> Measure:
    return Measure(
        f"prec@{threshold}",
        "the share of boxes whose IoU with the true one is at least what stands after the @",
        ("rec",),
        partial(Answers.precision, threshold=threshold),
        plotted=("rec",) if threshold == min(IOU_THRESHOLDS) else (),
    )


def _chained(success: ChainedSuccess) -> Measure:
    return Measure(
        success.name,
        success.meaning,
        ("remqa",),
        lambda answers: answers.chained[success.name],
        words=success.name,
        plotted=("remqa",),
        takes_replay="manipulated" in success.conditions,
    )


MEASURES: tuple[Measure, ...] = (
    *(_chained(success) for success in CHAIN),
    Measure(
        "answer_accuracy",
        "the answer is right, wherever the agent stands",
        ("remqa", "qa"),
        lambda answers: answers.is_right,
        plotted=("qa",),
    ),
    Measure(
        "manipulated",
        "it has done to the target what the question takes, wherever it stands and whatever it answers",
        ("remqa",),
        lambda answers: answers.is_manipulated,
        takes_replay=True,
    ),
    *(measure(limit) for limit in (None, *STEP_LIMITS) for measure in (_success, _spl)),
    *(_precision(threshold) for threshold in IOU_THRESHOLDS),
    Measure(
        "mean_iou",
        "the mean of intersection over union of the box and the true one",
        ("rec",),
        lambda answers: answers.iou,
        words="mean IoU",
        plotted=("rec",),
    ),
)
"""In the order in which they are reported."""


def measures_of(track: Track) -> tuple[Measure, ...]:
    """The measures of a track."""
    return tuple(measure for measure in MEASURES if track in measure.tracks)
