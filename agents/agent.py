"""An agent: a navigator, a localizer, a manipulator and an answerer, and how they play an episode together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import Answerer, Localizer, Manipulator, Navigator, Percept, Remembering
from remqa_data.env.actions import Command
from remqa_data.sim.agent.actions import DONE, Action

Act = Callable[[Command], Percept]
"""Does something in the room and says what the agent perceives then: all that an agent has of the environment."""


@dataclass(frozen=True)
class Agent:
    """The four parts; without a localizer or a manipulator nothing is pointed at or done, without an answerer not answered.

    Attributes
    ----------
    most_steps : int
        After so many navigation actions the agent stops where it is.
    """

    navigator: Navigator
    localizer: Localizer | None = None
    manipulator: Manipulator | None = None
    answerer: Answerer | None = None
    most_steps: int = 100

    def play(self, asked: Question, memory: WalkMemory, first: Percept, act: Act, rng: np.random.Generator) -> None:
        """Play an episode to its end: walk, say where the target is, manipulate it, answer.

        Parameters
        ----------
        asked : Question
            What the question's words say.
        memory : WalkMemory
            What the walk through this configuration has left.
        first : Percept
            What the agent perceives at first.
        act : callable
            Does a command in the room.
        rng : numpy.random.Generator
            For parts that draw.
        """
        walker = self.navigator.begin(asked, memory, rng)
        before = first
        for _ in range(self.most_steps):
            action = walker.next_action(before)
            if action is None:
                break
            before = act(Command(Action(action)))
        if isinstance(walker, Remembering):
            memory = walker.memory
        sighting = self.localizer.locate(asked, memory, before, rng) if self.localizer else None
        box = sighting.box if sighting else None
        after = before
        for manipulation in self.manipulator.actions(asked, memory, before, sighting) if self.manipulator else ():
            after = act(Command(manipulation, box=box))
            if after.succeeded:
                break
        answer = self.answerer.answer(asked, before, after, sighting) if self.answerer else None
        act(Command(Action(DONE), box=box) if answer is None else Command(answer=answer, box=box))
