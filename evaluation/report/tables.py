"""Results as tables: for the terminal, as Markdown to paste, and for the report."""

from __future__ import annotations

from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from remqa_data.evaluation.scoring.results import NOT_REPLAYED, OVERALL, Metric, Results

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


MEANINGS = {
    "S_N": "navigated: the agent has stopped at most 1 m from a pose that reaches the target, and sees the target",
    "S_L": "S_N, and its box of the target overlaps the true one with an IoU of at least 0.5",
    "S_QA": "S_L, and its answer is right",
    "answer_accuracy": "the answer is right, wherever the agent stands",
    "manipulated": "it did the right thing to the right object, and the simulator let it; not part of S_QA",
    "success": "the agent has stopped at most 1 m from a pose that reaches the target, and sees the target; with @, in at "
    "most that many steps",
    "SPL": "success weighted by path length, 1 for the shortest path: success * shortest / max(walked, shortest)",
    "prec": "the share of boxes whose IoU with the true one is at least what stands after the @",
    "mean_iou": "the mean of intersection over union of the box and the true one",
}
"""What the measures are, for people; docs/METRICS.md has the definitions. By what stands before the @ of a name."""

IN_WORDS = {
    "iou": "IoU",
    "mean_iou": "mean IoU",
    "path_m": "metres walked",
    "goal_distance_m": "metres to the nearest goal pose",
    "target_visible": "target in the final view",
}


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
    return Grid(f"{TITLES[results.track]}, split {results.split}", headings, tuple(rows))


def cell(metric: Metric) -> str:
    """A value, then its interval on a second line."""
    if metric.low is None or metric.high is None:
        return rounded(metric.value)
    return f"{rounded(metric.value)}\n{rounded(metric.low)}–{rounded(metric.high)}"


def rounded(share: float) -> str:
    """A share with three digits; 1.000 is said of 1 alone, so that who reads it knows that nothing has failed."""
    return "0.999" if 0.999 < share < 1 else f"{share:.3f}"


def asked_things(results: Results) -> str:
    """What is counted."""
    return "expressions" if results.track == "rec" else "questions"


def in_words(name: str) -> str:
    """A column's or a group's name as people read it: "answer accuracy", but "S_QA"."""
    if name.startswith("S_"):
        return name
    return IN_WORDS.get(name) or name.replace("_", " ")


def meanings(results: Results) -> list[tuple[str, str]]:
    """Name and meaning of each measure of these results, once for all of its limits."""
    names = dict.fromkeys(name.partition("@")[0] for name in results.measures)
    return [(in_words(name), MEANINGS[name]) for name in names]


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
    return "\n".join([f"**{grid.title}**", "", *markdown_rows(grid), "", about + " ".join(notes(results))]) + "\n"


def markdown_rows(grid: Grid) -> list[str]:
    """The lines of a Markdown table."""
    escaped = [[_escaped(text) for text in row] for row in (grid.headings, *grid.rows)]
    lines = [f"| {' | '.join(row)} |" for row in escaped]
    return [lines[0], "|" + "---|" + "---:|" * (len(grid.headings) - 1), *lines[1:]]


def print_results(console: Console, results: Results) -> None:
    """Print the table of kinds and the notes."""
    print_grid(console, grid_of(results).transposed())
    for line in notes(results):
        console.print(Text(line), style="bold red" if line == NOT_REPLAYED else "dim")


def print_grid(console: Console, grid: Grid) -> None:
    """Print a table."""
    table = Table(title=Text(grid.title), box=SIMPLE_HEAD, padding=(0, 1, 0, 0))  # all fits in 80 columns
    for place, heading in enumerate(grid.headings):
        table.add_column(Text(heading), justify="right" if place else "left", no_wrap=True)
    for row in grid.rows:
        table.add_row(*(Text(text) for text in row))  # Text: names in brackets are not markup
    console.print(table)


def _escaped(text: str) -> str:
    """A text as the cell of a Markdown table, on one line."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ")
