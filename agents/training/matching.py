"""Learning to refer: a matcher on expressions, over the regions that a trained detector sees."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.box_head import Fit
from remqa_data.agents.networks.detection.detector import iou
from remqa_data.agents.networks.detection.detector_loss import LEAST_PIXELS, box_loss
from remqa_data.agents.networks.detection.regions import AnyDetector, Regions, candidates, regions_of
from remqa_data.agents.networks.matcher import (
    AnchoredMatcher,
    LanguageAttentionMatcher,
    Match,
    Matcher,
    PlainMatcher,
    ranking_loss,
)
from remqa_data.agents.training.config import MatcherConfig
from remqa_data.agents.training.pictures import shown_in
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.datasets.random_access import SplitReader
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.geometry.types import F32, Flags
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.tables.images import decode_depth, decode_instances, decode_rgb

RIGHT_IOU = 0.5

MOVED_IOU = 0.3
"""Boxes that overlap an object so much are to be moved to it."""

Progress = Callable[[int], None]
Shown = Callable[[Path, str, frozenset[str] | None], Iterable["FrameExpressions"]]

IMAGES, START_IMAGES = ("rgb", "depth"), ("start_rgb", "start_depth")
"""Columns of frames of walks, and of questions."""

MATCHERS: Mapping[str, Callable[[int, int, bool, bool], Matcher]] = {
    "language_attention": LanguageAttentionMatcher,
    "anchored": AnchoredMatcher,
    "plain": PlainMatcher,
}


@dataclass(frozen=True, eq=False)
class Referred:
    """A picture, and expressions that are about it.

    Attributes
    ----------
    expression_ids, texts : tuple of str
    targets : (e, 4) float32
        Box of what each expression means, pixels.
    found, true : Regions
        What the detector found, and the objects that are there.
    right_true : (e,) int64
        Which of those that are there each expression means.
    """

    expression_ids: tuple[str, ...]
    texts: tuple[str, ...]
    targets: F32
    found: Regions
    true: Regions
    right_true: np.ndarray


class Looks:
    """What a detector sees in the pictures that expressions are about; each is looked at once for all who learn from it.

    Parameters
    ----------
    detector : AnyDetector
        Trained.
    device : str
        Where to compute.
    """

    def __init__(self, detector: AnyDetector, device: str = "cpu") -> None:
        self.detector, self.device = detector.to(device).eval(), device
        self._seen: dict[tuple[Shown, Path, str, frozenset[str] | None], list[Referred]] = {}

    def at(
        self, shown: Shown, root: Path, split: str, rooms: frozenset[str] | None, progress: Progress | None = None
    ) -> list[Referred]:
        """What `frames_with_expressions` or `views_with_expressions` shows of a split; only of some rooms, if given."""
        key = shown, root, split, rooms
        if key not in self._seen:
            self._seen[key] = referred_pictures(shown(root, split, rooms), self.detector, self.device, progress)
        return self._seen[key]


class Choices(NamedTuple):
    """The expressions of a picture, and what each may mean.

    Attributes
    ----------
    numbers : (e, t) int64
        Words.
    regions : Regions
        m objects, which are there or were found.
    picture : Referred
        Of which they are.
    """

    numbers: Tensor
    regions: Regions
    picture: Referred


class MatchingTask:
    """A matcher learns from the expressions of the train split; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the first one's val expressions give the score.
    network : MatcherConfig
        Which matcher, and what it learns from.
    looks : Looks
        Through what it sees, and where it computes.
    progress : callable, optional
        Called with the number of pictures that were looked at since the last call, before training begins.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        network: MatcherConfig,
        looks: Looks,
        progress: Progress | None = None,
    ) -> None:
        rooms = learning_rooms(roots)
        shown = [looks.at(frames_with_expressions, root, "train", rooms, progress) for root in roots]
        if network.questions:
            shown += [looks.at(views_with_expressions, root, "train", rooms, progress) for root in roots]
        self._pictures = list(chain.from_iterable(shown))
        has_val = rooms_of(roots[0], "val")
        self._val = looks.at(frames_with_expressions, roots[0], "val", None, progress) if has_val else []
        self.vocabulary = Vocabulary.build((text for picture in self._pictures for text in picture.texts), ())
        self.model = empty_matcher(network, len(self.vocabulary.words), looks.detector.types)
        self.device, self.spared_iou = looks.device, network.spared_iou

    def __len__(self) -> int:
        return len(self._pictures)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> list[Choices]:
        """Of each picture the words of its expressions, and regions, found or true by chance."""
        made = []
        for sample, rng in zip(samples, rngs, strict=True):
            picture = self._pictures[sample]
            is_true = rng.random() < 0.5 or not len(picture.found.boxes)
            made.append(Choices(self._numbers(picture.texts), picture.true if is_true else picture.found, picture))
        return made

    def losses(self, batch: list[Choices]) -> Mapping[str, Tensor]:
        """The ranking loss, a mean over expressions whose object is among the regions; that of a box head, over pictures."""
        ranking = fitting = torch.zeros((), device=self.device)
        hits, asked = 0, 0
        for (numbers, regions, picture), fit in zip(batch, self._fits(batch), strict=True):
            match: Match = self.model.match(numbers, regions)
            if fit is not None:
                fitting = fitting + fitting_loss(fit, picture.found.boxes, picture.true.boxes) / len(batch)
                if not regions.are_known:
                    match = match.judged(fit)
            right, spared = rights_of(picture, regions, match.boxes_of(regions), self.spared_iou)
            for e in np.flatnonzero(right >= 0).tolist():
                scores = match.scores[e]
                wrong = torch.cat([scores[~spared[e]], match.scores[~spared[:, right[e]], right[e]]])
                ranking = ranking + ranking_loss(scores[right[e]], wrong)
                hits += int(scores.argmax()) == int(right[e])
                asked += 1
        if not asked:  # no object that is meant is among the regions: there is nothing to learn, but a way back
            ranking = 0 * match.scores.sum()
        losses = {"ranking": ranking / max(asked, 1), "fitting": fitting}
        return {"loss": losses["ranking"] + losses["fitting"], **losses, "right": torch.tensor(hits / max(asked, 1))}

    def score(self) -> Mapping[str, float]:
        """prec@0.5 on val expressions, with detected and with true boxes, and the share of targets that are detected."""
        found = {"detected": 0, "true": 0, "recall": 0}
        asked = 0
        for picture in self._val:
            asked += len(picture.texts)
            for name, regions in (("detected", picture.found), ("true", picture.true)):
                if not len(regions.boxes):
                    continue
                match: Match = self.model(self._numbers(picture.texts), regions)
                is_right = iou(picture.targets, match.meant_in(regions)).diagonal() >= RIGHT_IOU
                found[name] += int(is_right.sum())
                if name == "detected":
                    nearest = iou(picture.targets, match.boxes_of(regions)).max(1)
                    found["recall"] += int((nearest >= RIGHT_IOU).sum())
        return {f"val_{name}": count / asked for name, count in found.items()} if asked else {}

    def _fits(self, batch: list[Choices]) -> Sequence[Fit | None]:
        """What the box head says of what was found in each picture, whether or not that is chosen among."""
        found = [choices.picture.found for choices in batch]
        if self.model.box_head is None or sum(len(regions.boxes) for regions in found) < 2:  # too few to norm
            return [None] * len(batch)
        return self.model.box_head(found)  # type: ignore[no-any-return]

    def _numbers(self, texts: Sequence[str]) -> Tensor:
        return torch.from_numpy(self.vocabulary.encode_batch(texts)[0]).to(self.device)


