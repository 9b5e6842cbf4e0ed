"""Reading submissions: JSON Lines or Parquet, in bounded memory, and nothing in them is ever executed.

The first line of a .jsonl file is its header, the metadata entry `remqa-submission` of a .parquet file is:
``{"format": "remqa-submission", "version": 1, "track": "nav", "split": "test"}``, and where wished "dataset", the
dataset's sha256, all of it or the first 16 digits that `remqa-eval` prints, and "agent", a name for reports.
"""

from __future__ import annotations

import codecs
import gc
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, BinaryIO, Literal, NoReturn

import pyarrow as pa
import pyarrow.parquet as pq
from pydantic import BaseModel, ConfigDict, Field, StringConstraints, TypeAdapter, ValidationError, with_config
from typing_extensions import TypedDict

from remqa_data.errors import SubmissionError
from remqa_data.evaluation.submission.checks import find_problem
from remqa_data.evaluation.submission.parquet_rows import METADATA_KEY, parquet_batches, parquet_header, too_many_rows
from remqa_data.evaluation.submission.tracks import COLUMNS, FORMAT, TRACKS, VERSION, Track, arrow_schema
from remqa_data.files import atomic_path, local_path
from remqa_data.limits import MAX_NAME

MAX_LINE_BYTES = 1 << 20
BATCH_ROWS = 4096
LEAST_SHA256 = 16
"""Digits that tell a dataset; reports show so many."""
ShortText = Annotated[str, StringConstraints(max_length=MAX_NAME, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")]
"""A line for people: a character that drives a terminal has no place in it."""


class Header(BaseModel):
    """What a submission says about itself."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    format: Literal["remqa-submission"] = FORMAT
    version: Annotated[int, Field(ge=VERSION, le=VERSION)] = VERSION
    track: Track
    split: ShortText
    dataset: ShortText | None = None
    agent: ShortText = "unnamed"


@dataclass(frozen=True)
class Batch:
    """Some rows of a submission, checked.

    Attributes
    ----------
    rows : pyarrow.RecordBatch
        With the types of `tracks.COLUMNS`.
    first : int
        Number of the first row in the file, from 1.
    """

    rows: pa.RecordBatch
    first: int


@dataclass(frozen=True)
class Submission:
    """An open submission; see `open_submission`."""

    path: Path
    header: Header
    is_parquet: bool

    def batches(self, *, replay: bool, max_rows: int) -> Iterator[Batch]:
        """The rows, some at a time.

        Parameters
        ----------
        replay : bool
            Whether rows hold actions, or poses; see `tracks.TrackSpec.columns`.
        max_rows : int
            How many there may be.

        Raises
        ------
        SubmissionError
            For the first row that cannot be scored.
        """
        names = TRACKS[self.header.track].columns(replay=replay)
        first = 1
        for rows in (
            parquet_batches(self.path, names, max_rows) if self.is_parquet else _jsonl_batches(self.path, names)
        ):
            problem = find_problem(rows)
            if problem is not None:
                where = f"{self.place(first + problem.row)}, field {problem.field}"
                column = COLUMNS[problem.field.partition("[")[0]]
                raise SubmissionError(self.path, where, f"{problem.reason}; expected {column.expected}")
            yield Batch(rows, first)
            first += rows.num_rows
            if first - 1 > max_rows:
                raise SubmissionError(self.path, self.place(first - 1), too_many_rows(max_rows))

    def check(
        self,
        *,
        track: str | None = None,
        split: str | None = None,
        dataset: str | None = None,
        splits: Sequence[str] = (),
    ) -> None:
        """Refuse a submission to another track, or about another split or dataset (its sha256), where one is named.

        Where `splits` are named, those of the dataset, its split is one of them.

        Raises
        ------
        SubmissionError
            If its header says another one.
        """
        said = self.header.dataset
        for name, found, value in (("track", self.header.track, track), ("split", self.header.split, split)):
            if value is not None and found != value:
                self._refuse(name, found, value)
        if dataset is not None and said is not None and not (len(said) >= LEAST_SHA256 and dataset.startswith(said)):
            self._refuse("dataset", said[:LEAST_SHA256], dataset[:LEAST_SHA256])
        if splits and self.header.split not in splits:
            msg = f"the dataset has no split {self.header.split!r}; expected one of: {', '.join(splits)}"
            raise SubmissionError(self.path, self.header_place("split"), msg)

    def _refuse(self, name: str, found: str, value: str) -> NoReturn:
        raise SubmissionError(
            self.path, self.header_place(name), f"the predictions are for {name} {found!r}, not {value!r}"
        )

    def header_place(self, field: str) -> str:
        """Where a field of the header is, for people."""
        return f"{_header_place(is_parquet=self.is_parquet)}, field {field}"

    def place(self, row: int) -> str:
        """Where a row is, for people: in a .jsonl file the line, of which the header is the first."""
        return f"row {row}" if self.is_parquet else f"line {row + 1}"


def open_submission(path: Path) -> Submission:
    """Read a submission's header.

    Raises
    ------
    SubmissionError
        If it is neither .jsonl nor .parquet, or its header cannot be read.
    """
    if path.suffix not in (".jsonl", ".parquet"):
        raise SubmissionError(path, "", "the name must end with .jsonl or .parquet")
    if not path.is_file():
        raise SubmissionError(path, "", "is no ordinary file" if path.exists() else "no such file")
    is_parquet = path.suffix == ".parquet"
    text, where = parquet_header(path) if is_parquet else _first_line(path), _header_place(is_parquet=is_parquet)
    try:
        header = Header.model_validate_json(text)
        _refuse_repeated_keys(path, where, text)
    except ValidationError as error:
        field, reason = _first_error(error)
        msg = f'{reason}; a header is {{"format": "{FORMAT}", "version": {VERSION}, "track": ..., "split": ...}}'
        raise SubmissionError(path, ", field ".join(filter(None, (where, field))), msg) from None
    return Submission(path, header, is_parquet)


def _header_place(*, is_parquet: bool) -> str:
    return f"metadata {FORMAT}" if is_parquet else "line 1"


def write_submission(path: Path, header: Header, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a submission as .jsonl or .parquet, whole or not at all.

    Raises
    ------
    SubmissionError
        If the name ends with neither.
    """
    if path.suffix not in (".jsonl", ".parquet"):
        raise SubmissionError(path, "", "the name must end with .jsonl or .parquet")
    about = header.model_dump_json(exclude_none=True)
    with atomic_path(path) as temporary:
        if path.suffix == ".jsonl":
            lines = (json.dumps(row, ensure_ascii=False) for row in rows)
            temporary.write_text("\n".join([about, *lines]) + "\n", encoding="utf-8")
        else:
            schema = arrow_schema(TRACKS[header.track].columns(replay=True)).with_metadata({METADATA_KEY: about})
            pq.write_table(pa.Table.from_pylist(list(rows), schema), local_path(temporary))


def _jsonl_batches(path: Path, names: tuple[str, ...]) -> Iterator[pa.RecordBatch]:
    schema, row_type = arrow_schema(names), _row_type(names)
    keys = [f'"{name}"'.encode() for name in names]
    with path.open("rb") as handle:
        lines = enumerate(_lines(path, handle), start=1)
        next(lines)  # the header
        while rows := _parsed_rows(path, row_type, keys, islice(lines, BATCH_ROWS)):
            yield pa.RecordBatch.from_pylist(rows, schema)


def _lines(path: Path, handle: BinaryIO) -> Iterator[bytes]:
    number = 0
    while line := handle.readline(MAX_LINE_BYTES + 1):
        number += 1
        if number == 1:
            line = line.removeprefix(codecs.BOM_UTF8)
        if len(line) > MAX_LINE_BYTES:
            raise SubmissionError(path, f"line {number}", f"longer than {MAX_LINE_BYTES:,} bytes")
        yield line


def _parsed_rows(
    path: Path, row_type: TypeAdapter[Any], keys: Sequence[bytes], lines: Iterable[tuple[int, bytes]]
) -> list[Any]:
    """Some rows. JSON has no cycles: looking for them among its many small lists would take most of the time."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        return [_parsed(path, row_type, keys, number, line) for number, line in lines]
    finally:
        if was_enabled:
            gc.enable()


def _parsed(path: Path, row_type: TypeAdapter[Any], keys: Sequence[bytes], number: int, line: bytes) -> Any:
    if not line.strip():
        raise SubmissionError(path, f"line {number}", "is empty: take it out")
    try:
        row = row_type.validate_json(line)
        if b"\\" in line or any(line.count(key) > 1 for key in keys):  # so few that looking closely costs nothing
            _refuse_repeated_keys(path, f"line {number}", line)
        return row
    except ValidationError as error:
        field, reason = _first_error(error)
        name = field.partition("[")[0]
        if name in COLUMNS:
            reason = f"{reason}; expected {COLUMNS[name].expected}"
        if name in ("actions", "poses"):
            reason += " (actions, or poses with --no-replay)"
        raise SubmissionError(path, ", field ".join(filter(None, (f"line {number}", field))), reason) from None


def _refuse_repeated_keys(path: Path, where: str, text: bytes) -> None:
    """Refuse a JSON object in which a key is there twice: which one counts would depend on who reads it."""
    keys = [key for key, _ in json.loads(text, object_pairs_hook=list)]
    twice = next((key for number, key in enumerate(keys) if key in keys[:number]), None)
    if twice is not None:
        raise SubmissionError(path, f"{where}, field {twice[:80]}", "is there twice")


def _row_type(names: tuple[str, ...]) -> TypeAdapter[Any]:
    config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)
    fields = {name: COLUMNS[name].json for name in names}
    return TypeAdapter(with_config(config)(TypedDict("Row", fields)))  # type: ignore[operator]


def _first_error(error: ValidationError) -> tuple[str, str]:
    """The field of a validation error, and what is wrong with it, in short."""
    found = error.errors(include_url=False, include_input=False, include_context=False)[0]
    field = ""
    for part in found["loc"]:
        field += f"[{part}]" if isinstance(part, int) else f".{part}" if field else str(part)
    messages = {
        "json_invalid": "is not JSON, not UTF-8, or holds half a character (\\ud800) or a number that is too long",
        "extra_forbidden": "is no field that a submission has here",
    }
    return field[:80], messages.get(found["type"], found["msg"])


def _first_line(path: Path) -> bytes:
    with path.open("rb") as handle:
        line = next(_lines(path, handle), b"")
    if not line:
        raise SubmissionError(path, "", "the file is empty; expected a header line and one line for each row")
    return line
