"""Localisation by networks: of what the detector finds in the view, what the expression means to a matcher."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.detector import Detector
from remqa_data.agents.networks.matcher import Matcher
from remqa_data.agents.networks.regions import candidates, regions_of
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.geometry.types import Flags


@dataclass(frozen=True, eq=False)
class NetworkLocalizer:
    """Finds the target in the view alone; it remembers nothing of the walk.

    Attributes
    ----------
    detector, matcher
        Trained networks.
    vocabulary : Vocabulary
        The matcher's.
    """

    detector: Detector
    matcher: Matcher
    vocabulary: Vocabulary

    @torch.no_grad()
    def locate(
        self, asked: Question, memory: WalkMemory, percept: Percept, rng: np.random.Generator
    ) -> Sighting | None:
        """See `remqa_data.agents.parts.interfaces.Localizer`; nothing is drawn."""
        with one_thread():
            rgb = torch.from_numpy(percept.rgb).permute(2, 0, 1)[None]
            features, (found,) = self.detector.look(rgb)
            places = candidates(found)
            if not len(places):
                return None
            regions = regions_of(self.detector, features, found.boxes[places], percept.depth)
            numbers = torch.from_numpy(self.vocabulary.encode_batch([asked.expression])[0])
            best = places[int(self.matcher(numbers, regions).scores[0].argmax())]
        height, width = percept.depth.shape
        box = found.boxes[best] / np.array([width, height, width, height], dtype=np.float32)
        x1, y1, x2, y2 = (float(share) for share in box)
        return Sighting((x1, y1, x2, y2), middle_of(found.mask(best, percept.depth.shape)))


def middle_of(mask: Flags) -> tuple[float, float]:
    """Of the pixels of a (h, w) mask the one nearest to their middle, as shares of the width and height."""
    rows, columns = np.nonzero(mask)
    nearest = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    return (float(columns[nearest]) + 0.5) / mask.shape[1], (float(rows[nearest]) + 0.5) / mask.shape[0]
