"""What is said of buckets that cannot be spoken to; none is needed here."""

from datetime import timedelta
from pathlib import Path

import pytest

from remqa_data.errors import DatasetError, StorageError
from remqa_data.storage.backend import storage_at
from remqa_data.storage.bucket import Bucket


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


@pytest.mark.parametrize("root", ["file:///data/x", Path("file:///data/x")])
def test_a_folder_is_given_by_its_path(root: str | Path) -> None:
    with pytest.raises(DatasetError, match=r"^file:///data/x: give the folder by its path, /data/x$"):
        storage_at(root)
