import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.errors import ProgramError
from remqa_data.language.referring import Program, program_of
from remqa_data.language.stored import stored_program

PHRASES = (
    "the fridge",
    "the top drawer next to the fridge",
    "the second drawer from the left",
    "the red mug on the wooden dining table",
    "the drawer closest to the cabinet below the sink",
)


@pytest.mark.parametrize("phrase", PHRASES)
def test_a_program_is_the_same_after_it_was_stored(phrase: str) -> None:
    program = program_of(phrase)
    asked = (("filter_type", "Egg"), ("relate", "in", program), ("count",))
    assert stored_program(json.dumps(program)) == program
    assert stored_program(json.dumps(asked)) == asked


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("nobody|9", "Expecting value"),
        ("[" * 4000, "Expecting value|recursion"),
        ("[]", "without steps"),
        ("{}", "no list of steps"),
        ("[1]", "no step of a program: 1"),
        ('["filter_type"]', "no step of a program: 'filter_type'"),
        ('[["filter_type"]]', r"no step of a program: \['filter_type'\]"),
        ('[["filter_type", ["Egg"]]]', "no step of a program"),
        ('[["relate", "in", []]]', "no step of a program"),
        ('[["relate", "in", [["exist"]]]]', r"no step of a program: \['exist'\]"),
        ('[["relate", "beside", [["filter_type", "Egg"]]]]', "no step of a program"),
        ('[["row", "fourth"]]', "no step of a program"),
        ('[["exist"], ["filter_type", "Egg"]]', r"no step of a program: \['exist'\]"),
        ('[["exist"], ["count"]]', r"no step of a program: \['exist'\]"),
        ('[["paint", "red"]]', "no step of a program"),
    ],
)
def test_what_is_no_program_is_refused(text: str, said: str) -> None:
    with pytest.raises(ProgramError, match=said) as caught:
        stored_program(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


anything = st.recursive(
    st.none() | st.integers() | st.sampled_from(["relate", "in", "exist", "filter_type", "closest", "Egg"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=2), inner, max_size=2),
)


def read(value: object) -> Program | None:
    try:
        return stored_program(json.dumps(value))
    except ProgramError:
        return None


@given(anything)
def test_nothing_else_comes_of_any_json(value: object) -> None:
    assert read(value) is None or json.loads(json.dumps(read(value))) == value
