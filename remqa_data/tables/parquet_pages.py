"""What the pages of a Parquet file claim to unpack to, read from the headers that the decoder itself goes by.

The footer tells the sizes of column chunks too, but nobody checks it: the decoder makes room for what each page's own
header says, and a kilobyte of zstd may say two gigabytes. Headers and footers are structs of Thrift's compact protocol.
Where the columns lie is read from the footer here, too: pyarrow ends the process over some that cannot be.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

DELTA_BYTE_ARRAY = 7
"""An encoding in which each text repeats the beginning of the one before, so that a page unpacks to any size."""


class PageError(ValueError):
    """Bytes that are no page header, or no footer."""


@dataclass(frozen=True)
class Chunk:
    """Where a column of a row group lies in its file, bytes from the beginning, and how many values it has."""

    data_page_offset: int
    dictionary_page_offset: int | None
    total_compressed_size: int
    num_values: int


@dataclass(frozen=True)
class Page:
    """What a page header says.

    Attributes
    ----------
    bytes : int
        That it unpacks to.
    values : int
        In it, nulls and empty lists too; 0 for a dictionary, whose entries are not values of rows.
    encoding : int
        Parquet's number.
    """

    bytes: int
    values: int
    encoding: int


@dataclass(frozen=True)
class Unpacked:
    """What the pages of a column chunk come to.

    Attributes
    ----------
    bytes, values : int
        Of all pages.
    """

    bytes: int
    values: int


def footer_start(data: Any) -> int:
    """Where in a file, such as an mmap, its footer begins; PageError if it has none."""
    end = len(data) - 8
    start = end - int.from_bytes(data[-8:-4], "little")
    if not 0 < start < end:
        raise PageError("a footer that cannot be")
    return start


def row_groups(data: Any) -> list[list[Chunk]]:
    """The columns of each row group of a file, such as an mmap, in the order of its schema.

    Raises
    ------
    PageError
        If the footer does not say so.
    """
    start = footer_start(data)
    try:
        footer, _ = _struct(data[start:-8], 0)
        return [[_chunk(column[_ABOUT]) for column in group[_COLUMNS]] for group in footer[_GROUPS]]
    except (IndexError, KeyError, TypeError, AttributeError, struct.error):
        raise PageError("a footer that is cut off") from None


def _chunk(about: Any) -> Chunk:
    needed = [about[field] for field in (_DATA_OFFSET, _COMPRESSED, _VALUES)]
    dictionary = about.get(_DICTIONARY_OFFSET)
    if not all(isinstance(number, int) for number in (*needed, dictionary or 0)):
        raise PageError("a footer with a column that cannot be")
    return Chunk(needed[0], dictionary, needed[1], needed[2])


_GROUPS, _COLUMNS, _ABOUT = 4, 1, 3
"""Fields of a footer, of a row group in it, and of a column in that."""
_VALUES, _COMPRESSED, _DATA_OFFSET, _DICTIONARY_OFFSET = 5, 7, 9, 11
"""Fields of what is said about a column."""


def unpacked(data: Any, column: Any) -> Unpacked:
    """What a column chunk unpacks to; parameters and errors as of `pages`, and it has no page whose size nobody knows."""
    found = list(pages(data, column))
    if any(page.encoding == DELTA_BYTE_ARRAY for page in found):
        raise PageError("the encoding DELTA_BYTE_ARRAY, which is not read; write the file with a dictionary")
    return Unpacked(sum(page.bytes for page in found), sum(page.values for page in found))


def pages(data: Any, column: Any) -> Iterator[Page]:
    """The pages of a column chunk.

    Parameters
    ----------
    data : buffer
        The whole file, such as an mmap.
    column : Chunk or pyarrow.parquet.ColumnChunkMetaData
        Where the chunk is.

    Raises
    ------
    PageError
        If that is not where pages are.
    """
    if not (column.num_values or column.data_page_offset):
        return  # Arrow's way to write a column without values: the dictionary's page is there, but none points to it
    place = column.data_page_offset
    if column.dictionary_page_offset is not None and 0 < column.dictionary_page_offset < place:
        place = column.dictionary_page_offset
    end = place + column.total_compressed_size
    if not 0 <= place <= end <= len(data):
        raise PageError("a column lies outside of the file")
    while place < end:
        try:
            header, place = _struct(data, place)
        except (IndexError, struct.error):
            raise PageError("a page header is cut off") from None
        packed: Any = header.get(_PACKED)
        size: Any = header.get(_UNPACKED)
        about = header.get(_DATA) or header.get(_DATA_2) or header.get(_DICTIONARY) or {}
        if not isinstance(about, dict):
            raise PageError("a page header that cannot be")
        encoding = about.get(4 if _DATA_2 in header else 2, 0)
        values = 0 if _DICTIONARY in header else about.get(1, 0)
        if not all(isinstance(n, int) and n >= 0 for n in (packed, size, values, encoding)) or place + packed > end:
            raise PageError("a page header that cannot be")
        yield Page(size, values, encoding)
        place += packed


_UNPACKED, _PACKED, _DATA, _DICTIONARY, _DATA_2 = 2, 3, 5, 7, 8
"""Fields of a header."""
_MOST_DEPTH = 8
_STOP, _TRUE, _FALSE, _BYTE, _DOUBLE, _BINARY, _LIST, _SET, _STRUCT = 0, 1, 2, 3, 7, 8, 9, 10, 12
_WHOLE = (4, 5, 6)


def _struct(data: Any, place: int, depth: int = 0) -> tuple[dict[int, Any], int]:
    """The whole numbers and structs in a struct, by field number, and where it ends."""
    if depth > _MOST_DEPTH:
        raise PageError("a page header that is nested too deep")
    found: dict[int, Any] = {}
    number = 0
    while (head := data[place]) != _STOP:
        place += 1
        if head >> 4:
            number += head >> 4
        else:
            number, place = _zigzag(data, place)
        found[number], place = _value(data, place, head & 15, depth)
    return found, place + 1


def _value(data: Any, place: int, kind: int, depth: int) -> tuple[Any, int]:
    if kind in _WHOLE:
        return _zigzag(data, place)
    if kind in (_TRUE, _FALSE):
        return None, place
    if kind == _STRUCT:
        return _struct(data, place, depth + 1)
    if kind == _BINARY:
        length, place = _varint(data, place)
        return None, place + length
    if kind in (_LIST, _SET):
        return _list(data, place, depth)
    if kind in (_BYTE, _DOUBLE):
        return None, place + (1 if kind == _BYTE else 8)
    raise PageError("a page header with a field that no page has")


def _list(data: Any, place: int, depth: int) -> tuple[list[Any], int]:
    kind, count, place = data[place] & 15, data[place] >> 4, place + 1
    if count == 15:
        count, place = _varint(data, place)
    if depth > _MOST_DEPTH or count > len(data) - place:  # each takes a byte at least
        raise PageError("a list that is nested too deep or longer than its file")
    values = []
    for _ in range(count):
        value, place = (None, place + 1) if kind in (_TRUE, _FALSE) else _value(data, place, kind, depth + 1)
        values.append(value)
    return values, place


def _zigzag(data: Any, place: int) -> tuple[int, int]:
    number, place = _varint(data, place)
    return (number >> 1) ^ -(number & 1), place


def _varint(data: Any, place: int) -> tuple[int, int]:
    number = shift = 0
    while True:
        byte = data[place]
        place += 1
        number |= (byte & 127) << shift
        if byte < 128:
            return number, place
        shift += 7
        if shift > 63:
            raise PageError("a page header with a number that does not end")
