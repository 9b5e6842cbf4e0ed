"""The four parts of an agent, and what each of them gets.

A part sees the question's words, the memory of the walk, and percepts: nothing else. No part gets the environment, so none can
ask it where the target is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.env.actions import Shares
from remqa_data.geometry.types import F32, U8, Flags
from remqa_data.sim.agent.actions import Action
from remqa_data.sim.metadata import tight_box
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.sim.render.camera import Camera


@dataclass(frozen=True, eq=False)
class Percept:
    """What the agent gets after an action: its senses.

    Attributes
    ----------
    rgb : (h, w, 3) uint8
        What it sees.
    depth : (h, w) float32
        Metres along the camera's forward axis, 0 where nothing is.
    pose : AgentPose
        Where it is, on the grid of its steps.
    camera : Camera
        Its eye, in the room's frame.
    succeeded : bool
        Whether the room let it do the action; True before the first.
    """

    rgb: U8
    depth: F32
    pose: AgentPose
    camera: Camera
    succeeded: bool


@dataclass(frozen=True)
class Sighting:
    """Where an agent says that the target is in its view, as shares of the width and height from the top left corner.

    Attributes
    ----------
    box : tuple of float
        x1, y1, x2, y2.
    point : tuple of float
        A point on the target, where the hand goes.
    """

    box: Shares
    point: tuple[float, float]

    @classmethod
    def of_mask(cls, mask: Flags) -> Sighting | None:
        """The box of the pixels of a (h, w) mask, and of the pixels the one nearest to their middle; None if it has none."""
        box = tight_box(mask)
        if box is None:
            return None
        height, width = mask.shape
        x1, y1, x2, y2 = box
        return cls((x1 / width, y1 / height, x2 / width, y2 / height), middle_of(mask))


def middle_of(mask: Flags) -> tuple[float, float]:
    """Of the pixels of a (h, w) mask the one nearest to their middle, as shares of the width and height."""
    rows, columns = np.nonzero(mask)
    nearest = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    return (float(columns[nearest]) + 0.5) / mask.shape[1], (float(rows[nearest]) + 0.5) / mask.shape[0]


class Walker(Protocol):
    """Walks in one episode."""

    def next_action(self, percept: Percept) -> str | None:
        """The next navigation action, a whole step such as "MoveAhead"; None when it is there, or gives up."""


@runtime_checkable
class Persistent(Protocol):
    """A walker that knows from where else something could be done to the target."""

    def leave(self, percept: Percept) -> None:
        """Hear that nothing could be done from here; the next actions lead elsewhere, if there is anywhere to go."""


@runtime_checkable
class Inspecting(Walker, Protocol):
    """A walker that knows from where the inside of what has been opened shows."""

    def look_inside(self, percept: Percept) -> None:
        """Hear that it is to be looked into from elsewhere; the next actions lead there, if there is anywhere to go."""

    def inside_of(self, percept: Percept) -> Flags:
        """(h, w) which pixels show the inside."""


@runtime_checkable
class Remembering(Protocol):
    """A walker that says what the agent knows of the room in the end: what it was told, or has found out itself."""

    @property
    def memory(self) -> WalkMemory:
        """For the localizer and the manipulator, instead of what the stored walk has left."""


class Navigator(Protocol):
    """Brings the agent to the target."""

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> Walker:
        """Begin an episode."""


class Localizer(Protocol):
    """Finds the target in the view in which the walk has ended."""

    def locate(
        self, asked: Question, memory: WalkMemory, percept: Percept, rng: np.random.Generator
    ) -> Sighting | None:
        """Where the target is; None where it is not seen."""


@runtime_checkable
class Manipulator(Protocol):
    """Decides what to do to the target."""

    def actions(
        self, asked: Question, memory: WalkMemory, percept: Percept, sighting: Sighting | None
    ) -> tuple[Action, ...]:
        """What to try, one after the other, until one succeeds; nothing where there is nothing to do."""


@runtime_checkable
class Answerer(Protocol):
    """Answers the question from what was seen before and after the manipulation."""

    def answer(self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None) -> str | None:
        """The answer; None for none. `sighting` is where the target was before, None where it was not seen."""


@runtime_checkable
class Weighing(Protocol):
    """An answerer that says how sure it is, so that its answers from several views can be weighed."""

    def chances(
        self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None
    ) -> Mapping[str, float]:
        """How likely each answer is, together 1."""
