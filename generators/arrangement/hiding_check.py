"""Looks whether hidden things are hidden: at rest in their place, out of sight before the manipulation, in sight after."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from remqa_data.generators.arrangement.hiding_place import HidingPlace, PlaceKey
from remqa_data.generators.arrangement.hiding_rules import hiding_rules
from remqa_data.generators.arrangement.interior_view import LEAST_SHARE, depth_looks, looks_about, share_in_view
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F32, F64, Vec3
from remqa_data.language.inner_relations import Partner, clearly_related
from remqa_data.sim.metadata import ObjectMetadata, object_metadata
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.contrast import RING_PX, contrast_de
from remqa_data.sim.render.view import WorldView

SLIPPED_M = 0.06
"""Hidden things come to rest within this distance of where they were put."""
COVERED, SUNK_M, NEAR_M = 0.8, 0.045, 0.03
"""Under a thing lies what it covers to this share, with its top so little above or below the thing's bottom."""
TILTED_DEG = 20.0
"""What lies over a hidden thing stays about level."""
CLEAR_DE = 13.0
"""What differs so much from what is around it (CIE76) still stands out when the picture is stored as JPEG."""


@dataclass(frozen=True)
class HidingWish:
    """A wish for one configuration: so many things of a type in or under a place; 0 asks that there be none.

    Attributes
    ----------
    place : HidingPlace
        Where.
    type : str
        Of what type.
    count : int
        How many.
    partner : Partner, optional
        What it lies on, next to, behind or between, all in the same place; those are wished for as well.
    holds : bool
        Whether it does, or clearly does not.
    is_asked : bool
        Whether the room's quota counts on a question about it in this configuration: where it asks for what is not to be
        there, one is to see that there is none.
    """

    place: HidingPlace
    type: str
    count: int
    partner: Partner | None = None
    holds: bool = True
    is_asked: bool = False


Pixels = npt.NDArray[np.int64]
FulfilledWishes = Sequence[tuple[HidingWish, tuple[str, ...]]]
"""Each wish, and the ids of the things that fulfil it."""


@dataclass(frozen=True)
class Violation:
    """What is wrong with things of a type that a place should hide."""

    place: HidingPlace
    type: str
    reason: str


def goal_camera(place: HidingPlace) -> Camera:
    """The agent's camera at the goal of a place, 300 x 300."""
    return place.goal.camera_above(place.floor_z)


@contextmanager
def manipulated(world: World, view: WorldView, place: HidingPlace) -> Iterator[list[str]]:
    """The world after the manipulation of a place, for the length of a block; yields what was carried along."""
    snapshot = world.save()
    carried: list[str] = []
    try:
        if place.manipulation == "Open":
            carried = world.open(place.object_id, 1.0)
        elif place.manipulation == "Pickup":
            view.hide(place.object_id)
        else:
            assert place.move_to is not None
            carried = world.move(place.object_id, place.move_to)  # as the replay of the oracle's actions does
        yield carried
    finally:
        view.hide(place.object_id, False)
        world.restore(snapshot)


def ids_of(hidden: FulfilledWishes) -> set[str]:
    """Of everything that was hidden on purpose."""
    return {object_id for _, ids in hidden for object_id in ids}


def in_sight_violations(world: World, view: WorldView, hidden: FulfilledWishes) -> list[Violation]:
    """What is seen before the manipulation, or not after it, or may be missed there; at most one violation for each wish."""
    looks, found = _Looks(world, view, hidden), []
    for wish, ids in hidden:
        reason = _ill_seen(looks, wish.place, ids)
        if reason is None and wish.is_asked and wish.count == 0:
            share = looks.share(wish.place, wish.type)
            if share < LEAST_SHARE:
                reason = f"of {share:.0%} of the ways in which there could be one, one would see it"
        if reason is not None:
            found.append(Violation(wish.place, wish.type, reason))
    return found


