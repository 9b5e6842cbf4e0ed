"""Learning to see small: the view encoder on frames of walks, as they look in a few pixels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.view_encoder import PARTS, ViewEncoder, shrunk
from remqa_data.agents.training.pictures import Picture, Pictures, detector_types, relit
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.opencv import cv2

HOW = (cv2.INTER_AREA, cv2.INTER_NEAREST)
"""Live views are shrunk, cached ones are drawn small: to the encoder both are to be the same."""

SCORED = 200
"""Frames of val rooms that are scored."""


class ViewingTask:
    """The view encoder learns what parts of views show; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the first one's val rooms give the score.
    detector : Detector
        Trained: its backbone is what the encoder begins with.
    device : str
        Where to compute.
    """

    def __init__(self, roots: Sequence[Path], detector: Detector, device: str = "cpu") -> None:
        types = detector_types()
        self.model = ViewEncoder(len(types))
        self.model.backbone.load_state_dict(detector.backbone.state_dict())
        self.device = device
        rooms = learning_rooms(roots)
        frames = [Pictures(root, "train", "rgb", types, rooms) for root in roots]
        self._places = [(pictures, index) for pictures in frames for index in range(len(pictures))]
        val = Pictures(roots[0], "train", "rgb", types, rooms_of(roots[0], "val"))
        self._scored = [val[index] for index in range(0, len(val), max(1, len(val) // SCORED))]

    def __len__(self) -> int:
        return len(self._places)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> tuple[Tensor, Tensor]:
        """(n, 3, VIEW_PX, VIEW_PX) views, perhaps mirrored, in another light; (n, PARTS^2, 1 + types) what they show."""
        views, shares = [], []
        for sample, rng in zip(samples, rngs, strict=True):
            pictures, index = self._places[sample]
            picture = pictures[index]
            view = relit(shrunk(picture.rgb, HOW[int(rng.integers(len(HOW)))]), rng)
            share = shares_of(picture, self.model.types)
            if rng.random() < 0.5:
                view, share = np.ascontiguousarray(view[:, ::-1]), np.ascontiguousarray(share[:, ::-1])
            views.append(torch.from_numpy(view).permute(2, 0, 1))
            shares.append(torch.from_numpy(share).flatten(0, 1))
        return torch.stack(views), torch.stack(shares)

    def losses(self, batch: tuple[Tensor, Tensor]) -> Mapping[str, Tensor]:
        """Cross-entropy of what the parts show."""
        views, shares = (part.to(self.device) for part in batch)
        logits = self.model.shown(self.model(views))
        return {"loss": functional.cross_entropy(logits.flatten(0, 1), shares.flatten(0, 1))}

    def score(self) -> Mapping[str, float]:
        """On val rooms the loss, and of the parts that show most of one type the share where that is the likeliest."""
        if not self._scored:
            return {}
        views = torch.stack([torch.from_numpy(shrunk(picture.rgb)).permute(2, 0, 1) for picture in self._scored])
        shares = torch.stack([torch.from_numpy(shares_of(picture, self.model.types)) for picture in self._scored])
        shares = shares.flatten(1, 2).to(self.device)
        logits = self.model.shown(self.model(views.to(self.device)))
        loss = functional.cross_entropy(logits.flatten(0, 1), shares.flatten(0, 1))
        most, which = shares.max(2)
        is_clear = (most > 0.5) & (which > 0)
        right = (logits.argmax(2) == which)[is_clear]
        return {"val_loss": float(loss), "val_parts_right": float(right.float().mean())}


def shares_of(picture: Picture, types: int) -> np.ndarray:
    """(PARTS, PARTS, 1 + types) float32 shares of the pixels of each part that are of each type; 0 is none of the types."""
    kinds = np.concatenate([[-1], picture.types])[picture.instances] + 1
    height, width = kinds.shape
    rows = np.arange(height) * PARTS // height
    columns = np.arange(width) * PARTS // width
    parts = rows[:, None] * PARTS + columns
    counts = np.bincount((parts * (1 + types) + kinds).ravel(), minlength=PARTS**2 * (1 + types))
    shares = counts.reshape(PARTS, PARTS, 1 + types).astype(np.float32)
    return np.asarray(shares / shares.sum(axis=2, keepdims=True), dtype=np.float32)
