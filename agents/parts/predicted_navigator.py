"""The paper's navigation on a map that nobody has labelled: the detector looks at the frames of the walk."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from remqa_data.agents.knowledge.instance import choose_instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.predicted_memory import RoomMap
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.parts.semantic_navigator import SemanticMapWalker


@dataclass(eq=False)
class PredictedMapNavigator:
    """Walks as `SemanticMapNavigator` does; of the stored walk it takes what was seen, and from where, alone.

    Attributes
    ----------
    detector : Detector
        Trained.
    types : tuple of str
        What it knows.
    """

    detector: Detector
    types: tuple[str, ...]
    _last: tuple[WalkMemory, WalkMemory] | None = field(default=None, init=False)

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> SemanticMapWalker:
        """Begin an episode; nothing is drawn."""
        if self._last is None or self._last[0] is not memory:  # many questions are about one walk
            self._last = memory, self._remembered(memory)
        own = self._last[1]
        return SemanticMapWalker(choose_instance(asked.target, own), own, opens=asked.manipulation == "Open")

    def _remembered(self, memory: WalkMemory) -> WalkMemory:
        assert memory.looks is not None, "a dataset has the frames of its walks"
        room = RoomMap(self.detector, self.types, memory.body, memory.plan.floor_z)
        for look in memory.looks():
            room.add(look)
        return room.memory()
