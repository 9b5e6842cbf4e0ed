"""Every table of a real dataset, read by what people use beside this package."""

import io
from pathlib import Path

import numpy as np
import pytest

from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.tables.images import decode_instances
from remqa_data.tables.schema import TABLES, table_spec

pytestmark = pytest.mark.slow

NAMES = list(TABLES)


def paths(root: Path, table: str) -> list[str]:
    return [str(root / file.path) for file in load_manifest(root).files_of(table)]


@pytest.mark.parametrize("table", NAMES)
def test_duckdb_counts_the_rows_of_the_manifest(one_room, table) -> None:
    duckdb = pytest.importorskip("duckdb")
    rows = duckdb.from_parquet(paths(one_room, table)).fetchall()
    assert len(rows) == load_manifest(one_room).rows(table) > 0
    assert len(rows[0]) == len(table_spec(table).schema.names)


def test_duckdb_asks_into_lists_of_structs_as_the_rows_have_them(one_room) -> None:
    duckdb = pytest.importorskip("duckdb")
    files = paths(one_room, "frames")
    ((pixels,),) = duckdb.sql(
        f"select sum(thing.pixels) from (select unnest(objects) as thing from read_parquet({files}))"
    ).fetchall()
    objects = read_table(one_room, "frames", "test", ["objects"])["objects"].to_pylist()
    assert pixels == sum(thing["pixels"] for frame in objects for thing in frame)


@pytest.mark.parametrize("table", NAMES)
def test_polars_reads_what_we_read(one_room, table) -> None:
    polars = pytest.importorskip("polars")
    read = polars.read_parquet(paths(one_room, table))
    ours = read_table(one_room, table, "test")
    assert read.shape == ours.shape
    assert read.columns == ours.column_names
    key = ours.column_names[0]
    assert read[key].to_list() == ours[key].to_pylist()


@pytest.mark.parametrize("table", NAMES)
def test_hugging_face_loads_every_split_and_decodes_the_pictures(one_room, table, tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("HF_DATASETS_OFFLINE", "1")
    datasets = pytest.importorskip("datasets")
    manifest = load_manifest(one_room)
    assert manifest.splits(table) == ["test"]
    for split in manifest.splits(table):
        loaded = datasets.load_dataset(str(one_room), table, split=split, cache_dir=str(tmp_path))
        assert len(loaded) == manifest.rows(table, split)
        for column in table_spec(table).image_columns:
            stored = read_table(one_room, table, split, [column])[column][0].as_py()["bytes"]
            picture = np.asarray(loaded[0][column])
            if picture.dtype == np.uint8:  # rgb
                from PIL import Image

                assert np.array_equal(picture, np.asarray(Image.open(io.BytesIO(stored))))
            else:
                assert np.array_equal(picture, decode_instances(stored))


@pytest.mark.parametrize("table", NAMES)
def test_croissant_yields_the_rows_of_every_table(one_room, table) -> None:
    mlcroissant = pytest.importorskip("mlcroissant")
    records = list(mlcroissant.Dataset(jsonld=str(one_room / "croissant.json")).records(table))
    assert len(records) == load_manifest(one_room).rows(table)
