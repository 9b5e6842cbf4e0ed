"""The agent as AI2-THOR's clients know it: it acts on what its own frames show, whatever their size."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache, partial
from itertools import product
from typing import Any, ClassVar, Self

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


class ThorAgent(Agent):
    """An agent whose sight is that of the frames that are sent; its hand is before its camera.

    Parameters
    ----------
    world, view, position, yaw_deg
        As of `Agent`.
    settings : Settings
        Field of view, visibility distance, steps.
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
        Where the hand is, metres to the right of the camera, above and ahead of it.
    """

    KIND_OF_HANDS: ClassVar[Hands] = "near"

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
        super().__init__(
            world, view, position, yaw_deg, embodiment=body, hands=self.KIND_OF_HANDS, number=number, **pose
        )
        self._usual_turn: F64 | None = None
        self._sight = Sight(world, view, body)

    def take_over(self, before: Self) -> None:
        """Hold the hand, and what is in it, as an agent with the same kind of hands did in whose place it comes."""
        self.hand_offset, self._usual_turn, self._along = before.hand_offset, before._usual_turn, before._along

    @contextmanager
    def elsewhere(self) -> Iterator[None]:
        """For the length of a block, it may be placed anywhere; then it and what it holds are as they were."""
        pose, saved = ((self.x, self.y), self.yaw_deg, self.horizon_deg, self.is_standing), self.world.save()
        try:
            yield
        finally:
            self.place(*pose)
            if not self.world.is_as(saved):
                self.world.restore(saved)

    def camera(self, width: int | None = None, height: int | None = None) -> Camera:
        """Its eye, by default with the size of its frames."""
        return super().camera(width or self.frame.width, height or self.frame.height)

    def hand_at(self, offset: Vec3 | None = None) -> Vec3:
        """Where the hand is, or with an offset would be; metres in the room."""
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
        result = super().pick_up(object_id, force, along)
        if result.success:
            self._along, self.hand_offset, self._usual_turn = tuple(along), HAND, None
        return result

    def tilt_held(self, quaternion: Quaternion) -> None:
        """Turn what it holds to a rotation in the room, until the hand rests again."""
        state = self.world.state(str(self.held))
        if self._usual_turn is None:
            self._usual_turn = arithmetic.product(about_z(-self.yaw_deg), rotation_of(state.quaternion))
        self.world.move_alone(str(self.held), state.position, quaternion)

    def rest_hand(self) -> None:
        """Have the hand where it usually is, and what it holds turned as before `tilt_held`."""
        self.hand_offset, turn, self._usual_turn = HAND, self._usual_turn, None
        if self.held is not None and turn is not None:
            quaternion = snapped_quaternion(quaternion_of(arithmetic.product(about_z(self.yaw_deg), turn)))
            self.world.move_alone(self.held, self.world.state(self.held).position, quaternion)

    def load(self, object_id: str) -> list[str]:
        """See `Agent`: what lies in or on a receptacle, if a hand can pick it up."""
        world = self.world
        if not object_type(world.type_of(object_id)).receptacle:
            return []
        found = supports(world, by_agents=True)
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

    def _face(self, yaw_deg: float) -> None:
        """See `Body`; what it holds turns with it, and stays upright when it looks up or down."""
        before = self.yaw_deg
        super()._face(yaw_deg)
        if self.yaw_deg != before:
            self.turn_held(about_z(self.yaw_deg - before))

    def turn_held(self, rotation: F64) -> None:
        """Turn what is held, if anything, by a (3, 3) rotation about axes of the room; its middle stays in the hand."""
        if self.held is not None:
            state = self.world.state(self.held)
            quaternion = snapped_quaternion(quaternion_of(arithmetic.product(rotation, rotation_of(state.quaternion))))
            self.world.move_alone(self.held, state.position, quaternion)

    def held_at(self) -> Vec3:
        """Where the middle of the box of what it holds is, metres in the room."""
        return self.hand_at()

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
            return super().open(object_id, openness, force)
        if self.world.state(object_id).openness == openness:
            return SUCCEEDED
        return ActionResult(True, value=self.world.open(object_id, openness, force=True))

    def _leave_as_it_is(self, object_id: str, openness: float, force: bool) -> ActionResult:
        """See `Agent`; AI2-THOR minds only whether it could have been done."""
        return (None if force else self.refusal(object_id)) or SUCCEEDED

    def drop_spots(self) -> list[Vec3]:
        """See `Agent`; where its hand is comes first, if it was moved."""
        return ([self.hand_at()] if self.hand_offset != HAND else []) + super().drop_spots()

    def _until_it_meets_an_agent(self, object_id: str, was: float, goal: float, position: Vec2) -> float:
        """See `Agent`; nothing opens through another agent either."""
        for place in (position, *((other.x, other.y) for other in self._all if other is not self)):
            goal = super()._until_it_meets_an_agent(object_id, was, goal, place)
        return goal

    def _is_beside(self, object_id: str) -> bool:
        """See `Agent`; nothing is put where another agent stands either."""
        return all(Agent._is_beside(who, object_id) for who in self._all or (self,))

    def _blocker(self, start: Vec2, end: Vec2) -> str | None:
        """See `Body`; another agent is in the way, too."""
        return self._other_between(start, end) or super()._blocker(start, end)

    def _blocker_at(self, x: float, y: float) -> str | None:
        """See `Body`."""
        return self._other_between((x, y), (x, y)) or super()._blocker_at(x, y)

    def _other_between(self, start: Vec2, end: Vec2) -> str | None:
        """The agent that stands on a straight way, if any; one may walk away from who is too near."""
        if self._passes_agents:
            return None
        radius = self.embodiment.radius_m
        for number, other in enumerate(self._all):
            if other is not self and _meets(start, end, radius, other.outline(self.embodiment.height_m)):
                return f"Agent {number}"
        return None

    def outline(self, below_m: float) -> F64:
        """(n, 3) x, y and radius of discs that others do not walk into, metres: its body, what of an arm is below a height."""
        return np.array([(self.x, self.y, self.embodiment.radius_m)])

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


def _meets(start: Vec2, end: Vec2, radius_m: float, discs: F64) -> bool:
    """Whether who walks straight runs into one of (n, 3) discs; not into those that the way leads away from at once."""
    way, away = np.subtract(end, start), discs[:, :2] - start
    far, along = float(way @ way), away @ way
    nearest = np.clip(along / far, 0.0, 1.0)[:, None] * way if far else np.zeros_like(away)
    is_met = arithmetic.length(away - nearest) < radius_m + discs[:, 2]
    return bool((is_met & ((along > 0.0) | (far == 0.0))).any())
