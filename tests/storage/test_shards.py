import json
import multiprocessing
import os
import pickle
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import DamagedShardError, DatasetError, UnknownNameError
from remqa_data.files import sha256_of
from remqa_data.storage.backend import storage_at
from remqa_data.storage.card import croissant, dataset_card
from remqa_data.storage.manifest import MANIFEST, config_hash, load_manifest
from remqa_data.storage.ownership import mark
from remqa_data.storage.shards import Shard, ShardWriter, check_files, file_info, find_damage, read_rows, read_table
from remqa_data.tables.rows import ExpressionRow, FrameRow, QuestionRow, SceneRow
from remqa_data.tables.schema import TABLES, check_schema, to_table
from remqa_data.version import RELEASED, __version__
from tests.helpers.damaged_files import files_of, flip, read_shard_with_flipped_footers
from tests.helpers.dataset_rows import frame_row, images, scene_rows

# ---- writing


def test_the_folder_holds_what_the_design_says(finished) -> None:
    names = set(files_of(finished[0]))
    assert {"README.md", "croissant.json", "manifest.json"} < names
    assert "questions/train-00000-of-00002.parquet" in names
    assert not any(".parts" in name for name in names)


def test_the_bytes_of_a_shard_do_not_depend_on_how_rows_are_handed_over(tmp_path) -> None:
    rows = [frame_row("K", "train", i) for i in range(30)]
    with ShardWriter(tmp_path / "one.parquet", "frames") as writer:
        writer.write_rows(rows)
    with ShardWriter(tmp_path / "many.parquet", "frames") as writer:
        for start in range(0, 30, 7):
            writer.write_table(to_table(FrameRow, rows[start : start + 7]))
    assert sha256_of(tmp_path / "one.parquet") == sha256_of(tmp_path / "many.parquet")


def test_rows_come_back_in_the_order_of_the_scenes(finished) -> None:
    root = finished[0]
    expected = [row for scene in ("Kitchen1", "Kitchen2") for row in scene_rows(scene, "train")["questions"]]
    assert list(read_rows(root, QuestionRow, "train")) == expected
    assert list(read_rows(root, SceneRow, "test")) == scene_rows("Kitchen3", "test")["scenes"]
    assert [row.scene for row in read_rows(root, ExpressionRow, "val")] == ["Kitchen2"] * 5


def test_rows_are_found_by_the_values_of_columns(finished) -> None:
    root = finished[0]
    wanted = list(read_rows(root, FrameRow, "train"))[6]
    found = read_rows(root, FrameRow, "train", scene=wanted.scene, frame_id=wanted.frame_id)
    assert list(found) == [wanted]
    assert list(read_rows(root, FrameRow, "train", scene="Kitchen1", frame_id="none")) == []


def test_row_groups_that_follow_each_other_are_read_as_one(finished) -> None:
    root, manifest = finished
    (info,) = manifest.files_of("frames", "train")[:1]
    shard = Shard(root / info.path, "frames")
    assert shard.row_groups > 3
    assert shard.read([1, 2]) == pa.concat_tables([shard.read(1), shard.read(2)])
    assert shard.read() == shard.read(range(shard.row_groups))


def test_row_groups_are_small_where_rows_hold_images_and_images_are_not_compressed_again(finished) -> None:
    about = pq.read_metadata(finished[0] / "frames/train-00000-of-00002.parquet")
    assert [about.row_group(i).num_rows for i in range(about.num_row_groups)] == [4, 4, 4, 4, 4, 1]
    codec = {
        about.row_group(0).column(i).path_in_schema: about.row_group(0).column(i).compression
        for i in range(about.num_columns)
    }
    assert {path for path, name in codec.items() if name == "UNCOMPRESSED"} == {
        "rgb.bytes",
        "depth.bytes",
        "instances.bytes",
    }
    assert set(codec.values()) == {"UNCOMPRESSED", "ZSTD"}


def test_a_shard_is_not_seen_before_it_is_whole_and_not_at_all_after_an_error(tmp_path) -> None:
    path = tmp_path / "new" / "train.parquet"
    with pytest.raises(RuntimeError, match="stop"), ShardWriter(path, "frames") as writer:  # noqa: PT012
        writer.write_rows([frame_row("K", "train", i) for i in range(9)])
        assert not path.exists()
        raise RuntimeError("stop")
    assert list(path.parent.iterdir()) == []


# ---- manifest


