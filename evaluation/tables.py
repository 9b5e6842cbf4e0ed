"""Results as tables: for the terminal, as Markdown to paste, and for the report."""

from __future__ import annotations

from dataclasses import dataclass

from rich.console import Console
from rich.table import Table
from rich.text import Text

from remqa_data.evaluation.results import NOT_REPLAYED, OVERALL, Metric, Results

TITLES = {
    "remqa": "REMQA: navigated, localised, answered (each over all questions)",
    "nav": "Object-goal navigation",
    "rec": "Referring expression comprehension",
    "qa": "Question answering on the stored frames",
}
BREAKDOWNS = {
    "kind": "Kind",
    "room_type": "Room",
    "manipulation": "Manipulation",
    "path_length": "Shortest path",
    "answer": "True answer",
    "target_type": "Target",
}


@dataclass(frozen=True)
class Grid:
    """A table of texts."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def grid_of(results: Results, breakdown: str = "kind") -> Grid:
    """One row for each group of a breakdown and one for all, one column for each measure."""
    groups = list(dict.fromkeys(metric.group for metric in results.metrics if metric.breakdown == breakdown))
    keys = [*((breakdown, group) for group in groups), (OVERALL, "all")]
    by_key = {(metric.name, metric.breakdown, metric.group): metric for metric in results.metrics}
    rows = []
    for found in keys:
        of_group = [by_key[name, *found] for name in results.measures]
        rows.append((found[1], str(of_group[0].questions), *(cell(metric) for metric in of_group)))
    names = (name if name.startswith("S_") else name.replace("_", " ") for name in results.measures)
    headings = (BREAKDOWNS[breakdown], "n", *names)
    return Grid(f"{TITLES[results.track]}, split {results.split}", headings, tuple(rows))


def cell(metric: Metric) -> str:
    """A value, then its interval on a second line."""
    if metric.low is None or metric.high is None:
        return f"{metric.value:.3f}"
    return f"{metric.value:.3f}\n{metric.low:.2f}–{metric.high:.2f}"


def notes(results: Results) -> list[str]:
    """What a reader of the numbers must know."""
    counts = results.counts
    lines = [NOT_REPLAYED] if results.replayed is False else []
    if results.replayed:
        lines.append(f"Replayed in the simulator; it refused {counts.refused_actions} actions.")
    lines.append(
        f"{counts.asked} asked, {counts.answered} answered, {counts.missing} missing (they count as failures), "
        f"{counts.scored} scored."
    )
    lines.append("a–b: 95 % interval, bootstrap over scenes (Wilson where all or none succeed). Higher is better.")
    lines.append(f"Dataset {results.dataset.sha256[:16]}, remqa-data {results.versions['remqa-data']}.")
    return lines


def markdown(results: Results) -> str:
    """The table of kinds and the notes, ready to paste."""
    grid = grid_of(results)
    about = f"Agent: {results.submission.agent}. "
    return "\n".join([f"**{grid.title}**", "", *markdown_rows(grid), "", about + " ".join(notes(results))]) + "\n"


def markdown_rows(grid: Grid) -> list[str]:
    """The lines of a Markdown table."""
    escaped = [[_escaped(text) for text in row] for row in (grid.headings, *grid.rows)]
    lines = [f"| {' | '.join(row)} |" for row in escaped]
    return [lines[0], "|" + "---|" + "---:|" * (len(grid.headings) - 1), *lines[1:]]


def print_results(console: Console, results: Results) -> None:
    """Print the table of kinds and the notes."""
    print_grid(console, grid_of(results))
    for line in notes(results):
        console.print(Text(line), style="bold red" if line == NOT_REPLAYED else "dim")


def print_grid(console: Console, grid: Grid) -> None:
    """Print a table."""
    table = Table(title=Text(grid.title))
    for place, heading in enumerate(grid.headings):
        table.add_column(Text(heading.replace(" ", "\n")), justify="right" if place else "left", no_wrap=True)
    for row in grid.rows:
        table.add_row(*(Text(text) for text in row))  # Text: names in brackets are not markup
    console.print(table)


def _escaped(text: str) -> str:
    """A text as the cell of a Markdown table, on one line."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ")
