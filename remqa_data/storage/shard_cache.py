"""Shards of a dataset in a bucket, kept on this machine under their checksums.

Training reads rows in random order and over and over, which is fast on a disk and slow over a network. So a shard is
fetched whole, when it is first wanted, checked against the manifest, and read from then on as if the dataset lay here.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from remqa_data.errors import DamagedShardError
from remqa_data.files import atomic_path, cache_folder, sha256_of
from remqa_data.storage.backend import storage_at
from remqa_data.storage.folder import Folder
from remqa_data.storage.manifest import FileInfo


def local_shard(root: str | os.PathLike[str], file: FileInfo) -> Path:
    """A shard on this machine: itself if the dataset is a folder, else a copy in the cache.

    Raises
    ------
    DamagedShardError
        If what was fetched is not what the manifest says, or is not there.
    """
    storage = storage_at(root)
    if isinstance(storage, Folder):
        return storage.path / file.path
    cached = cache_folder() / f"{file.sha256}.parquet"
    if cached.is_file() and cached.stat().st_size == file.bytes:
        return cached
    try:
        with storage.fetch(file.path) as fetched:
            if sha256_of(fetched) != file.sha256:
                raise DamagedShardError(storage.where(file.path), "the sha256 is not that of the manifest")
            with atomic_path(cached) as temporary:
                shutil.copyfile(fetched, temporary)
    except FileNotFoundError:
        raise DamagedShardError(storage.where(file.path), "the file is missing") from None
    return cached
