import pickle

import pytest

from remqa_data.errors import UnknownNameError


@pytest.mark.parametrize(
    ("name", "known", "words"),
    [
        ("mugg", ["Mug", "Fridge"], "unknown thing 'mugg'; did you mean 'Mug'?"),
        ("x", ["Fridge", "Mug"], "unknown thing 'x'; known are 'Fridge', 'Mug'"),
        ("x", iter("fedcba"), "unknown thing 'x'; known are 'a', 'b', 'c', 'd', ..."),
        ("x", [], "unknown thing 'x'"),
        (None, ["Mug"], "unknown thing None; known are 'Mug'"),
    ],
)
def test_what_is_near_is_told_or_else_some_of_what_there_is(name, known, words) -> None:
    error = UnknownNameError("thing", name, known)
    assert str(error) == words
    assert str(pickle.loads(pickle.dumps(error))) == words


def test_objects_that_nobody_asked_for_are_not_told() -> None:
    assert str(UnknownNameError("object", "x", ["Fridge|1", "Mug|2"])) == "unknown object 'x'"
