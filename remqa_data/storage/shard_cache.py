"""Shards of a dataset in a bucket, kept on this machine under their checksums.

Training reads rows in random order and over and over, which is fast on a disk and slow over a network. So a shard is
fetched whole, when it is first wanted, checked against the manifest, and read from then on as if the dataset lay here.
"""

from __future__ import annotations

import os
import shutil
from contextlib import ExitStack
from pathlib import Path

from remqa_data.errors import DamagedShardError, OutputError, one_line
from remqa_data.files import CACHE_VARIABLE, atomic_path, cache_folder, sha256_of
from remqa_data.storage.backend import storage_at
from remqa_data.storage.folder import Folder
from remqa_data.storage.manifest import FileInfo


def local_shard(root: str | os.PathLike[str], file: FileInfo) -> Path:
    """A shard on this machine: itself if the dataset is a folder, else a copy in the cache.

    Raises
    ------
    DamagedShardError
        If what was fetched is not what the manifest says, or is not there.
    OutputError
        If there is no place to keep it.
    """
    storage = storage_at(root)
    if isinstance(storage, Folder):
        return storage.path / file.path
    cached = _kept() / f"{file.sha256}.parquet"
    if cached.is_file() and cached.stat().st_size == file.bytes:
        return cached
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
