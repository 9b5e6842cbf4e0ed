"""The agent's body: its size, eye and arm, and the steps in which it moves.

The numbers are those of AI2-THOR's default agent with the arm of ManipulaTHOR.
"""

from __future__ import annotations

from dataclasses import dataclass

from remqa_data.geometry.types import Vec2


@dataclass(frozen=True)
class Embodiment:
    """Metres and degrees of the agent's body.

    Attributes
    ----------
    radius_m, height_m : float
        Of the cylinder that must not touch anything.
    step_over_m : float
        Lower things (rugs, a doorstep) do not stop the agent.
    camera_height_m, crouched_camera_height_m : float
        Above the floor.
    fov_deg : float
        Vertical field of view.
    step_m, rotate_deg, look_deg : float
        How far an action goes that names no amount. Grids of rooms have cells of the default step, 0.25 m, whatever this is.
    least_horizon_deg, most_horizon_deg : float
        How far the camera tilts; positive is down.
    shoulder_low_m, shoulder_high_m, shoulder_ahead_m : float
        The shoulder slides up and down a column (metres above the floor) that stands this far ahead of the agent's middle,
        so that the base does not eat up the arm's reach; the agent turns to face what it reaches for. Every shoulder is where
        the default's is: the simulated arm has these measures, and with hands "reach" distances are taken from there.
    reach_m : float
        From the shoulder to the hand: how near a thing must be for hands "reach". The simulated arm has the default's length.
    visibility_m : float
        How near, in plan, a thing must be for hands "near".
    push_m : float
        How far one action moves a thing. As text, no action asks for more than the default's.
    """

    radius_m: float = 0.20
    height_m: float = 1.80
    step_over_m: float = 0.05
    camera_height_m: float = 1.576
    crouched_camera_height_m: float = 0.901
    fov_deg: float = 90.0
    step_m: float = 0.25
    rotate_deg: float = 90.0
    look_deg: float = 30.0
    least_horizon_deg: float = -30.0
    most_horizon_deg: float = 60.0
    shoulder_low_m: float = 0.45
    shoulder_high_m: float = 1.80
    shoulder_ahead_m: float = 0.15
    reach_m: float = 0.63
    visibility_m: float = 1.5
    push_m: float = 0.75

    @classmethod
    def of_dataset(cls, camera_height_m: float, fov_deg: float, step_m: float, reach_m: float) -> Embodiment:
        """The body whose figures a dataset stores; to crouch lowers the camera as much as usual.

        Datasets that `remqa-gen` makes store those of the default body.
        """
        lower_m = cls.camera_height_m - cls.crouched_camera_height_m
        return cls(
            camera_height_m=camera_height_m,
            crouched_camera_height_m=camera_height_m - lower_m,
            fov_deg=fov_deg,
            step_m=step_m,
            reach_m=reach_m,
        )

    def eye_height_m(self, is_standing: bool) -> float:
        """Of the camera above the floor, as it stands or crouches."""
        return self.camera_height_m if is_standing else self.crouched_camera_height_m

    def centre_of(self, cell: tuple[int, int]) -> Vec2:
        """Centre of a cell of a grid of its steps, metres."""
        return cell[0] * self.step_m, cell[1] * self.step_m

    def cell_at(self, x: float, y: float) -> tuple[int, int]:
        """The cell whose centre is nearest to a point, metres.

        >>> Embodiment().cell_at(*Embodiment().centre_of((3, -2)))
        (3, -2)
        """
        return round(x / self.step_m), round(y / self.step_m)


AGENT = Embodiment()
"""The body that datasets are made with."""
