"""Shards of a dataset in a bucket, kept on this machine under their checksums.

Training reads rows in random order and over and over, which is fast on a disk and slow over a network. So a shard is
fetched whole, when it is first wanted, checked against the manifest, and read from then on as if the dataset lay here. A
copy that turns out to be damaged is removed, so that it is fetched again.
"""

from __future__ import annotations

import os
import shutil
from contextlib import ExitStack, suppress
from pathlib import Path

from remqa_data.errors import DamagedShardError, OutputError, one_line
from remqa_data.files import CACHE_VARIABLE, atomic_path, cache_folder, sha256_of
from remqa_data.storage.backend import storage_at
from remqa_data.storage.folder import Folder
from remqa_data.storage.manifest import FileInfo
from remqa_data.storage.protocol import Storage


def local_shard(root: str | os.PathLike[str], file: FileInfo) -> Path:
    """A shard on this machine, of the size that it should have: itself if the dataset is a folder, else a copy in the cache.

    Raises
    ------
    DamagedShardError
        If it is not there or of another size, or what was fetched is not what the manifest says.
    OutputError
        If there is no place to keep it.
    """
    storage = storage_at(root)
    if isinstance(storage, Folder):
        return _of_right_size(storage.path / file.path, file.bytes)
    cached = _kept() / f"{file.sha256}.parquet"
    with suppress(DamagedShardError):
        return _of_right_size(cached, file.bytes)
    return _fetched(storage, file, cached)


def stored_shard(root: str | os.PathLike[str], file: FileInfo) -> Path:
    """The same, but from a bucket it is fetched now, whatever the cache has: what lies there is what counts."""
    storage = storage_at(root)
    if isinstance(storage, Folder):
        return local_shard(root, file)
    return _fetched(storage, file, _kept() / f"{file.sha256}.parquet")


def forget_if_damaged(path: Path) -> bool:
    """Remove a copy from the cache that is not what its name says; whether it was one, and is gone."""
    with suppress(OSError, RuntimeError):
        if path.parent.samefile(cache_folder()) and sha256_of(path) != path.stem:
            path.unlink()
            return True
    return False


def _of_right_size(path: Path, size: int) -> Path:
    if not path.is_file():
        is_there = os.path.lexists(path)
        raise DamagedShardError(path, "this is no file, nor does it lead to one" if is_there else "the file is missing")
    if (found := path.stat().st_size) != size:
        raise DamagedShardError(path, f"it has {found:,} bytes; the manifest says {size:,}")
    return path


def _fetched(storage: Storage, file: FileInfo, cached: Path) -> Path:
    with ExitStack() as stack:
        try:
            fetched = stack.enter_context(storage.fetch(file.path))
        except FileNotFoundError:
            raise DamagedShardError(storage.where(file.path), "the file is missing") from None
        if sha256_of(fetched) != file.sha256:
            raise DamagedShardError(storage.where(file.path), "the sha256 is not that of the manifest")
        with atomic_path(cached) as temporary:
            shutil.copyfile(fetched, temporary)
    return cached


def _kept() -> Path:
    try:
        folder = cache_folder()
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError) as error:  # a user without a home
        raise OutputError(
            f"shards of a bucket can be kept nowhere ({one_line(error)}): set {CACHE_VARIABLE} to a folder"
        ) from None
    return folder
