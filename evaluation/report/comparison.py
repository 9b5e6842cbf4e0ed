"""Two submissions to the same questions, side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from remqa_data.errors import ResultsError, counted
from remqa_data.evaluation.report.tables import Grid, in_words, rounded
from remqa_data.evaluation.scoring.results import NOT_REPLAYED, OVERALL, Results, load_results
from remqa_data.evaluation.scoring.statistics import Difference, difference
from remqa_data.evaluation.submission.tracks import TRACKS

OF_RESAMPLING = ("seed", "resamples")
"""What of the config changes intervals, and no score."""


@dataclass(frozen=True)
class Comparison:
    """One measure of two submissions.

    Attributes
    ----------
    name : str
        Of the measure.
    first, second : float
        Its means.
    difference : Difference
        The second minus the first.
    """

    name: str
    first: float
    second: float
    difference: Difference


def compare(first: Results, second: Results, *, seed: int = 0) -> list[Comparison]:
    """Compare two submissions question by question; see `load_comparable`."""
    scenes = np.unique(np.array(first.samples["scene"]), return_inverse=True)[1]
    found = []
    for name in first.measures:
        if None in (first.metric(name).value, second.metric(name).value):
            continue  # only a replay knows it
        left, right = (np.array(results.samples[name], dtype=np.float64) for results in (first, second))
        change = difference(left, right, scenes, np.random.default_rng(seed))
        found.append(Comparison(name, float(left.mean()), float(right.mean()), change))
    return found


def load_comparable(paths: Sequence[Path]) -> list[Results]:
    """Read some results.json.

    Raises
    ------
    ResultsError
        If a file is none, or they are not about the same questions.
    """
    results = [load_results(path) for path in paths]
    for path, other in zip(paths, results, strict=True):
        for what, of in _SAME.items():
            if of(other) != of(results[0]):
                raise ResultsError(f"{paths[0]} and {path} cannot be compared: they are not of the same {what}")
        if not _has_columns(other):
            raise ResultsError(f"{path} cannot be compared: a column of samples, or a measure, is missing or no number")
    return results


_SAME: dict[str, Callable[[Results], object]] = {
    "track": lambda results: results.track,
    "split": lambda results: results.split,
    "dataset": lambda results: results.dataset,
    "definitions (config)": lambda results: {k: v for k, v in results.config.items() if k not in OF_RESAMPLING},
    "questions": lambda results: results.samples.get("id"),
    "measures": lambda results: results.measures,
}


def comparison_grid(first: Path, second: Path, compared: list[Comparison]) -> Grid:
    """The comparison as a table."""
    headings = ("measure", "A", "B", "B - A", "95 % interval", "p", "detectable")
    rows = []
    for one in compared:
        change = one.difference
        interval = "-" if change.low is None else f"[{change.low:+.3f}, {change.high:+.3f}]"
        rows.append(
            (
                in_words(one.name),
                rounded(one.first),
                rounded(one.second),
                f"{change.value:+.3f}",
                interval,
                "-" if change.p_value is None else f"{change.p_value:.4f}",
                "-" if change.detectable is None else f"{change.detectable:.3f}",
            )
        )
    return Grid(f"A is {first}\nB is {second}", headings, tuple(rows))


def comparison_notes(paths: Sequence[Path], results: Sequence[Results], compared: list[Comparison]) -> list[str]:
    """What a reader of the comparison must know; the paths are those of the results."""
    one = compared[0].difference
    lines = [f"{path}: {NOT_REPLAYED}" for path, of in zip(paths, results, strict=True) if of.replayed is False]
    no_interval = any(one.difference.low is None for one in compared)
    return [
        *lines,
        _verdict(results),
        f"Paired over {counted(one.questions, 'question')} in {counted(one.scenes, 'scene')}; intervals by bootstrap over "
        "scenes, p by swapping the two in whole scenes.",
        "Detectable: the smallest true difference that a test at 5 % finds in 80 % of such test splits.",
        *(
            ["-: resampling tells nothing, as there is one scene only, or all differ by the same."]
            if no_interval
            else []
        ),
    ]


def _verdict(results: Sequence[Results]) -> str:
    """Which is ranked first; by how much, and whether that is luck, is in the table."""
    name = TRACKS[results[0].track].ranked_by
    first, second = (of.metric(name).value for of in results)
    if first is None or second is None:
        unranked = " and ".join(letter for letter, value in (("A", first), ("B", second)) if value is None)
        return f"Ranked by {in_words(name)}, which only a replay measures: no rank for {unranked}."
    order = "A and B are level" if first == second else "A before B" if first > second else "B before A"
    return f"Ranked by {in_words(name)}: {order}."


def _has_columns(results: Results) -> bool:
    count = len(results.samples.get("id", []))
    names = ("scene", *results.measures)
    if not count or any(len(results.samples.get(name, [])) != count for name in names):
        return False
    overall = {metric.name for metric in results.metrics if metric.breakdown == OVERALL}
    numbers = all(not isinstance(value, str) for name in results.measures for value in results.samples[name])
    return numbers and TRACKS[results.track].ranked_by in overall
