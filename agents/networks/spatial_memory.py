"""HIMN, a planner with a spatial memory (Gordon et al. 2018, "IQA: Visual Question Answering in Interactive Environments").

The memory is a map from above, of numbers for each cell, made on the way: what is seen is written into the cells ahead of the
agent, each of which a recurrent unit keeps (the paper's egocentric spatial GRU). The planner reads the map around the agent,
and where in all of it what the question asks for may be, and says what comes next: a step, or that the target is there, and
what to do to it. The agent knows where it is by its own moves.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor, nn

from remqa_data.agents.networks.actor_critic import MOVES
from remqa_data.agents.networks.imitation import DEEDS, SEEN, Asking, Chosen, Eye, Lead, led
from remqa_data.agents.networks.language import HIDDEN as READ
from remqa_data.agents.networks.language import WordReader

CELLS = 12
"""Numbers of a cell, which is as wide as a step."""
SIDE = 49
"""Cells along a side of the map; the agent begins in its middle."""
AHEAD = 7
"""What is seen is written into so many rows of so many cells, the first row being the agent's."""
AROUND = 11
"""The planner reads so many rows of so many cells, the agent in their middle."""
HIDDEN = 128
"""Of the planner."""
NEAR = 64
"""Numbers of what it reads of the map around the agent."""
FOUND = 3
"""Numbers of where in the map what is asked for may be: how far ahead, how far to the right, and how well it fits."""
FAR = SIDE / 2
"""Cells that count as 1."""
UNWRITTEN = -1e4
"""Logit of a cell that nothing was written into."""

WAYS = ((0, 1), (1, 0), (0, -1), (-1, 0))
"""Steps to the east and north of each heading; each one is to the right of the one before."""


class Memory(NamedTuple):
    """What n agents remember.

    Attributes
    ----------
    cells : (n, SIDE^2, CELLS)
        The map, in rows to the north.
    is_written : (n, SIDE^2) bool
    places : (n, 2) int64
        East and north.
    headings : (n,) int64
        Among WAYS.
    hidden : (n, HIDDEN)
        The planner's state.
    """

    cells: Tensor
    is_written: Tensor
    places: Tensor
    headings: Tensor
    hidden: Tensor


class Planned(NamedTuple):
    """What n walks are to do in t steps.

    Attributes
    ----------
    moves : (t, n, moves)
        Logits.
    deeds : (t, n, DEEDS)
        Logits of what is to be done to the target now.
    """

    moves: Tensor
    deeds: Tensor


