import math
import re
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from remqa_data.errors import ArrangementError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.arrangement import configurations
from remqa_data.generators.arrangement.areas import Area
from remqa_data.generators.arrangement.configurations import Configuration, arrange
from remqa_data.generators.arrangement.fitting_types import fitting_types
from remqa_data.generators.arrangement.hiding_check import HidingWish, Violation, goal_camera, manipulated
from remqa_data.generators.arrangement.hiding_rules import hiding_rules
from remqa_data.generators.arrangement.inner_packing import inner_fits
from remqa_data.generators.arrangement.packing import packed
from remqa_data.generators.arrangement.wished_things import WishedThings
from remqa_data.generators.questions.questions import confusable
from remqa_data.language.inner_relations import Partner
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from tests.helpers.places import places_of

ROOMS = ("FloorPlan7", "FloorPlan318")


def wishes_for(room: str, number: int) -> list[HidingWish]:
    """A thing or more in each second place, of a type that fits well."""
    rng = np.random.default_rng(number)
    wishes = []
    for place in places_of(room)[number % 2 :: 2]:
        count = min(2, len(place.spots))
        found = fitting_types(place, load_scene(room).room_type, count)
        types = [pair for pair in found if pair[1] >= 0.4]  # what shows 200 pixels and more in most of the place
        if types:
            best = max(types, key=lambda pair: pair[1])[0]
            wishes.append(HidingWish(place, best, int(rng.integers(count + 1))))
    one_each = {wish.place.object_id: wish for wish in wishes}
    return list(one_each.values())[:6]


@cache
def arranged(room: str, number: int) -> Configuration:
    return arrange(load_scene(room), places_of(room), wishes_for(room, number), np.random.default_rng(number))


CASES = [(room, number) for room in ROOMS for number in (0, 1)]


@pytest.mark.slow
@pytest.mark.parametrize(("room", "number"), CASES)
def test_things_are_where_they_were_wished_and_nothing_else_of_their_type_is(room: str, number: int) -> None:
    made = arranged(room, number)
    assert made.hidden
    assert [wish for wish, _ in made.hidden] == wishes_for(room, number)
    with World(made.scene) as world:
        records = object_metadata(world)
        for wish, ids in made.hidden:
            assert len(ids) == wish.count
            assert all(records[object_id].type == wish.type for object_id in ids)
            if wish.place.relation == "in":
                held = {r.id for r in records.values() if r.support == wish.place.object_id and r.support_kind == "in"}
                assert {object_id for object_id in held if records[object_id].type == wish.type} == set(ids)
            for object_id in ids:
                if wish.place.relation == "under":
                    below, above = records[object_id].box, records[wish.place.object_id].box
                    hollow = world.assets[wish.place.object_id].hollow
                    depth = hollow[5] - hollow[2] if hollow is not None else 0.0
                    assert below[5] <= above[2] + depth + 0.005
                    assert above[0] <= (below[0] + below[3]) / 2 <= above[3]


@pytest.mark.slow
@pytest.mark.parametrize(("room", "number"), CASES)
def test_hidden_things_show_no_pixel_before_and_enough_after(room: str, number: int) -> None:
    made = arranged(room, number)
    assert any(ids for _, ids in made.hidden)
    with World(made.scene) as world:
        view = WorldView(world)
        for wish, ids in made.hidden:
            rows = [world.ids.index(object_id) for object_id in ids]
            camera = goal_camera(wish.place)
            assert not view.pixels(camera)[rows].any()
            with manipulated(world, view, wish.place):
                assert (view.pixels(camera)[rows] >= 120).all()


@pytest.mark.slow
@pytest.mark.parametrize(("room", "number"), CASES[::2])
def test_an_arrangement_is_at_rest_and_closed(room: str, number: int) -> None:
    made = arranged(room, number)
    mine = {object_id for _, ids in made.hidden for object_id in ids}
    assert mine
    with World(made.scene) as world:
        before = {object_id: np.array(world.state(object_id).position) for object_id in mine}
        assert all(world.state(wish.place.object_id).openness == 0.0 for wish, _ in made.hidden)
        world.settle()
        for object_id in mine:
            assert np.linalg.norm(before[object_id] - world.state(object_id).position) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize(("room", "number"), CASES)
