"""The agent's actions as data and as text: AI2-THOR's names and defaults, and what each of them does.

An action is written as its name, then what it is done to, then numbers: `MoveAhead`, `MoveAhead 0.1`, `RotateLeft 45`,
`OpenObject Fridge|+02.10|+00.00|-00.28`, `PickupObject @0.5,0.62` (what is seen at that share of the image's width and
height), or `MoveObject Stool|... 1.25 -0.5 0.38`, which puts the centre of an object there, in metres. Numbers that are
left out have AI2-THOR's defaults.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import takewhile
from typing import TYPE_CHECKING, NamedTuple

from remqa_data.errors import ActionError, nearest_names
from remqa_data.geometry.types import Vec3
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.embodiment import AGENT, Embodiment

if TYPE_CHECKING:
    from remqa_data.sim.agent.agent import Agent

Target = str | tuple[float, float]
"""An object's id, or an image point as shares of the width and height from the top left corner."""


@dataclass(frozen=True)
class Action:
    """One action; `str` writes what `parse_action` reads.

    Attributes
    ----------
    name : str
        Such as "MoveAhead"; see `ACTIONS`.
    target : str or tuple of float or None
        What it is done to.
    numbers : tuple of float
        Its amounts; may be fewer than the action has.

    Raises
    ------
    ActionError
        If it is of other types; numbers of NumPy and lists of them will do.
    """

    name: str
    target: Target | None = None
    numbers: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise ActionError(f"{_in_words(self)}: the name of an action is a text")
        if type(self.numbers) is not tuple or not all(type(number) is float for number in self.numbers):
            object.__setattr__(self, "numbers", _floats(self, self.numbers))
        if not isinstance(self.target, str | None):
            point = _floats(self, self.target)
            if len(point) != 2:
                raise ActionError(f"{_in_words(self)}: the target is an object's id or an image point (x, y)")
            object.__setattr__(self, "target", point)

    def in_short(self, body: Embodiment = AGENT) -> Action:
        """The same action without the numbers at its end that are a body's defaults.

        >>> str(Action("MoveAhead", None, (0.25,)).in_short())
        'MoveAhead'

        Raises
        ------
        ActionError
            If there is no such action, or it has too few, too many or wrong numbers, or no target.
        """
        amounts_of(self)
        amounts, numbers = action_spec(self.name).amounts, self.numbers
        while numbers and numbers[-1] == amounts[len(numbers) - 1].default_of(body):
            numbers = numbers[:-1]
        return Action(self.name, self.target, numbers)

    def __str__(self) -> str:
        parts = [self.name]
        if isinstance(self.target, str):
            parts.append(self.target)
        elif self.target is not None:
            parts.append("@" + ",".join(map(repr, self.target)))
        return " ".join([*parts, *map(repr, self.numbers)])


def _floats(action: Action, given: object) -> tuple[float, ...]:
    try:
        if isinstance(given, str):  # float would read its digits
            raise TypeError
        return tuple(float(number) for number in given)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise ActionError(f"{_in_words(action)}: {given!r:.80} are no numbers") from None


def _in_words(action: Action) -> str:
    return f"Action({action.name!r:.80}, {action.target!r:.80}, {action.numbers!r:.80})"


class Amount(NamedTuple):
    """A number that an action takes.

    Attributes
    ----------
    name : str
        With its unit.
    low, high : float
        What it may be.
    default : float, function of an `Embodiment`, or None
        What it is if it is left out, or which figure of the agent's body it is then; None if it must be given.
    scale : float
        What 1 stands for in the environment's parametrised space, in the amount's own unit.
    """

    name: str
    low: float
    high: float
    default: float | Callable[[Embodiment], float] | None = None
    scale: float = 1.0

    def default_of(self, body: Embodiment) -> float | None:
        """What it is if it is left out by an agent with this body."""
        return self.default(body) if callable(self.default) else self.default


class ActionSpec(NamedTuple):
    """What an action takes and does."""

    has_target: bool
    amounts: tuple[Amount, ...]
    run: Callable[..., ActionResult]
    """Called with the agent, the object's id if it has a target, and the amounts."""


@lru_cache(maxsize=256)
def parse_action(text: str) -> Action:
    """Read an action.

    Raises
    ------
    ActionError
        If there is no such action, or it is given too little, too much, or numbers that it does not take.

    Examples
    --------
    >>> parse_action("MoveAhead 0.1")
    Action(name='MoveAhead', target=None, numbers=(0.1,))
    >>> str(parse_action("OpenObject @0.5,0.25 0.7"))
    'OpenObject @0.5,0.25 0.7'
    """
    if not isinstance(text, str):
        raise ActionError(f"{text!r:.80} is no action: give a text")
    name, *rest = text.split(" ")
    if rest and not all((name, *rest)):
        raise ActionError(f"{text!r:.200}: between words is one blank, and none before or after them")
    spec = action_spec(name)
    target: Target | None = None
    if spec.has_target:
        if not rest:
            raise ActionError(f"{text!r:.200}: {_usage(name)}")
        target = _image_point(rest[0], text) if rest[0].startswith("@") else rest[0]
        rest = rest[1:]
    try:
        numbers = tuple(map(_number, rest))
    except ValueError:
        raise ActionError(f"{text!r:.200}: {_usage(name)}") from None
    action = Action(name, target, numbers)
    amounts_of(action)
    return action


