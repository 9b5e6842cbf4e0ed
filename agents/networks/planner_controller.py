"""PACMAN, a planner and a controller (Das et al. 2018, "Embodied Question Answering"), and who answers from its last views.

The planner, a recurrent network on view, question and last move, chooses a move. The controller says after each step whether
it is repeated or the planner is asked again, so that the planner remembers few decisions and not many steps. The answer comes
from the last views of the walk, each weighed by how well it goes with the question.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.actor_critic import MOVES
from remqa_data.agents.networks.imitation import SEEN, Asking, Chosen, Eye, Lead, led
from remqa_data.agents.networks.language import HIDDEN as READ
from remqa_data.agents.networks.language import WordReader

HIDDEN = 128
"""Of the planner."""
JUDGED = 64
"""Of the controller's hidden layer, and of what questions and views are compared by."""
MOST_REPEATS = 5
"""So many times a move is done before the planner is asked again in any case."""
LAST_VIEWS = 5
"""The answer comes from so many."""


class Planned(NamedTuple):
    """What n walks are to do in t steps.

    Attributes
    ----------
    moves : (t, n, moves)
        The planner's logits, if it is asked.
    goes_on : (t, n)
        The controller's logits that the last move is repeated.
    """

    moves: Tensor
    goes_on: Tensor


class PlannerController(nn.Module):
    """Walks, and answers.

    Parameters
    ----------
    words, answers : int
        Sizes of the vocabulary.
    types : int
        How many types of objects the view encoder knows.
    """

    def __init__(self, words: int, answers: int, types: int) -> None:
        super().__init__()
        told = len(MOVES) + 1
        self.reader = WordReader(words)
        self.eye = Eye(2 * READ, types)
        self.planner = nn.GRUCell(SEEN + 2 * READ + told, HIDDEN)
        self.plan = nn.Linear(HIDDEN, len(MOVES))
        self.controller = nn.Sequential(nn.Linear(HIDDEN + SEEN + told, JUDGED), nn.ReLU(), nn.Linear(JUDGED, 1))
        self.ask, self.show = nn.Linear(2 * READ, JUDGED), nn.Linear(SEEN, JUDGED)
        self.say = nn.Sequential(nn.Dropout(0.2), nn.Linear(2 * JUDGED, JUDGED), nn.ReLU(), nn.Linear(JUDGED, answers))

    def read(self, numbers: Tensor) -> Asking:
        """Read (n, w) int64 numbers of words."""
        return self.eye.ask(self.reader(numbers).sentence)

    def rest(self, walks: int) -> Tensor:
        """The planner's state at first."""
        return self.plan.weight.new_zeros(walks, HIDDEN)

    def decide(self, seen: Tensor, before: Tensor, asking: Asking, hidden: Tensor) -> tuple[Tensor, Tensor]:
        """(n,) logits of going on, and (n, HIDDEN) the planner's state if it is asked, upon its state before."""
        goes_on = self.controller(torch.cat([hidden, seen, before], 1))[:, 0]
        return goes_on, self.planner(torch.cat([seen, asking.sentence, before], 1), hidden)

    def forward(self, shown: Tensor, before: Tensor, asking: Asking, is_planned: Tensor) -> Planned:
        """What is thought along whole walks.

        Parameters
        ----------
        shown : (t, n, SEEN)
            What the eye sees.
        before : (t, n, moves + 1)
            The last moves; see `remqa_data.agents.networks.actor_critic.Seen`.
        asking : Asking
        is_planned : (t, n) bool
            When the planner was asked.
        """
        hidden = self.rest(before.shape[1])
        moves, goes_on = [], []
        for view, last, planned in zip(shown, before, is_planned, strict=True):
            logits, asked = self.decide(view, last, asking, hidden)
            goes_on.append(logits)
            moves.append(self.plan(asked))
            hidden = torch.where(planned[:, None], asked, hidden)
        return Planned(torch.stack(moves), torch.stack(goes_on))

    def answers(self, asking: Asking, shown: Tensor, is_view: Tensor) -> Tensor:
        """(n, answers) logits by (v, n, SEEN) views; (v, n) bool says which there are, at least one for each."""
        asked, views = self.ask(asking.sentence), self.show(shown)
        fits = (views * asked).sum(2) / JUDGED**0.5
        weights = fits.masked_fill(~is_view, -torch.inf).softmax(0)
        read = (weights[..., None] * views).sum(0)
        return self.say(functional.relu(torch.cat([asked, asked * read], 1)))  # type: ignore[no-any-return]


class PlannedWalk:
    """Some walks of one network, from their beginning; see `remqa_data.agents.networks.imitation.ImitatorWalk`.

    Parameters
    ----------
    model : PlannerController
    numbers : (n, w) int64
        Words of the questions.
    """

    def __init__(self, model: PlannerController, numbers: Tensor) -> None:
        self.model = model
        with torch.no_grad():
            self.asking = model.read(numbers)
        self._hidden = model.rest(len(numbers))
        self._repeats = torch.zeros(len(numbers), dtype=torch.int64, device=numbers.device)

    @torch.no_grad()
    def move(self, features: Tensor, before: Tensor, draws: Tensor, lead: Lead | None = None) -> Chosen:
        """The last move again, or another one."""
        last = before[:, :-1] > 0
        shown = self.model.eye(features, self.asking.names)
        logits, asked = self.model.decide(shown, before, self.asking, self._hidden)
        goes_on = draws[:, 0] < logits.sigmoid()
        if lead is not None:
            goes_on = torch.where(lead.is_led, (last & lead.best).any(1), goes_on)
        goes_on &= last.any(1) & (self._repeats < MOST_REPEATS)
        moves = torch.where(goes_on, last.int().argmax(1), led(self.model.plan(asked), draws[:, 1], lead))
        self._hidden = torch.where(goes_on[:, None], self._hidden, asked)
        self._repeats = torch.where(goes_on, self._repeats + 1, 1)
        return Chosen(moves, ~goes_on)
