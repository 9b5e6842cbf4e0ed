"""Rooms a minute of `remqa-gen` with one worker and with two: the whole command, as it is typed.

`python benchmarks/workers.py [SCENES]`, on an idle machine with two cores. With few rooms the end weighs more: the worker
that is done first waits for the other.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measure import Benchmark, Facts, Headline, Table, nothing_cached

COMMAND = Path(sys.executable).with_name("remqa-gen")
SCENES, ALL_SCENES, WORKERS = 12, 120, (1, 2)


def measure(arguments: list[str]) -> Facts:
    """Time the command with each number of workers."""
    scenes = int(arguments[0]) if arguments else SCENES
    generate(1, 1)  # compiles what is not compiled yet
    return {"scenes": scenes, "runs": {str(workers): generate(scenes, workers) for workers in WORKERS}}


def table(facts: Facts) -> Table:
    """By the number of workers."""
    rows = [
        (
            workers,
            f"{run['seconds']:.0f}",
            f"{60 * facts['scenes'] / run['seconds']:.1f}",
            f"{run['core_seconds']:.0f}",
            f"{100 * run['core_seconds'] / run['seconds'] / int(workers):.0f} %",
        )
        for workers, run in facts["runs"].items()
    ]
    headings = ("workers", "s", "rooms per minute", "s of a core", "cores in use")
    return Table(f"remqa-gen --scenes {facts['scenes']}", headings, rows)


def headlines(facts: Facts) -> list[Headline]:
    """Rooms a minute, and what the second worker brings."""
    one, two = (facts["runs"][str(workers)]["seconds"] for workers in WORKERS)
    minutes = two / 60 * ALL_SCENES / facts["scenes"]
    return [
        Headline(f"remqa-gen --scenes {facts['scenes']}, 1 worker", 60 * facts["scenes"] / one, "rooms/min"),
        Headline(f"remqa-gen --scenes {facts['scenes']}, 2 workers", 60 * facts["scenes"] / two, "rooms/min"),
        Headline("2 workers", one / two, "x 1 worker", at_least=1.8),
        Headline(f"{ALL_SCENES} rooms at the pace of 2 workers", minutes, "min", at_most=8),
    ]


def generate(scenes: int, workers: int) -> dict[str, float]:
    """Seconds of the command, and of the cores that it used."""
    with tempfile.TemporaryDirectory() as folder, nothing_cached():
        command = [str(COMMAND), "--scenes", str(scenes), "--workers", str(workers), "--out", f"{folder}/out"]
        core_seconds, start = children_s(), time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # its progress is shown
        return {"seconds": time.perf_counter() - start, "core_seconds": children_s() - core_seconds}


def children_s() -> float:
    """Time of a core that ended child processes, and theirs, have used."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


BENCHMARK = Benchmark("workers", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
