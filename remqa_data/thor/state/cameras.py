"""Cameras that are not the agent's."""

from __future__ import annotations

from dataclasses import dataclass

from remqa_data.sim.render.camera import Camera, TopDownCamera
from remqa_data.thor.state.frames import Vector, to_room, yaw_to_room
from remqa_data.thor.state.settings import FrameSize


@dataclass(frozen=True)
class ThirdPartyCamera:
    """A camera as AI2-THOR describes it.

    Attributes
    ----------
    position : Vector
        Metres, AI2-THOR's frame.
    rotation : Vector
        Degrees: x looks down, y turns clockwise; z would roll the picture and is 0.
    field_of_view : float
        Vertical, degrees.
    orthographic_size : float or None
        Half the height of the picture in metres, of a map camera that looks straight down.
    """

    position: Vector
    rotation: Vector
    field_of_view: float
    orthographic_size: float | None = None

    def problem(self) -> str | None:
        """Why this camera cannot be had here, or None."""
        if not 0.0 < self.field_of_view < 180.0:
            return f"fieldOfView {self.field_of_view:g} is not in (0, 180)"
        if self.rotation["z"] % 360.0:
            return "a camera cannot be rolled here: rotation.z must be 0"
        if self.orthographic_size is not None:
            if self.orthographic_size <= 0.0:
                return f"orthographicSize {self.orthographic_size:g} is not positive"
            if self._horizon() != 90.0 or self.rotation["y"] % 360.0:
                return "an orthographic camera looks straight down here: rotation must be x=90, y=0, z=0"
        elif not -90.0 <= self._horizon() <= 90.0:
            return f"a camera cannot look over its own back: rotation.x {self.rotation['x']:g}"
        return None

    def metadata(self, index: int) -> dict[str, object]:
        """What an event says of it."""
        return {
            "thirdPartyCameraId": index,
            "position": dict(self.position),
            "rotation": dict(self.rotation),
            "fieldOfView": self.field_of_view,
        }

    def camera(self, frame: FrameSize) -> Camera | TopDownCamera:
        """The camera that draws pictures of a size."""
        position, (width, height) = to_room(self.position), (frame.width, frame.height)
        if self.orthographic_size is not None:
            extent = 2.0 * self.orthographic_size * min(width, height) / height
            return TopDownCamera(position[:2], position[2], extent, width, height)
        yaw, horizon = yaw_to_room(self.rotation["y"]), self._horizon()
        return Camera(position, yaw, horizon, self.field_of_view, width, height)

    def _horizon(self) -> float:
        return (self.rotation["x"] + 180.0) % 360.0 - 180.0
