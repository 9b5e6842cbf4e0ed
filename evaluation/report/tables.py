"""Results as tables: for the terminal, as Markdown to paste, and for the report."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
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
    lines.append(
        "a–b: 95 % interval, bootstrap over scenes (none over one; Wilson where all or none succeed). Higher is better."
    )
    lines.append(f"Dataset {results.dataset.sha256[:16]}, remqa-data {results.versions['remqa-data']}.")
    return lines


def markdown(results: Results) -> str:
    """The table of kinds and the notes, ready to paste."""
    grid = grid_of(results)
    about = f"Agent: {markdown_text(results.submission.agent)}. "
    return "\n".join([*markdown_lines(grid), "", about + " ".join(notes(results))]) + "\n"


def markdown_lines(grid: Grid) -> list[str]:
    """A table's title and its rows in Markdown."""
    escaped = [[markdown_text(text) for text in row] for row in (grid.headings, *grid.rows)]
    lines = [f"| {' | '.join(row)} |" for row in escaped]
    rule = "|---|" + "---:|" * (len(grid.headings) - 1)
    return [f"**{markdown_text(grid.title)}**", "", lines[0], rule, *lines[1:]]


def print_results(console: Console, results: Results) -> None:
    """Print the table of kinds and the notes."""
    print_grid(console, grid_of(results).transposed())
    for line in notes(results):
        console.print(Text(line), style="bold red" if line == NOT_REPLAYED else "dim")


def print_grid(console: Console, grid: Grid) -> None:
    """Print a table, of which no number is broken.

    Where it is wider than the console, headings and names take several lines; numbers that still find no room stand below.
    """
    is_narrow = _width(max(map(_widest, column)) for column in _columns(grid)) > console.width
    for number, part in enumerate(_parts(grid, console.width) if is_narrow else [grid]):
        table = Table(title=None if number else Text(grid.title), box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
        for place, column in enumerate(_columns(part)):
            width = _least(column) if is_narrow and _are_numbers(column) else None
            table.add_column(Text(column[0]), justify="right" if place else "left", overflow="fold", width=width)
        for row in part.rows:
            table.add_row(*(Text(text) for text in row))  # Text: names in brackets are not markup
        console.print(table, crop=False)


def markdown_text(text: str) -> str:
    """A text that shows as it is in Markdown, also as a table's cell: on one line, without marks, HTML or links."""
    text = text.replace("\n", " ").replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return _MARKS.sub(r"\\\g<0>", text)


_MARKS = re.compile(r"[\\|`*~\[\]]|(?<![^\W_])_|_(?![^\W_])")
"""What means something to Markdown; an underscore within a word does not."""
_LEAST_NAME, _MOST_NUMBER = 8, 16
"""How many letters of a name stay side by side, and how many a number with its interval has."""


def _parts(grid: Grid, width: int) -> list[Grid]:
    """A table as several that are so wide or less, each with all names."""
    columns = _columns(grid)
    names = columns[: max((i + 1 for i, column in enumerate(columns) if not _are_numbers(column)), default=1)]
    parts = [names]
    for column in columns[len(names) :]:
        if len(parts[-1]) > len(names) and _width(map(_least, [*parts[-1], column])) > width:
            parts.append(names)
        parts[-1] = [*parts[-1], column]
    tables = ([*zip(*part, strict=True)] for part in parts)
    return [Grid(grid.title, headings, tuple(rows)) for headings, *rows in tables]


def _columns(grid: Grid) -> list[tuple[str, ...]]:
    """Each with its heading first."""
    return list(zip(grid.headings, *grid.rows, strict=True))


def _are_numbers(column: Sequence[str]) -> bool:
    known = [text for text in column[1:] if text != NOT_MEASURED]
    return all(_widest(text) <= _MOST_NUMBER and not any(map(str.isalpha, text)) for text in known)


def _least(column: Sequence[str]) -> int:
    """How wide a column is at least."""
    if _are_numbers(column):
        return max([*map(cell_len, column[0].split()), *map(_widest, column[1:])], default=0)
    return min(_LEAST_NAME, max(map(_widest, column)))


def _width(columns: Iterable[int]) -> int:
    """How wide a table is whose columns are so wide: there are two spaces between them, and one before the first."""
    return 1 + sum(width + 2 for width in columns)


def _widest(text: str) -> int:
    return max(map(cell_len, text.split("\n")))
