"""Learning to detect, on frames of walks and on views of what was opened: the detector, and its second stage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import ENLARGED, MOST_PEAKS, Detector, iou
from remqa_data.agents.networks.detection.detector_loss import (
    LEAST_PIXELS,
    Wanted,
    batch_of,
    box_loss,
    detector_losses,
    middle_losses,
    wanted_of,
)
from remqa_data.agents.networks.detection.proposer import likeliest_boxes
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.agents.networks.detection.refiner import GRID, Refined, Refiner, TwoStageDetector, with_margin
from remqa_data.agents.networks.detection.regions import candidates
from remqa_data.agents.training.pictures import UNKNOWN, Picture, Pictures, Which, detector_types, shown_in, varied
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.geometry.types import F32
from remqa_data.opencv import cv2

SEEN: tuple[Which, Which] = ("rgb", "end_rgb")
"""What is learnt from: frames of walks, and what is seen when something is opened or moved."""

FRAMES_APART, END_TIMES = 2, 2
"""In an epoch every second frame of a walk is seen, as it is much like the next, and twice what each question is about."""

MOST_BOXES = 32
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
    """The second stage learns to propose boxes, and what they show; see `DetectionTask`.

    Parameters
    ----------
    detector : Detector
        Trained; it stays as it is, and the second stage begins with its backbone.
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

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> Shown:
        """Parts of pictures with what is true of them."""
        return shown_of(_parts(self._places, samples, self.side, rngs), rngs)

    def losses(self, batch: Shown) -> Mapping[str, Tensor]:
        """See `refiner_losses`."""
        return refiner_losses(self.model, batch.on(self.device))

    def score(self) -> Mapping[str, float]:
        """Shares of the objects in frames of val rooms: found with half of their box, and known for what they are."""
        asked, found, known = 0, 0, 0
        detector = TwoStageDetector(self._first, self.model)
        for picture in self._scored:
            (seen,) = detector.detect(_colours([picture]).to(self.device))
            true = objects_of(picture)
            chosen = candidates(seen, detector.candidates)
            fits = iou(true.boxes, seen.boxes[chosen]) >= FOUND_IOU
            asked += len(true.boxes)
            found += int(fits.any(1).sum())
            known += int((fits & (true.types[:, None] == seen.types[chosen])).any(1).sum())
        return {"val_found": found / asked, "val_known": known / asked} if asked else {}


class Objects(NamedTuple):
    """What is to be found in a picture: (m,) numbers in its instances, (m, 4) boxes in pixels, (m,) types."""

    numbers: np.ndarray
    boxes: F32
    types: np.ndarray


class Shown(NamedTuple):
    """n parts of pictures, each with at most m objects, and what is drawn for them.

    Attributes
    ----------
    rgb : (n, 3, side, side) uint8
    wanted : Wanted
        What is true of the parts when they are enlarged.
    instances : (n, side, side) int32
        0, or the number of an object, from 1.
    boxes : (n, m, 4) float32
        Of the objects, pixels.
    kinds : (n, m) int64
        Index of its type + 1; 0 where there are fewer.
    numbers : (n, m) int32
        Of the objects in `instances`.
    shifts : (n, m, 4) float32
        By how much true boxes are moved to learn from, as shares of their sizes.
    lots : (n, MOST_PEAKS + m) float32
        Which boxes are learnt from: those that draw the lowest.
    """

    rgb: Tensor
    wanted: Wanted
    instances: Tensor
    boxes: Tensor
    kinds: Tensor
    numbers: Tensor
    shifts: Tensor
    lots: Tensor

    def on(self, device: str) -> Shown:
        """The same elsewhere."""
        rgb, wanted, *others = self
        return Shown(rgb.to(device), wanted.on(device), *(part.to(device) for part in others))


class Asked(NamedTuple):
    """k boxes in each of n pictures, and what is true of them.

    Attributes
    ----------
    boxes, true : (n, k, 4) float32
        In pixels; as proposed, and of the object that is meant.
    kinds : (n, k) int64
        Index of its type + 1; 0 where no object is.
    shapes : (n, k, GRID, GRID) float32
        1 where the box with its margin shows the object.
    """

    boxes: Tensor
    true: Tensor
    kinds: Tensor
    shapes: Tensor


def objects_of(picture: Picture) -> Objects:
    """The objects of known types of which enough is seen."""
    pixels, boxes = shown_in(picture.instances, len(picture.types))
    places = np.flatnonzero((picture.types != UNKNOWN) & (pixels >= LEAST_PIXELS))
    return Objects(places + 1, boxes[places], picture.types[places])


def shown_of(parts: Sequence[Picture], rngs: Sequence[np.random.Generator]) -> Shown:
    """Some parts of pictures as a batch."""
    objects = [objects_of(part) for part in parts]
    most = max(1, *(len(one.numbers) for one in objects))

    def padded(arrays: Sequence[np.ndarray]) -> Tensor:
        return torch.from_numpy(np.stack([np.pad(a, ((0, most - len(a)), *[(0, 0)] * (a.ndim - 1))) for a in arrays]))

    return Shown(
        _colours(parts),
        batch_of([wanted_of(_enlarged(part.instances), part.types) for part in parts]),
        torch.from_numpy(np.stack([part.instances for part in parts])),
        padded([one.boxes for one in objects]),
        padded([one.types + 1 for one in objects]),
        padded([one.numbers.astype(np.int32) for one in objects]),
        padded(
            [rng.normal(0, JITTER, one.boxes.shape).astype(np.float32) for one, rng in zip(objects, rngs, strict=True)]
        ),
        torch.from_numpy(np.stack([rng.random(MOST_PEAKS + most, dtype=np.float32) for rng in rngs])),
    )