def test_the_manifest_says_what_there_is(finished) -> None:
    root, manifest = finished
    assert load_manifest(root) == manifest
    assert manifest.questions == {
        "train": {"COUNTING": 6, "EXISTENCE": 8, "SPATIAL": 6},
        "test": {"COUNTING": 3, "EXISTENCE": 4, "SPATIAL": 3},
    }
    assert manifest.rows("frames") == 63
    assert manifest.splits("expressions") == ["train", "val", "test"]
    assert manifest.refused == {"not unique": 3}
    assert {"remqa-data", "python", "pyarrow", "pybullet"} <= set(manifest.versions)
    assert manifest.files
    for file in manifest.files:
        assert (root / file.path).stat().st_size == file.bytes


def test_the_hash_of_a_configuration_is_that_of_its_canonical_json() -> None:
    # printf '{"a":{"c":2},"b":1}' | sha256sum
    assert config_hash({"b": 1, "a": {"c": 2}}) == "5bd51451a14f74f6b4db3cbca26bae0debe6d5905a3bc15a92852f3da604f001"
    assert config_hash({"b": 2, "a": {"c": 2}}) != config_hash({"b": 1, "a": {"c": 2}})


def test_a_folder_without_a_manifest_is_not_a_dataset(dataset) -> None:
    (dataset / MANIFEST).unlink()
    with pytest.raises(DatasetError, match=r"it has no manifest\.json; give the folder of a dataset"):
        read_table(dataset, "questions", "train")
    mark(storage_at(dataset))
    with pytest.raises(DatasetError, match=r"not a finished dataset: it has no manifest\.json; .*--resume"):
        read_table(dataset, "questions", "train")


def test_a_folder_that_is_not_there_is_named(tmp_path) -> None:
    with pytest.raises(DatasetError, match="nowhere: no such folder"):
        load_manifest(tmp_path / "nowhere")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "the whole text"),
        ('{"seed": 0}', "config: Field required"),
        ({"format_version": 99}, "format version 99; this package reads 2; generate the dataset again"),
        ({"format_version": 1}, "format version 1; this package reads 2; generate the dataset again"),
    ],
)
def test_a_manifest_that_cannot_be_read_says_where(dataset, text, message) -> None:
    path = dataset / MANIFEST
    path.write_text(text if isinstance(text, str) else json.dumps(json.loads(path.read_text()) | text))
    with pytest.raises(DatasetError, match=message):
        load_manifest(dataset)


# ---- reading


def test_columns_and_splits_can_be_chosen(finished) -> None:
    table = read_table(finished[0], "questions", "test", ["question_id", "answer"])
    assert table.column_names == ["question_id", "answer"]
    assert table.num_rows == 10
    with pytest.raises(DatasetError, match="questions has no split 'val'; it has: train, test"):
        read_table(finished[0], "questions", "val")
    with pytest.raises(UnknownNameError, match="'questions'"):
        read_table(finished[0], "question", "train")


def test_pandas_reads_a_folder_without_our_code(finished) -> None:
    data = pd.read_parquet(finished[0] / "questions")
    assert len(data) == 30
    assert set(data["answer"]) == {"yes", "2", "no"}
    assert data["start_rgb"][0]["bytes"] == images(0)[0].bytes


def test_the_schema_and_its_documentation_are_in_the_files(finished) -> None:
    schema = pq.read_schema(finished[0] / "frames/test-00000-of-00002.parquet")
    check_schema("frames", schema)
    assert schema.metadata[b"huggingface"] == TABLES["frames"].schema.metadata[b"huggingface"]
    assert schema.field("depth").metadata[b"unit"] == b"mm"


# ---- damage


def chunk_of(path: Path, column: str, group: int) -> tuple[int, int]:
    """Where a column's data lies in a file: offset and length."""
    about = pq.read_metadata(path).row_group(group)
    chunk = next(about.column(i) for i in range(about.num_columns) if about.column(i).path_in_schema == column)
    start = chunk.dictionary_page_offset or chunk.data_page_offset
    return start, chunk.total_compressed_size


@pytest.mark.parametrize(
    ("column", "shown"),
    [
        ("rgb.bytes", "rgb.bytes"),
        ("objects.list.element.box.list.element", "objects[].box[]"),
        ("frame_id", "frame_id"),
    ],
)
def test_a_flipped_byte_is_told_by_file_row_group_and_column(dataset, column, shown) -> None:
    path = dataset / "frames" / "train-00001-of-00002.parquet"
    start, size = chunk_of(path, column, 1)
    flip(path, start + size - 3)
    expected = f"damaged shard: {path}, row group 1, column {shown}: "
    with pytest.raises(DamagedShardError, match=re.escape(expected)) as caught:
        check_files(dataset)
    assert (caught.value.row_group, caught.value.column) == (1, shown)
    with pytest.raises(DamagedShardError, match=re.escape(expected)):
        read_table(dataset, "frames", "train")