def _number(word: str) -> float:
    """A number in plain digits; Python would take those of any script, and underscores between them."""
    if not word.isascii() or "_" in word:
        raise ValueError(word)
    return float(word)


def parse_actions(texts: Iterable[str]) -> tuple[Action, ...]:
    """Read some actions; see `parse_action`."""
    return tuple(map(parse_action, texts))


def open_action(object_id: str) -> Action:
    """The action that opens an object."""
    return Action(OPEN, object_id)


def pick_up_action(object_id: str) -> Action:
    """The action that picks an object up."""
    return Action(PICK_UP, object_id)


def move_action(object_id: str, position: Vec3) -> Action:
    """The action that puts the centre of an object somewhere, metres.

    >>> str(move_action("Stool|1", (1.25, -0.5, 0.38)))
    'MoveObject Stool|1 1.25 -0.5 0.38'
    """
    return Action(MOVE, object_id, position)


def walk_and_rest(actions: Sequence[Action]) -> tuple[tuple[Action, ...], tuple[Action, ...]]:
    """The whole steps that an episode begins with, and what follows them: a manipulation, then Done.

    >>> walk, rest = walk_and_rest(parse_actions(["MoveAhead", "RotateLeft", "OpenObject Fridge|1", "Done"]))
    >>> [action.name for action in walk], [action.name for action in rest]
    (['MoveAhead', 'RotateLeft'], ['OpenObject', 'Done'])
    """
    walk = tuple(takewhile(lambda action: action.name in NAVIGATION and not action.numbers, actions))
    return walk, tuple(actions[len(walk) :])


def perform(agent: Agent, action: Action) -> ActionResult:
    """Let an agent do an action; steps, turns and tilts without an amount are those of its own body.

    Raises
    ------
    ActionError
        If there is no such action, or it has too few or wrong numbers or no target.
    UnknownNameError
        If the target is no object of the room.
    """
    spec, amounts = action_spec(action.name), amounts_of(action, agent.embodiment)
    if not spec.has_target:
        return spec.run(agent, *amounts)
    target = object_of(agent, action)
    return nothing_at(action) if target is None else spec.run(agent, target, *amounts)


def object_of(agent: Agent, action: Action) -> str | None:
    """The object that an action is done to: the one that it names, or that is seen at its image point, if any is.

    Raises
    ------
    ActionError
        If the point is not in the picture.
    """
    return agent.object_at(*action.target) if isinstance(action.target, tuple) else action.target


def nothing_at(action: Action) -> ActionResult:
    """What comes of an action at an image point where no object is seen."""
    return ActionResult(False, f"there is no object at image point {action.target}")


def action_spec(name: str) -> ActionSpec:
    """What an action takes.

    Raises
    ------
    ActionError
        If there is no such action; names the nearest.
    """
    if name not in ACTIONS:
        near = nearest_names(name, ACTIONS)
        hint = f"; did you mean {' or '.join(near)}?" if near else ""
        raise ActionError(f"{name!r:.80} is not an action{hint}")
    return ACTIONS[name]


OPEN, CLOSE, PICK_UP, MOVE = "OpenObject", "CloseObject", "PickupObject", "MoveObject"
PUSH, PULL, TELEPORT = "PushObject", "PullObject", "Teleport"

_STEP = Amount("metres", 0.0, 5.0, lambda body: body.step_m)
_TURN = Amount("degrees", 0.0, 360.0, lambda body: body.rotate_deg, scale=180.0)
_TILT = Amount("degrees", 0.0, 90.0, lambda body: body.look_deg, scale=180.0)
_PUSH = Amount("metres", 0.001, AGENT.push_m, 0.25)
_FAR = 1e4
_X, _Y, _Z = (Amount(axis, -_FAR, _FAR, scale=2.0) for axis in "xyz")
POSITION = (_X, _Y, _Z)
"""Metres in the room."""

