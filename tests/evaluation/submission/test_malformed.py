"""Every malformed submission gives one line with file, place and field, exit code 2, and no results."""

import json
import pickle
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

from remqa_data.evaluation.cli import app
from remqa_data.evaluation.submission.checks import find_problem
from remqa_data.evaluation.submission.reader import open_submission

HEADER = {"format": "remqa-submission", "version": 1, "track": "remqa", "split": "test"}
ID = "Kitchen3-q0"
OPEN = "OpenObject Drawer|1"
ROW = {
    "question_id": ID,
    "actions": ["MoveAhead", "Done"],
    "box": [1, 2, 30, 40.5],
    "manipulation": OPEN,
    "answer": "yes",
}


def jsonl(*rows: Any, header: Any = HEADER) -> bytes:
    lines = [row if isinstance(row, bytes) else json.dumps(row).encode() for row in (header, *rows)]
    return b"\n".join(lines) + b"\n"


def row(**changed: Any) -> bytes:
    return jsonl(ROW | changed)


def without(name: str) -> bytes:
    return jsonl({key: value for key, value in ROW.items() if key != name})


def header(**changed: Any) -> bytes:
    return jsonl(ROW, header=HEADER | changed)


def raw_row(field: str, text: bytes) -> bytes:
    """A row in which the JSON of one value is written by hand."""
    marked = json.dumps(ROW | {field: "@@"}).encode()
    return jsonl(marked.replace(b'"@@"', text))


