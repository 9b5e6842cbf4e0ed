"""Where the agent's body can go in a world that changes: for any step, and what is in the way.

A step is free when every point along it is farther from all obstacles than the agent's radius. Along the edges of the
navigation grid this is the same test as in `remqa_data.sim.navigation.grid`, at the same points.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import chain

import numpy as np

from remqa_data.geometry.types import F64, Vec2
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.navigation.grid import (
    FINE_M,
    Clearance,
    Outline,
    ReachableGrid,
    asset_outlines,
    building_outlines,
    clearance_from,
    object_outlines,
    outline_distance,
    reachable_grid,
    solid_ids,
)
from remqa_data.sim.navigation.straight_ways import SAMPLE_M, StraightWays
from remqa_data.sim.physics.bodies import STRUCTURE_NAME
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.world import World


class Ground:
    """The floor of a world, kept in step with what is opened, moved and taken away.

    Parameters
    ----------
    world : World
        The room.
    body : Embodiment
        Of the agent.
    """

    def __init__(self, world: World, body: Embodiment) -> None:
        self.world, self.body, self.radius_m = world, body, body.radius_m
        self._states: dict[str, ObjectState] = {}
        self._outlines: dict[str, list[Outline]] = {}
        self._building = building_outlines(world.scene, body)
        self._clearance: Clearance | None = None
        self._grid: ReachableGrid | None = None
        self._ways: StraightWays | None = None
        self._revision, self._held = world.revision, dict(world.held)
        self._follow(world.ids)

    def blocker_at(self, x: float, y: float) -> str | None:
        """What keeps the agent from standing at a point, by object id or "structure"; None if nothing does."""
        return None if self._clear().at(x, y) > self.radius_m else self._nearest(x, y)

    def blocker(self, start: Vec2, end: Vec2) -> str | None:
        """What keeps the agent from a straight step; see `blocker_at`.

        An agent that is too near to something already, such as to a thing that fell before its feet, may walk away
        from it.
        """
        blocked = self._first_blocked(start, end)
        return None if blocked is None else self._nearest(*blocked)

    def is_clear(self, start: Vec2, end: Vec2) -> bool:
        """Whether nothing keeps the agent from a straight step; cheaper than to ask what does."""
        return self._first_blocked(start, end) is None

    def meets_agent(self, object_id: str, link_poses: F64, agent: Vec2, first_link: int = 0) -> bool:
        """Whether an object would touch the agent with its links at (n, 4, 4) poses; not if it does so already.

        With `first_link` 1, which is enough where the rest stays, only what moves when it opens is looked at.
        """
        self._sync()
        now = outline_distance(self._outlines[object_id], agent)
        return self.distance(object_id, link_poses, agent, first_link) <= min(self.radius_m, now - 1e-6)

    def distance(self, object_id: str, link_poses: F64, agent: Vec2, first_link: int = 0) -> float:
        """How far an object would be from the middle of the agent with its links at (n, 4, 4) poses, metres in plan."""
        asset, floor_z = self.world.assets[object_id], self.world.scene.floor_z
        return outline_distance(asset_outlines(asset, link_poses, floor_z, first_link, self.body), agent)

    def grid(self) -> ReachableGrid:
        """The navigation grid as it is now."""
        self._sync()
        if self._grid is None:
            self._grid = reachable_grid(self.world, self._clear(), self.body)
        return self._grid

    def straight_ways(self) -> StraightWays:
        """The straight ways between cells of the grid as it is now."""
        places = self.grid().positions()
        if self._ways is None:
            self._ways = StraightWays(self._clear(), places, self.world.scene.bounds, self.radius_m)
        return self._ways

    def _first_blocked(self, start: Vec2, end: Vec2) -> Vec2 | None:
        clearance = self._clear()
        count = max(1, math.ceil(math.dist(start, end) / SAMPLE_M - 1e-9))
        limit = min(self.radius_m, np.nextafter(clearance.at(*start), 0.0))
        for k in range(1, count + 1):
            x = start[0] + k / count * (end[0] - start[0])
            y = start[1] + k / count * (end[1] - start[1])
            if clearance.at(x, y) <= limit:
                return x, y
        return None

    def _sync(self) -> None:
        world = self.world
        if world.revision == self._revision:
            return
        moved = [name for name in world.ids if self._states[name] is not world.state(name)]
        if moved or world.held != self._held:
            self._held = dict(world.held)
            self._follow(moved)
        self._revision = world.revision

    def _follow(self, moved: Iterable[str]) -> None:
        world = self.world
        for name in moved:
            self._states[name] = world.state(name)
            self._outlines[name] = object_outlines(world, name, body=self.body)
        self._clearance = self._grid = self._ways = None

    def _clear(self) -> Clearance:
        """The clearance as it is now; found when somebody walks, and not for every thing that moves."""
        self._sync()
        if self._clearance is None:
            in_the_way = (self._outlines[name] for name in solid_ids(self.world))
            self._clearance = clearance_from(self.world.scene.bounds, chain(self._building, *in_the_way))
        return self._clearance

    def _nearest(self, x: float, y: float) -> str:
        """The object nearest to a point, or the building if nothing is within the agent's radius."""
        gaps = {name: outline_distance(self._outlines[name], (x, y)) for name in solid_ids(self.world)}
        nearest = min(gaps, key=lambda name: gaps[name], default=STRUCTURE_NAME)
        return nearest if gaps.get(nearest, math.inf) <= self.radius_m + 2 * FINE_M else STRUCTURE_NAME
