"""Arrangements of a room: wished things hidden in their places, loose things moved about, all of it at rest.

An arrangement is made by geometry, settled by physics, and then looked at from the goal poses: what is hidden shows not
a single pixel before the manipulation, and enough after it. What fails is put elsewhere and tried again.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.floorplans.loose_objects import open_surfaces, put_anew
from remqa_data.generators.arrangement.hiding_check import (
    FulfilledWishes,
    HidingWish,
    Violation,
    blockers,
    ids_of,
    in_sight_violations,
    violations,
)
from remqa_data.generators.arrangement.hiding_place import HidingPlace, PlaceKey
from remqa_data.generators.arrangement.hiding_rules import hiding_rules
from remqa_data.generators.arrangement.wished_things import PACKED, WishedThings, parking
from remqa_data.geometry.types import Box, Vec3
from remqa_data.scene import Scene
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

SETTLED = 6
"""Physics is asked so often before what is wished for counts as impossible."""
STRAYED_M = 0.06
"""A loose thing that was put somewhere and rolls or falls farther than this is taken out of the room."""


@dataclass(frozen=True)
class Configuration:
    """One arrangement of a room.

    Attributes
    ----------
    scene : Scene
        The room at rest with everything closed.
    hidden : tuple of (HidingWish, tuple of str)
        Each wish and the ids of the things that fulfil it, in the order of the wishes.
    """

    scene: Scene
    hidden: tuple[tuple[HidingWish, tuple[str, ...]], ...]


def arrange(
    scene: Scene,
    places: Sequence[HidingPlace],
    wishes: Sequence[HidingWish],
    rng: np.random.Generator,
) -> Configuration:
    """One arrangement of a room that fulfils wishes.

    Parameters
    ----------
    scene : Scene
        The room as recorded.
    places : sequence of HidingPlace
        All its hiding places; things of the recording that are places stay where they are.
    wishes : sequence of HidingWish
        What to hide. A place can occur several times, with different types.
    rng : numpy.random.Generator
        Draws looks, places and turns; the same state gives the same arrangement.

    Returns
    -------
    Configuration
        Checked: every wished thing is in or under its place and at rest there, shows no pixel from the place's goal
        before the manipulation, and at least `min_evidence_px` of `hiding.yaml` after it; nothing else of its type is there.

    Raises
    ------
    ArrangementError
        If this cannot be done: names the place and what went wrong in the last attempt.
    """
    things = WishedThings.made(scene, wishes, rng)
    hidden = things.hidden
    with World(things.scene) as world:
        puts = {key: things.pack(world, key, rng) for key in things.by_place}
        things.put_all(world, puts)
        view = WorldView(world)
        lost = _move_loose_things(world, view, scene, places, hidden, rng)
        arranged = world.save()
        violations_found: list[Violation] = []
        tried: Counter[PlaceKey] = Counter()
        settled = 0
        while settled < SETTLED:
            world.restore(arranged)
            things.put_all(world, puts)
            violations_found = in_sight_violations(world, view, hidden)  # before physics, which takes longer
            if not violations_found:
                before = {object_id: world.state(object_id).position for object_id in world.ids}
                world.settle()
                settled += 1
                violations_found = violations(world, view, hidden, before)
            if not violations_found:
                strayed = _strayed(world, before, hidden, scene)
                return Configuration(_without(world.to_scene(), lost | strayed), hidden)
            for key in sorted({violation.place.key for violation in violations_found}):
                tried[key] += 1
                puts[key] = things.pack(world, key, rng)
            if max(tried.values()) >= PACKED:
                break
    raise things.error(violations_found[0], max(tried.values()))


def _move_loose_things(
    world: World,
    view: WorldView,
    scene: Scene,
    places: Sequence[HidingPlace],
    hidden: FulfilledWishes,
    rng: np.random.Generator,
) -> set[str]:
    """Clear the asked places and the views of them, and move a share of the other things; ids that found no place."""
    asked = {wish.place.object_id for wish, _ in hidden}
    covers = {place.object_id for place in places if place.manipulation == "Pickup"} | asked
    loose = [o.id for o in scene.objects if not o.is_fixed and o.id not in covers]
    in_the_way = _in_the_way(world, view, hidden)
    must = [object_id for object_id in loose if object_id in in_the_way]
    free = [object_id for object_id in loose if object_id not in in_the_way and not world.contents(object_id)]
    count = round(hiding_rules().moved_share * len(free))
    chosen = [free[i] for i in sorted(rng.choice(len(free), size=count, replace=False))] if count else []
    keep_out = _keep_out(world, [place for place in places if place.object_id in asked])
    surfaces = open_surfaces(world, asked)
    lost: set[str] = set()
    for object_id in [*must, *chosen]:
        moved = put_anew(world, object_id, scene.room_type, surfaces, keep_out, rng)
        if not moved and object_id in in_the_way:
            lost |= {object_id, *world.contents(object_id)}
            world.move(object_id, parking(world.ids.index(object_id)))
    return lost


def _in_the_way(world: World, view: WorldView, hidden: FulfilledWishes) -> set[str]:
    """What lies in places that are asked for or hides them, other than what was hidden there on purpose."""
    inside = {object_id for wish, _ in hidden for object_id in _inside(world, wish.place)}
    return (inside | blockers(world, view, hidden)) - ids_of(hidden)


def _inside(world: World, place: HidingPlace) -> list[str]:
    """Loose things that lie in a place that is opened, with what they hold."""
    if place.relation == "under":
        return []
    return world.contents(place.object_id)


def _keep_out(world: World, places: Sequence[HidingPlace]) -> list[Box]:
    """Boxes in the room that stay free: around what is moved or picked up, and where it goes."""
    boxes: list[Box] = []
    for place in places:
        if place.relation != "under":
            continue
        low, high = world.box(place.object_id)
        centre = np.array(world.state(place.object_id).position)
        for target in (tuple(centre), place.move_to):
            if target is not None:
                shift = np.asarray(target) - centre
                shift[2] = 0.0
                x0, y0, z0, x1, y1, z1 = (float(v) for v in np.concatenate([low + shift - 0.02, high + shift + 0.02]))
                boxes.append((x0, y0, z0, x1, y1, z1 + 0.1))
    return boxes


def _strayed(world: World, before: dict[str, Vec3], hidden: FulfilledWishes, scene: Scene) -> set[str]:
    """Loose things that did not stay where they were put."""
    mine = ids_of(hidden) | {wish.place.object_id for wish, _ in hidden}
    return {
        o.id
        for o in scene.objects
        if not o.is_fixed and o.id not in mine and math.dist(world.state(o.id).position, before[o.id]) > STRAYED_M
    }


def _without(scene: Scene, ids: set[str]) -> Scene:
    return scene.with_objects(tuple(o for o in scene.objects if o.id not in ids))
