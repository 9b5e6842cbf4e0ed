"""What is said of buckets that cannot be spoken to; none is needed here."""

from datetime import timedelta
from pathlib import Path

import pytest

from remqa_data.errors import DatasetError, StorageError
from remqa_data.storage.backend import storage_at
from remqa_data.storage.bucket import Bucket
from remqa_data.storage.manifest import load_manifest


class Unreachable:
    def get_file_info(self, place: object) -> None:
        raise RuntimeError("no\nroute")


class NotInstalled:
    @staticmethod
    def from_uri(uri: str) -> None:
        raise ImportError("install it")


def test_whatever_a_filesystem_raises_is_one_line_that_names_the_place(monkeypatch: pytest.MonkeyPatch) -> None:
    bucket = Bucket("hf://datasets/a")
    monkeypatch.setitem(vars(bucket), "_opened", (Unreachable(), "datasets/a"))
    for ask in (lambda: bucket.exists("x"), lambda: bucket.read("x"), bucket.files):
        with pytest.raises(StorageError, match=r"^hf://datasets/a: no route; check the address"):
            ask()

    monkeypatch.setattr("pyarrow.fs.FileSystem", NotInstalled)
    with pytest.raises(StorageError, match=r"^hf://datasets/b: install it"):
        Bucket("hf://datasets/b").exists("x")


def test_google_is_not_asked_for_a_quarter_of_an_hour() -> None:
    bucket = Bucket("gs://bucket/prefix")
    (settings,) = bucket._system.__reduce__()[1]
    assert settings["retry_time_limit"] == timedelta(seconds=30)
    assert bucket._key("x") == "bucket/prefix/x"
    assert bucket.where("x") == "gs://bucket/prefix/x"


@pytest.mark.parametrize("root", ["file:///data/x", Path("file:///data/x"), "FILE:///data/x"])
def test_a_folder_is_given_by_its_path(root: str | Path) -> None:
    with pytest.raises(DatasetError, match=r"^file:///data/x: give the folder by its path, /data/x$"):
        storage_at(root)


def test_a_folder_of_this_machine_by_its_name_is_given_by_its_path_too() -> None:
    with pytest.raises(DatasetError, match=r"give the folder by its path, /data/x$"):
        storage_at("file://localhost/data/x")


@pytest.mark.parametrize("root", ["S3://bucket/prefix", Path("S3://bucket/prefix")])
def test_the_case_of_a_scheme_means_nothing(root: str | Path) -> None:
    storage = storage_at(root)
    assert isinstance(storage, Bucket)
    assert storage.root == "s3://bucket/prefix"


@pytest.mark.parametrize("root", ["memory://bucket/prefix", "http://bucket/prefix"])
def test_what_is_no_storage_is_told_with_those_that_are(root: str) -> None:
    with pytest.raises(StorageError, match=r"there is no such storage; .*s3://"):
        storage_at(root).exists("x")


def test_only_a_shell_knows_the_home_folder() -> None:
    with pytest.raises(DatasetError, match="~/none: no such folder; only a shell puts the home folder for ~"):
        load_manifest("~/none")
