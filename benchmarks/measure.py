"""What a benchmark is: something to measure, a table of it, and the few figures that are held against a peer or a limit.

Each benchmark is a script of this folder that prints its table and stores its figures in out/benchmarks/NAME.json, as
{"machine": ..., "other_cores": ..., "measured": ...}. `run.py` runs them all.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import rich.table
from machine import Machine, OtherWork, machine
from rich.console import Console

from remqa_data.files import CACHE_VARIABLE, atomic_path

OUTPUT = Path("out/benchmarks")
QUIET_CORES = 0.5
"""Figures are not to be trusted if other work keeps more cores busy."""

Facts = dict[str, Any]
"""What JSON can hold."""


@contextmanager
def nothing_cached() -> Iterator[None]:
    """As on a machine on which no room has been lit; what is lit here is forgotten in the end."""
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, {CACHE_VARIABLE: folder}):
        yield


@dataclass(frozen=True)
class Table:
    """Rows of text; the first column says what, the others hold figures."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]

    def show(self) -> None:
        """Print it."""
        table = rich.table.Table(title=self.title)
        for number, heading in enumerate(self.headings):
            table.add_column(heading, justify="right" if number else "left")
        for row in self.rows:
            table.add_row(*row)
        Console(width=None if sys.stdout.isatty() else 120).print(table)

    def markdown(self) -> str:
        """The same for a document."""
        lines = [self.headings, ["---"] + ["---:"] * (len(self.headings) - 1), *self.rows]
        return "\n".join([f"{self.title}:", "", *(f"| {' | '.join(line)} |" for line in lines)])


@dataclass(frozen=True)
class Headline:
    """A figure that is held against a peer, a limit, or both."""

    what: str
    value: float
    unit: str
    at_least: float | None = None
    at_most: float | None = None

    @property
    def asked(self) -> str:
        """The limit, in words."""
        if self.at_least is not None:
            return f"at least {number(self.at_least)}"
        return "" if self.at_most is None else f"at most {number(self.at_most)}"

    @property
    def margin(self) -> float | None:
        """How many times better than the limit: below 1 it is missed."""
        if self.at_least is not None:
            return self.value / self.at_least
        return None if self.at_most is None else self.at_most / self.value


@dataclass(frozen=True)
class Benchmark:
    """One script of this folder."""

    name: str
    measure: Callable[[list[str]], Facts]
    """Takes the arguments of the command line."""
    table: Callable[[Facts], Table]
    headlines: Callable[[Facts], list[Headline]]

    def main(self) -> None:
        """Measure, store, and print the table."""
        where, other_work = machine(), OtherWork()
        facts = self.measure(sys.argv[1:])
        stored = Stored(where, round(other_work.cores(), 2), facts)
        with atomic_path(self.path) as temporary:
            temporary.write_text(json.dumps(asdict(stored), indent=1) + "\n", encoding="utf-8")
        self.table(facts).show()
        if stored.warning:
            print(f"{self.name}: {stored.warning}")

    def stored(self) -> Stored:
        """What was measured last.

        Raises
        ------
        FileNotFoundError
            If nothing was.
        """
        if not self.path.is_file():
            raise FileNotFoundError(f"{self.path} is not there; run python benchmarks/{self.name}.py first")
        content = json.loads(self.path.read_text(encoding="utf-8"))
        return Stored(Machine(**content["machine"]), content["other_cores"], content["measured"])

    @property
    def path(self) -> Path:
        """Where its figures are stored."""
        return OUTPUT / f"{self.name}.json"


@dataclass(frozen=True)
class Stored:
    """Figures, and how they came about."""

    machine: Machine
    other_cores: float
    """How many cores other work kept busy meanwhile, on average."""
    measured: Facts

    @property
    def warning(self) -> str:
        """Why the figures are not to be trusted, if they are not."""
        if self.other_cores <= QUIET_CORES:
            return ""
        return f"other work kept {self.other_cores} cores busy meanwhile: do not trust these figures"


def number(value: float) -> str:
    """Three digits, or more before the point.

    >>> number(8626.6), number(213.67), number(3.9219), number(0.0496)
    ('8,627', '214', '3.92', '0.0496')
    """
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def times_ms(calls: Iterable[Callable[[], object]]) -> list[float]:
    """Milliseconds that each call takes."""
    times = []
    for call in calls:
        start = time.perf_counter()
        call()
        times.append(1e3 * (time.perf_counter() - start))
    return times


def median_ms(calls: Iterable[Callable[[], object]]) -> float:
    """Their median."""
    return float(np.median(times_ms(calls)))
