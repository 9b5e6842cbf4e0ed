"""A command at a terminal of its own, and what happens when Ctrl-C is pressed there."""

from __future__ import annotations

import math
import os
import pty
import select
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

from tests.helpers.forked_runs import ForkedRun

ROOT = Path(__file__).parents[2]
PATIENCE_S = 600.0
CTRL_C = b"\x03"
STOPPED = ": stopped"


@dataclass
class Terminal:
    """A command, the other end of its terminal, and what it has shown there; how soon it said that it stops."""

    process: subprocess.Popen[bytes] | ForkedRun
    end: int
    shown: str = ""
    told_s: float = math.inf

    def press_ctrl_c(self) -> None:
        os.write(self.end, CTRL_C)

    def read_until(self, condition: Callable[[], bool], patience_s: float = PATIENCE_S) -> None:
        begun = time.monotonic()
        while not condition():
            assert time.monotonic() < begun + patience_s, f"it did not happen; shown: {self.shown}"
            if select.select([self.end], [], [], 0.02)[0]:
                try:
                    self.shown += os.read(self.end, 65536).decode(errors="replace")
                except OSError:  # nobody is there any more
                    time.sleep(0.02)

    def stop(self, *strikes: Callable[[], None], apart_s: float = 0.1) -> float:
        """Strike, and wait for the end of the command and all its children; seconds from the first strike on."""
        family = []
        with suppress(psutil.NoSuchProcess):  # it may end at this moment
            me = psutil.Process(self.process.pid)
            family = [me, *me.children(recursive=True)]
        begun = time.monotonic()
        for strike in strikes:
            strike()
            time.sleep(apart_s)
        self.read_until(lambda: STOPPED in self.shown or self.process.poll() is not None)
        if STOPPED in self.shown:
            self.told_s = time.monotonic() - begun
        self.read_until(lambda: self.process.poll() is not None)
        self.read_until(lambda: all(_has_ended(process) for process in family))
        return time.monotonic() - begun - apart_s * (len(strikes) - 1)


def _has_ended(process: psutil.Process) -> bool:
    """Whether a process has ended; that the system's first process has not yet heard of it is not its fault."""
    try:
        return process.status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def at_terminal(command: Sequence[str], *, ignores_ctrl_c: bool = False, **environment: str) -> Terminal:
    """Start a command at a terminal of its own.

    It heeds Ctrl-C wherever this runs: what scripts run in the background ignores it, and so do its children.
    """
    handler = signal.SIG_IGN if ignores_ctrl_c else signal.SIG_DFL
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        ["setsid", "--ctty", *command],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        cwd=ROOT,
        env={**os.environ, **environment},
        preexec_fn=lambda: signal.signal(signal.SIGINT, handler),
    )
    os.close(theirs)
    return Terminal(process, ours)


def forked_at_terminal(*arguments: str, ignores_ctrl_c: bool = False, **environment: str) -> Terminal:
    """The same for a run with rooms that are made up, without its imports."""
    ours, theirs = pty.openpty()
    process = ForkedRun(*arguments, output=Path(os.ttyname(theirs)), ignores_ctrl_c=ignores_ctrl_c, **environment)
    os.close(theirs)
    return Terminal(process, ours)
