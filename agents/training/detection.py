"""Learning to detect, on frames of walks and on views of what was opened: the detector, its second stage, and proposals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import ENLARGED, Detector, iou
from remqa_data.agents.networks.detection.detector_loss import (
    LEAST_PIXELS,
    Wanted,
    batch_of,
    box_loss,
    detector_losses,
    middle_losses,
    wanted_of,
)
from remqa_data.agents.networks.detection.proposer import Proposer
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.agents.networks.detection.refiner import (
    GRID,
    LEAST_VOTES,
    Refined,
    Refiner,
    TwoStageDetector,
    with_margin,
)
from remqa_data.agents.networks.detection.regions import candidates
from remqa_data.agents.training.pictures import UNKNOWN, Picture, Pictures, Which, detector_types, shown_in, varied
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.geometry.types import F32

SEEN: tuple[Which, Which] = ("rgb", "end_rgb")
"""What is learnt from: frames of walks, and what is seen when something is opened or moved."""

FRAMES_APART, END_TIMES = 2, 2
"""In an epoch every second frame of a walk is seen, as it is much like the next, and twice what each question is about."""

MOST_BOXES = 24
"""So many boxes of a picture are looked at again; half of them have an object, if there are so many."""

LIKE_IOU, FOUND_IOU = 0.4, 0.5
"""A box is of an object when they overlap so much: to learn from, and to be found."""

JITTER = 0.12
"""Standard deviation by which the sides of true boxes are moved, as a share of the box."""


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
        self._places = _places(roots, self.types)
        self._scored = _val_frames(roots[0], self.types, scored)

    def __len__(self) -> int:
        return len(self._places)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> tuple[Tensor, Wanted]:
        """(n, 3, side, side) pictures, and what is true of them."""
        parts = _parts(self._places, samples, self.side, rngs)
        return _colours(parts), batch_of([wanted_of(part.instances, part.types) for part in parts])

    def losses(self, batch: tuple[Tensor, Wanted]) -> Mapping[str, Tensor]:
        """See `detector_losses`."""
        rgb, wanted = batch
        return detector_losses(self.model, self.model(rgb.to(self.device)), wanted.on(self.device), rgb.shape[-2:])

    def score(self) -> Mapping[str, float]:
        """Losses on whole frames of val rooms, and the share of cells whose type is right."""
        sums: dict[str, Any] = {}
        for picture in self._scored:
            rgb = _colours([picture]).to(self.device)
            raw = self.model(rgb)
            wanted = batch_of([wanted_of(picture.instances, picture.types)]).on(self.device)
            found = dict(detector_losses(self.model, raw, wanted, rgb.shape[-2:]))
            is_right = raw.cells.argmax(1) == wanted.cells
            is_thing = wanted.cells > 0
            found["cells_right"] = (is_right & is_thing).sum() / is_thing.sum().clamp(min=1)
            for name, value in found.items():
                sums[f"val_{name}"] = sums.get(f"val_{name}", 0.0) + float(value)
        return {name: value / max(1, len(self._scored)) for name, value in sums.items()}


class RefinementTask:
    """The second stage learns where the first one, which stays as it is, sees objects; see `DetectionTask`.

    Parameters
    ----------
    detector : Detector
        Trained.
    """

    def __init__(
        self, roots: Sequence[Path], side: int, detector: Detector, device: str = "cpu", scored: int = 100
    ) -> None:
        self.types = detector_types()
        self.model = Refiner(len(self.types))
        self.model.backbone.load_state_dict(detector.backbone.state_dict())
        self.side, self.device = side, device
        self._first = detector.to(device).eval()
        self._places = _places(roots, self.types)
        self._scored = _val_frames(roots[0], self.types, scored)

    def __len__(self) -> int:
        return len(self._places)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> Proposed:
        """Parts of pictures, and boxes in them that the first stage has seen, or that are nearly right."""
        parts = _parts(self._places, samples, self.side, rngs)
        rgb = _colours(parts).to(self.device)
        voted = self._first.vote(rgb, LEAST_VOTES)
        proposed = [propose(part, peaks.boxes, rng) for part, peaks, rng in zip(parts, voted.peaks, rngs, strict=True)]
        images = np.repeat(np.arange(len(proposed)), [len(one.boxes) for one in proposed])
        boxes, true, kinds, shapes = (
            torch.from_numpy(np.concatenate(arrays)).to(self.device) for arrays in zip(*proposed, strict=True)
        )
        return Proposed(rgb, torch.from_numpy(images).to(self.device), boxes, true, kinds, shapes)

    def losses(self, batch: Proposed) -> Mapping[str, Tensor]:
        """How far boxes, kinds and shapes are from what is true; "right" is the share of objects whose kind is."""
        features = self.model.see(batch.rgb).float()
        said = Refined(*(part.float() for part in self.model(batch.rgb, features, batch.boxes, batch.images)))
        is_object = batch.kinds > 0
        count = is_object.sum().clamp(min=1)
        losses = {
            "kinds": functional.cross_entropy(said.kinds, batch.kinds),
            "boxes": box_loss(said.boxes, batch.true)[is_object].sum() / count,
            "shapes": functional.binary_cross_entropy_with_logits(
                said.shapes[is_object], batch.shapes[is_object], reduction="sum"
            )
            / (count * GRID**2),
        }
        right = ((said.kinds.argmax(1) == batch.kinds) & is_object).sum() / count
        return {"loss": sum(losses.values(), torch.zeros(())), **losses, "right": right}

    def score(self) -> Mapping[str, float]:
        """See `_found_and_known`."""
        return _found_and_known(TwoStageDetector(self._first, self.model), self._scored, self.device)


class ProposalTask:
    """Proposing boxes is learnt by the features of the second stage, which stays as it is; see `DetectionTask`.

    Parameters
    ----------
    first, second
        Trained.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        side: int,
        first: Detector,
        second: Refiner,
        device: str = "cpu",
        scored: int = 100,
    ) -> None:
        self.types = detector_types()
        self.model = Proposer()
        self.side, self.device = side, device
        self._first, self._second = first.to(device).eval(), second.to(device).eval()
        self._places = _places(roots, self.types)
        self._scored = _val_frames(roots[0], self.types, scored)

    def __len__(self) -> int:
        return len(self._places)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> tuple[Tensor, Wanted]:
        """(n, 3, side, side) pictures, and what is true of them when they are enlarged."""
        parts = _parts(self._places, samples, self.side, rngs)
        return _colours(parts), batch_of([wanted_of(_enlarged(part.instances), part.types) for part in parts])

    def losses(self, batch: tuple[Tensor, Wanted]) -> Mapping[str, Tensor]:
        """See `middle_losses`; "loss" is the sum."""
        rgb, wanted = batch
        with torch.no_grad():
            features = self._second.see(rgb.to(self.device))
        said = self.model(features)
        size = tuple(side * STRIDE for side in features.shape[-2:])
        losses = middle_losses(said.middles, said.sides, wanted.on(self.device), size)
        return {"loss": sum(losses.values(), torch.zeros(())), **losses}

    def score(self) -> Mapping[str, float]:
        """See `_found_and_known`."""
        return _found_and_known(TwoStageDetector(self._first, self._second, self.model), self._scored, self.device)


