"""Putting what is held into or onto a receptacle: where there is room, how it is turned, and whether it stays there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from remqa_data.assets.core.model import Space
from remqa_data.catalog import object_type, types_with
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import about_z, quaternion_of, rotation_of, snapped_quaternion
from remqa_data.geometry.types import F64, Flags, Vec2, Vec3
from remqa_data.scene import Quaternion
from remqa_data.sim.agent.handling import GAP_M, Release, comes_along, is_free, settle, sunk_into, support_of, touched
from remqa_data.sim.navigation.grid import collision_corners
from remqa_data.sim.physics.support import directly_held, support_rules, supports, surrounds
from remqa_data.sim.physics.world import Snapshot, World

LATTICE_M = 0.05
FINE_PITCHES_M, FINE_STEPS = (0.01, 0.025), 20
"""Where no place of that lattice is free, points are nearer to each other: so many steps, as AI2-THOR's, but not nearer or
farther than so."""
TRIES, MOST_TRIES = 3, 12
"""How many free places of a lattice are tried with a thing turned one way, and all ways: from some, things roll off."""
NEAR_SPOTS, FAR_STRIDE = 800, 40
"""So many of the nearest places are looked at, and of the others, which a floor has by ten thousands, one of so many."""
CLOSED = "closed"
STICKS_M = 0.01
"""What lies in a drawer or cabinet is in something by less than that when it is closed."""
MISFITS = 8
"""In so many ways it is put where it is in something then, before the first of these is taken."""
OPEN_ENOUGH = 0.15
"""A thing can be put into a closed space that is open at least this much, or as far as it opens at all."""
HANGS_M = 0.006
"""So far below the top of a holder's space is the top of what hangs on it."""
TURNS_DEG = (0.0, 90.0, 45.0, 135.0)
QUARTER_TURNS_DEG = TURNS_DEG[:2]
RISE_M, MOST_RISE_M = 0.01, 0.3
"""What is in the way a little is passed by letting go so much higher; what is too large for an open space, by so many
steps of it as it takes: it lies across the rim."""
HEAPS_M = (0.0, 0.02, 0.04, 0.06)
"""What fits nowhere else may lie on what is so low, such as a knife in a drawer or a television's foot."""
BEARS = 0.6
"""The middle of what is larger than its place is within this part of the place, so that it is borne."""
BEYOND = 0.2
"""So much farther than the middle of a vessel, in parts of its breadth, is what is best seen over its rim."""
UP_TO_TOP = np.array([0.0, 0.0, 0.4])
"""From the middle of a thing's box, in parts of its size, to where its top is looked for."""
LONG, DEEP = 3.0, 0.35
"""What is so many times as long as it is broad can be stood into a cup that is so deep, in parts of the thing's length; so
can, on edge, what is so many times as broad as it is thick."""


class _Way(NamedTuple):
    """How a thing is put down.

    Attributes
    ----------
    quaternion : tuple of float
        Its rotation.
    low, high : (3,) array
        Its box around its origin.
    is_upright : bool
        Whether it is stood up, which only walls around it hold.
    lies_across : bool
        Whether it may lie on the rim of what it is too large for.
    is_last : bool
        Whether it may lie anywhere that bears it, also on what lies there or beyond an edge.
    """

    quaternion: Quaternion
    low: F64
    high: F64
    is_upright: bool = False
    lies_across: bool = False
    is_last: bool = False


def put_into(
    world: World,
    held: str,
    receptacle_id: str,
    near: Vec2,
    are_seen: Callable[[F64], Flags],
    is_clear: Callable[[str], bool],
    are_near: Callable[[F64], Flags] | None = None,
) -> Release:
    """Put what is held into or onto a receptacle, where it is free; it must stay there.

    It lies as it is held, or else turned on the spot, or stands in what has walls around it if it is long, or lies across,
    or on something low, or, if nothing is in or on it, on its side; towels and rolls hang on their holders, and nothing else
    does. What is in or on it stays there, if that can be.

    Parameters
    ----------
    world : World
        The room.
    held : str
        What.
    receptacle_id : str
        Where to.
    near : tuple of float
        The nearest places to this x and y, metres, come first among those that are seen, and among those that are not.
    are_seen : callable
        Says of (n, 3) points in the room, metres, which of them are seen, (n,).
    is_clear : callable
        Says of an object whether it could stay where it is put to try.
    are_near : callable, optional
        Says of (n, 3) points, metres, which of them, (n,), come before all others; by default all do.
    """
    spaces = open_spaces(world, receptacle_id)
    if not spaces:
        is_closed = world.assets[receptacle_id].spaces
        return Release(None, f"{receptacle_id} is {CLOSED if is_closed else 'not a receptacle'}")
    before, refused = world.save(), Release(None, f"no free place for {held} in {receptacle_id}")
    hangs = support_rules().hangs.get(world.type_of(receptacle_id))
    if hangs is not None:
        if world.type_of(held) in hangs and _hang(world, held, receptacle_id, spaces[0]) and is_clear(held):
            return Release(held)
        world.restore(before)
        return refused
    kind = world.type_of(receptacle_id)
    if kind in types_with("one_in_a_slot"):
        in_slots = directly_held(supports(world, by_agents=True), receptacle_id)
        if len(in_slots) >= len(spaces):
            return refused
    for is_in in (True, False):  # under the spout of a coffee machine before on its top
        part = [space for space in spaces if surrounds(kind, space) is is_in]
        if part and _is_put(world, held, receptacle_id, part, near, are_seen, is_clear, are_near):
            return Release(held)
    return refused


