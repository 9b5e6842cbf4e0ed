"""Manipulation by a rule: what the question's words and the target's type ask for."""

from __future__ import annotations

from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.sim.agent.actions import OPEN, PICK_UP, PULL, PUSH, Action

NAMES = {"Open": (OPEN,), "Pickup": (PICK_UP,), "Move": (PUSH, PULL)}
"""What is tried, in this order: what cannot be pushed away is pulled."""
FAR_M = 0.7
"""How far things are pushed if nothing is in the way, so that they uncover what lay under them. A little less than one action
goes: a replay puts them where they have come to rest, and goes no farther."""


class RuleManipulator:
    """Opens what is asked to be looked into; of what is asked to be looked under, picks up what can be, and moves the rest."""

    def actions(self, asked: Question, sighting: Sighting | None) -> tuple[Action, ...]:
        """See `remqa_data.agents.parts.interfaces.Manipulator`; acts on the point of the sighting."""
        if sighting is None or asked.manipulation is None:
            return ()
        metres: tuple[float, ...] = (FAR_M,) if asked.manipulation == "Move" else ()
        return tuple(Action(name, sighting.point, metres) for name in NAMES[asked.manipulation])
