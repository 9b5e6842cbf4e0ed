"""Learning to answer: from the views before and after the manipulation, around the target.

Beside the answer, the answerer learns what each cell shows, where what is asked for is, and how often. And it is asked more
than the dataset asks: of each view after a manipulation it is also asked for other things that are there now, or that could be.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.answerer import VIEWS, Answered, ManipulationAnswerer, View, likeliest
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.detector_loss import heat_loss, wanted_of
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.agents.networks.windows import SIDE_PX, cut, window
from remqa_data.agents.training.pictures import detector_types, relit
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.catalog import object_type, plural, with_article
from remqa_data.datasets.random_access import SplitReader
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.tables.images import decode_instances, decode_rgb
from remqa_data.tables.rows import KINDS

EVIDENCE_PX = 30
"""What shows so many pixels after the manipulation and none before has come to light."""

ASKED_AGAIN = 0.5
"""Share of the questions in which another thing is asked for."""

MOST_COUNTED = 0.6
"""Share of the things asked to be counted that are the most numerous in view: few views show two or three alike."""

COLUMNS = (
    "question",
    "answer",
    "kind",
    "scene",
    "room_type",
    "answer_type",
    "answer_ids",
    "object_ids",
    "start_target_box_2d",
    "program",
)
IMAGES = ("start_rgb", "end_rgb", "start_instances", "end_instances")
MASK_WEIGHT, CELL_WEIGHT, TYPE_WEIGHT, MIDDLE_WEIGHT, COUNT_WEIGHT = 1.0, 1.0, 1.0, 0.3, 1.0
WANTED, OTHER = 1, 2
"""In masks: what is asked for, and what else has come to light."""
_SIDES, _OTHER_SIDE = re.compile(r"\b(left|right)(most)?\b"), {"left": "right", "right": "left"}


def mirrored_words(question: str) -> str:
    """What a question says of the mirrored room.

    >>> mirrored_words("Is there a cup in the top left drawer of the rightmost desk?")
    'Is there a cup in the top right drawer of the leftmost desk?'
    """
    return _SIDES.sub(lambda found: _OTHER_SIDE[found[1]] + (found[2] or ""), question)


@dataclass(frozen=True, eq=False)
class Asked:
    """A question with what is to be seen.

    Attributes
    ----------
    question, answer, kind : str
    wanted : int
        Index of the type that is asked for.
    views : (2, 3, side, side) uint8
        Before and after.
    cells : (2, h', w') int64
        What each cell shows, index of its type + 1, or 0; at places STRIDE apart.
    masks : (2, h', w') int64
        Where something is seen that was not before: WANTED if it is asked for, OTHER if not; 0 elsewhere.
    heat : (2, h', w') float32
        1 at middles of objects, less around them.
    counts : (2,) float32
        How many things are seen that were not before and are asked for.
    """

    question: str
    answer: str
    kind: str
    wanted: int
    views: Tensor
    cells: Tensor
    masks: Tensor
    heat: Tensor
    counts: Tensor


class AskedViews:
    """The questions of a split, in some rooms.

    Parameters
    ----------
    root, split : path, str
        Of the dataset.
    rooms : collection of str, optional
        Only these.
    with_box : bool
        Whether the target's box is given.
    side_px : int
        Squares of so many pixels are shown.
    """

    def __init__(
        self,
        root: Path,
        split: str,
        rooms: frozenset[str] | None = None,
        *,
        with_box: bool = True,
        side_px: int = SIDE_PX,
    ) -> None:
        self._reader = SplitReader(root, "questions", split)
        self.rows: list[dict[str, Any]] = [
            row | {"place": place}
            for place, row in enumerate(self._reader.columns(("question_id", *COLUMNS)).to_pylist())
            if rooms is None or row["scene"] in rooms
        ]
        self.with_box, self.side_px = with_box, side_px
        self._numbers = {name: number for number, name in enumerate(detector_types())}

    def __len__(self) -> int:
        return len(self.rows)

    def view(self, index: int, rng: np.random.Generator | None = None, others: Others | None = None) -> Asked:
        """A question; with a generator varied, and then perhaps for another of the things that can be asked for."""
        row = self.rows[index]
        start, end, start_ids, end_ids = self._reader.images(row["place"], IMAGES)
        pictures = [decode_rgb(start), decode_rgb(end)]
        instances = [decode_instances(data).astype(np.int32) for data in (start_ids, end_ids)]
        box = row["start_target_box_2d"] if self.with_box else None
        place, mirrored = window(box, instances[0].shape), False
        question, answer, wanted = row["question"], row["answer"], row["answer_type"]
        names = [name.partition("|")[0] for name in row["object_ids"]]
        counts = [np.bincount(ids.ravel(), minlength=len(names) + 1)[1:] for ids in instances]
        is_new = (counts[0] == 0) & (counts[1] >= EVIDENCE_PX)
        if rng is not None:
            mirrored = bool(rng.random() < 0.5)
            place = _shaken(place, rng)
            light = int(rng.integers(2**31))
            pictures = [relit(picture, np.random.default_rng(light)) for picture in pictures]
            is_plain = row["kind"] != "SPATIAL" or "the " + object_type(wanted).singular not in question.lower()
            if others is not None and is_plain and rng.random() < ASKED_AGAIN:
                there = [name for name, new in zip(names, is_new, strict=True) if new]
                question, answer, wanted = others.ask(row, there, rng)
            if mirrored:
                question = mirrored_words(question)
        masks = np.array(
            [0, *(new * (WANTED if name == wanted else OTHER) for name, new in zip(names, is_new, strict=True))]
        )
        kinds = np.array([0, *(self._numbers.get(name, -1) + 1 for name in names)])
        objects = [
            cut(ids.astype(np.float32), place, self.side_px, mirrored=mirrored).astype(np.int64) for ids in instances
        ]
        shown = [ids[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE] for ids in objects]
        views = np.stack([cut(picture, place, self.side_px, mirrored=mirrored) for picture in pictures])
        return Asked(
            question,
            answer,
            row["kind"],
            self._numbers[wanted],
            torch.from_numpy(np.ascontiguousarray(views.transpose(0, 3, 1, 2))),
            torch.from_numpy(np.stack([kinds[ids] for ids in shown])),
            torch.from_numpy(np.stack([masks[ids] for ids in shown])),
            torch.stack([wanted_of(ids, kinds[1:] - 1).heat for ids in objects]),
            torch.tensor([float((masks[np.unique(ids)] == WANTED).sum()) for ids in objects]),
        )


def _shaken(place: tuple[float, float, float], rng: np.random.Generator) -> tuple[float, float, float]:
    x, y, side = place
    dx, dy = rng.normal(0, 0.06 * side, 2)
    return x + dx, y + dy, side * float(np.exp(rng.normal(0, 0.15)))


@dataclass(frozen=True)
class Others:
    """What else can be asked for.

    Attributes
    ----------
    by_room_type : mapping of str to tuple of str
        Types that questions in rooms of a type ask for.
    answers : frozenset of str
        What is ever answered.
    """

    by_room_type: Mapping[str, tuple[str, ...]]
    answers: frozenset[str]

    @classmethod
    def of_rows(cls, rows: Sequence[Mapping[str, Any]]) -> Others:
        """What some questions ask for."""
        types: dict[str, dict[str, None]] = {}
        for row in rows:
            types.setdefault(row["room_type"], {})[row["answer_type"]] = None
        return cls({room: tuple(found) for room, found in types.items()}, frozenset(row["answer"] for row in rows))

    def ask(self, row: Mapping[str, Any], there: Sequence[str], rng: np.random.Generator) -> tuple[str, str, str]:
        """A question for another thing, its answer, and the thing.

        Whether there is one is true as often as not. How many there are is asked where something has come to light more than
        once, so that each number is about as often the answer.
        """
        types = self.by_room_type[row["room_type"]]
        counts = {name: there.count(name) for name in types}
        numbers = sorted({count for count in counts.values() if str(count) in self.answers})
        is_counted = max(numbers, default=0) > 1
        if row["kind"] == "COUNTING" and not is_counted:
            return row["question"], row["answer"], row["answer_type"]
        if is_counted:
            is_most = len(numbers) == 1 or rng.random() < MOST_COUNTED
            wanted_count = numbers[-1] if is_most else int(rng.choice(numbers[:-1]))
            pool = [name for name in types if counts[name] == wanted_count]
        else:
            is_there = bool(rng.random() < 0.5)
            pool = [name for name in types if bool(counts[name]) is is_there] or list(types)
        wanted = str(pool[int(rng.integers(len(pool)))])
        answer = str(counts[wanted]) if is_counted else "yes" if counts[wanted] else "no"
        if answer not in self.answers:
            return row["question"], row["answer"], row["answer_type"]
        return _asking(row["question"], row["answer_type"], wanted, is_counted=is_counted), answer, wanted


def _asking(question: str, before: str, wanted: str, *, is_counted: bool) -> str:
    """A question, asked for another type, and perhaps how many of it there are.

    >>> _asking("Is there a mug in the drawer?", "Mug", "Egg", is_counted=False)
    'Is there an egg in the drawer?'
    >>> _asking("Is there a mug in the drawer?", "Mug", "Egg", is_counted=True)
    'How many eggs are there in the drawer?'
    """
    if is_counted:
        question = question.replace(f"Is there {with_article(before)} ", f"How many {plural(before)} are there ", 1)
    for words in (plural, with_article):
        question = question.replace(f" {words(before)} ", f" {words(wanted)} ", 1)
    return question


class AnsweringTask:
    """An answerer learns from the questions of train rooms; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the first one's val rooms give the score.
    views : sequence of {"start", "end"}
        What it looks at.
    with_box : bool
        Whether the target's box is given.
    detector : Detector
        Trained: what it begins with.
    device : str
        Where to compute.
    side_px : int
        It is shown squares of so many pixels.
    questions : int, optional
        It learns from so many of them, spread evenly over the rooms; from all by default.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        views: Sequence[View],
        with_box: bool,
        detector: Detector,
        device: str = "cpu",
        *,
        side_px: int = SIDE_PX,
        questions: int | None = None,
    ) -> None:
        rooms = learning_rooms(roots)
        self._asked = [AskedViews(root, "train", rooms, with_box=with_box, side_px=side_px) for root in roots]
        self._places = [(asked, index) for asked in self._asked for index in range(len(asked))]
        if questions is not None:
            chosen = np.linspace(0, len(self._places), min(questions, len(self._places)), endpoint=False)
            self._places = [self._places[int(place)] for place in chosen]
        self._val = AskedViews(roots[0], "train", rooms_of(roots[0], "val"), with_box=with_box, side_px=side_px)
        rows = [asked.rows[index] for asked, index in self._places]
        self.others = Others.of_rows(rows)
        self.vocabulary = Vocabulary.build([row["question"] for row in rows], [row["answer"] for row in rows])
        self.model = ManipulationAnswerer(
            len(self.vocabulary.words), len(self.vocabulary.answers), len(detector_types()), views, side_px
        )
        if views:
            self.model.detector.load_state_dict(detector.state_dict())
        self.device = device

    def __len__(self) -> int:
        return len(self._places)

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> list[Asked]:
        """Some questions, varied."""
        places = [self._places[sample] for sample in samples]
        return [asked.view(index, rng, self.others) for (asked, index), rng in zip(places, rngs, strict=True)]

    def losses(self, batch: list[Asked]) -> Mapping[str, Tensor]:
        """Of the answers, of where what is asked for is and how often, and of what the cells show."""
        said = Answered(*(part.float() for part in self._said(batch)))
        right = torch.tensor([self.vocabulary.answers.index(asked.answer) for asked in batch], device=self.device)
        losses = {"answers": functional.cross_entropy(said.answers, right)}
        types = torch.tensor([asked.wanted for asked in batch], device=self.device)
        losses["types"] = TYPE_WEIGHT * functional.cross_entropy(said.types, types)
        used = [VIEWS.index(view) for view in self.model.views]
        if used:
            masks = torch.stack([asked.masks for asked in batch])[:, used].to(self.device)
            is_wanted = (masks == WANTED).to(said.fits.dtype)
            fit = functional.binary_cross_entropy_with_logits(said.fits, is_wanted, reduction="none")
            losses["masks"] = MASK_WEIGHT * _of_groups(fit, masks)
            cells = torch.stack([asked.cells for asked in batch])[:, used].to(self.device)
            shown = functional.cross_entropy(said.cells.flatten(0, 1), cells.flatten(0, 1), reduction="none")
            losses["cells"] = CELL_WEIGHT * _of_groups(shown, masks.flatten(0, 1))
            heat = torch.stack([asked.heat for asked in batch])[:, used].to(self.device)
            losses["middles"] = MIDDLE_WEIGHT * heat_loss(said.middles, heat) / (heat == 1).sum().clamp(min=1)
            counts = torch.stack([asked.counts for asked in batch])[:, used].to(self.device)
            losses["counts"] = COUNT_WEIGHT * functional.smooth_l1_loss(said.counts, counts)
        total = sum(losses.values(), torch.zeros((), device=self.device))
        return {"loss": total, "right": (said.answers.argmax(1) == right).float().mean(), **losses}

    def score(self) -> Mapping[str, float]:
        """Share of right answers in val rooms, by kind and in all."""
        hits: dict[str, list[bool]] = {kind: [] for kind in KINDS}
        for first in range(0, len(self._val), 16):
            batch = [self._val.view(index) for index in range(first, min(first + 16, len(self._val)))]
            for asked, answer in zip(batch, self.answers(batch), strict=True):
                hits[asked.kind].append(answer == asked.answer)
        every = [hit for found in hits.values() for hit in found]
        shares = {f"val_{kind}": float(np.mean(found)) for kind, found in hits.items() if found}
        return shares | {"val": float(np.mean(every))} if every else {}

    @torch.no_grad()
    def answers(self, batch: list[Asked]) -> list[str]:
        """The likeliest answer to each question, of those that its kind has."""
        return likeliest(self._said(batch).answers, [asked.kind for asked in batch], self.vocabulary.answers)

    def _said(self, batch: list[Asked]) -> Answered:
        numbers = torch.from_numpy(self.vocabulary.encode_batch([asked.question for asked in batch])[0])
        views = torch.stack([asked.views for asked in batch])
        return self.model(numbers.to(self.device), views.to(self.device))  # type: ignore[no-any-return]


def _of_groups(each: Tensor, masks: Tensor) -> Tensor:
    """Mean loss of cells that show what is asked for, that show other new things, and of the rest: the groups count alike."""
    groups = [masks == group for group in (0, WANTED, OTHER)]
    return torch.stack([(each * group).sum() / group.sum().clamp(min=1) for group in groups]).mean()
