"""What a network that grounds expressions in one stage is to say, and how far what it says is from that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detector_loss import box_loss
from remqa_data.agents.networks.grounding import CELL_PX, Said, clipped
from remqa_data.geometry.types import F32

INNER = 1 / 3
"""Cells in this share of a box, across and down, stand for its middle, and the nearest one in any case."""

AGREEMENT_WEIGHT = 0.1
LOOKING_WEIGHT = 0.5
"""Of MCN's agreement, and of where CGAN looks."""


@dataclass(frozen=True, eq=False)
class Targets:
    """What e expressions mean.

    Attributes
    ----------
    boxes : (e, 4)
        Pixels.
    masks : (e, h', w')
        Share of each cell that shows it.
    """

    boxes: Tensor
    masks: Tensor


def middles_of(boxes: Tensor, height: int, width: int) -> Tensor:
    """(e, height, width) where the middles of (e, 4) boxes are: shares that sum to 1 for each."""
    down, along = ((torch.arange(length, device=boxes.device) + 0.5) * CELL_PX for length in (height, width))
    flags = []
    for low, high, places in ((boxes[:, 1], boxes[:, 3], down), (boxes[:, 0], boxes[:, 2], along)):
        off = (places[None] - ((low + high) / 2)[:, None]).abs()
        flags.append((off <= (high - low)[:, None] * INNER / 2) | (off == off.amin(1, keepdim=True)))
    inside = (flags[0][:, :, None] & flags[1][:, None]).to(boxes.dtype)
    return inside / inside.sum((1, 2), keepdim=True)


def grounding_losses(
    said: Said, wanted: Targets, size: tuple[int, int], *, is_looking_taught: bool
) -> dict[str, Tensor]:
    """Means over expressions; "loss" is what becomes small.

    Parameters
    ----------
    said : Said
    wanted : Targets
    size : (int, int)
        Height and width of the pictures.
    is_looking_taught : bool
        Whether the attention is to be the mask (CGAN's attention to instances); otherwise branches are to agree (MCN).
    """
    middles = middles_of(wanted.boxes, *said.places.shape[1:])
    log_places = said.places.flatten(1).log_softmax(1)
    place = -(middles.flatten(1) * log_places).sum(1).mean()
    asked, rows, columns = torch.nonzero(middles, as_tuple=True)
    boxes = clipped(said.boxes[asked, :, rows, columns], size)
    box = (box_loss(boxes, wanted.boxes[asked]) * middles[asked, rows, columns]).sum() / len(wanted.boxes)
    mask = mask_loss(said.masks, wanted.masks)
    if is_looking_taught:
        steps = said.attention.shape[1]
        last = LOOKING_WEIGHT * mask_loss(said.attention.flatten(0, 1), wanted.masks.repeat_interleave(steps, 0))
    else:
        last = -AGREEMENT_WEIGHT * said.agreement.clamp(min=1e-6).log().mean()
    return {"loss": place + box + mask + last, "place": place, "box": box, "mask": mask, "looking": last}


def mask_loss(logits: Tensor, shares: Tensor) -> Tensor:
    """Cross-entropy and 1 - Dice of (e, h', w') masks, so that small things count."""
    entropy = functional.binary_cross_entropy_with_logits(logits, shares)
    said = logits.sigmoid()
    common = 2 * (said * shares).sum((1, 2)) + 1
    return entropy + (1 - common / (said.sum((1, 2)) + shares.sum((1, 2)) + 1)).mean()


def shares_of(shown: np.ndarray) -> F32:
    """(h', w') share of each cell of a (h, w) mask; what is cut off at the edges counts as it is."""
    height, width = (-(-side // CELL_PX) for side in shown.shape)
    padded = np.zeros((height * CELL_PX, width * CELL_PX), dtype=np.float32)
    padded[: shown.shape[0], : shown.shape[1]] = shown
    return np.asarray(padded.reshape(height, CELL_PX, width, CELL_PX).mean(axis=(1, 3)), dtype=np.float32)
