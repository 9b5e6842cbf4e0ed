"""Replaying what was submitted: the simulator says where the agent went, what it saw, and what it did.

An action that the room refuses (a wall is in the way) leaves the agent where it is and counts as a step, as in AI2-THOR
and Habitat. All questions of one configuration share a world, which is brought back to its first state between them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from remqa_data.errors import DatasetError, RemqaError, UnknownNameError
from remqa_data.processes.executors import LocalExecutor
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import DONE, KIND_OF, Action, object_of
from remqa_data.sim.agent.outcome import Wanted, is_manipulated, look_before
from remqa_data.sim.agent.replay import Replay
from remqa_data.sim.metadata import Box2D, visible_box
from remqa_data.sim.navigation.embodiment import AGENT, Embodiment
from remqa_data.sim.navigation.viewpoints import AgentPose, Pose
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import EmbodimentRow, configuration_name

RoomKey = tuple[str, int]
"""A scene and its configuration."""


@dataclass(frozen=True)
class Attempt:
    """What is to be replayed of one question.

    Attributes
    ----------
    place : int
        Of the question in its split.
    initial_pose : Pose
    target_id : str
    actions : sequence of Action
        Of navigation.
    manipulation : Action or None
    wanted : Wanted
        The right manipulation.
    """

    place: int
    initial_pose: Pose
    target_id: str
    actions: Sequence[Action]
    manipulation: Action | None
    wanted: Wanted


@dataclass(frozen=True)
class Replayed:
    """What happened.

    Attributes
    ----------
    place : int
        Of the question in its split.
    poses : tuple of Pose
        The initial pose, then the pose after each action but Done.
    target_box : Box2D or None
        The target in the final view before the manipulation, or None where it is not visible.
    is_manipulated : bool
        Whether the agent has done the right manipulation to the right object, and what that hid lies open.
    refused : int
        Actions that the room refused.
    """

    place: int
    poses: tuple[Pose, ...]
    target_box: Box2D | None
    is_manipulated: bool
    refused: int


@dataclass(frozen=True)
class ReplayJob:
    """The attempts in one configuration, for one worker."""

    name: str
    scene_json: str
    embodiment: EmbodimentRow
    attempts: tuple[Attempt, ...]


def replay_all(
    root: Path,
    split: str,
    attempts: dict[RoomKey, list[Attempt]],
    workers: int,
    progress: Callable[[int], None] | None = None,
) -> Iterator[Replayed]:
    """Replay attempts in the rooms of a dataset; the order does not depend on the number of workers.

    Parameters
    ----------
    root, split : path, str
        Where the rooms are.
    attempts : dict
        By scene and configuration.
    workers : int
        Processes.
    progress : callable, optional
        Called with the number of attempts of each finished room.

    Raises
    ------
    DatasetError
        If the dataset has no such configuration, or an agent that cannot be replayed.
    """
    jobs = replay_jobs(root, split, attempts)
    done: dict[str, list[Replayed]] = {}
    for job, replayed in LocalExecutor(min(workers, len(jobs)) or 1).run(replay_room, jobs):
        done[job.name] = replayed
        if progress is not None:
            progress(len(replayed))
    for job in jobs:
        yield from done[job.name]


def replay_room(job: ReplayJob) -> list[Replayed]:
    """Replay the attempts in one configuration, each from the room's first state."""
    replay = load_room(job.scene_json, job.name, job.embodiment)
    first = replay.world.save()
    try:
        done = []
        for attempt in job.attempts:
            done.append(_replayed(replay, attempt))
            replay.world.restore(first)
        return done
    finally:
        replay.close()


def load_room(scene_json: str, name: str, body: EmbodimentRow) -> Replay:
    """A stored configuration with the dataset's agent in it; `name` is for error messages."""
    return Replay(Scene.from_json(scene_json, name), AgentPose((0, 0), 0), Embodiment.of_dataset(**vars(body)))


def walk(replay: Replay, attempt: Attempt) -> tuple[list[Pose], int]:
    """Put the agent at its initial pose and let it walk: the poses it passes, and how many actions were refused."""
    replay.pose = AgentPose.nearest(*attempt.initial_pose)
    poses, refused = [attempt.initial_pose], 0
    agent = replay.agent
    for action in attempt.actions:
        if action.name == DONE:
            break
        refused += not does(replay, action)
        poses.append((agent.x, agent.y, agent.yaw_deg, agent.horizon_deg))
    return poses, refused


def does(replay: Replay, action: Action) -> bool:
    """Whether the room lets the agent do an action; if so, it is done."""
    try:
        return replay.attempt(action).success
    except RemqaError:
        return False


def place_of(replay: Replay, object_id: str) -> int:
    """Which of the room's objects one is.

    Raises
    ------
    UnknownNameError
        If the room has no such object.
    """
    if object_id not in replay.world.ids:
        raise UnknownNameError("object", object_id, replay.world.ids)
    return replay.world.ids.index(object_id)


def replay_jobs(root: Path, split: str, attempts: dict[RoomKey, list[Attempt]]) -> list[ReplayJob]:
    """The rooms in which something is attempted, in the order in which they are stored; errors as of `replay_all`."""
    columns = ["scene", "configuration", "scene_json", "embodiment"]
    jobs = []
    for row in read_table(root, "scenes", split, columns).to_pylist():
        found = attempts.get((row["scene"], row["configuration"]))
        if found:
            body = EmbodimentRow(**row["embodiment"])
            if body.step_m != AGENT.step_m:
                msg = (
                    f"{root}: the agent of {row['scene']} steps {body.step_m} m; the simulator's steps {AGENT.step_m} m"
                )
                raise DatasetError(msg)
            name = configuration_name(row["scene"], row["configuration"])
            jobs.append(ReplayJob(name, row["scene_json"], body, tuple(found)))
    replayed = sum(len(job.attempts) for job in jobs)
    if replayed != sum(map(len, attempts.values())):
        raise DatasetError(f"{root}: split {split} has questions about configurations that its scenes do not have")
    return jobs


def _replayed(replay: Replay, attempt: Attempt) -> Replayed:
    poses, refused = walk(replay, attempt)
    objects = replay.view.instances(replay.agent.camera())
    box = visible_box(objects, place_of(replay, attempt.target_id))
    is_right = False
    if attempt.manipulation is not None:
        wanted = attempt.wanted
        is_meant = _meant(replay, attempt.manipulation) == (wanted.kind, wanted.object_id)
        before = look_before(replay.agent, wanted)
        is_done = does(replay, attempt.manipulation)
        is_right = is_meant and is_done and is_manipulated(replay.world, before)
        refused += not is_done
    return Replayed(attempt.place, tuple(poses), box, is_right, refused)


def _meant(replay: Replay, manipulation: Action) -> tuple[str | None, str | None]:
    """What a manipulation is, such as "Open", and of which object."""
    try:
        target = object_of(replay.agent, manipulation)
    except RemqaError:  # a point outside the image
        target = None
    return KIND_OF.get(manipulation.name), target
