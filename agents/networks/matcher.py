"""The language attention network (MAttNet, Yu et al. 2018): which object of a picture an expression means.

The words are weighed three times: for what the object is and looks like, for where it is, and for what it is close to. Each of
these parts of the expression is compared with each object, and the expression says how much each comparison counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.detection.arrangement import PAIR, RANKS, arrangement_of
from remqa_data.agents.networks.detection.box_head import BoxHead, Fit
from remqa_data.agents.networks.detection.detector import iou
from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.detection.regions import ALIKE, PLACE, SHADES, Regions
from remqa_data.agents.networks.language import EMBEDDED, HIDDEN, WordReader
from remqa_data.geometry.types import F32, I64

JOINT = 128
"""Numbers of what is compared."""

BETWEEN = 64
"""The same, of how pairs lie."""

PARTS = ("subject", "location", "relationship")
SHARPNESS = 10.0
"""What similarities, -1 to 1, are multiplied with."""

VOTING_IOU = 0.5
"""Boxes that overlap the one that is chosen so much say, too, where it ends."""

VOTING_SHARPNESS = 4.0
"""What their scores are multiplied with before they are weighed by a softmax."""

MARGIN = 1.0
"""By how much the right pair of object and expression is to fit better than a wrong one."""

UNLIKELY = -1e4
"""Logit of what cannot be: nothing is its own anchor, unless it is alone."""


class Match(NamedTuple):
    """How well each of m objects of a picture fits each of e expressions of at most t words.

    Attributes
    ----------
    scores : (e, m)
        The sum of all parts.
    weights : (e, 3)
        How much each part counts.
    attention : (e, 3, t) or (e, 4, t)
        How much each word counts for each part, and for the anchor if there is one.
    fit : Fit, optional
        Where each object ends, and how well its box fits it, if that is judged; else the boxes stay as they are.
    """

    scores: Tensor
    weights: Tensor
    attention: Tensor
    fit: Fit | None = None

    @property
    def chosen(self) -> I64:
        """(e,) which object each expression means."""
        return np.asarray(self.scores.argmax(1).numpy(force=True))

    def judged(self, fit: Fit) -> Match:
        """The same match, of objects of which is said how well their boxes fit."""
        return self._replace(scores=self.scores + fit.worth, fit=fit)

    def boxes_of(self, regions: Regions) -> F32:
        """(m, 4) where the objects are that were matched, pixels."""
        return regions.boxes if self.fit is None else self.fit.boxes.numpy(force=True)

    def meant_in(self, regions: Regions) -> F32:
        """(e, 4) where what each expression means is, pixels.

        Where boxes are judged it is the mean of all that overlap the chosen one, by how well they fit the expression (box
        voting, Gidaris and Komodakis 2015).
        """
        boxes, chosen = self.boxes_of(regions), self.chosen
        if self.fit is None:
            return boxes[chosen]
        is_heard = iou(boxes[chosen], boxes) >= VOTING_IOU
        is_heard[range(len(chosen)), chosen] = True  # whatever its size
        weights = (VOTING_SHARPNESS * self.scores.cpu()).masked_fill(torch.from_numpy(~is_heard), -torch.inf).softmax(1)
        mean = weights.numpy(force=True) @ boxes
        # The weights sum up to one but for the last digit: no side is farther out than that of any box.
        return np.asarray(mean.clip(boxes.min(axis=0), boxes.max(axis=0)))


class Matcher(nn.Module):
    """Tells which object of a picture an expression means.

    Parameters
    ----------
    types : int
        How many types the detector knows.
    box_head : bool
        Whether it judges boxes that were found, and moves them.
    colors : bool
        Whether it sees colours, and not only what the detector, which need not tell them apart, keeps of them.
    """

    def __init__(self, types: int, box_head: bool, colors: bool) -> None:
        super().__init__()
        self.colors = colors
        self.box_head = BoxHead(types) if box_head else None

    def forward(self, numbers: Tensor, regions: Regions) -> Match:
        """How well the objects of a picture fit expressions that have (e, t) numbers of words.

        What was found counts the more the better its box fits an object.
        """
        match = self.match(numbers, regions)
        if self.box_head is None or regions.are_known:
            return match
        (fit,) = self.box_head([regions])
        return match.judged(fit)

    def match(self, numbers: Tensor, regions: Regions) -> Match:
        """The same, however well their boxes fit."""
        raise NotImplementedError

    def looks_of(self, regions: Regions) -> Tensor:
        """(m, CHANNELS, g, g) looks, or (m, CHANNELS + SHADES, g, g) with colours."""
        return torch.cat([regions.looks, regions.colors], 1) if self.colors else regions.looks


class ModularMatcher(Matcher):
    """What is said of each part of an expression, and how well objects fit its subject.

    Parameters
    ----------
    words : int
        Size of the vocabulary.
    types : int
        How many types the detector knows.
    phrases : int
        How many times the words are weighed; the subject comes first.
    seen : sequence of int
        How many numbers are compared with each of the first phrases.
    box_head, colors : bool
        See `Matcher`.
    """

    def __init__(self, words: int, types: int, phrases: int, seen: Sequence[int], box_head: bool, colors: bool) -> None:
        super().__init__(types, box_head, colors)
        self.reader = WordReader(words)
        self.attend = nn.Linear(2 * HIDDEN, phrases)
        self.weigh = nn.Linear(2 * HIDDEN, len(PARTS))
        self.type_look = nn.Linear(types, CHANNELS)
        self.look = nn.Conv2d(CHANNELS + SHADES * colors, CHANNELS, 1)
        self.asked_look = nn.Linear(EMBEDDED, CHANNELS)
        self.focus = nn.Linear(CHANNELS, 1)
        self.seen = nn.ModuleList(_joint(width) for width in seen)
        self.asked = nn.ModuleList(_joint(EMBEDDED) for _ in seen)

    def read(self, numbers: Tensor) -> tuple[Tensor, Tensor, tuple[Tensor, ...]]:
        """Weights and attention of `Match`, and each phrase, (e, EMBEDDED), of expressions with (e, t) numbers of words."""
        words = self.reader(numbers)
        attention = _attention(self.attend(words.read), words.is_word)
        return self.weigh(words.sentence).softmax(1), attention, (attention @ words.embedded).unbind(1)

    def fit_subject(self, phrases: Tensor, looks: Tensor, types: Tensor) -> Tensor:
        """(e, m) how well objects, by their `looks_of` and (m, CHANNELS) types, fit (e, EMBEDDED) phrases."""
        at = self.look(looks).flatten(2).transpose(1, 2)
        focus = self.focus(torch.tanh(at[None] + self.asked_look(phrases)[:, None, None])).softmax(2)
        subjects = torch.einsum("mgc,emg->emc", at, focus[..., 0])
        seen = self.seen[0](torch.cat([subjects, types.expand(len(subjects), -1, -1)], 2))
        return torch.einsum("ej,emj->em", _unit(self.asked[0](phrases)), _unit(seen))

    def fit_place(self, phrases: Tensor, places: Tensor) -> Tensor:
        """(e, m) how well what is known of the places of objects, (m, numbers), fits (e, EMBEDDED) phrases."""
        return _unit(self.asked[1](phrases)) @ _unit(self.seen[1](places)).T


class LanguageAttentionMatcher(ModularMatcher):
    """Matches expressions with objects in three modules.

    Parameters
    ----------
    words : int
        Size of the vocabulary.
    types : int
        How many types the detector knows.
    box_head, colors : bool
        See `Matcher`.
    """

    def __init__(self, words: int, types: int, box_head: bool = False, colors: bool = False) -> None:
        seen = (2 * CHANNELS, PLACE * (1 + ALIKE), 2 * CHANNELS + PLACE)
        super().__init__(words, types, len(PARTS), seen, box_head, colors)

    def match(self, numbers: Tensor, regions: Regions) -> Match:
        """See `Matcher.match`."""
        weights, attention, (of_subject, of_place, of_relation) = self.read(numbers)
        types = self.type_look(regions.types)
        subject = self.fit_subject(of_subject, self.looks_of(regions), types)
        location = self.fit_place(of_place, torch.cat([regions.places, regions.from_alike.flatten(1)], 1))
        looks = regions.looks.mean((2, 3))
        seen = torch.cat([looks[regions.around], types[regions.around], regions.from_around], 2)
        beside = torch.einsum("ej,mkj->emk", _unit(self.asked[2](of_relation)), _unit(self.seen[2](seen)))
        relationship = beside.masked_fill(~regions.is_around, -1.0).amax(2)
        return _weighed(subject, location, relationship, weights, attention)


class PlainMatcher(Matcher):
    """The same without modules: one vector for the expression, one for each object. What LAN is compared with."""

    def __init__(self, words: int, types: int, box_head: bool = False, colors: bool = False) -> None:
        super().__init__(types, box_head, colors)
        self.reader = WordReader(words)
        self.asked = _joint(2 * HIDDEN)
        self.seen = _joint(CHANNELS + SHADES * colors + types + PLACE * (1 + ALIKE))

    def match(self, numbers: Tensor, regions: Regions) -> Match:
        """See `Matcher.match`; every word counts alike."""
        words = self.reader(numbers)
        asked = _unit(self.asked(words.sentence))
        seen = [self.looks_of(regions).mean((2, 3)), regions.types, regions.places, regions.from_alike.flatten(1)]
        scores = SHARPNESS * asked @ _unit(self.seen(torch.cat(seen, 1))).T
        is_word = words.is_word.to(scores.dtype)
        attention = (is_word / is_word.sum(1, keepdim=True))[:, None].expand(-1, len(PARTS), -1)
        return Match(scores, torch.full((len(numbers), len(PARTS)), 1 / len(PARTS)), attention)


class AnchoredMatcher(ModularMatcher):
    """LAN whose relationship is to one object, the anchor, and whose locations are ranks among objects of a kind.

    The words are weighed a fourth time, for what the anchor is: each object is the anchor as likely as it fits these words,
    whatever the subject. The relationship of a subject is how it lies to the anchor, and how many of its kind are nearer to it:
    so what is closest is told from what is close. LAN's relationship takes for each subject the object that fits best.

    Parameters
    ----------
    words : int
        Size of the vocabulary.
    types : int
        How many types the detector knows.
    box_head, colors : bool
        See `Matcher`.
    """

    def __init__(self, words: int, types: int, box_head: bool = False, colors: bool = False) -> None:
        seen = (2 * CHANNELS, PLACE + RANKS + CHANNELS)
        super().__init__(words, types, len(PARTS) + 1, seen, box_head, colors)
        self.anchor, self.asked_anchor = _joint(2 * CHANNELS), _joint(EMBEDDED)
        self.pair = _joint(PAIR, BETWEEN)
        self.asked_pair = nn.Sequential(nn.Linear(EMBEDDED, JOINT), nn.ReLU(), nn.Linear(JOINT, BETWEEN))

    def match(self, numbers: Tensor, regions: Regions) -> Match:
        """See `Matcher.match`; attention is that of its three parts, and of the anchor."""
        weights, attention, (of_subject, of_place, of_relation, of_anchor) = self.read(numbers)
        types, lie = self.type_look(regions.types), arrangement_of(regions)
        subject = self.fit_subject(of_subject, self.looks_of(regions), types)
        location = self.fit_place(of_place, torch.cat([regions.level, lie.ranks, types], 1))
        anchors = self.anchor(torch.cat([regions.looks.mean((2, 3)), types], 1))
        fits = SHARPNESS * _unit(self.asked_anchor(of_anchor)) @ _unit(anchors).T
        is_anchor = fits[:, None].masked_fill(~lie.is_other, UNLIKELY).softmax(2)
        beside = torch.einsum("ej,mkj->emk", _unit(self.asked_pair(of_relation)), _unit(self.pair(lie.pairs)))
        return _weighed(subject, location, (is_anchor * beside).sum(2), weights, attention)


def _weighed(subject: Tensor, location: Tensor, relationship: Tensor, weights: Tensor, attention: Tensor) -> Match:
    """The match of (e, m) similarities by part."""
    scores = torch.stack([subject, location, relationship], 1)
    return Match(SHARPNESS * torch.einsum("ep,epm->em", weights, scores), weights, attention)


def _joint(width: int, made: int = JOINT) -> nn.Sequential:
    return nn.Sequential(nn.Linear(width, made), nn.ReLU(), nn.Linear(made, made))


def _attention(logits: Tensor, is_word: Tensor) -> Tensor:
    """(e, parts, t) how much each word counts for each part, by (e, t, parts) logits; what is no word counts nothing."""
    return logits.masked_fill(~is_word[..., None], -torch.inf).softmax(1).transpose(1, 2)


def _unit(vectors: Tensor) -> Tensor:
    return functional.normalize(vectors, dim=-1)


def ranking_loss(right: Tensor, wrong: Tensor) -> Tensor:
    """Hinge loss of one expression with its object, which is to fit better by `MARGIN`.

    Parameters
    ----------
    right : ()
        How well the object that is meant fits the expression.
    wrong : (k,)
        How well other objects of the picture fit it, and other expressions the object.

    Returns
    -------
    The mean over all wrong pairs, plus that of the worst: hard negatives are those of the same picture.
    """
    if not len(wrong):
        return right * 0
    short = functional.relu(MARGIN + wrong - right)
    return short.mean() + short.amax()
