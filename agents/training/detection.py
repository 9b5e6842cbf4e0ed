"""Learning to detect: the detector on frames of walks and on views of what questions have opened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from remqa_data.agents.networks.detector import Detector
from remqa_data.agents.networks.detector_loss import Wanted, batch_of, detector_losses, wanted_of
from remqa_data.agents.training.pictures import Pictures, Which, detector_types, varied
from remqa_data.agents.training.rooms import learning_rooms, rooms_of

SEEN: tuple[Which, Which] = ("rgb", "end_rgb")
"""What is learnt from: frames of walks, and what is seen when something is opened or moved."""

FRAMES_APART, END_TIMES = 2, 2
"""In an epoch every second frame of a walk is seen, as it is much like the next, and twice what each question is about."""


class DetectionTask:
    """The detector learns from pictures of all train rooms; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the first one's val rooms give the score.
    side : int
        Pictures are cut out to squares of so many pixels.
    device : str
        Where to compute.
    scored : int
        How many frames of val rooms are scored.
    """

    def __init__(self, roots: Sequence[Path], side: int, device: str = "cpu", scored: int = 200) -> None:
        self.types = detector_types()
        self.model = Detector(len(self.types))
        self.side, self.device = side, device
        rooms = learning_rooms(roots)
        self._places = []
        for root in roots:
            frames, ends = (Pictures(root, "train", which, self.types, rooms) for which in SEEN)
            self._places += [(frames, index) for index in range(0, len(frames), FRAMES_APART)]
            self._places += [(ends, index) for index in range(len(ends))] * END_TIMES
        val = Pictures(roots[0], "train", "rgb", self.types, rooms_of(roots[0], "val"))
        self._scored = [val[index] for index in range(0, len(val), max(1, len(val) // scored))]

    def __len__(self) -> int:
        return len(self._places)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> tuple[Tensor, Wanted]:
        """(n, 3, side, side) pictures, and what is true of them."""
        pictures, wanted = [], []
        for sample, rng in zip(samples, rngs, strict=True):
            source, index = self._places[sample]
            picture = varied(source[index], self.side, rng)
            pictures.append(torch.from_numpy(picture.rgb).permute(2, 0, 1))
            wanted.append(wanted_of(picture.instances, picture.types))
        return torch.stack(pictures), batch_of(wanted)

    def losses(self, batch: tuple[Tensor, Wanted]) -> Mapping[str, Tensor]:
        """See `detector_losses`."""
        rgb, wanted = batch
        moved = Wanted(**{name: value.to(self.device) for name, value in vars(wanted).items()})
        return detector_losses(self.model, self.model(rgb.to(self.device)), moved, rgb.shape[-2:])

    def score(self) -> Mapping[str, float]:
        """Losses on whole frames of val rooms, and the share of cells whose type is right."""
        sums: dict[str, Any] = {}
        for picture in self._scored:
            rgb = torch.from_numpy(picture.rgb).permute(2, 0, 1)[None].to(self.device)
            raw = self.model(rgb)
            wanted = batch_of([wanted_of(picture.instances, picture.types)])
            moved = Wanted(**{name: value.to(self.device) for name, value in vars(wanted).items()})
            found = dict(detector_losses(self.model, raw, moved, rgb.shape[-2:]))
            is_right = raw.cells.argmax(1) == moved.cells
            is_thing = moved.cells > 0
            found["cells_right"] = (is_right & is_thing).sum() / is_thing.sum().clamp(min=1)
            for name, value in found.items():
                sums[f"val_{name}"] = sums.get(f"val_{name}", 0.0) + float(value)
        return {name: value / max(1, len(self._scored)) for name, value in sums.items()}