class Proposed(NamedTuple):
    """Boxes in pictures, and what is true of them.

    Attributes
    ----------
    rgb : (n, 3, side, side) uint8
    images : (m,) int64
        Which picture each box is in.
    boxes, true : (m, 4) float32
        In pixels; as proposed, and of the object that is meant.
    kinds : (m,) int64
        Index of its type + 1; 0 where no object is.
    shapes : (m, GRID, GRID) float32
        1 where the box with its margin shows the object.
    """

    rgb: Tensor
    images: Tensor
    boxes: Tensor
    true: Tensor
    kinds: Tensor
    shapes: Tensor


class Objects(NamedTuple):
    """What is to be found in a picture: (m,) numbers in its instances, (m, 4) boxes in pixels, (m,) types."""

    numbers: np.ndarray
    boxes: F32
    types: np.ndarray


class Proposals(NamedTuple):
    """The same as in `Proposed`, of one picture, as arrays."""

    boxes: F32
    true: F32
    kinds: np.ndarray
    shapes: F32


def objects_of(picture: Picture) -> Objects:
    """The objects of known types of which enough is seen."""
    pixels, boxes = shown_in(picture.instances, len(picture.types))
    places = np.flatnonzero((picture.types != UNKNOWN) & (pixels >= LEAST_PIXELS))
    return Objects(places + 1, boxes[places], picture.types[places])


