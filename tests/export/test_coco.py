"""What pycocotools, and code for RefCOCO, find in the files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from remqa_data.catalog import catalog
from remqa_data.errors import DatasetError, OutputError
from remqa_data.export import coco
from remqa_data.export.coco import Written, write_coco
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows
from remqa_data.tables.images import decode_instances
from remqa_data.tables.rows import ExpressionRow, FrameRow

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def written(one_room, tmp_path_factory) -> tuple[Path, Written]:
    out = tmp_path_factory.mktemp("coco")
    return out, write_coco(one_room, out)


@pytest.fixture(scope="module")
def loaded(written):
    api = pytest.importorskip("pycocotools.coco")
    return api.COCO(str(written[0] / "annotations" / "instances_test.json"))


def refs_of(written) -> list[dict]:
    return json.loads((written[0] / "annotations" / "refs_test.json").read_text())


def test_pycocotools_decodes_exactly_the_pixels_and_boxes_of_the_rows(one_room, loaded) -> None:
    frames = {frame.frame_id: frame for frame in read_rows(one_room, FrameRow, "test")}
    assert len(loaded.imgs) == len(frames) > 0
    for image in loaded.imgs.values():
        frame = frames[image["frame_id"]]
        instances = decode_instances(frame.instances.bytes)
        assert (image["height"], image["width"]) == instances.shape
        annotations = loaded.imgToAnns[image["id"]]
        assert [annotation["object_id"] for annotation in annotations] == [thing.id for thing in frame.objects]
        for number, (annotation, thing) in enumerate(zip(annotations, frame.objects, strict=True), start=1):
            mask = loaded.annToMask(annotation)
            assert np.array_equal(mask, instances == number)
            assert annotation["area"] == thing.pixels == mask.sum()
            x, y, width, height = annotation["bbox"]
            assert (x, y, x + width, y + height) == thing.box_2d
            assert loaded.cats[annotation["category_id"]]["name"] == thing.type


def test_categories_are_in_the_catalogs_order(loaded) -> None:
    assert [loaded.cats[number]["name"] for number in range(1, len(loaded.cats) + 1)] == list(catalog())


def test_counts_are_the_manifests(one_room, written, loaded) -> None:
    manifest, counts = load_manifest(one_room), written[1]
    assert counts.images == manifest.rows("frames") == len(loaded.imgs)
    assert counts.annotations == len(loaded.anns)
    assert counts.sentences == manifest.rows("expressions")
    assert counts.refs == len(refs_of(written))


def test_pictures_are_the_rows_own_bytes(one_room, written, loaded) -> None:
    frames = {frame.frame_id: frame for frame in read_rows(one_room, FrameRow, "test")}
    assert len(loaded.imgs) == len(frames) > 0
    for image in loaded.imgs.values():
        path = written[0] / "images" / "test" / image["file_name"]
        assert path.read_bytes() == frames[image["frame_id"]].rgb.bytes


def test_every_expression_is_a_sentence_of_the_object_that_it_means(one_room, written, loaded) -> None:
    rows = {row.expression_id: row for row in read_rows(one_room, ExpressionRow, "test")}
    seen = []
    for ref in refs_of(written):
        annotation = loaded.anns[ref["ann_id"]]
        assert (ref["image_id"], ref["category_id"]) == (annotation["image_id"], annotation["category_id"])
        assert ref["file_name"] == loaded.imgs[ref["image_id"]]["file_name"]
        assert ref["sent_ids"] == [sentence["sent_id"] for sentence in ref["sentences"]]
        for sentence in ref["sentences"]:
            row = rows[sentence["expression_id"]]
            seen.append(row.expression_id)
            assert (row.frame_id, row.target_id) == (loaded.imgs[ref["image_id"]]["frame_id"], annotation["object_id"])
            assert sentence["raw"] == row.text
            assert " ".join(sentence["tokens"]) == sentence["sent"] == row.text.lower()
            x, y, width, height = annotation["bbox"]
            assert (x, y, x + width, y + height) == row.box_2d
    assert rows
    assert sorted(seen) == sorted(rows)


def test_ids_go_on_through_all_splits(two_rooms, tmp_path) -> None:
    write_coco(two_rooms, tmp_path, with_images=False)
    files = [
        json.loads((tmp_path / "annotations" / f"instances_{split}.json").read_text()) for split in ("train", "test")
    ]
    for table in ("images", "annotations"):
        ids = [entry["id"] for file in files for entry in file[table]]
        assert ids == list(range(1, len(ids) + 1))
    assert not (tmp_path / "images").exists()


def test_an_expression_about_what_its_frame_does_not_show_is_refused_by_name(one_room, tmp_path, monkeypatch) -> None:
    real = coco.read_rows

    def without_objects(root, row_type, split):
        for row in real(root, row_type, split):
            yield replace(row, objects=()) if row_type is FrameRow else row

    monkeypatch.setattr(coco, "read_rows", without_objects)
    with pytest.raises(DatasetError, match=r"expression .*: frame .* does not show its target"):
        write_coco(one_room, tmp_path)


def test_a_frame_that_is_there_twice_is_refused_by_name(one_room, tmp_path, monkeypatch) -> None:
    real = coco.read_rows
    monkeypatch.setattr(coco, "read_rows", lambda *wanted: (row for row in real(*wanted) for _ in range(2)))
    with pytest.raises(DatasetError, match=r"frame \S+ is there twice"):
        write_coco(one_room, tmp_path)


def test_expressions_of_val_are_about_pictures_of_train(finished, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(coco, "object_type", lambda name: catalog()["Mug"])  # these rows have types of their own
    written = write_coco(finished[0], tmp_path, with_images=False)
    assert written.sentences == load_manifest(finished[0]).rows("expressions")
    refs = json.loads((tmp_path / "annotations" / "refs_val.json").read_text())
    train = json.loads((tmp_path / "annotations" / "instances_train.json").read_text())
    annotations = {entry["id"]: entry for entry in train["annotations"]}
    assert len(refs) > 0
    assert all(annotations[ref["ann_id"]]["image_id"] == ref["image_id"] for ref in refs)


def test_a_bucket_is_no_folder_to_write_into(finished) -> None:
    with pytest.raises(OutputError, match="give a folder of this machine"):
        write_coco(finished[0], Path("s3://bucket/coco"))


def test_the_dataset_itself_is_not_written_into(finished) -> None:
    for out in (finished[0], finished[0] / "coco"):
        with pytest.raises(OutputError, match="which holds nothing else; give another place"):
            write_coco(finished[0], out)
        assert not (finished[0] / "coco").exists()
