"""Boxes that were found, judged and moved: how well each fits an object, and where that truly ends.

Of two boxes of the same thing the likelier one is not always the better one: how well a box fits is learnt for itself (IoU-Net,
Jiang et al. 2018), and so is where its sides belong, which a box that was moved once shows better than one that was proposed
(Cascade R-CNN, Cai and Vasconcelos 2018). It takes what is kept of a box for telling objects apart, and no look at the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import Tensor, nn

from remqa_data.agents.networks.detection.pyramid import CHANNELS, zero_linear
from remqa_data.agents.networks.detection.refiner import moved
from remqa_data.agents.networks.detection.regions import GRID, PLACE, Regions

KNOWN = 96
"""Numbers of what is known of a box in the end."""

TRUST = 0.5
"""How much it counts at first how well a box fits."""


class Fit(NamedTuple):
    """What is said of m boxes.

    Attributes
    ----------
    boxes : (m, 4)
        x1, y1, x2, y2 in pixels.
    quality : (m,)
        Logits of the IoU with the object that each is of.
    worth : (m,)
        What that adds to how well words fit an object; the quality learns nothing from it.
    """

    boxes: Tensor
    quality: Tensor
    worth: Tensor


class BoxHead(nn.Module):
    """Moves boxes, and judges them.

    Parameters
    ----------
    types : int
        How many types the detector knows.
    """

    def __init__(self, types: int) -> None:
        super().__init__()
        width = CHANNELS * GRID**2 + types + PLACE + 1
        evened = nn.BatchNorm1d(width)
        self.known = nn.Sequential(evened, nn.Linear(width, KNOWN), nn.ReLU(), nn.Linear(KNOWN, KNOWN), nn.ReLU())
        self.said = zero_linear(KNOWN, 1 + 4)
        self.trust = nn.Parameter(torch.tensor(TRUST))

    def forward(self, pictures: Sequence[Regions]) -> list[Fit]:
        """What it says of the boxes of each picture; at first that all are where they belong."""
        seen = [torch.cat([r.looks.flatten(1), r.types, r.places, r.scores[:, None]], 1) for r in pictures]
        said = self.said(self.known(torch.cat(seen)))
        each = said.split([len(regions.boxes) for regions in pictures])
        return [self._fit(regions, own) for regions, own in zip(pictures, each, strict=True)]

    def _fit(self, regions: Regions, said: Tensor) -> Fit:
        height, width = regions.size
        limits, quality = said.new_tensor([width, height, width, height]), said[:, 0]
        boxes = moved(torch.from_numpy(regions.boxes).to(said), said[:, 1:])
        return Fit(torch.minimum(boxes.clamp(min=0), limits), quality, self.trust * quality.detach())