def test_every_flipped_byte_is_found(dataset) -> None:
    path = dataset / "questions" / "test-00000-of-00002.parquet"
    file = next(f for f in load_manifest(dataset).files if dataset / f.path == path)
    whole = path.read_bytes()
    for place in np.random.default_rng(0).integers(0, len(whole), 40):
        flip(path, int(place))
        assert find_damage(dataset, file) is not None, place
        path.write_bytes(whole)
    assert find_damage(dataset, file) is None


@pytest.mark.slow
def test_no_flipped_bit_of_a_footer_ends_the_process(dataset) -> None:
    """pyarrow does, when it is asked what a row group says of a column whose sizes do not fit the schema."""
    arguments = dataset, "scenes", 250
    reading = multiprocessing.get_context("spawn").Process(target=read_shard_with_flipped_footers, args=arguments)
    reading.start()
    reading.join()
    assert reading.exitcode == 0


def test_a_file_that_is_cut_off_is_told(dataset) -> None:
    path = dataset / "scenes" / "test-00000-of-00002.parquet"
    whole = path.read_bytes()
    path.write_bytes(whole[:1000])
    for reading in (lambda: check_files(dataset), lambda: read_table(dataset, "scenes", "test")):
        with pytest.raises(DamagedShardError, match=rf"it has 1,000 bytes; the manifest says {len(whole):,}"):
            reading()
    with pytest.raises(DamagedShardError, match="footer cannot be read"):
        Shard(path, "scenes")


def test_a_shard_of_another_split_is_told(dataset) -> None:
    shutil.copyfile(
        dataset / "questions/test-00000-of-00002.parquet", dataset / "questions/train-00001-of-00002.parquet"
    )
    for reading in (
        lambda: read_table(dataset, "questions", "train"),
        lambda: list(read_rows(dataset, QuestionRow, "train")),
        lambda: SplitReader(dataset, "questions", "train"),
    ):
        with pytest.raises(DamagedShardError, match=r"train-00001.*bytes; the manifest says"):
            reading()


def test_a_file_that_is_missing_is_told(dataset) -> None:
    (dataset / "scenes" / "test-00000-of-00002.parquet").unlink()
    for reading in (lambda: check_files(dataset), lambda: read_table(dataset, "scenes", "test")):
        with pytest.raises(DamagedShardError, match=r"test-00000-of-00002\.parquet: the file is missing"):
            reading()


@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo, lambda path: path.symlink_to("nowhere")])
def test_what_is_no_file_is_told(dataset, make) -> None:
    path = dataset / "scenes" / "test-00000-of-00002.parquet"
    path.unlink()
    make(path)
    with pytest.raises(DamagedShardError, match=r"test-00000-of-00002\.parquet: this is no file"):
        check_files(dataset)


def test_a_file_of_another_table_is_told(dataset) -> None:
    manifest = load_manifest(dataset)
    path = dataset / "frames" / "test-00000-of-00002.parquet"
    shutil.copyfile(dataset / "questions" / "test-00000-of-00002.parquet", path)
    file = next(f for f in manifest.files if dataset / f.path == path)
    damage = find_damage(dataset, replace(file, bytes=path.stat().st_size))
    assert damage is not None
    assert "column frame_id is missing" in str(damage)


def test_a_whole_dataset_passes(finished) -> None:
    check_files(finished[0])


def test_a_damage_error_survives_pickling() -> None:
    error = DamagedShardError("a.parquet", "torn", 3, "rgb.bytes")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert again.row_group == 3


# ---- card


def test_the_card_names_the_files_of_every_table_and_split(finished) -> None:
    root, manifest = finished
    front = yaml.safe_load(dataset_card(manifest).split("---\n")[1])
    assert front["license"] == "apache-2.0"
    assert [config["config_name"] for config in front["configs"]] == list(TABLES)
    assert [config["config_name"] for config in front["configs"] if config.get("default")] == ["questions"]
    named = {
        path.relative_to(root).as_posix()
        for config in front["configs"]
        for entry in config["data_files"]
        for path in root.glob(entry["path"])
    }
    assert named == {file.path for file in manifest.files}


