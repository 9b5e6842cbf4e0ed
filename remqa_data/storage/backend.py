"""Where a dataset lies: a folder, or a prefix in a bucket, such as s3://bucket/prefix.

Both keep the same promise: a file appears under its name when it is whole. In a folder it is renamed, in a bucket an
object appears when its upload is complete. Nothing appears together with something else, so what makes a group of files
valid, such as the manifest, is written after them.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from remqa_data.errors import StorageError, one_line
from remqa_data.files import atomic_path

if TYPE_CHECKING:
    from pyarrow.fs import FileSystem

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

    def delete(self, paths: Iterable[str]) -> None:
        """Remove files, if they are there."""

    def delete_folder(self, folder: str) -> None:
        """Remove a folder and all that is in it, if it is there."""


def storage_at(root: str | os.PathLike[str]) -> Storage:
    """Where a dataset lies, by its root: a folder, or a URI that pyarrow knows, such as s3://bucket/prefix.

    A Path of a URI will do as well. Credentials, region and endpoint of a bucket come from where pyarrow looks for
    them, for S3 from variables such as AWS_ACCESS_KEY_ID and AWS_ENDPOINT_URL, and from ~/.aws.
    """
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
        """See `Storage`."""
        found = []
        for path in (self.path / folder).rglob("*"):
            if path.is_file():
                about = path.stat()
                found.append(StoredFile(path.relative_to(self.path).as_posix(), about.st_size, about.st_mtime))
        return sorted(found, key=lambda file: file.path)

    def delete(self, paths: Iterable[str]) -> None:
        """See `Storage`."""
        for path in paths:
            (self.path / path).unlink(missing_ok=True)

    def delete_folder(self, folder: str) -> None:
        """See `Storage`."""
        if (self.path / folder).exists():
            shutil.rmtree(self.path / folder)


class Bucket:
    """A storage under a prefix of a bucket."""

    def __init__(self, uri: str) -> None:
        self.root = uri.rstrip("/")

    def where(self, path: str = "") -> str:
        """The URI."""
        return f"{self.root}/{path}" if path else self.root

    def exists(self, path: str) -> bool:
        """See `Storage`."""
        from pyarrow.fs import FileType

        with self._named_errors():
            return bool(self._system.get_file_info(self._key(path)).type == FileType.File)

    def read(self, path: str) -> bytes:
        """See `Storage`."""
        with self._named_errors(), self._system.open_input_stream(self._key(path)) as stream:
            return bytes(stream.read())

    @contextmanager
    def publish(self, path: str) -> Iterator[Path]:
        """A temporary file, uploaded at the end."""
        from pyarrow.fs import LocalFileSystem, copy_files

        with tempfile.TemporaryDirectory(prefix="remqa-") as folder:
            temporary = Path(folder) / Path(path).name
            yield temporary
            with self._named_errors():
                copy_files(str(temporary), self._key(path), LocalFileSystem(), self._system)

    @contextmanager
    def fetch(self, path: str) -> Iterator[Path]:
        """A downloaded copy."""
        from pyarrow.fs import LocalFileSystem, copy_files

        with tempfile.TemporaryDirectory(prefix="remqa-") as folder:
            copy = Path(folder) / Path(path).name
            with self._named_errors():
                copy_files(self._key(path), str(copy), self._system, LocalFileSystem())
            yield copy

    def files(self, folder: str = "") -> list[StoredFile]:
        """See `Storage`."""
        from pyarrow.fs import FileSelector, FileType

        with self._named_errors():
            found = self._system.get_file_info(FileSelector(self._key(folder), allow_not_found=True, recursive=True))
        start = len(self._base) + 1
        files = [f for f in found if f.type == FileType.File]
        return sorted(
            (StoredFile(f.path[start:], f.size, f.mtime.timestamp()) for f in files), key=lambda file: file.path
        )

    def delete(self, paths: Iterable[str]) -> None:
        """See `Storage`."""
        for path in paths:
            if self.exists(path):
                with self._named_errors():
                    self._system.delete_file(self._key(path))

    def delete_folder(self, folder: str) -> None:
        """See `Storage`."""
        with suppress(FileNotFoundError), self._named_errors():
            self._system.delete_dir(self._key(folder))

    def __getstate__(self) -> dict[str, str]:
        return {"root": self.root}  # each process connects for itself

    def _key(self, path: str) -> str:
        return f"{self._base}/{path}".rstrip("/")

    @property
    def _system(self) -> FileSystem:
        return self._opened[0]

    @property
    def _base(self) -> str:
        """Bucket and prefix."""
        return self._opened[1]

    @cached_property
    def _opened(self) -> tuple[FileSystem, str]:
        from pyarrow.fs import FileSystem

        try:
            system, base = FileSystem.from_uri(self.root)
        except (OSError, ValueError) as error:
            raise StorageError(self.root, one_line(error)) from None
        return system, base.rstrip("/")

    @contextmanager
    def _named_errors(self) -> Iterator[None]:
        try:
            yield
        except FileNotFoundError:
            raise
        except OSError as error:
            raise StorageError(self.root, one_line(error)) from None


def _uri(root: str | os.PathLike[str]) -> str:
    """A URI whose two slashes a Path has joined into one, as it was.

    >>> _uri(Path("s3://bucket/prefix"))
    's3://bucket/prefix'
    """
    return _SCHEME.sub(r"\1://", os.fspath(root), count=1)
