"""An embodied agent in a room: where it stands and looks, what it holds, and what it can do.

What the room refuses is an `ActionResult` that says why, in AI2-THOR's words; misuse, such as an unknown object or an
openness of 2, is an exception. A refused action changes nothing, but for an arm that sets out and is stopped: it stays there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from remqa_data.catalog import object_type
from remqa_data.errors import ActionError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Flags, Vec2, Vec3
from remqa_data.sim.agent import handling
from remqa_data.sim.agent.body import Body, direction
from remqa_data.sim.agent.receptacles import put_into
from remqa_data.sim.agent.results import SUCCEEDED, ActionResult
from remqa_data.sim.arm.postures import HOME
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

if TYPE_CHECKING:
    from remqa_data.sim.arm.arm import Arm, ArmBase, ArmMove, ArmState

__all__ = ["Agent", "Embodiment", "Hands"]

Hands = Literal["arm", "reach", "near"]
"""What it takes to act on a thing. "arm": the arm finds a way on which its hand touches it. "reach": the agent sees it
and it is nowhere farther from the shoulder than the arm is long. "near": the agent sees it within its visibility
distance, as AI2-THOR's agent without an arm."""


SWING_STEP = 0.05
"""A door or drawer is looked at in such steps of its openness on its way."""
LEAST_OPEN = 0.15
"""Where the agent lets a thing open no farther than this, it does not open at all."""


