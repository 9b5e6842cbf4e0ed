"""Kills `remqa-gen` again and again, and looks whether the dataset is the same in the end.

`python -m tests.helpers.kill_runs --kills 50` starts so many runs of 24 rooms, kills each once at a random moment, now its
driver and now a worker, goes on with it, and compares all bytes with those of a run that nothing happened to. Rooms are made
up in no time (see `crash_run`); with `--rooms real` they are bathrooms with few questions, and 50 kills take half an hour.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil

from remqa_data.storage.manifest import load_manifest
from tests.helpers.damaged_files import files_of

HERE = Path(__file__).parent
PROGRAMS = {
    "made up": ["-m", "tests.helpers.crash_run"],
    "real": ["-c", "from remqa_data.generators.cli import main; main()", "--config", str(HERE / "kill_runs.yaml")],
}
WORKERS = 2


def start(out: Path, rooms: str = "made up", scenes: int = 24) -> subprocess.Popen[bytes]:
    """Start a run, or go on with it."""
    command = [sys.executable, *PROGRAMS[rooms], "--scenes", str(scenes), "--out", str(out), "--workers", str(WORKERS)]
    return subprocess.Popen([*command, "--resume"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def kill_once(process: subprocess.Popen[bytes], after_s: float, rng: np.random.Generator) -> str:
    """Kill -9 the driver or a worker after some time; says which, or that the run was over."""
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        pass
    else:
        return "nothing"
    with suppress(psutil.Error):  # it may end at this moment
        workers = [p for p in psutil.Process(process.pid).children() if "spawn_main" in " ".join(p.cmdline())]
        if workers and rng.random() < 0.5:
            workers[int(rng.integers(len(workers)))].kill()
            return "a worker"
    process.kill()
    process.wait()
    return "the driver"


def finish(out: Path, process: subprocess.Popen[bytes], rooms: str = "made up") -> int:
    """Let a run end, and go on with it if its driver was killed; the exit code of the last start."""
    return process.wait() if process.poll() != -9 else start(out, rooms).wait()


def main() -> None:
    """Kill, go on, compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--rooms", choices=list(PROGRAMS), default="made up")
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        began = time.monotonic()
        assert start(whole, asked.rooms).wait() == 0
        usual_s, expected = time.monotonic() - began, files_of(whole)
        assert len(load_manifest(whole).files) >= 4
        same = struck = 0
        number = 0
        while struck < asked.kills:
            number += 1
            out = Path(folder) / str(number)
            process = start(out, asked.rooms)
            after_s = rng.uniform(0.0, 0.8 * usual_s)
            killed = kill_once(process, after_s, rng)
            is_same = finish(out, process, asked.rooms) == 0 and files_of(out) == expected
            struck, same = struck + (killed != "nothing"), same + is_same
            print(
                f"{number}: killed {killed} after {after_s:.1f} s: {'same' if is_same else 'OTHER'} bytes", flush=True
            )
            if not is_same:
                os.rename(out, f"{tempfile.gettempdir()}/remqa-killed-{number}")
        print(f"{struck} kills in {number} runs, of which {same} ended with the same bytes")
        sys.exit(same != number)


if __name__ == "__main__":
    main()
