"""Localisation by memory: where the box that the walk has left of the chosen object is in the present depth image."""

from __future__ import annotations

import numpy as np

from remqa_data.agents.knowledge.instance import choose_instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.knowledge.sight import seen_of
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.geometry.types import Flags
from remqa_data.sim.metadata import tight_box


class MapLocalizer:
    """Takes the pixels whose depth lies in the remembered box of the instance that the expression means."""

    def locate(
        self, asked: Question, memory: WalkMemory, percept: Percept, rng: np.random.Generator
    ) -> Sighting | None:
        """See `remqa_data.agents.parts.interfaces.Localizer`; nothing is drawn."""
        instance = choose_instance(asked.target, memory)
        return None if instance is None else sighting_of(seen_of(instance, percept.depth, percept.camera))


def sighting_of(mask: Flags) -> Sighting | None:
    """The box of the pixels of a (h, w) mask, and of the pixels the one nearest to their middle."""
    box = tight_box(mask)
    if box is None:
        return None
    height, width = mask.shape
    x1, y1, x2, y2 = box
    rows, columns = np.nonzero(mask)
    middle = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    point = (float(columns[middle]) + 0.5) / width, (float(rows[middle]) + 0.5) / height
    return Sighting((x1 / width, y1 / height, x2 / width, y2 / height), point)