def empty_matcher(network: MatcherConfig, words: int, types: int) -> Matcher:
    """One that knows nothing yet, for so many words and types."""
    return MATCHERS[network.form](words, types, network.box_head, network.colors)


def rights_of(
    picture: Referred, regions: Regions, boxes: F32, spared_iou: float | None
) -> tuple[npt.NDArray[np.int64], Flags]:
    """(e,) which region each expression of a picture means, -1 for none of them, and (e, m) which are no wrong choice.

    Of what was found it is the one with the best of (m, 4) boxes. Where those that overlap what is meant by `spared_iou` are
    spared, they are no wrong choice either.
    """
    if regions.are_known:
        return picture.right_true, picture.right_true[:, None] == np.arange(len(boxes))
    overlaps = iou(picture.targets, boxes)
    right = np.where(overlaps.max(1) >= RIGHT_IOU, overlaps.argmax(1), -1)
    spared = right[:, None] == np.arange(len(boxes))
    return right, spared if spared_iou is None else spared | (overlaps >= spared_iou)


def fitting_loss(fit: Fit, boxes: F32, objects: F32) -> Tensor:
    """How far what is said of (m, 4) boxes, which were found, is from (k, 4) objects.

    Those near an object are to be moved to it; the quality of each is the IoU with the nearest when it has been moved.
    """
    if not len(boxes):
        return fit.quality.sum()
    overlaps = iou(boxes, objects)
    is_near = torch.from_numpy(overlaps.max(1, initial=0.0) >= MOVED_IOU).to(fit.boxes.device)
    if not is_near.any():
        return functional.binary_cross_entropy_with_logits(fit.quality, torch.zeros_like(fit.quality))
    best = overlaps.argmax(1)
    moved = iou(fit.boxes.numpy(force=True), objects)[range(len(best)), best]
    quality = functional.binary_cross_entropy_with_logits(fit.quality, torch.from_numpy(moved).to(fit.quality))
    return quality + box_loss(fit.boxes, torch.from_numpy(objects[best]).to(fit.boxes))[is_near].mean()


