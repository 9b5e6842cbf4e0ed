"""What a command is given to run in; whole processes are in `tests/test_hostile_inputs.py`."""

import threading

import pytest

from remqa_data.processes.surroundings import LEAST_THREADS, thread_problem


def test_enough_threads_are_no_problem_and_none_is_left() -> None:
    before = threading.active_count()
    assert thread_problem() is None
    assert threading.active_count() == before


def test_too_few_threads_are_a_problem_and_those_that_started_end(monkeypatch: pytest.MonkeyPatch) -> None:
    before, start, started = threading.active_count(), threading.Thread.start, []

    def start_five(thread: threading.Thread) -> None:
        if len(started) == 5:
            raise RuntimeError("can't start new thread")
        start(thread)
        started.append(thread)

    monkeypatch.setattr(threading.Thread, "start", start_five)
    problem = f"the system starts only 5 more threads (ulimit -u); at least {LEAST_THREADS} are needed"
    assert thread_problem() == problem
    assert threading.active_count() == before
