"""Ways to a posture of the arm: straight in its joint space, or by folding it first."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from remqa_data.geometry.types import F64
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.postures import HOME, ArmBase, link_poses, postures_to
from remqa_data.sim.navigation.embodiment import AGENT

STEP_RAD, STEP_M = 0.02, 0.015
"""Between two steps no joint moves farther; the arm is 1 m long, and its thinnest ball 4 cm across."""
DRAWN_BACK_M = 0.15
"""The hand is brought so far before its goal, and then straight ahead."""
RAISED_M = 0.3
"""The arm is brought to its goal from so far above where it cannot be unfolded beside it."""

_HOME_JOINTS = HOME.posture()[2:]


def ways(base: ArmBase, start: F64, goal: F64) -> Iterator[list[F64]]:
    """Waypoints (8,) from a posture to another, the goal included.

    Straight; or folding the arm, then unfolding it up to a little before the goal, or to the goal, or above it.
    """
    yield [goal]
    is_folded = np.array_equal(start[2:], _HOME_JOINTS)
    fold = [] if is_folded else _unfolding(base, start)[::-1]
    home, turned, *short = _unfolding(base, goal)
    yield [*fold, home, turned, *short, goal]
    yield [*fold, home, turned, goal]
    yield [*fold, *map(_raised, [home, turned, *short]), *short, goal]


def path(waypoints: Sequence[F64]) -> F64:
    """(n, 8) postures from the first waypoint to the last in straight lines, in small steps."""
    return np.vstack([waypoints[0][None], *itertools.starmap(_steps, itertools.pairwise(waypoints))])


def _unfolding(base: ArmBase, posture: F64) -> list[F64]:
    """On the way to a posture: the folded arm, the folded arm turned towards it, the hand drawn back from it."""
    home = np.append(posture[:2], _HOME_JOINTS)
    turned = home.copy()
    turned[2] = posture[2]
    if posture[4] < math.pi:  # the elbow bends the other way
        turned[[4, 6]] = 2 * math.pi - home[[4, 6]]
    hand = link_poses(base, posture[None])[0, jaco.HAND]
    back = hand[:3, 3] - DRAWN_BACK_M * hand[:3, 2]
    short = postures_to(base, back, posture[None, :2], hand[None, :3, 2], posture)
    return [home, turned, *short[:1]]


def _raised(posture: F64) -> F64:
    """The same posture with a higher shoulder."""
    return np.append(min(posture[0] + RAISED_M, AGENT.shoulder_high_m), posture[1:])


def _steps(a: F64, b: F64) -> F64:
    """(n, 8) postures after `a` up to `b`, in small steps."""
    change = np.abs(b - a)
    count = max(1, math.ceil(max(change[0] / STEP_M, change[1:].max() / STEP_RAD)))
    steps = a + (b - a) * (np.arange(1, count + 1)[:, None] / count)
    steps[-1] = b
    return np.asarray(steps)
