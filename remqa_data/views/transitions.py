"""Where each action leads from each state, found by letting the agent do it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from remqa_data.errors import ActionError
from remqa_data.geometry.types import I32
from remqa_data.sim.agent.actions import WALKING, parse_action, perform
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.navigation.grid import Cell
from remqa_data.views.states import TURNS, States

MOVES = tuple(name for name in WALKING if name.startswith("Move"))
"""Those that lead from cell to cell; the others turn the agent where it is, whatever there is in the room."""


@dataclass(frozen=True, eq=False)
class Transitions:
    """Where actions lead.

    Attributes
    ----------
    table : (states, actions) int32
        The state after each action of `WALKING`; the state itself if the room or the agent's body refuses.
    refusals : (states, actions) int16
        Why, an index into `reasons`; 0 where nothing is refused.
    reasons : tuple of str
        What the live environment says; the first is "".
    """

    table: I32
    refusals: npt.NDArray[np.int16]
    reasons: tuple[str, ...]


def transitions(agent: Agent, states: States, cells: Iterable[Cell]) -> Transitions:
    """The transitions of an agent in its room as it is now, on the cells that it can reach.

    Cells where it cannot be keep it in every state. A move depends on where the agent stands and faces; a turn, a look and
    a change of posture on how it looks and stands. So moves are made from every cell in every heading, the others on one
    cell in all ways, and nothing is said about actions that the agent itself does not say.

    Raises
    ------
    ActionError
        If a move leads off the grid.
    """
    cells = tuple(cells)
    count = len(states)
    table = np.repeat(np.arange(count, dtype=np.int32)[:, None], len(WALKING), axis=1)
    refusals = np.zeros((count, len(WALKING)), dtype=np.int16)
    reasons: dict[str, int] = {"": 0}
    ways = np.arange(len(TURNS))
    firsts = np.array([states.cell_number(cell) * len(TURNS) for cell in cells])
    for column, name in enumerate(WALKING):
        if name in MOVES:
            for first in firsts.tolist():
                for heading in dict.fromkeys(yaw for yaw, _, _ in TURNS):
                    alike = first + ways[[turn[0] == heading for turn in TURNS]]
                    after, why = _done(agent, states, int(alike[0]), name)
                    table[alike, column] = alike + (after - alike[0])
                    refusals[alike, column] = reasons.setdefault(why, len(reasons))
        else:
            for way in ways.tolist():
                after, why = _done(agent, states, int(firsts[0]) + way, name)
                table[firsts + way, column] = firsts + (after - firsts[0])
                refusals[firsts + way, column] = reasons.setdefault(why, len(reasons))
    return Transitions(table, refusals, tuple(reasons))


def _done(agent: Agent, states: States, state: int, name: str) -> tuple[int, str]:
    """The state after an action, and why it was refused."""
    states.place(agent, state)
    result = perform(agent, parse_action(name))
    after = states.state_of(agent)
    if after is None or result.success == (after == state):
        raise ActionError(f"{name} from {states.pose(state)} leads off the grid, to {(agent.x, agent.y)}")
    return after, result.without_name().error