# name: (bytes of the .jsonl, what the line must say)
JSONL: dict[str, tuple[bytes, str]] = {
    "empty file": (b"", "empty"),
    "only a line feed": (b"\n", "line 1"),
    "no header": (json.dumps(ROW).encode(), "line 1"),
    "header of a list": (jsonl(ROW, header=[1, 2]), "line 1"),
    "header with another format": (header(format="coco-results"), "line 1, field format"),
    "header with a later version": (header(version=2), "line 1, field version"),
    "header with a version that is a text": (header(version="1"), "line 1, field version"),
    "header with a version that is a truth value": (header(version=True), "line 1, field version"),
    "header with a version that is a fraction": (header(version=1.0), "line 1, field version"),
    "header with an unknown track": (header(track="vqa"), "line 1, field track"),
    "header without a split": (
        jsonl(ROW, header={k: v for k, v in HEADER.items() if k != "split"}),
        "line 1, field split",
    ),
    "header with an unknown key": (header(score=1.0), "line 1, field score"),
    "header with a long agent": (header(agent="x" * 10_000), "line 1, field agent"),
    "header with an agent that drives a terminal": (header(agent="a\x1b[31mred"), "line 1, field agent"),
    "header with an agent of two lines": (header(agent="a\nb"), "line 1, field agent"),
    "header with a key twice": (
        jsonl(ROW).replace(b'"track"', b'"agent": "a", "agent": "b", "track"', 1),
        "line 1, field agent: is there twice",
    ),
    "a key twice": (
        jsonl(ROW).replace(b'"answer"', b'"answer": "no", "answer"', 1),
        "line 2, field answer: is there twice",
    ),
    "a key twice in other letters": (
        jsonl(ROW).replace(b'"answer"', b'"\\u0061nswer": "no", "answer"', 1),
        "line 2, field answer: is there twice",
    ),
    "a number in other digits": (row(manipulation="OpenObject Fridge|1 ０.５"), "line 2, field manipulation"),
    "a number with an underscore": (row(manipulation="OpenObject Fridge|1 0_1.0"), "line 2, field manipulation"),
    "a split that the dataset has not": (
        header(split="../x"),
        "line 1, field split: the dataset has no split '../x'; expected one of: train, test",
    ),
    "a split that the dataset has not of expressions": (
        header(track="rec", split="walks"),
        "line 1, field split: the dataset has no split 'walks'",
    ),
    "another dataset": (
        header(dataset="0" * 64),
        "line 1, field dataset: the predictions are for dataset '0000000000000000'",
    ),
    "a dataset without a name": (header(dataset=""), "for dataset ''"),
    "truncated JSON": (jsonl(b'{"question_id": "Kitchen3-q0", "act'), "line 2"),
    "JSON in the middle of which the file ends": (jsonl(ROW)[:-30], "line 2"),
    "an empty line": (jsonl(b"", ROW), "line 2: is empty: take it out"),
    "an array": (jsonl([1, 2, 3]), "line 2"),
    "a number": (jsonl(b"17"), "line 2"),
    "null": (jsonl(b"null"), "line 2"),
    "two rows in one line": (jsonl(json.dumps(ROW).encode() * 2), "line 2"),
    "single quotes": (jsonl(str(ROW).encode()), "line 2"),
    "UTF-8 damage": (jsonl(json.dumps(ROW).encode().replace(b"yes", b"y\xffs")), "line 2"),
    "half a UTF-16 pair": (raw_row("answer", b'"\\ud800"'), "line 2"),
    "UTF-16": (json.dumps(HEADER).encode("utf-16"), "line 1"),
    "two byte order marks": (2 * b"\xef\xbb\xbf" + jsonl(ROW), "line 1"),
    "a byte order mark in line 2": (jsonl(b"\xef\xbb\xbf" + json.dumps(ROW).encode()), "line 2"),
    "zero bytes": (b"\0" * 1000, "line 1"),
    "a pickle": (pickle.dumps(ROW), "line 1"),
    "a pickle after a header": (jsonl(pickle.dumps(ROW)), "line 2"),
    "deep nesting": (jsonl(b"[" * 100_000), "line 2"),
    "deep nesting in a field": (raw_row("box", b"[" * 5000 + b"]" * 5000), "line 2"),
    "deep objects": (jsonl(b'{"a":' * 50_000), "line 2"),
    "a very long line": (jsonl(b" " * (2 << 20)), "line 2"),
    "a million actions": (row(actions=["MoveAhead"] * 1_000_000), "line 2"),
    "501 actions": (row(actions=["MoveAhead"] * 501), "line 2, field actions"),
    "a missing id": (without("question_id"), "line 2, field question_id"),
    "missing actions": (without("actions"), "line 2, field actions"),
    "a missing box": (without("box"), "line 2, field box"),
    "a missing manipulation": (without("manipulation"), "line 2, field manipulation"),
    "a missing answer": (without("answer"), "line 2, field answer"),
    "an unknown field": (row(confidence=0.5), "line 2, field confidence"),
    "poses instead of actions": (row(poses=[[0, -0.5, 0, 30]]), "line 2, field poses"),
    "an id that is a number": (row(question_id=3), "line 2, field question_id"),
    "an id that is null": (row(question_id=None), "line 2, field question_id"),
    "a long id": (row(question_id="q" * 1000), "line 2, field question_id"),
    "an unknown id": (
        row(question_id="Kitchen3-q00"),
        "line 2, field question_id: 'Kitchen3-q00' is not in split 'test'",
    ),
    "an id of another split": (row(question_id="Kitchen1-q0"), "line 2, field question_id"),
    "an id twice": (jsonl(ROW, ROW), "line 3, field question_id: 'Kitchen3-q0' is there twice"),
    "actions that are a text": (row(actions="MoveAhead"), "line 2, field actions"),
    "actions that are null": (row(actions=None), "line 2, field actions"),
    "an action that is a number": (row(actions=["MoveAhead", 5]), "line 2, field actions[1]"),
    "an action that is null": (row(actions=["MoveAhead", None]), "line 2, field actions[1]"),
    "an unknown action": (row(actions=["MoveAhead", "Fly"]), "line 2, field actions[1]: 'Fly'"),
    "Teleport": (row(actions=["Teleport 1 2"]), "line 2, field actions[0]: 'Teleport 1 2'"),
    "an action in small letters": (row(actions=["moveahead"]), "line 2, field actions[0]"),
    "a manipulation among the actions": (row(actions=[OPEN]), "line 2, field actions[0]"),
    "an action after Done": (row(actions=["Done", "MoveAhead"]), "line 2, field actions"),
    "a box of three": (row(box=[1, 2, 3]), "line 2, field box"),
    "a box of five": (row(box=[1, 2, 3, 4, 5]), "line 2, field box"),
    "a box of texts": (row(box=["1", "2", "3", "4"]), "line 2, field box[0]"),
    "a box of booleans": (row(box=[True, True, True, True]), "line 2, field box[0]"),
    "a box that is an object": (row(box={"x": 1}), "line 2, field box"),
    "a box with null": (row(box=[1, 2, 3, None]), "line 2, field box[3]"),
    "a box with NaN": (raw_row("box", b"[NaN, 0, 1, 1]"), "line 2, field box[0]"),
    "a box with Infinity": (raw_row("box", b"[0, 0, Infinity, 1]"), "line 2, field box[2]"),
    "a box with 1e999": (raw_row("box", b"[0, 0, 1e999, 1]"), "line 2, field box[2]"),
    "a box with a number of 400 digits": (raw_row("box", b"[0, 0, %s, 1]" % (b"9" * 400)), "line 2, field box[2]"),
    "a box with a number of 40,000 digits": (raw_row("box", b"[0, 0, %s, 1]" % (b"9" * 40_000)), "line 2"),
    "a huge box": (row(box=[0, 0, 1e9, 1e9]), "line 2, field box: a coordinate above"),
    "a negative box": (row(box=[-5, 0, 10, 10]), "line 2, field box: a negative coordinate"),
    "a box inside out": (row(box=[10, 0, 5, 10]), "line 2, field box: x2 < x1"),
    "an answer that is a number": (row(answer=2), "line 2, field answer"),
    "an answer that is a boolean": (row(answer=True), "line 2, field answer"),
    "an answer that is a list": (row(answer=["yes"]), "line 2, field answer"),
    "a long answer": (row(answer="y" * 100_000), "line 2, field answer"),
    "a manipulation that is a list": (row(manipulation=["OpenObject", "Drawer|1"]), "line 2, field manipulation"),
    "an unknown manipulation": (row(manipulation="Explode Drawer|1"), "line 2, field manipulation"),
    "a manipulation without an object": (row(manipulation="OpenObject"), "line 2, field manipulation"),
    "a manipulation beside the picture": (row(manipulation="OpenObject @1.5,0.5"), "line 2, field manipulation"),
    "a manipulation nowhere": (row(manipulation="OpenObject @nan,0.5"), "line 2, field manipulation"),
    "a manipulation of two objects": (row(manipulation="OpenObject a b"), "line 2, field manipulation"),
    "a move to nowhere": (row(manipulation="MoveObject Stool|1 0 nan 0"), "line 2, field manipulation"),
    "a move to far away": (row(manipulation="MoveObject Stool|1 0 1e308 0"), "line 2, field manipulation"),
    "a second line in a manipulation": (row(manipulation=OPEN + "\nDone"), "line 2, field manipulation"),
    "a later row": (jsonl(ROW, ROW | {"question_id": "Kitchen3-q1", "box": [1]}), "line 3, field box"),
}

