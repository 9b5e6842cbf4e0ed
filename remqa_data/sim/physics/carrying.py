"""What goes along with a thing that moves, or with a part of it: what rests on it, and on what rests on it.

Contacts tell. A mug in a drawer rests on the drawer's floor, a book on a book on the tray, a pen in a box on the box, and
all go along; what lies on the desk above rests on the desk and stays. What rests partly on something else stays too.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Protocol

import numpy as np

from remqa_data.assets.core.model import Asset
from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic, boxes
from remqa_data.geometry.types import F64
from remqa_data.sim.physics.bodies import Bodies, Part
from remqa_data.sim.physics.state import ObjectState


class WorldLike(Protocol):
    """What must be known of a `World`; see there."""

    @property
    def assets(self) -> Mapping[str, Asset]:
        """By object id."""

    def box(self, object_id: str) -> F64:
        """(2, 3) corners."""

    def state(self, object_id: str) -> ObjectState:
        """Where an object is."""

    def type_of(self, object_id: str) -> str:
        """Type of an object."""

    def link_poses(self, object_id: str) -> F64:
        """(links, 4, 4) poses."""


NEAR_M = 0.01
"""Who rests on a thing has a box that comes so near to the thing's own."""


def riders(
    world: WorldLike,
    bodies: Bodies,
    object_id: str,
    link: int | None = None,
    *,
    along: Collection[str] = (),
    or_lean: bool = False,
) -> set[str]:
    """Ids of the things that go along with an object, or with one link of it.

    Parameters
    ----------
    world : WorldLike
        The room.
    bodies : Bodies
        Its side of PyBullet.
    object_id : str
        What moves.
    link : int, optional
        Which part of it moves; by default all of it.
    along : collection of str
        What moves as one with it, whatever it rests on; not among what is found.
    or_lean : bool
        Whether to count what rests on something else too, and would stay or fall.
    """
    carriers: dict[str, set[Part]] = {}
    group, found = (object_id, *along), set(along)
    news = [*group]
    while news:
        for other in sorted(bodies.around(world.box(news.pop()), NEAR_M) - found - {object_id}):
            if not _can_ride(world, other):
                continue
            if other not in carriers:
                carriers[other] = bodies.carriers(other, world.box(other))
            rests = any(_moves(part, object_id, link, found) for part in carriers[other])
            if rests or (not carriers[other] and any(_is_enclosed(world, other, one, link) for one in group)):
                found.add(other)
                news.append(other)
    if or_lean:
        return found.difference(along)
    while held_back := {
        other
        for other in found.difference(along)
        if any(not _moves(part, object_id, link, found) for part in carriers[other])
    }:
        found -= held_back
    return found.difference(along)


def met_nothing(paths: Mapping[str, tuple[F64, F64]], awake: Collection[str]) -> list[str]:
    """Who of those that have moved has come near nothing that was awake, nor near anything that had.

    Parameters
    ----------
    paths : mapping of str to pair of (2, 3) array
        By id, the box of each before and after.
    awake : collection of str
        Who moved by itself.
    """
    swept = [[*np.minimum(was[0], box[0]), *np.maximum(was[1], box[1])] for was, box in paths.values()]
    is_near = boxes.gap(swept, swept) <= NEAR_M if swept else np.zeros((0, 0), dtype=np.bool_)
    met = np.array([name in awake for name in paths], dtype=np.bool_)
    while (more := is_near[met].any(axis=0) & ~met).any():
        met |= more
    return [name for name, has_met in zip(paths, met.tolist(), strict=True) if not has_met]


def _can_ride(world: WorldLike, object_id: str) -> bool:
    return object_type(world.type_of(object_id)).is_loose or not world.state(object_id).is_fixed


def _moves(part: Part, object_id: str, link: int | None, found: set[str]) -> bool:
    return part.object_id in found or (part.object_id == object_id and link in (None, part.link))


def _is_enclosed(world: WorldLike, other: str, object_id: str, link: int | None) -> bool:
    """Whether the middle of a thing that touches nothing below it is inside something closed all around."""
    poses, middle = world.link_poses(object_id), world.state(other).position
    for space in world.assets[object_id].spaces:
        if space.enclosed and link in (None, space.link):
            local = arithmetic.moved_back(middle, poses[space.link])
            if (local > space.box[:3]).all() and (local < space.box[3:]).all():
                return True
    return False
