"""The manifest of a dataset: what was asked for, with what it was made, and every file with its checksum.

It is written last. A folder without one is not a finished dataset, whatever else lies in it.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import platform
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from importlib import metadata, resources
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from remqa_data.errors import DatasetError, one_line, what_is_invalid
from remqa_data.files import uri_of
from remqa_data.storage.backend import storage_at
from remqa_data.storage.folder import Folder
from remqa_data.storage.protocol import Storage
from remqa_data.version import TEMPLATES_SHA256, __version__

MANIFEST = "manifest.json"
PARTS = ".parts"
MARKER = f"{PARTS}/UNFINISHED"
"""Only an unfinished dataset has it, beside its parts, from which its run goes on."""
FORMAT_VERSION = 2
"""2: initial_pose, start_target_box_2d and walk_start_cell have their names."""
VERSIONED = ("pybullet", "numpy", "numba", "opencv-python-headless", "pyarrow")
"""Packages whose version can change the bytes of a dataset."""


@dataclass(frozen=True)
class FileInfo:
    """One file of a dataset.

    Attributes
    ----------
    path : str
        Relative to the dataset's folder, with forward slashes.
    table, split : str
        What it holds.
    rows, bytes : int
        How much.
    sha256 : str
        Of the whole file, in hexadecimal.
    """

    path: str
    table: str
    split: str
    rows: int
    bytes: int
    sha256: str


@dataclass(frozen=True)
class Manifest:
    """What a finished dataset is.

    Attributes
    ----------
    seed : int
        Seed of the whole dataset.
    config : mapping
        The configuration it was generated with, as plain JSON.
    config_sha256 : str
        Of that configuration, see `config_hash`.
    versions : mapping of str to str
        Of this package (see `version_here`), Python and the packages that make the bytes.
    files : tuple of FileInfo
        All shards, in the order of tables, splits and numbers.
    questions : mapping
        Number of questions by split and kind.
    refused : mapping of str to int
        Number of candidates that generation refused, by reason.
    asked_anew : mapping
        What rooms were asked for, by scene, kind and answer, where that is not what they would be by the configuration
        alone: some could not have all, and others stepped in.
    """

    seed: int
    config: dict[str, Any]
    config_sha256: str
    versions: dict[str, str]
    files: tuple[FileInfo, ...]
    questions: dict[str, dict[str, int]]
    refused: dict[str, int]
    asked_anew: dict[str, dict[str, dict[str, int]]] = field(default_factory=dict)
    format_version: int = FORMAT_VERSION

    def splits(self, table: str) -> list[str]:
        """Splits that a table has, in the order of its files."""
        return list(dict.fromkeys(file.split for file in self.files if file.table == table))

    def files_of(self, table: str, split: str | None = None) -> list[FileInfo]:
        """Files of a table, of one split if given, in order."""
        return [file for file in self.files if file.table == table and split in (None, file.split)]

    def rows(self, table: str, split: str | None = None) -> int:
        """Number of rows of a table, of one split if given."""
        return sum(file.rows for file in self.files_of(table, split))

    def to_json(self) -> str:
        """The manifest as indented JSON; equal manifests give equal text."""
        return json.dumps(asdict(self), indent=1, ensure_ascii=False) + "\n"


def dataset_around(path: Path) -> Path | None:
    """The finished dataset that a folder or file is in, if there is one."""
    for outer in path.resolve().parents:
        if (outer / MANIFEST).is_file():
            with suppress(DatasetError):  # others have files of that name, too
                load_manifest(outer)
                return outer
    return None


def config_hash(config: Mapping[str, Any]) -> str:
    """sha256 of a configuration, whatever the order of its keys.

    >>> config_hash({"scenes": 1, "seed": 0}) == config_hash({"seed": 0, "scenes": 1})
    True
    """
    return hashlib.sha256(json.dumps(config, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def make_manifest(
    files: tuple[FileInfo, ...],
    *,
    seed: int,
    config: Mapping[str, Any],
    questions: Mapping[str, Mapping[str, int]],
    refused: Mapping[str, int],
    asked_anew: Mapping[str, Mapping[str, Mapping[str, int]]] | None = None,
) -> Manifest:
    """A manifest with the hash of the configuration and the versions of this environment."""
    counts = {split: dict(sorted(kinds.items())) for split, kinds in questions.items()}
    anew = {scene: {kind: dict(n) for kind, n in kinds.items()} for scene, kinds in (asked_anew or {}).items()}
    return Manifest(
        seed, dict(config), config_hash(config), versions_here(), files, counts, dict(sorted(refused.items())), anew
    )


def versions_here() -> dict[str, str]:
    """Of this package, Python and the packages that make the bytes, as they are in this environment."""
    return versions_of(VERSIONED) | {"remqa-data": version_here()}


def version_here() -> str:
    """Of this package; where files of `templates/` are not those of the version, "1.0.0+templates.0c1f5a3b" says so."""
    digest = templates_sha256()
    return __version__ if digest == TEMPLATES_SHA256 else f"{__version__}+templates.{digest[:8]}"


def templates_sha256() -> str:
    r"""Of all files of `templates/` and their names, whether their lines end in "\n" or, as in clones on Windows, in "\r\n"."""
    files = [file for file in resources.files("remqa_data.templates").iterdir() if not file.name.startswith("__")]
    contents = {file.name: file.read_bytes().replace(b"\r\n", b"\n") for file in files if file.is_file()}
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}
    return hashlib.sha256(repr(sorted(digests.items())).encode()).hexdigest()


def versions_of(packages: Iterable[str]) -> dict[str, str]:
    """Of this package, Python and some others, as they are in this environment."""
    here = {"remqa-data": __version__, "python": platform.python_version()}
    return here | {package: _version_of(package) for package in packages}


def _version_of(package: str) -> str:
    """Of an installed package, also where it is of another name there, as OpenCV is from conda or the system."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        module = importlib.import_module({"opencv-python-headless": "cv2"}.get(package, package))
        return str(getattr(module, "__version__", "unknown"))