def test_the_card_tells_every_field_the_counts_and_where_it_comes_from(finished) -> None:
    text = (finished[0] / "README.md").read_text()
    for spec in TABLES.values():
        assert all(f"| `{name}` |" in text for name in spec.schema.names)
    assert "| train | 6 | 8 | 6 |" in text
    assert "procthor" in text
    assert (
        "| `depth` | image | Depth along the camera's forward axis, 16-bit PNG, 0 where nothing is seen. (mm) |" in text
    )


def test_croissant_refers_only_to_what_it_defines(finished) -> None:
    # mlcroissant 1.1.1 loaded such a file and read records of all four tables, lists of structs too, by hand.
    root, manifest = finished
    stored = json.loads((root / "croissant.json").read_text())
    assert stored == croissant(manifest)
    assert stored["conformsTo"] == "http://mlcommons.org/croissant/1.0"
    objects = {entry["@id"]: entry for entry in stored["distribution"]}
    assert manifest.files
    for file in manifest.files:
        assert objects[file.path]["sha256"] == file.sha256
    assert stored["recordSet"]
    for records in stored["recordSet"]:
        fields = [leaf for field in records["field"] for leaf in field.get("subField", [field])]
        assert fields
        for field in fields:
            assert field["@id"].startswith(records["@id"] + "/")
            assert field["source"]["fileSet"]["@id"] in objects
            assert field["source"]["extract"]["column"] in TABLES[records["@id"]].schema.names


def test_croissant_has_every_column_lists_of_structs_with_their_fields(finished) -> None:
    by_name = {records["name"]: records for records in croissant(finished[1])["recordSet"]}
    for name, spec in TABLES.items():
        columns = {field["@id"].split("/")[1] for field in by_name[name]["field"]}
        assert columns == set(spec.schema.names)
    fields = {field["@id"]: field for field in by_name["questions"]["field"]}
    goals = fields["questions/goal_poses"]
    assert goals["repeated"] is True
    assert "source" not in goals
    yaw = next(field for field in goals["subField"] if field["@id"] == "questions/goal_poses/yaw_deg")
    assert yaw["dataType"] == "sc:Float"
    assert yaw["source"]["extract"]["column"] == "goal_poses"
    assert yaw["source"]["transform"] == {"jsonPath": "yaw_deg"}
    voxels = next(field for field in by_name["scenes"]["field"] if field["@id"] == "scenes/semantic_map/voxels")
    assert [field["name"].rpartition("/")[2] for field in voxels["subField"]] == ["x", "y", "z", "label"]
    # A list inside a struct: first the list, then of each of its items the number.
    assert voxels["subField"][0]["source"]["transform"] == [{"jsonPath": "voxels"}, {"jsonPath": "x"}]


def test_the_card_and_croissant_say_how_to_cite_and_no_clock_is_asked(finished) -> None:
    _, manifest = finished
    stored = croissant(manifest)
    assert "2210.02709" in stored["citeAs"]
    assert stored["datePublished"] == RELEASED
    assert stored["citeAs"] in dataset_card(manifest)
    changelog = (Path(__file__).parents[2] / "CHANGELOG.md").read_text(encoding="utf-8")
    dates = re.findall(rf"^## \[{re.escape(__version__)}\] - (\S+)", changelog, re.MULTILINE)
    assert dates in ([], [RELEASED])  # of a released version: the day that the changelog names


@pytest.mark.parametrize(
    ("rows", "category"),
    [(999, "n<1K"), (1_000, "1K<n<10K"), (4_072, "1K<n<10K"), (40_000, "10K<n<100K"), (10**7, "n>1M")],
)
def test_the_card_tells_the_size_in_hugging_faces_words(finished, rows: int, category: str) -> None:
    one = next(file for file in finished[1].files if file.table == "questions")
    manifest = replace(finished[1], files=(replace(one, rows=rows),))
    assert yaml.safe_load(dataset_card(manifest).split("---\n")[1])["size_categories"] == [category]


def test_a_name_with_a_colon_is_a_folder_and_no_address(finished, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = read_table(finished[0], "scenes", "train")
    for name in ("run:2", "s3:x", "file:x"):
        place = Path(name) / "scenes.parquet"
        with ShardWriter(place, "scenes") as writer:
            writer.write_table(rows)
        assert file_info(place, place.name, "scenes", "train").rows == rows.num_rows
        assert Shard(place, "scenes").read().equals(rows)
        shutil.copytree(finished[0], Path(name) / "dataset")
        assert read_table(Path(name) / "dataset", "scenes", "train").equals(rows)
