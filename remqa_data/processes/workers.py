"""Processes of this machine that do jobs, each one at a time.

The process that starts them has no threads for it, only waits: so nothing can hang when it is told to stop, or when the
system starts no more threads. Workers are ended outright, in the middle of a job if need be, for all that a job writes
appears when it is whole.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import traceback
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar

from remqa_data.errors import RemqaError, WorkersLostError
from remqa_data.processes.interrupts import handled_afterwards
from remqa_data.processes.surroundings import thread_problem

LOSSES_OF_A_JOB = 3
"""Processes die by accident, as when a machine is short of memory for a moment; so often in the same job is no accident."""

J = TypeVar("J")
R = TypeVar("R")

_CONTEXT = multiprocessing.get_context("spawn")


def run_in_processes(work: Callable[[J], R], jobs: Sequence[J], workers: int) -> Iterator[tuple[int, R]]:
    """Do `work` on each job; yields numbers of jobs with their results, in the order in which they are done.

    A process that dies is replaced, and its job is done again. None is left when this ends, however it does.

    Raises
    ------
    WorkersLostError
        If a job's process dies again and again, or the system starts no more processes.
    """
    waiting, losses, undone = deque(range(len(jobs))), Counter[int](), len(jobs)
    staff: list[_Worker[J, R]] = []
    try:
        while waiting or any(worker.is_busy for worker in staff):
            _give_jobs(staff, work, jobs, waiting, workers)
            busy = {worker.pipe: worker for worker in staff if worker.is_busy}
            outcomes = []
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index]
                outcome = worker.outcome()
                if outcome is None:
                    staff.remove(worker)
                    worker.kill()
                    losses[worker.number] += 1
                    waiting.appendleft(worker.number)
                    _check_losses(losses[worker.number], undone)
                else:
                    outcomes.append(outcome)
            if all(outcome.error is None for outcome in outcomes):
                _give_jobs(staff, work, jobs, waiting, workers)  # nobody waits while the results are dealt with
            for outcome in sorted(outcomes, key=lambda outcome: outcome.error is not None):
                if outcome.error is not None:
                    raise outcome.error
                undone -= 1
                yield outcome.number, outcome.result
    finally:
        for worker in staff:
            worker.strike()  # all at once: what a process holds takes the system a moment to take back
        for worker in staff:
            worker.kill()


@dataclass(frozen=True)
class _Outcome(Generic[R]):
    number: int
    result: R
    error: Exception | None


class _Worker(Generic[J, R]):
    """A process, from the side of the one that started it."""

    def __init__(self, work: Callable[[J], R]) -> None:
        self.pipe, theirs = _CONTEXT.Pipe()
        self.number, self.is_busy = -1, False
        self._process = _CONTEXT.Process(target=_do_jobs, args=(theirs, work), daemon=True)
        try:
            # Half started it would wait for its work, and tell with a traceback that none comes.
            with handled_afterwards(), _interrupts_held_back():
                self._process.start()
        except BlockingIOError:
            raise WorkersLostError("the system starts no more processes (ulimit -u); use fewer --workers") from None
        finally:
            theirs.close()  # so that the pipe ends when the process does

    def give(self, number: int, job: J) -> None:
        """Let it do a job."""
        self.number, self.is_busy = number, True
        with suppress(BrokenPipeError, ConnectionResetError):  # it has died, which shows when its outcome is asked for
            self.pipe.send(job)

    def outcome(self) -> _Outcome[R] | None:
        """What came of its job, or None if the process has died."""
        self.is_busy = False
        try:
            result, error = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            return None
        return _Outcome(self.number, result, error)

    def strike(self) -> None:
        """Let it end, whatever it is doing."""
        if self._process.pid is not None:
            self._process.kill()

    def kill(self) -> None:
        """End it, and wait until it has."""
        self.strike()
        if self._process.pid is not None:
            self._process.join()
        self.pipe.close()


def _give_jobs(
    staff: list[_Worker[J, R]], work: Callable[[J], R], jobs: Sequence[J], waiting: deque[int], workers: int
) -> None:
    """Give each idle worker a job, and start workers where there are too few."""
    while len(staff) < min(workers, sum(worker.is_busy for worker in staff) + len(waiting)):
        staff.append(_Worker(work))
    for worker in staff:
        if waiting and not worker.is_busy:
            number = waiting.popleft()
            worker.give(number, jobs[number])


def _check_losses(losses: int, undone: int) -> None:
    if losses == LOSSES_OF_A_JOB:
        raise WorkersLostError(
            f"worker processes died {losses} times with {undone} jobs to do, each time in the same one, perhaps for lack "
            "of memory; use fewer --workers (remqa-gen goes on with --resume)"
        )


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """What is started in this block never gets Ctrl-C, which a terminal sends to all: its starter decides what to do."""
    if os.name != "posix":
        yield
        return
    resource_tracker.ensure_running()  # it would let interrupts through as it starts
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# ---- in the process


def _do_jobs(pipe: Connection[Any, Any], work: Callable[[J], R]) -> None:
    problem = thread_problem()
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        if problem is not None:
            pipe.send_bytes(_as_bytes(WorkersLostError(f"a worker: {problem}; use fewer --workers")))
            return
        _die_with_parent()
        while True:
            data = pipe.recv_bytes()
            try:
                answer = pickle.dumps((work(pickle.loads(data)), None))
            except Exception as error:
                answer = _as_bytes(error)
            pipe.send_bytes(answer)


def _as_bytes(error: Exception) -> bytes:
    """An error for the other side; one that nobody expected tells where it came from."""
    if not isinstance(error, RemqaError):
        error.add_note(f"In a worker process:\n{traceback.format_exc()}")
    try:
        data = pickle.dumps((None, error))
        pickle.loads(data)
    except Exception:
        data = pickle.dumps((None, RuntimeError("".join(traceback.format_exception(error)))))
    return data


def _die_with_parent() -> None:
    """Let this process end as soon as the one that started it is gone, even if that was killed."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
