"""How an actor-critic goes on learning while it walks (SAVN, Wortsman et al. 2019): by steps down a loss that it has learnt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import torch
from torch import Tensor
from torch.func import functional_call

from remqa_data.agents.networks.actor_critic import MOVES, ActorCritic, Seen, Thought

AT_ONCE, MOST_ADAPTED = 6, 4
"""Every so many steps it learns from those, so many times."""
RATE = 0.001
"""Of a step down the loss."""

Weights = dict[str, Tensor]


class AdaptiveWalk:
    """Some walks that one network begins; each changes its own copy of the weights. See `actor_critic.PlainWalk`.

    Parameters
    ----------
    model : ActorCritic
        Of the form "savn".
    walks : int
        How many.
    """

    def __init__(self, model: ActorCritic, walks: int) -> None:
        self.model = model
        self._each = [_Walk(adaptive_weights(model), model.rest(1)) for _ in range(walks)]

    def think(self, features: Tensor, asked: Tensor, before: Tensor, is_going: Tensor | None = None) -> Tensor:
        """See `PlainWalk.think`."""
        logits = features.new_zeros(len(self._each), len(MOVES))
        for place, walk in enumerate(self._each):
            if is_going is None or is_going[place]:
                here = slice(place, place + 1)
                logits[place] = walk.think(self.model, Seen(features[None, here], asked[here], before[None, here]))[0]
        return logits


@dataclass
class _Walk:
    """One walk: its weights, the state of its LSTM at the last correction, and what it has seen since."""

    weights: Weights
    memory: tuple[Tensor, Tensor]
    since: list[Seen] = field(default_factory=list)
    corrections: int = 0

    def think(self, model: ActorCritic, seen: Seen) -> Tensor:
        """(1, moves) logits of the next move."""
        if len(self.since) == AT_ONCE:
            self._correct(model)
        self.since.append(seen)
        with torch.no_grad():
            return self._thought(model).moves[-1]

    def _correct(self, model: ActorCritic) -> None:
        with torch.enable_grad():
            thought = self._thought(model)
            if self.corrections < MOST_ADAPTED:
                self.weights = adapted(model, self.weights, thought)
                self.corrections += 1
        self.memory = thought.memory[0].detach(), thought.memory[1].detach()
        self.since = []

    def _thought(self, model: ActorCritic) -> Thought:
        steps = Seen(
            torch.cat([seen.features for seen in self.since]),
            self.since[0].asked,
            torch.cat([seen.before for seen in self.since]),
        )
        thought: Thought = functional_call(model, self.weights, (steps, self.memory))
        return thought


def adaptive_weights(model: ActorCritic) -> Weights:
    """The weights that are corrected: all that are learnt but those of the loss."""
    return {
        name: weight
        for name, weight in model.named_parameters()
        if weight.requires_grad and not name.startswith("loss.")
    }


def adapted(
    model: ActorCritic, weights: Mapping[str, Tensor], thought: Thought, *, is_learning: bool = False
) -> Weights:
    """Weights after a step down the learnt loss of what one walk thought in its last steps.

    Parameters
    ----------
    weights : mapping of str to Tensor
        See `adaptive_weights`; the thought is theirs.
    thought : Thought
        Of one walk.
    is_learning : bool
        Whether gradients are to go through the step.
    """
    loss = model.loss(thought.hidden[:, 0], thought.moves[:, 0].softmax(1))
    slopes = torch.autograd.grad(loss, list(weights.values()), create_graph=is_learning, allow_unused=True)
    moved = {
        name: weight if slope is None else weight - RATE * slope
        for (name, weight), slope in zip(weights.items(), slopes, strict=True)
    }
    return moved if is_learning else {name: weight.detach().requires_grad_() for name, weight in moved.items()}
