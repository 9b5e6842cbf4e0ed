import pytest

from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.agents.parts.rule_manipulator import RuleManipulator

SEEN = Sighting((0.1, 0.1, 0.5, 0.5), (0.25, 0.5))


@pytest.mark.parametrize(
    ("text", "actions"),
    [
        ("Is there a mug in the fridge?", ["OpenObject @0.25,0.5"]),
        ("Is there a cellphone under the book?", ["PickupObject @0.25,0.5"]),
        ("Is there a CD under the garbage can?", ["PushObject @0.25,0.5 0.7", "PullObject @0.25,0.5 0.7"]),
        ("Is there a pen under the box?", ["PickupObject @0.25,0.5"]),  # it opens, too, but one looks under it
        ("Is there a mug in the sink?", []),
    ],
)
def test_words_and_type_decide_what_is_tried(text: str, actions: list[str]) -> None:
    assert [str(action) for action in RuleManipulator().actions(read_question(text), SEEN)] == actions


def test_nothing_is_done_to_what_is_not_seen() -> None:
    assert RuleManipulator().actions(read_question("Is there a mug in the fridge?"), None) == ()
