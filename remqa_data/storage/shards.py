"""Shards: the Parquet files of a dataset, written atomically, read, and checked.

A row group is what a reader must read to get at one row, so tables with images have small ones, and encoded images,
which no compression shrinks further, lie in them as they are; everything else is compressed with zstd. Each page
carries a checksum, so damage is found when it is read, and can be told by row group and column.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from remqa_data.errors import DamagedShardError, DatasetError, ForgedRowError, SchemaError, one_line
from remqa_data.files import atomic_path, local_path, sha256_of, uri_of
from remqa_data.storage.manifest import FileInfo, Manifest, load_manifest
from remqa_data.storage.protocol import Storage
from remqa_data.storage.shard_cache import forget_if_damaged, local_shard, stored_shard
from remqa_data.tables.row_checks import find_problem
from remqa_data.tables.rows import ExpressionRow, FrameRow, QuestionRow, Row, SceneRow
from remqa_data.tables.schema import IMAGE_TYPE, check_schema, table_of, table_spec, to_rows, to_table

R = TypeVar("R", SceneRow, FrameRow, ExpressionRow, QuestionRow)

ZSTD_LEVEL = 3
DATA_PAGE_BYTES = 1 << 20


class ShardWriter:
    """Writes one Parquet file; it appears under its name when the `with` block ends without an error.

    The bytes depend on the rows alone: not on how they were divided among calls, nor on time or place.

    Parameters
    ----------
    path : path
        The file.
    table : str
        Name of its table.
    """

    def __init__(self, path: Path, table: str) -> None:
        self.path = path
        self._spec = table_spec(table)
        self._schema = self._spec.schema
        self._waiting: list[pa.Table] = []
        self._stack = ExitStack()
        self._writer: pq.ParquetWriter | None = None

    def __enter__(self) -> ShardWriter:
        temporary = self._stack.enter_context(atomic_path(self.path))
        writer = pq.ParquetWriter(local_path(temporary), self._schema, **writing_options(self._schema))
        self._writer = self._stack.enter_context(writer)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None:
            self._stack.__exit__(kind, error, trace)  # atomic_path throws the file away
            return
        with self._stack:
            self._write_groups(least=1)

    def write_rows(self, rows: Sequence[Row]) -> None:
        """Append typed rows.

        Raises
        ------
        SchemaError
            Naming the row and the field that do not fit.
        """
        self.write_table(to_table(self._spec.row_type, rows))  # type: ignore[type-var]

    def write_table(self, data: pa.Table) -> None:
        """Append the rows of an Arrow table that has the table's columns."""
        check_schema(self._spec.name, data.schema)
        self._waiting.append(data.replace_schema_metadata(self._schema.metadata).cast(self._schema))
        self._write_groups(least=self._spec.row_group_rows)

    def _write_groups(self, least: int) -> None:
        """Write full row groups, and the rest too if it has at least this many rows."""
        assert self._writer is not None, "use ShardWriter in a with block"
        size = self._spec.row_group_rows
        if sum(piece.num_rows for piece in self._waiting) < least:
            return
        rows = pa.concat_tables(self._waiting)
        while rows.num_rows >= least:
            self._writer.write_table(rows.slice(0, size).combine_chunks(), row_group_size=size)
            rows = rows.slice(size)
        self._waiting = [rows] if rows.num_rows else []


def file_info(written: Path, path: str, table: str, split: str) -> FileInfo:
    """What the manifest says about a shard that has been written and will be known under a path in the dataset."""
    rows = pq.read_metadata(local_path(written)).num_rows
    return FileInfo(path, table, split, rows, written.stat().st_size, sha256_of(written))


def read_table(root: str | os.PathLike[str], table: str, split: str, columns: Sequence[str] | None = None) -> pa.Table:
    """A split of a table of a finished dataset, or some of its columns.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or the table has no such split.
    DamagedShardError
        Naming the file, row group and column.
    """
    return pa.concat_tables([shard.read(columns=columns) for shard in open_shards(root, table, split)])


