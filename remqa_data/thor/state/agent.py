"""The agent as AI2-THOR's clients know it: it acts on what its own frames show, whatever their size."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from remqa_data.geometry.types import F64, I32
from remqa_data.sim.agent.agent import Agent, Hands
from remqa_data.sim.metadata import scaled_min_pixels
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import WorldView
from remqa_data.thor.state.settings import FrameSize, Settings


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
        self.frame = frame
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
