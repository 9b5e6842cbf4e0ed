from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.errors import ActionError
from remqa_data.sim.agent.actions import ACTIONS, Action, parse_action

SHARES = st.floats(0.0, 1.0)
IDS = st.from_regex(r"\A[A-Z][a-z]+\|[+-][0-9.]{1,5}(\|SinkBasin)?\Z")


@st.composite
def actions(draw: st.DrawFn) -> Action:
    name = draw(st.sampled_from(sorted(ACTIONS)))
    spec = ACTIONS[name]
    needed = [amount for amount in spec.amounts if amount.default is None]
    count = draw(st.integers(len(needed), len(spec.amounts)))
    numbers = tuple(draw(st.floats(amount.low, amount.high)) for amount in spec.amounts[:count])
    return Action(name, draw(IDS | st.tuples(SHARES, SHARES)) if spec.has_target else None, numbers)


@given(actions())
def test_every_action_is_read_as_it_is_written(action: Action) -> None:
    assert parse_action(str(action)) == action


@given(st.text(max_size=40) | st.builds("{} {}".format, st.sampled_from(sorted(ACTIONS)), st.text(max_size=20)))
def test_any_text_is_an_action_or_an_action_error(text: str) -> None:
    with suppress(ActionError):
        assert parse_action(text).name in ACTIONS


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is not an action"),
        ("MoveAhed", "did you mean MoveAhead"),
        ("MoveAhead 0.25 1", "MoveAhead takes metres"),
        ("MoveAhead far", "MoveAhead takes metres"),
        ("MoveAhead nan", "must be from 0 to 5"),
        ("MoveAhead inf", "must be from 0 to 5"),
        ("MoveAhead -1", "must be from 0 to 5"),
        ("OpenObject", "takes an object id or an image point"),
        ("MoveAhead  ", "between words is one blank, and none before or after"),
        ("OpenObject ", "between words is one blank, and none before or after"),
        (" MoveAhead", "' MoveAhead': between words is one blank, and none before or after"),
        ("OpenObject @0.5", "written @x,y"),
        ("OpenObject @0.5,left", "written @x,y"),
        ("OpenObject Fridge|1 2.0", "openness must be from 0 to 1"),
        ("Teleport 1 2", "Teleport takes x, y, yaw_deg"),
        ("MoveObject Stool|1 1 2", "takes an object id or an image point, x, y, z"),
        ("Done now", "Done takes nothing"),
        ("MoveAhead 1_0", "MoveAhead takes metres"),
        ("OpenObject @0.5_0,0.5", "written @x,y"),
        ("OpenObject @٠.5,0.5", "written @x,y"),
        (5, "give a text"),
    ],
)
def test_what_is_no_action_is_told_why(text: str, message: str) -> None:
    with pytest.raises(ActionError, match=message):
        parse_action(text)


def test_what_is_no_name_and_what_has_too_many_numbers_is_told_so() -> None:
    with pytest.raises(ActionError, match="name of an action is a text"):
        Action(5)  # type: ignore[arg-type]
    with pytest.raises(ActionError, match="MoveAhead takes metres"):
        Action("MoveAhead", None, (0.25, 0.25)).in_short()
