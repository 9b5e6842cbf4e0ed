"""Things that are wished for: made, and put in or under their places so that one sees what one should and no more."""

from __future__ import annotations

import math
import zlib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from remqa_data.assets import AssetSpec, build, variant_count
from remqa_data.assets.looks.seen_colors import inner_colors, mean_color
from remqa_data.catalog import object_type
from remqa_data.errors import ArrangementError
from remqa_data.floorplans.loose_objects import SKIN_M
from remqa_data.generators.arrangement.hiding_check import (
    FulfilledWishes,
    HidingWish,
    Violation,
    faint_violations,
    in_sight_violations,
    partner_ids,
)
from remqa_data.generators.arrangement.hiding_place import HidingPlace, PlaceKey
from remqa_data.generators.arrangement.hiding_rules import hidden_size, hiding_rules, largest_size
from remqa_data.generators.arrangement.inner_packing import RelationConstraint, packed_with_constraint
from remqa_data.generators.arrangement.packing import Put, packed
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

PACKED = 10
"""What a place hides is put there in so many ways before it counts as impossible."""
SEEDS = 12
"""Each variant of a type comes in so many looks: iTHOR has fewer."""
LOOKS = 10
"""So many looks are tried for one that stands out from what the thing lies in."""
UNLIKE_DE = 45.0
"""Colours so far apart (CIE76, without light) are told apart in the shade of a cabinet."""
BESIDE_M = 0.4
"""So far from some recorded thing is the place that the id of a new thing names."""


@dataclass(frozen=True)
class WishedThings:
    """The things of all wishes for a room, made.

    Attributes
    ----------
    recorded : Scene
        The room as recorded.
    scene : Scene
        The room with everything closed, and with the things, which wait far below it.
    hidden : tuple of (HidingWish, tuple of str)
        Each wish and the ids of its things.
    by_place : mapping of PlaceKey to (HidingPlace, tuple of str)
        Each place and the ids of all its things.
    constraints : mapping of PlaceKey to RelationConstraint
        How things are to lie to one another, in the places where that is wished; a place has one such wish at most.
    """

    recorded: Scene
    scene: Scene
    hidden: tuple[tuple[HidingWish, tuple[str, ...]], ...]
    by_place: Mapping[PlaceKey, tuple[HidingPlace, tuple[str, ...]]]
    constraints: Mapping[PlaceKey, RelationConstraint]

    @classmethod
    def made(cls, scene: Scene, wishes: Sequence[HidingWish], rng: np.random.Generator) -> WishedThings:
        """Make them; sizes and looks vary."""
        made, base = _make(scene, wishes, rng), _closed(scene)
        hidden = tuple((wish, tuple(o.id for o in things)) for wish, things in zip(wishes, made, strict=True))
        by_place = _by_place(hidden)
        everything = sorted((*base.objects, *(o for things in made for o in things)), key=lambda o: o.id)
        return cls(scene, base.with_objects(tuple(everything)), hidden, by_place, _constraints(hidden, by_place))

    @property
    def is_seen(self) -> set[str]:
        """Ids of the things and of what hides them."""
        return {name for place, ids in self.by_place.values() for name in (place.object_id, *ids)}

    def pack(self, world: World, key: PlaceKey, rng: np.random.Generator) -> list[Put]:
        """Where the things of a place lie, at random; raises ArrangementError if it has no room for them."""
        place, ids = self.by_place[key]
        sizes = [_plan_size(world.assets[object_id].spec) for object_id in ids]
        types, constraint = [world.type_of(object_id) for object_id in ids], self.constraints.get(key)
        if constraint is None:
            puts = packed(place.areas, sizes, hiding_rules().gap_m, rng)
        else:
            puts = packed_with_constraint(place, types, sizes, constraint, rng)
        if puts is None:
            names = ", ".join(types)
            where = f"{place.relation} {place.object_id}"
            msg = f"{self.recorded.name}: no room {where} for {names}; wish for fewer or smaller things"
            raise ArrangementError(msg, place.object_id, place.relation, sorted(set(types)))
        return puts

    def put_all(self, world: World, puts: Mapping[PlaceKey, Sequence[Put]]) -> None:
        """Things at their spots, a hair above what they lie on; what covers them is raised by their height, or has a hollow."""
        for key in sorted(puts, key=lambda key: self.by_place[key][0].relation):
            # What is "in" comes before what is "under": a box that is raised takes its contents along.
            place, ids = self.by_place[key]
            heights = [np.ptp(world.assets[object_id].bounds()[:, 2]) for object_id in ids]
            if place.relation == "under" and ids and world.assets[place.object_id].hollow is None:
                x, y, z = self.recorded.object(place.object_id).position
                world.move(place.object_id, (x, y, z + float(max(heights)) + 2 * SKIN_M))
            for object_id, put in zip(ids, puts[key], strict=True):
                bounds = world.assets[object_id].bounds()
                x, y, z = put.position
                sine, cosine = arithmetic.sin_cos_deg(put.yaw_deg / 2)
                quaternion = (0.0, 0.0, float(sine), float(cosine))
                world.move_alone(object_id, parking(world.ids.index(object_id)))  # so that it carries nothing along
                world.move(object_id, (x, y, z - float(bounds[0, 2]) + SKIN_M), quaternion)

    def error(self, violation: Violation, tried: int) -> ArrangementError:
        """What is wrong with things of a type in a place, after so many ways of putting them there."""
        place = violation.place
        msg = (
            f"{self.recorded.name}: cannot hide things {place.relation} {place.object_id}: {violation.reason}; "
            f"tried {tried} times; wish for fewer or smaller things there"
        )
        return ArrangementError(msg, place.object_id, place.relation, [violation.type])


