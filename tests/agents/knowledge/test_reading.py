import pytest

from remqa_data.agents.knowledge.reading import read_question
from remqa_data.catalog import catalog
from remqa_data.errors import ProgramError
from remqa_data.generators.questions.questions import inner_question_text, question_text
from remqa_data.language.inner_relations import Partner
from remqa_data.language.referring import program_of


@pytest.mark.parametrize(
    ("text", "kind", "relation", "expression", "manipulation"),
    [
        ("Is there a mug in the fridge?", "EXISTENCE", "in", "the fridge", "Open"),
        ("Is there a mug inside the fridge?", "SPATIAL", "in", "the fridge", "Open"),
        ("Is there a cellphone under the book?", "SPATIAL", "under", "the book", "Pickup"),
        ("How many cloths are there under the garbage can?", "COUNTING", "under", "the garbage can", "Move"),
        ("How many mugs are there in the fridge?", "COUNTING", "in", "the fridge", "Open"),
        ("Is the egg behind the mug in the fridge?", "SPATIAL", "in", "the fridge", "Open"),
        ("Is the fork between the mugs in the top drawer?", "SPATIAL", "in", "the top drawer", "Open"),
        # Phrases with a place of their own: what is asked for ends where the first "in" or "under" begins.
        (
            "Is there a mug in the cabinet under the sink?",
            "EXISTENCE",
            "in",
            "the cabinet under the sink",
            "Open",
        ),
        ("Is there a cellphone under the book in the drawer?", "SPATIAL", "under", "the book in the drawer", "Pickup"),
        (
            "Is there a key chain inside the second top drawer from the left?",
            "SPATIAL",
            "in",
            "the second top drawer from the left",
            "Open",
        ),
    ],
)
def test_what_the_words_say(text, kind, relation, expression, manipulation) -> None:
    asked = read_question(text)
    assert (asked.kind, asked.relation, asked.expression) == (kind, relation, expression)
    assert asked.target == program_of(expression)
    assert asked.manipulation == manipulation


@pytest.mark.parametrize("name", list(catalog()))
def test_a_question_about_any_type_is_read(name: str) -> None:
    where = "the drawer next to the toaster"
    assert read_question(question_text("EXISTENCE", name, "in", where)).expression == where
    assert read_question(question_text("COUNTING", name, "under", where)).relation == "under"
    assert read_question(question_text("SPATIAL", name, "in", where)).kind == "SPATIAL"
    assert read_question(inner_question_text(name, Partner("on", name), where)).expression == where


def test_the_target_is_what_the_expression_names_and_not_what_is_asked_for() -> None:
    assert read_question("Is there an apple in the cabinet above the sink?").target_type == "Cabinet"


def test_what_is_fixed_and_does_not_open_is_not_acted_on() -> None:
    assert read_question("Is there a mug in the sink?").manipulation is None


@pytest.mark.parametrize("text", ["", "What is in the fridge?", "Is there a mug in the zeppelin?"])
def test_words_that_are_not_understood_are_an_error(text: str) -> None:
    with pytest.raises(ProgramError):
        read_question(text)
