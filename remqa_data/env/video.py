"""A question as a film: what the agent sees, the agent from outside, and the map that it draws, side by side."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env import RemqaEnv
from remqa_data.env.actions import Command, Shares
from remqa_data.env.oracle import oracle_commands
from remqa_data.errors import OutputError, UnknownNameError
from remqa_data.files import atomic_path
from remqa_data.geometry.types import U8
from remqa_data.mapping.map_picture import draw_plan
from remqa_data.mapping.semantic_map import VoxelMap
from remqa_data.opencv import cv2
from remqa_data.sim.agent.actions import MANIPULATION
from remqa_data.sim.arm.arm import ArmState
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table

SIZE_PX = 420
GAP_PX, HEADER_PX = 8, 80
PAPER, INK, DIM, POINTED = (255, 255, 255), (25, 25, 25), (110, 110, 110), (225, 60, 40)
FRAMES_PER_S = 4
REACHING_FRAMES, LAST_FRAMES = 6, 10
"""Frames in which the arm goes to the target, and for which the end stays."""
QUESTION_COLUMNS = 90
CODECS = {".mp4": "vp09", ".webm": "VP90"}
"""VP9, which browsers play, as each container calls it; OpenCV's wheels have no encoder for H.264 or AV1."""
ANIMATED, QUALITY = ".webp", 85
"""A picture that moves, for a page that shows pictures only."""

_ONE_AT_A_TIME = Lock()


def write_film(root: Path, question_id: str, path: Path, commands: Sequence[Command] | None = None) -> int:
    """Write an episode of a question of a dataset as .mp4, .webm or .webp; returns the number of frames.

    Parameters
    ----------
    root : path
        The dataset.
    question_id : str
        Which question.
    path : path
        The film.
    commands : sequence of Command, optional
        What the agent does; by default what the oracle does.

    Raises
    ------
    UnknownNameError
        If the dataset has no such question; names the nearest.
    DatasetError
        If this is not a finished dataset.
    OutputError
        If films of this kind cannot be written here, or the film was not written whole.
    """
    suffix = path.suffix.lower()
    if suffix not in (*CODECS, ANIMATED):
        raise OutputError(f"{path}: give a name that ends with {', '.join(CODECS)} or {ANIMATED}")
    with atomic_path(path) as temporary:
        frames = [
            np.ascontiguousarray(frame[..., ::-1]) for frame in _of_one_size(list(film(root, question_id, commands)))
        ]
        is_whole = (_write_animation if suffix == ANIMATED else _write_video)(temporary, frames)
        if not is_whole:  # OpenCV says nothing when a write fails
            raise OutputError(f"{path}: the film could not be written whole; is the disk full?")
    return len(frames)


def _write_video(path: Path, frames: list[U8]) -> bool:
    """Write BGR frames as a video; whether all can be read again."""
    height, width = frames[0].shape[:2]
    codec = cv2.VideoWriter.fourcc(*CODECS[path.suffix.lower()])
    with _without_stderr():
        writer = cv2.VideoWriter(str(path), codec, FRAMES_PER_S, (width, height))
    if not writer.isOpened():
        raise OutputError(f"{path}: this OpenCV cannot write VP9; install opencv-python-headless")
    for frame in frames:
        writer.write(frame)
    writer.release()
    return _readable_frames(path) == len(frames)


@contextmanager
def _without_stderr() -> Iterator[None]:
    """Nothing that the process says on stderr is heard, as OpenCV says of every WebM that its codec is not one of WebM's."""
    with _ONE_AT_A_TIME:
        stderr, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(null, 2)
            yield
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)
            os.close(null)


def _write_animation(path: Path, frames: list[U8]) -> bool:
    """Write BGR frames as a picture that moves, for ever; whether it can be read again and lasts as long."""
    film, frame_ms = cv2.Animation(), round(1000 / FRAMES_PER_S)
    film.frames, film.durations = frames, [frame_ms] * len(frames)
    if not cv2.imwriteanimation(str(path), film, [cv2.IMWRITE_WEBP_QUALITY, QUALITY]):
        return False
    is_readable, written = cv2.imreadanimation(str(path))
    return is_readable and sum(written.durations) == frame_ms * len(frames)  # frames that are alike become one


def _readable_frames(path: Path) -> int:
    """How many frames of a film can be decoded."""
    reader, count = cv2.VideoCapture(str(path)), 0
    while reader.read()[0]:
        count += 1
    reader.release()
    return count


def film(root: Path, question_id: str, commands: Sequence[Command] | None = None) -> Iterator[U8]:
    """The frames of an episode, (h, w, 3) RGB; their widths differ with the map's legend. See `write_film`.

    What was submitted is done with the hands with which it is scored: those get to what is within the arm's reach.
    """
    env = RemqaEnv(
        root,
        _split_of(root, question_id),
        question_ids=[question_id],
        hands="arm" if commands is None else "reach",
        privileged=True,
        render_mode="rgb_array",
        width=SIZE_PX,
        height=SIZE_PX,
        max_steps=10_000,
        vocabulary=Vocabulary.build((), ()),  # nobody reads the question's tokens; a dataset may have no train split
    )
    try:
        observation, _ = env.reset(options={"episode": question_id})
        task = env.episode.task
        assert task is not None, "episodes of a dataset have a question"
        memory = _Memory(env)
        memory.add(observation)
        doing = "start"
        yield _frame(env, observation, memory, doing)
        for command in oracle_commands(task) if commands is None else commands:
            if command.action is not None and command.action.name in MANIPULATION:
                yield from _reaching(env, observation, memory, command)
            try:
                observation, *_, info = env.step(command)
                error = str(info.get("error", ""))
            except UnknownNameError as unknown:  # a refused action, when it is scored
                error = str(unknown)
            memory.add(observation)
            doing = _said(command, task.answer, error)
            yield _frame(env, observation, memory, doing)
        for _ in range(LAST_FRAMES):
            yield _frame(env, observation, memory, doing)
    finally:
        env.close()


