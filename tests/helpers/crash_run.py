"""`remqa-gen` with rooms that are made up in no time, for tests that kill it: everything else is as it is.

Run as a program, or in this process with `run_here`. $CRASH_ROOM_S is how long a room takes; with $CRASH_ALWAYS, every
worker dies in its first room; with $CRASH_STUCK, a room is minutes in a function that is not Python's, as a compiler is.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from remqa_data.generators import cli
from remqa_data.generators.pipeline import RoomJob, make_part
from remqa_data.processes import executors
from remqa_data.processes.executors import J, LocalExecutor, R
from remqa_data.storage.parts import Part
from tests.helpers.dataset_rows import scene_rows
from tests.helpers.executor_jobs import die

SCENES = 12


class MadeUpRooms(LocalExecutor):
    """Does all jobs as they are, but for rooms."""

    def run(self, work: Callable[[J], R], jobs: Sequence[J]) -> Iterator[tuple[J, R]]:
        if work is make_part and os.environ.get("CRASH_ALWAYS"):
            return super().run(die, range(len(jobs)))  # type: ignore[arg-type, return-value]
        return super().run(made_up_part if work is make_part else work, jobs)  # type: ignore[arg-type]


def made_up_part(job: RoomJob) -> Part:
    if os.environ.get("CRASH_STUCK"):
        print("stuck", file=sys.stderr, flush=True)
        hashlib.pbkdf2_hmac("sha256", b"", b"", 10**9)
    time.sleep(float(os.environ.get("CRASH_ROOM_S", "0.05")))
    rows = scene_rows(job.room.scene, job.room.quota.split)
    report = {"questions": len(rows["questions"]), "frames": len(rows["frames"]), "refused": {"made up": 1}}
    return job.write(rows, report)


def run_here(out: Path, *options: str, workers: int = 1, scenes: int = SCENES) -> tuple[int, str]:
    """Exit code of a run in this process, in which rooms take no time, and all that it printed."""
    import pytest
    from typer.testing import CliRunner

    arguments = ["--scenes", str(scenes), "--out", str(out), "--workers", str(workers), *options]
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(executors, "make_executor", lambda name, workers, address: MadeUpRooms(workers))
        monkeypatch.setenv("CRASH_ROOM_S", "0")
        result = CliRunner().invoke(cli.app, arguments)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


def parts_in(out: Path) -> list[Path]:
    """The notes of the rooms that are finished and not merged yet."""
    return sorted(out.glob(".parts/*/*/part.json"))


def main() -> None:
    executors.make_executor = lambda name, workers, address: MadeUpRooms(workers)
    cli.main()


if __name__ == "__main__":
    main()
