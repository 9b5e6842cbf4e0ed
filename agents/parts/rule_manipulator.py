"""Manipulation by a rule: what the question's words and the target's type ask for."""

from __future__ import annotations

from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.sim.agent.actions import OPEN, PICK_UP, PULL, PUSH, Action

NAMES = {"Open": (OPEN,), "Pickup": (PICK_UP,), "Move": (PUSH, PULL)}
"""What is tried, in this order. What is pushed goes away from the agent, and gives way to none: then it is pulled."""


class RuleManipulator:
    """Opens what is asked to be looked into; of what is asked to be looked under, picks up what can be, and moves the rest."""

    def actions(self, asked: Question, sighting: Sighting | None) -> tuple[Action, ...]:
        """See `remqa_data.agents.parts.interfaces.Manipulator`; acts on the point of the sighting."""
        if sighting is None or asked.manipulation is None:
            return ()
        return tuple(Action(name, sighting.point) for name in NAMES[asked.manipulation])
