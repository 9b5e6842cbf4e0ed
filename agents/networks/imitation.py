"""What those who learn to walk by imitation have in common: an eye for what a question names, and moves that may be led."""

from __future__ import annotations

from typing import Literal, NamedTuple, Protocol

import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.actor_critic import DONE, MOVES, drawn
from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.view_encoder import PARTS, ViewEncoder
from remqa_data.catalog import Manipulation

ImitatorForm = Literal["planner_controller", "transformer", "spatial_memory"]

DEEDS: tuple[Manipulation | None, ...] = (None, "Open", "Move", "Pickup")
"""What is done in the end; nothing where it is not there yet."""

SHARPNESS, DOUBT = 1.5, 1.0
"""Who walks alone multiplies logits by the one, so that likelier moves are preferred, and before takes the other from that of
stopping, which cannot be taken back; of 1, 1.5, 2.5 and 5, and of 0, 1, 1.5, 2 and 3, these did best in val rooms."""
DRAWS = 2
"""Numbers from 0 to 1 that a move takes."""
NARROW = 24
"""Numbers kept of each part of a view."""
NAMED = 2
"""Types of objects that a question names: where to look, and what tells that from others of its type."""
SEEN = 128
"""Numbers of a view."""


class Asking(NamedTuple):
    """n questions that were read.

    Attributes
    ----------
    sentence : (n, read)
    names : (n, NAMED, 1 + types)
        See `Eye.names`.
    """

    sentence: Tensor
    names: Tensor


class Eye(nn.Module):
    """What views show, and where in them what is looked for is.

    Parameters
    ----------
    read : int
        Numbers of a question that was read.
    types : int
        How many types of objects the view encoder knows.
    """

    def __init__(self, read: int, types: int) -> None:
        super().__init__()
        self.shares = nn.Linear(CHANNELS, 1 + types).requires_grad_(False)
        self.naming = nn.Linear(read, NAMED * (1 + types))
        self.parts = nn.Linear(CHANNELS, NARROW)
        self.view = nn.Linear((NARROW + NAMED) * PARTS**2, SEEN)

    def know(self, encoder: ViewEncoder) -> None:
        """Take over what a trained view encoder knows of types."""
        self.shares.load_state_dict(encoder.shares.state_dict())

    def names(self, question: Tensor) -> Tensor:
        """(n, NAMED, 1 + types) logits of the types that (n, read) questions name; 0 is none."""
        return self.naming(question).unflatten(1, (NAMED, -1))  # type: ignore[no-any-return]

    def ask(self, question: Tensor) -> Asking:
        """(n, read) questions, and what they name."""
        return Asking(question, self.names(question))

    def forward(self, features: Tensor, names: Tensor) -> Tensor:
        """(v, SEEN) of (v, PARTS^2, CHANNELS) features of views, by (v, NAMED, 1 + types) `names` of what is looked for."""
        shown = self.shares(features).softmax(2)
        wanted = shown[..., 1:] @ names.softmax(2)[..., 1:].transpose(1, 2)
        parts = torch.cat([functional.relu(self.parts(features)), wanted], 2)
        return functional.relu(self.view(parts.flatten(1)))

    def along(self, features: Tensor, names: Tensor, is_seen: Tensor) -> Tensor:
        """(t, n, SEEN) of the views of n walks in t steps; 0 where nothing is seen.

        Parameters
        ----------
        features : (v, PARTS^2, CHANNELS)
            Of the views that there are, step by step.
        names : (n, NAMED, 1 + types)
            What each walk looks for.
        is_seen : (t, n) bool
            Which steps of which walks have a view.
        """
        shown = features.new_zeros(*is_seen.shape, SEEN)
        shown[is_seen] = self(features, names[is_seen.nonzero()[:, 1]]).to(shown.dtype)
        return shown


class Lead(NamedTuple):
    """What the next moves should be, and who is made to do one of these.

    Attributes
    ----------
    best : (n, moves) bool
        Moves of the shortest ways.
    is_led : (n,) bool
    """

    best: Tensor
    is_led: Tensor


class Chosen(NamedTuple):
    """What n walks do next.

    Attributes
    ----------
    moves : (n,) int64
    is_planned : (n,) bool
        Whether a move was decided on, and not repeated.
    """

    moves: Tensor
    is_planned: Tensor


class ImitatorWalk(Protocol):
    """Some walks of a network, from their beginning."""

    def move(self, features: Tensor, before: Tensor, draws: Tensor, lead: Lead | None = None) -> Chosen:
        """What to do next.

        Parameters
        ----------
        features : (n, PARTS^2, CHANNELS)
            Of what is seen.
        before : (n, moves + 1)
            The last moves; see `remqa_data.agents.networks.actor_critic.Seen`.
        draws : (n, DRAWS)
            From 0 to 1.
        lead : Lead, optional
            For who is led.
        """


def led(own: Tensor, draws: Tensor, lead: Lead | None) -> Tensor:
    """(n,) moves: by (n, moves) own logits; of who is led, one of the best, if there is any."""
    if lead is None:
        stops = functional.one_hot(torch.tensor(DONE, device=own.device), len(MOVES))
        return drawn(SHARPNESS * (own - DOUBT * stops), draws)
    moves = drawn(own, draws)
    is_led = lead.is_led & lead.best.any(1)
    return torch.where(is_led, drawn(torch.where(lead.best, 0.0, -1e3), draws), moves)