def test_hidden_things_are_named_and_listed_like_all_others(room: str, number: int) -> None:
    made = arranged(room, number)
    ids = [o.id for o in made.scene.objects]
    assert ids == sorted(ids)
    mine = {object_id for _, hidden in made.hidden for object_id in hidden}
    assert mine
    # AI2-THOR's: the type, then x, height and y of some place, each with its sign and two decimals
    assert all(re.fullmatch(r"[A-Za-z]+(\|[+-]\d\d\.\d\d){3}", object_id) for object_id in mine)
    for object_id in mine:
        x, z, y = (float(number) for number in object_id.split("|")[1:])
        assert math.dist((x, y, z), made.scene.object(object_id).position) > 0.005  # it does not say where it is


@pytest.mark.slow
def test_the_generator_decides_everything() -> None:
    room, number = CASES[-1]
    again = arrange(load_scene(room), places_of(room), wishes_for(room, number), np.random.default_rng(number))
    assert again == arranged(room, number)
    other = arrange(load_scene(room), places_of(room), wishes_for(room, number), np.random.default_rng(98))
    assert other.scene != again.scene


@pytest.mark.slow
def test_the_order_in_which_violated_places_are_packed_again_is_no_hash_order(monkeypatch: pytest.MonkeyPatch) -> None:
    room = "FloorPlan7"
    wishes = [*wishes_for(room, 0), *wishes_for(room, 1)]
    packed_again: list[str] = []
    pack = WishedThings.pack

    def noted(things: WishedThings, world: World, key: tuple[str, str], rng: np.random.Generator):
        packed_again.append(key[0])
        return pack(things, world, key, rng)

    def all_violated(*_: object) -> list[Violation]:
        return [Violation(wish.place, wish.type, "for the test") for wish in wishes]

    monkeypatch.setattr(WishedThings, "pack", noted)
    monkeypatch.setattr(configurations, "in_sight_violations", all_violated)
    with pytest.raises(ArrangementError, match="for the test"):
        arrange(load_scene(room), places_of(room), wishes, np.random.default_rng(0))
    rounds = np.array(packed_again[len(wishes) :]).reshape(-1, len(wishes))
    assert len(wishes) >= 5  # a hash order is sorted once in 120 times
    assert (rounds == sorted(rounds[0])).all()


@pytest.mark.slow
def test_a_share_of_the_loose_things_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, places = load_scene("FloorPlan318"), places_of("FloorPlan318")
    positions = {o.id: o.position for o in scene.objects}

    def moved(share: float) -> int:
        rules = hiding_rules().model_copy(update={"moved_share": share})
        monkeypatch.setattr(configurations, "hiding_rules", lambda: rules)
        made = arrange(scene, places, [], np.random.default_rng(3))
        return sum(np.linalg.norm(np.subtract(o.position, positions[o.id])) > 0.1 for o in made.scene.objects)

    assert moved(0.0) == 0
    assert moved(1.0) >= 5


@pytest.mark.slow
def test_too_many_things_are_refused_with_the_place() -> None:
    place = next(place for place in places_of("FloorPlan7") if place.type == "Microwave")
    with pytest.raises(ArrangementError, match=r"FloorPlan7: no room in Microwave.*wish for fewer"):
        arrange(
            load_scene("FloorPlan7"), places_of("FloorPlan7"), [HidingWish(place, "Pot", 9)], np.random.default_rng(0)
        )


