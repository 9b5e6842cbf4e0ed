"""One small trainer for all networks: on the CPU the same seed gives the same weights, whether a run was killed or not.

What is drawn for a sample depends on the seed, the epoch and the sample alone, and a checkpoint has everything else: so a run
that goes on from a checkpoint does what it would have done.
"""

from __future__ import annotations

import csv
import io
import json
import math
import multiprocessing
import pickle
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import DataLoader, Dataset

from remqa_data.agents.training.config import CURVES, DURATION
from remqa_data.errors import ConfigError
from remqa_data.files import atomic_path
from remqa_data.version import __version__

CHECKPOINT = "checkpoint.pt"

UNREAD = 32
"""Losses are read after so many batches at the latest: a GPU that is asked for each one waits for who asks."""


class Task(Protocol):
    """What is learnt: a network, samples, how wrong it is, and how good."""

    @property
    def model(self) -> nn.Module:
        """The network."""

    def __len__(self) -> int:
        """How many samples there are to learn from."""

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> Any:
        """Some samples as a batch, each varied by its own generator."""

    def losses(self, batch: Any) -> Mapping[str, Tensor]:
        """What is to become small ("loss"), and other figures for the curves."""

    def score(self) -> Mapping[str, float]:
        """How good the network is, on rooms that it does not learn from; it is in evaluation mode."""


