"""The agent's arm: a Kinova Jaco2 whose shoulder slides up and down a column that turns on the agent's base.

A manipulation happens when the ball around the hand reaches the target; fingers do not grasp. The arm moves in straight
lines of its joint space, and stops at the last step before it would push into anything.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.assets.core.fitting import vec
from remqa_data.assets.core.model import Surface
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.body import robot_poses, robot_surfaces
from remqa_data.sim.arm.elbow import elbow_way
from remqa_data.sim.arm.load import NOTHING, Load
from remqa_data.sim.arm.obstacles import Obstacles
from remqa_data.sim.arm.postures import BALL_RADII_M, HOME, ArmBase, ArmState, balls, link_poses, postures_at
from remqa_data.sim.arm.search import HandGoals, Search, Way
from remqa_data.sim.arm.targets import Targets
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.physics.world import World

__all__ = ["HOME", "Arm", "ArmBase", "ArmMove", "ArmState"]

NOT_WITHIN_REACH = "not within reach"
HAND_RADIUS_M = 0.06
TOUCH_M = 0.1
"""A hand that is sent into an object may stop so far from there to touch it."""


@dataclass(frozen=True)
class ArmMove:
    """What came of a movement.

    Attributes
    ----------
    success : bool
        Whether the arm got where it should.
    error : str
        "", "... is blocking", which names what was met, or "not within reach".
    state : ArmState
        How the arm is held now.
    blocked_by : str or None
        Id of the object that the arm met; "structure" for the building, "Agent" for its own column and base, "another Agent".
    """

    success: bool
    error: str
    state: ArmState
    blocked_by: str | None = None


class Arm:
    """One arm; it knows nothing of the agent but where it stands.

    Parameters
    ----------
    world : World
        The room.
    load : callable
        Gives what the hand holds now; by default nothing, whatever it holds.
    others : callable
        Gives where other agents stand now.

    Attributes
    ----------
    state : ArmState
        How the arm is held; may be set.
    hand_radius_m : float
        Radius of the ball around the hand; what it touches is reached. May be set, to 0.03 m and more: a smaller ball
        would be inside of the finger tips.
    """

    def __init__(
        self,
        world: World,
        load: Callable[[], Load] = lambda: NOTHING,
        others: Callable[[], Sequence[ArmBase]] = lambda: (),
    ) -> None:
        self.world, self._load, self._others = world, load, others
        self.state = HOME
        self.hand_radius_m = HAND_RADIUS_M
        self._posed: tuple[tuple[ArmBase, ArmState] | None, F64] = (None, np.empty(0))
        self._obstacles = Obstacles(world)
        self._targets = Targets(world)

    def shoulder(self, base: ArmBase) -> Vec3:
        """The shoulder in the room, metres: from here the reach is measured."""
        return vec(arithmetic.moved([0.0, 0.0, jaco.SHOULDER_M], self.link_poses(base)[0]))

    def hand(self, base: ArmBase) -> Vec3:
        """Centre of the hand's ball in the room, metres."""
        return vec(self.link_poses(base)[jaco.HAND][:, 3])

    def link_poses(self, base: ArmBase) -> F64:
        """(8, 4, 4) poses in the room of the arm's foot, its six links and its hand."""
        if self._posed[0] != (base, self.state):
            self._posed = ((base, self.state), link_poses(base, self.state.posture()[None])[0])
        return self._posed[1].copy()

    def held_out(self, base: ArmBase) -> tuple[F64, F64]:
        """(n, 3) middles and (n,) radii of balls in the room that the arm and what it holds fill: none while it is folded."""
        load = self._load()
        if self._passes_everywhere(load):
            return NOTHING
        links = self.link_poses(base)
        middles = np.concatenate([balls(links[None])[0], np.asarray(self.hand(base)) + load.offsets])
        return middles, np.concatenate([BALL_RADII_M, load.radii])

    def touched(self, point: Vec3) -> list[str]:
        """Ids of the objects that the hand's ball would touch if it were at a point, nearest first; not of what is held."""
        gaps = self._obstacles.gaps(point)
        near = [index for index in np.argsort(gaps, kind="stable").tolist() if gaps[index] <= self.hand_radius_m]
        return [self.world.ids[index] for index in near if self.world.ids[index] not in self.world.held]

    @property
    def is_folded(self) -> bool:
        """Whether the whole arm is above the agent's base, and so passes wherever the agent does, but for what it holds."""
        return self.state.joints == HOME.joints

    def blocker(self, bases: Sequence[ArmBase]) -> str | None:
        """What the arm, held as it is, meets first while its agent walks or turns, by the name that it has in errors.

        What it is in already stops it only after it has come out of that.

        Parameters
        ----------
        bases : sequence of ArmBase
            Where the agent stands now, then wherever it passes, in small steps.
        """
        load, start = self._load(), bases[0]
        if self._passes_everywhere(load):
            return None
        walk = max(math.dist((start.x, start.y), (base.x, base.y)) for base in bases)
        owner = self._search(start, load=load, walk_m=walk).met_on_the_way(bases)
        return None if owner is None else self._obstacles.name(owner)

    def blocker_of_load(self, base: ArmBase, rotation: F64) -> str | None:
        """What the load meets first if the hand turns with it by a (3, 3) rotation about axes of the room, or None."""
        load = self._load()
        owner = self._search(base, load=load).met_by_turning_load(rotation) if len(load.radii) else None
        return None if owner is None else self._obstacles.name(owner)

    def is_free(self, base: ArmBase) -> bool:
        """Whether the arm, held as it is, would be in nothing if the agent stood there."""
        load = self._load()
        return self._passes_everywhere(load) or self._search(base, load=load).starts_free()

    def move_hand(
        self, base: ArmBase, target: Vec3, *, ignore: Collection[str] = (), free_height: bool = False
    ) -> ArmMove:
        """Bring the hand to a point, pointing wherever it likes.

        Parameters
        ----------
        base : ArmBase
            Where the agent stands.
        target : tuple of float
            Where the centre of the hand's ball should go, metres in the room.
        ignore : collection of str
            Objects that the hand may touch; the rest of the arm may not.
        free_height : bool
            Whether the column may slide and turn too.

        Returns
        -------
        What came of it. When something is in the way of every movement that was tried, the arm stops before it.

        Raises
        ------
        UnknownNameError
            If an object to ignore is not there.
        """
        point = np.array(target, dtype=np.float64)
        away = point - np.array(self.shoulder(base))
        goals = HandGoals(point[None], away[None] / max(float(arithmetic.length(away)), 1e-9))
        return self._after(self._search(base, ignore, self._load()).to(goals, free_column=free_height))

    def turn_hand(self, base: ArmBase, rotation: F64) -> ArmMove:
        """Turn the hand by a (3, 3) rotation about axes of the room; its middle and the column stay where they are."""
        pose = self.link_poses(base)[jaco.HAND]
        pose[:3, :3] = arithmetic.product(rotation, pose[:3, :3])
        return self._after(self._search(base).to_one_of(postures_at(base, pose, self.state.posture())))

    def turn_elbow(self, base: ArmBase, angle: float) -> ArmMove:
        """Lead the elbow round the line from the shoulder to the hand, radians; see `elbow_angle`.

        The hand's middle and the column stay where they are; where the hand points changes as little as need be.
        """
        way = elbow_way(base, self.state.posture(), angle)
        return self._after(None if way is None else self._search(base).along(*way))

    def set_base_height(self, base: ArmBase, height_m: float) -> ArmMove:
        """Slide the shoulder to a height above the floor, metres, as far as it is free; the joints stay as they are."""
        if not AGENT.shoulder_low_m <= height_m <= AGENT.shoulder_high_m:
            return ArmMove(False, NOT_WITHIN_REACH, self.state)
        posture = self.state.posture()
        posture[0] = height_m
        return self._after(self._search(base, load=self._load()).along(posture))

    def reach_object(self, base: ArmBase, object_id: str) -> ArmMove:
        """Touch an object with the hand's ball; the column slides and turns as it likes.

        The points of the object's surface that are nearest to the shoulder are tried first.

        Raises
        ------
        UnknownNameError
            If there is no such object.
        """
        goals = self._targets.goals(base, object_id, self.hand_radius_m)
        return self._after(self._search(base, [object_id]).to(goals, free_column=True, from_outside=True))

    def touch(self, base: ArmBase, object_id: str, near: Vec3) -> ArmMove:
        """Touch an object with the hand's ball, at most `TOUCH_M` from a point, the nearest places first.

        The shoulder stays where it is.

        Raises
        ------
        UnknownNameError
            If there is no such object.
        """
        goals = self._targets.goals(base, object_id, self.hand_radius_m)
        away = arithmetic.length(goals.points - np.array(near))
        order = np.argsort(np.round(away, 6), kind="stable")[: np.count_nonzero(away <= TOUCH_M)]
        goals = HandGoals(goals.points[order], goals.axes[order])
        return self._after(
            self._search(base, [object_id], self._load()).to(goals, free_column=False, from_outside=True)
        )

    def parts(self) -> tuple[tuple[Surface, ...], ...]:
        """Surfaces of the whole agent, part by part: base, column, head, carriage, the arm's foot and links."""
        return robot_surfaces()

    def poses(self, base: ArmBase, camera_height_m: float = AGENT.camera_height_m) -> F64:
        """(n, 4, 4) poses of the parts in the room; the head is at the camera's height above the floor."""
        return robot_poses(base, self.state, camera_height_m)

    def _passes_everywhere(self, load: Load) -> bool:
        """Whether the arm and what it holds pass wherever the agent does."""
        return self.is_folded and not len(load.radii)

    def _search(
        self, base: ArmBase, touchable: Collection[str] = (), load: Load = NOTHING, walk_m: float = 0.0
    ) -> Search:
        return Search(self._obstacles, base, self.state.posture(), touchable, load, self._others(), walk_m)

    def _after(self, way: Way | None) -> ArmMove:
        if way is None:
            return ArmMove(False, NOT_WITHIN_REACH, self.state)
        self.state = ArmState.of(way.posture)
        if way.blocker is None:
            return ArmMove(True, "", self.state)
        name = self._obstacles.name(way.blocker)
        return ArmMove(False, f"{name} is blocking", self.state, name)
