"""Which files of a place are a dataset of ours. Nothing else is ever removed or written over.

A finished dataset says so by its manifest, which lists its files. An unfinished one says so by a marker, which is written
before anything else and only where nothing else is, and goes with the parts; all that can lie beside it is known by name.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import get_args

from remqa_data.errors import DatasetError, named
from remqa_data.files import name_of_leftover
from remqa_data.storage.card import CARD, CROISSANT
from remqa_data.storage.locks import is_lock
from remqa_data.storage.manifest import MANIFEST, MARKER, PARTS
from remqa_data.storage.protocol import Storage
from remqa_data.tables.rows import Split
from remqa_data.tables.schema import TABLES

SPLITS: tuple[Split, ...] = get_args(Split)
_MARKER_TEXT = b"An unfinished dataset of remqa-gen, which goes on with --resume. It owns what it has written here.\n"
_SIGNS = {CARD: b"# REMQA dataset", CROISSANT: b'"name": "remqa"'}
"""What is in a file of this name if it is ours: many folders have a README.md."""
_ANY_TABLE, _ANY_SPLIT = "|".join(TABLES), "|".join(SPLITS)
_KNOWN = re.compile(
    rf"{re.escape(MANIFEST)}|{re.escape(CARD)}|{re.escape(CROISSANT)}|{re.escape(MARKER)}"
    rf"|({_ANY_TABLE})/({_ANY_SPLIT})-\d{{5,}}-of-\d{{5,}}\.parquet"
    rf"|{re.escape(PARTS)}/[0-9a-f]{{16}}/(deal\.json|[^/]+/(part\.json|({_ANY_TABLE})\.({_ANY_SPLIT})\.parquet))"
)
_EMPTY_FOLDER = re.compile(rf"(({_ANY_TABLE})|{re.escape(PARTS)}(/[0-9a-f]{{16}}(/[^/]+)?)?)/")


@dataclass(frozen=True)
class Place:
    """What there is where a dataset shall lie.

    Attributes
    ----------
    is_empty : bool
    is_finished : bool
        Whether there is a manifest.
    has_parts : bool
        Whether there is anything of an unfinished dataset.
    lacks : tuple of str
        Which of README.md and croissant.json are not there.
    """

    is_empty: bool
    is_finished: bool
    has_parts: bool
    lacks: tuple[str, ...]


def look(storage: Storage) -> Place:
    """What a place holds, if that is nothing or a dataset of ours, finished or not.

    Raises
    ------
    DatasetError
        If it holds anything else, which is named.
    """
    files = [file for file in storage.files() if not is_lock(file)]
    paths = [file.path for file in files]
    odd = [path for path in storage.oddities() if not _EMPTY_FOLDER.fullmatch(path)]
    is_marked = MARKER in paths and storage.read(MARKER) == _MARKER_TEXT
    listed = _listed(storage.read(MANIFEST)) if MANIFEST in paths else None
    if is_marked:
        foreign = [path for path in paths if not is_known(path)]
    elif listed is not None:
        ours = {MANIFEST, CARD, CROISSANT} | listed
        foreign = [path for path in paths if not (is_known(path) and (path in ours or _is_passing(path)))]
    else:
        foreign = [path for path in paths if path == MARKER or _finally(path) != MARKER]
    foreign += odd
    foreign += [name for name, sign in _SIGNS.items() if name in paths and sign not in storage.read(name)]
    if foreign:
        raise DatasetError(
            f"{storage.where()} holds {named(sorted(foreign), most=3)}: no part of a dataset of ours; give another folder"
        )
    has_parts = any(path.startswith(f"{PARTS}/") for path in paths)
    return Place(not paths, listed is not None, has_parts, tuple(name for name in _SIGNS if name not in paths))


def mark(storage: Storage) -> None:
    """Say that an unfinished dataset lies here, in a place that `look` has found to be empty or ours."""
    with storage.publish(MARKER) as temporary:
        temporary.write_bytes(_MARKER_TEXT)


def clear(storage: Storage) -> None:
    """Remove a dataset that `look` has found to be ours and that is marked as unfinished; lock and marker stay."""
    storage.delete([MANIFEST])  # first, so that a half-removed dataset does not look finished
    ours = [file.path for file in storage.files() if is_known(file.path) and file.path != MARKER]
    runs = {"/".join(path.split("/")[:2]) for path in ours if path.startswith(f"{PARTS}/") and path.count("/") > 1}
    for run in sorted(runs):
        _remove_all(storage, run)
    storage.delete(path for path in ours if "/".join(path.split("/")[:2]) not in runs)


def remove_parts(storage: Storage) -> None:
    """Remove what only an unfinished dataset has."""
    _remove_all(storage, PARTS)


def is_known(path: str) -> bool:
    """Whether remqa-gen writes files of this name, or leaves them behind when it is killed.

    >>> is_known("frames/train-00000-of-00005.parquet"), is_known("frames/.train-00000-of-00005.0123456789ab.parquet")
    (True, True)
    >>> is_known("frames/mine.txt"), is_known("sub/README.md"), is_known("../manifest.json")
    (False, False, False)
    """
    return _KNOWN.fullmatch(_finally(path)) is not None


def _finally(path: str) -> str:
    """What a file is called when it is whole: a temporary name may have been given to one that had one already."""
    place = PurePosixPath(path)
    name = name_of_leftover(place.name)
    return path if name is None else _finally(str(place.with_name(name)))


def _is_passing(path: str) -> bool:
    """Whether a file has no business in a finished dataset, but may have been left behind there."""
    return path.startswith(f"{PARTS}/") or _finally(path) != path


def _listed(manifest: bytes) -> frozenset[str] | None:
    """Files that a manifest of any version lists; None if it is none of ours."""
    try:
        read = json.loads(manifest)
        return frozenset(str(file["path"]) for file in read["files"]) if "config_sha256" in read else None
    except (ValueError, TypeError, KeyError, RecursionError):
        return None


def _remove_all(storage: Storage, folder: str) -> None:
    """At once, which spares a bucket many requests, unless something else has come to lie there."""
    found = [file.path for file in storage.files(folder)]
    if all(is_known(path) for path in found):
        storage.delete_folder(folder)
    else:
        storage.delete(path for path in found if is_known(path))
