"""Results as tables: for the terminal, as Markdown to paste, and for the report."""

from __future__ import annotations

from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from remqa_data.evaluation.scoring.measures import MEASURES, measures_of
from remqa_data.evaluation.scoring.results import NOT_REPLAYED, OVERALL, Metric, Results
from remqa_data.evaluation.submission.tracks import TRACKS

BREAKDOWNS = {
    "kind": "Kind",
    "room_type": "Room",
    "manipulation": "Manipulation",
    "path_length": "Shortest path",
    "answer": "True answer",
    "target_type": "Target",
}

IN_WORDS = {measure.name: measure.words for measure in MEASURES if measure.words} | {
    "iou": "IoU",
    "path_m": "metres walked",
    "goal_distance_m": "metres to the nearest goal pose",
    "target_visible": "target in the final view",
}
"""Measures and details whose name for people is not their name with spaces."""

FAILS_AT = {
    "S_N": "navigation",
    "success": "navigation",
    "S_L": "localisation",
    "S_M": "manipulation",
    "answer_accuracy": "answer",
}
"""What went wrong where a measure is the first that is not fulfilled."""


@dataclass(frozen=True)
class Grid:
    """A table of texts."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def transposed(self) -> Grid:
        """The same with rows for columns: what has few rows is narrow enough for a terminal."""
        headings, *rows = zip(self.headings, *self.rows, strict=True)
        return Grid(self.title, headings, tuple(rows))


def grid_of(results: Results, breakdown: str = "kind") -> Grid:
    """One row for each group of a breakdown and one for all, one column for each measure."""
    groups = list(dict.fromkeys(metric.group for metric in results.metrics if metric.breakdown == breakdown))
    keys = [*((breakdown, group) for group in groups), (OVERALL, "all")]
    by_key = {(metric.name, metric.breakdown, metric.group): metric for metric in results.metrics}
    rows = []
    for found in keys:
        of_group = [by_key[name, *found] for name in results.measures]
        rows.append((in_words(found[1]), str(of_group[0].questions), *(cell(metric) for metric in of_group)))
    headings = (BREAKDOWNS[breakdown], asked_things(results), *map(in_words, results.measures))
    return Grid(f"{TRACKS[results.track].title}, split {results.split}", headings, tuple(rows))


NOT_MEASURED = "not measured"


def cell(metric: Metric) -> str:
    """A value, then its interval on a second line."""
    if metric.value is None:
        return NOT_MEASURED
    if metric.low is None or metric.high is None:
        return rounded(metric.value)
    return f"{rounded(metric.value)}\n{rounded(metric.low)}–{rounded(metric.high)}"


def rounded(share: float) -> str:
    """A share with three digits; 1.000 is said of 1 alone, so that who reads it knows that nothing has failed."""
    return "0.999" if 0.999 < share < 1 else f"{share:.3f}"


def asked_things(results: Results) -> str:
    """What is counted."""
    return f"{TRACKS[results.track].asks}s"


def failed_at(results: Results, place: int) -> str:
    """The first thing that went wrong with a question."""
    measured = {name: column[place] for name, column in results.samples.items() if column[place] is not None}
    if not measured["answered"]:
        return "nothing was submitted"
    if measured.get("success"):
        return "too many steps"
    return next(stage for name, stage in FAILS_AT.items() if not measured.get(name, True))


def in_words(name: str) -> str:
    """A column's or a group's name as people read it: "answer accuracy", but "S_QA"."""
    return IN_WORDS.get(name) or name.replace("_", " ")


def meanings(results: Results) -> list[tuple[str, str]]:
    """Name and meaning of each measure of these results, once for all of its limits."""
    own = [measure for measure in measures_of(results.track) if measure.name in results.measures]
    return list({in_words(measure.name.partition("@")[0]): measure.meaning for measure in own}.items())


def notes(results: Results) -> list[str]:
    """What a reader of the numbers must know."""
    counts = results.counts
    lines = [NOT_REPLAYED] if results.replayed is False else []
    if results.replayed:
        lines.append(f"Replayed in the simulator, which refused {counts.refused_actions or 'no'} actions.")
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
    about = f"Agent: {_escaped(results.submission.agent)}. "
    return "\n".join([*markdown_lines(grid), "", about + " ".join(notes(results))]) + "\n"


def markdown_lines(grid: Grid) -> list[str]:
    """A table's title and its rows in Markdown."""
    escaped = [[_escaped(text) for text in row] for row in (grid.headings, *grid.rows)]
    lines = [f"| {' | '.join(row)} |" for row in escaped]
    return [f"**{grid.title}**", "", lines[0], "|" + "---|" + "---:|" * (len(grid.headings) - 1), *lines[1:]]


def print_results(console: Console, results: Results) -> None:
    """Print the table of kinds and the notes."""
    print_grid(console, grid_of(results).transposed())
    for line in notes(results):
        console.print(Text(line), style="bold red" if line == NOT_REPLAYED else "dim")


def print_grid(console: Console, grid: Grid) -> None:
    """Print a table; where it is wider than the console, its widest cells, most often names, take several lines."""
    table = Table(title=Text(grid.title), box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for place, heading in enumerate(grid.headings):
        table.add_column(Text(heading), justify="right" if place else "left", overflow="fold")
    for row in grid.rows:
        table.add_row(*(Text(text) for text in row))  # Text: names in brackets are not markup
    console.print(table)


def _escaped(text: str) -> str:
    """A text as the cell of a Markdown table, on one line."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ")