class Agent(Body):
    """An agent in a world.

    Parameters
    ----------
    world : World
        The room.
    view : WorldView
        Draws the room.
    position : sequence of float
        x and y of the middle of its base, metres; a third number is ignored, it stands on the floor.
    yaw_deg : float
        Heading, counter-clockwise from +x.
    horizon_deg : float
        Tilt of the camera, positive looks down.
    is_standing : bool
        Whether it stands or crouches.
    embodiment : Embodiment
        Its body.
    hands : {"arm", "reach", "near"}
        What it takes to act on a thing.
    number : int
        Which one of the agents in the room it is.
    """

    def __init__(
        self,
        world: World,
        view: WorldView,
        position: Sequence[float],
        yaw_deg: float,
        horizon_deg: float = 0.0,
        is_standing: bool = True,
        *,
        embodiment: Embodiment | None = None,
        hands: Hands = "reach",
        number: int = 0,
    ) -> None:
        super().__init__(world, view, position, yaw_deg, horizon_deg, is_standing, embodiment=embodiment)
        self.hands: Hands = hands
        self.number = number
        self._arm: Arm | None = None

    @property
    def held(self) -> str | None:
        """Id of what it holds."""
        return self.world.held_by(self.number)

    @property
    def arm(self) -> Arm:
        """Its arm, which is folded until it is used."""
        if self._arm is None:
            self._arm = self._new_arm()
        return self._arm

    def _new_arm(self) -> Arm:
        from remqa_data.sim.arm.arm import Arm

        return Arm(self.world)

    @property
    def arm_state(self) -> ArmState:
        """How its arm is held."""
        return HOME if self._arm is None else self._arm.state

    def fold_arm(self) -> None:
        """Let the whole arm be above the base."""
        if self._arm is not None:
            self._arm.state = HOME

    @property
    def base(self) -> ArmBase:
        """Where it stands, as its arm wants to know it."""
        from remqa_data.sim.arm.arm import ArmBase

        return ArmBase(self.x, self.y, self.yaw_deg, self.world.scene.floor_z)

    # ---- manipulating

    def open(self, object_id: str, openness: float = 1.0, force: bool = False) -> ActionResult:
        """Open an object to an openness from 0 to 1; what lies in its moving parts comes along.

        It opens less far where the room does not let it (`World.most_open`), or where the agent stands in its way.
        """
        if not 0.0 <= openness <= 1.0:
            raise ActionError(f"openness {openness} is not between 0 and 1")
        was = self.world.state(object_id).openness
        if not self.world.assets[object_id].is_openable:
            return ActionResult(False, f"{object_id} is not openable")
        goal = min(openness, self.world.most_open(object_id))
        if openness > 0.0 and goal == 0.0:
            return ActionResult(False, f"{object_id} cannot be opened: there is no room for it")
        if abs(was - goal) < 1e-6:
            return self._leave_as_it_is(object_id, openness, force)
        if force:
            return ActionResult(True, value=self.world.open(object_id, goal))
        reached = self._until_it_meets_an_agent(object_id, was, goal, (self.x, self.y))
        refusal = self.refusal(object_id)
        if refusal is None and reached != goal and not reached > was + LEAST_OPEN:
            refusal = ActionResult(False, f"Agent is blocking {object_id} from moving")
        refusal = refusal or self.reach(object_id)
        return refusal or ActionResult(True, value=self.world.open(object_id, reached))

    def _leave_as_it_is(self, object_id: str, openness: float, force: bool) -> ActionResult:
        """What comes of opening or closing what is so already."""
        return ActionResult(False, f"{object_id} is already {'closed' if openness == 0.0 else 'open'}")

    def opens_to(self, object_id: str, position: Vec2) -> float:
        """How far a closed object opens before an agent that stands at a position, from 0 to 1."""
        return self._until_it_meets_an_agent(object_id, 0.0, self.world.most_open(object_id), position)

    def close(self, object_id: str, force: bool = False) -> ActionResult:
        """Close an object."""
        return self.open(object_id, 0.0, force)

    def pick_up(self, object_id: str, force: bool = False, along: Sequence[str] = ()) -> ActionResult:
        """Take an object into the hand, and others along; what lay on them falls, but for what `load` says."""
        if not object_type(self.world.type_of(object_id)).pickupable:
            return ActionResult(False, f"{object_id} is not pickupable")
        if self.held is not None:
            return ActionResult(False, f"cannot pick up {object_id}: already holding {self.held}")
        if object_id in self.world.held:
            return ActionResult(False, f"agent {self.world.held[object_id]} holds {object_id}")
        refusal = self.access_refusal(object_id, force)
        if refusal is None:
            taken = (object_id, *along)
            borne = {other for name in taken for other in self.world.borne(name)}
            _, *load = dict.fromkeys(name for one in taken for name in (one, *self.load(one)))
            self.world.pick_up(object_id, self.number, load)
            if borne:
                self._let_fall(borne)
        return refusal or SUCCEEDED

    def _let_fall(self, borne: Collection[str]) -> None:
        """Let fall what lay on what was taken and has not come along, and all else that is not at rest."""
        handling.settle(self.world)

    def load(self, object_id: str) -> list[str]:
        """Ids of what comes along when an object is picked up."""
        return []

    def put(
        self,
        receptacle_id: str,
        force: bool = False,
        near: Vec2 | None = None,
        whole: str | None = None,
        are_near: Callable[[F64], Flags] | None = None,
    ) -> ActionResult:
        """Put what is held into or onto a receptacle: at the nearest free place that the agent sees, or else at any.

        That is the nearest one to the agent, or to another x and y, metres. What the agent has to get to is the receptacle,
        or the `whole` that it is a part of, such as the sink around a basin. `are_near` says of (n, 3) points in the room,
        metres, (n,) which of them come before all others.
        """
        if self.held is None:
            return ActionResult(False, "nothing is held")
        if not object_type(self.world.type_of(receptacle_id)).receptacle:
            return ActionResult(False, f"{receptacle_id} is not a receptacle")
        refusal = self.access_refusal(whole or receptacle_id, force)
        if refusal is not None:
            return refusal
        near = near or (self.x, self.y)
        put = put_into(self.world, self.held, receptacle_id, near, self.are_seen, self._is_beside, are_near)
        return self._released(put)

    def drop(self) -> ActionResult:
        """Let go of what is held; it falls in front of the agent, or under the hand where the arm is in use."""
        if self.held is None:
            return ActionResult(False, "nothing is held")
        return self._released(handling.drop_at(self.world, self.held, self.drop_spots()))

    def drop_spots(self) -> list[Vec3]:
        """Where it lets go of what it holds, the best first: metres in the room."""
        spots = [self.arm.hand(self.base)] if self.hands == "arm" else []
        cos, sin = direction(self.yaw_deg)
        for ahead, height in handling.DROP_SPOTS_M:
            spots.append((self.x + ahead * cos, self.y + ahead * sin, self.world.scene.floor_z + height))
        return spots

    def move_object(self, object_id: str, position: Vec3) -> ActionResult:
        """Bring the centre of an object somewhere near, metres, with what is in or on it; what is under it stays.

        Only what is fixed may be in the way there. Neither the way to it, nor what bears the object there, is looked at.
        """
        if not object_type(self.world.type_of(object_id)).is_loose:
            return ActionResult(False, f"{object_id} is not moveable")
        refusal = self.refusal(object_id)
        if refusal is None and math.dist(self.world.state(object_id).position, position) > self.embodiment.push_m:
            refusal = ActionResult(False, f"{object_id} cannot be moved more than {self.embodiment.push_m} m at once")
        if refusal is None:
            blocker = handling.blocker_at(self.world, object_id, position) or self._body_at(object_id, position)
            refusal = ActionResult(False, f"{blocker} is blocking {object_id}") if blocker else self.reach(object_id)
        if refusal is not None:
            return refusal
        return ActionResult(True, value=self.world.move(object_id, position))

    def push(
        self, object_id: str, distance_m: float = 0.25, angle_deg: float = 0.0, force: bool = False
    ) -> ActionResult:
        """Slide an object away from the agent, or at an angle counter-clockwise from that; it stops before obstacles.

        The result's value is the distance that it was moved, metres.
        """
        if not 0.0 < distance_m <= self.embodiment.push_m:
            raise ActionError(f"a push goes more than 0 and at most {self.embodiment.push_m} m, not {distance_m}")
        if not object_type(self.world.type_of(object_id)).is_loose:
            return ActionResult(False, f"{object_id} is not moveable")
        refusal = self.access_refusal(object_id, force)
        if refusal is not None:
            return refusal
        x, y, _ = self.world.state(object_id).position
        heading = float(arithmetic.arctan2(y - self.y, x - self.x)) + math.radians(angle_deg)
        slide = handling.slide(
            self.world, object_id, heading, distance_m, lambda position: self._body_at(object_id, position)
        )
        if slide.distance_m == 0.0 and slide.blocked_by:
            return ActionResult(False, f"{slide.blocked_by} is blocking {object_id}")
        return ActionResult(True, value=slide.distance_m)

    def pull(self, object_id: str, distance_m: float = 0.25) -> ActionResult:
        """Slide an object towards the agent."""
        return self.push(object_id, distance_m, 180.0)

    def access_refusal(self, object_id: str, force: bool = False) -> ActionResult | None:
        """Why the agent does not get to an object, or None; an arm goes there to find out. With `force` it need not."""
        return None if force else self.refusal(object_id) or self.reach(object_id)

    def refusal(self, object_id: str) -> ActionResult | None:
        """Why the agent cannot act on an object from here, or None; whether an arm gets there is seen when it goes."""
        if object_id in self.world.held:
            return ActionResult(False, f"{object_id} is held")
        return None if self.hands == "arm" else self.out_of_reach(object_id, self.hands)

    def out_of_reach(self, object_id: str, hands: Hands = "reach") -> ActionResult | None:
        """Why hands of a kind, but for an arm's, do not get to an object from here, or None."""
        if object_id not in self.visible_objects():
            return ActionResult(False, f"{object_id} is not visible")
        is_near = (
            self.plan_distance(object_id) <= self.embodiment.visibility_m
            if hands == "near"
            else self.reach_distance(object_id) <= self.embodiment.reach_m
        )
        return None if is_near else ActionResult(False, f"{object_id} is not within reach")

    # ---- the arm

    def reach(self, object_id: str) -> ActionResult | None:
        """Bring the hand to an object, if acting takes the arm; why it does not get there, or None."""
        if self.hands != "arm":
            return None
        result = _of_arm(self.arm.reach_object(self.base, object_id))
        return None if result.success else ActionResult(False, f"{object_id}: {result.error}")

    def move_hand(self, position: Vec3) -> ActionResult:
        """Bring the hand to a point of the room, metres; the shoulder stays at its height."""
        return _of_arm(self.arm.move_hand(self.base, position))

    def set_arm_base(self, height_m: float) -> ActionResult:
        """Slide the shoulder to a height above the floor."""
        return _of_arm(self.arm.set_base_height(self.base, height_m))

    # ---- helpers

    def _prepare_to_move(self) -> None:
        """Fold the arm, so that it meets nothing."""
        self.fold_arm()

    def _until_it_meets_an_agent(self, object_id: str, was: float, goal: float, position: Vec2) -> float:
        """How far a door or drawer can be moved before it touches an agent at a position, if not all the way."""
        frame, asset = self.world.state(object_id).matrix(), self.world.assets[object_id]
        steps = math.ceil(abs(goal - was) / SWING_STEP - 1e-9)
        reached = was
        for k in range(1, steps + 1):
            share = goal if k == steps else was + k / steps * (goal - was)
            links = arithmetic.product(frame, asset.link_poses(share))
            if self.ground.meets_agent(object_id, links, position, first_link=1):
                break
            reached = share
        return reached

    def _is_beside(self, object_id: str) -> bool:
        """Whether an object, which is held out somewhere, is not where the agent stands."""
        links = self.world.link_poses(object_id)
        return self.ground.distance(object_id, links, (self.x, self.y)) > self.embodiment.radius_m

    def _body_at(self, object_id: str, position: Vec3) -> str | None:
        """Whether the agent is in the way of an object that is to be somewhere else; its name in errors, or None."""
        state = replace(self.world.state(object_id), position=position)
        links = state.link_poses(self.world.assets[object_id])
        return "Agent" if self.ground.meets_agent(object_id, links, (self.x, self.y)) else None

    def _released(self, done: handling.Release) -> ActionResult:
        if done.object_id is None:
            return ActionResult(False, done.error)
        return ActionResult(True, value=done.object_id)


def _of_arm(move: ArmMove) -> ActionResult:
    return ActionResult(move.success, move.error, move)
