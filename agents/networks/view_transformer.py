"""A small transformer that walks: the question's words and the last views are its tokens, the next move what comes out.

Words see each other; a view sees the words, itself and the views before it, a few in each layer. What a layer makes of words
and of earlier views is kept, so that a step takes one token.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import Tensor, nn

from remqa_data.agents.networks.actor_critic import MOVES
from remqa_data.agents.networks.imitation import DEEDS, SEEN, Chosen, Eye, Lead, led

WIDTH, HEADS, LAYERS = 96, 4, 3
VIEWS = 12
"""A view sees so many in each layer, itself among them."""
MOST_WORDS = 40
"""Of a question; what comes after is not read."""


class Reading(NamedTuple):
    """n questions that were read.

    Attributes
    ----------
    known : LAYERS of (n, w, 2 WIDTH)
        Keys and values of the words, which views attend to.
    is_word : (n, w) bool
    names : (n, NAMED, 1 + types)
        See `Eye.names`.
    """

    known: tuple[Tensor, ...]
    is_word: Tensor
    names: Tensor


class Attended(NamedTuple):
    """What n walks are to do in t steps.

    Attributes
    ----------
    moves : (t, n, moves)
        Logits.
    deeds : (t, n, DEEDS)
        Logits of what is to be done to the target now.
    known : LAYERS of (n, v, 2 WIDTH)
        Keys and values of the last views.
    """

    moves: Tensor
    deeds: Tensor
    known: tuple[Tensor, ...]


class Block(nn.Module):
    """A layer: attention to what is known already and to each other, then two linear maps."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.second = nn.LayerNorm(WIDTH), nn.LayerNorm(WIDTH)
        self.project, self.join = nn.Linear(WIDTH, 3 * WIDTH), nn.Linear(WIDTH, WIDTH)
        self.after = nn.Sequential(nn.Linear(WIDTH, 2 * WIDTH), nn.GELU(), nn.Linear(2 * WIDTH, WIDTH))

    def forward(self, tokens: Tensor, known: Tensor, bias: Tensor) -> tuple[Tensor, Tensor]:
        """New tokens, and their keys and values.

        Parameters
        ----------
        tokens : (n, t, WIDTH)
        known : (n, k, 2 WIDTH)
            Keys and values of what came before.
        bias : broadcast to (n, HEADS, t, k + t)
            Added to how well queries and keys agree; minus infinity where a token may not look.
        """
        query, own = self.project(self.first(tokens)).split((WIDTH, 2 * WIDTH), 2)
        key, value = torch.cat([known, own], 1).chunk(2, 2)
        query, key, value = (part.unflatten(2, (HEADS, -1)).transpose(1, 2) for part in (query, key, value))
        weights = (query @ key.transpose(2, 3) / (WIDTH / HEADS) ** 0.5 + bias).softmax(3)
        tokens = tokens + self.join((weights @ value).transpose(1, 2).flatten(2))
        return tokens + self.after(self.second(tokens)), own


