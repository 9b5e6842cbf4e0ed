"""Leading the elbow round the line from the shoulder to the hand, whose middle stays where it is.

The hand's place takes three of the six joints' freedoms, and where it points two. So the elbow goes where it should if the hand
points elsewhere: of all ways to turn it that lead the elbow as far the least one is taken, in small steps.
"""

from __future__ import annotations

import math

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.postures import ArmBase, link_poses, postures_to

ELBOW = 3
"""Index among `link_poses` of the link that turns in the elbow."""
STEP_RAD = math.radians(2.0)
PROBE = 0.01
"""So far to each side the hand is pointed, radians, to see where that leads the elbow."""
MOST_TURN = 0.4
"""A step that would turn the hand farther, radians, is none: there the arm is stretched, or at the end of a joint."""
MOST_TRAVEL_RAD = 0.6
"""A joint that moves farther in a step belongs to another way of bending the arm."""
ROUNDS, CLOSE_RAD = 3, 1e-4
"""Each step is put right so many times at most, until it is so exact."""


def elbow_angle(base: ArmBase, posture: F64) -> float:
    """How far the elbow is round the line from the shoulder to the hand, radians, by the right-hand rule; 0 above it.

    NaN where the hand is straight above or below the shoulder, or at it.
    """
    poses = link_poses(base, posture[None])[0]
    shoulder = arithmetic.moved(np.array([0.0, 0.0, jaco.SHOULDER_M]), poses[0])
    line, elbow = poses[jaco.HAND][:3, 3] - shoulder, poses[ELBOW][:3, 3] - shoulder
    length = float(arithmetic.length(line))
    if length < 1e-9:
        return math.nan
    line = line / length
    above = np.array([0.0, 0.0, 1.0]) - line[2] * line
    if float(arithmetic.length(above)) < 1e-6:
        return math.nan
    return float(arithmetic.arctan2(arithmetic.dot(arithmetic.cross(above, elbow), line), arithmetic.dot(above, elbow)))


def elbow_way(base: ArmBase, start: F64, angle: float) -> list[F64] | None:
    """Postures (8,) that lead the elbow round by an angle, radians, in small steps; None if six joints cannot."""
    count, begin, way = max(1, math.ceil(abs(angle) / STEP_RAD)), elbow_angle(base, start), [start]
    for step in range(1, count + 1):
        after = _led(base, way[-1], begin + step / count * angle)
        if after is None:
            return None
        way.append(after)
    return way[1:]


def _led(base: ArmBase, posture: F64, goal: float) -> F64 | None:
    """The posture nearby with the elbow at an angle, by Newton's method."""
    for _ in range(ROUNDS):
        left = _between(goal, elbow_angle(base, posture))
        if abs(left) < CLOSE_RAD:
            return posture
        slopes = np.array([_slope(base, posture, axis) for axis in (0, 1)])
        steepness = float(arithmetic.dot(slopes, slopes))
        if not steepness > 0.0:  # NaN too
            return None
        turn = left * slopes / steepness
        after = _pointed(base, posture, turn) if float(arithmetic.length(turn)) <= MOST_TURN else None
        if after is None:
            return None
        posture = after
    return posture


def _slope(base: ArmBase, posture: F64, axis: int) -> float:
    """How far the elbow goes round when the hand is tilted along one of its two axes, radians for each radian."""
    tilt = PROBE * np.eye(2)[axis]
    sides = [_pointed(base, posture, by) for by in (tilt, -tilt)]
    if sides[0] is None or sides[1] is None:
        return math.nan
    return _between(elbow_angle(base, sides[0]), elbow_angle(base, sides[1])) / (2 * PROBE)


def _pointed(base: ArmBase, posture: F64, tilt: F64) -> F64 | None:
    """The posture with the hand in its place, tilted by (2,) radians along its own axes, the arm bent as it is; or None."""
    hand = link_poses(base, posture[None])[0, jaco.HAND]
    axis = arithmetic.turned(np.append(tilt, 1.0), hand[:3, :3])
    axis = axis / float(arithmetic.length(axis))
    found = postures_to(base, hand[:3, 3], posture[None, :2], axis[None], posture)
    if not len(found) or float(np.abs(found[0] - posture).max()) > MOST_TRAVEL_RAD:
        return None
    return np.asarray(found[0])


def _between(end: float, start: float) -> float:
    """The shorter way from one angle to another, radians."""
    return (end - start + math.pi) % (2 * math.pi) - math.pi
