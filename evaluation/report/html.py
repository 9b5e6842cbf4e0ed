"""Pages that load nothing and believe nothing they show: report.html with tables, plots and failures, and tables alone.

Every text is escaped by the template, and a content security policy lets run only this report's own script, by its
checksum. Nothing is fetched: pictures are data: URIs.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from remqa_data.evaluation.report.gallery import find_attempts
from remqa_data.evaluation.report.published import questions_beside_published
from remqa_data.evaluation.report.tables import (
    BREAKDOWNS,
    Grid,
    asked_things,
    grid_of,
    in_words,
    meanings,
    notes,
    rounded,
)
from remqa_data.evaluation.scoring.ground_truth import GroundTruth
from remqa_data.evaluation.scoring.measures import measures_of
from remqa_data.evaluation.scoring.results import OVERALL, Metric, Results
from remqa_data.evaluation.submission.reader import Submission
from remqa_data.evaluation.submission.tracks import TRACKS
from remqa_data.extras import require
from remqa_data.files import atomic_path
from remqa_data.published import SOURCE
from remqa_data.storage.shards import read_table

HERE = Path(__file__).parent
SCRIPT, STYLE = HERE / "report.js", HERE / "report.css"
MOST_PLOTTED_GROUPS = 12
"""A breakdown with more groups is a table only."""
MAX_SAMPLES = 5000
"""More rows make a page that no browser likes; results.json has them all."""


@dataclass(frozen=True)
class PlotRow:
    """A group of a breakdown: one metric for each measure that is plotted."""

    group: str
    questions: int
    metrics: tuple[Metric, ...]


@dataclass(frozen=True)
class Plot:
    """Dots with intervals, some for each group of a breakdown."""

    title: str
    rows: tuple[PlotRow, ...]


def write_report(path: Path, results: Results, submission: Submission, truth: GroundTruth) -> None:
    """Write the report, whole or not at all.

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """
    main_measure = results.main_measure
    failures, successes = find_attempts(results, submission, truth)
    page = _page(
        "report.html.j2",
        results=results,
        title=TRACKS[results.track].title,
        notes=notes(results),
        meanings=meanings(results),
        grids=[grid_of(results, breakdown) for breakdown in _breakdowns(results)],
        published=_published(results, truth),
        source=SOURCE,
        things=asked_things(results),
        plots=_plots(results),
        plotted=[in_words(name) for name in _plotted(results)],
        failures=failures,
        successes=successes,
        failed=results.samples[main_measure].count(False),
        main_measure=in_words(main_measure),
        samples=_sample_rows(results),
        max_samples=MAX_SAMPLES,
    )
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def write_tables_page(path: Path, title: str, grids: Sequence[Grid], remarks: Sequence[str] = ()) -> None:
    """Write tables as a page, whole or not at all; remarks stand after them.

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """
    page = _page("tables.html.j2", title=title, grids=grids, notes=remarks)
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _page(name: str, **values: object) -> str:
    """A template with its values, and what all pages share: a script with its checksum, and a style."""
    jinja2 = require("jinja2", "report")
    loader = jinja2.FileSystemLoader(HERE)
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["rounded"] = rounded
    script = SCRIPT.read_text(encoding="utf-8")
    page = environment.get_template(name).render(
        script=jinja2.utils.markupsafe.Markup(script),
        script_sha256=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        style=jinja2.utils.markupsafe.Markup(STYLE.read_text(encoding="utf-8")),
        **values,
    )
    return str(page)


def _breakdowns(results: Results) -> list[str]:
    return [name for name in BREAKDOWNS if any(metric.breakdown == name for metric in results.metrics)]


def _published(results: Results, truth: GroundTruth) -> Grid | None:
    if results.track == "rec":
        return None
    questions = read_table(truth.root, "questions", truth.split, ["question"])["question"].to_pylist()
    return questions_beside_published(truth.split, truth.texts("kind"), questions)


def _plots(results: Results) -> list[Plot]:
    """The main measures by every breakdown that has not too many groups."""
    plots = []
    for breakdown in _breakdowns(results):
        found = [metric for metric in results.metrics if metric.breakdown == breakdown]
        groups = dict.fromkeys(metric.group for metric in found)
        if len(groups) <= MOST_PLOTTED_GROUPS:
            rows = [_plot_row(results, breakdown, group) for group in groups]
            plots.append(Plot(BREAKDOWNS[breakdown], (*rows, _plot_row(results, OVERALL, "all"))))
    return plots


def _plotted(results: Results) -> tuple[str, ...]:
    """Names of the measures that plots show."""
    own = (measure.name for measure in measures_of(results.track) if results.track in measure.plotted)
    return tuple(name for name in own if results.metric(name).value is not None)


def _plot_row(results: Results, breakdown: str, group: str) -> PlotRow:
    metrics = tuple(results.metric(name, breakdown, group) for name in _plotted(results))
    return PlotRow(in_words(group), metrics[0].questions, metrics)


def _sample_rows(results: Results) -> Grid:
    names = list(results.samples)
    columns = [results.samples[name][:MAX_SAMPLES] for name in names]
    rows = tuple(tuple(_text(value) for value in row) for row in zip(*columns, strict=True))
    return Grid("Every row", tuple(map(in_words, names)), rows)


def _text(value: str | bool | int | float | None) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "1" if value else "0"
    return rounded(value) if isinstance(value, float) else str(value)
