"""A storage in a folder of this machine."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

from remqa_data.files import atomic_path, walk
from remqa_data.storage.protocol import StoredFile


class Folder:
    """A storage in a folder; see `Storage`."""

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
