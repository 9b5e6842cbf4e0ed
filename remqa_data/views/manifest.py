"""The manifest of a cache of views: of which dataset it is, and every file with its checksum.

It is written when a run begins, with what is there already, and again when all is done; only then it says that it is finished.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from remqa_data.errors import DatasetError, what_is_invalid
from remqa_data.files import atomic_path, sha256_of
from remqa_data.storage.manifest import Manifest, config_hash
from remqa_data.version import __version__

MANIFEST = "views.json"
NOTE = "room.json"
FORMAT_VERSION = 1


@dataclass(frozen=True)
class Origin:
    """What the bytes of a cache depend on.

    Attributes
    ----------
    config_sha256 : str
        Of the dataset's configuration.
    tables_sha256 : str
        Of the checksums of its scenes and questions.
    size_px : int
        Width and height of the frames.
    version : str
        Of this package, which draws them.
    """

    config_sha256: str
    tables_sha256: str
    size_px: int
    version: str
    format_version: int = FORMAT_VERSION

    @classmethod
    def of(cls, dataset: Manifest, size_px: int) -> Origin:
        """What a cache of a dataset is made from."""
        sums = {file.path: file.sha256 for file in dataset.files if file.table in ("scenes", "questions")}
        return cls(dataset.config_sha256, config_hash(sums), size_px, __version__)

    def check(self, wanted: Origin, folder: Path) -> None:
        """Refuse a cache that is not made from what is wanted.

        Raises
        ------
        DatasetError
            Saying what is different.
        """
        for name, what in _DIFFERENCES:
            mine, asked = getattr(self, name), getattr(wanted, name)
            if mine != asked:
                raise DatasetError(
                    f"{folder} is a cache of {what} ({str(mine)[:12]}, not {str(asked)[:12]}); "
                    "give another folder, or remove this one and run remqa-data cache again"
                )


_DIFFERENCES = (
    ("config_sha256", "another dataset: its configuration is another"),
    ("tables_sha256", "another dataset: its rooms or questions are others"),
    ("version", "another version of remqa-data"),
    ("format_version", "another format"),
    ("size_px", "frames of another size"),
)


@dataclass(frozen=True)
class ViewFile:
    """A file; its path is relative to the cache, with forward slashes."""

    path: str
    bytes: int
    sha256: str

    @classmethod
    def of(cls, folder: Path, path: str) -> ViewFile:
        """What is to be said of a file that has been written."""
        return cls(path, (folder / path).stat().st_size, sha256_of(folder / path))

    def is_whole(self, folder: Path) -> bool:
        """Whether it is as it was written."""
        path = folder / self.path
        return path.is_file() and path.stat().st_size == self.bytes and sha256_of(path) == self.sha256


@dataclass(frozen=True)
class CachedRoom:
    """A finished room.

    Attributes
    ----------
    scene : str
        Its name, which is that of its folder.
    configurations : tuple of int
        Those that are cached.
    states : int
        See `remqa_data.views.states`.
    frames : int
        How many views there are: the states that can be reached, of all configurations.
    files : tuple of ViewFile
        All of them.
    features : str or None
        The function that made its features, "module:function".
    """

    scene: str
    configurations: tuple[int, ...]
    states: int
    frames: int
    files: tuple[ViewFile, ...]
    features: str | None = None

    def is_whole(self, folder: Path) -> bool:
        """Whether all its files are as they were written."""
        return all(file.is_whole(folder) for file in self.files)

    def save(self, folder: Path) -> None:
        """Note that the room is finished."""
        with atomic_path(folder / self.scene / NOTE) as temporary:
            temporary.write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class ViewsManifest:
    """What a cache is."""

    origin: Origin
    rooms: tuple[CachedRoom, ...] = ()
    is_finished: bool = False

    @property
    def bytes(self) -> int:
        """How large it is."""
        return sum(file.bytes for room in self.rooms for file in room.files)

    def save(self, folder: Path) -> None:
        """Write it; equal caches have equal manifests."""
        rooms = tuple(sorted(self.rooms, key=lambda room: room.scene))
        with atomic_path(folder / MANIFEST) as temporary:
            text = json.dumps(asdict(replace(self, rooms=rooms)), indent=1)
            temporary.write_text(text + "\n", encoding="utf-8")


def load_views_manifest(folder: str | os.PathLike[str]) -> ViewsManifest | None:
    """The manifest of a cache, finished or not; None if there is none.

    Raises
    ------
    DatasetError
        If it cannot be read.
    """
    path = Path(folder) / MANIFEST
    try:
        manifest = _MANIFEST.validate_json(path.read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        return None
    except ValidationError as error:
        raise _unreadable(path, error) from None
    for room in manifest.rooms:
        _check_names(path, room)
    return manifest


def finished_rooms(folder: Path, scenes: Sequence[str]) -> dict[str, CachedRoom]:
    """Those of some rooms whose note says that they are finished; whether their files are whole is not looked at."""
    rooms = {}
    for scene in scenes:
        path = folder / scene / NOTE
        if path.is_file():
            try:
                rooms[scene] = _ROOM.validate_json(path.read_bytes())
            except ValidationError as error:
                raise _unreadable(path, error) from None
            _check_names(path, rooms[scene])
    return rooms


def _check_names(where: Path, room: CachedRoom) -> None:
    """A manifest may come from anywhere: what it names lies in the room's own folder."""
    for file in room.files:
        if not (_NAME.fullmatch(room.scene) and file.path == f"{room.scene}/{_last(file.path)}"):
            raise DatasetError(
                f"{where}: {file.path!r:.100} is no file of room {room.scene!r:.40}; make the cache again"
            )


def is_plain(name: str) -> bool:
    """Whether a name is that of a file or folder, and leads nowhere else."""
    return _NAME.fullmatch(name) is not None


def _last(path: str) -> str:
    name = path.rpartition("/")[2]
    return name if is_plain(name) else ""


def _unreadable(path: Path, error: ValidationError) -> DatasetError:
    return DatasetError(f"{path}: {what_is_invalid(error)}; remove the cache and make it again")


_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", re.ASCII)
_MANIFEST = TypeAdapter(ViewsManifest)
_ROOM = TypeAdapter(CachedRoom)
