"""The agent's body: its size, eye and arm, and the steps in which it moves.

The numbers are those of AI2-THOR's default agent with the arm of ManipulaTHOR.
"""

from __future__ import annotations

from dataclasses import dataclass

from remqa_data.sim.navigation.grid import (
    AGENT_RADIUS_M,
    ARM_REACH_M,
    CAMERA_HEIGHT_M,
    CROUCHED_CAMERA_HEIGHT_M,
    GRID_M,
)

MAX_PUSH_M = 0.75
"""How far one action moves a thing."""


@dataclass(frozen=True)
class Embodiment:
    """Metres and degrees of the agent's body.

    Attributes
    ----------
    radius_m : float
        Of the cylinder that must not touch anything.
    camera_height_m, crouched_camera_height_m : float
        Above the floor.
    fov_deg : float
        Vertical field of view.
    step_m, rotate_deg, look_deg : float
        How far an action goes that names no amount.
    least_horizon_deg, most_horizon_deg : float
        How far the camera tilts; positive is down.
    reach_m : float
        From the shoulder to the hand.
    visibility_m : float
        How near, in plan, a thing must be to be acted on without the arm.
    """

    radius_m: float = AGENT_RADIUS_M
    camera_height_m: float = CAMERA_HEIGHT_M
    crouched_camera_height_m: float = CROUCHED_CAMERA_HEIGHT_M
    fov_deg: float = 90.0
    step_m: float = GRID_M
    rotate_deg: float = 90.0
    look_deg: float = 30.0
    least_horizon_deg: float = -30.0
    most_horizon_deg: float = 60.0
    reach_m: float = ARM_REACH_M
    visibility_m: float = 1.5

    @classmethod
    def of_dataset(cls, camera_height_m: float, fov_deg: float, step_m: float, reach_m: float) -> Embodiment:
        """The body whose figures a dataset stores; to crouch lowers the camera as much as usual."""
        lower_m = CAMERA_HEIGHT_M - CROUCHED_CAMERA_HEIGHT_M
        return cls(
            camera_height_m=camera_height_m,
            crouched_camera_height_m=camera_height_m - lower_m,
            fov_deg=fov_deg,
            step_m=step_m,
            reach_m=reach_m,
        )
