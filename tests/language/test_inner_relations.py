"""Questions about how two things lie to one another in one place."""

import json

import pytest

from remqa_data.generators.questions.questions import inner_question_program, question_program
from remqa_data.language.answers import execute, is_clear
from remqa_data.language.inner_relations import Partner, inner_of, is_sure, needed, witnesses
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import relation_rules
from tests.helpers.room_records import kitchen, thing

FRIDGE = (("filter_type", "Fridge"),)
MUG = thing("Mug|9", (0.3, -0.1, 0.5), (0.1, 0.1, 0.1), "Fridge|1", "in")


def fridge(*things) -> SceneGraph:
    return SceneGraph.from_objects([*kitchen(), MUG, *things])


def egg(x: float, y: float, number: int = 9):
    return thing(f"Egg|{number}", (x, y, 0.5), (0.06, 0.06, 0.06), "Fridge|1", "in")


def asks(relation) -> tuple:
    return inner_question_program("Egg", Partner(relation, "Mug"), FRIDGE)


@pytest.mark.parametrize(
    ("relation", "at", "answer"),
    [
        ("behind", (0.3, 0.0), "yes"),
        ("behind", (0.42, -0.1), "no"),
        ("next to", (0.4, -0.1), "yes"),
        ("next to", (0.7, 0.2), "no"),
        ("on", (0.4, -0.1), "no"),
    ],
)
def test_a_relation_within_a_relation_is_executed(relation, at, answer) -> None:
    graph = fridge(egg(*at))
    found = execute(json.loads(json.dumps(asks(relation))), graph)
    assert (found.text, found.ids) == (answer, ("Egg|9",) if answer == "yes" else ())
    inner = inner_of(asks(relation))
    assert inner is not None
    assert is_sure(inner, graph, answer)
    assert not is_sure(inner, graph, "no" if answer == "yes" else "yes")
    assert is_clear(asks(relation), graph, SceneGraph.from_objects(graph.objects.values(), relation_rules().loosened()))


def test_what_is_on_a_plate_in_the_fridge_is_on_it() -> None:
    plate = thing("Plate|9", (0.5, 0, 0.5), (0.26, 0.26, 0.03), "Fridge|1", "in")
    apple = thing("Apple|9", (0.5, 0, 0.51), (0.1, 0.1, 0.1), "Plate|9", "on")
    program = inner_question_program("Apple", Partner("on", "Plate"), FRIDGE)
    inner = inner_of(program)
    assert inner is not None
    assert execute(program, fridge(plate, apple)).ids == ("Apple|9",)
    assert witnesses(inner, fridge(plate, apple)) == (["Apple|1", "Apple|9"], ["Plate|9"])  # one is in the bowl there


@pytest.mark.parametrize("at", [(0.3, 0.08), (0.3, 0.13)])  # 10 and 15 cm behind, where 12 is the limit
def test_what_nearly_is_and_what_hardly_is_are_not_sure(at) -> None:
    inner = inner_of(asks("behind"))
    assert inner is not None
    assert not any(is_sure(inner, fridge(egg(*at)), answer) for answer in ("yes", "no"))


@pytest.mark.parametrize("things", [[], [egg(0.3, 0.0), egg(0.6, 0.2, 8)]])
def test_there_is_one_thing_and_what_it_lies_to(things) -> None:
    inner = inner_of(asks("behind"))
    assert inner is not None
    assert not any(is_sure(inner, fridge(*things), answer) for answer in ("yes", "no"))


def test_between_needs_two() -> None:
    other = thing("Mug|8", (0.3, 0.16, 0.5), (0.1, 0.1, 0.1), "Fridge|1", "in")
    inner = inner_of(asks("between"))
    assert inner is not None
    assert is_sure(inner, fridge(other, egg(0.3, 0.03)), "yes")
    assert not is_sure(inner, fridge(egg(0.3, 0.03)), "no")


def test_to_answer_no_one_must_see_both() -> None:
    graph = fridge(egg(0.42, -0.1))
    assert needed(asks("behind"), (), graph) == ("Egg|9", "Mug|9")
    plain = question_program("EXISTENCE", "Egg", "in", FRIDGE)
    assert inner_of(plain) is None
    assert needed(plain, ("Egg|9",), graph) == ("Egg|9",)
