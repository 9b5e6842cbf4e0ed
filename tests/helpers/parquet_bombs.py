"""Small Parquet files that unpack to very large tables, with footers that tell the truth or lie."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from remqa_data.errors import SubmissionError
from remqa_data.evaluation.submission.reader import open_submission
from tests.helpers.damaged_files import flip_bits_of_footer


def write_bomb(path: Path, data: pa.Table, *, is_footer_honest: bool = False) -> Path:
    """Write a table; unless it is honest, the footer then claims that every column chunk unpacks to 100 bytes."""
    pq.write_table(data, path, compression="zstd", use_dictionary=False, write_statistics=False, data_page_size=1 << 30)
    if not is_footer_honest:
        belittle(path)
    return path


def belittle(path: Path, claimed: int = 100) -> None:
    """Let the footer claim small sizes, in numbers of as many bytes as those that were there."""
    metadata = pq.read_metadata(path)
    content = path.read_bytes()
    start = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    footer = content[start:-8]
    for group in (metadata.row_group(i) for i in range(metadata.num_row_groups)):
        columns = [group.column(i) for i in range(group.num_columns)]
        for size in {group.total_byte_size, *(column.total_uncompressed_size for column in columns)}:
            written = _varint(2 * size)
            if size > 10_000:
                assert written in footer
                footer = footer.replace(written, _varint(2 * claimed, len(written)))
    path.write_bytes(content[:start] + footer + content[-8:])


def read_submission_with_flipped_footers(path: Path, times: int) -> None:
    """Each is read or refused; for a process of its own, as pyarrow may end it."""
    for _ in flip_bits_of_footer(path, times):
        with suppress(SubmissionError):
            list(open_submission(path).batches(replay=True, max_rows=10))


def _varint(number: int, length: int = 0) -> bytes:
    """A number as Thrift writes it, padded to a length."""
    digits = [number & 127]
    while number := number >> 7:
        digits.append(number & 127)
    digits += [0] * (length - len(digits))
    return bytes([*(digit | 128 for digit in digits[:-1]), digits[-1]])
