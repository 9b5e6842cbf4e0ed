import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from remqa_data.errors import QuotaError, UnknownNameError
from remqa_data.floorplans.ithor.table import recorded_objects, scene_names
from remqa_data.floorplans.splits import split_of
from remqa_data.generators.questions.allotment import FEWEST_LOTS, LOT_SIZE, MOST_LOTS, allot
from remqa_data.generators.questions.capacity_table import SceneCapacity, capacities
from remqa_data.generators.questions.chosen_scenes import choose_scenes
from remqa_data.generators.questions.groups import group_shapes
from remqa_data.tables.rows import KINDS

PUBLISHED = {
    "train": {"EXISTENCE": 1653, "COUNTING": 647, "SPATIAL": 1083},
    "test": {"EXISTENCE": 324, "COUNTING": 143, "SPATIAL": 222},
}
NUMBERS = st.integers(2, 400)


def room_for(name: str, groups: int) -> SceneCapacity:
    return SceneCapacity(name, "kitchen", dict.fromkeys(KINDS, groups), dict.fromkeys(KINDS, groups))


def check(quotas, totals, rooms) -> None:
    """Everything that `allot` promises."""
    assert len(quotas) == len(rooms) > 0
    for split, by_kind in totals.items():
        for kind, total in by_kind.items():
            answers: Counter[str] = Counter()
            for quota in quotas:
                if quota.split == split:
                    answers.update(quota.answers[kind])
            assert sum(answers.values()) == total
            assert not answers or max(answers.values()) - min(answers.values()) <= 1
    for split in totals:
        of_split = [(q, room) for q, room in zip(quotas, rooms, strict=True) if q.split == split]
        lots = sum(lots_needed(answers) for quota, _ in of_split for answers in quota.answers.values())
        if lots > sum(min(sum(room.lots.values()), MOST_LOTS) for _, room in of_split):
            continue  # some take more than is easy, so that none is asked too much
        for kind in KINDS:
            needed = {room.scene: lots_needed(quota.answers[kind]) for quota, room in of_split}
            if sum(needed.values()) > sum(room.lots[kind] for _, room in of_split):
                assert all(needed[room.scene] >= room.lots[kind] for _, room in of_split)
                continue
            for quota, room in of_split:
                if needed[room.scene] > room.lots[kind]:
                    assert sum(lots_needed(answers) for answers in quota.answers.values()) <= FEWEST_LOTS
    for quota, room in zip(quotas, rooms, strict=True):
        assert (quota.scene, quota.room_type) == (room.scene, room.room_type)
        for kind in KINDS:
            assert lots_needed(quota.answers[kind]) <= room.most[kind]
            assert all(len(shape) > 1 for shape in group_shapes(quota.answers[kind], LOT_SIZE, quota.scene))


def lots_needed(answers: Mapping[str, int]) -> int:
    """How many lots a quota makes, if a lot has one of each count, or two times yes and two times no."""
    per_answer = LOT_SIZE // len(answers)
    return max(math.ceil(count / per_answer) for count in answers.values())


@pytest.mark.slow
def test_the_published_totals() -> None:
    rooms = capacities(scene_names())
    quotas = allot(rooms, PUBLISHED)
    check(quotas, PUBLISHED, rooms)
    assert sum(quota.total(kind) for quota in quotas for kind in KINDS) == 4072


@pytest.mark.slow
def test_a_room_without_anything_to_open_owes_only_spatial_questions() -> None:
    assert not any(o.type in {"Cabinet", "Drawer", "Fridge", "Box", "Toilet"} for o in recorded_objects("FloorPlan320"))
    (quota,) = [q for q in allot(capacities(scene_names()), PUBLISHED) if q.scene == "FloorPlan320"]
    assert (quota.total("EXISTENCE"), quota.total("COUNTING")) == (0, 0)
    assert quota.total("SPATIAL") > 0


@pytest.mark.slow
@given(st.integers(1, 120), st.data())
def test_exact_and_balanced_for_any_rooms_and_totals(count, data) -> None:
    rooms = []
    for name in choose_scenes(count):
        easy = {kind: data.draw(st.integers(0, 8)) for kind in KINDS}
        most = {kind: n + data.draw(st.integers(0, 4)) for kind, n in easy.items()}
        rooms.append(SceneCapacity(name, "kitchen", easy, most))
    totals = {}
    for split in ("train", "test"):
        own = [room for room in rooms if split_of(room.scene) == split]
        room_for = {kind: 4 * sum(room.most[kind] for room in own) for kind in KINDS}
        totals[split] = {kind: data.draw(st.integers(0, n)) for kind, n in room_for.items()}
    assume(all(n != 1 for by_kind in totals.values() for n in by_kind.values()))
    check(allot(rooms, totals), totals, rooms)


@given(st.lists(st.integers(0, 3), min_size=4, max_size=4), NUMBERS)
def test_totals_that_do_not_fit_name_split_kind_and_rooms(groups, extra) -> None:
    names = ("FloorPlan1", "FloorPlan2", "FloorPlan3", "FloorPlan4")
    rooms = [room_for(name, n) for name, n in zip(names, groups, strict=True)]
    with pytest.raises(QuotaError, match=r"questions.train.COUNTING: .* questions need .*FloorPlan1"):
        allot(rooms, {"train": {"COUNTING": 4 * sum(groups) + extra}})


