"""Learning to walk by reward: a synchronous advantage actor-critic on cached views (Mnih et al. 2016).

A sample is a walk to a target from somewhere in a room; a batch of walks is made with the network as it is, and learnt from
once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.actor_critic import (
    MOVES,
    ActorCritic,
    Form,
    PlainWalk,
    Seen,
    Thinker,
    Thought,
    drawn,
    told,
)
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.training.cached_walks import (
    NOT_THERE,
    Walks,
    check_features,
    learning_errands,
)
from remqa_data.agents.training.pictures import detector_types
from remqa_data.agents.training.relations import near_counts
from remqa_data.metrics import spl

MOST_STEPS = 50
FARTHEST = 50
"""Actions from where a walk begins to its target, at most; small figures come as often as large ones."""

REACHED, STEP, NEARER, MISTAKEN = 5.0, -0.01, 0.1, -1.0
"""Rewards: at the target and sure of it, for each action, for each action that is less to go then, and for stopping elsewhere.
The first two are those of Wortsman et al.; the third (as Savva et al. 2019 have it) makes a million steps do."""
DISCOUNT, SMOOTHED = 0.99, 0.95
"""Of later rewards; of the advantages of later steps (Schulman et al. 2016)."""
VALUE_WEIGHT, ENTROPY_WEIGHT = 0.05, 0.01
"""Rewards of 5 make the value's errors large: with the usual 0.5 they undo what the policy has learnt in the LSTM of both."""


class Rollout(NamedTuple):
    """n walks of at most t steps.

    Attributes
    ----------
    features : (t, n, PARTS^2, CHANNELS)
    asked : (n, 2) int64
    before : (t, n, moves + 1)
    moves : (t, n) int64
    rewards : (t, n)
    is_going : (t, n) bool
        Whether the walk was not over before that step.
    is_done : (n,) bool
        Whether the agent has ended it.
    """

    features: Tensor
    asked: Tensor
    before: Tensor
    moves: Tensor
    rewards: Tensor
    is_going: Tensor
    is_done: Tensor


class ReinforcingTask:
    """An actor-critic learns to walk; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the questions of the first one are walked to.
    views : path
        The cache of the first one, with features.
    form : str
        Which actor-critic.
    encoder : ViewEncoder
        Trained: that of the cache's features.
    walks : int
        Of an epoch.
    device : str
        Where to compute.
    """

    def __init__(
        self, roots: Sequence[Path], views: Path, form: Form, encoder: ViewEncoder, walks: int, device: str = "cpu"
    ) -> None:
        self._epoch = walks
        self.errands, self._val = learning_errands(roots[0], views, roots)
        check_features(encoder, self.errands[0])
        self.model = ActorCritic(len(detector_types()), form)
        self.model.know(encoder)
        if form == "scene_priors":
            self.model.graph.learn_relations(torch.from_numpy(near_counts(roots, detector_types())))
        self.device = device

    def __len__(self) -> int:
        return self._epoch

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> Rollout:
        """Walks with the network as it is, one drawn with each generator."""
        chosen = [self.errands[int(rng.integers(len(self.errands)))] for rng in rngs]
        starts = [errand.some_start(rng, FARTHEST) for errand, rng in zip(chosen, rngs, strict=True)]
        return rollout(self.walk(len(rngs)), Walks(chosen, starts), rngs, self.device)

    def walk(self, walks: int) -> Thinker:
        """Begin some walks of the network."""
        return PlainWalk(self.model, walks)

    def losses(self, batch: Rollout) -> Mapping[str, Tensor]:
        """The policy's by advantages, the value's, and entropy."""
        memory = self.model.rest(len(batch.asked))
        seen = Seen(batch.features, batch.asked, batch.before, batch.is_going)
        return actor_critic_losses(self.model(seen, memory), batch)

    def score(self) -> Mapping[str, float]:
        """Success and SPL within MOST_STEPS from where the episodes of val rooms begin, and steps."""
        if not self._val:
            return {}
        walks = Walks(self._val, [errand.start for errand in self._val])
        rngs = [np.random.default_rng([0, place]) for place in range(len(walks))]
        made = rollout(self.walk(len(walks)), walks, rngs, self.device)
        ways = np.array([errand.task.path_length_m for errand in self._val])
        return {
            "val_success": float(walks.succeeded.mean()),
            "val_spl": float(spl(walks.succeeded, ways, walks.moved_m).mean()),
            "val_steps": float(made.is_going.sum(0).float().mean()),
        }


