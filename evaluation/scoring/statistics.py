"""Intervals and tests for means over questions, when questions of one scene are alike.

Scenes are what was sampled, so scenes are what is resampled: a mean over questions is the ratio of two sums over scenes,
of the measure and of the number of questions. docs/METRICS.md says why.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import stats

from remqa_data.geometry.types import F64, I64

LEVEL = 0.95
RESAMPLES = 9999
POWER = 0.8
ROUNDING = 1e-12
"""Means that differ by less are the same."""
IntervalKind = Literal["bootstrap", "wilson", "none"]


@dataclass(frozen=True)
class Estimate:
    """A mean with its 95 % interval.

    Attributes
    ----------
    value : float or None
        None where nothing was measured.
    low, high : float or None
        None where there is no interval.
    interval : str
        "bootstrap" over scenes; "wilson" over questions, where all or none succeed; "none" for a single scene, or
        where all scenes have the same mean.
    questions, scenes : int
    """

    value: float | None
    low: float | None
    high: float | None
    interval: IntervalKind
    questions: int
    scenes: int


@dataclass(frozen=True)
class Difference:
    """Of two submissions on the same questions, the second minus the first.

    Attributes
    ----------
    value : float
    low, high : float or None
        95 % bootstrap interval over scenes; None where it cannot be had.
    p_value : float or None
        Two-sided, of swapping the two in whole scenes; None for a single scene.
    detectable : float or None
        The smallest true difference that a test at 5 % finds in 80 % of such test splits.
    questions, scenes : int
    """

    value: float
    low: float | None
    high: float | None
    p_value: float | None
    detectable: float | None
    questions: int
    scenes: int


def estimate(values: npt.ArrayLike, scenes: npt.ArrayLike, rng: np.random.Generator) -> Estimate:
    """The mean of a measure and its interval.

    Parameters
    ----------
    values : (n,) bool or float
        One for each question; bool for a success.
    scenes : (n,) int
        Which scene each question is of.
    rng : numpy.random.Generator
        For the resampling.

    Notes
    -----
    Bias-corrected and accelerated bootstrap (Efron 1987) by `scipy.stats.bootstrap`, the percentile bootstrap where
    the former is not defined. Where all or none succeed, resampling would give an interval of no width; Wilson's score
    interval (1927) by `scipy.stats.binomtest` is given instead, which takes questions for independent.
    """
    measure = np.asarray(values)
    sums, counts = _by_scene(measure.astype(np.float64), np.asarray(scenes, dtype=np.int64))
    value, questions = float(sums.sum() / counts.sum()), len(measure)
    low: float | None
    high: float | None
    if (measure == 0).all() or (measure == 1).all():
        found = stats.binomtest(int(measure.sum()), questions).proportion_ci(LEVEL, method="wilson")
        low, high, kind = float(found.low), float(found.high), "wilson"
    else:
        low, high = _bootstrap(sums, counts, rng)
        kind = "none" if low is None else "bootstrap"
    return Estimate(value, low, high, kind, questions, len(sums))  # type: ignore[arg-type]


def estimate_over_runs(runs: npt.ArrayLike, scenes: npt.ArrayLike, rng: np.random.Generator) -> Estimate:
    """The mean of a measure over several runs of one system, such as those of different seeds, and its interval.

    Parameters
    ----------
    runs : (k, n) bool or float
        One row for each run.
    scenes : (n,) int
        Which scene each question is of.
    rng : numpy.random.Generator
        For the resampling.

    Notes
    -----
    Percentile bootstrap in which runs and scenes are both drawn anew, as both were sampled. Three runs say little about
    how much runs differ: such an interval is rather too narrow.
    """
    measure = np.asarray(runs, dtype=np.float64)
    places = np.asarray(scenes, dtype=np.int64)
    sums = np.stack([_by_scene(run, places)[0] for run in measure])
    counts = _by_scene(measure[0], places)[1]
    run = rng.integers(len(sums), size=(RESAMPLES, len(sums), 1))
    scene = rng.integers(len(counts), size=(RESAMPLES, 1, len(counts)))
    draws = sums[run, scene].sum((1, 2)) / (len(sums) * counts[scene].sum((1, 2)))
    low, high = np.quantile(draws, ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    return Estimate(float(measure.mean()), float(low), float(high), "bootstrap", measure.shape[1], len(counts))


def not_measured(scenes: npt.ArrayLike) -> Estimate:
    """What is said of questions of these (n,) scenes whose measure nobody knows."""
    return Estimate(None, None, None, "none", len(np.asarray(scenes)), len(np.unique(scenes)))


def difference(
    first: npt.ArrayLike, second: npt.ArrayLike, scenes: npt.ArrayLike, rng: np.random.Generator
) -> Difference:
    """How much better the second of two submissions is on the same questions; parameters as in `estimate`.

    Notes
    -----
    The p-value is that of a paired permutation test which changes the sign of whole scenes
    (`scipy.stats.permutation_test`). The smallest detectable difference is (t(0.975) + t(0.8)) times the standard error
    of the difference, with Student's t of one degree of freedom fewer than there are scenes.
    """
    change = np.asarray(second, dtype=np.float64) - np.asarray(first, dtype=np.float64)
    sums, counts = _by_scene(change, np.asarray(scenes, dtype=np.int64))
    value, questions = float(sums.sum() / counts.sum()), len(change)
    if len(sums) < 2:
        return Difference(value, None, None, None, None, questions, len(sums))
    low, high = _bootstrap(sums, counts, rng)
    p_value = 1.0
    if sums.any():
        test = stats.permutation_test(
            (sums,), np.sum, permutation_type="samples", vectorized=True, n_resamples=RESAMPLES, rng=rng
        )
        p_value = float(test.pvalue)
    error = _standard_error(sums, counts, rng)
    errors = float(stats.t.ppf((1 + LEVEL) / 2, len(sums) - 1) + stats.t.ppf(POWER, len(sums) - 1))
    return Difference(value, low, high, p_value, errors * error if error > ROUNDING else None, questions, len(sums))


def _by_scene(values: F64, scenes: I64) -> tuple[F64, F64]:
    """Sum of the values, and number of questions, of each scene."""
    places = np.unique(scenes, return_inverse=True)[1]
    sums = np.bincount(places, weights=values)
    return np.asarray(sums, dtype=np.float64), np.bincount(places).astype(np.float64)


def _mean(sums: F64, counts: F64, axis: int = -1) -> F64:
    return np.asarray(sums.sum(axis=axis) / counts.sum(axis=axis))


def _bootstrap(sums: F64, counts: F64, rng: np.random.Generator) -> tuple[float | None, float | None]:
    ratios = sums / counts
    if len(sums) < 2 or np.ptp(ratios) <= ROUNDING:
        return None, None
    low, high = np.nan, np.nan
    for method in ("BCa", "percentile"):
        if not np.isfinite([low, high]).all():
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", stats.DegenerateDataWarning)
                found = stats.bootstrap(
                    (sums, counts),
                    _mean,
                    paired=True,
                    vectorized=True,
                    n_resamples=RESAMPLES,
                    confidence_level=LEVEL,
                    method=method,
                    rng=rng,
                ).confidence_interval
            low, high = float(found.low), float(found.high)
    return low, high


def _standard_error(sums: F64, counts: F64, rng: np.random.Generator) -> float:
    """Of the mean, by the bootstrap, whose variance of a mean of n scenes is (n - 1) / n of the true one."""
    count = len(sums)
    chosen = rng.integers(count, size=(RESAMPLES, count))
    return float(_mean(sums[chosen], counts[chosen]).std() * np.sqrt(count / (count - 1)))
