"""Reading Parquet submissions in bounded memory, however large the table that a small file would unpack to."""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from remqa_data.errors import SubmissionError, one_line
from remqa_data.evaluation.submission.tracks import COLUMNS, FORMAT, arrow_schema
from remqa_data.files import local_path
from remqa_data.limits import MAX_ACTIONS, MAX_TEXT
from remqa_data.tables.parquet_pages import Chunk, PageError, row_groups, unpacked

METADATA_KEY = FORMAT.encode()
PARQUET_BATCH_ROWS = 32_768
MAX_ROW_VALUES = 4 * (MAX_ACTIONS + 1)
"""Numbers or words in one value of a column: four for each pose."""
BUFFER_BYTES = 1 << 20
"""Of a Parquet column in memory at a time."""
MAX_ROW_BYTES, SPARE_BYTES = 20_000, 1 << 24
"""How much a Parquet file may unpack to: so much for each row, and some to spare."""
MAX_UTF8_BYTES = 4
"""Of one character."""


def parquet_header(path: Path) -> bytes:
    """The header of a submission, from the file's metadata.

    Raises
    ------
    SubmissionError
        If there is none.
    """
    file = _opened(path)
    metadata = {**(file.schema_arrow.metadata or {}), **(file.metadata.metadata or {})}
    if METADATA_KEY not in metadata:
        raise SubmissionError(path, "", f"the file's metadata has no entry {FORMAT}, the header of a submission")
    return bytes(metadata[METADATA_KEY])


def parquet_batches(path: Path, names: tuple[str, ...], max_rows: int) -> Iterator[pa.RecordBatch]:
    """The rows of a file that has certain columns, some at a time, with the types of `tracks.COLUMNS`.

    Raises
    ------
    SubmissionError
        If it has other columns, too many rows, or cannot be read.
    """
    schema = arrow_schema(names)
    file = _opened(path)
    if file.metadata.num_rows > max_rows:
        raise SubmissionError(path, f"row {max_rows + 1}", too_many_rows(max_rows))
    found = file.schema_arrow
    for name in (*names, *found.names):
        if (
            name not in names
            or found.names.count(name) != 1
            or not _fits(found.field(name).type, schema.field(name).type)
        ):
            is_ = f"is {found.field(name).type}" if found.names.count(name) == 1 else "is missing or there twice"
            wanted = f"expected {schema.field(name).type}" if name in names else f"the columns are {', '.join(names)}"
            raise SubmissionError(path, f"field {name[:80]}", f"the column {is_}; {wanted}")
    with path.open("rb") as handle, mmap.mmap(handle.fileno(), 0, access=mmap.ACCESS_READ) as data:
        _check_sizes(path, file.metadata, data)
    leaves = [file.metadata.schema.column(i) for i in range(file.metadata.num_columns)]
    texts = [leaf.path for leaf in leaves if leaf.physical_type == "BYTE_ARRAY"]
    try:
        for batch in _read(path, texts, dictionaries=texts):
            _check_words(path, batch)
        pa.default_memory_pool().release_unused()  # what held the words of a million rows at once
        lists = [text for text in texts if "." in text]  # of a few words each, repeated in every row
        for batch in _read(path, names, dictionaries=lists):
            yield batch.select(list(names)).cast(schema)
    except (OSError, pa.ArrowException, ValueError) as error:
        raise SubmissionError(path, "", f"the data cannot be read: {one_line(error)[:200]}") from None


def _read(path: Path, columns: Sequence[str], dictionaries: Sequence[str]) -> Iterator[pa.RecordBatch]:
    yield from _opened(path, dictionaries).iter_batches(PARQUET_BATCH_ROWS, columns=list(columns), use_threads=False)


