"""Where the work on rooms is done: in processes of this machine, or on a Ray cluster.

A job writes its results itself, to a place that is the same for all, and gives back little. So an executor only says which
jobs there are and counts them. What a job does may depend on nothing but the job; then a job can be done again, on another
machine and by two at the same time, when a process or a machine is lost.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol, TypeVar

from remqa_data.errors import ClusterError, ConfigError, one_line
from remqa_data.extras import require
from remqa_data.processes.cores import worker_count
from remqa_data.processes.workers import run_in_processes

EXECUTORS = ("local", "ray")
RAY_QUEUE = 2000
"""Jobs that Ray knows at a time: more than a cluster can do at once, so that it grows if it can, and not a million."""
ANSWER_S = 10.0
"""So long a cluster has time to answer."""
RAY_RETRIES = 10
"""How often Ray does a job again whose process or node was lost."""

J = TypeVar("J")
R = TypeVar("R")


class Executor(Protocol):
    """Does jobs, each once or more often."""

    def run(self, work: Callable[[J], R], jobs: Sequence[J]) -> Iterator[tuple[J, R]]:
        """Do `work` on each job; yields jobs with their results, in the order in which they are done.

        The first error of a job ends the run and is raised as it is. `work` must be a function of a module.
        """


def make_executor(name: str, workers: int | None = None, ray_address: str | None = None) -> Executor:
    """An executor by its name on the command line.

    Parameters
    ----------
    name : {"local", "ray"}
    workers : int, optional
        Processes of this machine, by default one for each core.
    ray_address : str, optional
        See `RayExecutor`.

    Raises
    ------
    ConfigError
        If there is none of this name, or it does not take what is given.
    """
    if name not in EXECUTORS:
        raise ConfigError(f"there is no executor {name!r}; use {' or '.join(EXECUTORS)}")
    if name == "ray":
        if workers is not None:
            raise ConfigError("--workers is for --executor local; a Ray cluster has one for each of its cores")
        return RayExecutor(ray_address)
    if ray_address is not None:
        raise ConfigError("--ray-address is for --executor ray")
    return LocalExecutor(worker_count(workers))


class LocalExecutor:
    """Processes of this machine; a single worker is this process itself.

    A process that dies is replaced, and what it was doing is done again. When this process dies, its workers do too.

    Parameters
    ----------
    workers : int
        How many.
    """

    def __init__(self, workers: int = 1) -> None:
        self.workers = workers

    def run(self, work: Callable[[J], R], jobs: Sequence[J]) -> Iterator[tuple[J, R]]:
        """See `Executor`.

        Raises
        ------
        WorkersLostError
            If the processes of a job die again and again.
        """
        if self.workers == 1:
            for job in jobs:
                yield job, work(job)
            return
        for number, result in run_in_processes(work, jobs, self.workers):
            yield jobs[number], result


class RayExecutor:
    """A Ray cluster, with one job on each of its CPUs. Ray does a job again whose process or node is lost.

    Parameters
    ----------
    address : str, optional
        Of the cluster, such as "auto" or "ray://head:10001"; by default the one of $RAY_ADDRESS, else this machine alone.

    Raises
    ------
    MissingExtraError
        If Ray is not installed.
    ClusterError
        If the cluster cannot be reached.
    """

    def __init__(self, address: str | None = None) -> None:
        self._ray: Any = require("ray", "ray")
        if self._ray.is_initialized():
            return
        _check_address(address)
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # tell nobody, unless the user wants to
        try:
            self._ray.init(address=address, log_to_driver=False, logging_level="ERROR", include_dashboard=False)
        except (ConnectionError, ValueError, RuntimeError, TimeoutError) as error:
            raise _unreachable(address, error) from None

    def run(self, work: Callable[[J], R], jobs: Sequence[J]) -> Iterator[tuple[J, R]]:
        """See `Executor`.

        Raises
        ------
        ClusterError
            If the cluster loses the processes of a job again and again.
        """
        ray = self._ray
        task = ray.remote(num_cpus=1, max_retries=RAY_RETRIES)(work)
        waiting = list(reversed(range(len(jobs))))
        running: dict[Any, int] = {}
        try:
            while waiting or running:
                while waiting and len(running) < RAY_QUEUE:
                    number = waiting.pop()
                    running[task.remote(jobs[number])] = number
                (done,), _ = ray.wait(list(running), num_returns=1)
                number = running.pop(done)
                yield jobs[number], self._result(done)
        finally:
            for unfinished in running:
                ray.cancel(unfinished, force=True)

    def _result(self, done: Any) -> Any:
        exceptions = self._ray.exceptions
        try:
            return self._ray.get(done)
        except exceptions.RayTaskError as error:
            raise error.cause from None  # as it was raised there, without Ray's account of the way
        except exceptions.RayError as error:
            raise ClusterError(f"a job was lost for good: {one_line(error)}; go on with --resume") from None


def _check_address(address: str | None) -> None:
    """Look whether anybody answers, as Ray itself waits for minutes."""
    host, _, port = (address or "").removeprefix("ray://").rpartition(":")
    if not (host and port.isdecimal()):
        return
    try:
        socket.create_connection((host, int(port)), timeout=ANSWER_S).close()
    except OSError as error:
        raise _unreachable(address, error) from None


def _unreachable(address: str | None, error: Exception) -> ClusterError:
    return ClusterError(f"Ray cluster {address or 'on this machine'}: {one_line(error)}")
