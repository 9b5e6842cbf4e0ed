"""report.html: one file with tables, plots and failures, which loads nothing and believes nothing it shows.

Every text is escaped by the template, and a content security policy lets run only this report's own script, by its
checksum. Nothing is fetched: pictures are data: URIs.
"""

from __future__ import annotations

import base64
import hashlib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from remqa_data.evaluation.gallery import MAIN_MEASURE, find_failures
from remqa_data.evaluation.results import Metric, Results
from remqa_data.evaluation.submission import Submission
from remqa_data.evaluation.tables import BREAKDOWNS, TITLES, Grid, grid_of, notes
from remqa_data.evaluation.truth import Truth
from remqa_data.extras import require
from remqa_data.files import atomic_path

TEMPLATE, SCRIPT, STYLE = (Path(__file__).with_name(name) for name in ("report.html.j2", "report.js", "report.css"))
PUBLISHED_QUESTIONS = {
    "train": {"EXISTENCE": 1653, "COUNTING": 647, "SPATIAL": 1083},
    "test": {"EXISTENCE": 324, "COUNTING": 143, "SPATIAL": 222},
}
"""Questions of the published benchmark; its agents' scores are not known to this package."""
MAX_SAMPLES = 5000
"""More rows make a page that no browser likes; results.json has them all."""


@dataclass(frozen=True)
class Plot:
    """Dots with intervals, one row for each group of a breakdown; lengths in SVG units."""

    title: str
    measure: str
    rows: tuple[Metric, ...]


def write_report(path: Path, results: Results, submission: Submission, truth: Truth) -> None:
    """Write the report, whole or not at all.

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """
    jinja2 = require("jinja2", "report")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    script = SCRIPT.read_text(encoding="utf-8")
    page = template.render(
        results=results,
        title=TITLES[results.track],
        notes=notes(results),
        grids=[grid_of(results, breakdown) for breakdown in _breakdowns(results)],
        published=_published(results),
        plots=_plots(results),
        failures=find_failures(results, submission, truth),
        main_measure=MAIN_MEASURE[results.track],
        samples=_sample_rows(results),
        max_samples=MAX_SAMPLES,
        script=jinja2.utils.markupsafe.Markup(script),
        script_sha256=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        style=jinja2.utils.markupsafe.Markup(STYLE.read_text(encoding="utf-8")),
    )
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _breakdowns(results: Results) -> list[str]:
    return [name for name in BREAKDOWNS if any(metric.breakdown == name for metric in results.metrics)]


def _published(results: Results) -> Grid | None:
    """How many questions of each kind there are, here and in the published benchmark."""
    published = PUBLISHED_QUESTIONS.get(results.split)
    if results.track == "rec" or published is None:
        return None
    counts = Counter(str(kind) for kind in results.samples["kind"])
    rows = tuple((kind, str(counts[kind]), str(count)) for kind, count in published.items())
    total = ("all", str(sum(counts.values())), str(sum(published.values())))
    return Grid(f"Questions of split {results.split}", ("Kind", "this dataset", "published"), (*rows, total))


def _plots(results: Results) -> list[Plot]:
    """The main measure by every breakdown."""
    name = MAIN_MEASURE[results.track]
    overall = results.metric(name)
    plots = []
    for breakdown in _breakdowns(results):
        rows = [metric for metric in results.metrics if (metric.name, metric.breakdown) == (name, breakdown)]
        plots.append(Plot(BREAKDOWNS[breakdown], name, (*rows, overall)))
    return plots


def _sample_rows(results: Results) -> Grid:
    names = list(results.samples)
    columns = [results.samples[name][:MAX_SAMPLES] for name in names]
    rows = tuple(tuple(_text(value) for value in row) for row in zip(*columns, strict=True))
    return Grid("Every row", tuple(name.replace("_", " ") for name in names), rows)


def _text(value: str | bool | float) -> str:
    if isinstance(value, bool):
        return "1" if value else "0"
    return f"{value:.3f}" if isinstance(value, float) else value
