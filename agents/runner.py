"""Letting agents play all questions of a split; what each did becomes a submission that `remqa-eval` replays.

All questions about one configuration of a room are one job, whoever plays. What a job has done is written when it is whole,
so that a run that was stopped can go on. What an agent draws depends on its seed and the question alone: its submission is
the same with any number of workers, and whoever plays beside it.
"""

from __future__ import annotations

import json
import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from remqa_data.agents.agent import LOOKING_STEPS, MOST_MANIPULATIONS, MOST_TRIES, Agent
from remqa_data.agents.episodes import play_question
from remqa_data.agents.knowledge.memory import WalkMemories, WalkMemory
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env import RemqaEnv
from remqa_data.env.recorder import Recorder
from remqa_data.errors import ConfigError
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.evaluation.scoring.replay import RoomKey
from remqa_data.evaluation.submission.reader import Header, write_submission
from remqa_data.files import atomic_path, check_is_new
from remqa_data.limits import MAX_ACTIONS
from remqa_data.processes.executors import LocalExecutor
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.version import __version__

ENV_STEPS = MAX_ACTIONS + MOST_TRIES * MOST_MANIPULATIONS + LOOKING_STEPS + 1
"""The agent stops before the environment does: its walk, what it tries to do, its looks inside, and the answer."""

NOTE = "run.json"
"""Among finished rooms: what run they are of."""

VIEWS_KEPT = 600
"""Whoever plays walks by the same places; 0.8 GB in each process."""


@dataclass(frozen=True)
class Player:
    """Who plays, and where what it does is written.

    Attributes
    ----------
    agent : Agent
        It goes to other processes, so it can be pickled.
    path : path
        The submission to write, .jsonl or .parquet. Until it is whole, finished rooms lie in a folder beside it.
    title : str
        The agent's name, for reports.
    seed : int
        Of what the agent draws.
    fingerprint : str
        What else the rows depend on, such as the hash of a configuration: only a run with the same goes on with another.
    """

    agent: Agent
    path: Path
    title: str = "unnamed"
    seed: int = 0
    fingerprint: str = ""

    @property
    def parts(self) -> Path:
        """Where finished rooms lie."""
        return parts_path(self.path)

    def part(self, room: RoomKey) -> Path:
        """Where the rows about a scene and a configuration go."""
        return self.parts / f"{room[0]}-c{room[1]}.jsonl"


@dataclass(frozen=True)
class PlayJob:
    """The questions about one configuration.

    Attributes
    ----------
    root, split : path, str
        Of the dataset.
    room : RoomKey
        Where.
    question_ids : tuple of str
    players : tuple of Player
        Those that have not played there yet, one after the other: the room is loaded and lit once for all.
    """

    root: Path
    split: str
    room: RoomKey
    question_ids: tuple[str, ...]
    players: tuple[Player, ...]


def check_places(paths: Iterable[Path], *, overwrite: bool, resume: bool) -> None:
    """Refuse to write over what agents have played, be it finished or not.

    Raises
    ------
    ConfigError
        If there is any, and neither overwriting nor resuming was asked for.
    """
    for path in paths:
        check_is_new(path, (path, parts_path(path)), "played", overwrite=overwrite, resume=resume)


def parts_path(submission: Path) -> Path:
    """Where finished rooms lie until the submission is whole."""
    return submission.with_name(f"{submission.name}.parts")


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
    """Let one agent play all questions of a split and write its submission; see `Player` and `play_all`.

    Returns
    -------
    Number of rows.
    """
    player = Player(agent, path, title, seed, fingerprint)
    return play_all([player], root, split, only=only, workers=workers, resume=resume, progress=progress)


def play_all(
    players: Sequence[Player],
    root: Path,
    split: str,
    *,
    only: Sequence[str] | None = None,
    workers: int = 1,
    resume: bool = False,
    progress: Callable[[int], None] | None = None,
) -> int:
    """Let agents play all questions of a split; write their submissions, and beside each (`pace_path`) how long it took.

    Parameters
    ----------
    players : sequence of Player
        Who plays.
    root, split : path, str
        What is asked.
    only : sequence of str, optional
        Ids of the questions to play; all of the split by default.
    workers : int
        Processes.
    resume : bool
        Go on with what an interrupted run has finished; submissions that the same run has written stay as they are.
    progress : callable, optional
        Called with the number of questions that have been played since the last call, by all players.

    Returns
    -------
    Number of rows of each submission.

    Raises
    ------
    DatasetError
        If the dataset cannot be read.
    ConfigError
        If what is to be gone on with is another run.
    """
    _check_paths_differ(players)

    def tell(played: int) -> None:
        if progress is not None and played:
            progress(played)

    dataset, asked = dataset_sha256(load_manifest(root)), _questions(root, split, only)
    rooms = _by_room(asked)
    questions = crc32(" ".join(row["question_id"] for row in asked).encode())
    about = {"dataset": dataset, "split": split, "questions": questions, "version": __version__}
    runs = {player.path: about | _told_of(player) for player in players}
    playing = [player for player in players if not (resume and _is_finished(player.path, runs[player.path]))]
    for player in playing:
        _prepare(player.parts, runs[player.path], resume)
    jobs = _jobs(root, split, rooms, playing)
    tell(len(asked) * len(players) - sum(map(_size, jobs)))  # what has been played already
    for job, _ in LocalExecutor(min(workers, len(jobs)) or 1).run(play_room, jobs):
        tell(_size(job))
    for player in playing:
        parts = [player.part(room) for room in rooms]
        rows = {row["question_id"]: row for part in parts for row in _rows(part)}
        header = Header(track="remqa", split=split, dataset=dataset, agent=player.title)
        write_submission(player.path, header, [rows[row["question_id"]] for row in asked])
        _write_pace(player.path, rows.values(), parts, runs[player.path])
    for player in players:
        if (player.parts / NOTE).is_file():  # a run that was stopped here has left them
            shutil.rmtree(player.parts)
    return len(asked)