def refiner_losses(refiner: Refiner, shown: Shown) -> dict[str, Tensor]:
    """How far proposals are from the truth, and sides, kinds and shapes of boxes; "loss" is the sum.

    "right" is the share of boxes of objects whose kind is right.
    """
    features = refiner.see(shown.rgb).float()
    said = refiner.proposer(features)
    size = tuple(side * STRIDE for side in features.shape[-2:])
    proposing = middle_losses(said.middles, said.sides, shown.wanted, size)
    asked = asked_again(likeliest_boxes(said)[1].detach(), shown)
    again = Refined(*(part.float() for part in refiner(shown.rgb, features, asked.boxes)))
    true, kinds, shapes = (part.flatten(0, 1) for part in (asked.true, asked.kinds, asked.shapes))
    is_object = kinds > 0
    count = is_object.sum().clamp(min=1)
    shape = functional.binary_cross_entropy_with_logits(again.shapes, shapes, reduction="none").mean((1, 2))
    losses = {
        "proposed_middles": proposing["middles"],
        "proposed_boxes": proposing["boxes"],
        "kinds": functional.cross_entropy(again.kinds, kinds),
        "boxes": (box_loss(again.boxes, true) * is_object).sum() / count,
        "shapes": (shape * is_object).sum() / count,
    }
    right = ((again.kinds.argmax(1) == kinds) & is_object).sum() / count
    return {"loss": torch.stack(list(losses.values())).sum(), **losses, "right": right}


def asked_again(proposed: Tensor, shown: Shown) -> Asked:
    """Boxes to learn from: of (n, p, 4) that are proposed, and of the true ones, moved a little; objects and none alike."""
    near = shown.boxes + shown.shifts * (shown.boxes[..., 2:] - shown.boxes[..., :2]).repeat(1, 1, 2)
    boxes = torch.cat([proposed, near], 1)
    is_there = shown.kinds > 0
    overlaps, which = (overlaps_of(boxes, shown.boxes) * is_there[:, None]).max(2)
    is_object = overlaps >= LIKE_IOU
    lots = shown.lots[:, : boxes.shape[1]] + (~is_object).float()
    lots[:, proposed.shape[1] :] += 4 * (~is_there).float()
    order = lots.argsort(1)
    half = torch.arange(boxes.shape[1], device=boxes.device) >= MOST_BOXES // 2
    is_too_many = is_object.gather(1, order) & half
    chosen = order.gather(1, (lots.gather(1, order) + 2 * is_too_many.float()).argsort(1))[:, :MOST_BOXES]
    boxes, which = boxes.gather(1, _fours(chosen)), which.gather(1, chosen)
    kinds = torch.where(is_object.gather(1, chosen), shown.kinds.gather(1, which), 0)
    numbers = torch.where(kinds > 0, shown.numbers.gather(1, which), UNKNOWN)
    shapes = _shapes(shown.instances, boxes, numbers)
    return Asked(boxes, shown.boxes.gather(1, _fours(which)), kinds, shapes)


def overlaps_of(first: Tensor, second: Tensor) -> Tensor:
    """(n, p, m) IoU of (n, p, 4) and (n, m, 4) boxes of n pictures."""
    low = torch.maximum(first[:, :, None, :2], second[:, None, :, :2])
    high = torch.minimum(first[:, :, None, 2:], second[:, None, :, 2:])
    common = (high - low).clamp(min=0).prod(3)
    areas = [(boxes[..., 2:] - boxes[..., :2]).clamp(min=0).prod(2) for boxes in (first, second)]
    return common / (areas[0][:, :, None] + areas[1][:, None] - common).clamp(min=1e-6)


def _fours(places: Tensor) -> Tensor:
    """(n, k, 4) places of the sides of boxes, by (n, k) places of boxes."""
    return places[..., None].expand(-1, -1, 4)


def _shapes(instances: Tensor, boxes: Tensor, numbers: Tensor) -> Tensor:
    """(n, k, GRID, GRID) 1 where (n, k, 4) boxes with their margin show the object of (n, k) numbers."""
    seen = with_margin(boxes.flatten(0, 1)).view_as(boxes)
    steps = (torch.arange(GRID, device=boxes.device) + 0.5) / GRID
    places, is_in = [], []
    for axis, length in enumerate(reversed(instances.shape[1:])):
        low, high = seen[..., axis, None], seen[..., axis + 2, None]
        at = low + steps * (high - low)
        is_in.append((at >= 0) & (at < length))
        places.append(at.long().clamp(0, length - 1))
    columns, rows = places
    images = torch.arange(len(boxes), device=boxes.device)[:, None, None, None]
    is_shown = instances[images, rows[..., None], columns[:, :, None]] == numbers[..., None, None]
    return (is_shown & is_in[1][..., None] & is_in[0][:, :, None]).float()


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
