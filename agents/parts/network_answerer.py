"""Answers by a network, from what was seen around the target before and after the manipulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.answerer import ManipulationAnswerer, agreed, likeliest
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.networks.windows import looks
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
    """

    network: ManipulationAnswerer
    vocabulary: Vocabulary

    @torch.no_grad()
    def answer(self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Answerer`."""
        height, width = before.depth.shape
        box = None if sighting is None else np.array(sighting.box) * (width, height, width, height)
        views = torch.from_numpy(looks([before.rgb, after.rgb], box, self.network.side_px))
        numbers = torch.from_numpy(self.vocabulary.encode_batch([asked.text] * len(views))[0])
        with one_thread():
            said = agreed(self.network(numbers, views).answers[None])
        return likeliest(said, [asked.kind], self.vocabulary.answers)[0]