def faint_violations(world: World, view: WorldView, hidden: FulfilledWishes) -> list[Violation]:
    """Which wished things do not stand out from what is around them once they come to light; pictures with light take long."""
    found = []
    places = {wish.place.key: wish.place for wish, ids in hidden if wish.is_asked and ids}
    for key, place in places.items():
        asked = [name for wish, ids in hidden if wish.is_asked and wish.place.key == key for name in ids]
        camera = goal_camera(place)
        with manipulated(world, view, place):
            # With the pixels beside those that count, which the edges depend on.
            seen = view.render(camera, scissor=view.scissor_around(camera, asked, RING_PX + 3))
        for wish, ids in hidden:
            if wish.is_asked and wish.place.key == key:
                least = min(
                    (contrast_de(seen.rgb, seen.objects == world.ids.index(name)) for name in ids), default=math.inf
                )
                if least < CLEAR_DE:
                    found.append(
                        Violation(place, wish.type, f"it differs from what is around it by {least:.0f} Delta E only")
                    )
    return found


def violations(world: World, view: WorldView, hidden: FulfilledWishes, put_at: Mapping[str, Vec3]) -> list[Violation]:
    """What is wrong with the hidden things of a settled world, at most one violation for each wish.

    Parameters
    ----------
    world, view : World, WorldView
        The room with everything closed.
    hidden : sequence of (HidingWish, tuple of str)
        Each wish and the ids that fulfil it.
    put_at : mapping of str to Vec3
        Where everything was before physics.
    """
    records, looks = object_metadata(world), _Looks(world, view, hidden)
    found = []
    for wish, ids in hidden:
        place = wish.place
        alike = [record for record in records.values() if record.type == wish.type]
        partners = partner_ids(hidden, wish)
        related = {record.id for record in alike if _is_related(record, records[place.object_id], place.relation)}
        related |= {record.id for record in alike if record.support in partners}
        reason = _unrest(world, place, ids, put_at)
        if reason is None and related != set(ids):
            strays = sorted(related ^ set(ids))
            reason = f"{', '.join(strays)}: whether it is {place.relation} it is not as wished"
        if reason is None and wish.partner is not None:
            known = [records[name] for name in (place.object_id, *partners, *ids)]
            if clearly_related(known, ids[0], wish.partner.relation, partners) is not wish.holds:
                reason = f"{ids[0]} lies otherwise to {', '.join(partners)}"
        if reason is None:
            reason = _ill_seen(looks, place, ids)
        if reason is not None:
            found.append(Violation(place, wish.type, reason))
    return found


def partner_ids(hidden: FulfilledWishes, wish: HidingWish) -> tuple[str, ...]:
    """What a wished thing is to lie to: the things of its partner's type that are wished for in the same place."""
    if wish.partner is None:
        return ()
    same = ((other, ids) for other, ids in hidden if other.place is wish.place or other.place == wish.place)
    return next(ids for other, ids in same if other.type == wish.partner.type)


def _is_related(thing: ObjectMetadata, target: ObjectMetadata, relation: str) -> bool:
    if relation == "in":
        return (thing.support, thing.support_kind) == (target.id, "in")
    low, high = np.array(target.box[:3]), np.array(target.box[3:])
    thing_low, thing_high = np.array(thing.box[:3]), np.array(thing.box[3:])
    shared = np.minimum(high, thing_high)[:2] - np.maximum(low, thing_low)[:2]
    covered = np.prod(np.maximum(shared, 0.0)) / max(float(np.prod((thing_high - thing_low)[:2])), 1e-9)
    gap = low[2] - thing_high[2]
    is_apart = thing.id != target.id and thing.support != target.id
    return is_apart and covered >= COVERED and -SUNK_M <= gap <= NEAR_M


def _unrest(world: World, place: HidingPlace, ids: Sequence[str], put_at: Mapping[str, Vec3]) -> str | None:
    for object_id in (*ids, place.object_id):
        slipped = math.dist(world.state(object_id).position, put_at[object_id])
        if slipped > SLIPPED_M:
            return f"{object_id} slips by {slipped:.2f} m"
    tilt_deg = math.degrees(arithmetic.arccos(np.clip(world.state(place.object_id).matrix()[2, 2], -1.0, 1.0)))
    if place.relation == "under" and ids and tilt_deg > TILTED_DEG:
        return f"it tilts by {tilt_deg:.0f} degrees"
    return None


