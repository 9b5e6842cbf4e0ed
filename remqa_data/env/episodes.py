"""What the environment plays: questions of a dataset, or bare rooms to walk about in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from remqa_data.env.actions import Shares
from remqa_data.env.arguments import chosen_questions, folder, in_order
from remqa_data.errors import ActionError, DatasetError, UnknownNameError, one_line
from remqa_data.floorplans.load import check_scene_name, load_scene
from remqa_data.geometry.types import F64
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import Action, parse_actions
from remqa_data.sim.agent.outcome import Wanted
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.navigation.viewpoints import FRAME_PX, Pose
from remqa_data.sim.physics.world import World
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import configuration_name


@dataclass(frozen=True, eq=False)
class Task:
    """A question, what answers it, and how the oracle does it; see `remqa_data.tables.rows.QuestionRow`.

    Attributes
    ----------
    goals : (n, 2) float64
        x, y of the goal poses, metres.
    target_box : tuple of float or None
        Of the target in the view from the oracle's goal pose.
    """

    question_id: str
    kind: str
    question: str
    answer: str
    target_id: str
    manipulation: str
    manipulation_object_id: str
    goals: F64
    path_length_m: float
    actions: tuple[Action, ...]
    target_box: Shares | None

    @property
    def wanted(self) -> Wanted:
        """The manipulation that it takes."""
        x, y = self.goals[0].tolist()
        return Wanted(self.manipulation, self.manipulation_object_id, (x, y))


@dataclass(frozen=True, eq=False)
class Episode:
    """One episode.

    Attributes
    ----------
    name : str
        Of the room and its configuration; equal names mean equal rooms.
    scene : Scene
        The room, at rest.
    initial_pose : tuple of float or None
        Where the agent begins; None for anywhere on the grid.
    task : Task or None
        None in a bare room.
    """

    name: str
    scene: Scene
    initial_pose: Pose | None
    embodiment: Embodiment
    task: Task | None


class Episodes(Protocol):
    """What there is to play."""

    @property
    def ids(self) -> tuple[str, ...]:
        """Names of the episodes."""
        ...

    def episode(self, name: str) -> Episode:
        """The episode of a name."""
        ...


class DatasetEpisodes:
    """The questions of a split of a dataset.

    Parameters
    ----------
    root : path
        Folder of a finished dataset.
    split : str
        "train" or "test".
    question_ids : sequence of str, optional
        Only these.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or has no such split.
    UnknownNameError
        If it has no such question.
    ActionError
        As of `remqa_data.env.arguments`.
    """

    def __init__(self, root: str | Path, split: str, question_ids: Sequence[str] | None = None) -> None:
        chosen = chosen_questions(question_ids)
        self.root, self.split = folder(root), split
        self._questions = read_table(self.root, "questions", split, list(_QUESTION_COLUMNS))
        scenes = read_table(self.root, "scenes", split, ["scene", "configuration", "scene_json", "embodiment"])
        self._scenes = scenes.combine_chunks()
        keys = scenes.select(["scene", "configuration"]).to_pylist()
        self._scene_rows = {(key["scene"], key["configuration"]): row for row, key in enumerate(keys)}
        self._rows = {name: row for row, name in enumerate(self._questions["question_id"].to_pylist())}
        if chosen is not None:
            self._rows = {name: self._row(name) for name in chosen}
        self.ids = tuple(self._rows)

    def episode(self, name: str) -> Episode:
        """The episode of a question.

        Raises
        ------
        UnknownNameError
            If the split has no such question, or it is none of the chosen ones.
        DatasetError
            If the dataset lacks its room, or what is asked for is not in it.
        """
        question = self._questions.slice(self._row(name), 1).to_pylist()[0]
        key = question["scene"], question["configuration"]
        place = configuration_name(*key)
        if key not in self._scene_rows:
            raise DatasetError(f"{self.root}: split {self.split} asks about {place}, but has no such room")
        row = self._scenes.slice(self._scene_rows[key], 1).to_pylist()[0]
        scene = Scene.from_json(row["scene_json"], place)
        for field in ("target_id", "manipulation_object_id"):
            if question[field] not in {thing.id for thing in scene.objects}:
                raise DatasetError(
                    f"{self.root}: question {name}, field {field}: {place} has no {question[field]!r:.80}"
                )
        if not question["goal_poses"]:
            raise DatasetError(f"{self.root}: question {name}, field goal_poses: there is none")
        try:
            actions = parse_actions(question["actions"])
        except ActionError as error:
            raise DatasetError(f"{self.root}: question {name}, field actions: {one_line(error)}") from None
        return Episode(
            name=place,
            scene=scene,
            initial_pose=_pose(question["initial_pose"]),
            embodiment=Embodiment.of_dataset(**row["embodiment"]),
            task=_task(question, actions),
        )

    def _row(self, name: str) -> int:
        if name not in self._rows:
            raise UnknownNameError("question", name, self._rows)
        return self._rows[name]


class SceneEpisodes:
    """Bare rooms: the agent starts anywhere, and nothing is asked.

    Parameters
    ----------
    scenes : sequence of str or Scene
        iTHOR's floor plans by name, such as "FloorPlan1", or rooms, which are taken to be at rest.

    Raises
    ------
    ActionError
        If it is something else, or two rooms have one name.
    DatasetError
        If there are none.
    UnknownNameError
        If there is no such floor plan.
    """

    def __init__(self, scenes: Sequence[str | Scene]) -> None:
        self._scenes: dict[str, str | Scene] = {}
        for scene in in_order("scenes", scenes, "FloorPlan1"):
            if isinstance(scene, str):
                scene = name = str(scene)  # NumPy has texts of its own
                check_scene_name(name)
            elif isinstance(scene, Scene):
                name = scene.name
            else:
                raise ActionError(f"scenes has {scene!r:.80}: give names of floor plans, or rooms (Scene)")
            if name in self._scenes:
                raise ActionError(f"scenes has two rooms called {name!r:.80}: give each a name of its own")
            self._scenes[name] = scene
        if not self._scenes:
            raise DatasetError("no scenes were given: name at least one, such as FloorPlan1")
        self.ids = tuple(self._scenes)

    def episode(self, name: str) -> Episode:
        """The episode in a room.

        Raises
        ------
        UnknownNameError
            If the room is not among these, or there is no such floor plan.
        """
        if name not in self._scenes:
            raise UnknownNameError("scene", name, self._scenes)
        scene = self._scenes[name]
        if isinstance(scene, str):
            scene = self._scenes[name] = _floor_plan(scene)
        return Episode(name, scene, None, Embodiment(), None)


_QUESTION_COLUMNS = (
    "question_id",
    "kind",
    "question",
    "answer",
    "scene",
    "configuration",
    "initial_pose",
    "goal_poses",
    "target_id",
    "start_target_box_2d",
    "manipulation",
    "manipulation_object_id",
    "path_length_m",
    "actions",
)


def _floor_plan(name: str) -> Scene:
    with World(load_scene(name)) as world:
        world.settle()
        return world.to_scene()


def _pose(stored: dict[str, Any]) -> Pose:
    x, y, _ = stored["position"]
    return x, y, stored["yaw_deg"], stored["horizon_deg"]


def _task(stored: dict[str, Any], actions: tuple[Action, ...]) -> Task:
    box = stored["start_target_box_2d"]
    return Task(
        question_id=stored["question_id"],
        kind=stored["kind"],
        question=stored["question"],
        answer=stored["answer"],
        target_id=stored["target_id"],
        manipulation=stored["manipulation"],
        manipulation_object_id=stored["manipulation_object_id"],
        goals=np.array([pose["position"][:2] for pose in stored["goal_poses"]]),
        path_length_m=stored["path_length_m"],
        actions=actions,
        target_box=None if box is None else tuple(edge / FRAME_PX for edge in box),
    )
