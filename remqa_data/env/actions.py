"""What one step of the environment is told: an action of the agent, or an answer, and where the target is said to be.

A step takes a number (an index into `DISCRETE`), a dictionary (an element of the parametrised action space), the text of
an action, such as "OpenObject Fridge|+02.10|+00.00|-00.28" or "Answer yes", or a `Command`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from gymnasium import spaces

from remqa_data.errors import ActionError, one_line
from remqa_data.limits import MAX_TEXT
from remqa_data.sim.agent.actions import (
    DONE,
    MANIPULATION,
    POSITION,
    WALKING,
    Action,
    Amount,
    action_spec,
    parse_action,
)
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.agent.body import direction

ActionMode = Literal["discrete", "parametrised"]
Shares = tuple[float, float, float, float]
"""A box x1, y1, x2, y2 as shares of the width and height of the view, from its top left corner."""

ANSWER = "Answer"
ANSWERS = ("yes", "no", *map(str, range(10)))
"""The answers that the action spaces have; as text, any answer can be given."""

_AT_THE_CENTRE = ("OpenObject", "CloseObject", "PickupObject", "PutObject", "PushObject", "PullObject")

DISCRETE = (
    *WALKING,
    *(f"{name} @0.5,0.5" for name in _AT_THE_CENTRE),
    "DropHandObject",
    DONE,
    *(f"{ANSWER} {answer}" for answer in ANSWERS),
)
"""The actions of the discrete space, as text. They act on what is in the middle of the view."""
PARAMETRISED = (*WALKING, *MANIPULATION, DONE, ANSWER)
"""The names of the actions of the parametrised space."""


@dataclass(frozen=True)
class Command:
    """What the agent wants.

    Attributes
    ----------
    action : Action or None
        What to do; None for an answer.
    answer : str or None
        Ends the episode.
    box : sequence of float or None
        Where the agent says that the question's target is in the present view: left, top, right, bottom, from 0 to 1.

    Raises
    ------
    ActionError
        If it is not one of the two, an action or an answer, or what a submission cannot hold.
    """

    action: Action | None = None
    answer: str | None = None
    box: Shares | None = None

    def __post_init__(self) -> None:
        if self.action is None and self.answer is None:
            raise ActionError("a Command has an action or an answer; action=Action(DONE) ends an episode without one")
        if self.action is not None and self.answer is not None:
            raise ActionError("a Command has an action or an answer, not both: an answer ends the episode")
        if not isinstance(self.action, Action | None):
            raise ActionError(f"Command(action={self.action!r:.80}): give an Action, such as parse_action('MoveAhead')")
        if not (self.answer is None or (isinstance(self.answer, str) and len(self.answer) <= MAX_TEXT)):
            raise ActionError(f"Command(answer={self.answer!r:.80}): give a text of at most {MAX_TEXT} characters")
        if self.answer is not None and not _is_unicode(self.answer):
            raise ActionError(f"Command(answer={self.answer!r:.80}): half a character, which no file holds")
        if self.box is not None:
            object.__setattr__(self, "box", _box(self.box))

    def __str__(self) -> str:
        return f"{ANSWER} {self.answer}" if self.action is None else str(self.action)


def _is_unicode(text: str) -> bool:
    """Whether a text has no lone surrogates."""
    return not any("\ud800" <= character <= "\udfff" for character in text)


def _box(box: Sequence[float]) -> Shares:
    try:
        left, top, right, bottom = (float(share) for share in box)
    except (TypeError, ValueError):
        left = top = right = bottom = math.nan
    if not (0.0 <= left <= right <= 1.0 and 0.0 <= top <= bottom <= 1.0):
        raise ActionError(f"Command(box={box!r:.200}): give left, top, right and bottom, shares from 0 to 1")
    return left, top, right, bottom


def action_space(mode: ActionMode) -> spaces.Space[Any]:
    """The space of a mode; see `DISCRETE`, and `command` for the entries of the parametrised one.

    Raises
    ------
    ActionError
        If there is no such mode.
    """
    if mode == "discrete":
        return spaces.Discrete(len(DISCRETE))
    if mode != "parametrised":
        raise ActionError(f"action mode {mode!r:.80} is neither 'discrete' nor 'parametrised'")
    return spaces.Dict(
        {
            "action": spaces.Discrete(len(PARAMETRISED)),
            "point": spaces.Box(0.0, 1.0, (2,), np.float32),
            "amounts": spaces.Box(-1.0, 1.0, (3,), np.float32),
            "box": spaces.Box(0.0, 1.0, (4,), np.float32),
            "answer": spaces.Discrete(len(ANSWERS)),
        }
    )


def command(action: Any, mode: ActionMode, agent: Agent) -> Command:
    """Read what a step is told.

    Parameters
    ----------
    action : int, dict, str or Command
        A dictionary has "action", an index into `PARAMETRISED`; "point", the image point (shares of width and height)
        of what it is done to; "amounts", its numbers in the order of `remqa_data.sim.agent.actions`, in units of their
        `scale`; "box", see `Command` (without area: none); "answer", an index into `ANSWERS`. An amount of 0 stands for the
        default where there is one, an amount beyond what the action takes for the nearest that it takes, and a position
        is ahead, left and up of where the agent stands. Arrays of float64 will do.
    mode : {"discrete", "parametrised"}
        What a number or a dictionary belongs to.
    agent : Agent
        Whose action it is.

    Raises
    ------
    ActionError
        If it is none of these.
    """
    if isinstance(action, Command):
        return action
    if isinstance(action, str):
        return _of_text(action)
    if isinstance(action, dict):
        action = {name: _as_in_space(entry) for name, entry in action.items()}
    if isinstance(action, bool | np.bool_) or not _known_space(mode).contains(action):
        what = f"a number below {len(DISCRETE)}" if mode == "discrete" else "an element of the action space"
        told = one_line(repr(action))
        raise ActionError(f"{told:.200} is not an action of the {mode} space: give {what}, a text or a Command")
    return _of_text(DISCRETE[int(action)]) if mode == "discrete" else _of_entries(action, agent)


@cache
def _known_space(mode: ActionMode) -> spaces.Space[Any]:
    return action_space(mode)


def _as_in_space(entry: Any) -> Any:
    """An entry of a dictionary; NumPy's own numbers, float64, as the float32 that the space has."""
    return entry.astype(np.float32) if isinstance(entry, np.ndarray) and entry.dtype == np.float64 else entry