class ViewTransformer(nn.Module):
    """Walks, and says what to do in the end.

    Parameters
    ----------
    words : int
        Size of the vocabulary.
    types : int
        How many types of objects the view encoder knows.
    """

    def __init__(self, words: int, types: int) -> None:
        super().__init__()
        self.embedding = nn.Embedding(words, WIDTH, padding_idx=0)
        self.places = nn.Parameter(torch.randn(MOST_WORDS, WIDTH) * 0.02)
        self.eye = Eye(WIDTH, types)
        self.view = nn.Linear(SEEN + len(MOVES) + 1, WIDTH)
        self.blocks = nn.ModuleList(Block() for _ in range(LAYERS))
        self.ago = nn.Parameter(torch.zeros(HEADS, VIEWS))
        self.last = nn.LayerNorm(WIDTH)
        self.policy, self.deed = nn.Linear(WIDTH, len(MOVES)), nn.Linear(WIDTH, len(DEEDS))

    def read(self, numbers: Tensor) -> Reading:
        """Read (n, w) int64 numbers of words, 0 after the end of each sentence."""
        numbers = numbers[:, :MOST_WORDS]
        is_word = numbers > 0
        tokens = self.embedding(numbers) + self.places[: numbers.shape[1]]
        bias = _unseen(is_word)[:, None, None]
        known = []
        for block in self.blocks:
            tokens, own = block(tokens, tokens.new_zeros(len(tokens), 0, 2 * WIDTH), bias)
            known.append(own)
        sentence = (tokens * is_word[..., None]).sum(1) / is_word.sum(1, keepdim=True).clamp(min=1)
        return Reading(tuple(known), is_word, self.eye.names(sentence))

    def forward(
        self, shown: Tensor, before: Tensor, reading: Reading, known: Sequence[Tensor] | None = None
    ) -> Attended:
        """Some steps of some walks.

        Parameters
        ----------
        shown : (t, n, SEEN)
            What the eye sees.
        before : (t, n, moves + 1)
            The last moves; see `remqa_data.agents.networks.actor_critic.Seen`.
        reading : Reading
        known : LAYERS of (n, v, 2 WIDTH), optional
            Of the views before these; see `Attended`.
        """
        tokens = self.view(torch.cat([shown, before], 2)).transpose(0, 1)
        if known is None:
            known = [tokens.new_zeros(len(tokens), 0, 2 * WIDTH)] * LAYERS
        bias = self._bias(tokens.shape[1], known[0].shape[1], reading.is_word)
        kept = []
        for block, words, views in zip(self.blocks, reading.known, known, strict=True):
            tokens, own = block(tokens, torch.cat([words, views], 1), bias)
            kept.append(torch.cat([views, own], 1)[:, 1 - VIEWS :])
        said = self.last(tokens).transpose(0, 1)
        return Attended(self.policy(said), self.deed(said), tuple(kept))

    def _bias(self, steps: int, past: int, is_word: Tensor) -> Tensor:
        """(n, HEADS, steps, words + past + steps) where views look."""
        ago = past + torch.arange(steps)[:, None] - torch.arange(past + steps)[None]
        is_seen = ((ago >= 0) & (ago < VIEWS)).to(is_word.device)
        views = self.ago[:, ago.clamp(0, VIEWS - 1)] + _unseen(is_seen)
        words = _unseen(is_word)[:, None, None].expand(-1, HEADS, steps, -1)
        return torch.cat([words, views[None].expand(len(is_word), -1, -1, -1)], 3)


def _unseen(is_seen: Tensor) -> Tensor:
    """0 where something is seen, minus infinity elsewhere."""
    return torch.zeros(is_seen.shape, device=is_seen.device).masked_fill(~is_seen, -torch.inf)


class AttentiveWalk:
    """Some walks of one network, from their beginning; see `remqa_data.agents.networks.imitation.ImitatorWalk`.

    Parameters
    ----------
    model : ViewTransformer
    numbers : (n, w) int64
        Words of the questions.
    """

    def __init__(self, model: ViewTransformer, numbers: Tensor) -> None:
        self.model = model
        with torch.no_grad():
            self._reading = model.read(numbers)
        self._known: tuple[Tensor, ...] | None = None
        self.deeds = torch.zeros(len(numbers), len(DEEDS), device=numbers.device)

    @torch.no_grad()
    def move(self, features: Tensor, before: Tensor, draws: Tensor, lead: Lead | None = None) -> Chosen:
        """What comes out for the last view; `deeds` has the logits of what is to be done there."""
        shown = self.model.eye(features, self._reading.names)
        said: Attended = self.model(shown[None], before[None], self._reading, self._known)
        self._known, self.deeds = said.known, said.deeds[0]
        moves = led(said.moves[0], draws[:, 1], lead)
        return Chosen(moves, torch.ones_like(moves, dtype=torch.bool))
