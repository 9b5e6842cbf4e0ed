from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.errors import DamagedPartError, DatasetError, SchemaError
from remqa_data.storage.manifest import FileInfo, load_manifest
from remqa_data.storage.ownership import SPLITS
from remqa_data.storage.parts import Part, Parts, assemble, tidy
from tests.helpers.damaged_files import files_of, flip
from tests.helpers.dataset_rows import frame_row, question_row, write_dataset


@pytest.mark.slow
@pytest.mark.parametrize("order", [("Kitchen1", "Kitchen2", "Kitchen3"), ("Kitchen3", "Kitchen1", "Kitchen2")])
def test_the_bytes_do_not_depend_on_the_order_in_which_scenes_finish(finished, tmp_path, order) -> None:
    write_dataset(tmp_path, order)
    assert files_of(tmp_path) == files_of(finished[0])


def test_a_split_is_divided_evenly_and_never_into_empty_files(tmp_path) -> None:
    parts = Parts(tmp_path, {})
    rows = [frame_row("A", "train", i) for i in range(7)]
    part = parts.write("A", {"frames": rows, "questions": [question_row("A", "train", 0)]})
    files = assemble(parts, [part], {**dict.fromkeys(SPLITS, 1), "train": 3})
    assert [(f.path, f.rows) for f in files] == [
        ("frames/train-00000-of-00003.parquet", 2),
        ("frames/train-00001-of-00003.parquet", 2),
        ("frames/train-00002-of-00003.parquet", 3),
        ("questions/train-00000-of-00001.parquet", 1),
    ]


def test_a_row_that_does_not_fit_leaves_no_part(tmp_path) -> None:
    parts = Parts(tmp_path, {})
    wrong = replace(question_row("A", "train", 0), answer=None)
    with pytest.raises(SchemaError, match="questions: row 0: answer"):
        parts.write("A", {"frames": [frame_row("A", "train", 0)], "questions": [wrong]})
    assert parts.finished() == {}


def test_a_run_goes_on_with_the_scenes_that_are_finished(tmp_path) -> None:
    parts = Parts(tmp_path, {"seed": 0})
    assert parts.finished() == {}
    part = parts.write("B", {"frames": [frame_row("B", "train", 0)]}, {"refused": {"blocked": 2}})
    assert part.report == {"refused": {"blocked": 2}}
    assert Parts(tmp_path, {"seed": 0}).finished() == {"B": part}
    with pytest.raises(DatasetError, match=r"another run.*--overwrite"):
        Parts(tmp_path, {"seed": 1}).finished()


def test_a_scene_can_be_written_again(tmp_path) -> None:
    parts = Parts(tmp_path, {})
    for count in (3, 1):
        parts.write("A", {"frames": [frame_row("A", "train", i) for i in range(count)]})
    assert [file.rows for file in assemble(parts, [parts.finished()["A"]], 1)] == [1]


@pytest.mark.parametrize("size", [0, 1000, -1])
def test_a_part_that_is_not_as_it_was_written_is_told_and_made_again(tmp_path, size) -> None:
    parts = Parts(tmp_path, {})
    made = [parts.write(scene, {"frames": [frame_row(scene, "train", 0)]}) for scene in "AB"]
    path = tmp_path / made[1].files[0].path
    if size < 0:
        flip(path, path.stat().st_size // 2)
    else:
        path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(
        DamagedPartError, match=r"frames\.train\.parquet is not as it was written; .*--resume.* B again"
    ):
        assemble(parts, made, 1)
    assert list(parts.finished()) == ["A"]
    assert not list((tmp_path / "frames").iterdir())


def test_a_part_whose_note_is_damaged_is_made_again(tmp_path) -> None:
    parts = Parts(tmp_path, {})
    for scene in "AB":
        parts.write(scene, {"frames": [frame_row(scene, "train", 0)]}, {"refused": {"blocked": 2}})
    (note,) = tmp_path.glob(".parts/*/B/part.json")
    flip(note, note.read_bytes().index(b"blocked"))
    assert list(parts.finished()) == ["A"]


@given(st.lists(st.integers(0, 30), min_size=1, max_size=8), st.integers(1, 9))
def test_shards_hold_every_row_once_in_order(rows: list[int], wanted: int) -> None:
    made = [
        Part(str(n), (FileInfo(f"{n}.parquet", "frames", "train", count, 1, ""),), {}, {})
        for n, count in enumerate(rows)
        if count
    ]
    jobs = Parts("nowhere", {}).shard_jobs(made, wanted)
    held = [
        (piece.scene, row)
        for job in jobs
        for piece in job.pieces
        for row in range(piece.first, piece.first + piece.rows)
    ]
    assert held == [(part.scene, row) for part in made for row in range(part.files[0].rows)]
    sizes = [sum(piece.rows for piece in job.pieces) for job in jobs]
    assert len(sizes) == min(wanted, sum(rows))
    assert not sizes or max(sizes) - min(sizes) <= 1


def test_a_shard_of_another_run_is_told_before_the_manifest_is_written(tmp_path) -> None:
    parts = Parts(tmp_path, {})
    files = assemble(parts, [parts.write("A", {"frames": [frame_row("A", "train", 0)]})], 1)
    (tmp_path / files[0].path).write_bytes(b"of a machine that was thought to be dead")
    with pytest.raises(DatasetError, match=r"00001\.parquet was written by another run meanwhile; .*--resume"):
        tidy(parts.storage, files)


def test_writing_over_a_dataset_leaves_nothing_of_it_and_does_not_look_finished(dataset) -> None:
    parts = Parts(dataset, {"seed": 9})
    leftover = dataset / "frames" / ".train-00000-of-00001.0123456789ab.parquet"  # of a killed process
    leftover.touch()
    assemble(parts, [parts.write("A", {"frames": [frame_row("A", "train", 0)]})], 1)
    assert [path.name for path in dataset.rglob("*.parquet") if ".parts" not in path.parts] == [
        "train-00000-of-00001.parquet"
    ]
    with pytest.raises(DatasetError, match="not a finished dataset"):
        load_manifest(dataset)