_NAVIGATION: dict[str, ActionSpec] = {
    "MoveAhead": ActionSpec(False, (_STEP,), lambda agent, metres: agent.move(metres)),
    "MoveBack": ActionSpec(False, (_STEP,), lambda agent, metres: agent.move(-metres)),
    "MoveLeft": ActionSpec(False, (_STEP,), lambda agent, metres: agent.move(0.0, -metres)),
    "MoveRight": ActionSpec(False, (_STEP,), lambda agent, metres: agent.move(0.0, metres)),
    "RotateLeft": ActionSpec(False, (_TURN,), lambda agent, degrees: agent.rotate(degrees)),
    "RotateRight": ActionSpec(False, (_TURN,), lambda agent, degrees: agent.rotate(-degrees)),
    "LookUp": ActionSpec(False, (_TILT,), lambda agent, degrees: agent.look(-degrees)),
    "LookDown": ActionSpec(False, (_TILT,), lambda agent, degrees: agent.look(degrees)),
    "Crouch": ActionSpec(False, (), lambda agent: agent.crouch()),
    "Stand": ActionSpec(False, (), lambda agent: agent.stand()),
    TELEPORT: ActionSpec(
        False,
        (_X, _Y, Amount("yaw_deg", -360.0, 360.0), Amount("horizon_deg", -90.0, 90.0, 0.0)),
        lambda agent, x, y, yaw_deg, horizon_deg: agent.teleport(x, y, yaw_deg, horizon_deg),
    ),
}
_MANIPULATION: dict[str, ActionSpec] = {
    OPEN: ActionSpec(
        True, (Amount("openness", 0.0, 1.0, 1.0),), lambda agent, target, openness: agent.open(target, openness)
    ),
    CLOSE: ActionSpec(True, (), lambda agent, target: agent.close(target)),
    PICK_UP: ActionSpec(True, (), lambda agent, target: agent.pick_up(target)),
    "PutObject": ActionSpec(True, (), lambda agent, target: agent.put(target)),
    "DropHandObject": ActionSpec(False, (), lambda agent: agent.drop()),
    MOVE: ActionSpec(True, POSITION, lambda agent, target, x, y, z: agent.move_object(target, (x, y, z))),
    PUSH: ActionSpec(True, (_PUSH,), lambda agent, target, metres: agent.push(target, metres)),
    PULL: ActionSpec(True, (_PUSH,), lambda agent, target, metres: agent.pull(target, metres)),
    "MoveArm": ActionSpec(False, POSITION, lambda agent, x, y, z: agent.move_hand((x, y, z))),
    "MoveArmBase": ActionSpec(
        False,
        (Amount("metres above the floor", 0.0, 3.0, scale=2.0),),
        lambda agent, metres: agent.set_arm_base(metres),
    ),
}
NAVIGATION, MANIPULATION = tuple(_NAVIGATION), tuple(_MANIPULATION)
"""Names of the actions that move the agent or its camera and nothing else, and of those that do something."""
WALKING = tuple(name for name in NAVIGATION if name != TELEPORT)
"""Names of the actions that an agent walks and looks about with."""
KIND_OF = {OPEN: "Open", CLOSE: "Close", PICK_UP: "Pickup", MOVE: "Move", PUSH: "Move", PULL: "Move"}
"""What the tables call the manipulation that an action is."""
DONE = "Done"
ACTIONS: dict[str, ActionSpec] = {
    **_NAVIGATION,
    **_MANIPULATION,
    DONE: ActionSpec(False, (), lambda agent: ActionResult(True)),
}
"""All actions by name."""


def amounts_of(action: Action, body: Embodiment = AGENT) -> list[float]:
    """The amounts of an action, with a body's defaults.

    Raises
    ------
    ActionError
        If there is no such action, or it has too few or wrong numbers, or lacks a target or has one that it does not take.
    """
    spec = action_spec(action.name)
    if spec.has_target != (action.target is not None) or len(action.numbers) > len(spec.amounts):
        raise ActionError(f"{str(action)!r:.200}: {_usage(action.name)}")
    amounts = []
    for place, amount in enumerate(spec.amounts):
        value = action.numbers[place] if place < len(action.numbers) else amount.default_of(body)
        if value is None:
            raise ActionError(f"{str(action)!r:.200}: {_usage(action.name)}")
        if not (math.isfinite(value) and amount.low <= value <= amount.high):
            raise ActionError(f"{str(action)!r:.200}: {amount.name} must be from {amount.low:g} to {amount.high:g}")
        amounts.append(value)
    return amounts


def _usage(name: str) -> str:
    spec = action_spec(name)
    wanted = ["an object id or an image point"] if spec.has_target else []
    wanted += [amount.name if amount.default is None else f"{amount.name} (optional)" for amount in spec.amounts]
    return f"{name} takes {', '.join(wanted) or 'nothing'}"


def _image_point(word: str, text: str) -> tuple[float, float]:
    try:
        x, y = map(_number, word[1:].split(","))
    except ValueError:
        raise ActionError(f"{text!r:.200}: an image point is written @x,y") from None
    if not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
        raise ActionError(f"{text!r:.200}: x and y are shares of the picture, 0 to 1")
    return x, y