TABLE = {
    "question_id": pa.array([ID]),
    "actions": pa.array([["MoveAhead"]]),
    "box": pa.array([[1.0, 2.0, 3.0, 4.0]]),
    "manipulation": pa.array([OPEN]),
    "answer": pa.array(["yes"]),
}


def parquet(path: Path, header: Any = HEADER, **changed: pa.Array) -> None:
    columns = {name: values for name, values in (TABLE | changed).items() if values is not None}
    table = pa.table(columns)
    if header is not None:
        table = table.replace_schema_metadata({"remqa-submission": json.dumps(header)})
    pq.write_table(table, path)


def cut(path: Path) -> None:
    parquet(path)
    path.write_bytes(path.read_bytes()[:-50])


def flipped(path: Path) -> None:
    parquet(path)
    data = bytearray(path.read_bytes())
    data[4:40] = b"\xff" * 36
    path.write_bytes(bytes(data))


def many_rows(path: Path) -> None:
    """Few bytes, many rows."""
    copies = {name: values.take(pa.array([0] * 200_000)) for name, values in TABLE.items()}
    pq.write_table(pa.table(copies).replace_schema_metadata({"remqa-submission": json.dumps(HEADER)}), path)


def long_list(path: Path) -> None:
    """Few bytes, one row with many actions."""
    parquet(path, actions=pa.array([["MoveAhead"] * 3_000_000]))


def long_words(path: Path) -> None:
    """A dictionary with one long word, named by every action: 10 MB that would be 5 GB."""
    words = pa.DictionaryArray.from_arrays(pa.array([0] * 500), pa.array(["x" * 10_000_000]))
    columns = TABLE | {"actions": pa.ListArray.from_arrays(pa.array([0, 500]), words)}
    table = pa.table(columns).replace_schema_metadata({"remqa-submission": json.dumps(HEADER)})
    with pq.ParquetWriter(path, table.schema, store_schema=False) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata({"remqa-submission": json.dumps(HEADER)})


