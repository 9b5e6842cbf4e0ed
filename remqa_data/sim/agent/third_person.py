"""The agent from outside: a camera that stands near it, sees its body and arm, and what it holds in its hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from remqa_data.geometry.types import F64
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.arm import body as arm_body
from remqa_data.sim.arm.postures import COLUMN_TOP_M
from remqa_data.sim.render.camera import NEAR_M, AnyCamera, Camera
from remqa_data.sim.render.view import WorldView

Place = tuple[float, float, float]
"""Where the camera stands: degrees counter-clockwise from the agent's heading, and metres away and above the floor."""

ANGLES_DEG = (140.0, -140.0, 110.0, -110.0, 80.0, -80.0, 170.0, 50.0, -50.0)
DISTANCES_M = (1.9, 1.5, 2.4)
HEIGHTS_M = (1.75, 2.15)
PLACES: tuple[Place, ...] = tuple((a, d, h) for h in HEIGHTS_M for d in DISTANCES_M for a in ANGLES_DEG)
"""The best first."""
FOV_DEG = 64.0
LOOKS_AHEAD_M, LOOKS_AT_M = 0.3, 0.8
"""The middle of the picture, from the agent's middle on the floor."""
SCOUT_PX = 60
CLOSE_M = 0.7
MARGIN_M = 0.08
"""The camera keeps this far from the walls."""
GOOD_SHARE, BETTER_SHARE = 0.7, 0.9
"""The camera stays where it is while that is worth this share of the best place, and else goes to a better one."""


class ThirdPerson:
    """Pictures of an agent in its room; they follow both.

    Parameters
    ----------
    agent : Agent
        Whom to show.
    """

    def __init__(self, agent: Agent) -> None:
        self.agent = agent
        self.view = RobotView(agent)
        self.begin()

    def begin(self) -> None:
        """Forget where the camera stood, so that pictures of an episode are those that it would have alone."""
        self._place = PLACES[0]

    def render(self, width: int = 300, height: int = 300) -> npt.NDArray[np.uint8]:
        """The picture, (height, width, 3) RGB, from the place around the agent that sees most of it.

        The camera turns with the agent, and changes its place only when furniture or walls hide the agent from it.
        """
        self.view.sync()
        worth = {place: self._worth(place) for place in PLACES}
        best = max(worth.values())
        if worth[self._place] < GOOD_SHARE * best:
            self._place = next(place for place in PLACES if worth[place] >= BETTER_SHARE * best)
        return self.view.render(replace(self._camera(self._place), width=width, height=height)).rgb

    def _camera(self, place: Place) -> Camera:
        angle, distance, above = place
        agent, scene = self.agent, self.agent.world.scene
        heading, around = math.radians(agent.yaw_deg), math.radians(agent.yaw_deg + angle)
        target = (
            agent.x + LOOKS_AHEAD_M * math.cos(heading),
            agent.y + LOOKS_AHEAD_M * math.sin(heading),
            scene.floor_z + LOOKS_AT_M,
        )
        x0, y0, x1, y1 = scene.bounds
        eye = (
            min(max(target[0] + distance * math.cos(around), x0 + MARGIN_M), x1 - MARGIN_M),
            min(max(target[1] + distance * math.sin(around), y0 + MARGIN_M), y1 - MARGIN_M),
            scene.floor_z + min(above, scene.height - MARGIN_M),
        )
        return Camera.look_at(eye, target, fov_deg=FOV_DEG, width=SCOUT_PX, height=SCOUT_PX)

    def _worth(self, place: Place) -> float:
        """How much of the agent is seen from a place, less where an end is cut off or something is before the camera."""
        camera = self._camera(place)
        x, y, floor_z = self.agent.position
        ends = [(x, y, floor_z), (x, y, floor_z + COLUMN_TOP_M), self.agent.arm.hand(self.agent.base)]
        shown = camera.project(ends)
        is_in = (shown[:, 2] > NEAR_M) & np.all((shown[:, :2] > 0) & (shown[:, :2] < SCOUT_PX), axis=1)
        pixels, near_share = self.view.scout(camera)
        return math.sqrt(pixels) * (0.1 + float(is_in.mean()) ** 2) * (1.0 - near_share) ** 2


class RobotView(WorldView):
    """A view of a world with the agent's body in it.

    Parameters
    ----------
    agent : Agent
        Who is shown.
    """

    def __init__(self, agent: Agent) -> None:
        super().__init__(agent.world, bodies=[arm_body.robot_surfaces()])
        self.agent = agent
        self._in_hand: str | None = None

    def sync(self) -> None:
        """Follow the world, the agent, its arm, and what is in its hand."""
        super().sync()
        self.show_body(0, body_of(self.agent))
        before, held = self._in_hand, self.agent.held
        self._in_hand = held
        if before not in (None, held):  # it may be where it was when it was picked up
            self.renderer.set_poses(self._parts_of[before], self.world.link_poses(before))
        if held is not None:
            poses = self.world.link_poses(held)
            poses[:, :3, 3] += np.array(self.agent.arm.hand(self.agent.base)) - self.world.state(held).position
            self.show_held(held, poses)

    def scout(self, camera: AnyCamera) -> tuple[int, float]:
        """Number of pixels that show the agent, and share of those that show something else close to the camera.

        The view must be in step, see `sync`.
        """
        depth, instances = self.renderer.render_instances(camera)
        is_robot = instances == self.instance_of_bodies
        is_near = ~is_robot & (depth < CLOSE_M) & (instances >= 0)
        return int(np.count_nonzero(is_robot)), float(is_near.mean())


ARM = slice(3, None)
"""Of `body_of`: what an agent sees of itself, which is its arm with the carriage."""


def body_of(agent: Agent) -> F64:
    """(n, 4, 4) poses in the room of the parts of `robot_surfaces`, of an agent as it stands and holds its arm."""
    eye = agent.embodiment.eye_height_m(agent.is_standing)
    return arm_body.robot_poses(agent.base, agent.arm_state, eye)