class _Looks:
    """How many pixels each object of a world shows at the goals of places; each is looked at once, for all its wishes."""

    def __init__(self, world: World, view: WorldView, hidden: FulfilledWishes) -> None:
        self.world, self.view = world, view
        self._things: defaultdict[PlaceKey, list[str]] = defaultdict(list)
        for wish, ids in hidden:
            self._things[wish.place.key] += ids
        self._after: dict[PlaceKey, Pixels] = {}
        self._proofs: dict[PlaceKey, tuple[F64 | None, list[tuple[Camera, F32]], list[F64]]] = {}

    def before(self, place: HidingPlace, ids: Sequence[str]) -> Pixels:
        """Of some hidden objects, before the manipulation."""
        camera, index = goal_camera(place), [self.world.ids.index(object_id) for object_id in ids]
        around = self.view.scissor_around(camera, ids)
        # What its place alone hides need not be looked at among all else, which takes ten times as long.
        alone = self.view.pixels(camera, self.view.parts_of((place.object_id, *ids)), around)[index]
        return self.view.pixels(camera, scissor=around)[index] if alone.any() else alone

    def share(self, place: HidingPlace, type_: str) -> float:
        """Of the ways in which a thing of a type could lie there beside what it hides, how many one sees after it."""
        key = place.key
        if key not in self._proofs:
            closed = self.world.link_poses(place.object_id)
            with manipulated(self.world, self.view, place):
                is_opened = place.manipulation == "Open"
                motion = self.world.motion_since(place.object_id, closed) if is_opened else None
                about = [pose.camera_above(place.floor_z) for pose in looks_about(place.goal)]
                looks = depth_looks(self.view, about, place.interior, motion)
                boxes = [self.world.box(object_id) for object_id in self._things[key]]
            self._proofs[key] = (motion, looks, boxes)
        motion, looks, boxes = self._proofs[key]
        return share_in_view(place.interior, motion, looks, boxes, type_)

    def after(self, place: HidingPlace, ids: Sequence[str]) -> Pixels:
        """Of some of the objects that a place hides, after it."""
        key, camera = place.key, goal_camera(place)
        if key not in self._after:
            with manipulated(self.world, self.view, place):
                around = self.view.scissor_around(camera, self._things[key])
                self._after[key] = self.view.pixels(camera, scissor=around)
        return self._after[key][[self.world.ids.index(object_id) for object_id in ids]]


def _ill_seen(looks: _Looks, place: HidingPlace, ids: Sequence[str]) -> str | None:
    if not ids:
        return None
    before = looks.before(place, ids)
    if before.any():
        return f"{ids[int(before.argmax())]} shows {before.max()} pixels before the manipulation"
    after = looks.after(place, ids)
    if after.min() < hiding_rules().min_evidence_px:
        return f"{ids[int(after.argmin())]} shows only {after.min()} pixels after the manipulation"
    return None


def blockers(world: World, view: WorldView, hidden: FulfilledWishes) -> set[str]:
    """Loose things that stand in front of asked places, or where their doors and drawers go."""
    found: set[str] = set()
    mine = ids_of(hidden)
    for place in {w.place.key: w.place for w, _ in hidden}.values():
        camera = goal_camera(place)
        closed = world.link_poses(place.object_id)
        with manipulated(world, view, place) as carried:
            depth, image = view.depth_and_instances(camera)
            motion = world.motion_since(place.object_id, closed)
            if place.manipulation == "Open":
                inside = set(world.contents(place.object_id)) | set(carried)
                found |= {o for o, d in world.overlapping(place.object_id) if d < -0.005 and o not in inside}
            elif place.manipulation == "Move":
                found |= {o for o, d in world.overlapping(place.object_id) if d < -0.005 and o not in carried}
        for area in place.areas:
            turn = motion[area.link] if place.manipulation == "Open" else np.eye(4)
            flat = area.lattice(0.03).reshape(-1, 2)
            points = area.to_room(np.column_stack([flat, np.full(len(flat), area.seen_from_m + 0.01)]))
            projected = camera.project(arithmetic.moved(points, turn))
            x, y, z = projected[camera.are_framed(projected)].T
            row, column = y.astype(int), x.astype(int)
            covered = depth[row, column] < z - 0.02
            found |= {world.ids[i] for i in np.unique(image[row, column][covered]) if i >= 0}
    return {o for o in found if o in world.ids and not world.state(o).is_fixed and o not in mine}