def write_manifest(root: str | os.PathLike[str], manifest: Manifest) -> None:
    """Write the manifest, which makes the folder a finished dataset."""
    with storage_at(root).publish(MANIFEST) as temporary:
        temporary.write_text(manifest.to_json(), encoding="utf-8")


def load_manifest(root: str | os.PathLike[str]) -> Manifest:
    """Read the manifest of a finished dataset, which may lie in a bucket, see `storage_at`.

    Raises
    ------
    DatasetError
        If there is no such folder, it is not a finished dataset, or its manifest cannot be read or names files elsewhere.
    """
    storage = storage_at(root)
    path = storage.where(MANIFEST)
    try:
        text = storage.read(MANIFEST)
    except (FileNotFoundError, NotADirectoryError):
        raise _no_dataset(storage) from None
    _check_format(path, text)
    try:
        manifest = _ADAPTER.validate_json(text)
    except ValidationError as error:
        raise DatasetError(f"{path}: {what_is_invalid(error)}; generate the dataset again") from None
    _check_names(path, manifest.files)
    return manifest


_PATH = re.compile(r"[A-Za-z0-9_]+/[A-Za-z0-9_][A-Za-z0-9_.-]*", re.ASCII)
_SHA256 = re.compile(r"[0-9a-f]{64}", re.ASCII)


def question_splits(root: str | os.PathLike[str], manifest: Manifest | None = None) -> list[str]:
    """Splits that a dataset has questions of, in the order of its files; DatasetError if it has none.

    The manifest is read if it is not given.
    """
    splits = (manifest or load_manifest(root)).splits("questions")
    if not splits:
        raise DatasetError(f"{uri_of(root)} has no questions")
    return splits


def _check_format(where: str, text: bytes) -> None:
    """Before anything else: another format may have other keys."""
    try:
        stored = json.loads(text)
    except (ValueError, RecursionError):
        return  # reading it says why
    if isinstance(stored, dict) and (version := stored.get("format_version", FORMAT_VERSION)) != FORMAT_VERSION:
        versions = stored.get("versions")
        made_by = versions.get("remqa-data") if isinstance(versions, dict) else None
        raise DatasetError(
            f"{where}: format version {version!r:.20}; this package reads {FORMAT_VERSION}; generate the dataset again, "
            f"or install the remqa-data that made it ({one_line(made_by):.40})"
        )


def _check_names(where: str, files: tuple[FileInfo, ...]) -> None:
    """A manifest may come from anywhere: what it names lies in the folder of a table, and names no other place."""
    for number, file in enumerate(files):
        if not _PATH.fullmatch(file.path) or not file.path.startswith(f"{file.table}/"):
            raise DatasetError(
                f"{where}: files.{number}.path: {file.path!r:.100} is no name of a file in the dataset's folder "
                f"{file.table!r:.40}; fetch or generate the dataset again"
            )
        if not _SHA256.fullmatch(file.sha256):
            raise DatasetError(f"{where}: files.{number}.sha256: {file.sha256!r:.100} is no sha256 in hexadecimal")
    for path, count in Counter(file.path for file in files).items():
        if count > 1:
            raise DatasetError(f"{where}: files: {path} is listed {count} times")


def _no_dataset(storage: Storage) -> DatasetError:
    where = storage.where()
    if isinstance(storage, Folder) and storage.path.is_file():
        return DatasetError(f"{where} is a file; give the folder of a dataset")
    if isinstance(storage, Folder) and not storage.path.is_dir():
        if where.startswith("~"):
            return DatasetError(
                f"{where}: no such folder; only a shell puts the home folder for ~: give the whole path"
            )
        return DatasetError(f"{where}: no such folder; generate a dataset with remqa-gen --out {where}")
    if storage.exists(MARKER):
        advice = "go on with remqa-gen --resume, or start again"
    else:
        advice = "give the folder of a dataset, or generate one with remqa-gen"
    return DatasetError(f"{where} is not a finished dataset: it has no {MANIFEST}; {advice}")


_ADAPTER = TypeAdapter(Manifest)
