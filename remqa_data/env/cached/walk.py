"""One episode of navigation over cached views, as it goes on."""

from __future__ import annotations

import operator
from typing import Any

from remqa_data.env.cached.tasks import CachedTasks
from remqa_data.errors import ActionError
from remqa_data.metrics import distance_to_goal_m, spl
from remqa_data.sim.agent.actions import DONE, WALKING
from remqa_data.views.reader import RoomViews
from remqa_data.views.states import TURNS
from remqa_data.views.tasks import NavigationTask

ACTIONS = (*WALKING, DONE)
"""What the agent can do, by number: the first are those of `remqa_data.env.actions.DISCRETE`, with the same numbers."""
_DONE = len(WALKING)
_NUMBER = {name: number for number, name in enumerate(ACTIONS)}


class Walk:
    """An agent's way through a room.

    Attributes
    ----------
    state : int
        Where the agent is, see `remqa_data.views.states`.
    steps : int
        How many actions it has done.
    is_over : bool
        Whether an episode must begin first.
    """

    task: NavigationTask
    room: RoomViews

    def __init__(self, tasks: CachedTasks, max_steps: int) -> None:
        self._tasks, self._max_steps = tasks, max_steps
        self.state = self.steps = self._moved = 0
        self.is_over = True

    def __getstate__(self) -> dict[str, Any]:
        """Without the cached room, of which only what is looked at is read; another process opens it for itself."""
        return {name: value for name, value in vars(self).items() if name not in ("room", "_table", "_refusals")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        if "task" in state:
            self._enter(self._tasks.room(self.task))

    def begin(self, name: str) -> None:
        """Begin the episode of a question; until there is all that it takes, there is none."""
        self.is_over = True
        task = self._tasks.task(name)
        room = self._tasks.room(task)
        self.state = self._tasks.start(task, room)
        self.task = task
        self._enter(room)
        self.steps = self._moved = 0
        self.is_over = False

    def _enter(self, room: RoomViews) -> None:
        self.room = room
        self._table, self._refusals = self.room.transitions.table, self.room.transitions.refusals

    def act(self, action: int) -> str:
        """Do an action; why it was refused, or ""."""
        self.steps += 1
        if action == _DONE:
            return ""
        before, after = self.state, int(self._table[self.state, action])
        if after == before:
            return self.room.transitions.reasons[int(self._refusals[before, action])]
        self._moved += before // len(TURNS) != after // len(TURNS)
        self.state = after
        return ""

    def ended(self, action: int) -> tuple[bool, bool]:
        """Whether an action that was done has terminated or truncated the episode."""
        terminated = action == _DONE
        truncated = not terminated and self.steps >= self._max_steps
        self.is_over = terminated or truncated
        return terminated, truncated

    def measures(self, action: int) -> dict[str, Any]:
        """Those of the live environment's measures that are about navigation, after the last action."""
        task, here = self.task, self.room.positions[self.state // len(TURNS)]
        navigated = bool(self.room.succeeds(task.question_id)[self.state])
        path_length_m = self._moved * self.room.states.step_m
        return {
            "S_N": navigated,
            "SPL": float(spl([navigated], [task.path_length_m], [path_length_m])[0]),
            "distance_to_goal_m": float(distance_to_goal_m(here[None], task.goals[None])[0]),
            "path_length_m": path_length_m,
            "steps": self.steps - (action == _DONE),
        }


def action_number(action: Any) -> int:
    """The number of an action that is given as a number or by its name.

    Raises
    ------
    ActionError
        If it is none.
    """
    if isinstance(action, str) and action in _NUMBER:
        return _NUMBER[action]
    try:
        number = operator.index(action)
    except TypeError:
        number = -1
    if not 0 <= number < len(ACTIONS):
        raise ActionError(
            f"{action!r:.80} is not an action: give a number below {len(ACTIONS)} or one of {', '.join(ACTIONS)}"
        )
    return number
