"""Learning to ground expressions in one stage, on what a trained detector makes of the pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import Detector, iou
from remqa_data.agents.networks.detection.detector_loss import box_loss
from remqa_data.agents.networks.grounding import (
    CELL_PX,
    CollaborativeGrounder,
    Grounder,
    GroupedGrounder,
    Said,
    Sight,
    clipped,
    grounded,
    sight_of,
)
from remqa_data.agents.training.matching import RIGHT_IOU, FrameExpressions, Progress, frames_with_expressions
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.errors import DatasetError
from remqa_data.geometry.types import F32
from remqa_data.storage.manifest import load_manifest
from remqa_data.tables.images import decode_depth, decode_instances, decode_rgb

INNER = 1 / 3
"""Cells in this share of a box, across and down, stand for its middle, and the nearest one in any case."""

AGREEMENT_WEIGHT = 0.1
LOOKING_WEIGHT = 0.5
"""Of MCN's agreement, and of where CGAN looks."""


GROUNDERS: Mapping[str, Callable[[int], Grounder]] = {
    "collaborative": CollaborativeGrounder,
    "grouped": GroupedGrounder,
}
AT_ONCE = 2
"""Expressions of a frame that are learnt from in an epoch."""


@dataclass(frozen=True, eq=False)
class SeenFrame:
    """A frame as the detector sees it, and expressions that are about it.

    Attributes
    ----------
    expression_ids, texts : tuple of str
    targets : (e, 4) float32
        Box of what each expression means, pixels.
    masks : (e, h', w') float16
        Share of each cell that shows it.
    sight : Sight
        Of one picture, in half precision.
    size : (int, int)
        Height and width of the frame.
    """

    expression_ids: tuple[str, ...]
    texts: tuple[str, ...]
    targets: F32
    masks: Tensor
    sight: Sight
    size: tuple[int, int]

    def of(self, places: np.ndarray) -> SeenFrame:
        """The same with some of its expressions."""
        ids, texts = (tuple(values[place] for place in places) for values in (self.expression_ids, self.texts))
        return SeenFrame(ids, texts, self.targets[places], self.masks[places], self.sight, self.size)


@dataclass(frozen=True, eq=False)
class AskedFrames:
    """A batch of frames, all of one size: see `SeenFrame`; `which` is the frame of each expression."""

    numbers: Tensor
    sight: Sight
    which: Tensor
    wanted: Targets
    size: tuple[int, int]


