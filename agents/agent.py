"""An agent: a navigator, a localizer, a manipulator and an answerer, and how they play an episode together."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import (
    Answerer,
    Inspecting,
    Localizer,
    Manipulator,
    Navigator,
    Percept,
    Persistent,
    Remembering,
    Sighting,
    Walker,
    Weighing,
)
from remqa_data.env.actions import Command
from remqa_data.sim.agent.actions import DONE, Action

MOST_TRIES, MOST_MANIPULATIONS = 3, 4
"""Where nothing can be done to the target from so many places, by so many manipulations each, the agent answers without."""

LOOKING_STEPS = 40
"""After it has opened something it does no more navigation actions than so; they are in no submission."""

Act = Callable[[Command], Percept]
"""Does something in the room and says what the agent perceives then: all that an agent has of the environment."""


@dataclass(frozen=True)
class Agent:
    """The four parts; without a localizer or a manipulator nothing is pointed at or done, without an answerer not answered.

    Attributes
    ----------
    most_steps : int
        After so many navigation actions the agent stops where it is.
    looks : int
        What it has opened it looks into from so many other places before it answers, if its navigator knows from where, and
        its answerer can say how sure it is.
    """

    navigator: Navigator
    localizer: Localizer | None = None
    manipulator: Manipulator | None = None
    answerer: Answerer | None = None
    most_steps: int = 100
    looks: int = 0

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
        before, steps = self._walk(walker, first, act, self.most_steps)
        for tries_left in reversed(range(MOST_TRIES)):
            if isinstance(walker, Remembering):
                memory = walker.memory
            sighting = self.localizer.locate(asked, memory, before, rng) if self.localizer else None
            after = self._manipulate(asked, memory, before, sighting, act)
            if after is before or after.succeeded or not tries_left or not isinstance(walker, Persistent):
                break
            walker.leave(before)
            there, steps = self._walk(walker, before, act, steps)
            if there.pose == before.pose:
                break
            before = there
        box = sighting.box if sighting else None
        is_open = asked.manipulation == "Open" and after is not before and after.succeeded
        if self.looks and is_open and isinstance(walker, Inspecting) and isinstance(self.answerer, Weighing):
            answer: str | None = self._answer_inside(walker, self.answerer, asked, (before, after, sighting), act)
        else:
            answer = self.answerer.answer(asked, before, after, sighting) if self.answerer else None
        act(Command(Action(DONE), box=box) if answer is None else Command(answer=answer, box=box))

    def _walk(self, walker: Walker, percept: Percept, act: Act, most_steps: int) -> tuple[Percept, int]:
        """Walk until the walker is there; what is perceived then, and how many steps are left."""
        while most_steps and (action := walker.next_action(percept)) is not None:
            percept, most_steps = act(Command(Action(action))), most_steps - 1
        return percept, most_steps

    def _answer_inside(
        self,
        walker: Inspecting,
        answerer: Weighing,
        asked: Question,
        seen: tuple[Percept, Percept, Sighting | None],
        act: Act,
    ) -> str:
        """Look into what is open from other places, too; answers from all views count by how much of it they show."""
        before, view, where = seen
        inside, steps = walker.inside_of(view), LOOKING_STEPS
        total: defaultdict[str, float] = defaultdict(float)
        for looks_left in reversed(range(self.looks + 1)):
            for answer, chance in answerer.chances(asked, before, view, where).items():
                total[answer] += chance * (1 + int(np.count_nonzero(inside)))
            if not looks_left:
                break
            walker.look_inside(view)
            there, steps = self._walk(walker, view, act, steps)
            if there.pose == view.pose:
                break
            view, inside = there, walker.inside_of(there)
            where = Sighting.of_mask(inside)
        return max(total, key=total.__getitem__)

    def _manipulate(
        self, asked: Question, memory: WalkMemory, before: Percept, sighting: Sighting | None, act: Act
    ) -> Percept:
        """Try what is to be done until it succeeds; what is perceived then. `before` itself if nothing was tried."""
        after = before
        wished = self.manipulator.actions(asked, memory, before, sighting) if self.manipulator else ()
        for manipulation in wished[:MOST_MANIPULATIONS]:
            after = act(Command(manipulation, box=sighting.box if sighting else None))
            if after.succeeded:
                break
        return after
