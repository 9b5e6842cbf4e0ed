"""Checking a dataset from its files alone: checksums, balance, and every question in a freshly loaded world."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from remqa_data.errors import RemqaError
from remqa_data.generators.audit.balance import AskedQuestion, asked_questions, balance_failures
from remqa_data.generators.audit.truths import CheckedRoom, Failure
from remqa_data.processes.executors import LocalExecutor
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import Shard, check_files, shard_paths
from remqa_data.tables.rows import QuestionRow, SceneRow
from remqa_data.tables.schema import R, table_of, to_rows


@dataclass(frozen=True)
class Verification:
    """How many questions were checked, and what does not hold.

    Attributes
    ----------
    checked : tuple of str
        Ids of the questions that were replayed.
    failures : tuple of Failure
        Those of the dataset as a whole, then by room in the order of the dataset.
    """

    checked: tuple[str, ...]
    failures: tuple[Failure, ...]

    @property
    def failed(self) -> frozenset[str]:
        """Ids of the questions that were replayed and do not hold."""
        return frozenset(failure.where for failure in self.failures).intersection(self.checked)


def verify(
    root: Path,
    sample: int | None = None,
    seed: int = 0,
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Verification:
    """Check a finished dataset.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    sample : int, optional
        How many questions to replay, drawn at random; all by default. Checksums, schemas and balance are always checked
        in full.
    seed : int
        Of the draw.
    workers : int
        Number of processes. What is found does not depend on it.
    progress : callable, optional
        Called with the numbers of questions replayed and to replay.

    Raises
    ------
    DatasetError
        If the folder is not a finished dataset, or a shard is damaged.
    """
    check_files(root)
    manifest = load_manifest(root)
    questions = asked_questions(root, manifest)
    failures = list(balance_failures(questions, manifest))
    if sample is not None and sample < len(questions):
        chosen = np.random.default_rng(seed).choice(len(questions), sample, replace=False)
        questions = [questions[i] for i in sorted(chosen)]
    tell, done = progress or (lambda done, total: None), 0
    tell(done, len(questions))
    found: dict[str, list[Failure]] = {}
    for room, wrong in LocalExecutor(workers).run(_check_room, _rooms(root, questions)):
        found[room.scene] = wrong
        done += len(room.question_ids)
        tell(done, len(questions))
    failures += [failure for scene in dict.fromkeys(q.scene for q in questions) for failure in found[scene]]
    return Verification(tuple(question.question_id for question in questions), tuple(failures))


Piece = tuple[Path, int]
"""A shard and a row group in it."""


@dataclass(frozen=True)
class _RoomJob:
    """Questions of one room, and where the rows lie."""

    scene: str
    question_ids: frozenset[str]
    scene_pieces: tuple[Piece, ...]
    question_pieces: tuple[Piece, ...]


def _rooms(root: Path, questions: Sequence[AskedQuestion]) -> list[_RoomJob]:
    jobs = []
    for split, of_split in groupby(questions, lambda question: question.split):
        wanted: dict[str, list[str]] = {}
        for question in of_split:
            wanted.setdefault(question.scene, []).append(question.question_id)
        pieces = {table: _pieces(root, table, split) for table in ("scenes", "questions")}
        for scene, ids in wanted.items():
            places = (tuple(pieces[table].get(scene, ())) for table in ("scenes", "questions"))
            jobs.append(_RoomJob(scene, frozenset(ids), *places))
    return jobs


def _pieces(root: Path, table: str, split: str) -> dict[str, list[Piece]]:
    """Where the rows of each room lie."""
    found: dict[str, list[Piece]] = {}
    for path in shard_paths(root, table, split):
        shard = Shard(path, table)
        for group in range(shard.row_groups):
            for scene in shard.read(group, ["scene"])["scene"].unique().to_pylist():
                found.setdefault(scene, []).append((path, group))
    return found


def _check_room(job: _RoomJob) -> list[Failure]:
    """What does not hold of the chosen questions of a room."""
    questions = [q for q in _rows(QuestionRow, job.question_pieces) if q.question_id in job.question_ids]
    rows = {row.configuration: row for row in _rows(SceneRow, job.scene_pieces) if row.scene == job.scene}
    failures: list[Failure] = []
    for number, asked in _by_configuration(questions):
        if number not in rows:
            reason = f"there is no configuration {number} of {job.scene}"
            failures += [Failure(question.question_id, "consistent", reason) for question in asked]
            continue
        try:
            room = CheckedRoom(rows[number])
        except RemqaError as error:
            failures += [Failure(question.question_id, "consistent", str(error)) for question in asked]
            continue
        failures += room.failures()
        for question in asked:
            failures += room.question_failures(question)
    return failures


def _by_configuration(questions: Iterable[QuestionRow]) -> list[tuple[int, list[QuestionRow]]]:
    ordered = sorted(questions, key=lambda question: question.configuration)
    return [(number, list(asked)) for number, asked in groupby(ordered, lambda question: question.configuration)]


def _rows(row_type: type[R], pieces: Iterable[Piece]) -> Iterator[R]:
    for path, group in pieces:
        yield from to_rows(row_type, Shard(path, table_of(row_type).name).read(group))