class GroundingTask:
    """A grounder learns from the expressions of the train split; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the first one's val expressions give the score.
    form : str
        Which network: a key of GROUNDERS.
    detector : Detector
        Trained.
    device : str
        Where to compute.
    progress : callable, optional
        Called with the number of pictures that were looked at since the last call, before training begins.

    Raises
    ------
    DatasetError
        If pictures of the datasets are not of one size.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        form: str,
        detector: Detector,
        device: str = "cpu",
        progress: Progress | None = None,
    ) -> None:
        _check_sizes(roots)
        detector = detector.to(device).eval()
        rooms = learning_rooms(roots)
        self._frames = [
            frame for root in roots for frame in seen_frames(root, "train", detector, device, rooms, progress)
        ]
        has_val = bool(rooms_of(roots[0], "val"))
        self._val = list(seen_frames(roots[0], "val", detector, device, None, progress)) if has_val else []
        self.vocabulary = Vocabulary.build((text for frame in self._frames for text in frame.texts), ())
        self.model = GROUNDERS[form](len(self.vocabulary.words))
        self.device = device

    def __len__(self) -> int:
        return len(self._frames)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> AskedFrames:
        """Frames with `AT_ONCE` of their expressions each."""
        drawn = [self._frames[sample] for sample in samples]
        some = [rng.permutation(len(frame.texts))[:AT_ONCE] for frame, rng in zip(drawn, rngs, strict=True)]
        return asked_frames(
            [frame.of(places) for frame, places in zip(drawn, some, strict=True)], self.vocabulary, self.device
        )

    def losses(self, batch: AskedFrames) -> Mapping[str, Tensor]:
        """See `grounding_losses`."""
        said = self.model(batch.numbers, batch.sight, batch.which)
        is_grouped = isinstance(self.model, GroupedGrounder)
        return grounding_losses(said, batch.wanted, batch.size, is_looking_taught=is_grouped)

    def score(self) -> Mapping[str, float]:
        """prec@0.5 of boxes on val expressions, and the mean IoU of masks of cells."""
        right, overlap, asked = 0, 0.0, 0
        for frame in self._val:
            made = asked_frames([frame], self.vocabulary, self.device)
            with torch.no_grad():
                found = grounded(self.model(made.numbers, made.sight, made.which), made.size)
            right += int(sum(iou(np.stack([one.box for one in found]), frame.targets).diagonal() >= RIGHT_IOU))
            wanted = (frame.masks >= 0.5).numpy()
            overlap += sum(
                (one.mask & true).sum() / max((one.mask | true).sum(), 1)
                for one, true in zip(found, wanted, strict=True)
            )
            asked += len(found)
        return {"val_right": right / asked, "val_mask_iou": float(overlap) / asked} if asked else {}


def _check_sizes(roots: Sequence[Path]) -> None:
    """Pictures in a batch are of one size; DatasetError if those of some datasets are not, before any is looked at."""
    sizes = {root: load_manifest(root).config.get("image", {}).get("size_px") for root in roots}
    for root, size in sizes.items():
        if size != sizes[roots[0]]:
            raise DatasetError(
                f"{root} has pictures of {size} pixels, {roots[0]} of {sizes[roots[0]]}; give datasets that are alike"
            )


def asked_frames(frames: Sequence[SeenFrame], vocabulary: Vocabulary, device: str = "cpu") -> AskedFrames:
    """Some frames as a batch."""
    texts = [text for frame in frames for text in frame.texts]
    counts = torch.tensor([len(frame.texts) for frame in frames])
    cells, boxes = (
        torch.cat(parts).float().to(device) for parts in zip(*(frame.sight for frame in frames), strict=True)
    )
    return AskedFrames(
        torch.from_numpy(vocabulary.encode_batch(texts)[0]).to(device),
        Sight(cells, boxes),
        torch.arange(len(frames)).repeat_interleave(counts).to(device),
        Targets(
            torch.from_numpy(np.concatenate([frame.targets for frame in frames])).to(device),
            torch.cat([frame.masks for frame in frames]).float().to(device),
        ),
        frames[0].size,
    )


def seen_frames(
    root: Path,
    split: str,
    detector: Detector,
    device: str,
    rooms: frozenset[str] | None = None,
    progress: Progress | None = None,
) -> Iterator[SeenFrame]:
    """The frames that expressions of a split are about, as the detector sees them; only those of some rooms, if given."""
    for frame in frames_with_expressions(root, split, rooms):
        yield _seen(frame, detector, device)
        if progress is not None:
            progress(1)


def _seen(frame: FrameExpressions, detector: Detector, device: str) -> SeenFrame:
    rgb, depth, instances = frame.reader.images(frame.place, ["rgb", "depth", "instances"])
    picture = torch.from_numpy(decode_rgb(rgb)).permute(2, 0, 1)[None].to(device)
    sight = sight_of(detector, picture, torch.from_numpy(decode_depth(depth))[None].to(device))
    shown, numbers = decode_instances(instances), {item["id"]: at for at, item in enumerate(frame.objects, 1)}
    masks = np.stack([shares_of(shown == numbers[row["target_id"]]) for row in frame.rows])
    return SeenFrame(
        tuple(row["expression_id"] for row in frame.rows),
        tuple(row["text"] for row in frame.rows),
        np.array([row["box_2d"] for row in frame.rows], dtype=np.float32),
        torch.from_numpy(masks).half(),
        Sight(*(part.half().cpu() for part in sight)),
        (picture.shape[2], picture.shape[3]),
    )


# ---- what is wanted, and how far what is said is from that


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
