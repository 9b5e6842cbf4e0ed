"""The straight ways over a floor, and the shortest way that bends only between them."""

from __future__ import annotations

import math

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Flags, Rect, Vec2
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Clearance

SAMPLE_M = AGENT.step_m / 4
"""A step is tested at least this densely."""
SAME_PLACE_M = 1e-6
"""A place so near to another one is that one."""


class StraightWays:
    """All straight ways between the cells of a grid, as `Ground.is_clear` knows them, for many at once.

    Parameters
    ----------
    clearance : Clearance
        Of the floor.
    places : (n, 2) float64
        Where the cells are, metres in the room.
    bounds : tuple of float
        Of the room: x0, y0, x1, y1, metres.
    radius_m : float
        Of who walks.
    """

    def __init__(self, clearance: Clearance, places: F64, bounds: Rect, radius_m: float) -> None:
        self.places = places
        self._clearance, self._bounds, self._radius_m = clearance, bounds, radius_m
        self._metres: dict[int, F64] = {}

    def shortest(self, start: Vec2, goal: Vec2) -> list[Vec2] | None:
        """The shortest way that bends at cells, and at one at least, from its start to its goal; None if there is none.

        Its length is the same there and back. Whether one can walk straight there, `Ground.is_clear` tells.

        Notes
        -----
        A* over all straight ways that are clear; the last entry of each array is the goal.
        """
        count, to_goal = len(self.places), self.metres_from(goal)
        gone, before = np.append(self.metres_from(start), np.inf), np.full(count + 1, -1)
        left, is_open = np.append(arithmetic.length(self.places - goal), 0.0), np.full(count + 1, True)
        while is_open[count]:
            whole = np.where(is_open, gone + left, np.inf)
            here = int(whole.argmin())
            if whole[here] == np.inf:
                return None
            is_open[here] = False
            if here < count:
                there = gone[here] + np.append(self.metres(here), to_goal[here])
                nearer = there < gone
                gone[nearer], before[nearer] = there[nearer], here
        way, cell = [goal], int(before[count])
        while cell >= 0:
            x, y = self.places[cell].tolist()
            if min(math.dist((x, y), start), math.dist((x, y), goal)) > SAME_PLACE_M:
                way.append((x, y))
            cell = int(before[cell])
        return [start, *reversed(way)]

    def metres(self, cell: int) -> F64:
        """(n,) metres straight from one of the cells to each, infinite where something is in the way; found once."""
        if cell not in self._metres:
            x, y = self.places[cell].tolist()
            self._metres[cell] = self.metres_from((x, y))
        return self._metres[cell]

    def metres_from(self, place: Vec2) -> F64:
        """(n,) metres straight from a place to each cell, infinite where something is in the way.

        From a place that is too near to something a way leads to the nearest cell only.
        """
        x0, y0, x1, y1 = self._bounds
        if not (x0 <= place[0] <= x1 and y0 <= place[1] <= y1):
            return np.full(len(self.places), np.inf)
        start = np.array(place)
        metres = np.where(self._are_clear(start), arithmetic.length(self.places - start), np.inf)
        if self._clearance.at(*place) <= self._radius_m:
            metres[metres > metres.min(initial=np.inf)] = np.inf
        return metres

    def _are_clear(self, start: F64) -> Flags:
        """(n,) whether nothing keeps the agent from a straight step from a (2,) place to each cell; see `Ground.is_clear`."""
        ways, clearance = self.places - start, self._clearance
        counts = np.maximum(np.ceil(arithmetic.length(ways) / SAMPLE_M - 1e-9), 1.0)[:, None]
        shares = np.minimum(np.arange(1.0, counts.max(initial=1.0) + 1.0) / counts, 1.0)
        x, y = (start[k] + shares * ways[:, k, None] for k in (0, 1))
        limit = min(self._radius_m, math.nextafter(clearance.at(*start.tolist()), 0.0))
        return np.asarray((clearance.at_each(x, y) > limit).all(axis=1))
