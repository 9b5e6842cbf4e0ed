"""What an import costs: fresh interpreters that import and end, beside one that only ends.

`python benchmarks/imports.py`, on an idle machine.
"""

from __future__ import annotations

import subprocess
import sys
from functools import partial

import numpy as np
from measure import Benchmark, Facts, Headline, Table, times_ms

BARE, PACKAGE = "pass", "import remqa_data"
CODES = (BARE, PACKAGE, "import remqa_data.cli", "import remqa_data.env", "from remqa_data import RemqaDataset")
ROUNDS = 9


def measure(arguments: list[str]) -> Facts:
    """Start an interpreter for each import in turns."""
    turns = [times_ms(partial(run, code) for code in CODES) for _ in range(ROUNDS)]
    return {"median_ms": dict(zip(CODES, np.median(turns, axis=0).tolist(), strict=True))}


def table(facts: Facts) -> Table:
    """All imports."""
    rows = [(f"python -c '{code}'", f"{ms:.0f}") for code, ms in facts["median_ms"].items()]
    return Table(f"Fresh interpreters, medians of {ROUNDS}", ("command", "ms"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """The package, from the start of the interpreter to its end."""
    ms = facts["median_ms"]
    return [
        Headline("import remqa_data, with the interpreter", ms[PACKAGE] / 1e3, "s", at_most=0.3),
        Headline("a bare interpreter", ms[BARE] / 1e3, "s"),
    ]


def run(code: str) -> None:
    """Run code in a fresh interpreter."""
    subprocess.run([sys.executable, "-c", code], check=True)


BENCHMARK = Benchmark("imports", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
