"""Target-driven actor-critics: what to do next, and how much will come of it, by what is seen and what is looked for.

`a3c` (Zhu et al. 2017; Mnih et al. 2016): view and target in one space, an LSTM, a policy and a value. `scene_priors` (Yang et
al. 2019) adds a graph convolution over which types of objects lie near each other in the rooms that were learnt from. `savn`
(Wortsman et al. 2019) adds a loss that is itself learnt, by which the policy goes on learning while it walks.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, Protocol

import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.view_encoder import PARTS, ViewEncoder

Form = Literal["a3c", "scene_priors", "savn"]

MOVES = ("MoveAhead", "RotateLeft", "RotateRight", "LookUp", "LookDown", "Done")
"""What it can do (Wortsman et al. 2019)."""
DONE = MOVES.index("Done")

NARROW = 24
"""Numbers kept of each part of a view."""
HIDDEN = 128
"""Of the LSTM."""
EMBEDDED = 32
"""Of a type that is asked for."""
GRAPH = 16
"""Of a type in the graph."""


class Seen(NamedTuple):
    """What n walks have before them in t steps.

    Attributes
    ----------
    features : (t, n, PARTS^2, CHANNELS)
        Of their views.
    asked : (n, 2) int64
        Types that are looked for, and that those are told by, from 1; 0 for none.
    before : (t, n, moves + 1)
        The last move, 1 at its place; at the last place whether it was refused. All 0 at first.
    is_going : (t, n) bool, optional
        Which walks are not over yet; what the others see is not looked at, and what is thought of them means nothing.
    """

    features: Tensor
    asked: Tensor
    before: Tensor
    is_going: Tensor | None = None


class Thought(NamedTuple):
    """What n walks are to do in t steps.

    Attributes
    ----------
    moves : (t, n, moves)
        Logits.
    values : (t, n)
        What will come of it.
    hidden : (t, n, HIDDEN)
        What the LSTM says.
    memory : (n, HIDDEN), (n, HIDDEN)
        State of the LSTM at the end.
    """

    moves: Tensor
    values: Tensor
    hidden: Tensor
    memory: tuple[Tensor, Tensor]


class ActorCritic(nn.Module):
    """Walks.

    Parameters
    ----------
    types : int
        How many types of objects the view encoder knows.
    form : {"a3c", "scene_priors", "savn"}
    """

    def __init__(self, types: int, form: Form) -> None:
        super().__init__()
        self.types, self.form = types, form
        self.shares = nn.Linear(CHANNELS, 1 + types).requires_grad_(False)
        self.parts = nn.Linear(CHANNELS, NARROW)
        self.view = nn.Linear((NARROW + 2) * PARTS**2, HIDDEN)
        self.embedding = nn.Embedding(1 + types, EMBEDDED, padding_idx=0)
        joint = HIDDEN + 2 * EMBEDDED + len(MOVES) + 1
        if form == "scene_priors":
            self.graph = KnowledgeGraph(types)
            joint += types
        self.lstm = nn.LSTMCell(joint, HIDDEN)
        self.policy = nn.Linear(HIDDEN, len(MOVES))
        self.value = nn.Linear(HIDDEN, 1)
        if form == "savn":
            self.loss = LearnedLoss()
        with torch.no_grad():
            self.policy.weight.mul_(0.1)
            self.policy.bias[DONE] = -2.0  # who stops at once sees nothing

    def know(self, encoder: ViewEncoder) -> None:
        """Take over what a trained view encoder knows of types."""
        self.shares.load_state_dict(encoder.shares.state_dict())

    def rest(self, walks: int) -> tuple[Tensor, Tensor]:
        """The LSTM's state at first."""
        zeros = self.policy.weight.new_zeros(walks, HIDDEN)
        return zeros, zeros

    def forward(self, seen: Seen, memory: tuple[Tensor, Tensor]) -> Thought:
        """Some steps of some walks, upon the LSTM's state before them."""
        hidden = []
        for step in self.look(seen):
            memory = self.lstm(step, memory)
            hidden.append(memory[0])
        said = torch.stack(hidden)
        return Thought(self.policy(said), self.value(said)[..., 0], said, memory)

    def look(self, seen: Seen) -> Tensor:
        """(t, n, ...) what the views and the targets are in one space; 0 where a walk is over."""
        steps, walks = seen.before.shape[:2]
        asked, features, before = seen.asked.repeat(steps, 1), seen.features.flatten(0, 1), seen.before.flatten(0, 1)
        if seen.is_going is not None:
            is_going = seen.is_going.flatten()
            joint = self._joint(features[is_going], asked[is_going], before[is_going])
            return (
                joint.new_zeros(steps * walks, joint.shape[1])
                .masked_scatter(is_going[:, None], joint)
                .view(steps, walks, -1)
            )
        return self._joint(features, asked, before).view(steps, walks, -1)

    def _joint(self, features: Tensor, asked: Tensor, before: Tensor) -> Tensor:
        shown = self.shares(features).softmax(2)
        wanted = shown.gather(2, asked[:, None].expand(-1, shown.shape[1], -1)) * (asked > 0)[:, None]
        parts = torch.cat([functional.relu(self.parts(features)), wanted], 2)
        joint = [functional.relu(self.view(parts.flatten(1))), self.embedding(asked).flatten(1)]
        if self.form == "scene_priors":
            joint.append(self.graph(shown[:, :, 1:].amax(1), asked[:, 0]))
        return torch.cat([*joint, before], 1)


