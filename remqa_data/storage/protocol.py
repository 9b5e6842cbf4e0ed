"""What a storage is: the files of a dataset by their paths, wherever they lie."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol


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