def _is_put(
    world: World,
    held: str,
    receptacle_id: str,
    spaces: list[Space],
    near: Vec2,
    are_seen: Callable[[F64], Flags],
    is_clear: Callable[[str], bool],
    are_near: Callable[[F64], Flags] | None,
) -> bool:
    """Put what is held into one of some spaces of a receptacle, if that can be; else all is as before.

    Rather where it would stick in nothing if the receptacle were closed.
    """
    before, load, tries = world.save(), world.load_of(held), [MOST_TRIES, MOST_TRIES]
    second_best: list[Snapshot] = []
    for way in _ways(world, held):
        spots = _spots(world, receptacle_id, spaces, way)
        if not spots:
            continue
        spots = _best_first(world, receptacle_id, spots, way, near, are_seen, are_near)
        world.move_alone(held, world.state(held).position, way.quaternion)
        looked_at = spots[:NEAR_SPOTS] + spots[NEAR_SPOTS::FAR_STRIDE]
        free = (spot for spot in _free(world, held, looked_at, way) if is_clear(held))
        for spot in islice(free, min(TRIES, tries[way.is_last])):
            tries[way.is_last] -= 1
            world.put(held, spot)
            settle(world, awake=[held, *load])
            stays = _stays(world, held, receptacle_id, load) and is_clear(held)
            if stays and _fits_closed(world, held, receptacle_id):
                return True
            if stays:
                second_best.append(world.save())
                break  # the next way, as it is mostly too high for the drawer
            world.restore(before)
            world.move_alone(held, world.state(held).position, way.quaternion)
        world.restore(before)
        if len(second_best) == MISFITS:
            break
    if second_best:
        world.restore(second_best[0])
    return bool(second_best)


def _stays(world: World, held: str, receptacle_id: str, load: Sequence[str]) -> bool:
    """Whether what has been put lies in or on a receptacle, with its load, in nothing else and in no machine's hollow foot."""
    held_by = supports(world, by_agents=True)
    if held not in held_by or held_by[held].id != receptacle_id or sunk_into(world, held):
        return False
    others = [name for name in directly_held(held_by, receptacle_id) if name != held]
    is_floor = world.type_of(receptacle_id) == "Floor"  # where furniture stands, which is open below
    machines = [name for name in others if not (is_floor or object_type(world.type_of(name)).pickupable)]
    is_swallowed = any(_is_within(world.box(held), world.box(name)) for name in machines)
    return not is_swallowed and set(load) <= comes_along(world, held, held_by)


def _fits_closed(world: World, held: str, receptacle_id: str) -> bool:
    """Whether what lies in or on a receptacle would still do so if that were closed, and stick in nothing."""
    if not world.state(receptacle_id).openness:
        return True
    before = world.save()
    world.open(receptacle_id, 0.0)
    fits = support_of(world, held, by_agents=True) == receptacle_id and not sunk_into(world, held, STICKS_M)
    world.restore(before)
    return fits


def _is_within(box: F64, other: F64) -> bool:
    """Whether a (2, 3) box is within another, but for a hair."""
    return bool((box[0] >= other[0] - GAP_M).all() and (box[1] <= other[1] + GAP_M).all())


