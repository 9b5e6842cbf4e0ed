"""Navigation by a policy that has learnt to walk to types of objects by reward: A3C, Scene Priors, SAVN. It has no map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question, asked_types
from remqa_data.agents.networks.actor_critic import DONE, MOVES, ActorCritic, PlainWalk, Thinker, drawn, told
from remqa_data.agents.networks.adaptation import AdaptiveWalk
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.parts.interfaces import Percept


@dataclass(frozen=True, eq=False)
class PolicyNavigator:
    """Draws what to do next from what the policy says of the view; it does not look at what the walk has left.

    Attributes
    ----------
    policy : ActorCritic
        Trained.
    encoder : ViewEncoder
        That through which it has learnt to see.
    types : tuple of str
        What that knows.
    """

    policy: ActorCritic
    encoder: ViewEncoder
    types: tuple[str, ...]

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> PolicyWalker:
        """Begin an episode; each move is drawn."""
        walk = AdaptiveWalk(self.policy, 1) if self.policy.form == "savn" else PlainWalk(self.policy, 1)
        return PolicyWalker(self.encoder, walk, asked_types(asked, self.types), rng)


class PolicyWalker:
    """Walks in one episode; see `PolicyNavigator`."""

    def __init__(self, encoder: ViewEncoder, walk: Thinker, types: tuple[int, int], rng: np.random.Generator) -> None:
        self._encoder, self._walk, self._rng = encoder, walk, rng
        self._asked = torch.tensor([types])
        self._last: int | None = None

    def next_action(self, percept: Percept) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Walker`."""
        before = torch.zeros(1, len(MOVES) + 1)
        if self._last is not None:
            before = told(torch.tensor([self._last]), torch.tensor([percept.succeeded]))
        with one_thread():
            features = self._encoder.encode(percept.rgb[None])
            logits = self._walk.think(features, self._asked, before)
        self._last = int(drawn(logits, torch.tensor([self._rng.random()])))
        return None if self._last == DONE else MOVES[self._last]
