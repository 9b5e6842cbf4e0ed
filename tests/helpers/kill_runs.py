"""Kills or interrupts `remqa-gen` again and again, and looks whether the dataset is the same in the end.

`python -m tests.helpers.kill_runs --strikes 50` strikes runs at random moments, now the driver and now a worker, goes on with
them, strikes again, and when one has come to its end compares all bytes with those of a run that nothing happened to. With
`--how interrupt` it presses Ctrl-C at the run's terminal, once or twice, or sends SIGTERM, and looks that every process is
gone and how soon. Rooms are made up in no time (see `crash_run`); with `--rooms real` they are bathrooms with few questions.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import psutil

from tests.helpers.damaged_files import files_of
from tests.helpers.terminal import PATIENCE_S, STOPPED, Terminal, at_terminal

HERE = Path(__file__).parent
PROGRAMS = {
    "made up": ["-m", "tests.helpers.crash_run"],
    "real": ["-c", "from remqa_data.commands import remqa_gen; remqa_gen()", "--config", str(HERE / "kill_runs.yaml")],
}
WORKERS = 2
STRUCK = (-signal.SIGKILL, -signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGINT, 128 + signal.SIGTERM)
"""Exit codes of what was struck."""


@dataclass(frozen=True)
class Strike:
    """What was done to a run, and how long that took to stop if it was told to."""

    what: str
    stopped_s: float | None = None


def run_command(out: Path, rooms: str = "made up", scenes: int = 24) -> list[str]:
    """What starts a run, or goes on with it."""
    arguments = ["--scenes", str(scenes), "--out", str(out), "--workers", str(WORKERS), "--resume"]
    return [sys.executable, *PROGRAMS[rooms], *arguments]


def start(out: Path, rooms: str = "made up", scenes: int = 24) -> subprocess.Popen[bytes]:
    """Start a run, or go on with it."""
    command = run_command(out, rooms, scenes)
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def kill_once(process: subprocess.Popen[bytes], after_s: float, rng: np.random.Generator) -> Strike | None:
    """Kill -9 the driver or a worker after some time; None if the run was over. With the driver its workers go."""
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        pass
    else:
        return None
    workers: list[psutil.Process] = []
    with suppress(psutil.Error):  # it may end at this moment
        workers = [p for p in psutil.Process(process.pid).children() if "resource_tracker" not in " ".join(p.cmdline())]
        if workers and rng.random() < 0.5:
            workers[int(rng.integers(len(workers)))].kill()
            return Strike("a worker")
    process.kill()
    process.wait()
    _, alive = psutil.wait_procs(workers, timeout=PATIENCE_S)
    assert not alive, f"left behind: {alive}"
    return Strike("the driver")


def interrupt_once(terminal: Terminal, after_s: float, rng: np.random.Generator) -> Strike | None:
    """Stop a run at its terminal after some time; None if the run was over."""
    begun = time.monotonic()
    terminal.read_until(lambda: terminal.process.poll() is not None or time.monotonic() > begun + after_s)
    if terminal.process.poll() is not None:
        return None
    how = ("Ctrl-C", "Ctrl-C twice", "SIGTERM")[int(rng.integers(3))]
    strike = terminal.process.terminate if how == "SIGTERM" else terminal.press_ctrl_c
    took_s = terminal.stop(*[strike] * (2 if how == "Ctrl-C twice" else 1))
    if "Traceback" in terminal.shown:
        told = f"NOT TOLD: {terminal.shown}"
    elif terminal.process.returncode < 0:
        told = "before the first or after the last of our own lines"
    else:
        told = (
            f"told after {terminal.told_s:.1f} s"
            if terminal.shown.count(STOPPED) == 1
            else f"NOT TOLD: {terminal.shown}"
        )
    load = os.getloadavg()[0]
    return Strike(f"{how} after {after_s:.1f} s, {told}, ended after {took_s:.1f} s, load {load:.1f}", took_s)


def strike_until_the_end(
    out: Path, asked: argparse.Namespace, within_s: float, rng: np.random.Generator
) -> list[Strike]:
    """Strike a run and go on with it, until it comes to its end before it is struck; what was done to it."""
    command, done = run_command(out, asked.rooms, asked.scenes), []
    while True:
        if asked.how == "kill":
            process = start(out, asked.rooms, asked.scenes)
            struck = kill_once(process, rng.uniform(0.0, within_s), rng)
            process.wait()
        else:
            terminal = at_terminal(command)
            process, struck = terminal.process, interrupt_once(terminal, rng.uniform(0.0, within_s), rng)
        if struck is not None:
            done.append(struck)
        if process.returncode == 0:
            return done
        assert process.returncode in STRUCK, f"exit code {process.returncode}"


def main() -> None:
    """Strike, go on, compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--strikes", type=int, default=50)
    parser.add_argument("--how", choices=["kill", "interrupt"], default="kill")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scenes", type=int, default=24)
    parser.add_argument("--rooms", choices=list(PROGRAMS), default="made up")
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        began = time.monotonic()
        assert start(whole, asked.rooms, asked.scenes).wait() == 0
        usual_s, expected = time.monotonic() - began, files_of(whole)
        print(f"a run takes {usual_s:.0f} s and writes {len(expected)} files", flush=True)
        strikes: list[Strike] = []
        runs, same = 0, 0
        while len(strikes) < asked.strikes:
            out = Path(folder) / str(runs)
            began = time.monotonic()
            done = strike_until_the_end(out, asked, usual_s, rng)
            if not done:  # the machine has become faster
                usual_s = time.monotonic() - began
            is_same = files_of(out) == expected
            strikes += done
            runs, same = runs + 1, same + is_same
            print(
                f"{'same' if is_same else 'OTHER'} bytes after {len(done)}: {'; '.join(strike.what for strike in done)}",
                flush=True,
            )
            if not is_same:
                os.rename(out, f"{tempfile.gettempdir()}/remqa-struck-{runs}")
        stopped_s = [strike.stopped_s for strike in strikes if strike.stopped_s is not None]
        if stopped_s:
            middle, most, last = np.quantile(stopped_s, [0.5, 0.95, 1.0])
            print(f"stopped after {middle:.1f} s (median), {most:.1f} s (95 %), {last:.1f} s at most")
        print(f"{len(strikes)} strikes in {runs} runs, of which {same} ended with the same bytes")
        sys.exit(same != runs)


if __name__ == "__main__":
    main()
