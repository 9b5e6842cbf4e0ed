"""Which types of objects lie near each other, as the walks through train rooms have it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.agents.training.rooms import learning_rooms
from remqa_data.geometry.types import F32
from remqa_data.storage.shards import read_table


def near_counts(roots: Sequence[Path], types: Sequence[str]) -> F32:
    """(types, types) how often an object of a type, first, has been seen in relation to one of another, second.

    Of the first dataset; in rooms that all of them allow to learn from.

    Raises
    ------
    DatasetError
        If this is not a finished dataset.
    """
    numbers = {name: number for number, name in enumerate(types)}
    rooms = pa.array(sorted(learning_rooms(roots)))
    frames = read_table(roots[0], "frames", "train", ["scene", "added_edges"])
    edges = pc.list_flatten(frames.filter(pc.is_in(frames["scene"], rooms))["added_edges"])
    counts = np.zeros((len(types), len(types)), dtype=np.float32)
    sources, targets = (pc.struct_field(edges, name).to_pylist() for name in ("source", "target"))
    for ends in zip(sources, targets, strict=True):
        first, second = (numbers.get(name.partition("|")[0]) for name in ends)
        if first is not None and second is not None:
            counts[first, second] += 1
    return counts
