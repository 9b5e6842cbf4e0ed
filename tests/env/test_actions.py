"""The parametrised action space and the table of actions, against what actions there are."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from remqa_data.env import actions
from remqa_data.env.actions import ANSWER, DISCRETE, PARAMETRISED, command
from remqa_data.errors import ActionError
from remqa_data.sim.agent.actions import ACTIONS, DONE, ActionSpec, Amount, amounts_of
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.embodiment import AGENT

ENVIRONMENT = Path(__file__).resolve().parents[2] / "docs" / "ENVIRONMENT.md"
SOMEBODY: Any = SimpleNamespace(embodiment=AGENT, yaw_deg=90.0, position=(0.0, 0.0, 0.0))


def entries(name: str, amounts: float = 0.5) -> dict[str, Any]:
    """An element of the parametrised space whose amounts are all alike."""
    return {
        "action": np.int64(actions.PARAMETRISED.index(name)),
        "point": np.full(2, 0.5, dtype=np.float32),
        "amounts": np.full(3, amounts, dtype=np.float32),
        "box": np.zeros(4, dtype=np.float32),
        "answer": np.int64(0),
    }


@pytest.mark.parametrize("name", sorted({*PARAMETRISED} - {ANSWER}))
@pytest.mark.parametrize("amount", [-1.0, 0.0, 0.5, 1.0])
def test_every_amount_of_every_action_is_read_from_the_parametrised_space(name: str, amount: float) -> None:
    read = command(entries(name, amount), "parametrised", SOMEBODY).action
    assert read is not None
    assert len(read.numbers) == len(ACTIONS[name].amounts)
    assert amounts_of(read) == list(read.numbers)


def test_arrays_of_float64_are_read_as_those_of_float32() -> None:
    given = {**entries("MoveObject", 0.3), "box": np.array([0.1, 0.2, 0.7, 0.9], dtype=np.float32)}
    wide = {name: entry.astype(np.float64) if entry.ndim else entry for name, entry in given.items()}
    assert command(wide, "parametrised", SOMEBODY) == command(given, "parametrised", SOMEBODY)
    wide["point"][0] = 1.5
    with pytest.raises(ActionError, match="give an element of the action space"):
        command(wide, "parametrised", SOMEBODY)
    assert wide["box"].dtype == np.float64  # it is the caller's own


def test_an_amount_brings_the_scale_of_its_own_unit_along(monkeypatch: pytest.MonkeyPatch) -> None:
    fling = ActionSpec(True, (Amount("m/s", 0.0, 8.0, scale=10.0),), lambda agent, target, speed: ActionResult(True))
    monkeypatch.setitem(ACTIONS, "FlingObject", fling)
    monkeypatch.setattr(actions, "PARAMETRISED", (*PARAMETRISED[:-1], "FlingObject"))
    read = command(entries("FlingObject"), "parametrised", SOMEBODY).action
    assert read is not None
    assert read.numbers == (5.0,)


def test_the_table_of_actions_names_every_action() -> None:
    told = re.findall(r"^\| (`[^|]*`) \|", ENVIRONMENT.read_text(encoding="utf-8"), re.MULTILINE)
    named = {name for cell in told for name in re.findall(r"`([A-Z]\w+)`", cell)}
    assert {*ACTIONS, ANSWER} <= named
    assert {text.split(" ")[0] for text in DISCRETE} <= {*ACTIONS, ANSWER}


def test_only_the_last_of_the_discrete_actions_end_an_episode() -> None:
    told = re.search(
        r"The last (\d+) of the (\d+), `Done` and the answers, .* the first (\d+);", _one_line(ENVIRONMENT)
    )
    assert told is not None
    ends = [text == DONE or text.startswith(f"{ANSWER} ") for text in DISCRETE]
    assert ends == [False] * int(told[3]) + [True] * int(told[1])
    assert len(DISCRETE) == int(told[2])


def _one_line(page: Path) -> str:
    return " ".join(page.read_text(encoding="utf-8").split())