class MemoryPlanner(nn.Module):
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
        self.reader = WordReader(words)
        self.eye = Eye(2 * READ, types)
        self.write = nn.Linear(SEEN, AHEAD**2 * CELLS)
        self.keep = nn.GRUCell(CELLS, CELLS)
        self.ask = nn.Linear(2 * READ, CELLS)
        self.near = nn.Sequential(
            nn.Conv2d(CELLS, 24, 3, stride=2),
            nn.ReLU(),
            nn.Conv2d(24, 24, 3),
            nn.ReLU(),
            nn.Flatten(),
            nn.Linear(24 * 3 * 3, NEAR),
        )
        self.planner = nn.GRUCell(SEEN + NEAR + FOUND + 2 * READ + len(MOVES) + 1, HIDDEN)
        self.policy, self.deed = nn.Linear(HIDDEN, len(MOVES)), nn.Linear(HIDDEN, len(DEEDS))

    def read(self, numbers: Tensor) -> Asking:
        """Read (n, w) int64 numbers of words."""
        return self.eye.ask(self.reader(numbers).sentence)

    def nothing(self, walks: int) -> Memory:
        """What is remembered at first."""
        empty = self.policy.weight.new_zeros(walks, SIDE**2, CELLS)
        places = torch.full((walks, 2), SIDE // 2, device=empty.device)
        headings = torch.zeros(walks, dtype=torch.int64, device=empty.device)
        return Memory(empty, empty[..., 0] > 0, places, headings, empty.new_zeros(walks, HIDDEN))

    def forward(self, shown: Tensor, before: Tensor, asking: Asking) -> Planned:
        """What is thought along whole walks.

        Parameters
        ----------
        shown : (t, n, SEEN)
            What the eye sees.
        before : (t, n, moves + 1)
            The last moves; see `remqa_data.agents.networks.actor_critic.Seen`.
        asking : Asking
        """
        memory, moves, deeds = self.nothing(before.shape[1]), [], []
        for view, last in zip(shown, before, strict=True):
            memory = self.remember(memory, view, last, asking)
            moves.append(self.policy(memory.hidden))
            deeds.append(self.deed(memory.hidden))
        return Planned(torch.stack(moves), torch.stack(deeds))

    def remember(self, memory: Memory, shown: Tensor, before: Tensor, asking: Asking) -> Memory:
        """What is remembered after one more view, (n, SEEN), which the last moves, (n, moves + 1), have led to."""
        places, headings = moved(memory.places, memory.headings, before)
        ahead = cells_at(places, headings, AHEAD, first_row=0)
        into = ahead[..., None].expand(-1, -1, CELLS)
        seen = self.write(shown).view(-1, AHEAD**2, CELLS)
        kept = self.keep(seen.flatten(0, 1), memory.cells.gather(1, into).flatten(0, 1))
        cells = memory.cells.scatter(1, into, kept.view(-1, AHEAD**2, CELLS).to(memory.cells.dtype))
        is_written = memory.is_written.scatter(1, ahead, value=True)
        around = cells_at(places, headings, AROUND, first_row=-(AROUND // 2))
        near = cells.gather(1, around[..., None].expand(-1, -1, CELLS))
        near = self.near(near.transpose(1, 2).reshape(-1, CELLS, AROUND, AROUND))
        found = self._found(cells, is_written, places, headings, asking)
        thought = torch.cat([shown, near, found, asking.sentence, before], 1)
        return Memory(cells, is_written, places, headings, self.planner(thought, memory.hidden))

    def _found(self, cells: Tensor, is_written: Tensor, places: Tensor, headings: Tensor, asking: Asking) -> Tensor:
        """(n, FOUND) where in the map what is asked for may be, as the agent sees it."""
        fits = (cells @ self.ask(asking.sentence)[..., None])[..., 0].masked_fill(~is_written, UNWRITTEN)
        weights = fits.softmax(1)
        sides = torch.arange(SIDE, device=fits.device)
        east_north = torch.stack([sides.repeat(SIDE), sides.repeat_interleave(SIDE)], 1)
        away = (weights @ east_north.to(weights.dtype) - places) / FAR
        ahead = torch.tensor(WAYS, device=fits.device)[headings]
        right = torch.tensor(WAYS, device=fits.device)[(headings + 1) % 4]
        return torch.stack([(away * ahead).sum(1), (away * right).sum(1), fits.amax(1).tanh()], 1)


def moved(places: Tensor, headings: Tensor, before: Tensor) -> tuple[Tensor, Tensor]:
    """(n, 2) places and (n,) headings after (n, moves + 1) last moves, of which those that were refused changed nothing."""
    is_done = before[:, -1] == 0
    turns = before[:, MOVES.index("RotateRight")] - before[:, MOVES.index("RotateLeft")]
    headings = (headings + (turns * is_done).to(torch.int64)) % 4
    goes = (before[:, MOVES.index("MoveAhead")] * is_done).to(torch.int64)
    places = places + goes[:, None] * torch.tensor(WAYS, device=places.device)[headings]
    return places.clamp(0, SIDE - 1), headings


def cells_at(places: Tensor, headings: Tensor, side: int, first_row: int) -> Tensor:
    """(n, side^2) cells of the map in rows ahead of agents, from the left to the right; beyond the map, those at its edge."""
    steps = torch.arange(side, device=places.device)
    rows, columns = (steps + first_row).repeat_interleave(side), (steps - side // 2).repeat(side)
    ways = torch.tensor(WAYS, device=places.device)
    ahead, right = ways[headings], ways[(headings + 1) % 4]
    at = places[:, None] + rows[None, :, None] * ahead[:, None] + columns[None, :, None] * right[:, None]
    at = at.clamp(0, SIDE - 1)
    return at[..., 1] * SIDE + at[..., 0]


class RememberedWalk:
    """Some walks of one network, from their beginning; see `remqa_data.agents.networks.imitation.ImitatorWalk`.

    Parameters
    ----------
    model : MemoryPlanner
    numbers : (n, w) int64
        Words of the questions.
    """

    def __init__(self, model: MemoryPlanner, numbers: Tensor) -> None:
        self.model = model
        with torch.no_grad():
            self._asking = model.read(numbers)
        self._memory = model.nothing(len(numbers))
        self.deeds = torch.zeros(len(numbers), len(DEEDS), device=numbers.device)

    @torch.no_grad()
    def move(self, features: Tensor, before: Tensor, draws: Tensor, lead: Lead | None = None) -> Chosen:
        """What comes out for the last view; `deeds` has the logits of what is to be done there."""
        shown = self.model.eye(features, self._asking.names)
        self._memory = self.model.remember(self._memory, shown, before, self._asking)
        self.deeds = self.model.deed(self._memory.hidden)
        moves = led(self.model.policy(self._memory.hidden), draws[:, 1], lead)
        return Chosen(moves, torch.ones_like(moves, dtype=torch.bool))
