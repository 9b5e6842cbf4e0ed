"""Executing actions in a room: what the oracle does, and how it is checked."""

from __future__ import annotations

from remqa_data.errors import ActionError
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import TELEPORT, Action, perform
from remqa_data.sim.agent.agent import Agent, Embodiment
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import FRAME_PX, AgentPose
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import Observation, WorldView


class Replay:
    """An agent in a freshly loaded room.

    Parameters
    ----------
    scene : Scene
        The room; it is not settled again, because a stored one is at rest.
    start : AgentPose
        Where the agent stands.
    embodiment : Embodiment, optional
        Its body.

    Attributes
    ----------
    agent : Agent
        Acts on what it sees and what is within its arm's length.
    grid : ReachableGrid
        Where it could stand at first.
    """

    def __init__(self, scene: Scene, start: AgentPose, embodiment: Embodiment | None = None) -> None:
        self.world = World(scene)
        self.view = WorldView(self.world)
        self.agent = Agent(self.world, self.view, (0.0, 0.0), 0.0, embodiment=embodiment)
        self.grid: ReachableGrid = self.agent.grid
        self.pose = start

    @property
    def pose(self) -> AgentPose:
        """Where the agent stands and looks, rounded to the grid; may be set."""
        agent = self.agent
        return AgentPose.nearest(agent.x, agent.y, agent.yaw_deg, agent.horizon_deg, agent.is_standing)

    @pose.setter
    def pose(self, pose: AgentPose) -> None:
        self.agent.place(self.grid.position(pose.cell), pose.yaw_deg, pose.horizon_deg, pose.is_standing)

    def step(self, action: Action) -> None:
        """Execute one action.

        Raises
        ------
        ActionError
            If the room or the agent's body refuses it, or there is no such action.
        UnknownNameError
            If it names an object that is not in the room.
        """
        result = self.attempt(action)
        if not result.success:
            raise ActionError(f"{action} from {self.pose}: {result.error}")

    def attempt(self, action: Action) -> ActionResult:
        """Execute one action, or say why the room or the agent's body refuses it; nobody teleports.

        Raises
        ------
        ActionError
            If there is no such action.
        UnknownNameError
            If it names an object that is not in the room.
        """
        if action.name == TELEPORT:
            raise ActionError(f"{action}: an episode is played without {TELEPORT}")
        return perform(self.agent, action)

    def observe(self, size_px: int = FRAME_PX) -> Observation:
        """What the agent sees now."""
        return self.view.render(self.agent.camera(size_px, size_px))

    def close(self) -> None:
        """Give the simulator's memory back."""
        self.world.close()
