"""Which rooms may be learnt from: those of the train split that are in no val or test split of any of the datasets.

Which split a room is of follows from its name, so that what has learnt from one dataset may be tried on any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow.compute as pc

from remqa_data.errors import DatasetError
from remqa_data.floorplans.splits import expression_split
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table

HELD_OUT = ("val", "test")


def rooms_of(root: Path, split: str) -> frozenset[str]:
    """Names of the rooms of a split; none if the dataset has no such split.

    Rooms of the split "val" are a part of the train questions, and have expressions of their own.
    """
    if split not in load_manifest(root).splits("expressions"):
        return frozenset()
    return frozenset(pc.unique(read_table(root, "expressions", split, ["scene"])["scene"]).to_pylist())


def learning_rooms(roots: Sequence[Path]) -> frozenset[str]:
    """Rooms to learn from in any of some datasets.

    Raises
    ------
    DatasetError
        If none is left, or one of these is no finished dataset.
    """
    rooms = _train_rooms(frozenset().union(*(rooms_of(root, "train") for root in roots)) - _held_out(roots))
    if not rooms:
        raise DatasetError(f"{', '.join(map(str, roots))}: no room to learn from that is not in val or test")
    return rooms


def held_out_elsewhere(root: Path) -> tuple[str, ...]:
    """Val and test rooms of a dataset that are train rooms by their names, from which others may have learnt; sorted."""
    return tuple(sorted(_train_rooms(_held_out([root]))))


def _held_out(roots: Sequence[Path]) -> frozenset[str]:
    return frozenset().union(*(rooms_of(root, split) for root in roots for split in HELD_OUT))


def _train_rooms(rooms: frozenset[str]) -> frozenset[str]:
    """Those that are for training by their names."""
    return frozenset(room for room in rooms if expression_split(room) == "train")
