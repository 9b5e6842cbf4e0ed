"""A dataset in numbers, for a page: the paper's table beside ours, histograms, and how far answers can be guessed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from remqa_data.errors import ConfigError, ProgramError, one_line
from remqa_data.generators.audit.recount.report import Figure
from remqa_data.generators.audit.recount.wording import relation_of
from remqa_data.generators.figures.question_statistics import statistics_of
from remqa_data.language.stored import stored_program

MOST_BARS = 24
STEP_M = 1.0


@dataclass(frozen=True)
class Bar:
    """A bar of a histogram, with its share of the longest."""

    name: str
    count: int
    share: float


@dataclass(frozen=True)
class Histogram:
    """Bars under one another.

    Attributes
    ----------
    title : str
    bars : tuple of Bar
    left_out : int
        How many more there are.
    """

    title: str
    bars: tuple[Bar, ...]
    left_out: int


@dataclass(frozen=True)
class StatisticsPage:
    """All that the page shows."""

    headings: tuple[str, ...]
    table: tuple[tuple[str, ...], ...]
    histograms: tuple[Histogram, ...]
    audit: tuple[Figure, ...]


def statistics_page(questions: pd.DataFrame, splits: Sequence[str], audit: tuple[Figure, ...]) -> StatisticsPage:
    """Count what the page shows.

    Parameters
    ----------
    questions : pandas.DataFrame
        All questions, with the columns of `dataset.INDEX`.
    splits : sequence of str
        In the order of the table.
    audit : tuple of Figure
        See `read_audit`.
    """
    table = statistics_of(questions, splits).reset_index()
    rows = tuple(tuple(_text(value) for value in row) for row in table.itertuples(index=False))
    headings = tuple(str(name).replace("_", " ") for name in table.columns)
    return StatisticsPage(headings, rows, tuple(_histograms(questions)), audit)


def read_audit(path: Path) -> tuple[Figure, ...]:
    """What `remqa-data recount DIR --csv FILE` has written.

    Raises
    ------
    ConfigError
        If it is no such file.
    """
    try:
        table = pd.read_csv(path, keep_default_na=False, compression=None)
        if tuple(table.columns) != Figure._fields:
            raise ValueError(f"its columns are not {', '.join(Figure._fields)}")
        rows = [
            (str(what), str(asked), float(value), str(holds) == "True") for what, asked, value, holds in table.values
        ]
    except (ValueError, UnicodeDecodeError) as error:
        msg = f"{path}: {one_line(error)}; write it with: remqa-data recount DIR --csv {path.name}"
        raise ConfigError(msg) from None
    return tuple(Figure(*row) for row in rows)


def _histograms(questions: pd.DataFrame) -> Iterable[Histogram]:
    words = questions["question"].map(lambda text: len(text.split()))
    for kind in questions["kind"].unique():
        yield _numbers(f"Words of a question, {kind}", words[questions["kind"] == kind])
    for kind in questions["kind"].unique():
        yield _names(f"Answers, {kind}", questions.loc[questions["kind"] == kind, "answer"])
    relations = questions["program"].map(_relation)
    yield _names("Relations asked about", relations[relations != ""])
    yield _names("What must be done", questions["manipulation"])
    yield _numbers("Whole metres of the stored way", (questions["path_length_m"] // STEP_M).astype(int), STEP_M)
    yield _numbers("Steps of the stored way, in tens", questions["path_steps"] // 10 * 10, 10)
    yield _names("Types asked for", questions["answer_type"])
    yield _names("Types acted on", questions["target_type"])
    yield _names("Room types", questions["room_type"])
    yield _numbers("Questions of a room, in tens", questions.groupby("scene").size() // 10 * 10, 10)


def _relation(program: str) -> str:
    try:
        return relation_of(stored_program(program))
    except ProgramError:
        return ""


def _names(title: str, values: pd.Series) -> Histogram:
    """The most frequent first."""
    counts = sorted(Counter(values).items(), key=lambda item: (-item[1], str(item[0])))
    return _histogram(title, [(str(name), count) for name, count in counts[:MOST_BARS]], len(counts))


def _numbers(title: str, values: pd.Series, step: float = 1) -> Histogram:
    """In order, with what lies between and does not occur."""
    counts = Counter(int(value) for value in values)
    if not counts:
        return Histogram(title, (), 0)
    every = range(min(counts), max(counts) + 1, int(step))
    shown = [(f"{n}–{n + int(step)}" if step > 1 else str(n), counts[n]) for n in every[:MOST_BARS]]
    return _histogram(title, shown, len(every))


def _histogram(title: str, shown: Sequence[tuple[str, int]], bars: int) -> Histogram:
    most = max((count for _, count in shown), default=1) or 1
    return Histogram(title, tuple(Bar(name, count, count / most) for name, count in shown), bars - len(shown))


def _text(value: object) -> str:
    if value is None or value is pd.NA or value != value:
        return "–"
    return f"{value:.10g}" if isinstance(value, float) else str(value)