def _best_first(
    world: World,
    receptacle_id: str,
    spots: list[Vec3],
    way: _Way,
    near: Vec2,
    are_seen: Callable[[F64], Flags],
    are_near: Callable[[F64], Flags] | None,
) -> list[Vec3]:
    """Spots in the order in which they are tried: where a thing's top is seen, where its middle is, and where neither is.

    The nearest ones come first; of a vessel's that are not seen, those beyond its middle, as the nearest are behind its rim. Of
    spots that are not near, the nearest is best, seen or not.
    """
    middles, up = np.array(spots) + (way.low + way.high) / 2, (way.high - way.low) * UP_TO_TOP
    seen = are_seen(np.concatenate([middles + up, middles])).reshape(2, -1).sum(axis=0)
    is_far = np.zeros(len(spots), dtype=np.bool_) if are_near is None else ~are_near(middles)
    seen[is_far] = 0
    is_vessel = world.type_of(receptacle_id) in support_rules().vessels
    amid = _beyond_middle(world.box(receptacle_id), near) if is_vessel else near
    away = [math.dist(spot[:2], near if is_seen else amid) for spot, is_seen in zip(spots, seen.tolist(), strict=True)]
    return [spots[i] for i in np.lexsort(np.stack([away, -seen, is_far])).tolist()]


def _beyond_middle(box: F64, near: Vec2) -> Vec2:
    """A point a little farther than the middle of a (2, 3) box, as seen from somewhere."""
    middle, size = box.mean(axis=0)[:2], np.ptp(box, axis=0)[:2]
    ahead = middle - near
    x, y = (middle + BEYOND * size.min() * ahead / max(math.hypot(*ahead.tolist()), 1e-9)).tolist()
    return x, y


def open_spaces(world: World, receptacle_id: str) -> list[Space]:
    """The spaces of a receptacle into which a thing can be put as it is now: not those that are closed."""
    asset = world.assets[receptacle_id]
    enough, openness = min(OPEN_ENOUGH, world.most_open(receptacle_id)), world.state(receptacle_id).openness
    is_open = asset.is_openable and openness > 0.0 and openness >= enough
    return [space for space in spaces_for_things(world, receptacle_id) if is_open or not space.enclosed]


def spaces_for_things(world: World, receptacle_id: str) -> list[Space]:
    """The spaces of a receptacle where things may be if it is open: not the top of what takes things in, as microwaves do."""
    takes_in = world.type_of(receptacle_id) in types_with("takes_in")
    return [space for space in world.assets[receptacle_id].spaces if space.enclosed or not takes_in]


def lattice(link: F64, space: Space, half: ArrayLike = (0.0, 0.0), is_fine: bool = False) -> Iterator[Vec3]:
    """Points of the floor of a space at which the middle of a thing, (2,) half as large, can be; at least one.

    The link to which the space belongs is at a (4, 4) pose; all in metres, the points in the room. What is larger than its
    place lies in its middle; on a fine lattice also beyond an edge, where that is open.
    """
    low, high = np.array(space.box).reshape(2, 3)
    room, middle = (high - low)[:2] / 2, (low + high) / 2
    within = np.minimum(half, room)
    axes = [np.arange(-(r - h), r - h + 1e-9, LATTICE_M) for r, h in zip(room, within, strict=True)]
    if is_fine:
        beyond = np.zeros(2) if space.enclosed else np.minimum(half - within, BEARS * room)
        axes = [_fine(far) for far in (room - within + beyond).tolist()]
    for dx in axes[0]:
        for dy in axes[1]:
            x, y, z = arithmetic.moved([middle[0] + dx, middle[1] + dy, low[2]], link).tolist()
            yield x, y, z


def _fine(far: float) -> F64:
    """Points from so far on one side of the middle to as far on the other, the middle among them."""
    pitch = float(np.clip(2 * far / FINE_STEPS, *FINE_PITCHES_M))
    steps = math.ceil(far / pitch - 1e-9)
    return np.linspace(-far, far, 2 * steps + 1)


def _hang(world: World, held: str, receptacle_id: str, space: Space) -> bool:
    """Hang a thing just below the top of a holder's space; whether it hangs there and meets nothing else."""
    low, high = np.array(space.box).reshape(2, 3)
    middle = [*(low + high)[:2] / 2, high[2] - HANGS_M - world.assets[held].spec.size[2] / 2]
    x, y, z = arithmetic.snapped(arithmetic.moved(middle, world.link_poses(receptacle_id)[space.link])).tolist()
    world.put(held, (x, y, z), world.state(receptacle_id).quaternion)
    world.set_fixed(held, True)
    return support_of(world, held) == receptacle_id and not {*sunk_into(world, held)} - {receptacle_id}


