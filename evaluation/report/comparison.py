"""Two submissions to the same questions, side by side."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from remqa_data.errors import ResultsError
from remqa_data.evaluation.report.tables import Grid, in_words, rounded
from remqa_data.evaluation.scoring.results import NOT_REPLAYED, Results, load_results
from remqa_data.evaluation.scoring.statistics import Difference, difference


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


def compare(first: Path, second: Path, seed: int = 0) -> list[Comparison]:
    """Compare two results.json, question by question.

    Raises
    ------
    ResultsError
        If a file is none, or they are not about the same questions.
    """
    a, b = load_results(first), load_results(second)
    same = {
        "track": a.track == b.track,
        "split": a.split == b.split,
        "dataset": a.dataset == b.dataset,
        "definitions (config)": a.config == b.config,
        "questions": a.samples.get("id") == b.samples.get("id"),
    }
    for what, is_same in same.items():
        if not is_same:
            raise ResultsError(f"{first} and {second} cannot be compared: they are not of the same {what}")
    if not _has_columns(a) or not _has_columns(b):
        raise ResultsError(f"{first} and {second} cannot be compared: a column of samples is missing or too short")
    scenes = np.unique(np.array(a.samples["scene"]), return_inverse=True)[1]
    found = []
    for name in a.measures:
        if name not in b.measures:
            continue  # only a replay knows it
        left, right = (np.array(results.samples[name], dtype=np.float64) for results in (a, b))
        change = difference(left, right, scenes, np.random.default_rng(seed))
        found.append(Comparison(name, float(left.mean()), float(right.mean()), change))
    return found


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


def comparison_notes(first: Path, second: Path, compared: list[Comparison]) -> list[str]:
    """What a reader of the comparison must know."""
    one = compared[0].difference
    lines = [f"{path}: {NOT_REPLAYED}" for path in (first, second) if load_results(path).replayed is False]
    return [
        *lines,
        f"Paired over {one.questions} questions in {one.scenes} scenes; intervals by bootstrap over scenes, p by swapping "
        "the two in whole scenes.",
        "Detectable: the smallest true difference that a test at 5 % finds in 80 % of such test splits.",
    ]


def _has_columns(results: Results) -> bool:
    count = len(results.samples.get("id", []))
    return count > 0 and all(len(results.samples.get(name, [])) == count for name in ("scene", *results.measures))
