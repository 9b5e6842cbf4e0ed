"""From scenes that are generated anywhere, in any order, to the shards of one dataset.

Each scene is written as a part: a few files under `.parts`, and last a note with their checksums, which makes the part
finished. Then every shard is merged from parts in a fixed order. So the shards are the same bytes whoever made the parts
and in whatever order, and a run that was cut off goes on where it stopped. Parts lie in a folder that is named after what
they depend on, so that parts of different runs are never mixed, not even when a process of an older run is still writing.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from pydantic import TypeAdapter, ValidationError

from remqa_data.errors import DamagedPartError, DatasetError
from remqa_data.files import name_of_leftover, sha256_of
from remqa_data.processes.executors import Executor, LocalExecutor
from remqa_data.storage.backend import storage_at
from remqa_data.storage.manifest import MANIFEST, PARTS, FileInfo, Manifest, config_hash, write_manifest
from remqa_data.storage.ownership import SPLITS, is_known, remove_parts
from remqa_data.storage.protocol import Storage
from remqa_data.storage.shards import Shard, ShardWriter, file_info
from remqa_data.tables.rows import Row
from remqa_data.tables.schema import TABLES

_NOTE = "part.json"
_REQUESTS = 32
"""Notes that are read at the same time."""


@dataclass(frozen=True)
class Part:
    """A finished scene.

    Attributes
    ----------
    scene : str
        Its name.
    files : tuple of FileInfo
        Where its rows are.
    questions : mapping
        Number of questions by split and kind.
    report : mapping
        What else to keep until the manifest is written, such as counts of refused candidates.
    """

    scene: str
    files: tuple[FileInfo, ...]
    questions: dict[str, dict[str, int]]
    report: dict[str, Any]


@dataclass(frozen=True)
class Piece:
    """Rows of a part that belong into a shard: so many from the first one on."""

    scene: str
    note: str
    file: FileInfo
    first: int
    rows: int


@dataclass(frozen=True)
class ShardJob:
    """All that is needed to write one shard, on any machine that can reach the dataset's root."""

    root: str
    path: str
    table: str
    split: str
    pieces: tuple[Piece, ...]


