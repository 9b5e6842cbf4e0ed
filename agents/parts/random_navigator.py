"""Random: walks anywhere."""

from __future__ import annotations

import numpy as np

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import Percept
from remqa_data.sim.agent.actions import WALKING


class RandomNavigator:
    """Does navigation actions, each equally likely, and stops after any number of them, each equally likely.

    Parameters
    ----------
    most_steps : int
        The largest such number.
    """

    def __init__(self, most_steps: int) -> None:
        self.most_steps = most_steps

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> RandomWalker:
        """Begin an episode: draw all actions."""
        count = int(rng.integers(0, self.most_steps + 1))
        return RandomWalker(rng.choice(WALKING, count).tolist())


class RandomWalker:
    """Does what was drawn."""

    def __init__(self, actions: list[str]) -> None:
        self._actions = iter(actions)

    def next_action(self, percept: Percept) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Walker`."""
        return next(self._actions, None)