class FrameExpressions(NamedTuple):
    """A frame, and the expressions that are about it.

    Attributes
    ----------
    reader : SplitReader
        Of its table.
    place : int
        Its row there.
    images : tuple of str
        Columns of its colours and its depth.
    objects : list of dict
        What it shows: `id`, `pixels` and `box_2d`.
    horizon_deg : float
        How far down its camera looks.
    rows : list of dict
        The expressions: `expression_id`, `text`, `target_id`, `box_2d`.
    """

    reader: SplitReader
    place: int
    images: tuple[str, str]
    objects: list[dict[str, Any]]
    horizon_deg: float
    rows: list[dict[str, Any]]


def frames_with_expressions(root: Path, split: str, rooms: frozenset[str] | None = None) -> Iterator[FrameExpressions]:
    """The frames that expressions of a split are about; only those of some rooms, if given."""
    columns = ["expression_id", "scene", "frame_id", "text", "target_id", "box_2d"]
    by_frame: dict[str, list[dict[str, Any]]] = {}
    for row in read_table(root, "expressions", split, columns).to_pylist():
        if rooms is None or row["scene"] in rooms:
            by_frame.setdefault(row["frame_id"], []).append(row)
    for frames_split in load_manifest(root).splits("frames"):
        reader = SplitReader(root, "frames", frames_split)
        table = reader.columns(["frame_id", "objects", "agent"])
        for place, frame_id in enumerate(table["frame_id"].to_pylist()):
            if frame_id in by_frame:
                objects, agent = (table[name][place].as_py() for name in ("objects", "agent"))
                yield FrameExpressions(reader, place, IMAGES, objects, agent["horizon_deg"], by_frame[frame_id])


def views_with_expressions(root: Path, split: str, rooms: frozenset[str] | None = None) -> Iterator[FrameExpressions]:
    """The views before the manipulation of a split's questions, with what these say of the target; see above."""
    reader = SplitReader(root, "questions", split)
    names = ("question_id", "scene", "expression", "target_id", "start_target_box_2d", "goal_poses", "object_ids")
    for place, row in enumerate(reader.columns(names).to_pylist()):
        if rooms is not None and row["scene"] not in rooms:
            continue
        (stored,) = reader.images(place, ["start_instances"])
        ids = row["object_ids"]
        pixels, boxes = shown_in(decode_instances(stored).astype(np.int32), len(ids))
        objects = [
            {"id": ids[number], "pixels": int(pixels[number]), "box_2d": boxes[number].tolist()}
            for number in np.flatnonzero(pixels).tolist()
        ]
        said = {
            "expression_id": row["question_id"],
            "text": row["expression"],
            "target_id": row["target_id"],
            "box_2d": row["start_target_box_2d"],
        }
        yield FrameExpressions(reader, place, START_IMAGES, objects, row["goal_poses"][0]["horizon_deg"], [said])


@torch.no_grad()
def referred_pictures(
    frames: Iterable[FrameExpressions],
    detector: AnyDetector,
    device: str,
    progress: Progress | None = None,
) -> list[Referred]:
    """The pictures that expressions are about, as the detector sees them."""
    pictures = []
    for frame in frames:
        pictures.append(referred(frame, detector, device))
        if progress is not None:
            progress(1)
    return pictures


def referred(frame: FrameExpressions, detector: AnyDetector, device: str) -> Referred:
    """A frame as the detector sees it."""
    rgb, depth = frame.reader.images(frame.place, frame.images)
    rows, objects = frame.rows, frame.objects
    picture = torch.from_numpy(decode_rgb(rgb)).permute(2, 0, 1)[None].to(device)
    seen, (found,) = detector.look(picture)
    metres = decode_depth(depth)
    places = candidates(found, detector.candidates)
    boxes = found.boxes[places]
    asked = {row["target_id"] for row in rows}
    shown = [item for item in objects if item["pixels"] >= LEAST_PIXELS or item["id"] in asked]
    true = np.array([item["box_2d"] for item in shown], dtype=np.float32)
    targets = np.array([row["box_2d"] for row in rows], dtype=np.float32)
    numbers = {item["id"]: number for number, item in enumerate(shown)}
    return Referred(
        tuple(row["expression_id"] for row in rows),
        tuple(row["text"] for row in rows),
        targets,
        regions_of(detector, seen, boxes, metres, frame.horizon_deg, found.scores[places]),
        regions_of(detector, seen, true, metres, frame.horizon_deg),
        np.array([numbers[row["target_id"]] for row in rows]),
    )