def has_room(place: HidingPlace, types: Sequence[str], asked: Sequence[str] = ()) -> bool:
    """Whether things of some types fit a place at the same time, however large they come, and hide none that is asked for.

    Parameters
    ----------
    place : HidingPlace
        Where.
    types : sequence of str
        Each named as often as there are things.
    asked : sequence of str
        Types of which one must see that there are none; what is much higher would stand before them.
    """
    sizes = [largest_size(name) for name in types]
    lowest = min((hidden_size(name)[2] for name in asked), default=math.inf)
    if max((height for _, _, height in sizes), default=0.0) > lowest + hiding_rules().higher_m:
        return False
    return packed(place.areas, sizes, hiding_rules().gap_m, np.random.default_rng(0)) is not None


def infeasible_wishes(scene: Scene, wishes: Sequence[HidingWish], rng: np.random.Generator) -> list[ArrangementError]:
    """The wishes that cannot be fulfilled, wherever things lie: for want of room, or because one sees too much or too little.

    All of it is found at once, in the room without its loose things; what physics does with them is not tried.

    Parameters
    ----------
    scene : Scene
        The room as recorded.
    wishes : sequence of HidingWish
        What to hide.
    rng : Generator
        As for `configurations.arrange`: with the same state the same things are made.
    """
    things = WishedThings.made(scene, wishes, rng)
    found: list[ArrangementError] = []
    seen = things.is_seen
    alone = things.scene.with_objects(tuple(o for o in things.scene.objects if o.is_fixed or o.id in seen))
    with World(alone) as world:
        view = WorldView(world)
        puts: dict[PlaceKey, list[Put]] = {}
        for key in things.by_place:
            try:
                puts[key] = things.pack(world, key, rng)
            except ArrangementError as error:
                found.append(error)
        at_first, seen_ill = world.save(), list[Violation]()
        waiting = set(puts)
        for _ in range(PACKED):
            world.restore(at_first)
            things.put_all(world, {key: puts[key] for key in things.by_place if key in waiting})
            still = [pair for pair in things.hidden if pair[0].place.key in waiting]
            seen_ill = in_sight_violations(world, view, still)
            ill = {violation.place.key for violation in seen_ill}
            seen_ill += faint_violations(world, view, [pair for pair in still if pair[0].place.key not in ill])
            waiting = {violation.place.key for violation in seen_ill}
            if not waiting:
                break
            for key in sorted(waiting):
                puts[key] = things.pack(world, key, rng)
    return found + [things.error(violation, PACKED) for violation in seen_ill]


