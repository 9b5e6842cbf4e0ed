"""Where a dataset lies: a folder, or a prefix in a bucket, such as s3://bucket/prefix (see `bucket`).

Both keep the same promise: a file appears under its name when it is whole. In a folder it is renamed, in a bucket an
object appears when its upload is complete. Nothing appears together with something else, so what makes a group of files
valid, such as the manifest, is written after them.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Protocol

from remqa_data.errors import DatasetError
from remqa_data.files import atomic_path, walk

_SCHEME = re.compile(r"([a-z][a-z0-9+.-]+):/+")


@dataclass(frozen=True)
class StoredFile:
    """A file of a storage.

    Attributes
    ----------
    path : str
        Relative to the root, with forward slashes.
    bytes : int
        Its size.
    modified_s : float
        When it was written, in seconds by the clock of the storage.
    """

    path: str
    bytes: int
    modified_s: float


class Storage(Protocol):
    """The files of a dataset, by their paths relative to its root, with forward slashes.

    It can be pickled. Whatever cannot be read or written is an OSError.
    """

    @property
    def root(self) -> str:
        """The root, from which any process on any machine opens the same storage again."""

    def where(self, path: str = "") -> str:
        """A path as a person knows it."""

    def exists(self, path: str) -> bool:
        """Whether there is such a file."""

    def read(self, path: str) -> bytes:
        """All of a file; FileNotFoundError if there is none."""

    def publish(self, path: str) -> Any:
        """Context manager: a name on this machine for a new file, which gets its own name when the block ends well."""

    def fetch(self, path: str) -> Any:
        """Context manager: the name on this machine of a file, or of a copy that lasts for the block."""

    def files(self, folder: str = "") -> list[StoredFile]:
        """All files in a folder and the folders in it, by path."""

    def oddities(self) -> list[str]:
        """What is there besides files: links, devices, mounted folders, and empty folders, whose names end with a slash."""

    def delete(self, paths: Iterable[str]) -> None:
        """Remove files, if they are there, and folders that become empty."""

    def delete_folder(self, folder: str) -> None:
        """Remove the files of `files(folder)`: who calls this has looked at them."""


def storage_at(root: str | os.PathLike[str]) -> Storage:
    """Where a dataset lies, by its root: a folder, or a URI that pyarrow knows, such as s3://bucket/prefix.

    A Path of a URI will do as well. Credentials, region and endpoint of a bucket come from where pyarrow looks for
    them, for S3 from variables such as AWS_ACCESS_KEY_ID and AWS_ENDPOINT_URL, and from ~/.aws.

    Raises
    ------
    DatasetError
        For a folder that is given as a URI.
    """
    if os.fspath(root).startswith("file:/"):
        raise DatasetError(f"{root}: give the folder by its path, {_SCHEME.sub('/', os.fspath(root), count=1)}")
    from remqa_data.storage.bucket import Bucket

    return Bucket(_uri(root)) if is_remote(root) else Folder(Path(root))


def is_remote(root: str | os.PathLike[str]) -> bool:
    """Whether a root is a URI.

    >>> is_remote("s3://bucket/prefix"), is_remote("data/remqa"), is_remote("C:/data")
    (True, False, False)
    """
    return _SCHEME.match(os.fspath(root)) is not None


class Folder:
    """A storage in a folder."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def root(self) -> str:
        """The absolute path."""
        return str(self.path.absolute())

    def where(self, path: str = "") -> str:
        """The path as it was given, not made absolute."""
        return str(self.path / path)

    def exists(self, path: str) -> bool:
        """See `Storage`."""
        return (self.path / path).is_file()

    def read(self, path: str) -> bytes:
        """See `Storage`."""
        return (self.path / path).read_bytes()

    @contextmanager
    def publish(self, path: str) -> Iterator[Path]:
        """See `Storage`."""
        with atomic_path(self.path / path) as temporary:
            yield temporary

    @contextmanager
    def fetch(self, path: str) -> Iterator[Path]:
        """The file itself."""
        yield self.path / path

    def files(self, folder: str = "") -> list[StoredFile]:
        """See `Storage`; what links and mounted folders lead to is not among them."""
        found = []
        for path, kind in walk(self.path / folder):
            if kind == "file":
                with suppress(FileNotFoundError):  # a temporary file whose process still lives
                    about = path.lstat()
                    found.append(StoredFile(path.relative_to(self.path).as_posix(), about.st_size, about.st_mtime))
        return sorted(found, key=lambda file: file.path)

    def oddities(self) -> list[str]:
        """See `Storage`."""
        odd = [(path, "/" if kind == "empty folder" else "") for path, kind in walk(self.path) if kind != "file"]
        return sorted(path.relative_to(self.path).as_posix() + slash for path, slash in odd)

    def delete(self, paths: Iterable[str]) -> None:
        """See `Storage`."""
        for path in paths:
            (self.path / path).unlink(missing_ok=True)
            for parent in PurePosixPath(path).parents[:-1]:
                try:
                    (self.path / parent).rmdir()
                except OSError:
                    break  # there is something else in it

    def delete_folder(self, folder: str) -> None:
        """See `Storage`."""
        self.delete(file.path for file in self.files(folder))


def _uri(root: str | os.PathLike[str]) -> str:
    """A URI whose two slashes a Path has joined into one, as it was.

    >>> _uri(Path("s3://bucket/prefix"))
    's3://bucket/prefix'
    """
    return _SCHEME.sub(r"\1://", os.fspath(root), count=1)
