"""Cameras that are not the agent's."""

from __future__ import annotations

from dataclasses import dataclass

from remqa_data.sim.render.camera import Camera, OrthographicCamera
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
        Degrees: x looks down, y turns clockwise, z rolls it counter-clockwise, as seen from behind.
    field_of_view : float
        Vertical, degrees.
    orthographic_size : float or None
        Half the height of the picture in metres, of a camera with a parallel projection.
    """

    position: Vector
    rotation: Vector
    field_of_view: float
    orthographic_size: float | None = None

    def problem(self) -> str | None:
        """Why this camera cannot be had here, or None."""
        if not 0.0 < self.field_of_view < 180.0:
            return f"fieldOfView {self.field_of_view:g} is not in (0, 180)"
        if self.orthographic_size is not None and self.orthographic_size <= 0.0:
            return f"orthographicSize {self.orthographic_size:g} is not positive"
        return None

    def metadata(self, index: int) -> dict[str, object]:
        """What an event says of it."""
        return {
            "thirdPartyCameraId": index,
            "position": dict(self.position),
            "rotation": dict(self.rotation),
            "fieldOfView": self.field_of_view,
        }

    def camera(self, frame: FrameSize) -> Camera | OrthographicCamera:
        """The camera that draws pictures of a size."""
        position, (width, height) = to_room(self.position), (frame.width, frame.height)
        yaw, horizon, roll = yaw_to_room(self.rotation["y"]), self.rotation["x"], self.rotation["z"]
        if self.orthographic_size is not None:
            return OrthographicCamera(position, self.orthographic_size, yaw, horizon, roll, width, height)
        return Camera(position, yaw, horizon, self.field_of_view, width, height, roll)
