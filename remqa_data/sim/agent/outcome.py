"""Whether a thing is manipulated: judged by how the room is, and not by what the agent says that it has done.

docs/METRICS.md says why the limits are what they are.
"""

from __future__ import annotations

from dataclasses import dataclass

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Vec2
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.world import World

OPEN_SHARE = 0.8
"""A thing is open if it is open at least so far, as a share of how far it is in the question's end frame."""
ROUNDING = 1e-9


@dataclass(frozen=True)
class Wanted:
    """The manipulation that a question takes.

    Attributes
    ----------
    kind : str
        "Open", "Move" or "Pickup".
    object_id : str
        What it must be done to; it is closed at first.
    goal : (float, float)
        x, y of the first goal pose, from which the end frame is seen, metres.
    """

    kind: str
    object_id: str
    goal: Vec2


@dataclass(frozen=True)
class Before:
    """How an object is before it is manipulated, to tell afterwards whether it has been.

    Attributes
    ----------
    wanted : Wanted
    state : ObjectState
    opens_to : float
        How far it opens before an agent that stands at the goal; 0 unless it is to be opened.
    """

    wanted: Wanted
    state: ObjectState
    opens_to: float


def look_before(agent: Agent, wanted: Wanted) -> Before:
    """Note how an object is, before the manipulation."""
    opens_to = agent.opens_to(wanted.object_id, wanted.goal) if wanted.kind == "Open" else 0.0
    return Before(wanted, agent.world.state(wanted.object_id), opens_to)


def is_manipulated(world: World, before: Before) -> bool:
    """Whether what an object hid lies open now, as it does in the question's end frame.

    Open: it is open to at least `OPEN_SHARE` of what it opens before an agent that stands at the goal. Pickup: the agent
    holds it. Move: it stands in the room, and nothing is under it that was under it before: its centre has gone, in plan and
    along one of its own sides, at least as far as that side is long.
    """
    object_id = before.wanted.object_id
    if before.wanted.kind == "Open":
        least = OPEN_SHARE * before.opens_to - ROUNDING
        return world.state(object_id).openness >= max(least, ROUNDING)
    if before.wanted.kind == "Pickup":
        return object_id in world.held
    return object_id not in world.held and _is_aside(world, object_id, before.state)


def _is_aside(world: World, object_id: str, before: ObjectState) -> bool:
    (x, y, _), (was_x, was_y, _) = world.state(object_id).position, before.position
    sideways, ahead, _ = arithmetic.turned_back([x - was_x, y - was_y, 0.0], before.matrix()[:3, :3])
    width, depth, _ = world.assets[object_id].spec.size
    return bool(abs(sideways) >= width - ROUNDING or abs(ahead) >= depth - ROUNDING)
