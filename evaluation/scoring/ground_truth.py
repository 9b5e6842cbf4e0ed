"""What a split of a dataset asks, and the true answers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.errors import DatasetError
from remqa_data.evaluation.submission.reader import Submission
from remqa_data.evaluation.submission.tracks import TRACKS, Track
from remqa_data.geometry.types import F64
from remqa_data.storage.manifest import Manifest, load_manifest
from remqa_data.storage.shards import read_table

QUESTION_COLUMNS = (
    "question_id",
    "kind",
    "answer",
    "scene",
    "room_type",
    "configuration",
    "initial_pose",
    "goal_poses",
    "target_id",
    "target_type",
    "manipulation",
    "manipulation_object_id",
    "path_length_m",
)
EXPRESSION_COLUMNS = ("expression_id", "kind", "scene", "configuration", "target_type", "box_2d")

PATH_BINS_M = (0.0, 1.0, 2.0, 3.0, 5.0, float("inf"))
"""Edges of the path-length bins; each holds its lower edge."""


@dataclass(frozen=True, eq=False)
class GroundTruth:
    """A split of a dataset as the evaluator needs it.

    Attributes
    ----------
    root : Path
        Folder of the dataset.
    track, split : str
    manifest : Manifest
    table : pyarrow.Table
        One row for each question, or for each expression in the track `rec`, without images.
    """

    root: Path
    track: Track
    split: str
    manifest: Manifest
    table: pa.Table

    @cached_property
    def ids(self) -> pa.Array:
        """(n,) ids of the rows."""
        return self.table[TRACKS[self.track].id_column].combine_chunks()

    def places(self, ids: pa.Array) -> npt.NDArray[np.int64]:
        """(m,) where each id is among those of the rows, -1 where it is not."""
        encoded = ids.dictionary_encode()
        # Looking for all rows among a few ids needs far less memory than a table of all rows in which to look for the ids.
        found = pc.index_in(self.ids, value_set=encoded.dictionary)
        rows = np.flatnonzero(found.is_valid().to_numpy(zero_copy_only=False))
        row_of = np.full(len(encoded.dictionary), -1, dtype=np.int64)
        row_of[found.drop_null().to_numpy()] = rows
        return np.asarray(row_of[encoded.indices.to_numpy()])

    def only(self, ids: Collection[str]) -> GroundTruth:
        """The same of some of the rows, in the same order."""
        kept = pc.is_in(self.ids, value_set=pa.array(ids, self.ids.type))
        return replace(self, table=self.table.filter(kept).combine_chunks())

    def texts(self, name: str) -> list[str]:
        """A column of texts."""
        return [str(value) for value in self.table[name].to_pylist()]

    @cached_property
    def path_lengths_m(self) -> F64:
        """(n,) length of the shortest path to the first goal pose."""
        return np.asarray(self.table["path_length_m"].to_numpy(), dtype=np.float64)

    @cached_property
    def initial_poses(self) -> F64:
        """(n, 4) initial poses: x, y, yaw_deg, horizon_deg."""
        structs = self.table["initial_pose"].combine_chunks()
        angles = [structs.field(name).to_numpy(zero_copy_only=False)[:, None] for name in ("yaw_deg", "horizon_deg")]
        return np.hstack([_positions(structs), *angles])

    @cached_property
    def goals(self) -> F64:
        """(n, k, 2) positions of the goal poses; NaN where a question has fewer than k."""
        lists = self.table["goal_poses"].combine_chunks()
        counts = np.asarray(lists.value_lengths().to_numpy(zero_copy_only=False), dtype=np.int64)
        padded = np.full((len(counts), max(counts.max(initial=0), 1), 2), np.nan)
        rows = np.repeat(np.arange(len(counts)), counts)
        firsts = np.cumsum(counts) - counts
        padded[rows, np.arange(len(rows)) - firsts[rows]] = _positions(lists.flatten())
        return padded

    @cached_property
    def boxes(self) -> F64:
        """(n, 4) true boxes in the stored frames, of the track `rec`."""
        return np.asarray(self.table["box_2d"].combine_chunks().flatten().to_numpy(), dtype=np.float64).reshape(-1, 4)

    @cached_property
    def groups(self) -> dict[str, list[str]]:
        """By name of a breakdown, the group of each row."""
        found = {"kind": self.texts("kind"), "room_type": self.texts("room_type")}
        if self.track == "rec":
            return found | {"target_type": self.texts("target_type")}
        bins = np.digitize(self.path_lengths_m, PATH_BINS_M) - 1
        labels = [_bin_name(low, high) for low, high in pairwise(PATH_BINS_M)]
        return found | {
            "manipulation": self.texts("manipulation"),
            "path_length": [labels[place] for place in bins],
            "answer": self.texts("answer"),
        }


def load_ground_truth(root: Path, track: Track, split: str) -> GroundTruth:
    """Read a split.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or has no such split.
    DamagedShardError
        If a shard is not as it was written.
    """
    manifest = load_manifest(root)
    columns = EXPRESSION_COLUMNS if track == "rec" else QUESTION_COLUMNS
    table = read_table(root, TRACKS[track].table, split, columns).combine_chunks()
    if track == "rec":
        table = table.append_column("room_type", pa.array(_room_types(root, manifest, table["scene"].to_pylist())))
    return GroundTruth(root, track, split, manifest, table)


def truth_of(submission: Submission, root: Path) -> GroundTruth:
    """Read the split that a submission is about; errors as in `load_ground_truth`, too.

    Raises
    ------
    SubmissionError
        If it is about another dataset, or a split that the dataset has not.
    """
    header, manifest = submission.header, load_manifest(root)
    splits = manifest.splits(TRACKS[header.track].table)
    submission.check(dataset=dataset_sha256(manifest), splits=splits)
    return load_ground_truth(root, header.track, header.split)


def dataset_sha256(manifest: Manifest) -> str:
    """One checksum for all data of a dataset, whatever versions it was made with: of its files' checksums.

    It is the sha256 of the JSON list of [path, sha256] of the manifest's files, in the manifest's order.
    """
    files = [[file.path, file.sha256] for file in manifest.files]
    return hashlib.sha256(json.dumps(files, separators=(",", ":")).encode()).hexdigest()


def _room_types(root: Path, manifest: Manifest, scenes: list[str]) -> list[str]:
    room_type: dict[str, str] = {}
    for split in manifest.splits("scenes"):
        rows = read_table(root, "scenes", split, ["scene", "room_type"])
        room_type |= dict(zip(rows["scene"].to_pylist(), rows["room_type"].to_pylist(), strict=True))
    unknown = set(scenes) - set(room_type)
    if unknown:
        raise DatasetError(f"{root}: expressions of {min(unknown)}, which the table scenes does not have")
    return [room_type[scene] for scene in scenes]


def _positions(structs: pa.StructArray) -> F64:
    """(n, 2) x and y of agent states."""
    return np.asarray(structs.field("position").flatten().to_numpy(), dtype=np.float64).reshape(-1, 3)[:, :2]


def _bin_name(low: float, high: float) -> str:
    return f"{low:g} m and more" if high == float("inf") else f"{low:g} to {high:g} m"
