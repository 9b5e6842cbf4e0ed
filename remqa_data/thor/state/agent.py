"""The agent as AI2-THOR's clients know it: it acts on what its own frames show, whatever their size."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, I32, Vec3
from remqa_data.sim.agent.agent import ActionResult, Agent, Hands
from remqa_data.sim.metadata import scaled_min_pixels
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import WorldView
from remqa_data.thor.state.settings import FrameSize, Settings

HAND: Vec3 = (0.0, -0.16, 0.38)
"""Where AI2-THOR's agent without an arm holds things: metres to the right of its camera, above and ahead of it."""


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
        position: tuple[float, float],
        yaw_deg: float,
        *,
        settings: Settings,
        frame: FrameSize,
        **pose: Any,
    ) -> None:
        self.frame, self.hand_offset = frame, HAND
        body = Embodiment(
            fov_deg=settings.field_of_view,
            step_m=settings.grid_size,
            rotate_deg=settings.rotate_step_degrees,
            visibility_m=settings.visibility_distance,
        )
        hands: Hands = "arm" if settings.has_arm else "near"
        super().__init__(world, view, position, yaw_deg, embodiment=body, hands=hands, **pose)

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

    def offset_of(self, point: F64) -> Vec3:
        """The hand's offset at which it is at a (3,) point of the room."""
        camera = self.camera()
        right, up, ahead = arithmetic.turned(point - np.asarray(camera.position), camera.rotation()).tolist()
        return right, up, ahead

    def has_in_frame(self, offset: Vec3) -> bool:
        """Whether a point, metres to the right of the camera, above and ahead of it, is in its frame, seen or not."""
        right, up, ahead = offset
        sine, cosine = arithmetic.sin_cos_deg(self.embodiment.fov_deg / 2)
        tall = ahead * float(sine / cosine)
        return abs(up) <= tall and abs(right) <= tall * self.frame.width / self.frame.height

    def pick_up(self, object_id: str, force: bool = False) -> ActionResult:
        """Take an object into the hand, which is where it usually is."""
        result = super().pick_up(object_id, force)
        if result.success:
            self.hand_offset = HAND
        return result

    def drop_spots(self) -> list[Vec3]:
        """Where it lets go: where its hand is, if it has been moved."""
        moved = [self.hand_at()] if self.hands != "arm" and self.hand_offset != HAND else []
        return moved + super().drop_spots()

    def visible_objects(self, distance_m: float | None = None) -> list[str]:
        """Ids of the objects that its frame shows, in the scene's order; with a distance, those nearer in plan."""
        return self.seen_in(self.view.instances(self.camera()), distance_m)

    def seen_in(self, objects: I32, distance_m: float | None = None) -> list[str]:
        """Ids of the objects that a (h, w) image of object indices shows; with a distance, those nearer in plan."""
        counts = np.bincount(objects[objects >= 0].ravel(), minlength=len(self.world.ids))
        ids = [self.world.ids[index] for index in np.flatnonzero(counts >= scaled_min_pixels(objects.shape))]
        return ids if distance_m is None else [name for name in ids if self.plan_distance(name) <= distance_m]

    def is_near(self, object_id: str) -> bool:
        """Whether an object is within the visibility distance, in plan."""
        return self.plan_distance(object_id) <= self.embodiment.visibility_m

    def sees(self, object_id: str, distance_m: float | None = None) -> bool:
        """Whether its frame shows an object within a distance in plan, by default the visibility distance."""
        limit = self.embodiment.visibility_m if distance_m is None else distance_m
        if self.plan_distance(object_id) > limit or not _may_show(self.camera(), self.world.box(object_id)):
            return False
        return object_id in self.visible_objects()


def _may_show(camera: Camera, box: F64) -> bool:
    """False if a (2, 3) box is outside the picture for sure: all its corners lie beyond one border."""
    corners = np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]]) - camera.position
    right, up, ahead = camera.rotation() @ corners.T
    tall = math.tan(math.radians(camera.fov_deg) / 2)
    wide = tall * camera.width / camera.height
    beyond = (ahead < 0, right > wide * ahead, -right > wide * ahead, up > tall * ahead, -up > tall * ahead)
    return not any(bool(side.all()) for side in beyond)
