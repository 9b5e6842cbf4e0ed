"""Any row of a split, at any time, from memory-mapped shards: what the PyTorch datasets read with.

Columns without images are small and are read once, when they are first asked for. Images lie in a shard as they are (see
`remqa_data.storage.shards`). The first time that a process wants one, its row group is read and its checksums are checked;
where the images were found is remembered, and from then on they are taken from there, without a copy. Nothing here needs
torch.
"""

from __future__ import annotations

import hashlib
import mmap
import os
from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from remqa_data.errors import DatasetError, UnknownNameError
from remqa_data.storage.shards import Shard, leaf_paths, open_shards
from remqa_data.tables.parquet_pages import footer_start
from remqa_data.tables.schema import table_spec

Spans = npt.NDArray[np.int64]
"""(rows, 2) where in its file the image of each row begins and ends; 0 where that is not known yet."""


class SplitReader:
    """One split of a table of a finished dataset.

    It can be pickled, and used after a fork: each process opens the shards for itself, whatever its working directory is, and
    refuses those that have been replaced since.

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
        self._begin(list(open_shards(root, table, split)))
        self.paths = [shard.path.absolute() for shard in self._shards]
        self._footers = [_footer_digest(path) for path in self.paths]
        groups = [
            (number, group, shard.rows(group))
            for number, shard in enumerate(self._shards)
            for group in range(shard.row_groups)
        ]
        self._places = [(number, group) for number, group, _ in groups]
        self._starts = list(accumulate((rows for _, _, rows in groups), initial=0))

    def __len__(self) -> int:
        return self._starts[-1]

    def columns(self, names: Sequence[str]) -> pa.Table:
        """All rows of some columns, a chunk for each shard: one array holds 2 GB of text at most.

        Raises
        ------
        UnknownNameError
            If the table has no such column.
        """
        known = table_spec(self.table).schema.names
        for name in names:
            if name not in known:
                raise UnknownNameError(f"column of {self.table}", name, known)
        return pa.concat_tables([shard.read(columns=names).combine_chunks() for shard in self._open()])

    def rows(self, rows: Sequence[int], names: Sequence[str]) -> list[dict[str, Any]]:
        """Some columns of some rows as plain Python; each row group is read once.

        Names may lead into structs: "semantic_map.labels".
        """
        self._open()
        found: dict[int, dict[str, Any]] = {}
        for place in sorted({self._place(row) for row in rows}):
            number, group = self._places[place]
            first, last = self._starts[place], self._starts[place + 1]
            table = self._shards[number].read(group, list(names))
            found |= {row: table.slice(row - first, 1).to_pylist()[0] for row in rows if first <= row < last}
        return [found[row] for row in rows]

    def images(self, row: int, names: Sequence[str]) -> list[memoryview]:
        """Encoded images of one row, in the order of the names.

        Raises
        ------
        DamagedShardError
            Naming the file, row group and column.
        ForgedRowError
            If there is no image.
        """
        self._open()
        place = self._place(row)
        number, group = self._places[place]
        data = self._bytes[number]
        spans = [self._spans[name][row].tolist() if name in self._spans else (0, 0) for name in names]
        if all(end for _, end in spans):
            return [data[start:end] for start, end in spans]
        table = self._shards[number].read(group, [f"{name}.bytes" for name in names])
        first = self._starts[place]
        columns = [table[name].combine_chunks().field("bytes") for name in names]
        for name, column in zip(names, columns, strict=True):
            self._locate(name, first, column, number, group)
        return [memoryview(column[row - first].as_buffer()) for column in columns]

    def where(self, row: int) -> tuple[Path, int]:
        """The file that a row is in, and which of its rows it is."""
        place = self._place(row)
        number = self._places[place][0]
        first = next(i for i, (of_place, _) in enumerate(self._places) if of_place == number)
        return self.paths[number], row - self._starts[first]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_process": -1, "_shards": [], "_bytes": [], "_spans": {}}

    def _place(self, row: int) -> int:
        """In which of all row groups a row is."""
        return bisect_right(self._starts, row) - 1

    def _locate(self, name: str, first: int, images: pa.BinaryArray, number: int, group: int) -> None:
        """Remember where the images of a row group lie; a file that some other writer has compressed has them nowhere."""
        spans = self._spans.setdefault(name, np.zeros((len(self), 2), dtype=np.int64))
        start, end = _extent(self._shards[number], group, f"{name}.bytes")
        mapped = self._bytes[number].obj
        assert isinstance(mapped, mmap.mmap)
        for row, image in enumerate(images.to_pylist(), start=first):
            # Parquet writes the length in 4 bytes before the bytes; most images begin alike.
            found = mapped.find(len(image).to_bytes(4, "little") + image[:8], start, end) + 4
            if mapped[found : found + len(image)] != image:
                return
            start = found + len(image)
            spans[row] = found, start

    def _open(self) -> list[Shard]:
        """The shards, opened by this process."""
        if self._process != os.getpid():
            shards = [Shard(path, self.table) for path in self.paths]
            for path, footer in zip(self.paths, self._footers, strict=True):
                if _footer_digest(path) != footer:  # rows that were read before are those of the other file
                    raise DatasetError(f"{path}: it was replaced after the dataset was opened; open the dataset again")
            self._begin(shards)
        return self._shards

    def _begin(self, shards: list[Shard]) -> None:
        """Read from shards that this process has opened."""
        self._shards = shards
        self._bytes = [memoryview(_mapped(shard.path)) for shard in shards]
        self._spans: dict[str, Spans] = {}
        self._process = os.getpid()


def _mapped(path: Path) -> mmap.mmap:
    with path.open("rb") as file:
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def _footer_digest(path: Path) -> bytes:
    """Of where a file says that its columns lie, and of what is in them: another file says something else."""
    with _mapped(path) as data:
        return hashlib.sha256(data[footer_start(data) :]).digest()


def _extent(shard: Shard, group: int, path: str) -> tuple[int, int]:
    """Where in its file a column of a row group, which has been read, begins and ends."""
    column = shard.file.metadata.row_group(group).column(leaf_paths(shard.file).index(path))
    return column.data_page_offset, column.data_page_offset + column.total_compressed_size