class Parts:
    """The parts of one run. It can be sent to another process.

    Parameters
    ----------
    root : path or str
        Where the dataset shall lie, see `storage_at`.
    run : mapping
        What the scenes depend on, such as seed, configuration hash and versions; plain JSON.
    """

    def __init__(self, root: str | os.PathLike[str], run: Mapping[str, Any]) -> None:
        self.storage = storage_at(root)
        self.folder = f"{PARTS}/{config_hash(run)[:16]}"

    def finished(self) -> dict[str, Part]:
        """Parts that are finished, by scene, as far as can be told without reading them.

        Raises
        ------
        DatasetError
            If there are parts of another run.
        """
        paths = [file.path for file in self.storage.files(PARTS)]
        if any(path.endswith(f"/{_NOTE}") and not path.startswith(f"{self.folder}/") for path in paths):
            raise DatasetError(
                f"{self.storage.where(PARTS)} holds scenes of another run (other seed, configuration, templates, or "
                "version of Python or a package); use --overwrite, another folder, or what it was begun with"
            )
        notes = [path for path in paths if path.endswith(f"/{_NOTE}")]
        with ThreadPoolExecutor(_REQUESTS) as pool:
            parts = pool.map(lambda path: _parsed(self.storage.read(path)), notes)
            return {part.scene: part for part in parts if part is not None}

    def write(
        self, scene: str, rows_by_table: Mapping[str, Sequence[Row]], report: Mapping[str, Any] | None = None
    ) -> Part:
        """Write all rows of one scene; the part is finished when all is written.

        Parameters
        ----------
        scene : str
            Name of the scene.
        rows_by_table : mapping
            Rows of each table in their final order; each row's `split` says where it goes.
        report : mapping, optional
            See `Part`; plain JSON.

        Raises
        ------
        SchemaError
            Naming the table, row and field that do not fit.
        """
        files = []
        for table, rows in rows_by_table.items():
            for split in dict.fromkeys(row.split for row in rows):
                path = f"{self.folder}/{scene}/{table}.{split}.parquet"
                with self.storage.publish(path) as temporary:
                    with ShardWriter(temporary, table) as writer:
                        writer.write_rows([row for row in rows if row.split == split])
                    files.append(file_info(temporary, path, table, split))
        asked: dict[str, Counter[str]] = {}
        for row in rows_by_table.get("questions", ()):
            asked.setdefault(row.split, Counter())[row.kind] += 1  # type: ignore[union-attr]
        questions = {split: dict(kinds) for split, kinds in asked.items()}
        part = Part(scene, tuple(files), questions, dict(report or {}))
        with self.storage.publish(self._note(scene)) as temporary:
            temporary.write_bytes(_note_text(part))
        return part

    def keep(self, name: str, text: bytes) -> None:
        """Keep something beside the parts for a run that goes on with them."""
        with self.storage.publish(f"{self.folder}/{name}") as temporary:
            temporary.write_bytes(_with_checksum(text))

    def kept(self, name: str) -> bytes | None:
        """What was kept; None if nothing was, or it is torn."""
        with suppress(FileNotFoundError):
            return _without_checksum(self.storage.read(f"{self.folder}/{name}"))
        return None

    def shard_jobs(self, parts: Sequence[Part], shards_per_split: int | Mapping[str, int]) -> list[ShardJob]:
        """What is to be merged.

        Parameters
        ----------
        parts : sequence of Part
            All scenes, in the order in which their rows shall lie.
        shards_per_split : int or mapping of str to int
            Number of files per table and split; a split with fewer rows has one for each row.
        """
        jobs = []
        for table in TABLES:
            for split in SPLITS:
                sources = [(p.scene, f) for p in parts for f in p.files if (f.table, f.split) == (table, split)]
                wanted = shards_per_split if isinstance(shards_per_split, int) else shards_per_split[split]
                bounds = shard_bounds(sum(file.rows for _, file in sources), wanted)
                for number, pieces in enumerate(self._pieces(sources, bounds)):
                    path = shard_path(table, split, number, len(bounds) - 1)
                    jobs.append(ShardJob(self.storage.root, path, table, split, tuple(pieces)))
        return jobs

    def _pieces(self, sources: Iterable[tuple[str, FileInfo]], bounds: Sequence[int]) -> list[list[Piece]]:
        """The pieces of each shard; a shard has the rows between two bounds, counted over all sources."""
        pieces: list[list[Piece]] = [[] for _ in bounds[1:]]
        shard = start = 0
        for scene, file in sources:
            first = 0
            while first < file.rows:
                if start + first == bounds[shard + 1]:
                    shard += 1
                rows = min(file.rows - first, bounds[shard + 1] - start - first)
                pieces[shard].append(Piece(scene, self._note(scene), file, first, rows))
                first += rows
            start += file.rows
        return pieces

    def _note(self, scene: str) -> str:
        return f"{self.folder}/{scene}/{_NOTE}"