def propose(picture: Picture, seen: F32, rng: np.random.Generator) -> Proposals:
    """Boxes to learn from: of those that are seen, (k, 4), and of the true ones, moved a little; objects and none alike."""
    objects = objects_of(picture)
    sizes = np.tile(objects.boxes[:, 2:] - objects.boxes[:, :2], 2)
    near = objects.boxes + (rng.normal(0, JITTER, sizes.shape) * sizes).astype(np.float32)
    boxes = np.concatenate([seen, near])
    boxes = boxes[(boxes[:, 2:] - boxes[:, :2]).min(axis=1, initial=np.inf) >= 1]
    overlaps = iou(boxes, objects.boxes)
    is_object = overlaps.max(1, initial=0.0) >= LIKE_IOU
    order = rng.permutation(len(boxes))
    good, bad = order[is_object[order]][: MOST_BOXES // 2], order[~is_object[order]]
    chosen = np.concatenate([good, bad[: MOST_BOXES - len(good)]])
    boxes, is_object = boxes[chosen], is_object[chosen]
    if not len(objects.boxes):
        blank = np.zeros((len(boxes), GRID, GRID), dtype=np.float32)
        return Proposals(boxes, boxes, np.zeros(len(boxes), dtype=np.int64), blank)
    best = overlaps[chosen].argmax(1)
    kinds = np.where(is_object, objects.types[best] + 1, 0)
    return Proposals(boxes, objects.boxes[best], kinds, _shapes(picture.instances, boxes, objects.numbers[best]))


def _shapes(instances: np.ndarray, boxes: F32, numbers: np.ndarray) -> F32:
    """(m, GRID, GRID) 1 where boxes with their margin show the object of a number."""
    seen = with_margin(torch.from_numpy(boxes)).numpy()
    steps = (np.arange(GRID) + 0.5) / GRID
    columns, rows = (seen[:, axis, None] + steps * (seen[:, axis + 2] - seen[:, axis])[:, None] for axis in (0, 1))
    height, width = instances.shape
    is_in = ((rows >= 0) & (rows < height))[:, :, None] & ((columns >= 0) & (columns < width))[:, None, :]
    down, across = (np.clip(at.astype(int), 0, most - 1) for at, most in ((rows, height), (columns, width)))
    shown = instances[down[:, :, None], across[:, None, :]]
    return np.asarray((shown == numbers[:, None, None]) & is_in, dtype=np.float32)


def _found_and_known(detector: TwoStageDetector, pictures: Sequence[Picture], device: str) -> dict[str, float]:
    """Shares of the objects in frames of val rooms: found with half of their box, and known for what they are."""
    asked, found, known = 0, 0, 0
    for picture in pictures:
        (seen,) = detector.detect(_colours([picture]).to(device))
        true = objects_of(picture)
        chosen = candidates(seen)
        fits = iou(true.boxes, seen.boxes[chosen]) >= FOUND_IOU
        asked += len(true.boxes)
        found += int(fits.any(1).sum())
        known += int((fits & (true.types[:, None] == seen.types[chosen])).any(1).sum())
    return {"val_found": found / max(asked, 1), "val_known": known / max(asked, 1)}


def _enlarged(instances: np.ndarray) -> np.ndarray:
    """(h, w) numbers of objects, ENLARGED times as wide and high."""
    height, width = (round(side * ENLARGED) for side in instances.shape)
    larger = cv2.resize(instances.astype(np.float32), (width, height), interpolation=cv2.INTER_NEAREST)
    return larger.astype(np.int32)


def _parts(
    places: Sequence[tuple[Pictures, int]], samples: np.ndarray, side: int, rngs: Sequence[np.random.Generator]
) -> list[Picture]:
    """Parts of the pictures at some places, of so many pixels a side, varied."""
    chosen = (places[sample] for sample in samples)
    return [varied(source[index], side, rng) for (source, index), rng in zip(chosen, rngs, strict=True)]


def _colours(pictures: Sequence[Picture]) -> Tensor:
    """(n, 3, h, w) uint8."""
    return torch.stack([torch.from_numpy(picture.rgb).permute(2, 0, 1) for picture in pictures])


def _places(roots: Sequence[Path], types: Sequence[str]) -> list[tuple[Pictures, int]]:
    """The pictures of an epoch, of all rooms to learn from."""
    rooms, places = learning_rooms(roots), []
    for root in roots:
        frames, ends = (Pictures(root, "train", which, types, rooms) for which in SEEN)
        places += [(frames, index) for index in range(0, len(frames), FRAMES_APART)]
        places += [(ends, index) for index in range(len(ends))] * END_TIMES
    return places


def _val_frames(root: Path, types: Sequence[str], count: int) -> list[Picture]:
    """About so many frames of val rooms."""
    val = Pictures(root, "train", "rgb", types, rooms_of(root, "val"))
    return [val[index] for index in range(0, len(val), max(1, len(val) // count))]
