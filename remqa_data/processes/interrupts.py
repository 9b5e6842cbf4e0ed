"""Ctrl-C and SIGTERM end a command at once, with a line that says so, and leave no process behind.

Python deals with a signal between two of its own instructions, and a compiler or an upload can be a minute between them.
So the system's handler also writes the signal's number to a pipe (`signal.set_wakeup_fd`), which a thread reads: it says
that the command stops, gives it a moment to clean up, and ends the process if that is too long or a second signal comes.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any

GRACE_S = 1.2
"""What a command has to clean up."""
_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_NO_SIGNAL = b"\0"
_SHOW_CURSOR = b"\x1b[?25h"
"""Progress bars hide it."""
_SHOWN_S = 0.2
"""A terminal of which this process is the leader, as in `docker run -t`, forgets what it has not shown when that ends."""


class PromptInterrupts:
    """Ctrl-C and SIGTERM raise a KeyboardInterrupt in the block; this process ends with it, or soon after if it goes on.

    The exit code is 128 and the number of the signal, as shells have it.

    Parameters
    ----------
    line : str
        What to say on stderr when it comes.

    Notes
    -----
    Signals that this process was started to ignore stay ignored. Outside of the main thread, where Python handles no
    signals, this does nothing.
    """

    def __init__(self, line: str) -> None:
        self._number: int | None = None
        self._line = line
        self._is_told, self._telling = False, threading.Lock()
        self._handlers: dict[int, Any] = {}

    def __enter__(self) -> PromptInterrupts:
        if threading.current_thread() is not threading.main_thread():
            return self
        self._reader, self._writer = socket.socketpair()
        self._writer.setblocking(False)  # as `set_wakeup_fd` wants it
        self._watcher = threading.Thread(target=self._watch, daemon=True)
        with suppress(RuntimeError):  # no more threads: then the first signal does what it can
            self._watcher.start()
        self._wakeup_fd = signal.set_wakeup_fd(self._writer.fileno(), warn_on_full_buffer=False)
        heard = [number for number in _SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]
        self._handlers = {number: signal.signal(number, self._interrupt) for number in heard}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._number is not None:
            self._tell()  # the block may have ended before the watcher came to it
            _end_process(128 + self._number)  # an orderly end of Python takes seconds on a busy machine
        if not self._handlers:
            return
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._wakeup_fd)
        if self._watcher.ident is not None:
            self._writer.send(_NO_SIGNAL)
            self._watcher.join()
        self._reader.close()
        self._writer.close()

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self._number is not None:
            return  # the first one is being dealt with
        self._number = number
        raise KeyboardInterrupt

    def _watch(self) -> None:
        number = self._next_signal()
        if number is None:
            return
        self._tell()
        self._reader.settimeout(GRACE_S)
        with suppress(TimeoutError):
            self._next_signal()
        _end_process(128 + number)

    def _tell(self) -> None:
        """Say the line, once; when this returns it is said."""
        with self._telling:
            if not self._is_told:
                self._is_told = True
                with suppress(OSError):
                    os.write(2, f"\n{self._line}\n".encode())

    def _next_signal(self) -> int | None:
        while True:
            data = self._reader.recv(1)
            if data in (_NO_SIGNAL, b""):
                return None
            if data[0] in _SIGNALS:
                return data[0]


@contextmanager
def handled_afterwards() -> Iterator[None]:
    """A signal that comes in this block is handled when it ends: what must not be left half done is done to its end.

    Where a signal is blocked for a thread, another thread may get it, and Python's handler still runs in the main thread.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[tuple[int, FrameType | None]] = []
    handlers = {number: handler for number in _SIGNALS if callable(handler := signal.getsignal(number))}
    for known in handlers:
        signal.signal(known, lambda *signalled: came.append(signalled))
    try:
        yield
    finally:
        for known, handler in handlers.items():
            signal.signal(known, handler)
        for number, frame in came:
            handlers[signal.Signals(number)](number, frame)


@contextmanager
def ends_the_process() -> Iterator[None]:
    """After this block nothing is left to be told: Ctrl-C ends the process while Python tidies up, which takes a moment."""
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, signal.SIG_DFL)


def _end_process(code: int) -> None:
    """End this process and all that it has started, without another word."""
    try:
        sys.stdout.flush()
        for child in multiprocessing.active_children():
            child.kill()
        if os.isatty(2):
            os.write(2, _SHOW_CURSOR)
            time.sleep(_SHOWN_S)
    finally:
        os._exit(code)
