"""Localisation by networks: of what the detector finds in the view, what the expression means to a matcher."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.committee import Committee
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.regions import AnyDetector, candidates, regions_of
from remqa_data.agents.networks.grounding import CELL_PX, Grounder, grounded, sight_of
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.parts.interfaces import Percept, Sighting, middle_of
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.geometry.types import F32


@dataclass(frozen=True, eq=False)
class NetworkLocalizer:
    """Finds the target in the view alone; it remembers nothing of the walk.

    Attributes
    ----------
    detector : AnyDetector
        Trained.
    committee : Committee
        Trained matchers, or one.
    """

    detector: AnyDetector
    committee: Committee

    @torch.no_grad()
    def locate(
        self, asked: Question, memory: WalkMemory, percept: Percept, rng: np.random.Generator
    ) -> Sighting | None:
        """See `remqa_data.agents.parts.interfaces.Localizer`; nothing is drawn."""
        with one_thread():
            rgb = torch.from_numpy(percept.rgb).permute(2, 0, 1)[None]
            seen, (found,) = self.detector.look(rgb)
            places = candidates(found, self.detector.candidates)
            if not len(places):
                return None
            boxes, scores = found.boxes[places], found.scores[places]
            regions = regions_of(self.detector, seen, boxes, percept.depth, percept.pose.horizon_deg, scores)
            match = self.committee.match([asked.expression], regions)
            (best,), (box,) = match.chosen.tolist(), match.meant_in(regions)
        size = percept.depth.shape
        if asked.manipulation == "Open":
            return _sighting(box, middle_of_both(boxes[best], box, size), size)
        return _sighting(box, middle_of(found.mask(places[best], size)), size)


@dataclass(frozen=True, eq=False)
class GroundingLocalizer:
    """The same in one stage: from the words to a box and a mask.

    Attributes
    ----------
    detector, grounder
        Trained networks.
    vocabulary : Vocabulary
        The grounder's.
    """

    detector: Detector
    grounder: Grounder
    vocabulary: Vocabulary

    @torch.no_grad()
    def locate(
        self, asked: Question, memory: WalkMemory, percept: Percept, rng: np.random.Generator
    ) -> Sighting | None:
        """See `remqa_data.agents.parts.interfaces.Localizer`; nothing is drawn, and something is always found."""
        with one_thread():
            rgb = torch.from_numpy(percept.rgb).permute(2, 0, 1)[None]
            sight = sight_of(self.detector, rgb, torch.from_numpy(percept.depth)[None])
            numbers = torch.from_numpy(self.vocabulary.encode_batch([asked.expression])[0])
            said = self.grounder(numbers, sight, torch.zeros(1, dtype=torch.int64))
        height, width = percept.depth.shape
        (found,) = grounded(said, (height, width))
        mask = np.kron(found.mask, np.ones((CELL_PX, CELL_PX), dtype=np.bool_))[:height, :width]
        return _sighting(found.box, middle_of(mask), mask.shape)


def middle_of_both(found: F32, moved: F32, size: tuple[int, ...]) -> tuple[float, float]:
    """The middle of what two boxes in pixels share, as shares of a view of a height and width.

    What is opened is taken hold of there. Drawers lie side by side, and more often than this the middle of a mask is on
    another one than is meant.

    >>> middle_of_both(np.array([0, 20, 60, 60]), np.array([20, 0, 80, 60]), (100, 200))
    (0.2, 0.4)
    """
    height, width = size
    across, down = (np.maximum(found[:2], moved[:2]) + np.minimum(found[2:], moved[2:])) / 2
    return float(across) / width, float(down) / height


def _sighting(box: F32, point: tuple[float, float], size: tuple[int, ...]) -> Sighting:
    """A box in pixels and a point in shares, as shares of a view of a height and width."""
    height, width = size
    x1, y1, x2, y2 = (float(share) for share in box / np.array([width, height, width, height], dtype=np.float32))
    return Sighting((x1, y1, x2, y2), point)
