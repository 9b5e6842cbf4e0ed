"""The examples run as they are written, on a small dataset."""

from pathlib import Path

import pytest

from tests.helpers.forked_runs import run_forked

EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.py"))
SAYS = {
    "load_and_plot": "questions",
    "own_rooms": "the mug came to rest",
    "random_agent_film": "film",
    "submit_and_read_the_report": "report.html",
    "train_blind_and_seeing": "seeing",
}


def test_each_example_is_known() -> None:
    assert {path.stem for path in EXAMPLES} == set(SAYS)


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, two_rooms: Path, tmp_path: Path) -> None:
    done = run_forked(str(path), str(two_rooms), folder=tmp_path, MPLBACKEND="agg")
    assert done.returncode == 0, done.stderr
    assert SAYS[path.stem] in done.stdout
    assert list(tmp_path.rglob("*.*")) or path.stem == "train_blind_and_seeing"
