"""Manipulation by a rule: what the question's words and the target's type ask for."""

from __future__ import annotations

from collections.abc import Iterator

from remqa_data.agents.knowledge.instance import Instance, choose_instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.geometry.types import Vec3
from remqa_data.sim.agent.actions import MOVE, OPEN, PICK_UP, Action

NAMES = {"Open": OPEN, "Pickup": PICK_UP}
GAP_M = 0.02
"""What is moved aside goes by its own size and so much more, so that it uncovers what lay under it."""


class RuleManipulator:
    """Opens what is asked to be looked into; of what is asked to be looked under, picks up what can be, and moves the rest."""

    def actions(
        self, asked: Question, memory: WalkMemory, percept: Percept, sighting: Sighting | None
    ) -> tuple[Action, ...]:
        """See `remqa_data.agents.parts.interfaces.Manipulator`; acts on the point of the sighting."""
        if sighting is None or asked.manipulation is None:
            return ()
        if asked.manipulation != "Move":
            return (Action(NAMES[asked.manipulation], sighting.point),)
        instance = choose_instance(asked.target, memory)
        if instance is None:
            return ()
        return tuple(Action(MOVE, sighting.point, place) for place in places_beside(instance, percept.pose.yaw_deg))


def places_beside(instance: Instance, yaw_deg: float) -> Iterator[Vec3]:
    """Where the centre of an object could go, metres: to both sides as the agent sees it, then away, then towards it."""
    x, y, z = instance.centre.tolist()
    x0, y0, _, x1, y1, _ = instance.box
    along_x, along_y = (x1 - x0 + GAP_M, 0.0), (0.0, y1 - y0 + GAP_M)
    looks_along_x = round(yaw_deg / 90) % 2 == 0
    aside, ahead = (along_y, along_x) if looks_along_x else (along_x, along_y)
    sign = 1.0 if round(yaw_deg / 90) % 4 in (0, 1) else -1.0
    for (dx, dy), way in ((aside, sign), (aside, -sign), (ahead, sign), (ahead, -sign)):
        yield x + way * dx, y + way * dy, z
