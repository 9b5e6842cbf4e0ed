"""What hands do to a world: put things down, let them fall, slide them along. Who acts, and from where, is not asked.

Every function leaves the world either with the thing done and all at rest, or as it was.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Vec3
from remqa_data.sim.physics.support import Support, contents_of, supports
from remqa_data.sim.physics.world import SETTLE_STEPS, World

Where = TypeVar("Where")
Depths = Mapping[tuple[str, str], float]
"""How deep things are in others, metres, by the ids of both."""

DROP_SPOTS_M = ((0.45, 0.9), (0.6, 0.9), (0.45, 1.3), (0.35, 1.1), (0.6, 0.4), (0.75, 0.9))
"""Where a thing is let go: how far before the agent and how high above the floor, the best first."""
OVERLAP_M = 0.005
"""Things that rest on each other overlap less than this."""
AROUND_M = 0.02
"""PyBullet, asked for what is no farther than a contact, leaves out some of what a thing is deep in; asked for so much more, it
does not."""
GAP_M = 0.003
"""How far above its place a thing is let go."""
NEAR_M, NEAR_STEP_M = 0.06, 0.02
FAR_M, FAR_STEP_M = 0.4, 0.1
"""What is put into something is put aside, and up to twice as far up: so far in such steps, then farther in longer ones."""
SLIDE_STEP_M, LEAST_STEP_M = 0.025, 0.0005
"""In such steps things slide and are let down, and in shorter ones before they touch something."""
FLIGHT_STEPS = 960
"""What is thrown has come to rest after so many steps of physics at the most."""


@dataclass(frozen=True)
class Release:
    """What was put down, or why it was not."""

    object_id: str | None
    error: str = ""


@dataclass(frozen=True)
class Slide:
    """How far a thing was moved, metres, and what stopped it before its goal."""

    distance_m: float
    blocked_by: str = ""


def drop_at(
    world: World,
    held: str,
    spots: Sequence[Vec3],
    velocity: Vec3 | None = None,
    *,
    is_clear: Callable[[str], bool] | None = None,
    force: bool = False,
) -> Release:
    """Let go of what is held at the first of some points where there is room for it, and let it fall.

    Parameters
    ----------
    world, held
        The room, and what.
    spots : sequence of tuple of float
        The points, metres, the best first.
    velocity : tuple of float, optional
        m/s with which it is thrown.
    is_clear : callable, optional
        Says of an object whether it may stay where it has come to rest, if it can as well be dropped somewhere else.
    force : bool
        Whether it is let go where there is no room, too, if there is none anywhere; physics drives it out.
    """
    before = world.save()
    passes: list[tuple[bool, Callable[[str], bool] | None]] = [(True, None)]
    if is_clear is not None:
        passes.insert(0, (True, is_clear))
    if force:
        passes.append((False, None))
    for needs_room, may_stay in passes:
        for spot in spots:
            if needs_room and not is_free(world, held, spot):
                continue
            world.put(held, spot)
            falling = [held, *world.contents(held)]
            if velocity is None:
                settle(world, awake=falling)
            else:
                settle(world, FLIGHT_STEPS, {held: velocity}, falling)
            fell = world.state(held).position != spot  # and not out of the room
            if fell and (may_stay is None or may_stay(held)):
                return Release(held)
            world.restore(before)
    world.restore(before)  # where it was held out
    return Release(None, f"no room to drop {held}")


def settle(
    world: World,
    steps: int = SETTLE_STEPS,
    velocities: Mapping[str, Vec3] | None = None,
    awake: Iterable[str] | None = None,
) -> None:
    """As `World.settle`; but what physics would push through the floor or out of the room stays where it was."""
    before = world.save()
    world.settle(steps, velocities, awake)
    for object_id, state in before.states.items():
        if not state.is_fixed and object_id not in world.held and not is_in_room(world, object_id):
            world.move(object_id, state.position, state.quaternion)


def blocker_at(world: World, object_id: str, position: Vec3) -> str | None:
    """What fixed thing an object would overlap somewhere else; None if none. What is loose would be pushed aside."""
    state, carried = world.state(object_id), set(world.contents(object_id))
    world.move_alone(object_id, position)
    met = [other for other in sunk_into(world, object_id) if other not in carried]
    world.put_back(object_id, state)
    return next((other for other in met if other not in world.ids or world.state(other).is_fixed), None)


def slide(
    world: World, object_id: str, heading: float, distance_m: float, is_refused: Callable[[Vec3], str | None]
) -> Slide:
    """Slide an object, with its parts and what is in or on it, until it meets something; loose things come to rest afterwards.

    What one of them is in already stops it only where it would get deeper into that.

    Parameters
    ----------
    world : World
        The room.
    object_id : str
        What to slide.
    heading : float
        Radians counter-clockwise from +x.
    distance_m : float
        How far at most.
    is_refused : callable
        Names what else is in the way of the object's centre being at a position, or gives None.
    """
    held_by = support_of(world, object_id, by_agents=True)
    if held_by is None and world.state(object_id).is_fixed:
        return Slide(0.0, "what holds it")
    parts = world.built_into(object_id)
    group = [object_id, *parts, *world.contents(object_id, along=parts)]
    leaning = [name for name in world.borne(object_id, along=parts) if name not in group]
    before, own = world.save(), {*group, *leaning}
    at_start = depths(world, group, own)
    starts = {name: np.array(world.state(name).position) for name in (*group, *leaning)}
    sine, cosine = arithmetic.sin_cos(heading)
    way = np.array([cosine, sine, 0.0])

    def put(away_m: float) -> None:
        for name, start in starts.items():
            x, y, z = (start + away_m * way).tolist()
            world.move_alone(name, (x, y, z))

    gone, blocker = 0.0, ""
    for step in _steps(distance_m):
        x, y, z = (starts[object_id] + step * way).tolist()
        refused = is_refused((x, y, z))
        put(step)
        blocker = refused or next((other for _, other in deeper(depths(world, group, own), at_start)), "")
        if blocker:
            put(gone)
            break
        gone = step
    if gone == 0.0:
        world.restore(before)
    elif world.state(object_id).is_fixed:
        if support_of(world, object_id, by_agents=True) != held_by:
            world.restore(before)  # physics does not move what is fixed, so it would hang in the air
            return Slide(0.0, "the edge")
    else:
        settle(world)
    return Slide(gone, blocker)


def lower(world: World, object_id: str) -> None:
    """Let furniture, with its parts and what is in or on it, down until it would touch something; it does not tilt."""
    parts = world.built_into(object_id)
    group = {object_id, *parts, *world.contents(object_id, along=parts)}
    x, y, z = world.state(object_id).position
    step = 0.0 if _touch_others(world, group) else SLIDE_STEP_M
    while step >= LEAST_STEP_M and z > world.scene.floor_z:
        world.move(object_id, (x, y, z - step), along=parts)
        if _touch_others(world, group):
            world.move(object_id, (x, y, z), along=parts)
            step /= 2
        else:
            z -= step


def _steps(distance_m: float) -> list[float]:
    """How far something has gone after each step of a slide; the last one may be shorter."""
    whole = np.arange(SLIDE_STEP_M, distance_m + 1e-9, SLIDE_STEP_M).tolist()
    return whole if whole and distance_m - whole[-1] <= 1e-9 else [*whole, distance_m]


def is_free(world: World, object_id: str, spot: Vec3) -> bool:
    """Whether an object, which is put there with its load and stays there, touches nothing at a point."""
    world.move_alone(object_id, spot)
    group = {object_id, *world.load_of(object_id)}
    return not _touch_others(world, group)


def _touch_others(world: World, group: Collection[str]) -> bool:
    """Whether any of a group touches what is not of the group."""
    return any(other not in group for name in group for other in touched(world, name))


def touched(world: World, object_id: str) -> dict[str, float]:
    """What an object touches or is in, and how deep, metres; the deepest first."""
    return {other: -gap for other, gap in world.overlapping(object_id, AROUND_M) if gap <= 0.0}


def depths(world: World, names: Iterable[str], own: Collection[str] = ()) -> Depths:
    """How deep each of some objects is in what it touches, but for what is their own."""
    return {(name, other): depth for name in names for other, depth in touched(world, name).items() if other not in own}


def deeper(now: Mapping[Where, float], before: Mapping[Where, float], most_m: float = OVERLAP_M) -> list[Where]:
    """Where something is deeper in something than it was before by more than metres, by default more than things that touch."""
    return [where for where, depth in now.items() if depth > before.get(where, 0.0) + most_m]


def sunk_into(world: World, object_id: str, most_m: float = OVERLAP_M) -> list[str]:
    """What an object is in by more than metres, by default more than things that touch are, the deepest first."""
    return [other for other, depth in touched(world, object_id).items() if depth > most_m]


def move_out(world: World, object_id: str, usual: Depths) -> None:
    """Move an object that is in something, and deeper than is usual, to the nearest place where it is not.

    Where there is none near, it stays. Furniture is moved by a hair only, and not up: it would fall onto what it is in.
    """
    state = world.state(object_id)
    if not deeper(depths(world, [object_id]), usual):
        return
    for shift in _shifts():
        if not state.is_fixed or (shift[2] == 0.0 and math.hypot(*shift) <= NEAR_M):
            x, y, z = arithmetic.snapped(np.add(state.position, shift)).tolist()
            world.move_alone(object_id, (x, y, z))
            if not deeper(depths(world, [object_id]), usual):
                return
    world.put_back(object_id, state)


@lru_cache(maxsize=1)
def _shifts() -> tuple[Vec3, ...]:
    """Where else an object may be put, the nearest place first, metres."""
    found: set[Vec3] = set()
    for far, step in ((NEAR_M, NEAR_STEP_M), (FAR_M, FAR_STEP_M)):
        count = round(far / step)
        found |= {
            (x * step, y * step, z * step)
            for x in range(-count, count + 1)
            for y in range(-count, count + 1)
            for z in range(2 * count + 1)
            if (x or y or z) and math.hypot(x, y) <= count
        }
    return tuple(sorted(found, key=lambda shift: (math.hypot(*shift), shift)))


def support_of(world: World, object_id: str, *, by_agents: bool = False) -> str | None:
    """Id of what holds an object, if anything does; `by_agents` as for `supports`."""
    found = supports(world, by_agents=by_agents).get(object_id)
    return found.id if found else None


def comes_along(world: World, object_id: str, held_by: Mapping[str, Support]) -> set[str]:
    """Ids of what is picked up with an object: what goes along by contact, and what is said to be in or on it."""
    return {*world.contents(object_id), *contents_of(held_by, object_id)}


def is_in_room(world: World, object_id: str) -> bool:
    """Whether the middle of an object is between the walls of its room, and not below the floor."""
    x0, y0, x1, y1 = world.scene.bounds
    x, y, z = world.state(object_id).position
    return x0 <= x <= x1 and y0 <= y <= y1 and z >= world.scene.floor_z
