"""Grounding in one stage: from words and a picture straight to a box and a mask, with no boxes to choose from.

Two networks of the paper's table. Both stand on what the trained detector makes of a picture, as theirs stand on a backbone
that has learnt to detect, and differ in how words and picture meet; a third of what makes each of them is how it is taught
(`remqa_data.agents.training.grounding`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.pyramid import CHANNELS, STRIDE
from remqa_data.agents.networks.detection.regions import UNSEEN_M
from remqa_data.agents.networks.language import HIDDEN, WordReader
from remqa_data.geometry.types import F32, Flags

CELL_PX = 2 * STRIDE
"""Cells are twice as wide as the detector's: each stands for the likeliest middle of an object among four."""

SEEN = 2 * CHANNELS + 4
"""Numbers of a cell: the detector's features there and around, how likely that middle is, how far away, and where."""

WIDTH = 64
GROUPS, STEPS = 4, 2
"""Of CGAN: groups of features that look for words of their own, and how often they do."""

MOST_CHANGE = 3.0
"""The detector's sides are changed by e to the power of this at most."""

POOLED = 2
"""The two branches of MCN are compared in squares of so many cells."""

OUTSIDE = 0.5
"""What MCN's mask is worth outside its box, beside what the mask is worth inside."""


class Sight(NamedTuple):
    """What the detector makes of n pictures, each of h' x w' cells of `CELL_PX` pixels.

    Attributes
    ----------
    cells : (n, SEEN, h', w')
    boxes : (n, 4, h', w')
        x, y, width, height of what has its middle there, pixels.
    """

    cells: Tensor
    boxes: Tensor


class Said(NamedTuple):
    """What e expressions are thought to mean.

    Attributes
    ----------
    places : (e, h', w')
        Logits that its middle is there.
    boxes : (e, 4, h', w')
        x1, y1, x2, y2 if so, pixels.
    masks : (e, h', w')
        Logits that the cell shows it.
    attention : (e, k, h', w')
        Logits of where k parts of the network look.
    agreement : (e,)
        Of MCN, from 0 to 1: how much the branch of boxes and that of masks look at alike things; else 1.
    """

    places: Tensor
    boxes: Tensor
    masks: Tensor
    attention: Tensor
    agreement: Tensor


