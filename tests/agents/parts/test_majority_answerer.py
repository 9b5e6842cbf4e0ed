from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.majority_answerer import MajorityAnswerer, majority
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.walked_rooms import percept_of

EXISTENCE, COUNTING = "Is there a mug in the fridge?", "How many mugs are there in the fridge?"
NOW = percept_of(AgentPose((0, 0), 0))


def test_each_kind_has_its_own_most_frequent_answer() -> None:
    known = majority([(EXISTENCE, "yes"), (COUNTING, "2"), (COUNTING, "3"), (COUNTING, "3"), (EXISTENCE, "yes")])
    assert known == {"EXISTENCE": "yes", "COUNTING": "3"}
    assert MajorityAnswerer(known).answer(read_question(COUNTING), NOW, NOW, None) == "3"


def test_of_equally_frequent_answers_the_first_is_taken_whatever_their_order() -> None:
    pairs = [(EXISTENCE, "yes"), (EXISTENCE, "no")]
    assert majority(pairs) == majority(pairs[::-1]) == {"EXISTENCE": "no"}


def test_nothing_is_answered_to_a_kind_that_is_not_known() -> None:
    assert MajorityAnswerer({}).answer(read_question(COUNTING), NOW, NOW, None) is None