def read_rows(root: str | os.PathLike[str], row_type: type[R], split: str, **wanted: str | int) -> Iterator[R]:
    """Typed rows of a split, one row group in memory at a time; errors as in `read_table`.

    With values of columns, such as ``scene="FloorPlan1"``, only the rows that have them: the images of other row groups
    are not read.
    """
    name = table_of(row_type).name
    for shard in open_shards(root, name, split):
        for group in range(shard.row_groups):
            is_wanted = np.ones(shard.rows(group), dtype=np.bool_)
            if wanted:
                keys = shard.read(group, list(wanted))
                for column, value in wanted.items():
                    is_wanted &= keys[column].to_numpy() == value
            if is_wanted.any():
                rows = shard.read(group)
                yield from to_rows(row_type, rows if is_wanted.all() else rows.filter(is_wanted))


def open_shards(root: str | os.PathLike[str], table: str, split: str) -> Iterator[Shard]:
    """Shards of a split of a table of a finished dataset, in order, as long as the manifest says; errors as in `read_table`.

    Those of a dataset in a bucket are fetched first, see `shard_cache`.
    """
    manifest = load_manifest(root)
    known = manifest.splits(table_spec(table).name)
    if split not in known:
        raise DatasetError(
            f"{uri_of(root)}: table {table} has no split {split!r}; it has: {', '.join(known) or 'none'}"
        )
    for file in manifest.files_of(table, split):
        shard = Shard(local_shard(root, file), table)
        if (rows := shard.file.metadata.num_rows) != file.rows:
            raise _damaged(shard.path, f"it has {rows:,} rows; the manifest says {file.rows:,}")
        yield shard


class Shard:
    """An open shard, mapped into memory.

    Parameters
    ----------
    path : path
        The file.
    table : str
        Name of its table.

    Raises
    ------
    DamagedShardError
        If it is missing, cut off, no Parquet file, or has other columns than its table.
    """

    def __init__(self, path: Path, table: str) -> None:
        self.path = path
        self.file = _opened(path)
        self._record = table_spec(table).record
        try:
            check_schema(table, self.file.schema_arrow)
        except SchemaError as error:
            raise _damaged(path, str(error)) from None

    @property
    def row_groups(self) -> int:
        """Number of row groups."""
        return int(self.file.num_row_groups)

    def rows(self, group: int) -> int:
        """Number of rows of a row group."""
        return int(self.file.metadata.row_group(group).num_rows)

    def read(self, group: int | Sequence[int] | None = None, columns: Sequence[str] | None = None) -> pa.Table:
        """The rows of one row group, of several that follow each other, or of all; all columns or some.

        Raises
        ------
        DamagedShardError
            Naming the file, row group and column.
        ForgedRowError
            If a value is not what `row_checks` lets through; names the file, row and field.
        """
        groups = [group] if isinstance(group, int) else list(range(self.row_groups) if group is None else group)
        try:
            data = self.file.read_row_groups(groups, columns=columns, use_threads=False)
        except (OSError, pa.ArrowException) as error:
            damage = _damaged_column(self.path, self.file, groups)
            raise damage or _damaged(self.path, one_line(error)) from None
        problem = find_problem(self._record, data)
        if problem is not None:
            first = sum(self.rows(earlier) for earlier in range(groups[0]))
            raise ForgedRowError(self.path, first + problem.row, problem.field, problem.reason)
        return data


def check_files(root: str | os.PathLike[str]) -> None:
    """Check that every file of a finished dataset is as it was written, and has the columns of its table.

    Raises
    ------
    DamagedShardError
        For the first file that is not, naming the row group and column where that can be told.
    """
    for file in load_manifest(root).files:
        damage = find_damage(root, file)
        if damage is not None:
            raise damage


