"""What the footer of a shard says of its columns: programs that filter rows believe it, and skip what it rules out."""

from __future__ import annotations

import mmap
from collections.abc import Iterator

import pyarrow as pa
import pyarrow.parquet as pq

from remqa_data.storage.shards import Shard, leaf_paths, writing_options
from remqa_data.tables.parquet_pages import footer_start
from remqa_data.tables.schema import TableSpec

_MAGIC = b"PAR1"
_AT_ONCE = 16
"""Row groups that are read and written together."""


def footer_problems(shard: Shard, spec: TableSpec) -> Iterator[str]:
    """Statistics that are not those of the rows, and bytes that belong to no column.

    The shard must have row groups of as many rows as its table's have. What compression makes of the pages is not compared:
    it may differ between builds of one version of pyarrow.

    Raises
    ------
    DamagedShardError
        If a row group cannot be read.
    """
    yield from _wrong_statistics(shard, spec)
    yield from _stray_bytes(shard)


def _wrong_statistics(shard: Shard, spec: TableSpec) -> Iterator[str]:
    paths = leaf_paths(shard.file)
    for first in range(0, shard.row_groups, _AT_ONCE):
        groups = range(first, min(first + _AT_ONCE, shard.row_groups))
        true = _written_again(shard.read(groups), spec)
        for group in groups:
            told = shard.file.metadata.row_group(group)
            for number, path in enumerate(paths):
                if _statistics(told.column(number)) != _statistics(true.row_group(group - first).column(number)):
                    yield f"row group {group}: what the footer says of {path} is not so"


def _stray_bytes(shard: Shard) -> Iterator[str]:
    """Where columns, which could be read, do not follow each other from the beginning of the file to its footer."""
    end, paths = len(_MAGIC), leaf_paths(shard.file)
    for group in range(shard.row_groups):
        told = shard.file.metadata.row_group(group)
        for number, path in enumerate(paths):
            column = told.column(number)
            start = column.dictionary_page_offset if column.has_dictionary_page else column.data_page_offset
            if start != end:
                yield f"row group {group}: {path} begins at byte {start:,}, and what comes before it ends at {end:,}"
            end = start + column.total_compressed_size
    with shard.path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        footer = footer_start(data)
    if footer != end:
        yield f"the last column ends at byte {end:,}, and the footer begins at {footer:,}"


def _written_again(rows: pa.Table, spec: TableSpec) -> pq.FileMetaData:
    """What a footer should say of some rows."""
    quick = {
        **writing_options(spec.schema),
        "compression": "NONE",
        "compression_level": None,
        "write_page_checksum": False,
    }
    buffer = pa.BufferOutputStream()
    pq.write_table(rows.cast(spec.schema), buffer, row_group_size=spec.row_group_rows, **quick)
    return pq.read_metadata(pa.BufferReader(buffer.getvalue()))


def _statistics(column: pq.ColumnChunkMetaData) -> tuple[object, ...] | None:
    """What a footer says of a column's values, as it is stored; pyarrow ends the process where it compares some with none."""
    said = column.statistics
    if said is None:
        return None
    ends = (said.min_raw, said.max_raw) if said.has_min_max else None
    return said.physical_type, said.num_values, said.null_count, ends
