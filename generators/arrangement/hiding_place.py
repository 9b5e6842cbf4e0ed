"""A place in or under which things can be hidden; `hiding_places` finds them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NewType

from remqa_data.catalog import Manipulation
from remqa_data.generators.arrangement.areas import Area, Spot
from remqa_data.geometry.types import Vec3
from remqa_data.sim.navigation.viewpoints import AgentPose

PlaceKey = NewType("PlaceKey", tuple[str, str])
"""An object and what is done with it: what is in it and what is under it are brought to light in two ways."""


@dataclass(frozen=True)
class HidingPlace:
    """An object in or under which things can be hidden.

    Attributes
    ----------
    object_id, type : str
        The object.
    manipulation : {"Open", "Pickup", "Move"}
        What brings the hidden things to light.
    relation : {"in", "under"}
        Where they are.
    goal : AgentPose
        A standing pose before the object's front that sees the object, from which the arm reaches it, and which sees the
        hidden things after the manipulation, but not before: of all such, the one to which they look largest. What the
        manipulation moves stays clear of the agent there.
    other_goals : tuple of AgentPose
        Up to four more, the best first.
    spots : tuple of Spot
        Room for that many things of middling size at the same time, in the room with everything closed.
    areas : tuple of Area
        Where hidden things may lie: all of it is in sight from the goal after the manipulation.
    interior : tuple of Area
        Where anything could lie that the manipulation reveals, in sight or not.
    provable : frozenset of str
        Types kept there of which one would see from the goal that none is there, if the place were empty.
    floor_z : float
        Height of the room's floor, on which the agent stands, metres.
    move_to : tuple of float or None
        Where the centre of the object goes when it is moved aside.
    """

    object_id: str
    type: str
    manipulation: Manipulation
    relation: Literal["in", "under"]
    goal: AgentPose
    other_goals: tuple[AgentPose, ...]
    spots: tuple[Spot, ...]
    areas: tuple[Area, ...]
    interior: tuple[Area, ...]
    provable: frozenset[str]
    floor_z: float
    move_to: Vec3 | None = None

    @property
    def key(self) -> PlaceKey:
        """What tells it from the room's other places."""
        return PlaceKey((self.object_id, self.manipulation))
