import doctest
import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))

import generation
import machine
import measure
import run
from measure import Benchmark, Headline, Stored, Table

DOCUMENT = """# Speed
<!-- figures: speed -->
old
<!-- end of figures -->
prose
<!-- figures: headlines -->
<!-- end of figures -->
"""


def benchmark(name: str = "speed") -> Benchmark:
    return Benchmark(
        name,
        lambda arguments: {"ms": 2.0},
        lambda facts: Table("Speed", ("what", "ms"), [("a frame", str(facts["ms"]))]),
        lambda facts: [
            Headline("a frame", facts["ms"], "ms", at_most=1.0),
            Headline("steps", 250.0, "/s", at_least=100),
        ],
    )


def stored(other_cores: float = 0.0) -> Stored:
    return Stored(machine.machine(), other_cores, {"ms": 2.0})


def test_the_document_gets_tables_between_its_markers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "DOCUMENT", tmp_path / "PERFORMANCE.md")
    run.DOCUMENT.write_text(DOCUMENT)
    run.write_document({benchmark(): stored()})
    text = run.DOCUMENT.read_text()
    assert "| a frame | 2.0 |" in text
    assert "| a frame | 2 | ms | at most 1 | 0.50, missed |" in text
    assert "| steps | 250 | /s | at least 100 | 2.50 |" in text
    assert "old" not in text
    assert "prose" in text
    run.write_document({benchmark(): stored()})
    assert run.DOCUMENT.read_text() == text


def test_figures_of_several_machines_and_unknown_tables_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "DOCUMENT", tmp_path / "PERFORMANCE.md")
    run.DOCUMENT.write_text(DOCUMENT)
    other = replace(stored(), machine=replace(machine.machine(), cpu="another"))
    with pytest.raises(run.DocumentError, match="another machine"):
        run.write_document({benchmark(): stored(), benchmark("more"): other})
    run.DOCUMENT.write_text(DOCUMENT.replace("figures: speed", "figures: nothing"))
    with pytest.raises(run.DocumentError, match="no table 'nothing'"):
        run.write_document({benchmark(): stored()})
    assert "old" in run.DOCUMENT.read_text()


def test_figures_taken_beside_other_work_are_not_to_be_trusted() -> None:
    assert "do not trust" in stored(0.8).warning
    assert not stored(0.2).warning


def test_examples() -> None:
    assert doctest.testmod(measure).failed == 0


def test_the_document_asks_for_all_tables_and_no_others() -> None:
    asked = set(run.BLOCK.findall(Path(run.__file__).parents[1].joinpath(run.DOCUMENT).read_text()))
    names = {name for _, name, _ in asked}
    assert names == {script.BENCHMARK.name for script in run.SCRIPTS} | {"headlines", "machine"}


def test_every_step_of_generation_that_is_timed_is_there() -> None:
    assert len(generation.STEPS) > 10
    assert all(callable(getattr(owner, name)) for _, owner, name in generation.STEPS)
