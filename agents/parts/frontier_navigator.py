"""Navigation without a walk before: explore to the nearest frontier until the target is believed in, then go there.

Frontiers as in Yamauchi (1997); the map of labels that grows on the way, as in the modular navigators to objects of today
(such as Chaplot et al. 2020), whose learned choice of goals is the nearest frontier here.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.predicted_memory import RoomMap
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.parts.explorer import Belief, Explorer
from remqa_data.agents.parts.interfaces import Percept

SURE, FAIRLY_SURE = 0.8, 1.5
"""Votes that it takes to go to what the expression means exactly, and to what it may mean."""
THINK_EVERY = 3
"""Actions of a plan that are done before it is thought over, with what was seen meanwhile."""


@dataclass(frozen=True, eq=False)
class FrontierNavigator:
    """Explores, and walks to what it believes to be the target; of the stored walk it knows nothing.

    Attributes
    ----------
    detector : Detector
        Trained.
    types : tuple of str
        What it knows.
    """

    detector: Detector
    types: tuple[str, ...]

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> FrontierWalker:
        """Begin an episode; nothing is drawn."""
        room = RoomMap(self.detector, self.types, memory.body, memory.plan.floor_z)
        return FrontierWalker(Explorer(room, asked))


class FrontierWalker:
    """Walks in one episode; see `FrontierNavigator`."""

    def __init__(self, explorer: Explorer) -> None:
        self._explorer = explorer
        self._plan: deque[str] = deque()
        self._left = 0

    @property
    def memory(self) -> WalkMemory:
        """See `remqa_data.agents.parts.interfaces.Remembering`."""
        return self._explorer.memory

    def next_action(self, percept: Percept) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Walker`."""
        self._explorer.perceive(percept)
        if not self._plan or not self._left or not percept.succeeded:
            self._plan = deque(self._thought_over())
            self._left = THINK_EVERY
        if not self._plan:
            return None
        self._left -= 1
        return self._explorer.act(self._plan.popleft())

    def _thought_over(self) -> list[str]:
        """What to do next; nothing where it is there, or nothing is left to do."""
        belief = self._explorer.belief()
        if belief is not None and is_sure(belief):
            return self._to(belief.instance)
        return self._explorer.to_frontier() or (self._to(belief.instance) if belief is not None else [])

    def _to(self, instance: Instance) -> list[str]:
        way = self._explorer.to_outlook(instance)
        return self._explorer.to_frontier(towards=instance) if way is None else way


def is_sure(belief: Belief) -> bool:
    """Whether the agent goes to what it believes in, instead of exploring."""
    if belief.instance.found_by == "graph":
        return belief.votes >= SURE
    return belief.instance.found_by == "graph, roughly" and belief.votes >= FAIRLY_SURE
