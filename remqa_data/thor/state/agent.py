"""The agent as AI2-THOR's clients know it: it acts on what its own frames show, whatever their size."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache, cached_property, partial
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import about_z, quaternion_of, rotation_of, snapped_quaternion
from remqa_data.geometry.types import F64, I32, Flags, Vec2, Vec3
from remqa_data.scene import Quaternion
from remqa_data.sim.agent import handling
from remqa_data.sim.agent.agent import Agent, Hands
from remqa_data.sim.agent.body import direction
from remqa_data.sim.agent.results import SUCCEEDED, ActionResult
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.arm import HOME as FOLDED
from remqa_data.sim.arm.arm import Arm, ArmBase
from remqa_data.sim.arm.load import NOTHING, Load, load_of
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.navigation.viewpoints import pixel_counts
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.support import supports
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import Observation, WorldView
from remqa_data.thor.state.settings import FrameSize, Settings
from remqa_data.thor.state.sight import Sight, enough_pixels

HAND: Vec3 = (0.0, -0.16, 0.38)
"""Where AI2-THOR's agent without an arm holds things: metres to the right of its camera, above and ahead of it."""

ASIDE_DEG, ASIDE_M, ASIDE_HIGH_M = (0.0, 45.0, -45.0, 90.0, -90.0, 135.0, -135.0, 180.0), (0.6, 0.8, 1.0), 0.5
"""What would end where an agent stands is let go of in another direction, so far away and so high above the floor."""
CARRY_STEP_M, CARRY_STEP_DEG = 0.02, 1.0
"""In such steps of walking and turning an arm that is carried is looked at."""
RISES_M = (0.0, 0.005, 0.015, 0.03, 0.06)
BACK_M = (0.03, 0.06, 0.1, 0.15, 0.2, 0.3)
"""What an arm lets go of where it touches things is let go of so far above, or so far back towards the agent."""