class _Memory:
    """The semantic map, and the way on it."""

    def __init__(self, env: RemqaEnv) -> None:
        self._env = env
        world = env.agent.world
        self._types = [world.type_of(object_id) for object_id in world.ids]
        self._voxels = VoxelMap.of_scene(world.scene)
        self._way: list[Cell] = []

    def add(self, observation: dict[str, Any]) -> None:
        """Remember a view."""
        agent = self._env.agent
        camera = agent.camera(self._env.width, self._env.height)
        self._voxels.add(observation["depth"], observation["instances"] - 1, self._types, camera)
        cell = AGENT.cell_at(agent.x, agent.y)
        if cell not in self._way[-1:]:
            self._way.append(cell)

    def picture(self) -> U8:
        """The map as it is now."""
        plan = self._voxels.plan()
        voxel_px = max(1, (SIZE_PX - 40) // max(plan.labels.shape))
        return draw_plan(plan, path=self._way, title="semantic map", voxel_px=voxel_px)


def _reaching(env: RemqaEnv, observation: dict[str, Any], memory: _Memory, command: Command) -> Iterator[U8]:
    """What the agent points at, and the arm on its way there; it is folded again afterwards, as the episode goes on."""
    assert command.action is not None
    if command.box is not None:
        yield _frame(env, observation, memory, "points at the target", command.box)
    arm, target = env.agent.arm, command.action.target
    if not isinstance(target, str) or target not in env.agent.world.ids:
        return
    first = arm.state
    last = arm.reach_object(env.agent.base, target).state
    for share in np.linspace(0.0, 1.0, REACHING_FRAMES + 1)[1:].tolist():
        arm.state = ArmState.of((1.0 - share) * first.posture() + share * last.posture())
        yield _frame(env, observation, memory, "reaching", command.box)
    arm.state = first


def _frame(env: RemqaEnv, observation: dict[str, Any], memory: _Memory, doing: str, box: Shares | None = None) -> U8:
    outside = env.render()
    assert outside is not None
    seen = observation["rgb"]
    if box is not None:
        seen = seen.copy()
        x1, y1, x2, y2 = (round(share * SIZE_PX) for share in box)
        cv2.rectangle(seen, (x1, y1), (x2, y2), POINTED, 2)
    plan = memory.picture()[:SIZE_PX]
    plan = _padded(plan, SIZE_PX, plan.shape[1])
    gap = np.full((SIZE_PX, GAP_PX, 3), PAPER, np.uint8)
    body = np.hstack([seen, gap, outside, gap, plan])
    header = np.full((HEADER_PX, body.shape[1], 3), PAPER, np.uint8)
    task = env.episode.task
    assert task is not None
    _write(header, textwrap.shorten(task.question, QUESTION_COLUMNS), 0, 24, 0.65, INK)
    _write(header, f"step {env.steps}: {doing}", 0, 48, 0.5, INK)
    _write(header, "what the agent sees", 0, 72, 0.42, DIM)
    _write(header, "the agent from outside", SIZE_PX + GAP_PX, 72, 0.42, DIM)
    return np.vstack([header, body])


def _said(command: Command, right: str, refusal: str) -> str:
    """A command in few words, and what came of it: an object's type stands for its id."""
    if command.action is None:
        return f"answer: {command.answer}" + (f", but it is {right}" if command.answer != right else "")
    target = command.action.target
    said = f"{command.action.name} {target.partition('|')[0]}" if isinstance(target, str) else command.action.name
    return f"{said}: {textwrap.shorten(refusal, QUESTION_COLUMNS)}" if refusal else said


def _write(image: U8, text: str, x: int, y: int, scale: float, color: tuple[int, int, int]) -> None:
    cv2.putText(image, text, (x + GAP_PX, y), cv2.FONT_HERSHEY_SIMPLEX, scale, color, 1, cv2.LINE_AA)


def _of_one_size(frames: list[U8]) -> list[U8]:
    """All as large as the largest, in even numbers of pixels, which films need."""
    height, width = (2 * -(-max(frame.shape[axis] for frame in frames) // 2) for axis in (0, 1))
    return [_padded(frame, height, width) for frame in frames]


def _padded(image: U8, height: int, width: int) -> U8:
    page = np.full((height, width, 3), PAPER, np.uint8)
    page[: image.shape[0], : image.shape[1]] = image
    return page


def _split_of(root: Path, question_id: str) -> str:
    known: list[str] = []
    for split in load_manifest(root).splits("questions"):
        ids = read_table(root, "questions", split, ["question_id"])["question_id"].to_pylist()
        if question_id in ids:
            return str(split)
        known += ids
    raise UnknownNameError("question", question_id, known)