def check_sizes(storage: Storage, manifest: Manifest) -> None:
    """Check that every file of a dataset is there and as long as it was, without reading it.

    Raises
    ------
    DamagedShardError
        For the first file that is not.
    """
    found = {file.path: file.bytes for file in storage.files()}
    for file in manifest.files:
        if found.get(file.path) != file.bytes:
            raise DamagedShardError(storage.where(file.path), "it is missing or not as long as the manifest says")


def find_damage(root: str | os.PathLike[str], file: FileInfo) -> DamagedShardError | None:
    """What is wrong with one file of a dataset, or None; of a bucket, with what lies in it now."""
    try:
        path = stored_shard(root, file)
        parquet = _opened(path)
        check_schema(file.table, parquet.schema_arrow)
    except DamagedShardError as error:
        return error
    except SchemaError as error:
        return DamagedShardError(path, str(error))
    if sha256_of(path) == file.sha256:
        return None
    other = DamagedShardError(path, "every column can be read, but the sha256 is not that of the manifest")
    return _damaged_column(path, parquet, range(parquet.num_row_groups)) or other


def leaf_paths(parquet: pq.ParquetFile) -> list[str]:
    """What a file's columns are called as they are stored, in order.

    The schema says so. What a row group says of a column is asked for only where that column could be read: pyarrow ends
    the process over one that cannot be.
    """
    return [parquet.schema.column(i).path for i in range(len(parquet.schema))]


def _opened(path: Path) -> pq.ParquetFile:
    try:
        file = pq.ParquetFile(local_path(path), memory_map=True, pre_buffer=False, page_checksum_verification=True)
        _ = leaf_paths(file), file.schema_arrow.names, file.metadata.created_by  # texts that may be no UTF-8
        return file
    except FileNotFoundError:
        raise DamagedShardError(path, "the file is missing") from None
    except (OSError, pa.ArrowException, UnicodeDecodeError) as error:
        raise _damaged(path, f"the footer cannot be read: {one_line(error)}") from None


def _damaged(path: Path, reason: str, group: int | None = None, column: str | None = None) -> DamagedShardError:
    if forget_if_damaged(path):
        reason += " (a copy from a bucket, now removed: start again, which fetches it)"
    return DamagedShardError(path, reason, group, column)


def _damaged_column(path: Path, parquet: pq.ParquetFile, groups: Sequence[int]) -> DamagedShardError | None:
    for group in groups:
        for column in leaf_paths(parquet):
            try:
                parquet.read_row_group(group, columns=[column], use_threads=False)
            except (OSError, pa.ArrowException) as error:
                return _damaged(path, one_line(error), group, column.replace(".list.element", "[]"))
    return None


def writing_options(schema: pa.Schema) -> dict[str, Any]:
    """What the bytes of a shard depend on besides its rows: every choice is made here, none is left to a default."""
    leaves = [leaf for field in schema for leaf in _leaves(field.type, field.name)]
    images = {f"{field.name}.bytes" for field in schema if field.type == IMAGE_TYPE}
    plain = [leaf for leaf in leaves if leaf not in images]
    return {
        "compression": {leaf: "NONE" if leaf in images else "ZSTD" for leaf in leaves},
        "compression_level": dict.fromkeys(plain, ZSTD_LEVEL),
        "use_dictionary": plain,
        "write_statistics": plain,
        "write_page_checksum": True,
        "version": "2.6",
        "data_page_version": "1.0",
        "data_page_size": DATA_PAGE_BYTES,
    }


def _leaves(kind: pa.DataType, path: str) -> list[str]:
    """Parquet's paths of the columns that a field is stored as."""
    if pa.types.is_struct(kind):
        return [leaf for child in kind for leaf in _leaves(child.type, f"{path}.{child.name}")]
    if pa.types.is_list(kind):
        return _leaves(kind.value_type, f"{path}.list.element")
    return [path]
