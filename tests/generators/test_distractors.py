from collections import Counter

import numpy as np
import pytest

from remqa_data.errors import ArrangementError
from remqa_data.generators.arrangement.areas import Area, Spot
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.wished_things import has_room
from remqa_data.generators.distractors import distractors
from remqa_data.generators.questions.expressions import Expression
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.questions import Candidate, confusable
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.tables.rows import QuestionKind

AREA = Area((0.0, 0.0, 0.5), 0.0, (0.3, 0.2), 0.2)
DRAWER = HidingPlace(
    "Drawer|1", "Drawer", "Open", "in", AgentPose((0, 0), 0), (), (Spot((0.0, 0.0, 0.5), 0.1, 0.2),) * 4,
    (AREA,), (AREA,), frozenset(), 0.0,
)  # fmt: skip
FITS = [(name, 1.0) for name in ("Apple", "CellPhone", "Cup", "Mug", "Plate", "Potato", "RemoteControl", "Tomato")]


def group(kind: QuestionKind, number: int, type_: str, *answers: str) -> GroupPlan[HidingPlace]:
    where = Expression("the drawer", "Drawer|1", "Drawer", None, None, "bare", (("filter_type", "Drawer"),))
    name = f"FloorPlan1-{kind}-{number:02d}"
    return GroupPlan(name, Candidate(kind, DRAWER, where, type_), answers, (0, 1))


ASKED = [
    group("EXISTENCE", 0, "Mug", "yes", "no", "no", "yes"),
    group("COUNTING", 0, "CellPhone", "0", "1", "2", "3"),
]


@pytest.mark.parametrize("asked", [ASKED, ASKED[:1], ASKED[1:]])
def test_every_configuration_reveals_as_many_things(asked: list[GroupPlan[HidingPlace]]) -> None:
    made = distractors(asked, 4, lambda place, count: FITS, has_room, {}, np.random.default_rng(0))
    revealed = [
        sum(g.counts[number] for g in asked) + sum(hidden.count for hidden in made[number]) for number in range(4)
    ]
    # by hand: 1 + 0, 0 + 1, 0 + 2, 1 + 3; alone at most one mug, at most three phones
    assert revealed == [{2: 4, 1: max(asked[0].counts)}[len(asked)]] * 4


def test_nothing_that_is_asked_for_or_taken_for_it_or_named_is_a_distractor() -> None:
    for seed in range(20):
        made = distractors(ASKED, 4, lambda place, count: FITS, has_room, {}, np.random.default_rng(seed))
        types = {hidden.type for each in made for hidden in each}
        assert not any(confusable(name, asked) for name in types for asked in ("Mug", "CellPhone", "Drawer"))
        assert "Cup" not in types  # templates/expressions.yaml: a mug may be taken for one


@pytest.mark.slow
def test_a_remote_control_stands_in_for_a_phone_more_often_than_a_plate() -> None:
    drawn: Counter[str] = Counter()
    for seed in range(200):
        made = distractors(ASKED[1:], 4, lambda place, count: FITS, has_room, {}, np.random.default_rng(seed))
        drawn.update({hidden.type: hidden.count for each in made for hidden in each})
    assert drawn["RemoteControl"] > 2 * drawn["Plate"]


def test_types_that_do_not_go_together_are_not_put_together() -> None:
    clashes = {
        ("Drawer|1", "in"): {frozenset({"CellPhone", name}) for name, _ in FITS if name not in ("CellPhone", "Tomato")}
    }
    for seed in range(10):
        made = distractors(ASKED[1:], 4, lambda place, count: FITS, has_room, clashes, np.random.default_rng(seed))
        assert {hidden.type for each in made[1:] for hidden in each} == {"Tomato"}


def test_nothing_stands_before_what_is_asked_for() -> None:
    tall = [("WineBottle", 1.0), ("RemoteControl", 1e-6)]  # 0.3 m high, and a phone is 0.01 m high
    for seed in range(10):
        made = distractors(ASKED[1:], 4, lambda place, count: tall, has_room, {}, np.random.default_rng(seed))
        assert {hidden.type for each in made for hidden in each} == {"RemoteControl"}


def test_a_place_that_nothing_else_fits_is_refused() -> None:
    with pytest.raises(ArrangementError, match="nothing else than CellPhone"):
        distractors(ASKED[1:], 4, lambda place, count: [("CellPhone", 1.0)], has_room, {}, np.random.default_rng(0))


def test_what_an_earlier_plan_hid_beside_the_same_questions_stays_there_unless_it_is_named_now() -> None:
    before = [["Potato"], ["Tomato"], ["Plate"], ["Apple"]]
    site = DRAWER.object_id, DRAWER.relation
    rng = np.random.default_rng(0)
    made = distractors(ASKED, 4, lambda place, count: FITS, has_room, {}, rng, {site: before})
    assert [[hidden.type for hidden in each] for each in made] == before
    apple = group("EXISTENCE", 1, "Apple", "no", "no", "yes", "no")
    made = distractors([*ASKED, apple], 4, lambda place, count: FITS, has_room, {}, rng, {site: before})
    assert "Apple" not in {hidden.type for each in made for hidden in each}
