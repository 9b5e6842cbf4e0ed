"""Submissions to the same questions in order, the best first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from remqa_data.errors import ResultsError, counted
from remqa_data.evaluation.report.comparison import load_comparable
from remqa_data.evaluation.report.tables import Grid, cell, in_words, markdown_lines, markdown_text, rounded
from remqa_data.evaluation.scoring.measures import measures_of
from remqa_data.evaluation.scoring.results import Metric, Results
from remqa_data.evaluation.submission.tracks import TRACKS

NO_RANK = "–"


@dataclass(frozen=True)
class Ranked:
    """A submission among others.

    Attributes
    ----------
    rank : int or None
        From 1; equal for those that score alike. None where the measure that decides was not measured.
    path : Path
        Of its results.json.
    results : Results
    """

    rank: int | None
    path: Path
    results: Results

    @property
    def agent(self) -> str:
        """Name of the agent."""
        return self.results.submission.agent

    def as_json(self) -> dict[str, Any]:
        """The entry for programs, with what decides and its interval."""
        metric = _decisive(self.results)
        return {
            "rank": self.rank,
            "file": self.path,
            "agent": self.agent,
            "measure": metric.name,
            "value": metric.value,
            "low": metric.low,
            "high": metric.high,
            "replayed": self.results.replayed,
        }


def rank(paths: Sequence[Path]) -> list[Ranked]:
    """Order some results.json by the main measure of their track; those that were not replayed come last, without a rank.

    Raises
    ------
    ResultsError
        If a file is none or is named twice, or they are not about the same questions.
    """
    for path, count in Counter(path.resolve() for path in paths).items():
        if count > 1:
            raise ResultsError(f"{path} is named {count} times")
    entries = list(zip(paths, load_comparable(paths), strict=True))
    scores = [None if results.replayed is False else _decisive(results).value for _, results in entries]
    known = [score for score in scores if score is not None]
    ranked = [
        Ranked(None if score is None else 1 + sum(other > score for other in known), path, results)
        for score, (path, results) in zip(scores, entries, strict=True)
    ]
    return sorted(ranked, key=lambda one: (one.rank is None, one.rank))


def ranking_grid(ranked: Sequence[Ranked]) -> Grid:
    """One row for each submission: rank, agent, what decides with its interval, and the other plotted measures."""
    first = ranked[0].results
    decisive = _decisive(first).name
    others = [m.name for m in measures_of(first.track) if first.track in m.plotted and m.name != decisive]
    rows = []
    for one in ranked:
        rest = (_value(one.results.metric(name)) for name in others)
        place = NO_RANK if one.rank is None else str(one.rank)
        rows.append((place, one.agent, cell(_decisive(one.results)), *rest))
    headings = ("rank", "agent", in_words(decisive), *map(in_words, others))
    return Grid(f"{TRACKS[first.track].title}, split {first.split}", headings, tuple(rows))


def ranking_notes(ranked: Sequence[Ranked]) -> list[str]:
    """What a reader of the order must know."""
    first = ranked[0].results
    metric = _decisive(first)
    over, rooms = counted(metric.questions, TRACKS[first.track].asks), counted(metric.scenes, "scene")
    lines = [f"Ranked by {in_words(metric.name)} over {over} in {rooms}."]
    lines.append("Intervals that overlap decide nothing: remqa-eval compare says whether a difference is luck.")
    lines += [f"{one.path} was not replayed and has no rank." for one in ranked if one.rank is None]
    return lines


def ranking_markdown(ranked: Sequence[Ranked]) -> str:
    """The order as Markdown, ready to paste."""
    grid = ranking_grid(ranked)
    return "\n".join([*markdown_lines(grid), "", markdown_text(" ".join(ranking_notes(ranked)))]) + "\n"


def _decisive(results: Results) -> Metric:
    return results.metric(TRACKS[results.track].ranked_by)


def _value(metric: Metric) -> str:
    return NO_RANK if metric.value is None else rounded(metric.value)
