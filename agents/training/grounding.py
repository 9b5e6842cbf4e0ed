"""Learning to ground expressions in one stage, on what a trained detector makes of the pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from remqa_data.agents.networks.detector import Detector, iou
from remqa_data.agents.networks.grounding import (
    CollaborativeGrounder,
    Grounder,
    GroupedGrounder,
    Sight,
    grounded,
    sight_of,
)
from remqa_data.agents.training.grounding_loss import Targets, grounding_losses, shares_of
from remqa_data.agents.training.matching import RIGHT_IOU, FrameExpressions, frames_with_expressions
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.geometry.types import F32
from remqa_data.tables.images import decode_depth, decode_instances, decode_rgb

GROUNDERS: Mapping[str, Callable[[int], Grounder]] = {
    "collaborative": CollaborativeGrounder,
    "grouped": GroupedGrounder,
}
AT_ONCE = 2
"""Expressions of a frame that are learnt from in an epoch."""

Progress = Callable[[int], None]


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
    """

    def __init__(
        self,
        roots: Sequence[Path],
        form: str,
        detector: Detector,
        device: str = "cpu",
        progress: Progress | None = None,
    ) -> None:
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
        return {"val_right": right / max(asked, 1), "val_mask_iou": float(overlap) / max(asked, 1)}


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
