"""The examples run as they are written, on a small dataset."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

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
    done = subprocess.run(
        [sys.executable, str(path), str(two_rooms)],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert SAYS[path.stem] in done.stdout
    assert list(tmp_path.rglob("*.*")) or path.stem == "train_blind_and_seeing"