def _ways(world: World, held: str) -> Iterator[_Way]:
    """How a thing can be put down, the most natural way first."""
    lying = rotation_of(world.state(held).quaternion)
    flat = [_way(world, held, arithmetic.product(about_z(degrees), lying)) for degrees in TURNS_DEG]
    yield from flat
    sides = np.ptp(world.assets[held].bounds(), axis=0)
    thin, broad, tall = np.argsort(sides, kind="stable").tolist()
    on_end = [tall] if sides[tall] >= LONG * sides[broad] else []
    on_edge = [broad, tall] if sides[broad] >= LONG * sides[thin] else []
    for axis in dict.fromkeys([*on_end, *on_edge]):
        yield from (way._replace(is_upright=True) for way in _stood_on(world, held, axis, TURNS_DEG))
    yield from (way._replace(lies_across=True) for way in flat)
    yield from (way._replace(is_last=True) for way in flat[: len(QUARTER_TURNS_DEG)])
    if world.load_of(held):
        return
    upright = int(np.abs(lying[2]).argmax())
    for axis in sorted({0, 1, 2} - {upright}, key=lambda axis: (float(sides[axis]), axis)):  # lying before on edge
        yield from (way._replace(is_last=True) for way in _stood_on(world, held, axis, QUARTER_TURNS_DEG))


def _stood_on(world: World, held: str, axis: int, turns_deg: Iterable[float]) -> Iterator[_Way]:
    """How a thing is turned that has one of its own axes upright."""
    up, across = np.eye(3)[axis], np.eye(3)[(axis + 1) % 3]
    upright = np.array([across, arithmetic.cross(up, across), up])
    for degrees in turns_deg:
        yield _way(world, held, arithmetic.product(about_z(degrees), upright))


def _way(world: World, held: str, rotation: F64) -> _Way:
    was = world.state(held)
    quaternion = snapped_quaternion(quaternion_of(rotation))
    world.move_alone(held, was.position, quaternion)
    low, high = world.box(held) - np.array(was.position)
    low[2] = min(low[2], _lowest(world, held) - was.position[2])
    world.move_alone(held, was.position, was.quaternion)
    return _Way(quaternion, low, high)


def _lowest(world: World, object_id: str) -> float:
    """Height of the lowest corner of an object's collision boxes, metres: below what is round and leans."""
    links = zip(world.assets[object_id].links, world.link_poses(object_id), strict=True)
    corners = (arithmetic.moved(collision_corners(link.boxes), pose) for link, pose in links)
    return min(float(placed[..., 2].min(initial=np.inf)) for placed in corners)


def _spots(world: World, receptacle_id: str, spaces: list[Space], way: _Way) -> list[Vec3]:
    """Where the origin of a thing can be when it lies or stands in some spaces."""
    links, spots = world.link_poses(receptacle_id), list[Vec3]()
    for space in spaces:
        link = links[space.link]
        along = arithmetic.turned(np.maximum(-way.low, way.high), np.abs(link[:3, :3]).T)[:2]  # the space's own axes
        is_too_large = (along > np.subtract(space.box[3:5], space.box[:2]) / 2).any()
        if way.is_upright and not _holds_upright(world.type_of(receptacle_id), space, way):
            continue
        if way.lies_across and (space.enclosed or not is_too_large):
            continue
        points = lattice(link, space, along, way.is_last)
        spots += [(x, y, z + GAP_M - float(way.low[2])) for x, y, z in points]
    return spots


def _holds_upright(type_name: str, space: Space, way: _Way) -> bool:
    """Whether a thing that is stood into a space leans against walls around it."""
    tall, deep = float(way.high[2] - way.low[2]), space.box[5] - space.box[2]
    return surrounds(type_name, space) and not space.enclosed and deep >= DEEP * tall


def _free(world: World, held: str, spots: list[Vec3], way: _Way) -> Iterator[Vec3]:
    """Those of some spots where a thing touches nothing; it may have to rise above them."""
    for x, y, z in spots:
        for rise in _rises(world, held, (x, y, z), way):
            if is_free(world, held, (x, y, z + rise)):
                yield x, y, z + rise
                break


def _rises(world: World, held: str, spot: Vec3, way: _Way) -> list[float]:
    """How far above a spot a thing may be let go, metres, the least first."""
    if not way.is_last:
        return np.arange(0.0, MOST_RISE_M if way.lies_across else 1.5 * RISE_M, RISE_M).tolist()
    world.move_alone(held, spot)
    load = world.load_of(held)
    deepest = max((depth for other, depth in touched(world, held).items() if other not in load), default=0.0)
    return [rise for rise in HEAPS_M if rise >= deepest]  # a thing comes out of another no sooner
