"""Arrangements of a room: wished things hidden in their places, loose things moved about, all of it at rest.

An arrangement is made by geometry, settled by physics, and then looked at from the goal poses: what is hidden shows not
a single pixel before the manipulation, and enough after it. What fails is put elsewhere and tried again.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from remqa_data.assets import AssetSpec, build, variant_count
from remqa_data.catalog import object_type
from remqa_data.errors import ArrangementError
from remqa_data.generators.arrangement.hiding_check import (
    Hidden,
    Violation,
    Wished,
    blockers,
    in_sight_violations,
    partner_ids,
    violations,
)
from remqa_data.generators.arrangement.hiding_places import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import hidden_size, hiding_rules
from remqa_data.generators.arrangement.inner_packing import Link, packed_with_link
from remqa_data.generators.arrangement.loose_objects import SKIN_M, open_surfaces, put_anew
from remqa_data.generators.arrangement.packing import Put, packed
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Box, Vec3
from remqa_data.language.rules import similar_words
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

PACKED, SETTLED = 10, 6
"""What a place hides is put there in so many ways, and physics is asked so often, before it counts as impossible."""
LOOKS = 6
"""So many looks are tried for one that stands out from what the thing lies in."""
BESIDE_M = 0.4
"""So far from some recorded thing is the place that the id of a new thing names."""
STRAYED_M = 0.06
"""A loose thing that was put somewhere and rolls or falls farther than this is taken out of the room."""


@dataclass(frozen=True)
class Configuration:
    """One arrangement of a room.

    Attributes
    ----------
    scene : Scene
        The room at rest with everything closed.
    hidden : tuple of (Hidden, tuple of str)
        Each wish and the ids of the things that fulfil it, in the order of the wishes.
    """

    scene: Scene
    hidden: tuple[tuple[Hidden, tuple[str, ...]], ...]


def arrange(
    scene: Scene,
    places: Sequence[HidingPlace],
    wishes: Sequence[Hidden],
    rng: np.random.Generator,
    moved_share: float | None = None,
) -> Configuration:
    """One arrangement of a room that fulfils wishes.

    Parameters
    ----------
    scene : Scene
        The room as recorded.
    places : sequence of HidingPlace
        All its hiding places; things of the recording that are places stay where they are.
    wishes : sequence of Hidden
        What to hide. A place can occur several times, with different types.
    rng : numpy.random.Generator
        Draws looks, places and turns; the same state gives the same arrangement.
    moved_share : float, optional
        Share of the other loose things that find a new place; by default that of `hiding.yaml`.

    Returns
    -------
    Configuration
        Checked: every wished thing is in or under its place and at rest there, shows no pixel from the place's goal
        before the manipulation, and at least `viewpoints.MIN_PIXELS` after it; nothing else of its type is there.

    Raises
    ------
    ArrangementError
        If this cannot be done: names the place and what went wrong in the last attempt.
    """
    share = hiding_rules().moved_share if moved_share is None else moved_share
    made = _make(scene, wishes, rng)
    base = _closed(scene)
    hidden = tuple((wish, tuple(o.id for o in things)) for wish, things in zip(wishes, made, strict=True))
    by_place = _by_place(hidden)
    everything = sorted((*base.objects, *(o for things in made for o in things)), key=lambda o: o.id)
    with World(base.with_objects(tuple(everything))) as world:
        links = _links(hidden, by_place)
        puts = {key: _pack(world, scene, by_place[key], links.get(key), rng) for key in by_place}
        _put_all(world, scene, by_place, puts)
        view = WorldView(world)
        lost = _move_loose_things(world, view, scene, places, hidden, share, rng)
        arranged = world.save()
        violations_found: list[Violation] = []
        tried: Counter[Key] = Counter()
        settled = 0
        while settled < SETTLED:
            world.restore(arranged)
            _put_all(world, scene, by_place, puts)
            violations_found = in_sight_violations(world, view, hidden)  # before physics, which takes longer
            if not violations_found:
                before = {object_id: world.state(object_id).position for object_id in world.ids}
                world.settle()
                settled += 1
                violations_found = violations(world, view, hidden, before)
            if not violations_found:
                strayed = _strayed(world, before, hidden, scene)
                return Configuration(_without(world.to_scene(), lost | strayed), hidden)
            for key in sorted({(t.place.object_id, t.place.manipulation) for t in violations_found}):
                tried[key] += 1
                puts[key] = _pack(world, scene, by_place[key], links.get(key), rng)
            if max(tried.values()) >= PACKED:
                break
    first = violations_found[0]
    msg = (
        f"{scene.name}: cannot hide things {first.place.relation} {first.place.object_id}: {first.reason}; "
        f"tried {max(tried.values())} times; wish for fewer or smaller things there"
    )
    raise ArrangementError(msg, first.place.object_id, first.place.relation, [first.type])


def check_room(scene: Scene, wishes: Sequence[Hidden], rng: np.random.Generator) -> None:
    """Look whether places have room for all that is wished there, without making anything.

    Raises
    ------
    ArrangementError
        If one has not: names the place and the things.
    """
    hidden = [
        (wish, tuple(f"{number} {wish.type} {n}" for n in range(wish.count))) for number, wish in enumerate(wishes)
    ]
    types = {name: wish.type for wish, names in hidden for name in names}
    by_place = _by_place(hidden)
    links = _links(hidden, by_place)
    for key, (place, names) in by_place.items():
        sizes = [_largest_size(types[name]) for name in names]
        _packed(scene, place, [types[name] for name in names], sizes, links.get(key), rng)


def has_room(place: HidingPlace, types: Sequence[str]) -> bool:
    """Whether things of some types, each named as often as there are, fit a place at the same time, however large they come."""
    sizes = [_largest_size(name) for name in types]
    return packed(place.areas, sizes, hiding_rules().gap_m, np.random.default_rng(0)) is not None


Key = tuple[str, str]


def _make(scene: Scene, wishes: Sequence[Hidden], rng: np.random.Generator) -> list[list[SceneObject]]:
    """New things for each wish; sizes and looks vary."""
    spread = hiding_rules().size_spread
    known = {o.id for o in scene.objects}
    loose = [o for o in scene.objects if object_type(o.type).pickupable] or list(scene.objects)
    made = []
    for wish in wishes:
        things = []
        inside = similar_words(build(scene.object(wish.place.object_id).asset).color)
        for _ in range(wish.count):
            scale = 1.0 + float(rng.uniform(-spread, spread))
            w, d, h = (scale * side for side in hidden_size(wish.type))
            for _ in range(LOOKS):
                variant, seed = int(rng.integers(variant_count(wish.type))), int(rng.integers(1 << 16))
                spec = AssetSpec(wish.type, (w, d, h), variant, seed)
                if wish.place.relation != "in" or build(spec).color not in inside:
                    break
            name = _name(spec, loose[int(rng.integers(len(loose)))], known, rng)
            things.append(SceneObject(name, spec, _parking(len(known)), is_fixed=False))
            known.add(name)
        made.append(things)
    return made


def _name(spec: AssetSpec, beside: SceneObject, known: Collection[str], rng: np.random.Generator) -> str:
    """An id like those of recorded things: the type, and where it might have been when the room was recorded.

    That is beside some loose thing, on the same level, and says nothing about where it is.
    """
    bottom = beside.position[2] - beside.asset.size[2] / 2
    while True:
        x, y = (place + float(rng.uniform(-BESIDE_M, BESIDE_M)) for place in beside.position[:2])
        name = f"{spec.type}|{x:+06.2f}|{bottom + spec.size[2] / 2:+06.2f}|{y:+06.2f}"
        if name not in known:
            return name


def _parking(number: int) -> Vec3:
    """Far below the room, and far from one another, things wait."""
    return 0.0, 0.0, -50.0 - 2.0 * number


def _closed(scene: Scene) -> Scene:
    """The room with everything closed that things can be hidden in."""
    return scene.with_objects(
        tuple(replace(o, openness=0.0) if object_type(o.type).is_container else o for o in scene.objects)
    )


def _by_place(hidden: Wished) -> dict[Key, tuple[HidingPlace, tuple[str, ...]]]:
    grouped: dict[Key, tuple[HidingPlace, tuple[str, ...]]] = {}
    for wish, ids in hidden:
        key = (wish.place.object_id, wish.place.manipulation)
        grouped[key] = (wish.place, grouped.get(key, (wish.place, ()))[1] + ids)
    return grouped


def _links(hidden: Wished, by_place: Mapping[Key, tuple[HidingPlace, tuple[str, ...]]]) -> dict[Key, Link]:
    """How things are to lie to one another, in the places where that is wished; a place has one such wish at most."""
    found: dict[Key, Link] = {}
    for wish, ids in hidden:
        if wish.partner is not None:
            key = (wish.place.object_id, wish.place.manipulation)
            names = by_place[key][1]
            others = tuple(names.index(name) for name in partner_ids(hidden, wish))
            found[key] = Link(names.index(ids[0]), others, wish.partner.relation, wish.holds)
    return found


def _pack(
    world: World,
    scene: Scene,
    place_and_ids: tuple[HidingPlace, tuple[str, ...]],
    link: Link | None,
    rng: np.random.Generator,
) -> list[Put]:
    place, ids = place_and_ids
    sizes = [_plan_size(world.assets[object_id].spec) for object_id in ids]
    return _packed(scene, place, [world.type_of(object_id) for object_id in ids], sizes, link, rng)


def _packed(
    scene: Scene,
    place: HidingPlace,
    types: Sequence[str],
    sizes: Sequence[Vec3],
    link: Link | None,
    rng: np.random.Generator,
) -> list[Put]:
    if link is None:
        puts = packed(place.areas, sizes, hiding_rules().gap_m, rng)
    else:
        puts = packed_with_link(place, types, sizes, link, rng)
    if puts is None:
        names = ", ".join(types)
        msg = f"{scene.name}: no room {place.relation} {place.object_id} for {names}; wish for fewer or smaller things"
        raise ArrangementError(msg, place.object_id, place.relation, sorted(set(types)))
    return puts


def _largest_size(type_name: str) -> Vec3:
    grown = 1.0 + hiding_rules().size_spread
    width, depth, height = (grown * side for side in hidden_size(type_name))
    return width, depth, height


def _plan_size(spec: AssetSpec) -> Vec3:
    low, high = build(spec).bounds()
    x, y, z = (float(v) for v in high - low)
    return x, y, z


def _put_all(
    world: World,
    scene: Scene,
    by_place: dict[Key, tuple[HidingPlace, tuple[str, ...]]],
    puts: dict[Key, list[Put]],
) -> None:
    """Hidden things at their spots, a hair above what they lie on, and what covers them raised by their height."""
    for key, (place, ids) in sorted(by_place.items(), key=lambda item: item[1][0].relation):
        # What is "in" comes before what is "under": a box that is raised takes its contents along.
        heights = [np.ptp(world.assets[object_id].bounds()[:, 2]) for object_id in ids]
        if place.relation == "under" and ids:
            x, y, z = scene.object(place.object_id).position
            world.move(place.object_id, (x, y, z + float(max(heights)) + 2 * SKIN_M))
        for object_id, put in zip(ids, puts[key], strict=True):
            bounds = world.assets[object_id].bounds()
            x, y, z = put.position
            sine, cosine = arithmetic.sin_cos_deg(put.yaw_deg / 2)
            quaternion = (0.0, 0.0, float(sine), float(cosine))
            world.move_alone(object_id, _parking(world.ids.index(object_id)))  # so that it carries nothing along
            world.move(object_id, (x, y, z - float(bounds[0, 2]) + SKIN_M), quaternion)


def _move_loose_things(
    world: World,
    view: WorldView,
    scene: Scene,
    places: Sequence[HidingPlace],
    hidden: Wished,
    share: float,
    rng: np.random.Generator,
) -> set[str]:
    """Clear the asked places and the views of them, and move a share of the other things; ids that found no place."""
    mine = {object_id for _, ids in hidden for object_id in ids}
    covers = {place.object_id for place in places if place.manipulation == "Pickup"}
    covers |= {wish.place.object_id for wish, _ in hidden}
    loose = [o.id for o in scene.objects if not o.is_fixed and o.id not in covers]
    asked = {wish.place.object_id: wish.place for wish, _ in hidden}
    must = {o for wish, _ in hidden for o in _inside(world, wish.place)} | blockers(world, view, hidden)
    must = {object_id for object_id in must if object_id not in mine and object_id in set(loose)}
    free = [object_id for object_id in loose if object_id not in must and not world.contents(object_id)]
    count = round(share * len(free))
    chosen = [free[i] for i in sorted(rng.choice(len(free), size=count, replace=False))] if count else []
    keep_out = _keep_out(world, [place for place in places if place.object_id in asked])
    surfaces = open_surfaces(world, set(asked))
    lost: set[str] = set()
    for object_id in [*(o for o in loose if o in must), *chosen]:
        moved = put_anew(world, object_id, scene.room_type, surfaces, keep_out, rng)
        if not moved and object_id in must:
            lost |= {object_id, *world.contents(object_id)}
            world.move(object_id, _parking(world.ids.index(object_id)))
    return lost


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


def _strayed(world: World, before: dict[str, Vec3], hidden: Wished, scene: Scene) -> set[str]:
    """Loose things that did not stay where they were put."""
    mine = {object_id for _, ids in hidden for object_id in ids} | {wish.place.object_id for wish, _ in hidden}
    return {
        o.id
        for o in scene.objects
        if not o.is_fixed and o.id not in mine and math.dist(world.state(o.id).position, before[o.id]) > STRAYED_M
    }


def _without(scene: Scene, ids: set[str]) -> Scene:
    return scene.with_objects(tuple(o for o in scene.objects if o.id not in ids))
