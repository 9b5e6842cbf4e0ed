"""Small Parquet submissions that would unpack to very large tables are refused by what their pages say."""

import json
import multiprocessing
import resource
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from remqa_data.errors import SubmissionError
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.tables.parquet_pages import unpacked
from tests.helpers.parquet_bombs import belittle, read_submission_with_flipped_footers, write_bomb

MB = 1 << 20


def with_header(data: pa.Table, track: str) -> pa.Table:
    header = {"format": "remqa-submission", "version": 1, "track": track, "split": "test"}
    return data.replace_schema_metadata({"remqa-submission": json.dumps(header)})


def long_answer(megabytes: int) -> pa.Table:
    return with_header(pa.table({"question_id": ["a"], "answer": ["x" * (megabytes * MB)]}), "qa")


def long_list(actions: int) -> pa.Table:
    words = pa.DictionaryArray.from_arrays(pa.array(np.zeros(actions, np.int8)), pa.array(["MoveAhead"]))
    plain = pa.ListArray.from_arrays(pa.array([0, actions], pa.int32()), words)
    return with_header(pa.table({"question_id": ["a"], "actions": plain}), "nav")


def refusal(path: Path) -> str:
    """What is said; and no more than 50 MB of memory is taken on the way."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(SubmissionError) as caught:
        list(open_submission(path).batches(replay=True, max_rows=10))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50 * 1024
    return str(caught.value)


@pytest.mark.slow
@pytest.mark.parametrize("is_footer_honest", [True, False])
def test_a_text_of_100_mb_is_refused_whatever_the_footer_says(is_footer_honest: bool, tmp_path: Path) -> None:
    path = write_bomb(tmp_path / "bomb.parquet", long_answer(100), is_footer_honest=is_footer_honest)
    assert path.stat().st_size < 20_000
    if not is_footer_honest:
        assert pq.read_metadata(path).row_group(0).column(1).total_uncompressed_size == 100
    assert "unpacks to 104,857," in refusal(path)


@pytest.mark.slow
def test_a_list_of_five_million_actions_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.parquet"
    pq.write_table(long_list(5_000_000), path, store_schema=False, data_page_size=1 << 30, write_statistics=False)
    data = pq.read_table(path)  # without what only pyarrow knows of its types
    pq.write_table(with_header(data, "nav"), path, data_page_size=1 << 30)
    belittle(path)
    assert path.stat().st_size < 100_000
    assert "too many values for its rows" in refusal(path)


@pytest.mark.slow
@pytest.mark.parametrize("version", ["1.0", "2.0"])
@pytest.mark.parametrize("compression", ["zstd", "snappy", "none"])
def test_pages_say_what_an_honest_footer_says(version: str, compression: str, tmp_path: Path) -> None:
    path = tmp_path / "honest.parquet"
    rows = pa.table({"word": [f"word {i % 50}" for i in range(20_000)], "list": [[i, None] for i in range(20_000)]})
    pq.write_table(rows, path, compression=compression, data_page_version=version, data_page_size=4096)
    content = path.read_bytes()
    group = pq.read_metadata(path).row_group(0)
    assert group.num_columns == 2
    for column in (group.column(i) for i in range(group.num_columns)):
        found = unpacked(content, column)
        assert found.values == column.num_values
        assert 0 < found.bytes <= column.total_uncompressed_size  # which counts the headers too


def test_an_encoding_whose_size_nobody_knows_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "delta.parquet"
    rows = with_header(pa.table({"question_id": ["a", "b"], "answer": ["yes", "yes"]}), "qa")
    encoding = {"answer": "DELTA_BYTE_ARRAY", "question_id": "PLAIN"}
    pq.write_table(rows, path, use_dictionary=False, column_encoding=encoding)
    assert "DELTA_BYTE_ARRAY" in refusal(path)


@pytest.mark.slow
def test_no_flipped_bit_of_a_footer_ends_the_process(tmp_path: Path) -> None:
    """pyarrow does, when it is asked what a row group says of a column whose sizes do not fit the schema."""
    path = tmp_path / "lists.parquet"
    pq.write_table(long_list(20), path)
    reading = multiprocessing.get_context("spawn").Process(
        target=read_submission_with_flipped_footers, args=(path, 1500)
    )
    reading.start()
    reading.join()
    assert reading.exitcode == 0


def test_a_file_whose_pages_are_damaged_is_refused(tmp_path: Path) -> None:
    path = write_bomb(tmp_path / "bomb.parquet", long_answer(1), is_footer_honest=True)
    content = bytearray(path.read_bytes())
    content[4:40] = b"\xff" * 36
    path.write_bytes(content)
    assert "cannot be read" in refusal(path)
