"""A manifest may come from anywhere: it names files of the dataset, each once, and nothing else."""

import json
from importlib import metadata, resources
from pathlib import Path
from typing import Any

import pytest

from remqa_data.errors import DamagedShardError, DatasetError
from remqa_data.storage import manifest
from remqa_data.storage.manifest import (
    MANIFEST,
    VERSIONED,
    load_manifest,
    make_manifest,
    templates_sha256,
    version_here,
    versions_here,
    versions_of,
)
from remqa_data.storage.shards import read_table
from remqa_data.version import TEMPLATES_SHA256, __version__


def told(dataset: Path, **changes: Any) -> Path:
    """The dataset with a manifest that says something else of its first file."""
    path = dataset / MANIFEST
    stored = json.loads(path.read_text())
    stored["files"][0].update(changes)
    path.write_text(json.dumps(stored))
    return dataset


@pytest.mark.parametrize(
    "path",
    [
        "../scenes/train-00000-of-00002.parquet",
        "scenes/../../train-00000-of-00002.parquet",
        "scenes/../train-00000-of-00002.parquet",
        "/etc/passwd",
        "//host/share/train.parquet",
        "C:/train.parquet",
        "scenes\\train-00000-of-00002.parquet",
        "s3://bucket/train.parquet",
        "scenes/.hidden.parquet",
        "scenes/..",
        "scenes/",
        "scenes",
        "",
        ".",
        "frames/train-00000-of-00002.parquet",
        "scenes/train\n.parquet",
        "scenes/train\x00.parquet",
        "scenes/" + "a" * 300 + "/x.parquet",
    ],
)
def test_a_path_that_leads_elsewhere_is_refused_wherever_a_dataset_is_read(dataset: Path, path: str) -> None:
    told(dataset, path=path)
    with pytest.raises(DatasetError, match=r"files\.0\.path"):
        load_manifest(dataset)
    with pytest.raises(DatasetError, match=r"files\.0\.path"):
        read_table(dataset, "questions", "train")


def test_a_file_is_no_dataset(dataset: Path) -> None:
    with pytest.raises(DatasetError, match=rf"{MANIFEST} is a file; give the folder of a dataset"):
        load_manifest(dataset / MANIFEST)


@pytest.mark.parametrize("sha256", ["", "0" * 63, "G" * 64, "../" * 21 + "x", "A" * 64])
def test_a_checksum_that_is_none_is_refused(dataset: Path, sha256: str) -> None:
    """A shard of a bucket is kept under its checksum, so this is a name of a file too."""
    with pytest.raises(DatasetError, match=r"files\.0\.sha256"):
        load_manifest(told(dataset, sha256=sha256))


def test_a_file_that_is_listed_twice_is_refused(dataset: Path) -> None:
    second = load_manifest(dataset).files[1].path
    with pytest.raises(DatasetError, match=f"{second} is listed 2 times"):
        load_manifest(told(dataset, path=second))


def test_a_file_of_another_number_of_rows_is_refused(dataset: Path) -> None:
    table, split = (getattr(load_manifest(dataset).files[0], name) for name in ("table", "split"))
    with pytest.raises(DamagedShardError, match="rows; the manifest says 99"):
        read_table(told(dataset, rows=99), table, split)


def test_a_format_to_come_is_called_so_whatever_its_keys_are(tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text('{"format_version": 3, "versions": {"remqa-data": "2.0.0"}, "shards": []}')
    with pytest.raises(DatasetError, match=r"format version 3; this package reads 2; .* that made it \(2\.0\.0\)"):
        load_manifest(tmp_path)


def test_opencv_may_be_of_another_package(monkeypatch: pytest.MonkeyPatch) -> None:
    known = metadata.version

    def version(package: str) -> str:
        if package == "opencv-python-headless":
            raise metadata.PackageNotFoundError(package)
        return known(package)

    monkeypatch.setattr(metadata, "version", version)
    versions = make_manifest(seed=0, config={}, files=(), questions={}, refused={}).versions
    assert known("opencv-python-headless").startswith(versions["opencv-python-headless"])
    assert versions["numpy"] == known("numpy")
    assert versions_of(["opencv-python-headless"])["opencv-python-headless"] == versions["opencv-python-headless"]


def test_templates_are_those_of_the_version(monkeypatch: pytest.MonkeyPatch) -> None:
    told = "templates/ was edited: put its checksum into remqa_data/version.py, and say in CHANGELOG.md whether bytes change"
    assert templates_sha256() == TEMPLATES_SHA256, told
    assert version_here() == versions_here()["remqa-data"] == __version__
    monkeypatch.setattr(manifest, "templates_sha256", lambda: "0c1f5a3b9d")
    assert version_here() == versions_here()["remqa-data"] == f"{__version__}+templates.0c1f5a3b"
    assert list(versions_here()) == ["remqa-data", "python", *VERSIONED]


def test_the_checksum_of_all_templates_follows_any_of_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shipped = manifest.templates_sha256()
    for file in resources.files("remqa_data.templates").iterdir():
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    monkeypatch.setattr(manifest.resources, "files", lambda package: tmp_path)
    assert manifest.templates_sha256() == shipped
    (tmp_path / "placements.csv").write_bytes((tmp_path / "placements.csv").read_bytes() + b"\n")
    assert manifest.templates_sha256() != shipped
