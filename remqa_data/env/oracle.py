"""The oracle: plays the actions that are stored with a question, and gives its answer."""

from __future__ import annotations

from remqa_data.env.actions import Command
from remqa_data.env.episodes import Task
from remqa_data.sim.agent.actions import DONE, MANIPULATION


def oracle_commands(task: Task) -> list[Command]:
    """What the oracle does, for `RemqaEnv.step`: it walks, manipulates the target, whose box it knows, and answers."""
    commands = [
        Command(action, box=task.target_box if action.name in MANIPULATION else None)
        for action in task.actions
        if action.name != DONE
    ]
    return [*commands, Command(answer=task.answer)]