def _check_paths_differ(players: Iterable[Player]) -> None:
    for path, count in Counter(player.path for player in players).items():
        if count > 1:
            raise ConfigError(
                f"{count} systems would write {path}: let them play one after the other, to folders of their own"
            )


def _questions(root: Path, split: str, only: Sequence[str] | None) -> list[dict[str, Any]]:
    """Ids and rooms of the questions of a split, or of some of them."""
    asked: list[dict[str, Any]] = read_table(
        root, "questions", split, ["question_id", "scene", "configuration"]
    ).to_pylist()
    wanted = None if only is None else frozenset(only)
    return [row for row in asked if wanted is None or row["question_id"] in wanted]


def _by_room(asked: Iterable[dict[str, Any]]) -> dict[RoomKey, list[str]]:
    """Ids of questions by the configuration that they are about."""
    rooms: dict[RoomKey, list[str]] = {}
    for row in asked:
        rooms.setdefault((row["scene"], row["configuration"]), []).append(row["question_id"])
    return rooms


def _jobs(root: Path, split: str, rooms: dict[RoomKey, list[str]], playing: Sequence[Player]) -> list[PlayJob]:
    """What is left to play: in each room, by those who have not played there yet."""
    waiting = {room: tuple(player for player in playing if not player.part(room).is_file()) for room in rooms}
    return [PlayJob(root, split, room, tuple(ids), waiting[room]) for room, ids in rooms.items() if waiting[room]]


def _size(job: PlayJob) -> int:
    """How many questions are played, by all players."""
    return len(job.question_ids) * len(job.players)


def play_room(job: PlayJob) -> None:
    """Let the players play the questions about one configuration, and write the rows of each."""
    env, memories = _stage(job.root, job.split)
    memory = memories.memory(*job.room)
    try:
        env.reset(options={"episode": job.question_ids[0]})  # loads the room, which is nobody's time
        for player in job.players:
            _play(player, env, memory, job)
    finally:
        env.close()  # the room; the environment itself plays on


def _play(player: Player, env: RemqaEnv, memory: WalkMemory, job: PlayJob) -> None:
    part = player.part(job.room)
    recorder = Recorder(env, part, player.title)
    began = time.process_time()
    for question_id in job.question_ids:
        rng = np.random.default_rng([player.seed, crc32(question_id.encode())])
        play_question(recorder, question_id, player.agent, memory, rng)
    _seconds_path(part).write_text(str(time.process_time() - began), encoding="utf-8")
    recorder.save()


def pace_path(submission: Path) -> Path:
    """Where it is written how many actions a submission has, how many seconds of a core it took to play them, and by whom."""
    return submission.with_suffix(".pace.json")


def read_pace(submission: Path) -> dict[str, Any]:
    """What is written there: `steps`, `seconds` and `run`; nothing if nobody has."""
    return read_told(pace_path(submission))


@lru_cache(maxsize=1)
def _stage(root: Path, split: str) -> tuple[RemqaEnv, WalkMemories]:
    """What a process reads once for all of its jobs; hands are those with which `remqa-eval` replays."""
    nobody_reads_tokens = Vocabulary.build((), ())
    env = RemqaEnv(
        root, split, hands="reach", max_steps=ENV_STEPS, vocabulary=nobody_reads_tokens, views_kept=VIEWS_KEPT
    )
    return env, WalkMemories(root, split)


def _prepare(parts: Path, about: dict[str, Any], resume: bool) -> None:
    """A folder for finished rooms, which says what run they are of; empty unless that is the same run."""
    note = parts / NOTE
    if resume and note.is_file():
        if read_told(note) != about:
            raise ConfigError(
                f"{parts}: holds rooms of another run; use --overwrite in place of --resume to begin anew"
            )
        return
    if parts.exists() and not note.is_file():
        raise ConfigError(f"{parts} is not of remqa-agent: move it elsewhere, or write to another folder")
    shutil.rmtree(parts, ignore_errors=True)
    with atomic_path(note) as temporary:
        temporary.write_text(json.dumps(about), encoding="utf-8")


def _told_of(player: Player) -> dict[str, Any]:
    return {"title": player.title, "seed": player.seed, "system": player.fingerprint}


def _is_finished(submission: Path, run: dict[str, Any]) -> bool:
    """Whether this run has written its submission."""
    return submission.is_file() and read_pace(submission).get("run") == run


def read_told(path: Path) -> dict[str, Any]:
    """What a run has told in a file of JSON; nothing if there is none, or it is damaged."""
    try:
        told = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return told if isinstance(told, dict) else {}


def _seconds_path(part: Path) -> Path:
    return part.with_suffix(".seconds")


def _write_pace(path: Path, rows: Iterable[dict[str, Any]], parts: Iterable[Path], run: dict[str, Any]) -> None:
    steps = sum(len(row["actions"]) + (row["manipulation"] is not None) for row in rows)
    seconds = sum(float(_seconds_path(part).read_text(encoding="utf-8")) for part in parts)
    with atomic_path(pace_path(path)) as temporary:
        pace = {"steps": steps, "seconds": round(seconds, 2), "run": run}
        temporary.write_text(json.dumps(pace) + "\n", encoding="utf-8")


def _rows(part: Path) -> list[dict[str, Any]]:
    """The rows of a finished room, which is a submission of its own: its first line is a header."""
    return [json.loads(line) for line in part.read_text(encoding="utf-8").splitlines()[1:]]