@pytest.mark.slow
@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.floats(0.02, 0.2), st.floats(0.02, 0.2)), min_size=1, max_size=6),
    st.integers(0, 1000),
    st.floats(-180, 180),
)
def test_packed_things_keep_apart_and_inside(sides: list[tuple[float, float]], seed: int, yaw: float) -> None:
    area = Area((0.0, 0.0, 0.0), yaw, (0.3, 0.2), 0.3)
    puts = packed([area], [(w, d, 0.1) for w, d in sides], 0.0, np.random.default_rng(seed))
    assume(puts is not None)
    assert len(puts) == len(sides)
    circles = [(np.array(put.position[:2]), min(side) / 2) for put, side in zip(puts, sides, strict=True)]
    for i, (centre, radius) in enumerate(circles):
        turn = np.radians(yaw)
        local = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) @ centre
        assert np.all(np.abs(local) + radius <= np.array(area.half) + 1e-9)
        assert all(np.linalg.norm(centre - other) >= radius + width - 1e-9 for other, width in circles[:i])


def test_rows_are_found_where_chance_leaves_no_room() -> None:
    # by hand: four squares of 0.1 m fill 0.2 m x 0.2 m to the edge
    area = Area((0.0, 0.0, 0.0), 0.0, (0.1001, 0.1001), 0.3)
    assert packed([area], [(0.1, 0.1, 0.1)] * 4, 0.0, np.random.default_rng(0)) is not None
    assert packed([area], [(0.1, 0.1, 0.1)] * 5, 0.0, np.random.default_rng(0)) is None


def inner_wishes(room: str, holds: bool) -> list[HidingWish]:
    """A wish for each relation, each in another place: two types that can lie so there and are well seen."""
    scene, wishes, taken = load_scene(room), list[HidingWish](), set[str]()
    for relation in ("behind", "on", "between", "next to"):
        found = []
        for number, place in enumerate(places_of(room)):
            if place.relation == "in" and place.object_id not in taken:
                weights = dict(fitting_types(place, scene.room_type, 1))
                found += [
                    (min(weights[one], weights[two]), -number, one, two)
                    for one in weights
                    for two in weights
                    if not confusable(one, two) and inner_fits(place, one, Partner(relation, two))
                ]
        _, number, one, two = max(found)
        place, partner = places_of(room)[-number], Partner(relation, two)
        wishes += [HidingWish(place, two, partner.count), HidingWish(place, one, 1, partner, holds)]
        taken.add(place.object_id)
    return wishes


@pytest.mark.slow
@pytest.mark.parametrize("holds", [True, False])
def test_things_lie_to_one_another_as_wished_when_all_is_at_rest(holds) -> None:
    wishes = inner_wishes("FloorPlan7", holds)
    assert {wish.partner.relation for wish in wishes if wish.partner} == {"behind", "on", "between", "next to"}
    made = arrange(load_scene("FloorPlan7"), places_of("FloorPlan7"), wishes, np.random.default_rng(1))
    ids = {(wish.place.object_id, wish.type): found for wish, found in made.hidden}
    with World(made.scene) as world:
        records = object_metadata(world)
    for wish in wishes:
        if wish.partner is None:
            continue
        (one,) = ids[wish.place.object_id, wish.type]
        others = [np.array(records[name].box) for name in ids[wish.place.object_id, wish.partner.type]]
        sine, cosine = np.sin(np.radians(turn := records[wish.place.object_id].facing_deg)), np.cos(np.radians(turn))
        box, other = np.array(records[one].box), np.mean(others, axis=0)
        middle, there = (box[:3] + box[3:]) / 2, (other[:3] + other[3:]) / 2
        to_back = -(middle - there)[:2] @ [cosine, sine]
        aside = abs((middle - there)[:2] @ [-sine, cosine])
        near = np.linalg.norm((middle - there)[:2]) < 0.5 * np.linalg.norm(
            (box[3:] - box[:3] + other[3:] - other[:3])[:2]
        )
        so = {
            "behind": to_back > 0.02 and to_back > aside,
            "on": box[2] > other[2] + 0.002 and np.all(middle[:2] > other[:2]) and np.all(middle[:2] < other[3:5]),
            "between": np.linalg.norm((middle - there)[:2]) < 0.06,
            "next to": near and aside > to_back,
        }
        if holds or wish.partner.relation != "next to":  # what is not next to it may still be rather near
            assert so[wish.partner.relation] == holds, wish
