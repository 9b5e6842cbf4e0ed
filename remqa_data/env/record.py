"""What an agent of the environment has achieved, by the definitions that `remqa-eval` uses too.

As in a submission, an episode is a walk and then one manipulation: the first one that succeeds. Where the agent stands
and what it sees just before it decides whether it has navigated, and the box that it names then whether it has localised.
How the room is just after it decides whether it has manipulated: that is what the agent sees next, whatever it does later.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from remqa_data.env.actions import Shares
from remqa_data.env.episodes import Task
from remqa_data.geometry.types import Vec2
from remqa_data.metrics import (
    box_iou,
    chained,
    distance_to_goal_m,
    is_localised,
    is_right_answer,
    navigation_success,
    path_lengths_m,
    spl,
)
from remqa_data.sim.agent.actions import KIND_OF, MOVE, PULL, PUSH, Action
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.agent.outcome import Before, is_manipulated, look_before
from remqa_data.sim.metadata import Box2D, visible_box
from remqa_data.sim.navigation.viewpoints import FRAME_PX


@dataclass
class EpisodeRecord:
    """An episode as it goes on.

    Attributes
    ----------
    walk : list of Action
        Navigation actions before the manipulation, refused ones too.
    positions : list of (float, float)
        Where the agent was, from the start on, before the manipulation; metres.
    manipulation : Action or None
        The manipulation that was done first, its target by id.
    is_manipulated : bool
        Whether that was what the question takes, and what was hidden lay open after it.
    before : Before or None
        How the thing to be manipulated was just before that.
    target_box : tuple of float or None
        The question's target in the view just before it, pixels of a 300 x 300 frame; None where it is not visible.
    box : tuple of float or None
        Where the agent said that it is, in the same pixels.
    is_in_reach : bool
        Whether the thing to be manipulated was seen, and within the arm's length, just before: `remqa-eval` asks for that, too.
    """

    walk: list[Action] = field(default_factory=list)
    positions: list[Vec2] = field(default_factory=list)
    manipulation: Action | None = None
    is_manipulated: bool = False
    before: Before | None = None
    target_box: Box2D | None = None
    box: tuple[float, float, float, float] | None = None
    is_in_reach: bool = False

    def walked(self, action: Action, agent: Agent) -> None:
        """Note a navigation action, done or refused."""
        if self.manipulation is None:
            self.walk.append(action.in_short(agent.embodiment))
            self.positions.append((agent.x, agent.y))

    def look(self, agent: Agent, task: Task, box: Shares | None) -> None:
        """Note the view before the manipulation, or before the end of an episode without one."""
        if self.manipulation is None:
            self.before = look_before(agent, task.wanted)
            self.is_in_reach = agent.out_of_reach(task.wanted.object_id) is None
            index = agent.world.ids.index(task.target_id)
            self.target_box = visible_box(agent.view.instances(agent.camera()), index)
            self.box = None if box is None else _in_pixels(box)

    def manipulated(self, action: Action, object_id: str, agent: Agent) -> None:
        """Note that a manipulation was done to an object, and how the room is now."""
        if self.manipulation is not None or action.name not in KIND_OF:
            return
        if action.name in (PUSH, PULL):
            self.manipulation = Action(MOVE, object_id, agent.world.state(object_id).position)
        else:
            self.manipulation = Action(action.name, object_id, action.numbers).in_short(agent.embodiment)
        if self.before is not None:
            wanted = self.before.wanted
            is_meant = (KIND_OF[action.name], object_id) == (wanted.kind, wanted.object_id)
            self.is_manipulated = is_meant and self.is_in_reach and is_manipulated(agent.world, self.before)

    def measures(self, task: Task, answer: str | None) -> dict[str, Any]:
        """The measures of the episode at its end; names and definitions are in docs/METRICS.md."""
        nothing = [np.nan] * 4
        walked_m = path_lengths_m(np.array(self.positions), [len(self.positions)])
        distance_m = distance_to_goal_m(np.array(self.positions[-1:]), task.goals[None])
        navigated = navigation_success(distance_m, [self.target_box is not None])
        iou = box_iou([self.box or nothing], [self.target_box or nothing])
        is_right = is_right_answer([answer], [task.answer])
        chain = chained(
            {
                "navigated": navigated,
                "localised": is_localised(iou),
                "manipulated": [self.is_manipulated],
                "answered": is_right,
            }
        )
        return {
            **{name: bool(column[0]) for name, column in chain.items()},
            "answer_accuracy": bool(is_right[0]),
            "manipulated": self.is_manipulated,
            "SPL": float(spl(navigated, [task.path_length_m], walked_m)[0]),
            "iou": float(iou[0]),
            "distance_to_goal_m": float(distance_m[0]),
            "path_length_m": float(walked_m[0]),
            "steps": len(self.walk),
        }


def reward_of(measures: Mapping[str, Any], terminated: bool) -> float:
    """Of an episode's last step: 1 if the agent has ended it, had navigated to the target and answered rightly, else 0.

    Where nothing is answered, as in walks over cached views, to have navigated is enough.
    """
    return float(terminated and measures["S_N"] and measures.get("answer_accuracy", True))


def _in_pixels(box: Shares) -> tuple[float, float, float, float]:
    x1, y1, x2, y2 = (FRAME_PX * share for share in box)
    return x1, y1, x2, y2