def _opened(path: Path, dictionaries: Sequence[str] = ()) -> pq.ParquetFile:
    """The file; `dictionaries` names the leaves whose values are kept once, however many rows repeat them."""
    try:
        file = pq.ParquetFile(
            local_path(path), read_dictionary=list(dictionaries), pre_buffer=False, buffer_size=BUFFER_BYTES
        )
        _ = file.schema_arrow.names  # texts that may be no UTF-8
        return file
    except (OSError, pa.ArrowException, UnicodeDecodeError) as error:
        reason = f"no Parquet file, or a damaged one: {one_line(error)[:200]}"
        raise SubmissionError(path, "", reason) from None


def _check_sizes(path: Path, metadata: pq.FileMetaData, data: mmap.mmap) -> None:
    """Refuse a small file that would unpack to a very large table, by what its pages say: its footer may lie."""
    group_rows = [metadata.row_group(i).num_rows for i in range(metadata.num_row_groups)]
    rows = sum(group_rows)
    if rows != metadata.num_rows:
        raise SubmissionError(path, "", f"{metadata.num_rows:,} rows in all, but {rows:,} in its row groups")
    most = SPARE_BYTES + rows * MAX_ROW_BYTES
    names = [metadata.schema.column(i).path for i in range(metadata.num_columns)]
    total = 0
    for in_group, chunks in zip(group_rows, _chunks(path, metadata, data), strict=True):
        for name, column in zip(names, chunks, strict=True):
            where = f"field {name}"
            try:
                found = unpacked(data, column)
            except PageError as error:
                raise SubmissionError(path, where, f"the data cannot be read: {error}") from None
            total += found.bytes
            if max(found.values, column.num_values) > in_group * MAX_ROW_VALUES:
                raise SubmissionError(path, where, "too many values for its rows")
    if total > most:
        raise SubmissionError(path, "", f"unpacks to {total:,} bytes; at most {most:,} are read")


def _chunks(path: Path, metadata: pq.FileMetaData, data: mmap.mmap) -> list[list[Chunk]]:
    """The columns of each row group, as many as pyarrow sees."""
    try:
        found = row_groups(data)
    except PageError as error:
        raise SubmissionError(path, "", f"the data cannot be read: {error}") from None
    if [len(chunks) for chunks in found] != [metadata.num_columns] * metadata.num_row_groups:
        raise SubmissionError(path, "", "the data cannot be read: a row group has not all columns")
    return found


def _check_words(path: Path, batch: pa.RecordBatch) -> None:
    """Refuse long words in a batch whose words are in memory once: the rows may repeat them a million times."""
    for name, values in zip(batch.schema.names, batch.columns, strict=True):
        while pa.types.is_list(values.type) or pa.types.is_large_list(values.type):
            values = values.flatten()
        if pa.types.is_dictionary(values.type):
            longest = pc.max(pc.binary_length(values.dictionary)).as_py() or 0
            if longest > MAX_TEXT * MAX_UTF8_BYTES:
                raise SubmissionError(
                    path, f"field {name}", f"a text of {longest:,} bytes; expected {COLUMNS[name].expected}"
                )


def _fits(found: pa.DataType, expected: pa.DataType) -> bool:
    """Whether a column is what is expected, but for the width of numbers and offsets, and how words are kept.

    A column of nothing but nulls, which has no type of its own, fits anything; where there may be none, rows say so.
    """
    if pa.types.is_null(found):
        return True
    if pa.types.is_list(expected):
        is_list = pa.types.is_list(found) or pa.types.is_large_list(found) or pa.types.is_fixed_size_list(found)
        return is_list and _fits(found.value_type, expected.value_type)
    if pa.types.is_string(expected):
        if pa.types.is_dictionary(found):
            found = found.value_type
        return bool(pa.types.is_string(found) or pa.types.is_large_string(found) or pa.types.is_string_view(found))
    return bool(pa.types.is_floating(found) or pa.types.is_integer(found))


def too_many_rows(max_rows: int) -> str:
    """What is said of a file with more rows than there are questions."""
    return f"more rows than the split has ({max_rows:,})"
