"""What comes while a worker is being started, on one that is started by this process."""

import gc
import os
import signal
import threading
import time
from multiprocessing import resource_tracker, util

import psutil
import pytest

from remqa_data.processes.interrupts import handled_afterwards
from remqa_data.processes.workers import run_in_processes
from tests.helpers.executor_jobs import square

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs signals")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_handled_when_what_it_would_break_off_is_done(number: int) -> None:
    came: list[int] = []
    before = signal.signal(number, lambda got, _: came.append(got))
    try:
        with handled_afterwards():
            signal.raise_signal(number)
            assert not came
        assert came == [number]
        signal.raise_signal(number)
        assert came == [number] * 2
    finally:
        signal.signal(number, before)


@pytest.mark.slow
def test_a_worker_that_is_interrupted_as_it_starts_ends_without_a_word(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    resource_tracker.ensure_running()  # a process, too
    start, started = util.spawnv_passfds, []

    def interrupted(path: bytes, *others: object) -> int:
        started.append(start(path, *others))
        os.kill(os.getpid(), signal.SIGINT)  # whatever thread of this process gets it
        time.sleep(0.1)
        return started[-1]

    monkeypatch.setattr(util, "spawnv_passfds", interrupted)
    done = threading.Event()
    threading.Thread(target=done.wait, daemon=True).start()  # the main thread blocks the signal
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            list(run_in_processes(square, [2, 3], 2))
    finally:
        signal.signal(signal.SIGINT, before)
        done.set()
    (child,) = started
    gc.collect()  # what was interrupted holds ends of pipes
    assert psutil.Process(child).wait(20) is not None
    assert "Traceback" not in capfd.readouterr().err
