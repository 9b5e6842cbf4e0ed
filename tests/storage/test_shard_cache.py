"""Where shards of a bucket are kept, and what is said where they cannot be."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from remqa_data.errors import DamagedShardError, OutputError
from remqa_data.files import sha256_of
from remqa_data.storage import shard_cache
from remqa_data.storage.manifest import FileInfo, Manifest
from remqa_data.storage.shard_cache import local_shard, stored_shard
from remqa_data.storage.shards import Shard


@pytest.fixture
def shard(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FileInfo:
    """A file of a place that is no folder of this machine."""
    path = tmp_path / "bucket" / "rows.parquet"
    path.parent.mkdir()
    path.write_bytes(b"rows")

    class Elsewhere:
        @contextmanager
        def fetch(self, name: str) -> Iterator[Path]:
            if not (path.parent / name).is_file():
                raise FileNotFoundError(name)
            yield path.parent / name

        def where(self, name: str = "") -> str:
            return f"s3://bucket/{name}"

    monkeypatch.setattr(shard_cache, "storage_at", lambda root: Elsewhere())
    return FileInfo("rows.parquet", "scenes", "train", 1, 4, sha256_of(path))


def test_it_is_fetched_once(shard: FileInfo, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path / "kept"))
    cached = local_shard("s3://bucket", shard)
    assert cached.read_bytes() == b"rows"
    assert cached.is_relative_to(tmp_path / "kept")
    (tmp_path / "bucket" / "rows.parquet").unlink()
    assert local_shard("s3://bucket", shard) == cached
    cached.unlink()
    with pytest.raises(DamagedShardError, match=r"s3://bucket/rows\.parquet: the file is missing"):
        local_shard("s3://bucket", shard)


def test_what_lies_in_the_bucket_is_checked_and_takes_the_place_of_the_copy(
    shard: FileInfo, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path / "kept"))
    cached = local_shard("s3://bucket", shard)
    cached.write_bytes(b"swor")
    assert stored_shard("s3://bucket", shard).read_bytes() == b"rows"
    (tmp_path / "bucket" / "rows.parquet").write_bytes(b"swor")
    with pytest.raises(DamagedShardError, match=r"s3://bucket/rows\.parquet: the sha256"):
        stored_shard("s3://bucket", shard)


def test_a_damaged_copy_is_removed_and_fetched_again(
    finished: tuple[Path, Manifest], shard: FileInfo, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path / "kept"))
    root, manifest = finished
    file = manifest.files_of("scenes")[0]
    shutil.copyfile(root / file.path, tmp_path / "bucket" / Path(file.path).name)
    file = replace(file, path=Path(file.path).name)
    cached = local_shard("s3://bucket", file)
    cached.write_bytes(bytes(file.bytes))
    with pytest.raises(DamagedShardError, match="a copy from a bucket, now removed: start again"):
        Shard(local_shard("s3://bucket", file), "scenes")
    assert Shard(local_shard("s3://bucket", file), "scenes").read().num_rows == file.rows


def test_where_nothing_can_be_kept_that_is_said_and_not_that_the_shard_is_damaged(
    shard: FileInfo, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path / "file" / "kept"))
    with pytest.raises(OutputError, match=r"shards of a bucket can be kept nowhere .*: set REMQA_CACHE to a folder"):
        local_shard("s3://bucket", shard)
    monkeypatch.delenv("REMQA_CACHE")

    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    with pytest.raises(OutputError, match=r"Could not determine home directory.*set REMQA_CACHE"):
        local_shard("s3://bucket", shard)
