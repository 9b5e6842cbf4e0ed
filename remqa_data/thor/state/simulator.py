"""What AI2-THOR's actions act on: a room, the agent in it, the cameras and the settings."""

from __future__ import annotations

from threading import RLock

import numpy as np

from remqa_data.errors import MisuseError
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.cameras import ThirdPartyCamera
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.settings import FrameSize, Quality, Settings

SCENE_SUFFIX = "_physics"
SEEDS = 1 << 32
"""A seed is a 32-bit number there."""


class SimulatorState:
    """The state between actions.

    Parameters
    ----------
    frame : FrameSize
        Of every picture.
    quality : Quality
        What pictures are drawn with, in all rooms.

    Attributes
    ----------
    settings : Settings
        What Initialize has set.
    scene_name : str
        As AI2-THOR calls it.
    cameras : list of ThirdPartyCamera
        In the order in which they were added.
    shown_objects : frozenset of str or None
        What SetObjectFilter restricts the metadata to; None for all objects.
    is_paused : bool
        Whether a client has told physics to wait for it. All is at rest between actions in any case.
    lock : RLock
        Held by who changes or reads the room, where clients have several threads.
    rng : numpy.random.Generator
        Draws what is random and has no seed of its own. As in AI2-THOR it goes on over resets, so that each room is
        another one.
    """

    def __init__(self, frame: FrameSize, quality: Quality) -> None:
        self.frame, self.quality = frame, quality
        self.lock = RLock()
        self.settings = Settings()
        self.scene_name = ""
        self.cameras: list[ThirdPartyCamera] = []
        self.shown_objects: frozenset[str] | None = None
        self.is_paused = False
        self.rng = generator(0)
        self._room: LoadedFloorPlan | None = None

    @property
    def has_room(self) -> bool:
        """Whether a scene has been loaded."""
        return self._room is not None

    @property
    def room(self) -> LoadedFloorPlan:
        """The room.

        Raises
        ------
        MisuseError
            If no scene has been loaded.
        """
        if self._room is None:
            raise MisuseError("InvalidAction", "no scene is loaded: Reset first")
        return self._room

    @property
    def agent(self) -> ThorAgent:
        """The agent in the room."""
        return self.room.agent

    def load(self, scene_name: str) -> None:
        """Load a scene by its name in AI2-THOR, or the same scene again."""
        scene = scene_name.removesuffix(SCENE_SUFFIX)
        if self._room is not None and self._room.scene == scene:
            self._room.restart(self.settings, self.frame)
        else:
            room = LoadedFloorPlan(scene, self.settings, self.frame)
            self.close()
            self._room = room
        self.scene_name = scene_name
        self.cameras, self.shown_objects, self.is_paused = [], None, False

    def seed(self, seed: int) -> None:
        """Start anew what is random."""
        self.rng = generator(seed)

    def resize(self, frame: FrameSize) -> None:
        """Change the size of all pictures."""
        self.frame = frame
        if self._room is not None:
            for agent in self._room.agents:
                agent.frame = frame

    def close(self) -> None:
        """Give the simulator's memory back."""
        if self._room is not None:
            self._room.world.close()
            self._room = None


def generator(seed: int) -> np.random.Generator:
    """Random numbers from a seed of AI2-THOR, which may be negative."""
    return np.random.default_rng(seed % SEEDS)
