"""Commands and runs of `crash_run` in processes that are forked from one that has imported all of it.

They are processes like others: they can be killed, have workers, which are forked too, and sit at a terminal if they are given
one. Only the imports are spared, which take three seconds in the driver and in each worker.
"""

from __future__ import annotations

import multiprocessing
import os
import runpy
import signal
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path

from remqa_data.processes import workers
from tests.helpers import crash_run
from tests.helpers.fork_server import FORK_SERVER

PATIENCE_S = 120.0


class ForkedRun:
    """A run that has begun; what tests use of `subprocess.Popen`.

    Parameters
    ----------
    arguments : str
        Of the command line.
    output : path
        The file that it prints to, or the terminal at which it sits.
    ignores_ctrl_c : bool
        Whether it is started to ignore it.
    environment : str
        Variables that differ from those of this process.
    """

    def __init__(self, *arguments: str, output: Path, ignores_ctrl_c: bool = False, **environment: str) -> None:
        self.output = output
        variables = {**os.environ, **environment}
        self._process = FORK_SERVER.Process(target=_run, args=(arguments, str(output), ignores_ctrl_c, variables))
        self._process.start()
        self.pid = self._process.pid

    @property
    def returncode(self) -> int | None:
        """As `subprocess.Popen` has it."""
        return self._process.exitcode

    def poll(self) -> int | None:
        """The exit code, if it has ended."""
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        """The exit code, when it has ended."""
        self._process.join(timeout)
        if self._process.exitcode is None:
            raise subprocess.TimeoutExpired("crash_run", timeout or 0.0)
        return self._process.exitcode

    def communicate(self, timeout: float | None = None) -> tuple[str, str]:
        """What it has printed when it has ended."""
        self.wait(timeout)
        return self.output.read_text(encoding="utf-8"), ""

    def kill(self) -> None:
        """Kill -9."""
        self._process.kill()

    def send_signal(self, number: int) -> None:
        """Unless it has ended."""
        if self._process.is_alive():
            os.kill(self._process.pid or 0, number)

    def terminate(self) -> None:
        """SIGTERM."""
        self.send_signal(signal.SIGTERM)


def run_forked(
    what: str, *arguments: str | bytes, folder: Path, **environment: str
) -> subprocess.CompletedProcess[str]:
    """What comes of the command whose `main` is in a module, or of a program by its path, in a folder."""
    with tempfile.TemporaryDirectory() as streams:
        process = FORK_SERVER.Process(target=_run_main, args=(what, arguments, str(folder), streams, environment))
        process.start()
        process.join(PATIENCE_S)
        assert process.exitcode is not None, "it does not end"
        out, err = (Path(streams, name).read_text(encoding="utf-8") for name in ("1", "2"))
    return subprocess.CompletedProcess(arguments, process.exitcode, out, err)


def _run_main(
    what: str, arguments: tuple[str | bytes, ...], folder: str, streams: str, environment: dict[str, str]
) -> None:
    os.chdir(folder)
    os.environ.update(environment)
    for standard in (1, 2):
        os.dup2(os.open(f"{streams}/{standard}", os.O_WRONLY | os.O_CREAT), standard)
    sys.argv = ["command", *map(os.fsdecode, arguments)]
    if what.endswith(".py"):
        runpy.run_path(what, run_name="__main__")
    else:
        import_module(what).main()


def _run(arguments: tuple[str, ...], output: str, ignores_ctrl_c: bool, variables: dict[str, str]) -> None:
    os.setsid()
    ours = os.open(output, os.O_RDWR | os.O_CREAT | os.O_APPEND)  # a terminal becomes that of this session
    for standard in (0, 1, 2):
        os.dup2(ours, standard)
    os.environ.clear()
    os.environ.update(variables)
    signal.signal(signal.SIGINT, signal.SIG_IGN if ignores_ctrl_c else signal.default_int_handler)
    workers._CONTEXT = multiprocessing.get_context("fork")  # type: ignore[assignment]
    os.fsync = os.fstat  # type: ignore[assignment]  # a process is killed, but the power is not cut
    sys.argv = ["remqa-gen", *arguments]
    crash_run.main()
