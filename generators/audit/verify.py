"""Checking a dataset from its files alone: what it says of itself, then its rooms, each looked at and made again."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TypeVar

import numpy as np

from remqa_data.generators.audit.balance import AskedQuestion, asked_questions, balance_failures
from remqa_data.generators.audit.failures import Failure
from remqa_data.generators.audit.manifest_check import folder_failures, manifest_failures, other_versions
from remqa_data.generators.audit.room_check import Found, Piece, RoomCheck, check_room
from remqa_data.generators.audit.row_order import row_failures, short_walks
from remqa_data.generators.config import Config, stored_config
from remqa_data.generators.questions.shortfalls import asked_in_the_end
from remqa_data.generators.scene_plan import Job
from remqa_data.processes.executors import LocalExecutor
from remqa_data.storage.manifest import MANIFEST, Manifest, load_manifest
from remqa_data.storage.shards import check_files, open_shards
from remqa_data.tables.schema import TABLES

FILES_IN_FULL = ("checksums", "manifest", "card", "croissant.json", "folder", "balance")
ROWS_IN_FULL = ("names and order of all rows", "number of all rows but of expressions")


@dataclass(frozen=True)
class Verification:
    """What was checked, and what does not hold.

    Attributes
    ----------
    checked : tuple of str
        Ids of the questions that were replayed.
    failures : tuple of Failure
        Those of the dataset as a whole, then by room in the order of the dataset.
    coverage : mapping of str to (int, int)
        How many rooms were made again, how many rows of each table were worked out anew and compared, and how many
        questions were replayed; and how many there are.
    notes : tuple of str
        With which other versions the dataset was made, which may give other bytes.
    in_full : tuple of str
        What was looked at as a whole, whatever was drawn.
    """

    checked: tuple[str, ...]
    failures: tuple[Failure, ...]
    coverage: dict[str, tuple[int, int]]
    notes: tuple[str, ...]
    in_full: tuple[str, ...]

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
    *,
    rooms: int | None = None,
) -> Verification:
    """Check a finished dataset.

    Checksums, schemas, manifest, card, croissant.json, the folder and balance are always checked in full; where the manifest
    holds, so are names and order of all rows, and their number, which of expressions only making their room again tells.
    Only where manifest and rows are those of one dataset is it worth looking into rooms.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    sample : int, optional
        How many questions to replay, drawn at random; all by default.
    seed : int
        Of both draws.
    workers : int
        Number of processes. What is found does not depend on it.
    progress : callable, optional
        Called with the numbers of rooms looked at and to look at.
    rooms : int, optional
        How many rooms to make again and to compare row by row, drawn at random; all by default. Rooms with fewer frames
        than were asked for are always among them.

    Raises
    ------
    DatasetError
        If the folder is not a finished dataset, or a shard is damaged.
    """
    manifest = load_manifest(root)
    check_files(root)
    failures = list(manifest_failures(root, manifest))
    config = None if failures else stored_config(manifest.config)
    if config is not None:
        failures += row_failures(root, manifest, config)
    is_sound = all(failure.truth == "unbiased" for failure in failures)
    questions = asked_questions(root, manifest)
    failures += [*folder_failures(root, manifest), *balance_failures(questions, manifest)]
    notes = tuple(f"made with {name}" for name in other_versions(manifest))
    if config is None or not is_sound:
        in_full = FILES_IN_FULL if config is None else FILES_IN_FULL + ROWS_IN_FULL
        return Verification((), tuple(failures), _coverage(manifest, Counter(), 0), notes, in_full)
    rng = np.random.default_rng(seed)
    asked = _drawn(questions, sample, rng)
    again = set(_drawn(config.scene_names, rooms, rng))
    if rooms is not None:
        again |= short_walks(root, manifest, config)
    checks = _room_checks(root, manifest, config, asked, again)
    found = _checked(checks, workers, progress)
    compared: Counter[str] = Counter()
    for result in found:
        compared.update(result.rows)
        failures += result.failures
    if sample is None and rooms is None:
        failures += _unconfirmed(manifest, found, notes)
    coverage = _coverage(manifest, compared, len(again))
    checked = tuple(question.question_id for question in asked)
    return Verification(checked, tuple(failures), coverage, notes, FILES_IN_FULL + ROWS_IN_FULL)


T = TypeVar("T")


def _drawn(names: Sequence[T], count: int | None, rng: np.random.Generator) -> list[T]:
    """So many of some things, in their order; all by default."""
    if count is None or count >= len(names):
        return list(names)
    return [names[i] for i in sorted(rng.choice(len(names), count, replace=False))]


def _room_checks(
    root: Path, manifest: Manifest, config: Config, asked: Sequence[AskedQuestion], again: Collection[str]
) -> list[RoomCheck]:
    """What is to be checked, by room in the order of the dataset."""
    wanted: dict[str, set[str]] = defaultdict(set)
    for question in asked:
        wanted[question.scene].add(question.question_id)
    pieces = {table: _pieces(root, manifest, table) for table in TABLES}
    quotas = asked_in_the_end(config.scene_names, config.totals, manifest.asked_anew)
    checks = []
    for quota in quotas:
        scene = quota.scene
        if scene in wanted or scene in again:
            places = {table: tuple(of_table.get(scene, ())) for table, of_table in pieces.items()}
            job = Job(quota, config) if scene in again else None
            checks.append(RoomCheck(scene, frozenset(wanted[scene]), places, job))
    return checks


def _pieces(root: Path, manifest: Manifest, table: str) -> dict[str, list[Piece]]:
    """Where the rows of each room lie."""
    found: defaultdict[str, list[Piece]] = defaultdict(list)
    for shard in (shard for split in manifest.splits(table) for shard in open_shards(root, table, split)):
        scenes = iter(shard.read(columns=["scene"])["scene"].to_pylist())
        groups: defaultdict[str, list[int]] = defaultdict(list)
        for group in range(shard.row_groups):
            for scene in set(islice(scenes, shard.rows(group))):
                groups[scene].append(group)
        for scene, own in groups.items():
            found[scene].append((shard.path, tuple(own)))
    return found


def _checked(checks: Sequence[RoomCheck], workers: int, progress: Callable[[int, int], None] | None) -> list[Found]:
    """What came of the checks, in their order."""
    tell = progress or (lambda done, total: None)
    tell(0, len(checks))
    found: dict[str, Found] = {}
    for check, result in LocalExecutor(workers).run(check_room, checks):
        found[check.scene] = result
        tell(len(found), len(checks))
    return [found[check.scene] for check in checks]


def _unconfirmed(manifest: Manifest, found: Sequence[Found], notes: Sequence[str]) -> Iterator[Failure]:
    """What the manifest says and only making all rooms again, with the same versions, confirms."""
    if notes:
        yield Failure(MANIFEST, "reproducible", f"{', '.join(notes)}: install these versions to have all confirmed")
    refused: Counter[str] = Counter()
    for result in found:
        refused.update(result.refused)
    if dict(sorted(refused.items())) != manifest.refused:
        yield Failure(MANIFEST, "reproducible", f"refused is {manifest.refused}; all rooms together: {dict(refused)}")


def _coverage(manifest: Manifest, compared: Mapping[str, int], rooms: int) -> dict[str, tuple[int, int]]:
    """What was looked into, and how much there is of it."""
    each = manifest.config.get("configurations")
    count = manifest.rows("scenes") // each if isinstance(each, int) and each > 0 else rooms
    covered = {"rooms": (rooms, count)}
    return covered | {table: (compared.get(table, 0), manifest.rows(table)) for table in TABLES}