PARQUET: dict[str, tuple[Callable[[Path], None], str]] = {
    "no Parquet": (lambda path: path.write_bytes(jsonl(ROW)) and None, "no Parquet file"),
    "an empty file": (lambda path: path.write_bytes(b"") and None, "no Parquet file"),
    "a cut file": (cut, "no Parquet file"),
    "damaged data": (flipped, "cannot be read"),
    "a pickle": (lambda path: path.write_bytes(pickle.dumps(ROW)) and None, "no Parquet file"),
    "no header": (lambda path: parquet(path, header=None), "metadata"),
    "a header that is no header": (lambda path: parquet(path, header=[1]), "metadata remqa-submission"),
    "a split that the dataset has not": (
        lambda path: parquet(path, header=HEADER | {"split": "val"}),
        "metadata remqa-submission, field split: the dataset has no split 'val'",
    ),
    "another table": (lambda path: pq.write_table(pa.table({"a": [1]}), path), "metadata"),
    "a missing column": (lambda path: parquet(path, box=None), "field box"),
    "another column": (lambda path: parquet(path, extra=pa.array([1])), "field extra"),
    "ids that are numbers": (lambda path: parquet(path, question_id=pa.array([1])), "field question_id"),
    "actions that are a text": (lambda path: parquet(path, actions=pa.array(["MoveAhead"])), "field actions"),
    "actions that are bytes": (lambda path: parquet(path, actions=pa.array([[b"MoveAhead"]])), "field actions"),
    "boxes of texts": (lambda path: parquet(path, box=pa.array([["1", "2", "3", "4"]])), "field box"),
    "a box with NaN": (lambda path: parquet(path, box=pa.array([[1.0, float("nan"), 3, 4]])), "row 1, field box[1]"),
    "a box with null": (lambda path: parquet(path, box=pa.array([[1.0, None, 3, 4]])), "row 1, field box"),
    "a box of two": (lambda path: parquet(path, box=pa.array([[1.0, 2.0]])), "row 1, field box"),
    "a null id": (lambda path: parquet(path, question_id=pa.array([None], pa.string())), "row 1, field question_id"),
    "null actions": (
        lambda path: parquet(path, actions=pa.array([None], pa.list_(pa.string()))),
        "row 1, field actions",
    ),
    "ids of nothing but nulls": (lambda path: parquet(path, question_id=pa.nulls(1)), "row 1, field question_id"),
    "actions of nothing but nulls": (lambda path: parquet(path, actions=pa.nulls(1)), "row 1, field actions"),
    "an unknown action": (lambda path: parquet(path, actions=pa.array([["Fly"]])), "row 1, field actions[0]: 'Fly'"),
    "an unknown id": (lambda path: parquet(path, question_id=pa.array(["x"])), "row 1, field question_id"),
    "too many rows": (many_rows, "more rows than the split has"),
    "a very long list": (long_list, "field actions"),
    "very long words": (long_words, "field actions"),
    "a very long id": (lambda path: parquet(path, question_id=pa.array(["q" * 10_000_000])), "field question_id"),
}


@pytest.mark.parametrize("kind", [pa.list_(pa.float64()), pa.list_(pa.float64(), 4)], ids=["list", "fixed size"])
@pytest.mark.parametrize(
    ("wrong", "field"), [([-1.0, 0, 5, 5], "box"), ([3.0, 0, 1, 5], "box"), ([0.0, float("nan"), 1, 1], "box[1]")]
)
def test_a_wrong_box_behind_rows_without_one_is_told_of_its_own_row(
    kind: pa.DataType, wrong: list[float], field: str
) -> None:
    boxes = pa.array([None, [0.0, 0, 1, 1], None, [0.0, 0, 1, 1], wrong], kind).cast(pa.list_(pa.float64()))
    problem = find_problem(pa.RecordBatch.from_arrays([boxes], ["box"]))
    assert problem is not None
    assert (problem.row, problem.field) == (4, field)


@pytest.mark.slow
@pytest.mark.parametrize("name", JSONL)
def test_malformed_json_lines(data: Path, tmp_path: Path, name: str) -> None:
    content, wanted = JSONL[name]
    path = tmp_path / "predictions.jsonl"
    path.write_bytes(content)
    assert_refused(data, path, wanted)


