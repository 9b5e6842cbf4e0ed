"""Letting an agent play all questions of a split; what it did becomes a submission that `remqa-eval` replays.

All questions about one configuration of a room are one job. What a job has done is written when it is whole, so that a run that
was stopped can go on. What the agent draws depends on the seed and the question alone: the submission is the same with any
number of workers.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from remqa_data.agents.agent import Agent
from remqa_data.agents.episodes import play_question
from remqa_data.agents.knowledge.memory import WalkMemories
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env import RemqaEnv
from remqa_data.env.recorder import Recorder
from remqa_data.errors import ConfigError
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.evaluation.submission.reader import Header, write_submission
from remqa_data.evaluation.submission.tracks import MAX_ACTIONS
from remqa_data.files import atomic_path
from remqa_data.processes.executors import LocalExecutor
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.version import __version__

ENV_STEPS = MAX_ACTIONS + 10
"""The agent stops before the environment does: its walk, some manipulations, and the answer."""


@dataclass(frozen=True)
class PlayJob:
    """The questions about one configuration.

    Attributes
    ----------
    root, split : path, str
        Of the dataset.
    room : (str, int)
        Scene and configuration.
    question_ids : tuple of str
    agent : Agent
        Who plays; it goes to other processes, so it can be pickled.
    title : str
        Its name.
    seed : int
        Of what it draws.
    part : Path
        Where the rows go.
    """

    root: Path
    split: str
    room: tuple[str, int]
    question_ids: tuple[str, ...]
    agent: Agent
    title: str
    seed: int
    part: Path


def play_split(
    agent: Agent,
    root: Path,
    split: str,
    path: Path,
    *,
    title: str = "unnamed",
    seed: int = 0,
    fingerprint: str = "",
    only: Sequence[str] | None = None,
    workers: int = 1,
    resume: bool = False,
    progress: Callable[[int], None] | None = None,
) -> int:
    """Play all questions of a split and write the submission, and beside it (`pace_path`) how long that took.

    Parameters
    ----------
    agent : Agent
        Who plays.
    root, split : path, str
        What is asked.
    path : path
        The submission to write, .jsonl or .parquet. Until it is whole, finished rooms lie in a folder beside it.
    title : str
        The agent's name, for reports.
    seed : int
        Of what the agent draws.
    fingerprint : str
        What else the rows depend on, such as the hash of a configuration: only a run with the same goes on with another.
    only : sequence of str, optional
        Ids of the questions to play; all of the split by default.
    workers : int
        Processes.
    resume : bool
        Go on with what an interrupted run has finished.
    progress : callable, optional
        Called with the number of questions that have been played since the last call.

    Returns
    -------
    Number of rows.

    Raises
    ------
    DatasetError
        If the dataset cannot be read.
    ConfigError
        If what is to be gone on with is another run.
    """
    dataset = dataset_sha256(load_manifest(root))
    asked = read_table(root, "questions", split, ["question_id", "scene", "configuration"]).to_pylist()
    if only is not None:
        wanted = frozenset(only)
        asked = [row for row in asked if row["question_id"] in wanted]
    parts = path.with_name(f"{path.name}.parts")
    about = {"dataset": dataset, "split": split, "title": title, "seed": seed, "system": fingerprint}
    about["questions"] = crc32(" ".join(row["question_id"] for row in asked).encode())
    _prepare(parts, about | {"version": __version__}, resume)
    jobs = _jobs(agent, root, split, asked, title, seed, parts)
    waiting = []
    for job in jobs:
        if not job.part.is_file():
            waiting.append(job)
        elif progress is not None:
            progress(len(job.question_ids))
    for job, _ in LocalExecutor(min(workers, len(waiting)) or 1).run(play_room, waiting):
        if progress is not None:
            progress(len(job.question_ids))
    rows = {row["question_id"]: row for job in jobs for row in _rows(job.part)}
    header = Header(track="remqa", split=split, dataset=dataset, agent=title)
    write_submission(path, header, [rows[row["question_id"]] for row in asked])
    _write_pace(path, rows.values(), jobs)
    shutil.rmtree(parts)
    return len(rows)


def play_room(job: PlayJob) -> None:
    """Play the questions about one configuration, and write the rows."""
    env, memories = _stage(job.root, job.split)
    memory = memories.memory(*job.room)
    recorder = Recorder(env, job.part, job.title)
    began = time.process_time()
    try:
        for question_id in job.question_ids:
            rng = np.random.default_rng([job.seed, crc32(question_id.encode())])
            play_question(recorder, question_id, job.agent, memory, rng)
        _seconds_path(job.part).write_text(str(time.process_time() - began), encoding="utf-8")
        recorder.save()
    finally:
        env.close()  # the room; the environment itself plays on


def pace_path(submission: Path) -> Path:
    """Where `play_split` writes how many actions a submission has, and how many seconds of a core it took to play them."""
    return submission.with_suffix(".pace.json")


@lru_cache(maxsize=1)
def _stage(root: Path, split: str) -> tuple[RemqaEnv, WalkMemories]:
    """What a process reads once for all of its jobs; hands are those with which `remqa-eval` replays."""
    nobody_reads_tokens = Vocabulary.build((), ())
    env = RemqaEnv(root, split, hands="reach", max_steps=ENV_STEPS, vocabulary=nobody_reads_tokens)
    return env, WalkMemories(root, split)


def _jobs(
    agent: Agent, root: Path, split: str, asked: list[dict[str, Any]], title: str, seed: int, parts: Path
) -> list[PlayJob]:
    by_room: dict[tuple[str, int], list[str]] = {}
    for row in asked:
        by_room.setdefault((row["scene"], row["configuration"]), []).append(row["question_id"])
    return [
        PlayJob(root, split, room, tuple(ids), agent, title, seed, parts / f"{room[0]}-c{room[1]}.jsonl")
        for room, ids in by_room.items()
    ]


def _prepare(parts: Path, about: dict[str, Any], resume: bool) -> None:
    """A folder for finished rooms, which says what run they are of; empty unless that is the same run."""
    note = parts / "run.json"
    if resume and note.is_file():
        if json.loads(note.read_text(encoding="utf-8")) != about:
            raise ConfigError(f"{parts}: holds rooms of another run; leave --resume out to begin anew")
        return
    if parts.exists() and not note.is_file():
        raise ConfigError(f"{parts} is not of remqa-agent: move it elsewhere, or write to another folder")
    shutil.rmtree(parts, ignore_errors=True)
    with atomic_path(note) as temporary:
        temporary.write_text(json.dumps(about), encoding="utf-8")


def _seconds_path(part: Path) -> Path:
    return part.with_suffix(".seconds")


def _write_pace(path: Path, rows: Iterable[dict[str, Any]], jobs: Iterable[PlayJob]) -> None:
    steps = sum(len(row["actions"]) + (row["manipulation"] is not None) for row in rows)
    seconds = sum(float(_seconds_path(job.part).read_text(encoding="utf-8")) for job in jobs)
    with atomic_path(pace_path(path)) as temporary:
        temporary.write_text(json.dumps({"steps": steps, "seconds": round(seconds, 2)}) + "\n", encoding="utf-8")


def _rows(part: Path) -> list[dict[str, Any]]:
    """The rows of a finished room, which is a submission of its own: its first line is a header."""
    return [json.loads(line) for line in part.read_text(encoding="utf-8").splitlines()[1:]]