class Thinker(Protocol):
    """Some walks of a network; see `PlainWalk`."""

    def think(self, features: Tensor, asked: Tensor, before: Tensor, is_going: Tensor | None = None) -> Tensor:
        """(n, moves) logits of what to do next."""


class PlainWalk:
    """Some walks of one network, from their beginning.

    Parameters
    ----------
    model : ActorCritic
    walks : int
        How many.
    """

    def __init__(self, model: ActorCritic, walks: int) -> None:
        self.model, self._memory = model, model.rest(walks)

    @torch.no_grad()
    def think(self, features: Tensor, asked: Tensor, before: Tensor, is_going: Tensor | None = None) -> Tensor:
        """(n, moves) logits of what to do next; the parameters are those of `Seen`, of one step."""
        going = None if is_going is None else is_going[None]
        thought: Thought = self.model(Seen(features[None], asked, before[None], going), self._memory)
        self._memory = thought.memory
        return thought.moves[0]


class KnowledgeGraph(nn.Module):
    """Three graph convolutions (Kipf and Welling 2017) over types of objects that lie near each other.

    The last one's numbers are as they come: where a type has a single number, a ReLU over it is 0 everywhere with about
    half of all seeds, from the first step on, and nothing before it ever learns.

    Parameters
    ----------
    types : int
        How many there are.
    """

    near: Tensor

    def __init__(self, types: int) -> None:
        super().__init__()
        self.register_buffer("near", torch.eye(types))
        self.names = nn.Parameter(torch.randn(types, GRAPH) * 0.1)
        self.first = nn.Linear(GRAPH + 2, GRAPH)
        self.second = nn.Linear(GRAPH, GRAPH)
        self.third = nn.Linear(GRAPH, 1)

    def learn_relations(self, counts: Tensor) -> None:
        """Join types by (types, types) counts of how often they lie near each other: each row and column weighs alike."""
        joined = (counts > 0).to(self.near.dtype)
        joined = torch.maximum(joined, joined.T) + torch.eye(len(joined))
        scale = joined.sum(1).rsqrt()
        self.near.copy_(joined.clamp(max=1) * scale[:, None] * scale[None])

    def forward(self, seen: Tensor, asked: Tensor) -> Tensor:
        """(n, types) what the graph says where (n, types) are seen and (n,) types, from 1, are asked for."""
        wanted = functional.one_hot(asked, len(self.near) + 1)[:, 1:].to(seen.dtype)
        names = self.names[:, None].expand(-1, len(seen), -1)
        nodes = torch.cat([names, seen.T[..., None], wanted.T[..., None]], 2)  # types first: one product for all n
        for layer in (self.first, self.second):
            nodes = functional.relu((self.near @ layer(nodes).flatten(1)).view(*nodes.shape[:2], GRAPH))
        return (self.near @ self.third(nodes)[..., 0]).T


class LearnedLoss(nn.Module):
    """How wrong the last moves were, judged by the policy and its memory alone: convolutions along time."""

    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Conv1d(HIDDEN + len(MOVES), 10, 1)
        self.second = nn.Conv1d(10, 1, 3)

    def forward(self, hidden: Tensor, probabilities: Tensor) -> Tensor:
        """A number for t >= 3 steps with (t, HIDDEN) states of the LSTM and (t, moves) probabilities."""
        said = self.second(functional.relu(self.first(torch.cat([hidden, probabilities], 1).T[None])))
        return torch.linalg.vector_norm(said)


def drawn(logits: Tensor, draws: Tensor) -> Tensor:
    """(n,) moves by (n, moves) logits and (n,) numbers from 0 to 1."""
    return (logits.softmax(1).cumsum(1) <= draws[:, None]).sum(1).clamp(max=logits.shape[1] - 1)


def told(moves: Tensor, was_done: Tensor) -> Tensor:
    """(n, moves + 1) what is known of the last of (n,) moves and whether each was done; see `Seen`."""
    known = functional.one_hot(moves, len(MOVES) + 1).float()
    known[:, -1] = (~was_done).float()
    return known
