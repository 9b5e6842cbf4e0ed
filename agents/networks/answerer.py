"""The answerer: a CNN on the views before and after the manipulation, an LSTM on the question, attention.

What the words ask for, as a type and as a vector, is compared with each cell of both views. The views are read where the two
agree; how strongly they do, and how many middles of objects are there, goes into the answer with what is seen there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.detection.arrangement import near_numbers
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.pyramid import CHANNELS, STRIDE
from remqa_data.agents.networks.language import HIDDEN, WordReader
from remqa_data.agents.networks.windows import SIDE_PX

View = Literal["start", "end"]
VIEWS: tuple[View, ...] = ("start", "end")
KEY = 64
"""Numbers that questions and cells are compared by."""

MOST = 3
"""So many things, and not more, are told from one fewer."""

EVIDENCE = 4 + MOST + 1
"""Figures of how the cells of a view fit: see `_evidence`."""

NEVER = 1e-4
"""The least share of a type that a cell may show."""

FIRST_MIX = (1.0, -0.3, 0.5, 2.0)
"""What a cell fits by at first: so much of the logarithm of how surely it shows the type that is asked for, of how surely it
did in the other view, of how much its colours differ from those there, and a constant."""

LEAST_CHANGE = 0.01
"""What colours, 0 to 1, differ by at least, for its logarithm."""


class Answered(NamedTuple):
    """What the answerer says of n questions.

    Attributes
    ----------
    answers : (n, answers)
        Logits.
    fits : (n, views, h', w')
        Logits that a cell of a view shows what is asked for.
    middles : (n, views, h', w')
        Logits that the middle of an object is there.
    counts : (n, views)
        How many middles of what is asked for there are.
    cells : (n, views, 1 + types, h', w')
        Logits of what each cell shows, see `remqa_data.agents.networks.detection.detector.Raw`.
    types : (n, types)
        Logits of which type is asked for.
    """

    answers: Tensor
    fits: Tensor
    middles: Tensor
    counts: Tensor
    cells: Tensor
    types: Tensor


class ManipulationAnswerer(nn.Module):
    """Answers from two views.

    Parameters
    ----------
    words, answers : int
        Sizes of the vocabulary.
    types : int
        How many types the detector knows, with whose weights this one begins.
    views : sequence of {"start", "end"}
        What it looks at; nothing at all for who answers from the words alone.
    side_px : int
        It is shown squares of so many pixels.
    """

    def __init__(
        self, words: int, answers: int, types: int, views: Sequence[View] = VIEWS, side_px: int = SIDE_PX
    ) -> None:
        super().__init__()
        self.views, self.side_px = tuple(views), side_px
        self.reader = WordReader(words, layers=2)
        self.ask = nn.Linear(2 * HIDDEN, KEY)
        self.ask_type = nn.Linear(2 * HIDDEN, types)
        said = KEY
        if self.views:
            self.detector = Detector(types)
            self.values = nn.Conv2d(CHANNELS + 1 + types, KEY, 1)
            self.keys = nn.Sequential(
                nn.ReLU(), nn.Conv2d(KEY * len(self.views), KEY, 1), nn.ReLU(), nn.Conv2d(KEY, KEY, 1)
            )
            self.mix = nn.Parameter(torch.tensor(FIRST_MIX))
            said += len(self.views) * (KEY + EVIDENCE)
        self.say = nn.Sequential(nn.Dropout(0.2), nn.Linear(said, KEY), nn.ReLU(), nn.Linear(KEY, answers))

    def forward(self, numbers: Tensor, views: Tensor) -> Answered:
        """Answer.

        Parameters
        ----------
        numbers : (n, t) int64
            Words of the questions.
        views : (n, 2, 3, h, w) uint8
            What is seen around the target before and after the manipulation; views that it does not look at are not read.
        """
        sentence = self.reader(numbers).sentence
        asked, types = self.ask(sentence), self.ask_type(sentence)
        if not self.views:
            nothing = asked.new_zeros((len(asked), 0, 1, 1))
            return Answered(self.say(asked), nothing, nothing, nothing[:, :, 0, 0], nothing[:, :, None], types)
        used = [VIEWS.index(view) for view in self.views]
        count, raw = len(used), self.detector(views[:, used].flatten(0, 1))
        shown = raw.cells.softmax(1)
        shows = torch.einsum("nvthw,nt->nvhw", _split(shown[:, 1:], count), types.softmax(1)).clamp(min=NEVER).log()
        values = _split(self.values(torch.cat([raw.features, shown], 1)), count)
        # Each view is compared with the question beside the other view: what is new stands out.
        turned = torch.stack([values.roll(-k, 1).flatten(1, 2) for k in range(count)], 1)
        keys = _split(self.keys(turned.flatten(0, 1)), count)
        fits = (keys * asked[:, None, :, None, None]).sum(2) / KEY**0.5 + self.mix[0] * shows + self.mix[3]
        if count > 1:
            fits = fits + self.mix[1] * shows.flip(1) + self.mix[2] * _changes(views)[:, None]
        weights = fits.flatten(2).softmax(2)
        read = (values.flatten(3) * weights[:, :, None]).sum(3)
        middles = _split(raw.middles, count)
        counts = _counts(middles, fits)
        said = torch.cat([asked, read.flatten(1), _evidence(fits, counts).flatten(1)], 1)
        return Answered(self.say(said), fits, middles, counts, _split(raw.cells, count), types)


def _split(images: Tensor, count: int) -> Tensor:
    """(n, count, ...) of (n * count, ...)."""
    return images.reshape(-1, count, *images.shape[1:])


def _changes(views: Tensor) -> Tensor:
    """(n, h', w') logarithms of how much the colours of two views, (n, 2, 3, h, w), differ in each cell."""
    change = (views[:, 1].to(torch.float32) - views[:, 0].to(torch.float32)).abs().mean(1, keepdim=True) / 255
    return functional.avg_pool2d(change, STRIDE, ceil_mode=True)[:, 0].clamp(min=LEAST_CHANGE).log()


def fitting(logits: Tensor, kinds: Sequence[str], answers: Sequence[str]) -> Tensor:
    """(n, answers) logits, -inf for what does not fit the kind of question: a number where one is asked for, else yes or no."""
    is_number = torch.tensor([answer.isdigit() for answer in answers], device=logits.device)
    wants_number = torch.tensor([kind == "COUNTING" for kind in kinds], device=logits.device)
    return logits.masked_fill(is_number[None] != wants_number[:, None], -torch.inf)


def likeliest(logits: Tensor, kinds: Sequence[str], answers: Sequence[str]) -> list[str]:
    """The likeliest answer of each row of (n, answers) logits that fits the kind of question."""
    return [answers[place] for place in fitting(logits, kinds, answers).argmax(1).tolist()]


def _counts(middles: Tensor, fits: Tensor) -> Tensor:
    """(n, views) numbers of middles of what is asked for, of (n, views, h', w') logits of middles, and of what fits."""
    is_peak = functional.max_pool2d(middles, 3, 1, 1) == middles
    return (middles.sigmoid() * fits.sigmoid() * is_peak).sum((2, 3))


def _evidence(fits: Tensor, counts: Tensor) -> Tensor:
    """(n, views, EVIDENCE) of (n, views, h', w') logits and (n, views) counts.

    The highest logit, the logarithms of sum and area, the count, and how near it is to 0, 1, ... MOST.
    """
    flat = fits.flatten(2)
    figures = torch.stack([flat.amax(2), flat.logsumexp(2), flat.sigmoid().sum(2).log1p(), counts], dim=2)
    return torch.cat([figures, near_numbers(counts, MOST)], dim=2)
