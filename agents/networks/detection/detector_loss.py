"""What the detector is to say of a picture, and how far what it says is from that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from scipy import ndimage
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import Detector, Raw, boxes_at
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.geometry.types import F32

LEAST_PIXELS = 25
"""What shows fewer pixels is not asked for."""

NOTHING = -1
"""Where no box is asked for."""

SPREAD_SHARE = 1 / 8
"""Standard deviation of the heat around a middle, of the object's width and height."""

FOCUS, FAR = 2.0, 4.0
"""Exponents of the focal loss of heatmaps (Law and Deng 2018)."""


@dataclass(frozen=True, eq=False)
class Wanted:
    """What is true of a picture, or of a batch of them, with one more dimension at the front.

    Attributes
    ----------
    heat : (h', w') float32
        1 at middles of objects, less around them.
    boxes : (4, h', w') float32
        Box of the object whose middle is at the cell or next to it, pixels.
    types : (h', w') int64
        Index of its type; NOTHING elsewhere.
    cells : (h', w') int64
        What each cell shows: index of its type + 1, or 0.
    weights : (h', w') float32
        How much that counts: small things are as many cells as large ones together.
    """

    heat: Tensor
    boxes: Tensor
    types: Tensor
    cells: Tensor
    weights: Tensor

    def on(self, device: str) -> Wanted:
        """The same elsewhere."""
        return Wanted(**{name: value.to(device) for name, value in vars(self).items()})


def wanted_of(instances: np.ndarray, types: np.ndarray) -> Wanted:
    """What is true of a picture.

    Parameters
    ----------
    instances : (h, w) integers
        0, or the number of an object, from 1.
    types : (objects,) int64
        Index of the type of each object; NOTHING for those that are not looked for.
    """
    height, width = (-(-side // STRIDE) for side in instances.shape)
    heat = np.zeros((height, width), dtype=np.float32)
    boxes = np.zeros((4, height, width), dtype=np.float32)
    kinds = np.full((height, width), NOTHING, dtype=np.int64)
    known = np.concatenate([[NOTHING], types])
    sizes = np.bincount(instances.ravel(), minlength=len(known))
    places = ndimage.find_objects(instances.astype(np.int32), max_label=len(types))
    order = np.argsort(-sizes[1:], kind="stable")  # small things over large ones
    for number in order.tolist():
        place = places[number]
        if place is None or types[number] == NOTHING or sizes[number + 1] < LEAST_PIXELS:
            continue
        rows, columns = place
        box = np.array([columns.start, rows.start, columns.stop, rows.stop], dtype=np.float32)
        _draw(heat, boxes, kinds, box, int(types[number]))
    seen = instances[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE]
    seen = np.pad(seen, ((0, height - seen.shape[0]), (0, width - seen.shape[1])))
    weights = 1 / np.sqrt(np.maximum(sizes, LEAST_PIXELS))[seen]
    return Wanted(
        torch.from_numpy(heat),
        torch.from_numpy(boxes),
        torch.from_numpy(kinds),
        torch.from_numpy(known[seen] + 1),
        torch.from_numpy(weights.astype(np.float32)),
    )


def _draw(heat: F32, boxes: F32, kinds: np.ndarray, box: F32, kind: int) -> None:
    """Write an object into the maps; its box and type stand in the cells next to its middle, within its box."""
    height, width = heat.shape
    x, y = (box[0] + box[2]) / 2 / STRIDE, (box[1] + box[3]) / 2 / STRIDE
    column, row = min(int(x), width - 1), min(int(y), height - 1)
    wide, high = (max(side / STRIDE * SPREAD_SHARE, 0.4) for side in (box[2] - box[0], box[3] - box[1]))
    down = np.exp(-((np.arange(height) - row) ** 2) / (2 * high**2))
    along = np.exp(-((np.arange(width) - column) ** 2) / (2 * wide**2))
    np.maximum(heat, np.outer(down, along), out=heat, casting="same_kind")
    y_reach, x_reach = (int(side / STRIDE >= 3) for side in (box[3] - box[1], box[2] - box[0]))
    near = (
        slice(max(row - y_reach, 0), row + y_reach + 1),
        slice(max(column - x_reach, 0), column + x_reach + 1),
    )
    boxes[(slice(None), *near)] = box[:, None, None]
    kinds[near] = kind


def batch_of(wanted: list[Wanted]) -> Wanted:
    """Several pictures as one batch."""
    names = ("heat", "boxes", "types", "cells", "weights")
    return Wanted(*(torch.stack([getattr(one, name) for one in wanted]) for name in names))


def detector_losses(detector: Detector, raw: Raw, wanted: Wanted, size: tuple[int, ...]) -> dict[str, Tensor]:
    """How far what the detector said of pictures of a (height, width) is from what is true; "loss" is the sum."""
    losses = middle_losses(raw.middles, raw.sides, wanted, size)
    images, rows, columns = torch.nonzero(wanted.types != NOTHING, as_tuple=True)
    asked = max(1, len(images))
    logits = detector.types_at(raw.features[images, :, rows, columns])
    losses["types"] = functional.cross_entropy(logits, wanted.types[images, rows, columns], reduction="sum") / asked
    of_cells = functional.cross_entropy(raw.cells, wanted.cells, reduction="none")
    losses["cells"] = (of_cells * wanted.weights).sum() / wanted.weights.sum()
    return {"loss": sum(losses.values(), torch.zeros(())), **losses}


def middle_losses(middles: Tensor, sides: Tensor, wanted: Wanted, size: tuple[int, ...]) -> dict[str, Tensor]:
    """How far middles, (n, h', w') logits, and sides, (n, 4, h', w'), in pictures of a (height, width) are from the truth."""
    images, rows, columns = torch.nonzero(wanted.types != NOTHING, as_tuple=True)
    boxes = boxes_at(sides[images, :, rows, columns], rows, columns, size)
    return {
        "middles": heat_loss(middles, wanted.heat) / max(1.0, float((wanted.heat == 1).sum())),
        "boxes": box_loss(boxes, wanted.boxes[images, :, rows, columns]).sum() / max(1, len(images)),
    }


def heat_loss(logits: Tensor, heat: Tensor) -> Tensor:
    """Focal loss of a heatmap, summed."""
    said, log_yes, log_no = logits.sigmoid(), functional.logsigmoid(logits), functional.logsigmoid(-logits)
    at_middles = -((1 - said) ** FOCUS) * log_yes
    elsewhere = -(said**FOCUS) * log_no * (1 - heat) ** FAR
    return torch.where(heat == 1, at_middles, elsewhere).sum()


def box_loss(said: Tensor, wanted: Tensor) -> Tensor:
    """(m,) 1 - generalised IoU (Rezatofighi et al. 2019) of (m, 4) boxes."""
    low, high = torch.maximum(said[:, :2], wanted[:, :2]), torch.minimum(said[:, 2:], wanted[:, 2:])
    outer_low, outer_high = torch.minimum(said[:, :2], wanted[:, :2]), torch.maximum(said[:, 2:], wanted[:, 2:])
    common = (high - low).clamp(min=0).prod(1)
    either = (said[:, 2:] - said[:, :2]).prod(1) + (wanted[:, 2:] - wanted[:, :2]).prod(1) - common
    around = (outer_high - outer_low).prod(1).clamp(min=1e-6)
    return 1 - common / either.clamp(min=1e-6) + (around - either) / around