@pytest.mark.slow
@pytest.mark.parametrize("name", PARQUET)
def test_malformed_parquet(data: Path, tmp_path: Path, name: str) -> None:
    write, wanted = PARQUET[name]
    path = tmp_path / "predictions.parquet"
    write(path)
    assert_refused(data, path, wanted)


def test_a_split_other_than_the_one_asked_for(data: Path, tmp_path: Path) -> None:
    path = tmp_path / "predictions.jsonl"
    path.write_bytes(jsonl(ROW))
    assert_refused(
        data, path, "line 1, field split: the predictions are for split 'test', not 'train'", "--split", "train"
    )


def test_files_that_are_not_there_or_have_another_name(data: Path, tmp_path: Path) -> None:
    assert_refused(data, tmp_path / "predictions.jsonl", "no such file")
    other = tmp_path / "predictions.pkl"
    other.write_bytes(pickle.dumps(ROW))
    assert_refused(data, other, ".jsonl or .parquet")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("poses", "wanted"),
    [
        ([], "field poses: no pose"),
        ([[0, -0.5, 0]], "field poses"),
        ([[0, -0.5, 0, 1e9]], "field poses: a number beyond"),
        ([[3, 3, 0, 30]], "field poses[0]: not the question's initial pose"),
        ([[0, -0.5, 0, 30]] * 502, "field poses"),
        ([[0, -0.5, 0, "30"]], "field poses[0][3]"),
    ],
)
def test_malformed_poses_without_replay(data: Path, tmp_path: Path, poses: Any, wanted: str) -> None:
    path = tmp_path / "predictions.jsonl"
    rows = [{"question_id": ID, "poses": poses, "target_box": None}]
    path.write_bytes(jsonl(*rows, header=HEADER | {"track": "nav"}))
    assert_refused(data, path, f"line 2, {wanted}", "--no-replay")


class Bomb:
    """Leaves a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return (Path.touch, (self.path,))


def test_nothing_is_unpickled(data: Path, tmp_path: Path) -> None:
    proof = tmp_path / "proof"
    for name in ("a.jsonl", "a.parquet", "a.pkl"):
        (tmp_path / name).write_bytes(pickle.dumps(Bomb(proof), protocol=0))
        CliRunner().invoke(app, [str(tmp_path / name), "--data", str(data)])
    assert not proof.exists()


def assert_refused(data: Path, path: Path, wanted: str, *options: str) -> None:
    out = path.parent / "out"
    tracemalloc.start()
    started = time.process_time()
    result = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(out), *options])
    seconds, peak = time.process_time() - started, tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert result.exit_code == 2, result.output
    lines = result.stderr.splitlines()
    assert len(lines) == 1, lines
    assert wanted in lines[0]
    assert len(lines[0]) < 700
    assert path.name in lines[0]
    assert isinstance(result.exception, SystemExit)  # no traceback
    assert not out.exists()
    assert seconds < 20, "time is not bounded"
    assert peak < 200 << 20, "memory is not bounded"


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["null", "dictionary", "view"])
def test_a_parquet_file_may_keep_words_as_others_write_them(data: Path, tmp_path: Path, kind: str) -> None:
    """Such as pandas' categories, and columns of nothing but nulls, which pyarrow infers where no value is."""
    path = tmp_path / "predictions.parquet"
    changed = {
        "null": {"answer": pa.nulls(1), "box": pa.nulls(1), "manipulation": pa.nulls(1)},
        "dictionary": {"answer": pa.array(["yes"]).dictionary_encode()},
        "view": {"answer": pa.array(["yes"], pa.string_view())},
    }[kind]
    parquet(path, **changed)
    (batch,) = open_submission(path).batches(replay=True, max_rows=1)
    assert batch.rows["answer"].to_pylist() == [None if kind == "null" else "yes"]
    assert batch.rows.schema.field("answer").type == pa.string()


@pytest.mark.slow
def test_a_header_may_be_in_the_metadata_of_the_file_alone(data: Path, tmp_path: Path) -> None:
    path = tmp_path / "predictions.parquet"
    with pq.ParquetWriter(path, pa.table(TABLE).schema) as writer:
        writer.write_table(pa.table(TABLE))
        writer.add_key_value_metadata({"remqa-submission": json.dumps(HEADER)})
    assert open_submission(path).header.track == "remqa"
