"""Ctrl-C on a terminal of its own, and SIGTERM: one line, at most 2 s, no process left, and `--resume` goes on.

The runs are `remqa-gen` with rooms that are made up (see `crash_run`): programs of their own where it matters how they
start, else processes that are forked from one that has imported everything.
"""

import shutil
import signal
import sys
import time
from functools import partial
from pathlib import Path

import psutil
import pytest

from tests.helpers.crash_run import SCENES, parts_in, run_here
from tests.helpers.damaged_files import files_of
from tests.helpers.terminal import Terminal, at_terminal, forked_at_terminal

pytestmark = [pytest.mark.slow, pytest.mark.skipif(shutil.which("setsid") is None, reason="needs a pseudo-terminal")]

PROGRAM = "tests.helpers.crash_run"
STOP_S = 4.0
"""Twice what is promised: other tests run at the same time."""
LINE = "remqa-gen: stopped; the rooms that are finished are kept, go on with --resume"


def words(out: Path, *options: str, workers: int = 2) -> list[str]:
    return ["--scenes", str(SCENES), "--out", str(out), "--workers", str(workers), *options]


def program(out: Path, **environment: str) -> Terminal:
    return at_terminal([sys.executable, "-m", PROGRAM, *words(out)], **environment)


def forked(out: Path, workers: int = 2, ignores_ctrl_c: bool = False, **environment: str) -> Terminal:
    return forked_at_terminal(*words(out, workers=workers), ignores_ctrl_c=ignores_ctrl_c, **environment)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset that nothing happened to."""
    out = tmp_path_factory.mktemp("whole") / "out"
    code, text = run_here(out, scenes=SCENES)
    assert code == 0, text
    return out


@pytest.mark.parametrize("how", ["once", "twice", "terminated"])
def test_a_run_stops_at_once_says_so_and_goes_on(whole: Path, tmp_path: Path, how: str) -> None:
    out = tmp_path / "out"
    start = {"once": partial(forked, workers=1), "twice": program, "terminated": forked}[how]
    terminal = start(out, CRASH_ROOM_S="0.5")
    terminal.read_until(lambda: len(parts_in(out)) >= 2)
    strikes = {
        "once": [terminal.press_ctrl_c],
        "twice": [terminal.press_ctrl_c] * 2,
        "terminated": [lambda: terminal.process.send_signal(signal.SIGTERM)],
    }[how]
    assert terminal.stop(*strikes) < STOP_S
    assert terminal.process.returncode == 128 + (signal.SIGTERM if how == "terminated" else signal.SIGINT)
    assert terminal.shown.count(LINE) == 1
    assert "Traceback" not in terminal.shown
    assert 2 <= len(parts_in(out)) < SCENES
    assert run_here(out, "--resume", scenes=SCENES)[0] == 0
    assert files_of(out) == files_of(whole)


@pytest.mark.parametrize("workers", [1, 2])
def test_what_cannot_be_interrupted_is_ended(tmp_path: Path, workers: int) -> None:
    terminal = forked(tmp_path / "out", workers=workers, CRASH_STUCK="1")
    terminal.read_until(lambda: terminal.shown.count("stuck") == workers)
    assert terminal.stop(terminal.press_ctrl_c) < STOP_S
    assert terminal.process.returncode == 128 + signal.SIGINT
    assert LINE in terminal.shown


@pytest.mark.parametrize("after_s", [0.0, 0.3])
def test_a_run_that_is_starting_its_workers_stops(tmp_path: Path, after_s: float) -> None:
    out = tmp_path / "out"
    terminal = program(out, CRASH_ROOM_S="0.5")
    terminal.read_until(lambda: len(psutil.Process(terminal.process.pid).children()) > 0)
    time.sleep(after_s)
    assert terminal.stop(terminal.press_ctrl_c) < STOP_S
    assert LINE in terminal.shown
    assert "Traceback" not in terminal.shown


def test_a_command_that_is_being_imported_stops(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text(
        "import time\nprint('importing', flush=True)\ntime.sleep(60)\n", encoding="utf-8"
    )
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from remqa_data.commands import remqa_gen; remqa_gen()"
    terminal = at_terminal([sys.executable, "-c", code])
    terminal.read_until(lambda: "importing" in terminal.shown)
    assert terminal.stop(terminal.press_ctrl_c) < STOP_S
    assert terminal.process.returncode == 128 + signal.SIGINT
    assert "remqa-gen: stopped" in terminal.shown
    assert "Traceback" not in terminal.shown


def test_a_command_that_has_done_its_work_ends_at_once(tmp_path: Path) -> None:
    tidy = "import atexit, time; atexit.register(lambda: (print('tidying', flush=True), time.sleep(60)))"
    code = f"{tidy}; from remqa_data.commands import remqa_gen; remqa_gen()"
    terminal = at_terminal([sys.executable, "-c", code, "--version"])
    terminal.read_until(lambda: "tidying" in terminal.shown)
    assert terminal.stop(terminal.press_ctrl_c) < STOP_S
    assert terminal.process.returncode == -signal.SIGINT
    assert "Traceback" not in terminal.shown


def test_a_run_whose_merging_is_interrupted_leaves_no_half_shard(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    terminal = forked(out, CRASH_ROOM_S="0")
    terminal.read_until(lambda: any(out.glob("*/train-*")))
    terminal.stop(terminal.press_ctrl_c)
    assert {path.name for path in out.glob("*/[!.]*.parquet")} <= {path.name for path in whole.glob("*/*.parquet")}
    assert run_here(out, "--resume", scenes=SCENES)[0] == 0
    assert files_of(out) == files_of(whole)


def test_a_run_that_was_started_to_ignore_ctrl_c_does(tmp_path: Path) -> None:
    """As `nohup` and shells do for commands in the background."""
    terminal = forked(tmp_path / "out", ignores_ctrl_c=True, CRASH_ROOM_S="0.1")
    terminal.read_until(lambda: "generating" in terminal.shown or terminal.process.poll() is not None)
    terminal.press_ctrl_c()
    terminal.read_until(lambda: terminal.process.poll() is not None)
    assert terminal.process.returncode == 0
    assert LINE not in terminal.shown
