"""Walks over cached views to learn from: many at once, from anywhere in the rooms that may be learnt from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from remqa_data.agents.knowledge.reading import Question, asked_types, read_question
from remqa_data.agents.networks.actor_critic import DONE, MOVES
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.training.pictures import detector_types
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.env.cached.tasks import CachedTasks
from remqa_data.env.cached.walk import ACTIONS
from remqa_data.errors import DatasetError
from remqa_data.geometry.types import F32, I32
from remqa_data.views.reader import RoomViews
from remqa_data.views.tasks import NavigationTask

_NUMBERS = np.array([ACTIONS.index(name) for name in MOVES])

NOT_THERE = np.iinfo(np.int32).max
"""Distance where no way leads to the target."""


@dataclass(frozen=True, eq=False)
class Errand:
    """A question up to the manipulation, in a cached room.

    Attributes
    ----------
    task : NavigationTask
    asked : Question
        What its words say.
    room : RoomViews
    start : int
        The state in which its episode begins.
    types : (int, int)
        See `asked_types`.
    distances : (states,) int32
        How many of MOVES lead from each state to where the target counts as found; NOT_THERE where none do.
    """

    task: NavigationTask
    asked: Question
    room: RoomViews
    start: int
    types: tuple[int, int]
    distances: I32

    def some_start(self, rng: np.random.Generator, farthest: int) -> int:
        """A state to begin in: first how far away it may be is drawn, up to `farthest` actions, then one of those so near."""
        bound = int(rng.integers(1, farthest + 1))
        near = np.flatnonzero((self.distances > 0) & (self.distances <= bound))
        return int(near[rng.integers(len(near))]) if len(near) else self.start


def errands(root: Path, views: Path, rooms: frozenset[str] | None) -> list[Errand]:
    """The train questions that can be walked to, in rooms of a cache; only in some rooms, if given.

    Raises
    ------
    DatasetError
        If it is no finished cache of the dataset, has no features, or none of these rooms.
    """
    tasks = CachedTasks(root, views, "train")
    ids = [name for name in tasks.ids if rooms is None or tasks.task(name).scene in rooms]
    found = []
    for name in ids:
        task = tasks.task(name)
        room = tasks.room(task)
        if room.features is None:
            raise DatasetError(
                f"{views} has no features; add them: remqa-data cache {root} "
                "--features remqa_data.agents.view_features:features"
            )
        distances = distances_to(room, room.succeeds(name))
        if (distances == 0).any():
            asked = read_question(task.question)
            start, types = tasks.start(task, room), asked_types(asked, detector_types())
            found.append(Errand(task, asked, room, start, types, distances))
    if not found:
        raise DatasetError(
            f"{views} has none of the rooms to learn from; add them: remqa-data cache {root} --split train"
        )
    return found


def learning_errands(root: Path, views: Path, roots: Sequence[Path]) -> tuple[list[Errand], list[Errand]]:
    """What is learnt from, see `learning_rooms`, and what is scored, in val rooms."""
    val = rooms_of(root, "val")
    return errands(root, views, learning_rooms(roots)), errands(root, views, val) if val else []


def distances_to(room: RoomViews, succeeds: np.ndarray) -> I32:
    """(states,) how many of MOVES lead to the nearest of (states,) flagged ones; NOT_THERE where none do."""
    states = np.arange(len(room.states))
    after = room.transitions.table[:, _NUMBERS[:DONE]]
    # Backwards: from where an action leads to where it is done. States that are refused lead to themselves.
    edges = sparse.csr_array(
        (np.ones(after.size, dtype=np.int8), (after.ravel(), np.repeat(states, DONE))), shape=(len(states),) * 2
    )
    ends = np.flatnonzero(succeeds & room.is_reachable)
    found = np.full(len(states), NOT_THERE, dtype=np.int32)
    if len(ends):
        steps = dijkstra(edges, unweighted=True, indices=ends, min_only=True)
        is_there = np.isfinite(steps)
        found[is_there] = steps[is_there].astype(np.int32)
    return found


class Walks:
    """Several walks at once.

    Parameters
    ----------
    errands : sequence of Errand
        Of each walk.
    starts : sequence of int
        States in which they begin.
    """

    def __init__(self, errands: Sequence[Errand], starts: Sequence[int]) -> None:
        self.errands = errands
        self.states = np.array(starts, dtype=np.int64)
        self.is_over = np.zeros(len(errands), dtype=np.bool_)
        self.succeeded = np.zeros(len(errands), dtype=np.bool_)
        self.moved_m = np.zeros(len(errands))

    def __len__(self) -> int:
        return len(self.errands)

    def features(self) -> F32:
        """(n, PARTS^2, CHANNELS) of what is seen; 0 where a walk is over."""
        rooms = [errand.room.features for errand in self.errands]
        found = np.zeros((len(self), *rooms[0].shape[1:]), dtype=np.float32)  # type: ignore[union-attr]
        for place in np.flatnonzero(~self.is_over).tolist():
            found[place] = rooms[place][self.states[place]]  # type: ignore[index]
        return found

    def distances(self) -> I32:
        """(n,) actions to where the target counts as found."""
        pairs = zip(self.errands, self.states.tolist(), strict=True)
        return np.array([errand.distances[state] for errand, state in pairs], dtype=np.int32)

    def step(self, moves: np.ndarray) -> np.ndarray:
        """Do (n,) of MOVES, but where a walk is over; (n,) whether each was done and not refused."""
        is_going = ~self.is_over
        is_done = is_going & (moves == DONE)
        self.succeeded |= is_done & (self.distances() == 0)
        self.is_over |= is_done
        before = self.states.copy()
        for place in np.flatnonzero(is_going & ~is_done).tolist():
            errand = self.errands[place]
            self.states[place] = errand.room.transitions.table[before[place], _NUMBERS[moves[place]]]
            if MOVES[moves[place]] == "MoveAhead" and self.states[place] != before[place]:
                self.moved_m[place] += errand.room.states.step_m
        return np.asarray(is_done | (self.states != before))


def check_features(encoder: ViewEncoder, errand: Errand) -> None:
    """Refuse a cache whose features are another encoder's.

    Raises
    ------
    DatasetError
        If the features of the errand's first view are not what the encoder makes of it.
    """
    stored = errand.room.features
    assert stored is not None, "errands have features"
    made = encoder.encode(errand.room.frame(errand.start)[None])[0].numpy()
    if not np.allclose(stored[errand.start].astype(np.float32), made, rtol=0.02, atol=0.02):
        raise DatasetError("the cache has features of another view encoder; make it anew with this one")
