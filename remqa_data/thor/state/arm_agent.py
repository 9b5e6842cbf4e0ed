"""The agent of arm mode, as in ManipulaTHOR: its arm is carried as it is held, and what it or its load meets is in the way."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec2, Vec3
from remqa_data.sim.agent.agent import Hands
from remqa_data.sim.agent.results import SUCCEEDED, ActionResult
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.arm import Arm, ArmBase, ArmMove
from remqa_data.sim.arm.load import NOTHING, Load, load_of
from remqa_data.thor.state.agent import ThorAgent

CARRY_STEP_M, CARRY_STEP_DEG = 0.02, 1.0
"""In such steps of walking and turning an arm that is carried is looked at."""
RISES_M = (0.0, 0.005, 0.015, 0.03, 0.06)
BACK_M = (0.03, 0.06, 0.1, 0.15, 0.2, 0.3)
"""What an arm lets go of where it touches things is let go of so far above, or so far back towards the agent."""


class ArmAgent(ThorAgent):
    """An agent whose hand is that of its arm. Parameters as of `ThorAgent`."""

    KIND_OF_HANDS: ClassVar[Hands] = "arm"

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._grasp: F64 = np.zeros(3)

    def _new_arm(self) -> Arm:
        """See `Agent`; what the hand holds and other agents are in its way."""

        def load() -> Load:
            return load_of(self.world, self.states_of_held(), self.hand_at()) if self.held else NOTHING

        def others() -> list[ArmBase]:
            return [other.base for other in self._all if other is not self and not self._passes_agents]

        return Arm(self.world, load, others)

    def take_over(self, before: Self) -> None:
        """See `ThorAgent`; the arm is held as that one's was."""
        super().take_over(before)
        self._grasp = before._grasp
        self.arm.state, self.arm.hand_radius_m = before.arm.state, before.arm.hand_radius_m

    @contextmanager
    def elsewhere(self) -> Iterator[None]:
        """See `ThorAgent`; the arm is as it was, too."""
        before = self.arm_state
        try:
            with super().elsewhere():
                yield
        finally:
            if self.arm_state != before:
                self.arm.state = before

    # ---- the hand, and what it holds

    def hand_at(self, offset: Vec3 | None = None) -> Vec3:
        """Where the hand is, metres in the room; it is nowhere else before the camera."""
        return self.arm.hand(self.base)

    def held_at(self) -> Vec3:
        """See `ThorAgent`; where it was in the hand when that took hold of it."""
        x, y, z = arithmetic.snapped(np.asarray(self.hand_at()) + self._grasp).tolist()
        return x, y, z

    def rest_hand(self) -> None:
        """See `ThorAgent`; an arm stays as it is."""

    def pick_up(self, object_id: str, force: bool = False, along: Sequence[str] = ()) -> ActionResult:
        """See `ThorAgent`; the hand takes hold of an object where it is."""
        middle = self.world.box(object_id).mean(axis=0)
        result = super().pick_up(object_id, force, along)
        if result.success:
            self._grasp = middle - np.asarray(self.hand_at())
        return result

    def turn_held(self, rotation: F64) -> None:
        """See `ThorAgent`; it turns about the middle of the hand."""
        if self.held is None:
            return
        before = self.world.state(self.held).position - self.world.box(self.held).mean(axis=0)
        super().turn_held(rotation)
        after = self.world.state(self.held).position - self.world.box(self.held).mean(axis=0)
        self._grasp = arithmetic.turned(self._grasp + before, rotation) - after

    def turn_hand(self, rotation: F64) -> ActionResult:
        """Turn the hand, and what it holds with it, by a (3, 3) rotation about axes of the room."""
        return self._turn(lambda: self.arm.turn_hand(self.base, rotation), rotation)

    def turn_elbow(self, angle: float) -> ActionResult:
        """Lead the elbow round the line from shoulder to hand, radians; what the hand holds turns with it."""
        return self._turn(lambda: self.arm.turn_elbow(self.base, angle))

    def _turn(self, movement: Callable[[], ArmMove], rotation: F64 | None = None) -> ActionResult:
        """Let the arm move its hand, whose middle stays, and turn what that holds by as much, or by what is known of it.

        If what it holds, lying where it lies in the hand, would meet something, all stays as it is.
        """
        before, axes = self.arm.state, self.arm.link_poses(self.base)[jaco.HAND][:3, :3]
        turned = movement()
        if not turned.success or self.held is None:
            return ActionResult(turned.success, turned.error)
        if rotation is None:
            rotation = arithmetic.product(self.arm.link_poses(self.base)[jaco.HAND][:3, :3], axes.T)
        if (blocker := self.arm.blocker_of_load(self.base, rotation)) is not None:
            self.arm.state = before
            return ActionResult(False, f"{blocker} is blocking", blocked_by=blocker)
        self.turn_held(rotation)
        return SUCCEEDED

    def drop_spots(self) -> list[Vec3]:
        """See `Agent`; where the arm holds the thing, a little above, or nearer to the agent, comes first."""
        held = str(self.held)
        origin = np.asarray(self.world.state(held).position) - self.world.box(held).mean(axis=0)
        x, y, z = arithmetic.snapped(np.asarray(self.held_at()) + origin).tolist()
        away = math.dist((x, y), (self.x, self.y))
        nearer = [back / away for back in BACK_M if back < away]
        spots = [(x, y, z + rise) for rise in RISES_M]
        spots += [(x + share * (self.x - x), y + share * (self.y - y), z) for share in nearer]
        return spots + super().drop_spots()

    # ---- the arm in the room

    def reach(self, object_id: str) -> ActionResult | None:
        """See `Agent`; the arm goes back to where it was."""
        before = self.arm.state
        refusal = super().reach(object_id)
        self.arm.state = before
        return refusal

    def open(self, object_id: str, openness: float = 1.0, force: bool = False) -> ActionResult:
        """See `ThorAgent`; the arm folds before a door that comes to where it is."""
        was_free = self.arm.is_free(self.base)
        result = super().open(object_id, openness, force)
        if result.success and was_free:
            self._fold_if_in_something()
        return result

    def outline(self, below_m: float) -> F64:
        """See `ThorAgent`; a folded arm is above the base."""
        middles, radii = self.arm.held_out(self.base)
        is_low = middles[:, 2] - radii < self.world.scene.floor_z + below_m
        return np.vstack([super().outline(below_m), np.column_stack([middles[:, :2], radii])[is_low]])

    def _prepare_to_move(self) -> None:
        """See `Body`; the arm is carried as it is held."""

    def _arrive(self) -> None:
        """See `Body`; the arm folds if, held as it is, it would be in something there."""
        self._fold_if_in_something()

    def _fold_if_in_something(self) -> None:
        if not self.arm.is_free(self.base):
            self.fold_arm()

    def _blocker(self, start: Vec2, end: Vec2) -> str | None:
        """See `Body`; what the arm meets is in the way, too."""
        blocker = super()._blocker(start, end)
        if blocker is not None:
            return blocker
        steps = max(1, math.ceil(math.dist(start, end) / CARRY_STEP_M))
        way = np.linspace(start, end, steps + 1).tolist()
        return self.arm.blocker([replace(self.base, x=x, y=y) for x, y in way])

    def _blocker_of_turn(self, degrees: float) -> str | None:
        """See `Body`; the arm turns along."""
        swept = float(np.clip(degrees, -360.0, 360.0))
        steps = max(1, math.ceil(abs(swept) / CARRY_STEP_DEG))
        headings = (self.yaw_deg + np.linspace(0.0, swept, steps + 1)).tolist()
        return self.arm.blocker([replace(self.base, yaw_deg=heading) for heading in headings])
