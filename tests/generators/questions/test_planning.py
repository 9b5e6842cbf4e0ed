import os
import zlib
from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from remqa_data.errors import QuotaError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.arrangement.fitting_types import fitting_types
from remqa_data.generators.arrangement.hiding_places import hiding_places
from remqa_data.generators.config import load_config
from remqa_data.generators.questions import planning
from remqa_data.generators.questions.allotment import SceneQuota, allot
from remqa_data.generators.questions.capacities import room_capacity
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.generators.questions.chosen_scenes import choose_scenes
from remqa_data.generators.questions.expressions import Expression, Expressions
from remqa_data.generators.questions.groups import group_shapes, shapes_of, wishes
from remqa_data.generators.questions.planning import Planner, plan_groups
from remqa_data.generators.questions.questions import confusable, mentioned_types
from remqa_data.generators.questions.selection import select
from remqa_data.generators.questions.sites import sites_of
from remqa_data.language.question_rules import question_rules
from remqa_data.published import MEAN_WORDS
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.physics.world import World
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import KINDS
from tests.helpers.stand_in_places import StandIn, stand_in_places, stand_in_types

pytestmark = pytest.mark.slow

PAPER = Path(__file__).parents[3] / "configs" / "paper.yaml"
SAMPLE = choose_scenes(12)
SPARE = dict.fromkeys(KINDS, 1)


@cache
def phrases_of(name: str):
    with World(load_scene(name)) as world:
        objects = object_metadata(world)
    room = Expressions(SceneGraph.from_objects(objects.values()))
    places = tuple(stand_in_places(objects))
    return places, {place.object_id: room.of(place.object_id) for place in places}


def rng_for(name: str, seed: int = 0) -> np.random.Generator:
    return np.random.default_rng([seed, zlib.crc32(name.encode())])


def plan(quota: SceneQuota, seed: int = 0, configurations: int = 4, spare=SPARE, clashes=None):
    places, phrases = phrases_of(quota.scene)
    return plan_groups(
        places,
        phrases,
        lambda p, _: stand_in_types(p, quota.room_type),
        quota,
        rng_for(quota.scene, seed),
        configurations,
        spare,
        clashes,
    )