def _make(scene: Scene, wishes: Sequence[HidingWish], rng: np.random.Generator) -> list[list[SceneObject]]:
    """New things for each wish; sizes and looks vary.

    With the same state of `rng`, the first cup in a place comes in the same size and looks whatever else is wished for: what
    was found to fit does so in other plans as well.
    """
    known = {o.id for o in scene.objects}
    loose = [o for o in scene.objects if object_type(o.type).pickupable] or list(scene.objects)
    seed = int(rng.integers(1 << 32))
    looks: dict[tuple[PlaceKey, str], Iterator[list[AssetSpec]]] = {}
    made = []
    for wish in wishes:
        things = []
        around = inner_colors(build(scene.object(wish.place.object_id).asset))
        key = wish.place.key, wish.type
        if key not in looks:
            looks[key] = _looks(wish.type, np.random.default_rng([seed, zlib.crc32(repr(key).encode())]))
        for _ in range(wish.count):
            spec = _unlike(next(looks[key]), around)
            name = _name(spec, loose[int(rng.integers(len(loose)))], known, rng)
            things.append(SceneObject(name, spec, parking(len(known)), is_fixed=False))
            known.add(name)
        made.append(things)
    return made


def _looks(type_: str, rng: np.random.Generator) -> Iterator[list[AssetSpec]]:
    """For one thing of a type after the other, the looks that it may have, all in one size."""
    spread = hiding_rules().size_spread
    while True:
        scale = 1.0 + float(rng.uniform(-spread, spread))
        w, d, h = (scale * side for side in hidden_size(type_))
        drawn = [(int(rng.integers(variant_count(type_))), int(rng.integers(SEEDS))) for _ in range(LOOKS)]
        yield [AssetSpec(type_, (w, d, h), variant, seed) for variant, seed in drawn]


def _unlike(specs: Sequence[AssetSpec], colors: Sequence[F64]) -> AssetSpec:
    """The first of some looks that stands out from some colours, or else the one that does most."""
    apart = []
    for spec in specs:
        color = _color(spec.type, spec.variant, spec.seed)  # what takes time: each look is built for it
        apart.append(min(float(arithmetic.length(color - other)) for other in colors))
        if apart[-1] >= UNLIKE_DE:
            return spec
    return specs[int(np.argmax(apart))]


@lru_cache(maxsize=1 << 13)
def _color(type_: str, variant: int, seed: int) -> F64:
    """The mean colour of a look, whatever its size."""
    return mean_color(build(AssetSpec(type_, hidden_size(type_), variant, seed)))


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


def parking(number: int) -> Vec3:
    """Far below the room, and far from one another, things wait."""
    return 0.0, 0.0, -50.0 - 2.0 * number


def _closed(scene: Scene) -> Scene:
    """The room with everything closed that things can be hidden in."""
    return scene.with_objects(
        tuple(replace(o, openness=0.0) if object_type(o.type).is_container else o for o in scene.objects)
    )


def _by_place(hidden: FulfilledWishes) -> dict[PlaceKey, tuple[HidingPlace, tuple[str, ...]]]:
    grouped: dict[PlaceKey, tuple[HidingPlace, tuple[str, ...]]] = {}
    for wish, ids in hidden:
        key = wish.place.key
        grouped[key] = (wish.place, grouped.get(key, (wish.place, ()))[1] + ids)
    return grouped


def _constraints(
    hidden: FulfilledWishes, by_place: Mapping[PlaceKey, tuple[HidingPlace, tuple[str, ...]]]
) -> dict[PlaceKey, RelationConstraint]:
    found: dict[PlaceKey, RelationConstraint] = {}
    for wish, ids in hidden:
        if wish.partner is not None:
            key = wish.place.key
            names = by_place[key][1]
            others = tuple(names.index(name) for name in partner_ids(hidden, wish))
            found[key] = RelationConstraint(names.index(ids[0]), others, wish.partner.relation, wish.holds)
    return found


def _plan_size(spec: AssetSpec) -> Vec3:
    low, high = build(spec).bounds()
    x, y, z = (float(v) for v in high - low)
    return x, y, z
