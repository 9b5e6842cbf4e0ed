"""Finding a movement of the arm: a posture that brings the hand somewhere, and a free way to it.

All that is tried is tried in a fixed order, so that equal rooms give equal movements: goals, heights and turns of the
column, directions of the hand, the closed-form postures of the arm, and a few ways of getting to each.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import steps_of
from remqa_data.geometry.types import F64
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.joint_paths import path, ways
from remqa_data.sim.arm.load import NOTHING, Load
from remqa_data.sim.arm.obstacles import OF_AGENT, Obstacles, depth, first_push
from remqa_data.sim.arm.postures import (
    BALL_RADII_M,
    HAND_BALLS,
    ArmBase,
    balls,
    hand_balls,
    link_poses,
    postures_to,
    shoulders,
)
from remqa_data.sim.navigation.embodiment import AGENT

T = TypeVar("T")

COARSE = 8
"""A way is first tested at every eighth posture, which refuses most of those that are not free."""
RISES_M = (0.0, 0.2, -0.2, 0.4, -0.4, 0.6, -0.6)
"""Heights of the shoulder over the target that are tried."""
TURNS_DEG = (0.0, 40.0, -40.0)
"""Turns of the column past the target that are tried."""
BATCH = 32
"""So many pairs of a column and a direction of the hand, with eight postures each, are tried at a time."""
MAX_GOALS = 24
"""So many points at which the tip of the hand is free are tried."""
TURN_STEP = 0.02
"""What is held is looked at in steps of a turn that change its quaternion by so much: 2.3 degrees."""
POSTURES_PER_BATCH = 3
"""So many of the free postures of a batch are tried to get to, the shortest ways first, where the column may slide and
turn: there are many more batches then. Where it stays all are tried, for there are at most 216 of them."""


class HandGoals(NamedTuple):
    """Where the hand may go, the preferred places first.

    Attributes
    ----------
    points : (n, 3) array
        Metres, in the room.
    axes : (n, 3) array
        The directions in which it had best point there: unit vectors.
    """

    points: F64
    axes: F64


@dataclass(frozen=True)
class Way:
    """How far the arm gets.

    Attributes
    ----------
    posture : (8,) array
        Where it ends.
    is_free : bool
        Whether it gets to its end.
    blocker : int or None
        What stops it, as an owner of `Obstacles`.
    """

    posture: F64
    is_free: bool
    blocker: int | None


class Search:
    """Movements from one posture at one place of the agent.

    Parameters
    ----------
    obstacles : Obstacles
        The room.
    base : ArmBase
        Where the agent stands.
    start : (8,) array
        The arm's posture.
    touchable : collection of str
        Objects that the hand may touch, but not the rest of the arm.
    load : Load
        What the hand holds; it does not turn with the hand.
    others : sequence of ArmBase
        Where other agents stand.
    walk_m : float
        How far the agent may walk from there with the arm as it is, metres.
    """

    def __init__(
        self,
        obstacles: Obstacles,
        base: ArmBase,
        start: F64,
        touchable: Collection[str] = (),
        load: Load = NOTHING,
        others: Sequence[ArmBase] = (),
        walk_m: float = 0.0,
    ) -> None:
        self.base, self.start, self.load = base, start, load
        self.boxes, self.owners = obstacles.near(base, load.reach_m + walk_m, others)
        may_touch = np.isin(self.owners, obstacles.indices(touchable))
        self.spared = HAND_BALLS[:, None] & may_touch[None]
        self._load_spared = np.tile(np.isin(self.owners, obstacles.let_loads_pass), (len(load.radii), 1))
        self._radii = np.concatenate([BALL_RADII_M, load.radii])
        self._all_spared = np.vstack([self.spared, self._load_spared])

    def along(self, *waypoints: F64) -> Way:
        """Go through postures in straight lines, as far as it is free."""
        postures = path([self.start, *waypoints])
        stop, box = self._first_push(postures)
        return Way(postures[stop - 1], box < 0, None if box < 0 else int(self.owners[box]))

    def met_on_the_way(self, bases: Sequence[ArmBase]) -> int | None:
        """The owner of what the arm meets first, held as it is, while its agent is at some places in turn; None if nothing."""
        here = self._placed(self.start[None])[0]
        frames = np.stack([base.pose() for base in bases])
        carried = arithmetic.moved(arithmetic.moved_back(here, self.base.pose()), frames[:, None])
        box = first_push(carried, self._radii, self.boxes, self._spared_with_agent())[1]
        return None if box < 0 else int(self.owners[box])

    def met_by_turning_load(self, rotation: F64) -> int | None:
        """The owner of what the load meets first, if anything, when a (3, 3) rotation turns it about the hand, which stays."""
        hand = link_poses(self.base, self.start[None])[0, jaco.HAND, :3, 3]
        turned = np.stack([hand + arithmetic.turned(self.load.offsets, step) for step in steps_of(rotation, TURN_STEP)])
        box = first_push(turned, self.load.radii, self.boxes, self._load_spared)[1]
        return None if box < 0 else int(self.owners[box])

    def starts_free(self) -> bool:
        """Whether the arm is in nothing as it is held."""
        here = self._placed(self.start[None])
        return bool((depth(here, self._radii, self.boxes, self._spared_with_agent()) <= 0.0).all())

    def to(self, goals: HandGoals, *, free_column: bool, from_outside: bool = False) -> Way | None:
        """Bring the hand to one of some goals.

        Parameters
        ----------
        goals : HandGoals
            The first ones are preferred.
        free_column : bool
            Whether the column may slide and turn too.
        from_outside : bool
            Whether goals do not count at which the tip of the hand is inside of what the hand may touch.

        Returns
        -------
        A free way; or the way to the first goal as far as the arm gets; or None if all are out of reach.
        """
        spared = np.zeros_like(self.spared[-1:]) if from_outside else self.spared[-1:]
        tip_is_free = depth(goals.points[:, None], BALL_RADII_M[-1:], self.boxes, spared) <= 0.0
        tip_is_free &= (
            depth(goals.points[:, None] + self.load.offsets, self.load.radii, self.boxes, self._load_spared) <= 0.0
        )
        hopeful = [(goals.points[i], goals.axes[i]) for i in np.flatnonzero(tip_is_free)[:MAX_GOALS]]
        tries = POSTURES_PER_BATCH if free_column else None
        batches = [self._free_batches(point, axis, free_column=free_column) for point, axis in hopeful]
        for point, columns, axes in _in_turns(batches):
            postures = postures_to(self.base, point, columns, axes, self.start)
            if (way := self._free_way(postures, tries)) is not None:
                return way
        return self._as_near_as_possible(goals, free_column=free_column)

    def to_one_of(self, postures: F64) -> Way | None:
        """Go to one of (n, 8) postures, or as far as it is free towards the first; None if there are none."""
        if not len(postures):
            return None
        return self._free_way(postures) or self.along(postures[0])

    def _free_way(self, postures: F64, tries: int | None = None) -> Way | None:
        """A way to one of the first few postures that touch nothing."""
        for posture in postures[self._touches_nothing(postures)][:tries]:
            for waypoints in ways(self.base, self.start, posture):
                if self._first_push(path([self.start, *waypoints])[::COARSE])[1] < 0:
                    way = self.along(*waypoints)
                    if way.is_free:
                        return way
        return None

    def _as_near_as_possible(self, goals: HandGoals, *, free_column: bool) -> Way | None:
        for goal, axis in zip(*goals, strict=True):
            for batch in self._batches(goal, _fanned(axis), free_column=free_column):
                postures = postures_to(self.base, *batch, self.start)
                if len(postures):
                    return self.along(postures[0])
        return None

    def _free_batches(self, point: F64, axis: F64, *, free_column: bool) -> Iterator[tuple[F64, F64, F64]]:
        """The batches for a point in which the hand alone is free."""
        fan = _fanned(axis)
        placed = hand_balls(np.broadcast_to(point, fan.shape), fan)
        is_free = depth(placed, BALL_RADII_M[HAND_BALLS], self.boxes, self.spared[HAND_BALLS]) <= 0.0
        yield from self._batches(point, fan[is_free], free_column=free_column)

    def _batches(self, point: F64, axes: F64, *, free_column: bool) -> Iterator[tuple[F64, F64, F64]]:
        """A point with columns (k, 2) and directions of the hand (k, 3) to try there, a batch at a time, the best first."""
        columns = self._columns(point, free_column=free_column)
        ranked = _best_pairs(len(columns), len(axes))
        for first in range(0, len(ranked), BATCH):
            column, axis = ranked[first : first + BATCH].T
            yield point, columns[column], axes[axis]

    def _columns(self, point: F64, *, free_column: bool) -> F64:
        """(k, 2) heights and turns of the column from which a point is in reach; the present ones first."""
        columns = [self.start[:2]]
        if free_column:
            ahead = float(arithmetic.arctan2(point[1] - self.base.y, point[0] - self.base.x)) - math.radians(
                self.base.yaw_deg
            )
            for turn, rise in itertools.product(TURNS_DEG, RISES_M):
                height = min(max(point[2] - self.base.floor_z + rise, AGENT.shoulder_low_m), AGENT.shoulder_high_m)
                columns.append(np.array([height, _wrapped(ahead + math.radians(turn))]))
        stacked = np.array(columns)
        is_near = arithmetic.length(shoulders(self.base, stacked) - point) <= AGENT.reach_m
        return np.asarray(stacked[is_near])

    def _touches_nothing(self, postures: F64) -> npt.NDArray[np.bool_]:
        return np.asarray(depth(self._placed(postures), self._radii, self.boxes, self._all_spared) <= 0.0)

    def _first_push(self, postures: F64) -> tuple[int, int]:
        """The first of successive postures that pushes into a box, and the box; see `first_push`."""
        return first_push(self._placed(postures), self._radii, self.boxes, self._all_spared)

    def _spared_with_agent(self) -> npt.NDArray[np.bool_]:
        """Pairs that may touch while the arm is carried: the agent's own body is carried along."""
        return np.asarray(self._all_spared | (self.owners == OF_AGENT))

    def _placed(self, postures: F64) -> F64:
        """(n, b, 3) balls of the arm and its load in (n, 8) postures."""
        links = link_poses(self.base, postures)
        return np.concatenate([balls(links), links[:, jaco.HAND, None, :3, 3] + self.load.offsets], axis=1)


def _in_turns(iterators: Iterable[Iterator[T]]) -> Iterator[T]:
    """The first item of each, then the second of each, and so on."""
    waiting = list(iterators)
    while waiting:
        left = []
        for iterator in waiting:
            for item in itertools.islice(iterator, 1):
                left.append(iterator)
                yield item
        waiting = left


@lru_cache
def _best_pairs(first: int, second: int) -> npt.NDArray[np.int64]:
    """(first * second, 2) pairs of places in two ranked lists: those with the least sum of places first."""
    pairs = np.array(list(np.ndindex(first, second)), dtype=np.int64).reshape(-1, 2)
    return pairs[np.argsort(pairs.sum(axis=1), kind="stable")]


def _fanned(axis: F64) -> F64:
    """(27, 3) directions: one, then 26 all around, those nearest to it first."""
    directions = _all_around()
    nearest_first = np.argsort(-np.round(arithmetic.dot(directions, axis), 9), kind="stable")
    return np.vstack([axis, directions[nearest_first]])


@lru_cache
def _all_around() -> F64:
    lattice = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
    return np.asarray(lattice / arithmetic.length(lattice)[:, None])


def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi
