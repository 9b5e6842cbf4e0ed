"""Where objects may be, by what the second stage of the detector sees of the whole picture (as in Ren et al. 2015).

The first stage looks with a backbone that knows less, and misses most drawers. What it finds stays: both propose, and of two
boxes that are of the same object the likelier one is looked at again.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn

from remqa_data.agents.networks.detection.detector import (
    ENLARGED,
    Peaks,
    apart,
    begin_with_few,
    boxes_at,
    likeliest_middles,
    sides_of,
)
from remqa_data.agents.networks.detection.pyramid import CHANNELS, STRIDE, conv_block
from remqa_data.geometry.types import F32

SAME_PLACE_IOU = 0.7
"""Of two boxes that overlap more, the likelier one is looked at; that is not always the better one, so some others may stay."""


class Middles(NamedTuple):
    """Where the middles of objects are in n enlarged pictures.

    Attributes
    ----------
    middles : (n, h', w')
        Logits.
    sides : (n, 4, h', w')
        Distances to the left, upper, right and lower side of the object, pixels of the enlarged picture.
    """

    middles: Tensor
    sides: Tensor


class Proposer(nn.Module):
    """Proposes boxes, whatever they hold; a small network on the second stage's features."""

    def __init__(self) -> None:
        super().__init__()
        heads = nn.Conv2d(CHANNELS, 1 + 4, 1)
        begin_with_few(heads)
        self.layers = nn.Sequential(conv_block(CHANNELS, CHANNELS), conv_block(CHANNELS, CHANNELS), heads)

    def forward(self, features: Tensor) -> Middles:
        """What it says of pictures of which the second stage has (n, CHANNELS, h', w') features."""
        said = self.layers(features).float()
        return Middles(said[:, 0], sides_of(said[:, 1:]))

    @torch.no_grad()
    def propose(self, looks: Sequence[tuple[Tensor, float]], seen: Peaks, least_votes: float) -> F32:
        """(m, 4) boxes in one picture, pixels: those that were seen, and its own.

        Parameters
        ----------
        looks : sequence of ((1, CHANNELS, h', w') features, float)
            Of the second stage, and how many times as wide and high as the picture it was shown.
        seen : Peaks
            Of the first stage.
        least_votes : float
            What is less likely an object is not proposed.
        """
        boxes, scores = [seen.boxes], [seen.votes.sum(axis=1)]
        for features, times in looks:
            (likely,), (own,) = likeliest_boxes(self(features))
            boxes.append((own / times).numpy(force=True))
            scores.append(likely.numpy(force=True))
        proposed = np.concatenate(boxes)
        return proposed[apart(proposed, np.concatenate(scores), least_votes, SAME_PLACE_IOU)]


def likeliest_boxes(said: Middles) -> tuple[Tensor, Tensor]:
    """How likely the likeliest middles in each of n enlarged pictures are, (n, k), and their boxes, (n, k, 4), in pixels.

    Pixels are those of the pictures as they were.
    """
    scores, rows, columns = likeliest_middles(said.middles)
    height, width = said.middles.shape[1:]
    places = (rows * width + columns)[:, None].expand(-1, 4, -1)
    sides = said.sides.flatten(2).gather(2, places).transpose(1, 2)
    size = (height * STRIDE, width * STRIDE)
    boxes = boxes_at(sides.flatten(0, 1), rows.flatten(), columns.flatten(), size) / ENLARGED
    return scores, boxes.view(*scores.shape, 4)