def shard_bounds(rows: int, wanted: int) -> list[int]:
    """Where the shards of a table begin and end when its rows are dealt out evenly; none is empty.

    >>> shard_bounds(10, 3), shard_bounds(1, 3), shard_bounds(0, 3)
    ([0, 3, 6, 10], [0, 1], [0])
    """
    count = min(wanted, rows)
    return [number * rows // count for number in range(count + 1)] if count else [0]


def shard_path(table: str, split: str, number: int, count: int) -> str:
    """Where a shard of several lies in the dataset.

    >>> shard_path("frames", "train", 2, 5)
    'frames/train-00002-of-00005.parquet'
    """
    return f"{table}/{split}-{number:05d}-of-{count:05d}.parquet"


def merge(job: ShardJob) -> FileInfo:
    """Write one shard.

    Raises
    ------
    DamagedPartError
        If a part is not as it was written. It does not count as finished any more.
    """
    storage = storage_at(job.root)
    with storage.publish(job.path) as temporary:
        with ShardWriter(temporary, job.table) as writer:
            for piece in job.pieces:
                for rows in _rows(storage, piece):
                    writer.write_table(rows)
        return file_info(temporary, job.path, job.table, job.split)


def assemble(
    parts: Parts,
    order: Sequence[Part],
    shards_per_split: int | Mapping[str, int],
    executor: Executor | None = None,
) -> tuple[FileInfo, ...]:
    """Merge all shards, by default in this process, and remove older ones; see `Parts.shard_jobs`."""
    unfinish(parts.storage)
    jobs = parts.shard_jobs(order, shards_per_split)
    made = {info.path: info for _, info in (executor or LocalExecutor()).run(merge, jobs)}
    files = tuple(made[job.path] for job in jobs)
    tidy(parts.storage, files)
    return files


def unfinish(storage: Storage) -> None:
    """Remove an older manifest, so that nothing looks finished while shards are written."""
    storage.delete([MANIFEST])


def tidy(storage: Storage, files: Iterable[FileInfo]) -> None:
    """Remove shards of an older dataset, and what killed processes left half-written.

    Raises
    ------
    DatasetError
        If a shard is not the one that was written, as when a lost machine of an older run has come back and written its own.
    """
    written = {file.path: file.bytes for file in files}
    found = {file.path: file.bytes for file in storage.files()}
    for path, size in written.items():
        if found.get(path) != size:
            raise DatasetError(
                f"{storage.where(path)} was written by another run meanwhile; go on with remqa-gen --resume"
            )
    ours = [path for path in found if is_known(path) and path not in written]
    storage.delete(path for path in ours if path.partition("/")[0] in TABLES)
    storage.delete(path for path in ours if "/" not in path and name_of_leftover(path))


def finish(storage: Storage, manifest: Manifest) -> None:
    """Write the manifest, which makes this a finished dataset, then remove the parts."""
    write_manifest(storage.root, manifest)
    remove_parts(storage)


def count_questions(parts: Iterable[Part]) -> dict[str, dict[str, int]]:
    """Number of questions by split and kind, for the manifest."""
    counts: dict[str, dict[str, int]] = {}
    for part in parts:
        for split, kinds in part.questions.items():
            of_split = counts.setdefault(split, {})
            for kind, count in kinds.items():
                of_split[kind] = of_split.get(kind, 0) + count
    return counts


def _rows(storage: Storage, piece: Piece) -> Iterator[pa.Table]:
    """The rows of a piece, a row group in memory at a time; a file that is not as it was written is read once more."""
    for _ in range(2):
        with suppress(FileNotFoundError), storage.fetch(piece.file.path) as path:
            if sha256_of(path) == piece.file.sha256:
                yield from _sliced(path, piece.file.table, piece.first, piece.rows)
                return
    raise _damaged(storage, piece)


def _sliced(path: Path, table: str, first: int, rows: int) -> Iterator[pa.Table]:
    shard, start = Shard(path, table), 0
    for group in range(shard.row_groups):
        end = start + shard.rows(group)
        low, high = max(first, start), min(first + rows, end)
        if low < high:
            yield shard.read(group).slice(low - start, high - low)
        start = end


def _damaged(storage: Storage, piece: Piece) -> DamagedPartError:
    storage.delete([piece.note])
    return DamagedPartError(
        f"{storage.where(piece.file.path)} is not as it was written; go on with remqa-gen --resume, "
        f"which makes {piece.scene} again"
    )


def _note_text(part: Part) -> bytes:
    return _with_checksum(json.dumps(asdict(part)).encode())


def _parsed(note: bytes) -> Part | None:
    """A part by its note; None if that is torn."""
    text = _without_checksum(note)
    try:
        return None if text is None else _PART.validate_json(text)
    except ValidationError:
        return None


def _with_checksum(text: bytes) -> bytes:
    """A text below its own checksum."""
    return hashlib.sha256(text).hexdigest().encode() + b"\n" + text


def _without_checksum(note: bytes) -> bytes | None:
    checksum, _, text = note.partition(b"\n")
    return text if hashlib.sha256(text).hexdigest().encode() == checksum else None


_PART = TypeAdapter(Part)
