"""Answers by a network, from what was seen around the target before and after the manipulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import torch

from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.answerer import ManipulationAnswerer, fitting
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.networks.windows import cut, window
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.datasets.vocabulary import Vocabulary


@dataclass(frozen=True, eq=False)
class NetworkAnswerer:
    """Looks at both views where the target was seen; at all of them if it was not.

    Attributes
    ----------
    network : ManipulationAnswerer
        Trained.
    vocabulary : Vocabulary
        Its words and answers.
    with_box : bool
        Whether it has learnt on views cut about the target, and not on whole ones.
    """

    network: ManipulationAnswerer
    vocabulary: Vocabulary
    with_box: bool = True

    def answer(self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Answerer`."""
        chances = self.chances(asked, before, after, sighting)
        return max(chances, key=chances.__getitem__)

    @torch.no_grad()
    def chances(
        self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None
    ) -> Mapping[str, float]:
        """See `remqa_data.agents.parts.interfaces.Weighing`."""
        height, width = before.depth.shape
        box = None if sighting is None or not self.with_box else np.array(sighting.box) * (width, height, width, height)
        place = window(box, (height, width))
        views = np.stack([cut(percept.rgb, place, self.network.side_px) for percept in (before, after)]).transpose(
            0, 3, 1, 2
        )
        numbers = torch.from_numpy(self.vocabulary.encode_batch([asked.text])[0])
        with one_thread():
            said = self.network(numbers, torch.from_numpy(np.ascontiguousarray(views))[None])
        answers = self.vocabulary.answers
        shares = fitting(said.answers, [asked.kind], answers).softmax(1)[0].tolist()
        return dict(zip(answers, shares, strict=True))
