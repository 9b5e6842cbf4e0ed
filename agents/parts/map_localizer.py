"""Localisation by memory: where the box that the walk has left of the chosen object is in the present depth image."""

from __future__ import annotations

import numpy as np

from remqa_data.agents.knowledge.instance import choose_instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.knowledge.sight import seen_of
from remqa_data.agents.parts.interfaces import Percept, Sighting


class MapLocalizer:
    """Takes the pixels whose depth lies in the remembered box of the instance that the expression means."""

    def locate(
        self, asked: Question, memory: WalkMemory, percept: Percept, rng: np.random.Generator
    ) -> Sighting | None:
        """See `remqa_data.agents.parts.interfaces.Localizer`; nothing is drawn."""
        instance = choose_instance(asked.target, memory)
        return None if instance is None else Sighting.of_mask(seen_of(instance, percept.depth, percept.camera))
