"""Run every benchmark, one after the other, and print the figures that are held against a peer or a limit.

`python benchmarks/run.py [DATASET]`, on an idle machine, takes about ten minutes; the dataset is read and replayed.
`python benchmarks/run.py --write-docs` measures nothing: it writes the stored figures into docs/PERFORMANCE.md.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import cached
import dataset
import env
import evaluator
import generation
import imports
import light
import questions
import raster
import thor
import workers
from machine import machine
from measure import QUIET_CORES, Benchmark, Stored, Table, number

from remqa_data.files import atomic_path

SCRIPTS = (raster, light, generation, workers, questions, dataset, evaluator, env, cached, thor, imports)
WITH_DATASET = (dataset, evaluator, cached)
DOCUMENT = Path("docs/PERFORMANCE.md")
BLOCK = re.compile(r"(<!-- figures: (\w+) -->\n).*?(<!-- end of figures -->)", re.DOTALL)


def main() -> None:
    """Measure, or write what was measured."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", nargs="?", help="folder of a finished dataset")
    parser.add_argument("--write-docs", action="store_true", help=f"only write {DOCUMENT} from the stored figures")
    arguments = parser.parse_args()
    if not arguments.write_docs:
        run_all(arguments.dataset)
    try:
        stored = {script.BENCHMARK: script.BENCHMARK.stored() for script in SCRIPTS}
        if arguments.write_docs:
            write_document(stored)
    except (FileNotFoundError, DocumentError) as error:
        parser.error(str(error))
    headline_table(stored).show()
    for benchmark, figures in stored.items():
        if figures.warning:
            print(f"{benchmark.name}: {figures.warning}")


class DocumentError(Exception):
    """Stored figures that do not belong into one document, or not into this one."""


def run_all(dataset_folder: str | None) -> None:
    """Run each script in a process of its own, so that none suffers from what another leaves in memory."""
    if (load := machine().load_average) > QUIET_CORES:
        print(f"The load average is {load}: this machine has other work to do, and figures will not be to be trusted.")
    for script in SCRIPTS:
        arguments = [dataset_folder] if dataset_folder and script in WITH_DATASET else []
        done = subprocess.run([sys.executable, str(script.__file__), *arguments])
        if done.returncode:
            sys.exit(done.returncode)


def headline_table(stored: Mapping[Benchmark, Stored]) -> Table:
    """Each figure beside what is asked."""
    rows = []
    for benchmark, figures in stored.items():
        for line in benchmark.headlines(figures.measured):
            margin = "" if line.margin is None else f"{line.margin:.2f}" + ("" if line.margin >= 1 else ", missed")
            rows.append((line.what, number(line.value), line.unit, line.asked, margin))
    return Table("Headline figures", ("what", "measured", "unit", "asked", "times better than asked"), rows)


def write_document(stored: Mapping[Benchmark, Stored]) -> None:
    """Replace the tables in the document.

    Raises
    ------
    DocumentError
        If figures are from several machines, or the document asks for a table that is not there.
    """
    tables = {benchmark.name: benchmark.table(figures.measured) for benchmark, figures in stored.items()}
    tables["headlines"] = headline_table(stored)
    tables["machine"] = machine_table(stored)

    def written(block: re.Match[str]) -> str:
        start, name, end = block.groups()
        if name not in tables:
            raise DocumentError(f"{DOCUMENT}: there is no table {name!r}; use one of {', '.join(tables)}")
        return f"{start}\n{tables[name].markdown()}\n\n{end}"

    text = BLOCK.sub(written, DOCUMENT.read_text(encoding="utf-8"))
    with atomic_path(DOCUMENT) as temporary:
        temporary.write_text(text, encoding="utf-8")


def machine_table(stored: Mapping[Benchmark, Stored]) -> Table:
    """The machine on which everything was measured, and how quiet it was."""
    machines = [figures.machine for figures in stored.values()]
    first = machines[0]
    for benchmark, figures in stored.items():
        if replace(figures.machine, commit=first.commit, load_average=first.load_average) != first:
            raise DocumentError(
                f"{benchmark.path} was measured on another machine or with other versions; run it again"
            )
    rows = (
        ("processor", f"{first.cpu}, {first.cores} cores"),
        ("memory", f"{first.memory_gb} GB"),
        ("system", first.system),
        ("software", ", ".join([f"Python {first.python}", *map(" ".join, first.packages.items())])),
        ("commit", ", ".join(dict.fromkeys(str(machine.commit) for machine in machines))),
        ("other work meanwhile, at most", f"{max(figures.other_cores for figures in stored.values())} cores"),
    )
    return Table("The machine", ("what", "which"), rows)


if __name__ == "__main__":
    main()