def test_totals_that_do_not_fit_name_rooms_that_could_be_asked_instead() -> None:
    other = r"the room FloorPlan430 can be asked none; ask for other scenes, such as FloorPlan30, or fewer questions$"
    with pytest.raises(QuotaError, match=other):
        allot(capacities(["FloorPlan430"]), {"test": {"COUNTING": 2}})
    more = (
        r"can be asked at most \d+ \(FloorPlan430 none\); ask for more scenes, such as FloorPlan30, or fewer questions$"
    )
    with pytest.raises(QuotaError, match=more):
        allot(capacities(["FloorPlan430", "FloorPlan27"]), {"test": {"COUNTING": 2000}})
    with pytest.raises(QuotaError, match=r"at most \d+; ask for more scenes or fewer questions$"):
        allot(capacities(["Sampled-kitchen-000004"]), {"test": {"COUNTING": 2000}})


def test_rooms_are_asked_about_alike_where_they_have_room() -> None:
    rooms = [room_for("FloorPlan1", 12), room_for("FloorPlan2", 12), room_for("FloorPlan3", 2)]
    quotas = allot(rooms, {"train": {"EXISTENCE": 80, "COUNTING": 24, "SPATIAL": 24}})
    assert [sum(quota.total(kind) for kind in KINDS) for quota in quotas] == [56, 56, 16]
    poor = [replace(room_for("FloorPlan3", 4), lots={"EXISTENCE": 4, "COUNTING": 0, "SPATIAL": 0})]
    quotas = allot([*rooms[:2], *poor], {"train": {"EXISTENCE": 60}})
    assert quotas[2].total("EXISTENCE") == 4 * FEWEST_LOTS


def test_a_room_with_too_many_lots_passes_one_on_of_another_kind_than_the_last() -> None:
    only = {"EXISTENCE": 0, "COUNTING": 0, "SPATIAL": 8}
    rooms = [room_for("FloorPlan1", 8), replace(room_for("FloorPlan2", 8), lots=only, most=only)]
    quotas = allot(rooms, {"train": {"EXISTENCE": 32, "COUNTING": 16, "SPATIAL": 32}})
    assert [sum(quota.total(kind) for kind in KINDS) for quota in quotas] == [60, 20]  # and not 64 and 16
    assert quotas[0].total("EXISTENCE") == 32


def test_a_room_with_too_few_lots_takes_more_than_it_takes_easily() -> None:
    easy, most = ({"EXISTENCE": n, "COUNTING": 0, "SPATIAL": 0} for n in (1, 4))
    poor = replace(room_for("FloorPlan2", 4), lots=easy, most=most)
    quotas = allot([room_for("FloorPlan1", 12), poor], {"train": {"EXISTENCE": 44}})
    assert [quota.total("EXISTENCE") for quota in quotas] == [44 - 4 * FEWEST_LOTS, 4 * FEWEST_LOTS]


@pytest.mark.slow
def test_rooms_of_the_benchmark_are_asked_16_to_60_questions_or_all_that_they_can_be() -> None:
    rooms = capacities(scene_names())
    asked = [sum(map(quota.total, KINDS)) for quota in allot(rooms, PUBLISHED)]
    assert max(asked) <= 60
    for room, count in zip(rooms, asked, strict=True):
        assert count >= min(16, LOT_SIZE * sum(room.most.values())), room


def test_one_sample_cannot_be_balanced() -> None:
    with pytest.raises(QuotaError, match=r"questions\.train\.SPATIAL: 1 question cannot"):
        allot(capacities(["FloorPlan1"]), {"train": {"SPATIAL": 1}})


def test_five_test_rooms_of_each_type() -> None:
    tests = [name for name in scene_names() if split_of(name) == "test"]
    assert tests == [f"FloorPlan{base + n}" for base in (0, 200, 300, 400) for n in range(26, 31)]
    with pytest.raises(UnknownNameError, match="FloorPlan1"):
        split_of("FloorPlan1x")


@pytest.mark.parametrize("count", range(1, 121))
def test_some_rooms_are_spread_over_types_and_splits(count) -> None:
    names = choose_scenes(count)
    assert len(set(names)) == count
    assert set(names) <= set(scene_names())
    types = Counter((int(name.removeprefix("FloorPlan")) - 1) // 100 for name in names)
    assert max(types.values()) - min((types[t] for t in (0, 2, 3, 4)), default=0) <= 1
    tests = sum(split_of(name) == "test" for name in names)
    assert abs(tests - count / 6) <= 1
    assert tests > 0 or count == 1


def test_more_rooms_than_there_are() -> None:
    with pytest.raises(QuotaError, match="ask for 1 to 120"):
        choose_scenes(121)


def test_the_table_of_capacities_has_all_rooms() -> None:
    rooms = capacities(scene_names())
    assert [room.room_type for room in rooms[::30]] == ["kitchen", "living_room", "bedroom", "bathroom"]
    with pytest.raises(UnknownNameError, match="FloorPlan430"):
        capacities(["FloorPlan431"])


def test_rooms_get_what_they_have_room_for_and_none_is_left_out() -> None:
    rooms = [room_for("FloorPlan1", 9), room_for("FloorPlan2", 6), room_for("FloorPlan3", 1)]
    quotas = allot(rooms, {"train": {"EXISTENCE": 24}})
    assert [quota.total("EXISTENCE") for quota in quotas] == [12, 8, 4]
