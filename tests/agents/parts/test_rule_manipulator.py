import pytest

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.agents.parts.rule_manipulator import RuleManipulator, places_beside
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.room_records import thing
from tests.helpers.walked_rooms import memory_of, percept_of

SEEN = Sighting((0.1, 0.1, 0.5, 0.5), (0.25, 0.5))
BIN = Instance("GarbageCan", (1.0, 2.0, 0.0, 1.3, 2.4, 0.5), None, "graph")
MEMORY = memory_of([thing("GarbageCan|1", (1.2, 0.0, 0.0), (0.4, 0.4, 0.6))], (-2.0, -2.0, 2.0, 2.0))
PERCEPT = percept_of(AgentPose((0, 0), 0))


@pytest.mark.parametrize(
    ("text", "actions"),
    [
        ("Is there a mug in the fridge?", ["OpenObject @0.25,0.5"]),
        ("Is there a cellphone under the book?", ["PickupObject @0.25,0.5"]),
        ("Is there a pen under the box?", ["PickupObject @0.25,0.5"]),  # it opens, too, but one looks under it
        ("Is there a mug in the sink?", []),
        ("Is there a CD under the toaster?", []),  # of which the walk has seen none
    ],
)
def test_words_and_type_decide_what_is_tried(text: str, actions: list[str]) -> None:
    found = RuleManipulator().actions(read_question(text), MEMORY, PERCEPT, SEEN)
    assert [str(action) for action in found] == actions


def test_what_cannot_be_carried_is_moved_to_where_there_may_be_room() -> None:
    found = RuleManipulator().actions(read_question("Is there a CD under the garbage can?"), MEMORY, PERCEPT, SEEN)
    assert [(action.name, action.target) for action in found] == [("MoveObject", SEEN.point)] * 4


def test_nothing_is_done_to_what_is_not_seen() -> None:
    assert RuleManipulator().actions(read_question("Is there a mug in the fridge?"), MEMORY, PERCEPT, None) == ()


def test_what_is_moved_aside_goes_by_its_own_size_first_to_the_sides() -> None:
    """By hand: the bin is 0.3 m x 0.4 m around (1.15, 2.2); the agent looks along +x, so its left is +y."""
    places = list(places_beside(BIN, 0.0))
    expected = [(1.15, 2.62), (1.15, 1.78), (1.47, 2.2), (0.83, 2.2)]
    assert [place[:2] for place in places] == [pytest.approx(place) for place in expected]
    assert {place[2] for place in places} == {0.25}


def test_who_looks_the_other_way_tries_the_other_side_first() -> None:
    assert next(places_beside(BIN, 180.0))[:2] == pytest.approx((1.15, 1.78))
    assert next(places_beside(BIN, 90.0))[:2] == pytest.approx((1.47, 2.2))
    assert list(places_beside(BIN, 270.0))[2][:2] == pytest.approx((1.15, 1.78))  # away from the agent
