"""What a question asks of an agent that only navigates."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from remqa_data.errors import DatasetError
from remqa_data.geometry.types import F64
from remqa_data.storage.shards import read_table

_COLUMNS = (
    "question_id",
    "question",
    "scene",
    "configuration",
    "initial_pose",
    "goal_poses",
    "target_id",
    "target_type",
    "path_length_m",
)


@dataclass(frozen=True, eq=False)
class NavigationTask:
    """A question up to the manipulation; see `remqa_data.tables.rows.QuestionRow`.

    Attributes
    ----------
    start : tuple of float
        x, y in metres, yaw_deg, horizon_deg of the initial pose, in which the agent stands.
    goals : (n, 2) float64
        x, y of the goal poses, metres.
    """

    question_id: str
    question: str
    scene: str
    configuration: int
    start: tuple[float, float, float, float]
    goals: F64
    target_id: str
    target_type: str
    path_length_m: float


def navigation_tasks(root: str | os.PathLike[str], split: str) -> list[NavigationTask]:
    """The tasks of a split, in its order.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, it has no such split, or a question has no goal.
    """
    tasks = []
    for row in read_table(root, "questions", split, list(_COLUMNS)).to_pylist():
        if not row["goal_poses"]:
            raise DatasetError(f"{root}: question {row['question_id']}, field goal_poses: there is none")
        pose = row.pop("initial_pose")
        goals = np.array([goal["position"][:2] for goal in row.pop("goal_poses")])
        start = (*pose["position"][:2], pose["yaw_deg"], pose["horizon_deg"])
        tasks.append(NavigationTask(start=start, goals=goals, **row))
    return tasks