@torch.no_grad()
def sight_of(detector: Detector, rgb: Tensor, depth: Tensor) -> Sight:
    """What a trained detector makes of (n, 3, h, w) uint8 pictures with (n, h, w) depth in metres, 0 where nothing is."""
    raw = detector(rgb)
    (height, width), fine = depth.shape[1:], raw.middles.shape[-2:]
    heat, best = functional.max_pool2d(raw.middles.sigmoid(), 2, ceil_mode=True, return_indices=True)
    coarse = heat.shape[-2:]

    def at_best(values: Tensor) -> Tensor:
        places = best.flatten(1)[:, None].expand(-1, values.shape[1], -1)
        return values.flatten(2).gather(2, places).view(*values.shape[:2], *coarse)

    x, y = ((places + 0.5) * STRIDE for places in (best % fine[1], best // fine[1]))
    left, up, right, down = at_best(raw.sides).unbind(1)
    boxes = torch.stack([x + (right - left) / 2, y + (down - up) / 2, left + right, up + down], 1)
    metres = torch.where(depth > 0, depth, torch.full_like(depth, UNSEEN_M))[:, None].log()
    padding = (0, coarse[1] * CELL_PX - width, 0, coarse[0] * CELL_PX - height)
    far = functional.avg_pool2d(functional.pad(metres, padding, mode="replicate"), CELL_PX)
    around = functional.avg_pool2d(raw.features, 2, ceil_mode=True)
    where = torch.stack([x / width, y / height], 1)
    return Sight(torch.cat([at_best(raw.features), around, heat[:, None], far, where], 1), boxes)


class Grounder(nn.Module):
    """What both networks have in common: they read, look, and say a place, a box and a mask.

    Parameters
    ----------
    words : int
        Size of the vocabulary.
    """

    def __init__(self, words: int) -> None:
        super().__init__()
        self.reader = WordReader(words)
        self.look = nn.Sequential(nn.Conv2d(SEEN, WIDTH, 1), nn.GroupNorm(GROUPS, WIDTH), nn.ReLU(), Mixing(WIDTH))
        self.place = nn.Conv2d(WIDTH, 1, 1)
        self.change = nn.Conv2d(WIDTH, 4, 1)
        self.mask = nn.Conv2d(WIDTH, 1, 1)
        with torch.no_grad():
            self.change.weight.mul_(0.1)

    def _boxes(self, before: Tensor, seen: Tensor) -> Tensor:
        """(e, 4, h, w) corners by centres and sizes, which are moved by shares of the size and made larger or smaller."""
        change: Tensor = self.change(seen).clamp(-MOST_CHANGE, MOST_CHANGE)
        middle = before[:, :2] + change[:, :2] * before[:, 2:]
        half = before[:, 2:] * change[:, 2:].exp() / 2
        return torch.cat([middle - half, middle + half], 1)


class CollaborativeGrounder(Grounder):
    """MCN (Luo et al. 2020): a branch for boxes and one for masks, which learn from each other and look at the same.

    Words and picture meet by products of their features; each branch has what the other one sees, and attends to cells by the
    sentence. Unlike the original, whose box branch sees coarser cells, both see those of the detector.
    """

    def __init__(self, words: int) -> None:
        super().__init__(words)
        self.asked = nn.Linear(2 * HIDDEN, WIDTH)
        self.branches = nn.ModuleList(Mixing(WIDTH) for _ in range(2))
        self.shared = nn.ModuleList(nn.Conv2d(WIDTH, WIDTH, 1) for _ in range(2))
        self.last = nn.ModuleList(Mixing(WIDTH) for _ in range(2))
        self.attends = nn.ModuleList(nn.Conv2d(WIDTH, 1, 1) for _ in range(2))
        self.to_attend = nn.ModuleList(nn.Linear(2 * HIDDEN, WIDTH) for _ in range(2))

    def forward(self, numbers: Tensor, sight: Sight, which: Tensor) -> Said:
        """What expressions with (e, t) numbers of words mean in pictures (e,) of a sight."""
        sentence = self.reader(numbers).sentence
        fused = self.look(sight.cells)[which] * functional.relu(self.asked(sentence))[..., None, None]
        apart = [branch(fused) for branch in self.branches]
        joined = [
            own + functional.relu(layer(other))
            for own, layer, other in zip(apart, self.shared, apart[::-1], strict=True)
        ]
        seen, attention = [], []
        for own, wants, attends, last in zip(joined, self.to_attend, self.attends, self.last, strict=True):
            logits = attends(torch.tanh(own + wants(sentence)[..., None, None]))
            share = logits.flatten(2).softmax(2).view_as(logits)
            whole = (own * share).sum((2, 3), keepdim=True)
            seen.append(last(own * logits.sigmoid() + whole))
            attention.append(logits[:, 0])
        boxes, masks = seen
        return Said(
            self.place(boxes)[:, 0],
            self._boxes(sight.boxes[which], boxes),
            self.mask(masks)[:, 0],
            torch.stack(attention, 1),
            agreement_of(*attention, *seen),
        )


class GroupedGrounder(Grounder):
    """CGAN (Luo et al. 2020): groups of features each look for the words that concern them, one time after the other.

    At each cell each group weighs the words anew; what it attends to is what its features are multiplied with.
    """

    def __init__(self, words: int) -> None:
        super().__init__(words)
        self.keys = nn.ModuleList(nn.Linear(2 * HIDDEN, WIDTH) for _ in range(STEPS))
        self.values = nn.ModuleList(nn.Linear(2 * HIDDEN, WIDTH) for _ in range(STEPS))
        self.mixing = nn.ModuleList(Mixing(WIDTH) for _ in range(STEPS))
        self.attends = nn.ModuleList(nn.Conv2d(WIDTH, 1, 1) for _ in range(STEPS))

    def forward(self, numbers: Tensor, sight: Sight, which: Tensor) -> Said:
        """See `CollaborativeGrounder.forward`; `attention` is what the steps believe in."""
        words = self.reader(numbers)
        seen = self.look(sight.cells)[which]
        attention = []
        for keys, values, mixing, attends in zip(self.keys, self.values, self.mixing, self.attends, strict=True):
            found = grouped_attention(seen, keys(words.read), values(words.read), words.is_word)
            seen = mixing(seen * functional.relu(found)) + seen
            attention.append(attends(seen)[:, 0])
        return Said(
            self.place(seen)[:, 0] + attention[-1],
            self._boxes(sight.boxes[which], seen),
            self.mask(seen)[:, 0],
            torch.stack(attention, 1),
            torch.ones(len(numbers), device=seen.device),
        )


class Mixing(nn.Module):
    """Cells see what is around them, near and farther away."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.near = nn.Conv2d(width, width, 3, padding=1)
        self.norm = nn.GroupNorm(GROUPS, width)
        self.far = nn.Conv2d(width, width, 3, padding=3, dilation=3)

    def forward(self, x: Tensor) -> Tensor:
        """(n, width, h, w) to the same."""
        near: Tensor = functional.relu(self.norm(self.near(x)))
        return functional.relu(x + near + self.far(near))


def grouped_attention(seen: Tensor, keys: Tensor, values: Tensor, is_word: Tensor) -> Tensor:
    """What each of `GROUPS` groups of features attends to at each cell.

    Parameters
    ----------
    seen : (e, WIDTH, h, w)
    keys, values : (e, t, WIDTH)
        Of words.
    is_word : (e, t) bool

    Returns
    -------
    (e, WIDTH, h, w)
    """
    asked, parts = len(seen), WIDTH // GROUPS
    looks = seen.view(asked, GROUPS, parts, -1)
    keys, values = (one.view(asked, -1, GROUPS, parts) for one in (keys, values))
    logits = torch.einsum("etgc,egcp->egtp", keys, looks) / parts**0.5
    weights = logits.masked_fill(~is_word[:, None, :, None], -torch.inf).softmax(2)
    return torch.einsum("egtp,etgc->egcp", weights, values).reshape(seen.shape)


def agreement_of(first: Tensor, second: Tensor, first_seen: Tensor, second_seen: Tensor) -> Tensor:
    """(e,) how much two branches look at alike things (the consistency energy of Luo et al. 2020).

    Parameters
    ----------
    first, second : (e, h, w)
        Logits of where they look.
    first_seen, second_seen : (e, c, h, w)
        What they see there.
    """
    energies, looks = [], []
    for logits, seen in ((first, first_seen), (second, second_seen)):
        shares = logits.flatten(1).softmax(1).view_as(logits)[:, None]
        energies.append(functional.avg_pool2d(shares, POOLED, ceil_mode=True, divisor_override=1).flatten(1))
        looks.append(functional.normalize(functional.avg_pool2d(seen, POOLED, ceil_mode=True).flatten(2), dim=1))
    alike = (torch.einsum("eci,ecj->eij", *looks) + 1) / 2
    return torch.einsum("ei,eij,ej->e", energies[0], alike, energies[1])


class Grounded(NamedTuple):
    """What an expression means.

    Attributes
    ----------
    box : (4,) float32
        x1, y1, x2, y2 in pixels.
    mask : (h', w') bool
        The cells that show it.
    """

    box: F32
    mask: Flags


def grounded(said: Said, size: tuple[int, int]) -> list[Grounded]:
    """The likeliest box of each expression, and its mask, in pictures of a (height, width).

    A mask counts less outside its box (soft suppression of what is not located, Luo et al. 2020), and has a cell at least.
    """
    best = said.places.flatten(1).argmax(1)
    boxes = clipped(said.boxes.flatten(2)[torch.arange(len(best)), :, best], size).numpy(force=True)
    shares = said.masks.sigmoid().numpy(force=True)
    down, along = ((np.arange(length) + 0.5) * CELL_PX for length in shares.shape[1:])
    found = []
    for box, share, place in zip(boxes, shares, best.tolist(), strict=True):
        is_in = ((down >= box[1]) & (down < box[3]))[:, None] & ((along >= box[0]) & (along < box[2]))[None]
        mask = np.where(is_in, share, share * OUTSIDE) > 0.5
        mask.flat[place] |= not mask.any()
        found.append(Grounded(box, mask))
    return found


def clipped(boxes: Tensor, size: tuple[int, int]) -> Tensor:
    """(m, 4) boxes within pictures of a (height, width)."""
    height, width = size
    return torch.minimum(boxes.clamp(min=0), boxes.new_tensor([width, height, width, height]))