@cache
def quotas():
    rooms = []
    for name in SAMPLE:
        places, phrases = phrases_of(name)
        room_type = load_scene(name).room_type
        rooms.append(room_capacity(places, phrases, lambda p, _, r=room_type: stand_in_types(p, r), name, room_type))
    totals = load_config(PAPER).with_scenes(12).totals
    return allot(rooms, {split: {k: n - n // 4 for k, n in by_kind.items()} for split, by_kind in totals.items()})


@pytest.mark.parametrize("index", range(12))
def test_groups_meet_the_quota_and_leave_no_doubt(index) -> None:
    quota = quotas()[index]
    groups = plan(quota)
    assert groups
    for kind in KINDS:
        asked = Counter(g.answers[c] for g in groups if g.question.kind == kind for c in g.asked)
        assert asked == Counter({answer: n for answer, n in quota.answers[kind].items() if n})
    assert len({g.name for g in groups}) == len({g.question.text for g in groups}) == len(groups)
    for group in groups:
        if group.asked:
            assert len({group.answers[c] for c in group.asked}) > 1
    for configuration in range(4):
        held: Counter[StandIn] = Counter()
        for wish in wishes(groups, configuration):
            held[wish.place] += wish.count
        assert all(count <= len(place.spots) for place, count in held.items())
    for one in groups:
        named = mentioned_types(one.question.expression.program)
        for other in groups:
            assert not any(confusable(a, other.question.type) for a in named)
            if one is not other and one.question.place.object_id == other.question.place.object_id:
                assert not confusable(one.question.type, other.question.type)


def types_by_place(groups) -> dict[tuple[str, str], set[str]]:
    found: dict[tuple[str, str], set[str]] = {}
    for group in groups:
        place = group.question.place
        found.setdefault((place.object_id, place.relation), set()).add(group.question.type)
    return found


def test_what_clashes_is_not_asked_for_in_one_place() -> None:
    clashes: dict[tuple[str, str], set[frozenset[str]]] = {}
    for _ in range(6):  # whatever comes together is ruled out, again and again
        groups = types_by_place(plan(quotas()[0], clashes=clashes))
        assert not any(clash <= groups.get(key, set()) for key, all_ in clashes.items() for clash in all_)
        for key, types in groups.items():
            if len(types) > 1:
                clashes.setdefault(key, set()).add(frozenset(sorted(types)[:2]))
    assert sum(map(len, clashes.values())) >= 6


def inner_plan(quota: SceneQuota, fits):
    places, phrases = phrases_of(quota.scene)
    types = lambda p, _: stand_in_types(p, quota.room_type)  # noqa: E731
    return plan_groups(places, phrases, types, quota, rng_for(quota.scene), 4, {}, None, fits)


def test_some_spatial_questions_ask_how_two_things_lie_and_both_are_wished_for_whatever_the_answer() -> None:
    found = 0
    for quota in quotas()[:6]:
        groups = inner_plan(quota, lambda place, type_, partner: True)
        found += sum(group.question.partner is not None for group in groups)
        for configuration in range(4):
            _check_inner_wishes(groups, configuration)
    assert found


def test_a_relation_that_is_never_to_be_asked_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    never = question_rules().model_copy(update={"inner_relations": {"on": 0, "next to": 1, "behind": 0, "between": 1}})
    monkeypatch.setattr(planning, "question_rules", lambda: never)
    asked = [
        group.question.partner.relation
        for quota in quotas()[:6]
        for group in inner_plan(quota, lambda place, type_, partner: True)
        if group.question.partner is not None
    ]
    assert {*asked} == {"next to", "between"}


def _check_inner_wishes(groups, configuration: int) -> None:
    made, held = wishes(groups, configuration), Counter[StandIn]()
    for wish in made:
        held[wish.place] += wish.count
    assert all(count <= len(place.spots) for place, count in held.items())
    for group in groups:
        question, partner = group.question, group.question.partner
        if partner is None:
            continue
        assert question.kind == "SPATIAL"
        assert question.words <= question_rules().inner_longest_words
        own = [w for w in made if w.place is question.place and w.type in question.types]
        assert Counter({w.type: w.count for w in own}) == {question.type: 1, partner.type: partner.count}
        assert [(w.partner, w.holds) for w in own if w.partner] == [(partner, group.answers[configuration] == "yes")]
        others = [g.question for g in groups if g is not group and g.question.place is question.place]
        assert not any(other.partner for other in others)
        types = [name for other in others for name in other.types]
        assert not any(confusable(a, b) for a in types for b in question.types)
        assert not confusable(question.type, partner.type)


def test_where_nothing_can_lie_as_asked_other_spatial_questions_step_in() -> None:
    quota = max(quotas(), key=lambda q: q.total("SPATIAL"))
    groups = inner_plan(quota, lambda place, type_, partner: False)
    assert not any(group.question.partner for group in groups)
    assert sum(len(g.asked) for g in groups if g.question.kind == "SPATIAL") == quota.total("SPATIAL")


def test_the_same_generator_gives_the_same_plan_and_another_one_another() -> None:
    assert plan(quotas()[0]) == plan(quotas()[0])
    assert plan(quotas()[0]) != plan(quotas()[0], seed=1)


def test_more_configurations_than_answers() -> None:
    groups = plan(quotas()[0], configurations=6)
    assert groups
    for group in groups:
        assert len(group.answers) == 6
        assert len(set(group.asked)) == len(group.asked)


def test_what_a_room_cannot_take_names_the_room_the_kind_and_what_there_is() -> None:
    full = {"yes": 100, "no": 100}
    quota = SceneQuota("FloorPlan403", "bathroom", "train", {"EXISTENCE": full, "COUNTING": {}, "SPATIAL": {}})
    with pytest.raises(QuotaError, match=r"FloorPlan403: EXISTENCE: 200 questions need more places .* spots in all"):
        plan(quota, spare={})


@given(st.dictionaries(st.sampled_from("0123"), st.integers(0, 20), min_size=2), st.integers(2, 6))
def test_shapes_add_up_to_as_many_groups_as_can_be_or_are_refused(quota, most) -> None:
    total, others = sum(quota.values()), sum(quota.values()) - max(quota.values())
    try:
        shapes = group_shapes(quota, most, "here")
    except QuotaError:
        assert total > most * min(total // 2, others)  # each group needs one of the rarer answers
        return
    assert sum(map(Counter, shapes), Counter()) == +Counter(quota)
    assert all(len(shape) > 1 and sum(shape.values()) <= most for shape in shapes)
    assert len(shapes) == min(total // 2, others)


@given(st.fixed_dictionaries({answer: st.integers(0, 9) for answer in "0123"}))
def test_a_question_about_how_many_has_every_answer_once_as_far_as_that_can_be(quota) -> None:
    try:
        fewest = len(group_shapes(quota, 4, "here"))
    except QuotaError:
        with pytest.raises(QuotaError):
            shapes_of("COUNTING", quota, 4, "here")
        return
    shapes = shapes_of("COUNTING", quota, 4, "here")
    assert len(shapes) <= fewest
    assert sum(map(Counter, shapes), Counter()) == +Counter(quota)
    assert all(len(shape) > 1 and sum(shape.values()) <= 4 for shape in shapes)
    if len(set(quota.values())) == 1:
        assert shapes == [dict.fromkeys("0123", 1)] * quota["0"]
    assert shapes_of("SPATIAL", quota, 4, "here") == group_shapes(quota, 4, "here")


def test_a_question_is_asked_twice_unless_there_is_no_other_to_ask() -> None:
    owed = next(q for q in quotas() if q.room_type == "kitchen" and all(q.total(kind) >= 4 for kind in KINDS))
    whole = {kind: dict.fromkeys(n, owed.total(kind) // 4 * 4 // len(n)) for kind, n in owed.answers.items()}
    quota = replace(owed, answers=whole)
    groups = plan(quota, spare={})
    sizes = Counter(len(group.asked) for group in groups if group.question.kind != "COUNTING")
    assert sizes[2] > 0.9 * sum(sizes.values())
    assert {group.asked for group in groups if group.question.kind == "COUNTING"} == {(0, 1, 2, 3)}
    places, phrases = phrases_of(quota.scene)
    planner = Planner(
        sites_of(places, phrases, lambda p, _: stand_in_types(p, "kitchen")[:2]), "here", 4, rng_for("here")
    )
    while planner.add("EXISTENCE", {"yes": 1, "no": 1}):
        pass
    assert 4 in {len(group.asked) for group in planner.chosen.groups}
    asked = [group.answers[c] for group in planner.chosen.groups for c in group.asked]
    assert asked.count("yes") == asked.count("no")
    for place in places:
        held = np.sum([g.counts for g in planner.chosen.groups if g.question.place == place] or [[0]], axis=0)
        assert held.max() <= len(place.spots)


def test_no_type_is_asked_for_often_where_there_are_others() -> None:
    types = Counter(group.question.type for group in plan(quotas()[0]))
    assert types.most_common(1)[0][1] <= question_rules().max_groups_per_type


def test_selection_keeps_what_was_asked_unless_something_was_refused() -> None:
    quota = quotas()[0]
    groups = plan(quota)
    everything = {g.name: range(4) for g in groups}
    assert select(groups, everything, quota) == {g.name: g.asked for g in groups if g.asked}


@settings(max_examples=30)
@given(st.data())
def test_selection_is_exact_whatever_is_refused_or_says_why_not(data) -> None:
    quota = quotas()[0]
    groups = plan(quota)
    refused = data.draw(st.sets(st.tuples(st.integers(0, len(groups) - 1), st.integers(0, 3)), max_size=4))
    passed = {g.name: [c for c in range(4) if (i, c) not in refused] for i, g in enumerate(groups)}
    try:
        chosen = select(groups, passed, quota)
    except QuotaError:
        assert refused
        return
    by_name = {g.name: g for g in groups}
    for kind in KINDS:
        own = {name: c for name, c in chosen.items() if by_name[name].question.kind == kind}
        answers = Counter(by_name[name].answers[c] for name, configurations in own.items() for c in configurations)
        assert answers == Counter({answer: n for answer, n in quota.answers[kind].items() if n})
        for name, configurations in own.items():
            assert set(configurations) <= set(passed[name])
            assert len({by_name[name].answers[c] for c in configurations}) > 1


def test_a_spare_group_steps_in_for_one_that_was_refused() -> None:
    quota = quotas()[0]
    groups = plan(quota)
    first = next(g for g in groups if g.question.kind == "COUNTING" and g.asked)
    spare = next(g for g in groups if g.question.kind == "COUNTING" and not g.asked)
    passed = {g.name: range(4) for g in groups} | {first.name: ()}
    assert spare.name in select(groups, passed, quota)


def test_mean_lengths_and_manipulations_of_a_tenth_of_the_benchmark() -> None:
    words: dict[str, list[int]] = {kind: [] for kind in KINDS}
    manipulations: Counter[str] = Counter()
    config = load_config(PAPER).with_scenes(12)
    for quota in allot(capacities(config.scene_names), config.totals):
        scene = load_scene(quota.scene)
        places = hiding_places(scene)
        with World(scene) as world:
            room = Expressions(SceneGraph.from_objects(object_metadata(world).values()))
        phrases: dict[str, list[Expression]] = {place.object_id: room.of(place.object_id) for place in places}
        fitting = lambda place, n, room_type=quota.room_type: fitting_types(place, room_type, n)  # noqa: E731
        for group in plan_groups(places, phrases, fitting, quota, rng_for(quota.scene), 4, SPARE):
            words[group.question.kind] += [group.question.words] * len(group.asked)
            manipulations[group.question.place.manipulation] += len(group.asked)
    asked = sum(sum(kinds.values()) for kinds in config.totals.values())
    assert manipulations.total() == asked
    # What is promised of 120 rooms, below, holds of 12 within what a sample of rooms varies by. It is little, as only what is
    # so thin that nobody sees it lies under things, and few things can be pushed aside.
    assert all(manipulations[m] >= 0.04 * asked for m in ("Open", "Pickup", "Move"))
    assert {kind: np.mean(w) for kind, w in words.items()} == pytest.approx(MEAN_WORDS, abs=0.8)


@pytest.mark.skipif(
    "REMQA_DATASET" not in os.environ,
    reason="needs the folder of a full dataset in REMQA_DATASET (remqa-gen --scenes 120 makes one)",
)
def test_the_whole_benchmark_has_the_published_lengths_and_enough_of_each_manipulation() -> None:
    root = Path(os.environ["REMQA_DATASET"])
    columns = ["kind", "question", "manipulation"]
    rows = [row for s in ("train", "test") for row in read_table(root, "questions", s, columns).to_pylist()]
    assert len(rows) == 4072
    counts = Counter(row["manipulation"] for row in rows)
    assert all(counts[m] >= 0.06 * len(rows) for m in ("Open", "Pickup", "Move"))
    means = {kind: np.mean([len(r["question"].split()) for r in rows if r["kind"] == kind]) for kind in KINDS}
    assert means == pytest.approx(MEAN_WORDS, abs=0.5)
