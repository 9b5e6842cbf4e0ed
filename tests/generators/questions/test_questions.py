import json
from dataclasses import replace

import pytest

from remqa_data.catalog import object_type, question_types
from remqa_data.generators.questions.expressions import Expression, Expressions
from remqa_data.generators.questions.questions import (
    Candidate,
    confusable,
    kinds_for,
    mentioned_types,
    question_text,
    usable_expressions,
)
from remqa_data.language.answers import execute
from remqa_data.language.inner_relations import Partner
from remqa_data.language.question_rules import question_rules
from remqa_data.language.referring import resolve
from remqa_data.tables.rows import KINDS
from tests.helpers.room_records import kitchen_graph
from tests.helpers.stand_in_places import StandIn


def place(type_name: str, manipulation="Open", relation="in", spots: int = 4) -> StandIn:
    return StandIn(f"{type_name}|1", type_name, manipulation, relation, range(spots), (0.5, 0.5, 0.5))


def candidate(kind, where: StandIn, type_name: str) -> Candidate[StandIn]:
    phrase = Expressions(kitchen_graph()).of(where.object_id)[0]
    return Candidate(kind, where, phrase, type_name)


@pytest.mark.parametrize(
    ("kind", "where", "type_name", "text"),
    [
        ("EXISTENCE", place("Fridge"), "Apple", "Is there an apple in the fridge?"),
        ("COUNTING", place("Cabinet"), "Knife", "How many knives are there in the cabinet below the sink?"),
        ("COUNTING", place("Fridge"), "Lettuce", "How many heads of lettuce are there in the fridge?"),
        ("SPATIAL", place("Pillow", "Pickup", "under"), "CD", "Is there a CD under the pillow?"),
        ("SPATIAL", place("Toaster", "Move", "under"), "Fork", "Is there a fork under the toaster?"),
        ("SPATIAL", place("Fridge"), "Apple", "Is there an apple inside the fridge?"),
        ("COUNTING", place("Toaster", "Move", "under"), "Fork", "How many forks are there under the toaster?"),
    ],
)
def test_words(kind, where, type_name, text) -> None:
    question = candidate(kind, where, type_name)
    assert question.text == text
    assert question.words == len(text.split())


@pytest.mark.parametrize(
    ("partner", "text"),
    [
        (Partner("behind", "Mug"), "Is the egg behind the mug in the fridge?"),
        (Partner("next to", "Bread"), "Is the egg next to the loaf of bread in the fridge?"),
        (Partner("on", "Plate"), "Is the egg on the plate in the fridge?"),
        (Partner("between", "Mug"), "Is the egg between the mugs in the fridge?"),
    ],
)
def test_words_of_how_two_things_lie(partner, text) -> None:
    question = replace(candidate("SPATIAL", place("Fridge"), "Egg"), partner=partner)
    assert question.text == text
    others = [["filter_type", partner.type], ["relate", "in", [["filter_type", "Fridge"]]]]
    expected = [["filter_type", "Egg"], ["relate", partner.relation, others], ["exist"]]
    assert json.loads(json.dumps(question.program)) == expected
    assert question.types == {"Egg", partner.type}


@pytest.mark.slow
def test_every_question_type_makes_a_sentence_without_leftovers() -> None:
    assert len(question_types()) == 60
    for name in question_types():
        for kind in ("EXISTENCE", "COUNTING"):
            text = candidate(kind, place("Fridge"), name).text
            assert text.endswith("in the fridge?")
            assert not set("{}_") & set(text)
            word = object_type(name).singular
            assert kind == "COUNTING" or f" {'an' if word[0] in 'aeiou' else 'a'} {word} in " in text


def test_the_program_is_stored_as_json_and_finds_the_place() -> None:
    question = candidate("COUNTING", place("Cabinet"), "Mug")
    program = json.loads(json.dumps(question.program))
    assert program[-1] == ["count"]
    assert resolve(program[1][2], kitchen_graph()) == ["Cabinet|1"]
    assert execute(program, kitchen_graph()).text == "0"


def test_existence_is_never_asked_of_what_lies_under_things() -> None:
    assert kinds_for(place("Drawer")) == KINDS
    assert kinds_for(place("Box", "Pickup", "under")) == ("COUNTING", "SPATIAL")


def test_no_kind_of_question_is_phrased_as_another() -> None:
    asked = [(kind, r) for kind in KINDS for r in ("in", "under") if (kind, r) != ("EXISTENCE", "under")]
    assert len({question_text(kind, "Book", relation, "the box") for kind, relation in asked}) == len(asked)


def expression(text: str, anchor: str | None, kind="relation") -> Expression:
    inner = ((("relate", "on", (("filter_type", anchor),))),) if anchor else ()
    return Expression(text, "Bowl|1", "Bowl", "on", anchor, kind, (("filter_type", "Bowl"), *inner))


def test_phrases_lean_on_nothing_that_may_be_carried_away_and_name_no_colours() -> None:
    on_table, on_book = expression("the bowl on the desk", "Desk"), expression("the bowl on the book", "Book")
    red = expression("the red bowl", None, "attribute")
    usable = usable_expressions([on_book, red, on_table])
    assert [phrase for phrase, _ in usable] == [on_table]


def test_no_landmark_where_the_noun_is_enough() -> None:
    bare, on_table = expression("the bowl", None, "bare"), expression("the bowl on the desk", "Desk")
    assert [phrase for phrase, _ in usable_expressions([on_table, bare])] == [bare]


def test_types_that_a_program_names_at_any_depth() -> None:
    assert mentioned_types(candidate("EXISTENCE", place("Cabinet"), "Mug").program) == {"Mug", "Cabinet", "Sink"}


def test_types_that_are_taken_for_one_another() -> None:
    assert confusable("Cup", "Mug")
    assert confusable("Knife", "ButterKnife")
    assert confusable("ButterKnife", "Knife")
    assert confusable("Egg", "Egg")
    assert not confusable("Fork", "Spoon")


def test_the_shipped_rules_name_real_types_and_shares() -> None:
    rules = question_rules()
    assert rules.manipulations
    assert all(sum(shares.values()) == pytest.approx(1) for shares in rules.manipulations.values())
    assert rules.answers("COUNTING") == ("0", "1", "2", "3")
