"""The states of a room: every pose that the agent can take on the grid, numbered."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from remqa_data.geometry.types import F32, F64
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.navigation.grid import Cell
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, HORIZONS_DEG

POSTURES = (True, False)
"""Standing, crouched."""
TURNS = tuple(product(HEADINGS_DEG, HORIZONS_DEG, POSTURES))
"""Ways to look from a cell: yaw_deg, horizon_deg, is_standing. State `s` is way `s % len(TURNS)` on cell `s // len(TURNS)`."""
_NUMBER = {turn: number for number, turn in enumerate(TURNS)}
NEAR = 1e-6
"""Metres and degrees that a pose may be off a state."""


@dataclass(frozen=True)
class States:
    """All poses on some cells of a grid.

    Attributes
    ----------
    cells : tuple of (int, int)
        Sorted; those that can be reached in any configuration of the room, so that all number their states alike.
    step_m : float
        Between the centres of cells.
    """

    cells: tuple[Cell, ...]
    step_m: float

    @classmethod
    def of(cls, cells: Iterable[Cell], step_m: float) -> States:
        """The states of cells in any order, some of them perhaps several times."""
        return cls(tuple(sorted(set(cells))), step_m)

    def __len__(self) -> int:
        return len(self.cells) * len(TURNS)

    def number(self, x: float, y: float, yaw_deg: float, horizon_deg: float, is_standing: bool = True) -> int | None:
        """The state of a pose; None if it is not one of these."""
        cell = self._cell_numbers.get((round(x / self.step_m), round(y / self.step_m)))
        turn = _NUMBER.get((round(yaw_deg) % 360, round(horizon_deg), is_standing))
        if cell is None or turn is None:
            return None
        state = cell * len(TURNS) + turn
        asked = (x, y, yaw_deg % 360.0, horizon_deg, is_standing)
        return state if all(abs(a - b) <= NEAR for a, b in zip(asked, self.pose(state), strict=True)) else None

    def cell_number(self, cell: Cell) -> int:
        """Place of a cell among the cells."""
        return self._cell_numbers[cell]

    def of_cells(self, cells: Iterable[Cell]) -> Iterator[int]:
        """The states on some of the cells."""
        for cell in cells:
            first = self._cell_numbers[cell] * len(TURNS)
            yield from range(first, first + len(TURNS))

    def pose(self, state: int) -> tuple[float, float, float, float, bool]:
        """x, y in metres, yaw_deg, horizon_deg, is_standing."""
        cell, turn = divmod(state, len(TURNS))
        (i, j), (yaw, horizon, is_standing) = self.cells[cell], TURNS[turn]
        return i * self.step_m, j * self.step_m, float(yaw), float(horizon), is_standing

    def place(self, agent: Agent, state: int) -> None:
        """Put an agent there."""
        x, y, yaw, horizon, is_standing = self.pose(state)
        agent.place((x, y), yaw, horizon, is_standing)

    def state_of(self, agent: Agent) -> int | None:
        """The state that an agent is in; None if it is not on the grid."""
        return self.number(agent.x, agent.y, agent.yaw_deg, agent.horizon_deg, agent.is_standing)

    def poses(self) -> F32:
        """(states, 5) x, y, yaw_deg, horizon_deg, 1 if it stands: as the environments observe them."""
        return np.array([self.pose(state) for state in range(len(self))], dtype=np.float32).reshape(-1, 5)

    def positions(self) -> F64:
        """(cells, 2) centres, metres."""
        return np.array(self.cells, dtype=np.float64).reshape(-1, 2) * self.step_m

    @cached_property
    def _cell_numbers(self) -> dict[Cell, int]:
        return {cell: number for number, cell in enumerate(self.cells)}