def _of_text(text: str) -> Command:
    word, _, rest = text.partition(" ")
    if word == ANSWER:
        if not rest.strip():
            raise ActionError(f"{text!r:.80}: {ANSWER} takes an answer, such as {ANSWER} yes")
        return Command(answer=rest.strip())
    return Command(parse_action(text))


def _of_entries(entries: Mapping[str, Any], agent: Agent) -> Command:
    name = PARAMETRISED[int(entries["action"])]
    x1, y1, x2, y2 = (float(share) for share in entries["box"])
    box = (x1, y1, x2, y2) if x1 < x2 and y1 < y2 else None
    if name == ANSWER:
        return Command(answer=ANSWERS[int(entries["answer"])], box=box)
    spec = action_spec(name)
    x, y = (float(share) for share in entries["point"])
    numbers = tuple(
        _number(float(value), amount, agent) for value, amount in zip(entries["amounts"], spec.amounts, strict=False)
    )
    if spec.amounts == POSITION:
        numbers = _in_room(numbers, agent)
    return Command(Action(name, (x, y) if spec.has_target else None, numbers), box=box)


def _number(value: float, amount: Amount, agent: Agent) -> float:
    default = amount.default_of(agent.embodiment)
    if value == 0.0 and default is not None:
        return default
    # Of float32, which the space has: a sixth of 180 degrees is 30, and not 30.00000089.
    return min(max(float(f"{value * amount.scale:.6g}"), amount.low), amount.high)


def _in_room(numbers: tuple[float, ...], agent: Agent) -> tuple[float, ...]:
    """A position ahead, left and up of the agent as x, y, z in the room."""
    ahead, left, up = numbers
    cos, sin = direction(agent.yaw_deg)
    x, y, z = agent.position
    return x + ahead * cos - left * sin, y + ahead * sin + left * cos, z + up
