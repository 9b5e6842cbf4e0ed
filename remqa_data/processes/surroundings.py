"""What a command is given to run in: streams, rights to what it writes, address space, threads, arguments."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress

LEAST_ADDRESS_SPACE = 3 << 30
"""What compilers and threads of libraries take, though most of it is never used: with less they hang or crash."""
LEAST_THREADS = 32
"""What libraries start on a few cores. With less, pyarrow waits for ever for a thread that it could not start, and OpenBLAS
sends its own process the signal of Ctrl-C."""


def open_standard_streams() -> None:
    """Where a standard stream is closed, as by `2>&-`, open it on nothing.

    Otherwise the next file that is opened gets its number, and whatever is said to the stream goes into that file.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the least number that is free, which is this one
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))


def turn_outputs_away() -> None:
    """Let what is still written to the standard output streams go nowhere: as Python ends, it flushes them, and complains."""
    with suppress(OSError), open(os.devnull, "wb") as nothing:  # a stream that is no file stays
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nothing.fileno(), stream.fileno())


def surroundings_problem(arguments: Sequence[str]) -> str | None:
    """What is wrong, if nothing can come of a command here: one line that says what to do."""
    return umask_problem() or address_space_problem() or thread_problem() or name_problem(arguments)


def umask_problem() -> str | None:
    """What is wrong if this user may not read, write and enter what this process makes, compiled modules too."""
    umask = os.umask(0o077)  # only setting it tells
    os.umask(umask)
    if not umask & 0o700:
        return None
    return f"the umask {umask:03o} takes away your own rights to what is written; use another one (umask 022)"


def address_space_problem() -> str | None:
    """What is wrong if the system lets this process have too little room."""
    try:
        import resource
    except ImportError:  # not on Windows
        return None
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY or limit >= LEAST_ADDRESS_SPACE:
        return None
    return f"the address space is limited to {limit >> 20} MB (ulimit -v); at least {LEAST_ADDRESS_SPACE >> 20} MB are needed"


def thread_problem() -> str | None:
    """What is wrong if the system lets this process start too few threads, which only trying tells."""
    started, end = [], threading.Event()
    try:
        for _ in range(LEAST_THREADS):
            thread = threading.Thread(target=end.wait, daemon=True)
            thread.start()
            started.append(thread)
    except RuntimeError:
        return f"the system starts only {len(started)} more threads (ulimit -u); at least {LEAST_THREADS} are needed"
    finally:
        end.set()
        for thread in started:
            thread.join()
    return None


def name_problem(arguments: Sequence[str]) -> str | None:
    """What is wrong with a name that is no UTF-8, which no file of a dataset can have."""
    for argument in arguments:
        try:
            argument.encode()
        except UnicodeEncodeError:
            return f"{argument!a} is no UTF-8; choose another name"
    return None
