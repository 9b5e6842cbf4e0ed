"""Learning to learn while walking (SAVN, Wortsman et al. 2019): an actor-critic and the loss by which it corrects itself.

Every few steps the agent takes a step down its own learnt loss, which needs no reward. Training follows these steps, so that
weights and loss become such that they help (as in Finn et al. 2017): gradients go through gradients.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from torch import Tensor
from torch.func import functional_call

from remqa_data.agents.networks.actor_critic import ActorCritic, Seen, Thought
from remqa_data.agents.networks.adaptation import AT_ONCE, MOST_ADAPTED, AdaptiveWalk, adapted, adaptive_weights
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.training.reinforcing import ReinforcingTask, Rollout, actor_critic_losses
from remqa_data.errors import ConfigError

OF_STEPS = Thought._fields[:3]
"""What is thought at each step."""


class AdaptingTask(ReinforcingTask):
    """SAVN learns; see `remqa_data.agents.training.trainer.Task`, and `ReinforcingTask` for parameters.

    Parameters
    ----------
    before : ActorCritic
        A trained one, whose weights it begins with.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        views: Path,
        before: ActorCritic,
        encoder: ViewEncoder,
        walks: int,
        device: str = "cpu",
    ) -> None:
        if before.form not in ("a3c", "savn"):
            raise ConfigError(
                f"begins_with: a network of the form {before.form!r} has other weights than one that adapts"
            )
        super().__init__(roots, views, "savn", encoder, walks, device)
        self.model.load_state_dict(before.state_dict() | self._of_loss())

    def walk(self, walks: int) -> AdaptiveWalk:
        """Begin some walks, which adapt."""
        return AdaptiveWalk(self.model, walks)

    def losses(self, batch: Rollout) -> Mapping[str, Tensor]:
        """Those of the actor-critic, as it has corrected itself on its way."""
        thoughts = [self._thought_again(batch, walk) for walk in range(len(batch.asked))]
        moves, values, hidden = (torch.cat([getattr(one, name) for one in thoughts], 1) for name in OF_STEPS)
        return actor_critic_losses(Thought(moves, values, hidden, thoughts[0].memory), batch)

    def _of_loss(self) -> dict[str, Tensor]:
        return {name: tensor for name, tensor in self.model.state_dict().items() if name.startswith("loss.")}

    def _thought_again(self, batch: Rollout, walk: int) -> Thought:
        """What it thinks along one walk, with gradients through the corrections; after its end, zeros."""
        weights, memory = adaptive_weights(self.model), self.model.rest(1)
        found: list[Thought] = []
        here, steps_walked = slice(walk, walk + 1), int(batch.is_going[:, walk].sum())
        for first in range(0, steps_walked, AT_ONCE):
            steps = slice(first, first + AT_ONCE)
            seen = Seen(batch.features[steps, here], batch.asked[here], batch.before[steps, here])
            found.append(functional_call(self.model, weights, (seen, memory)))
            memory = found[-1].memory
            if len(found) <= MOST_ADAPTED and bool(batch.is_going[steps, walk].all()) and len(seen.before) == AT_ONCE:
                weights = adapted(self.model, weights, found[-1], is_learning=True)
        moves, values, hidden = (_padded([getattr(one, name) for one in found], len(batch.moves)) for name in OF_STEPS)
        return Thought(moves, values, hidden, memory)


def _padded(parts: Sequence[Tensor], steps: int) -> Tensor:
    """(steps, ...) successive parts, then zeros."""
    said = torch.cat(list(parts))
    return torch.cat([said, said.new_zeros(steps - len(said), *said.shape[1:])])