@dataclass(frozen=True)
class Schedule:
    """How long and how fast is learnt.

    Attributes
    ----------
    epochs, batch_size : int
    learning_rate : float
        The highest, after `warm_up` of all steps; it falls to 0 as half a cosine.
    weight_decay : float
    seed : int
    score_every : int
        Epochs from one score to the next; the last is always scored.
    precision : {"float32", "bfloat16"}
        What convolutions and products are computed in while learning. The second takes half the time where the processor or
        GPU knows it, and is float32 where it does not (`knows_bfloat16`); weights and scores are float32 all the same.
    """

    epochs: int
    batch_size: int
    learning_rate: float
    weight_decay: float
    seed: int
    score_every: int = 1
    precision: Literal["float32", "bfloat16"] = "float32"
    warm_up: float = 0.1

    def batches(self, samples: int) -> int:
        """Batches of an epoch; what is left over waits for another epoch."""
        return max(1, samples // self.batch_size)

    def samples(self, count: int) -> int:
        """What is learnt from in all epochs, of so many samples."""
        return self.epochs * self.batches(count) * self.batch_size

    def rate(self, share: float) -> float:
        """The learning rate when a share, 0 to 1, of all steps is done."""
        if share < self.warm_up:
            return self.learning_rate * share / self.warm_up
        rest = (share - self.warm_up) / (1 - self.warm_up)
        return float(self.learning_rate * (1 + np.cos(np.pi * rest)) / 2)


def knows_bfloat16(device: str) -> bool:
    """Whether a device computes in bfloat16 by itself; a processor that only imitates it takes nine times as long."""
    kind = torch.device(device).type
    if kind == "cuda":
        return torch.cuda.get_device_capability(device) >= (8, 0)
    if kind != "cpu" or not hasattr(torch.cpu, "get_capabilities"):  # older versions of torch cannot tell
        return True
    known = torch.cpu.get_capabilities()
    return any(known.get(name, False) for name in ("avx512_bf16", "amx_bf16", "bf16"))


def train(
    task: Task,
    schedule: Schedule,
    folder: Path,
    *,
    fingerprint: str = "",
    resume: bool = False,
    device: str = "cpu",
    workers: int = 0,
    checkpoint_s: float = 60.0,
    progress: Callable[[int], None] | None = None,
) -> dict[str, float]:
    """Train a network; `task.model` has the weights then.

    Parameters
    ----------
    task : Task
        What is learnt.
    schedule : Schedule
        How.
    folder : path
        Where the checkpoint and the curves go.
    fingerprint : str
        What the run depends on: only a run with the same goes on with another.
    resume : bool
        Go on with an interrupted run, if there is one.
    device : str
        Where to compute, such as "cuda".
    workers : int
        Processes that make batches ahead, the same ones as without; 0 makes them as they are needed.
    checkpoint_s : float
        Seconds from one checkpoint to the next; nothing depends on it but what is done again.
    progress : callable, optional
        Called with the number of samples that were learnt from since the last call.

    Returns
    -------
    The last score.

    Raises
    ------
    ConfigError
        If what is to be gone on with is another run, or other processes cannot make batches on this system.
    """
    if workers and "fork" not in multiprocessing.get_all_start_methods():
        raise ConfigError("--workers: this system forks no processes; leave it out")
    torch.manual_seed(schedule.seed)
    run = _Run(task, schedule, folder, fingerprint, device)
    if resume:
        run.go_on()
    made = _Batches(task, schedule).since(run.step_of_all, workers)
    tell = progress if progress is not None else _to_nobody
    tell(run.step_of_all * schedule.batch_size)
    while run.state.epoch < schedule.epochs:
        run.model.train()
        while run.state.step < run.batches:
            run.learn_from(next(made))
            tell(schedule.batch_size)
            if time.monotonic() - run.saved > checkpoint_s:
                run.save()
        run.end_epoch()
    _write_curves(folder / CURVES, run.state.curves)  # a run that was killed after its last checkpoint has not
    run.model.eval()
    with atomic_path(folder / DURATION) as temporary:
        temporary.write_text(json.dumps({"minutes": round(run.state.minutes, 2)}) + "\n", encoding="utf-8")
    return run.state.score


@contextmanager
def deterministic(device: str) -> Iterator[None]:
    """Let torch compute the same on the CPU each time; its settings and its generator are as before in the end."""
    was = torch.are_deterministic_algorithms_enabled()
    with torch.random.fork_rng(devices=[]):
        torch.use_deterministic_algorithms(torch.device(device).type == "cpu")
        try:
            yield
        finally:
            torch.use_deterministic_algorithms(was)


class _Run:
    """One training: the network, its optimizer, and how far it has come.

    Attributes
    ----------
    batches : int
        Of an epoch.
    saved : float
        When the last checkpoint was written, or the run began, by the clock of `time.monotonic`.
    """

    def __init__(self, task: Task, schedule: Schedule, folder: Path, fingerprint: str, device: str) -> None:
        self.task, self.schedule, self.folder, self.device = task, schedule, folder, device
        self.model = task.model.to(device)
        self.kind = torch.device(device).type
        self.optimizer = torch.optim.AdamW(
            self.model.parameters(),
            lr=schedule.learning_rate,
            weight_decay=schedule.weight_decay,
            fused=self.kind == "cuda",
        )
        self.state = _State()
        self.batches = schedule.batches(len(task))
        self.saved = time.monotonic()
        self._about = json.dumps({"schedule": vars(schedule), "of": fingerprint, "version": __version__})
        self._is_short = schedule.precision == "bfloat16" and knows_bfloat16(device)
        self._unread: list[Mapping[str, Tensor]] = []

    @property
    def step_of_all(self) -> int:
        """Steps that are done, of all epochs."""
        return self.state.epoch * self.batches + self.state.step

    def go_on(self) -> None:
        """Take up an interrupted run, if there is one.

        Raises
        ------
        ConfigError
            If it is another run's, or damaged.
        """
        path = self.folder / CHECKPOINT
        if not path.is_file():
            return
        stored = _checkpoint(path, self.device)
        if stored["about"] != self._about:
            raise ConfigError(f"{path} is of another training; use --overwrite in place of --resume to begin anew")
        try:
            self.model.load_state_dict(stored["model"])
            self.optimizer.load_state_dict(stored["optimizer"])
            self.state = _State.of(stored["state"])
        except (RuntimeError, LookupError, ValueError, TypeError, AttributeError):
            raise ConfigError(_no_checkpoint(path)) from None

    def learn_from(self, batch: Any) -> None:
        """One step."""
        rate = self.schedule.rate(self.step_of_all / (self.schedule.epochs * self.batches))
        for group in self.optimizer.param_groups:
            group["lr"] = rate
        with torch.autocast(self.kind, torch.bfloat16, enabled=self._is_short):
            losses = self.task.losses(batch)
        self.optimizer.zero_grad()
        losses["loss"].backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(self.model.parameters(), 10.0)
        self.optimizer.step()
        self.state.step += 1
        self._unread.append({name: value.detach() for name, value in losses.items()})
        if len(self._unread) >= UNREAD:
            self._read()

    def end_epoch(self) -> None:
        """Score the network where that is due, add to the curves, and begin the next epoch."""
        state = self.state
        state.epoch += 1
        self._read()
        curve: dict[str, float] = {"epoch": state.epoch} | {k: v / self.batches for k, v in state.sums.items()}
        if state.epoch % self.schedule.score_every == 0 or state.epoch == self.schedule.epochs:
            self.model.eval()
            with torch.no_grad():
                state.score = dict(self.task.score())
            curve |= state.score
        state.curves.append(curve)
        state.step, state.sums = 0, {}
        self.save()
        _write_curves(self.folder / CURVES, state.curves)

    def save(self) -> None:
        """Write a checkpoint; what that takes is not counted among the minutes."""
        self.state.minutes += (time.monotonic() - self.saved) / 60
        self._read()
        parts = {"model": self.model.state_dict(), "optimizer": self.optimizer.state_dict(), "state": vars(self.state)}
        whole = io.BytesIO()  # what PyTorch says of a full disk is no OSError
        torch.save({"about": self._about, **parts}, whole)
        with atomic_path(self.folder / CHECKPOINT) as temporary:
            temporary.write_bytes(whole.getbuffer())
        self.saved = time.monotonic()

    def _read(self) -> None:
        """Add up the losses of the last batches."""
        for losses in self._unread:
            for name, value in losses.items():
                number = float(value)
                if not math.isfinite(number):
                    raise ConfigError(
                        f"epoch {self.state.epoch + 1}, up to step {self.state.step}: {name} is {number}; the last "
                        "checkpoint is as it was; a lower learning_rate or a larger batch_size may help"
                    )
                self.state.sums[name] = self.state.sums.get(name, 0.0) + number
        self._unread.clear()


def _to_nobody(_: int) -> None:
    """Nobody asked for progress."""


def _checkpoint(path: Path, device: str) -> dict[str, Any]:
    """What an interrupted run has left.

    Raises
    ------
    ConfigError
        If the file is damaged, or no checkpoint.
    """
    try:
        stored: dict[str, Any] = torch.load(path, map_location=device, weights_only=True)
        if stored.keys() == {"about", "model", "optimizer", "state"}:
            return stored
    except (RuntimeError, LookupError, ValueError, TypeError, AttributeError, EOFError, pickle.UnpicklingError):
        pass  # what PyTorch says of a damaged file is of many kinds
    raise ConfigError(_no_checkpoint(path))


def _no_checkpoint(path: Path) -> str:
    return f"{path} is no checkpoint of a training; use --overwrite in place of --resume to begin anew"


class _Batches(Dataset[Any]):
    """All batches of a training; each depends on its number alone, whoever makes it."""

    def __init__(self, task: Task, schedule: Schedule) -> None:
        self.task, self.schedule = task, schedule
        self._each = schedule.batches(len(task))
        self._epoch, self._order = -1, np.zeros(0, dtype=np.int64)

    def __getitem__(self, number: int) -> Any:
        epoch, step = divmod(number, self._each)
        if epoch != self._epoch:
            self._epoch, self._order = epoch, self._drawn(epoch).permutation(len(self.task))
        size = self.schedule.batch_size
        samples = self._order[step * size : (step + 1) * size]
        self.seed(number)
        return self.task.batch(samples, [self._drawn(epoch, int(sample)) for sample in samples])

    def seed(self, number: int) -> None:
        """Seed torch's own generator for a batch and what is learnt from it."""
        torch.manual_seed(int(self._drawn(*divmod(number, self._each)).integers(2**62)))

    def since(self, first: int, workers: int) -> Iterator[Any]:
        """All from a number on, made by so many other processes, or here, when they are asked for."""
        numbers = range(first, self.schedule.epochs * self._each)
        if not workers:
            yield from (self[number] for number in numbers)
            return
        made = DataLoader(
            self,
            batch_size=None,
            sampler=numbers,
            num_workers=workers,
            collate_fn=_as_it_is,
            multiprocessing_context="fork",  # they begin with what the task holds, and use no GPU
        )
        for number, batch in zip(numbers, made, strict=True):
            self.seed(number)
            yield batch

    def _drawn(self, *numbers: int) -> np.random.Generator:
        return np.random.default_rng([self.schedule.seed, *numbers])


def _as_it_is(batch: Any) -> Any:
    return batch


class _State:
    """How far a training has come."""

    def __init__(self) -> None:
        self.epoch = self.step = 0
        self.minutes = 0.0
        self.sums: dict[str, float] = {}
        self.score: dict[str, float] = {}
        self.curves: list[dict[str, float]] = []

    @classmethod
    def of(cls, stored: Mapping[str, Any]) -> _State:
        """That of a checkpoint.

        Raises
        ------
        TypeError
            If it is none.
        """
        state = cls()
        if {name: type(value) for name, value in stored.items()} != {n: type(v) for n, v in vars(state).items()}:
            raise TypeError(stored.keys())
        vars(state).update(stored)
        return state


def _write_curves(path: Path, curves: list[dict[str, float]]) -> None:
    names = list(dict.fromkeys(name for curve in curves for name in curve))
    with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows({name: f"{value:.5g}" for name, value in curve.items()} for curve in curves)
