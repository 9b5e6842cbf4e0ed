"""Where an agent and the environment meet: the agent's senses, and nothing of what the environment knows beside them."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from remqa_data.agents.agent import Agent
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.interfaces import Percept
from remqa_data.env.actions import Command
from remqa_data.sim.navigation.viewpoints import AgentPose

Env = gymnasium.Env[dict[str, Any], Any]


def play_question(env: Env, question_id: str, agent: Agent, memory: WalkMemory, rng: np.random.Generator) -> None:
    """Let an agent play an episode of the environment.

    The agent gets the question's text and its percepts. Of what the environment says beside its observations it gets one bit:
    whether the room let it do what it wanted.

    Parameters
    ----------
    env : Env
        `remqa_data/Remqa-v0` over a dataset, wrapped or not.
    question_id : str
        The episode.
    agent : Agent
        Who plays.
    memory : WalkMemory
        Of the question's configuration.
    rng : numpy.random.Generator
        For the agent.
    """
    observation, _ = env.reset(options={"episode": question_id})
    floor_z = memory.plan.floor_z

    def act(command: Command) -> Percept:
        seen, _, _, _, info = env.step(command)
        return _percept(seen, memory, floor_z, bool(info["success"]))

    first = _percept(observation, memory, floor_z, True)
    agent.play(read_question(observation["question"]), memory, first, act, rng)


def _percept(observation: dict[str, Any], memory: WalkMemory, floor_z: float, succeeded: bool) -> Percept:
    x, y, yaw_deg, horizon_deg, is_standing = observation["pose"].tolist()
    pose = AgentPose.nearest(x, y, yaw_deg, horizon_deg, bool(is_standing), memory.body)
    depth = observation["depth"]
    return Percept(observation["rgb"], depth, pose, pose.camera_above(floor_z, depth.shape[0], memory.body), succeeded)
