"""A dataset under a prefix of a bucket, spoken to through pyarrow."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from remqa_data.errors import StorageError, one_line
from remqa_data.files import sha256_of
from remqa_data.storage.protocol import StoredFile

if TYPE_CHECKING:
    from pyarrow.fs import FileSystem

CHUNK_BYTES = 1 << 20
GOOGLE_PATIENCE_S = 30
"""How long a request to Google's storage is tried again: of itself for a quarter of an hour, without a word."""
_AGAIN = "try again; remqa-gen goes on with --resume"
_CHECK = "check the address, the network and your credentials"
_KNOWN = "give a folder by its path, or s3://, gs://, abfs:// or hf://"
_CREDENTIALS = "set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_PROFILE for one of ~/.aws"


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
        return b"".join(self._chunks(path))

    @contextmanager
    def publish(self, path: str) -> Iterator[Path]:
        """A temporary file, uploaded at the end, and read back: an upload that is lost on the way may look like success."""
        with tempfile.TemporaryDirectory(prefix="remqa-") as folder:
            temporary = Path(folder) / Path(path).name
            yield temporary
            with self._named_errors():
                self._upload(temporary, path)
            if self._stored_sha256(path) != sha256_of(temporary):
                with suppress(OSError):
                    self.delete([path])
                raise StorageError(self.where(path), "what is stored is not what was uploaded", _AGAIN)

    @contextmanager
    def fetch(self, path: str) -> Iterator[Path]:
        """A downloaded copy."""
        with tempfile.TemporaryDirectory(prefix="remqa-") as folder:
            copy = Path(folder) / Path(path).name
            with copy.open("wb") as local:
                for chunk in self._chunks(path):
                    local.write(chunk)
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

    def oddities(self) -> list[str]:
        """See `Storage`: in a bucket there is nothing but files."""
        return []

    def delete(self, paths: Iterable[str]) -> None:
        """See `Storage`."""
        for path in paths:
            if self.exists(path):
                with suppress(FileNotFoundError), self._named_errors():
                    self._system.delete_file(self._key(path))

    def delete_folder(self, folder: str) -> None:
        """See `Storage`."""
        with suppress(FileNotFoundError), self._named_errors():
            self._system.delete_dir(self._key(folder))

    def _upload(self, local: Path, path: str) -> None:
        with local.open("rb") as source, self._system.open_output_stream(self._key(path)) as target:
            while chunk := source.read(CHUNK_BYTES):
                target.write(chunk)

    def _stored_sha256(self, path: str) -> str:
        stored = hashlib.sha256()
        try:
            for chunk in self._chunks(path):
                stored.update(chunk)
        except FileNotFoundError:
            raise StorageError(self.where(path), "the upload was lost", _AGAIN) from None
        return stored.hexdigest()

    def _chunks(self, path: str) -> Iterator[bytes]:
        """The bytes of a file, as many as the bucket says that it has: an answer may be cut off without a word."""
        with self._named_errors():
            size, read = self._system.get_file_info(self._key(path)).size, 0
            with self._system.open_input_stream(self._key(path)) as stream:
                while chunk := stream.read(CHUNK_BYTES):
                    read += len(chunk)
                    yield bytes(chunk)
            if read != size:
                raise StorageError(self.where(path), f"only {read:,} of {size:,} bytes came through", _AGAIN)

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
            system, base = FileSystem.from_uri(_impatient(self.root))
        except Exception as error:
            raise self._named(error) from None
        return system, base.rstrip("/")

    @contextmanager
    def _named_errors(self) -> Iterator[None]:
        try:
            yield
        except (FileNotFoundError, StorageError):
            raise
        except Exception as error:  # what is no filesystem of pyarrow's own, as for hf://, has errors of its own
            raise self._named(error) from None

    def _named(self, error: Exception) -> StorageError:
        if not self.root.startswith("s3://"):
            said = one_line(error).partition(" error_info=")[0]  # with which Google's client says it all again
            if "Unrecognized filesystem type" in said:
                return StorageError(self.root, "there is no such storage", _KNOWN)
            return StorageError(self.root, said or type(error).__name__, _CHECK)
        if _is_refused(error) and not _has_credentials():
            return StorageError(self.root, "no credentials were found", _CREDENTIALS)
        return StorageError(self.root, one_line(error))


def _impatient(uri: str) -> str:
    """The same place, asked for no longer than somebody waits.

    >>> _impatient("gs://bucket/prefix"), _impatient("s3://bucket/prefix")
    ('gs://bucket/prefix?retry_limit_seconds=30', 's3://bucket/prefix')
    """
    if not uri.startswith(("gs://", "gcs://")) or "retry_limit_seconds=" in uri:
        return uri
    return f"{uri}{'&' if '?' in uri else '?'}retry_limit_seconds={GOOGLE_PATIENCE_S}"


def _is_refused(error: Exception) -> bool:
    return any(
        word in str(error) for word in ("ACCESS_DENIED", "HTTP status 403", "INVALID_ACCESS_KEY_ID", "credential")
    )


def _has_credentials() -> bool:
    """Whether there is anything where the AWS SDK looks for credentials, but for the role of a machine in the cloud."""
    named = (
        "AWS_ACCESS_KEY_ID",
        "AWS_PROFILE",
        "AWS_WEB_IDENTITY_TOKEN_FILE",
        "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI",
    )
    if any(os.environ.get(name) for name in (*named, "AWS_CONTAINER_CREDENTIALS_FULL_URI")):
        return True
    files = (("AWS_SHARED_CREDENTIALS_FILE", "credentials"), ("AWS_CONFIG_FILE", "config"))
    return any(
        Path(os.environ.get(variable) or os.path.expanduser(f"~/.aws/{name}")).is_file() for variable, name in files
    )