class ThorAgent(Agent):
    """An agent whose sight is that of the frames that are sent.

    Parameters
    ----------
    world, view, position, yaw_deg
        As of `Agent`.
    settings : Settings
        Field of view, visibility distance, and whether it has an arm.
    frame : FrameSize
        Of its pictures; may change later.
    number : int
        Which one of the room's agents it is.
    others : sequence of ThorAgent
        The agents of the room, this one among them, by their numbers.
    **pose
        `horizon_deg` and `is_standing`, as of `Agent`.

    Attributes
    ----------
    hand_offset : tuple of float
        Where the hand is without an arm, metres to the right of the camera, above and ahead of it.
    """

    def __init__(
        self,
        world: World,
        view: WorldView,
        position: Vec2,
        yaw_deg: float,
        *,
        settings: Settings,
        frame: FrameSize,
        number: int = 0,
        others: Sequence[ThorAgent] = (),
        **pose: Any,
    ) -> None:
        self.frame, self.hand_offset, self._all = frame, HAND, others
        self._passes_agents = False
        self._along: tuple[str, ...] = ()
        body = Embodiment(
            fov_deg=settings.field_of_view,
            step_m=settings.grid_size,
            rotate_deg=settings.rotate_step_degrees,
            visibility_m=settings.visibility_distance,
            least_horizon_deg=-settings.look_up_deg,
            most_horizon_deg=settings.look_down_deg,
        )
        hands: Hands = "arm" if settings.has_arm else "near"
        super().__init__(world, view, position, yaw_deg, embodiment=body, hands=hands, number=number, **pose)
        self._grasp: F64 = np.zeros(3)
        self._usual_turn: F64 | None = None
        self._sight = Sight(world, view, body)

    @cached_property
    def arm(self) -> Arm:
        """See `Agent`; what the hand holds and other agents are in its way."""

        def load() -> Load:
            return load_of(self.world, self.states_of_held(), self.hand_at()) if self.held else NOTHING

        def others() -> list[ArmBase]:
            return [other.base for other in self._all if other is not self and not self._passes_agents]

        return Arm(self.world, load, others)

    def take_over(self, before: ThorAgent) -> None:
        """Hold the hand, and what is in it, as an agent did in whose place it comes, if that had the same kind of hand."""
        if self.hands != before.hands:
            return
        self.hand_offset, self._grasp, self._usual_turn = before.hand_offset, before._grasp, before._usual_turn
        self._along = before._along
        if "arm" in vars(before):  # it has been used
            self.arm.state, self.arm.hand_radius_m = before.arm.state, before.arm.hand_radius_m

    @contextmanager
    def elsewhere(self) -> Iterator[None]:
        """For the length of a block, it may be placed anywhere; then it, its arm and what it holds are as they were."""
        pose, saved = ((self.x, self.y), self.yaw_deg, self.horizon_deg, self.is_standing), self.world.save()
        arm = self.arm.state if "arm" in vars(self) else None
        try:
            yield
        finally:
            self.place(*pose)
            if not self.world.is_as(saved):
                self.world.restore(saved)
            if arm is not None:
                self.arm.state = arm

    def camera(self, width: int | None = None, height: int | None = None) -> Camera:
        """Its eye, by default with the size of its frames."""
        return super().camera(width or self.frame.width, height or self.frame.height)

    def hand_at(self, offset: Vec3 | None = None) -> Vec3:
        """Where the hand is, or with an offset would be; metres in the room."""
        if self.hands == "arm":
            return self.arm.hand(self.base)
        camera = self.camera()
        x, y, z = arithmetic.snapped(
            camera.position + arithmetic.turned(offset or self.hand_offset, camera.rotation().T)
        ).tolist()
        return x, y, z

    def offset_of(self, point: ArrayLike) -> Vec3:
        """The hand's offset at which it is at a (3,) point of the room."""
        camera = self.camera()
        right, up, ahead = arithmetic.turned(np.subtract(point, camera.position), camera.rotation()).tolist()
        return right, up, ahead

    def can_walk(self, start: Vec2, end: Vec2) -> bool:
        """Whether it could walk straight from a place to another one, metres in the room."""
        return self._other_between(start, end) is None and self.ground.is_clear(start, end)

    @contextmanager
    def passing_agents(self, passes: bool = True) -> Iterator[None]:
        """For the length of a block, other agents are not in its way, if it passes them."""
        self._passes_agents = passes
        try:
            yield
        finally:
            self._passes_agents = False

    def can_look(self, degrees: float) -> bool:
        """Whether its camera can be tilted so much farther down."""
        return self.tilt_refusal(self.horizon_deg + degrees) is None

    def change_field_of_view(self, fov_deg: float) -> None:
        """Give its eye another field of view, degrees from the top to the bottom of a frame."""
        self.embodiment = replace(self.embodiment, fov_deg=fov_deg)

    def has_in_frame(self, offset: Vec3) -> bool:
        """Whether a point, metres to the right of the camera, above and ahead of it, is in its frame, seen or not."""
        right, up, ahead = offset
        sine, cosine = arithmetic.sin_cos_deg(self.embodiment.fov_deg / 2)
        tall = ahead * float(sine / cosine)
        return abs(up) <= tall and abs(right) <= tall * self.frame.width / self.frame.height

    def pick_up(self, object_id: str, force: bool = False, along: Sequence[str] = ()) -> ActionResult:
        """Take an object into the hand, which is where it usually is, and others along; all turn with the agent then."""
        middle = self.world.box(object_id).mean(axis=0)
        result = super().pick_up(object_id, force, along)
        if result.success:
            self._along = tuple(along)
            self.hand_offset = HAND
            self._grasp = middle - np.asarray(self.hand_at()) if self.hands == "arm" else np.zeros(3)
            self._usual_turn = None
        return result

    def tilt_held(self, quaternion: Quaternion) -> None:
        """Turn what it holds to a rotation in the room, until the hand rests again."""
        state = self.world.state(str(self.held))
        if self._usual_turn is None:
            self._usual_turn = arithmetic.product(about_z(-self.yaw_deg), rotation_of(state.quaternion))
        self.world.move_alone(str(self.held), state.position, quaternion)

    def rest_hand(self) -> None:
        """Have the hand, if it is no arm's, where it usually is, and what it holds turned as before `tilt_held`."""
        if self.hands == "arm":
            return
        self.hand_offset, turn, self._usual_turn = HAND, self._usual_turn, None
        if self.held is not None and turn is not None:
            quaternion = snapped_quaternion(quaternion_of(arithmetic.product(about_z(self.yaw_deg), turn)))
            self.world.move_alone(self.held, self.world.state(self.held).position, quaternion)

    def load(self, object_id: str) -> list[str]:
        """See `Agent`: what lies in or on a receptacle, if a hand can pick it up."""
        world = self.world
        if not object_type(world.type_of(object_id)).receptacle:
            return []
        found = supports(world, {name: world.box(name) for name in world.ids}, by_agents=True)
        comes = handling.comes_along(world, object_id, found) - world.held.keys()
        return [name for name in world.ids if name in comes and object_type(world.type_of(name)).pickupable]

    def _let_fall(self, borne: Collection[str]) -> None:
        """See `Agent`; what has nothing to do with it stays as it is."""
        if falling := [name for name in self.world.ids if name in borne and name not in self.world.held]:
            handling.settle(self.world, awake=falling)

    @property
    def in_hand(self) -> list[str]:
        """Ids of what its hand itself holds, and not only something that does."""
        if self.held is None:
            return []
        load = self.world.load_of(self.held)
        return [self.held, *(name for name in self._along if name in load)]

    def _arrive(self) -> None:
        """See `Body`; the arm folds if, held as it is, it would be in something there."""
        self._fold_if_in_something()

    def _fold_if_in_something(self) -> None:
        if self.hands == "arm" and not self.arm.is_free(self.base):
            self.arm.state = FOLDED

    def reach(self, object_id: str) -> ActionResult | None:
        """See `Agent`; an arm goes back to where it was."""
        before = self.arm.state if self.hands == "arm" else None
        refusal = super().reach(object_id)
        if before is not None:
            self.arm.state = before
        return refusal

    def _prepare_to_move(self) -> None:
        """See `Body`; an arm is carried as it is held."""

    def _face(self, yaw_deg: float) -> None:
        """See `Body`; what it holds turns with it, and stays upright when it looks up or down."""
        before = self.yaw_deg
        super()._face(yaw_deg)
        if self.yaw_deg != before:
            self.turn_held(about_z(self.yaw_deg - before))

    def turn_hand(self, rotation: F64) -> ActionResult:
        """Turn the arm's hand, and what it holds with it, by a (3, 3) rotation about axes of the room."""
        turned = self.arm.turn_hand(self.base, rotation)
        if turned.success:
            self.turn_held(rotation)
        return ActionResult(turned.success, turned.error)

    def turn_elbow(self, angle: float) -> ActionResult:
        """Lead the arm's elbow round the line from shoulder to hand, radians; what the hand holds turns with it."""
        before = self.arm.link_poses(self.base)[jaco.HAND][:3, :3]
        turned = self.arm.turn_elbow(self.base, angle)
        after = self.arm.link_poses(self.base)[jaco.HAND][:3, :3]
        if turned.success:
            self.turn_held(arithmetic.product(after, before.T))
        return ActionResult(turned.success, turned.error)

    def turn_held(self, rotation: F64) -> None:
        """Turn what is held, if anything, by a (3, 3) rotation about axes of the room.

        An arm's hand turns about its middle, with what it holds; without an arm the middle of what is held stays there.
        """
        world, held = self.world, self.held
        if held is None:
            return
        state = world.state(held)
        from_hand = self._grasp + state.position - world.box(held).mean(axis=0)
        quaternion = snapped_quaternion(quaternion_of(arithmetic.product(rotation, rotation_of(state.quaternion))))
        world.move_alone(held, state.position, quaternion)
        if self.hands == "arm":
            self._grasp = arithmetic.turned(from_hand, rotation) - state.position + world.box(held).mean(axis=0)

    def held_at(self) -> Vec3:
        """Where the middle of the box of what it holds is, metres in the room."""
        x, y, z = arithmetic.snapped(np.asarray(self.hand_at()) + self._grasp).tolist()
        return x, y, z

    def states_of_held(self) -> dict[str, ObjectState]:
        """How what it holds, and its load, would be in the room if they were in the room where they are held, by their ids."""
        world, held = self.world, self.held
        if held is None:
            return {}
        shift, states = np.asarray(self.held_at()) - world.box(held).mean(axis=0), {}
        for name in (held, *world.load_of(held)):
            x, y, z = (world.state(name).position + shift).tolist()
            states[name] = replace(world.state(name), position=(x, y, z))
        return states

    def drop(self, force: bool = False) -> ActionResult:
        """See `Agent`: what falls lies beside the agents, if it can; with `force` it is let go where there is no room, too."""
        if self.held is None:
            return ActionResult(False, "nothing is held")
        spots, floor_z = self.drop_spots(), self.world.scene.floor_z
        for angle, away in product(ASIDE_DEG, ASIDE_M):
            cosine, sine = direction(self.yaw_deg + angle)
            spots.append((self.x + away * cosine, self.y + away * sine, floor_z + ASIDE_HIGH_M))
        before = self.world.save()

        @cache
        def stands_well() -> bool:
            """Whether nothing comes to where the agent stands by itself, such as what leans on a heap."""
            now = self.world.save()
            self.world.restore(before)
            handling.settle(self.world)
            well = self._blocker_at(self.x, self.y) is None
            self.world.restore(now)
            return well

        def leaves_room(object_id: str) -> bool:
            """It may also have pushed something else to where the agent stands."""
            return self._is_beside(object_id) and not (self._blocker_at(self.x, self.y) and stands_well())

        return self._released(handling.drop_at(self.world, self.held, spots, is_clear=leaves_room, force=force))

    def _released(self, done: handling.Release) -> ActionResult:
        """See `Agent`; a hand that has let go rests."""
        result = super()._released(done)
        if result.success:
            self.rest_hand()
        return result

    def open(self, object_id: str, openness: float = 1.0, force: bool = False) -> ActionResult:
        """See `Agent`; with `force` it opens through what is in its way."""
        is_openable = object_id in self.world.ids and self.world.assets[object_id].is_openable
        if not force or not is_openable or not self.world.most_open(object_id) < openness <= 1.0:
            was_free = self.hands != "arm" or self.arm.is_free(self.base)
            result = super().open(object_id, openness, force)
            if result.success and was_free:
                self._fold_if_in_something()  # such as a door that has come to where the hand is
            return result
        if self.world.state(object_id).openness == openness:
            return SUCCEEDED
        return ActionResult(True, value=self.world.open(object_id, openness, force=True))

    def _leave_as_it_is(self, object_id: str, openness: float, force: bool) -> ActionResult:
        """See `Agent`; AI2-THOR minds only whether it could have been done."""
        return (None if force else self.refusal(object_id)) or SUCCEEDED

    def drop_spots(self) -> list[Vec3]:
        """Where it lets go: where its hand is, if it was moved, or where its arm holds the thing, a little above, or nearer."""
        if self.hands != "arm":
            return ([self.hand_at()] if self.hand_offset != HAND else []) + super().drop_spots()
        held = str(self.held)
        origin = np.asarray(self.world.state(held).position) - self.world.box(held).mean(axis=0)
        x, y, z = arithmetic.snapped(np.asarray(self.held_at()) + origin).tolist()
        away = math.dist((x, y), (self.x, self.y))
        nearer = [back / away for back in BACK_M if back < away]
        spots = [(x, y, z + rise) for rise in RISES_M]
        spots += [(x + share * (self.x - x), y + share * (self.y - y), z) for share in nearer]
        return spots + super().drop_spots()

    def _until_it_meets_an_agent(self, object_id: str, was: float, goal: float, position: Vec2) -> float:
        """See `Agent`; nothing opens through another agent either."""
        for place in (position, *((other.x, other.y) for other in self._all if other is not self)):
            goal = super()._until_it_meets_an_agent(object_id, was, goal, place)
        return goal

    def _is_beside(self, object_id: str) -> bool:
        """See `Agent`; nothing is put where another agent stands either."""
        return all(Agent._is_beside(who, object_id) for who in self._all or (self,))

    def _blocker(self, start: Vec2, end: Vec2) -> str | None:
        """See `Body`; another agent is in the way, too, and what the arm meets."""
        blocker = self._other_between(start, end) or super()._blocker(start, end)
        if blocker is not None or self.hands != "arm":
            return blocker
        steps = max(1, math.ceil(math.dist(start, end) / CARRY_STEP_M))
        way = np.linspace(start, end, steps + 1).tolist()
        return self.arm.blocker([replace(self.base, x=x, y=y) for x, y in way])

    def _blocker_of_turn(self, degrees: float) -> str | None:
        """See `Body`; the arm turns along."""
        if self.hands != "arm":
            return None
        swept = float(np.clip(degrees, -360.0, 360.0))
        steps = max(1, math.ceil(abs(swept) / CARRY_STEP_DEG))
        headings = (self.yaw_deg + np.linspace(0.0, swept, steps + 1)).tolist()
        return self.arm.blocker([replace(self.base, yaw_deg=heading) for heading in headings])

    def _blocker_at(self, x: float, y: float) -> str | None:
        """See `Body`."""
        return self._other_between((x, y), (x, y)) or super()._blocker_at(x, y)

    def _other_between(self, start: Vec2, end: Vec2) -> str | None:
        """The agent that stands on a straight way, if any; one may walk away from who is too near."""
        for number, other in enumerate(self._all):
            if other is self or self._passes_agents:
                continue
            way, there = np.subtract(end, start), np.subtract((other.x, other.y), start)
            far = float(way @ way)
            nearest = way * float(np.clip(way @ there / far, 0.0, 1.0)) if far else way
            is_nearer = not far or way @ there > 0
            if is_nearer and math.dist(nearest, there) < 2 * self.embodiment.radius_m:
                return f"Agent {number}"
        return None

    def visible_objects(self, distance_m: float | None = None) -> list[str]:
        """Ids of the objects that its frame shows, in the scene's order; with a distance, those nearer in plan."""
        if distance_m is None:
            return self.seen_in(self.view.instances(self.camera()))
        seen = self._sight.visible(self.camera(), distance_m)
        return [name for name in self.world.ids if name in seen]

    def look_around(self, distance_m: float) -> Callable[[], Collection[str]]:
        """What gives the ids of the objects within a distance in plan that its frame shows now, while the room is as it is."""
        return partial(self._sight.visible, self.camera(), distance_m)

    def look_at(self, picture: Observation, distance_m: float) -> Callable[[], Collection[str]]:
        """What gives the ids of the objects within a distance in plan, from where it is now, that a picture shows."""
        is_near = self._sight.distances((self.x, self.y)) <= distance_m
        return lambda: self.seen_in(picture.objects, is_near)

    def seen_in(self, objects: I32, among: Flags | None = None) -> list[str]:
        """Ids of the objects that a (h, w) image of object indices shows; of (n,) some objects, if these are given."""
        enough = pixel_counts(objects, len(self.world.ids)) >= enough_pixels(objects.shape)
        if among is not None:
            enough &= among
        return [self.world.ids[index] for index in np.flatnonzero(enough)]

    def is_near(self, object_id: str, distance_m: float | None = None) -> bool:
        """Whether an object is within a distance in plan, by default the visibility distance."""
        return self.plan_distance(object_id) <= (self.embodiment.visibility_m if distance_m is None else distance_m)

    def sees(self, object_id: str, distance_m: float | None = None) -> bool:
        """Whether its frame shows an object within a distance in plan, by default the visibility distance."""
        if not self.is_near(object_id, distance_m):
            return False
        index = self.world.ids.index(object_id)
        camera = self.camera()
        pixels = self.view.pixels_of(camera, [object_id])[index]
        return int(pixels) >= enough_pixels((camera.height, camera.width))
