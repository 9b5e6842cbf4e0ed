"""A small encoder of small views, for who looks millions of times: what each part of the view shows.

It stands for the ResNet that target-driven navigation looks through (Zhu et al. 2017; Wortsman et al. 2019): trained before,
and then left as it is, so that the features of cached views are worked out once.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.detection.pyramid import CHANNELS, Pyramid
from remqa_data.geometry.types import U8
from remqa_data.opencv import cv2

VIEW_PX = 84
"""Width and height of the views."""

PARTS = 7
"""A view is divided into so many parts across and down."""


class ViewEncoder(nn.Module):
    """Features of the parts of views, and what of each part is of which type.

    Parameters
    ----------
    types : int
        How many types of objects it knows.
    """

    def __init__(self, types: int) -> None:
        super().__init__()
        self.types = types
        self.backbone = Pyramid()
        self.shares = nn.Linear(CHANNELS, 1 + types)

    def forward(self, rgb: Tensor) -> Tensor:
        """(n, PARTS^2, CHANNELS) features of (n, 3, VIEW_PX, VIEW_PX) uint8 views, rows of parts from the top left."""
        return functional.adaptive_avg_pool2d(self.backbone(rgb), PARTS).flatten(2).transpose(1, 2)

    def shown(self, features: Tensor) -> Tensor:
        """(..., 1 + types) logits of what the parts show, whose features are (..., CHANNELS): 0 is none of the types."""
        return self.shares(features)  # type: ignore[no-any-return]

    @torch.no_grad()
    def encode(self, views: U8) -> Tensor:
        """Features of (n, h, w, 3) uint8 views of any size."""
        small = np.stack([shrunk(view) for view in views])
        return self(torch.from_numpy(small).permute(0, 3, 1, 2))  # type: ignore[no-any-return]


def shrunk(view: U8, how: int = cv2.INTER_AREA) -> U8:
    """A (h, w, 3) view as (VIEW_PX, VIEW_PX, 3)."""
    if view.shape[:2] == (VIEW_PX, VIEW_PX):
        return view
    return np.asarray(cv2.resize(view, (VIEW_PX, VIEW_PX), interpolation=how), dtype=np.uint8)
