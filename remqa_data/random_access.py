"""Any row of a split, at any time, from memory-mapped shards: what the PyTorch datasets read with.

Columns without images are small and are read once, when they are first asked for. Images are read by row group, and the
last row group stays in memory, so reading in order costs each row group once. Nothing here needs torch.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from remqa_data.errors import UnknownNameError
from remqa_data.schema import table_spec
from remqa_data.shards import Shard, shard_paths


class SplitReader:
    """One split of a table of a finished dataset.

    It can be pickled, and used after a fork: each process opens the shards for itself.

    Parameters
    ----------
    root : path
        Folder of the dataset.
    table, split : str
        What to read.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or the table has no such split.
    DamagedShardError
        If a shard is missing or cut off; damage further in is found when it is read.
    """

    def __init__(self, root: Path, table: str, split: str) -> None:
        self.table = table
        self.paths = shard_paths(root, table, split)
        self._process = -1
        self._shards: list[Shard] = []
        self._cached: tuple[int, tuple[str, ...]] | None = None
        self._images: list[pa.Array] = []
        groups = [
            (number, group, shard.rows(group))
            for number, shard in enumerate(self._open())
            for group in range(shard.row_groups)
        ]
        self._places = [(number, group) for number, group, _ in groups]
        self._starts = np.cumsum([0, *(rows for _, _, rows in groups)])

    def __len__(self) -> int:
        return int(self._starts[-1])

    def columns(self, names: Sequence[str]) -> pa.Table:
        """All rows of some columns, each as one chunk.

        Raises
        ------
        UnknownNameError
            If the table has no such column.
        """
        known = table_spec(self.table).schema.names
        for name in names:
            if name not in known:
                raise UnknownNameError(f"column of {self.table}", name, known)
        return pa.concat_tables([shard.read(columns=names) for shard in self._open()]).combine_chunks()

    def images(self, row: int, names: Sequence[str]) -> list[pa.Buffer]:
        """Encoded images of one row, in the order of the names."""
        shards = self._open()
        place = int(np.searchsorted(self._starts, row, side="right")) - 1
        if self._cached != (place, tuple(names)):
            number, group = self._places[place]
            data = shards[number].read(group, [f"{name}.bytes" for name in names])
            self._images = [data[name].chunk(0).field("bytes") for name in names]
            self._cached = place, tuple(names)
        within = row - int(self._starts[place])
        return [column[within].as_buffer() for column in self._images]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_process": -1, "_shards": [], "_cached": None, "_images": []}

    def _open(self) -> list[Shard]:
        """The shards, opened by this process."""
        if self._process != os.getpid():
            self._shards = [Shard(path) for path in self.paths]
            self._cached = None
            self._process = os.getpid()
        return self._shards