def rollout(thinker: Thinker, walks: Walks, rngs: Sequence[np.random.Generator], device: str = "cpu") -> Rollout:
    """Let a network walk to the end of all walks, MOST_STEPS at most."""
    asked = torch.tensor([errand.types for errand in walks.errands], device=device)
    before = torch.zeros(len(walks), len(MOVES) + 1, device=device)
    steps = []
    distances = walks.distances()
    for _ in range(MOST_STEPS):
        is_going = ~walks.is_over
        if not is_going.any():
            break
        features, going = (torch.from_numpy(part).to(device) for part in (walks.features(), is_going))
        logits = thinker.think(features, asked, before, going)
        draws = torch.tensor([rng.random() for rng in rngs], device=device)
        moves = drawn(logits, draws)
        was_done = walks.step(moves.numpy(force=True))
        now = walks.distances()
        known = (distances != NOT_THERE) & (now != NOT_THERE)
        earned = STEP + NEARER * np.where(known, distances - now, 0)
        earned += np.where(walks.succeeded, REACHED, MISTAKEN) * (walks.is_over & is_going)
        distances = now
        rewards = torch.from_numpy(earned * is_going).float().to(device)
        steps.append((features, before, moves, rewards, going))
        before = told(moves, torch.from_numpy(was_done).to(device))
    views, befores, done, earnings, goings = (torch.stack(part) for part in zip(*steps, strict=True))
    return Rollout(views, asked, befores, done, earnings, goings, torch.from_numpy(walks.is_over).to(device))


def actor_critic_losses(thoughts: Thought, batch: Rollout) -> dict[str, Tensor]:
    """Losses of walks, means over their steps."""
    going = batch.is_going.float()
    with torch.no_grad():
        advantages = advantages_of(batch.rewards, thoughts.values, batch.is_going, batch.is_done)
        returns = advantages + thoughts.values
        counted = advantages[batch.is_going]
        mean = counted.mean()
        spread = counted.std().clamp(min=1e-3) if len(counted) > 1 else torch.ones_like(mean)
    log_moves = thoughts.moves.log_softmax(2)
    chosen = log_moves.gather(2, batch.moves[..., None])[..., 0]
    steps = going.sum()
    policy = -(chosen * (advantages - mean) / spread * going).sum() / steps
    value = (functional.mse_loss(thoughts.values, returns, reduction="none") * going).sum() / steps
    entropy = -((log_moves.exp() * log_moves).sum(2) * going).sum() / steps
    rewards = batch.rewards.sum(0).mean()
    loss = policy + VALUE_WEIGHT * value - ENTROPY_WEIGHT * entropy
    return {"loss": loss, "policy": policy, "value": value, "entropy": entropy, "rewards": rewards}


def advantages_of(rewards: Tensor, values: Tensor, is_going: Tensor, is_done: Tensor) -> Tensor:
    """(t, n) generalised advantages (Schulman et al. 2016).

    Parameters
    ----------
    rewards, values : (t, n)
    is_going : (t, n) bool
        Whether a walk was not over before a step.
    is_done : (n,) bool
        Whether the agent has ended it; one that ran out of steps would have gone on, which its last value stands for.
    """
    advantages = torch.zeros_like(rewards)
    after = torch.where(is_done, torch.zeros_like(values[-1]), values[-1])
    later = torch.zeros_like(after)
    for step in range(len(rewards) - 1, -1, -1):
        going = is_going[step]
        found = rewards[step] + DISCOUNT * after - values[step]
        later = torch.where(going, found + DISCOUNT * SMOOTHED * later, torch.zeros_like(later))
        after = torch.where(going, values[step], after)
        advantages[step] = later
    return advantages
