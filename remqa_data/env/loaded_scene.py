"""A room of the environment, loaded once for all episodes in it."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from remqa_data.env.episodes import Episode
from remqa_data.sim.agent.agent import Agent, Hands
from remqa_data.sim.agent.pictures import Pictures
from remqa_data.sim.agent.third_person import ThirdPerson
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import Observation, WorldView


class LoadedRoom:
    """A room with an agent, brought back to its first state for each episode.

    Parameters
    ----------
    episode : Episode
        One that is played in the room.
    hands : {"arm", "reach", "near"}
        See `remqa_data.sim.agent.agent.Hands`.
    bytes_kept : int
        Pictures of the room as it is at first that are remembered take so much.
    """

    def __init__(self, episode: Episode, hands: Hands, bytes_kept: int = 0) -> None:
        self.episode = episode
        self.world = World(episode.scene)
        self.view = WorldView(self.world)
        self.agent = Agent(self.world, self.view, (0.0, 0.0), 0.0, embodiment=episode.embodiment, hands=hands)
        self._first = self.world.save()
        self._kept = Pictures(self.view, bytes_kept)

    @cached_property
    def third_person(self) -> ThirdPerson:
        """Draws the agent from outside."""
        return ThirdPerson(self.agent)

    def look(self, width: int, height: int) -> Observation:
        """What the agent sees; the caller's own."""
        camera = self.agent.camera(width, height)
        if not self._kept.most_bytes or not self.world.is_as(self._first):
            return self.view.render(camera)
        seen = self._kept.of(camera)
        return replace(seen, rgb=seen.rgb.copy(), depth=seen.depth.copy(), instances=seen.instances.copy())

    def begin(self, episode: Episode, rng: np.random.Generator) -> None:
        """Undo what was done, and put the agent at its initial pose."""
        self.episode = episode
        self.world.restart(self._first)
        if "third_person" in vars(self):
            self.third_person.begin()
        if episode.initial_pose is None:
            cells = self.agent.grid.cells
            position = self.agent.grid.position(cells[int(rng.integers(len(cells)))])
            self.agent.place(position, float(rng.choice(HEADINGS_DEG)))
        else:
            self.agent.place(episode.initial_pose[:2], episode.initial_pose[2], episode.initial_pose[3])
