"""Writing files so that nothing half-written ever looks finished."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

from remqa_data.errors import ConfigError, OutputError

CACHE_VARIABLE = "REMQA_CACHE"
SCHEME = re.compile(r"([a-z][a-z0-9+.-]+):/+", re.IGNORECASE)
"""How a URI begins; the case of its letters means nothing."""
_NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Errors of a write that do not say of which."""
_LEFTOVER = re.compile(r"\.(.+)\.[0-9a-f]{12}(\.[^.]*)?")


def cache_folder() -> Path:
    """Where fetched shards, baked light and scores are kept; it may be removed.

    $REMQA_CACHE, else `remqa-data` in $XDG_CACHE_HOME, else in ~/.cache.

    Raises
    ------
    RuntimeError
        If neither variable is set, and the user has no home.
    """
    own = os.environ.get(CACHE_VARIABLE)
    return Path(own) if own else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "remqa-data"


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Write a file under a temporary name; it gets its own name when it is whole.

    The temporary name lies in the same folder, which is made if missing, and has the same suffix. When the block ends
    without an error, the file is flushed to disk and renamed, over an older file if there is one. After an error the
    temporary file is removed and `path` is as it was.

    Parameters
    ----------
    path : str or path
        The file to write.

    Yields
    ------
    Path
        The temporary name. The block must create this file.

    Raises
    ------
    OutputError
        If the path is taken by what is not a regular file, such as a device, a folder or a symbolic link.
    FileNotFoundError
        If the block ended without creating the file.

    Examples
    --------
    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "new" / "note.txt"
    >>> with atomic_path(target) as temporary:
    ...     _ = temporary.write_text("whole")
    ...     target.exists()
    False
    >>> target.read_text()
    'whole'
    """
    path = Path(path)
    _refuse_what_is_no_file(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = _temporary_name(path)
    try:
        yield temporary
        _flush(temporary)
        _refuse_what_is_no_file(path)  # again: the block may have taken an hour
        temporary.replace(path)
    except OSError as error:
        if error.errno in _NO_SPACE and error.filename is None:
            error.filename = os.fspath(path)
        raise
    finally:
        temporary.unlink(missing_ok=True)
    if os.name == "posix":
        _flush(path.parent)  # the rename itself lies in the folder


@contextmanager
def atomic_folder(path: Path) -> Iterator[Path]:
    """The same for a folder of files, which takes the place of an older one with all that this holds.

    Yields
    ------
    Path
        The temporary name of the folder, which is there and empty.
    """
    temporary, old = _temporary_name(path), _temporary_name(path)
    temporary.mkdir(parents=True)
    try:
        yield temporary
        for file in temporary.iterdir():
            _flush(file)
        if path.exists():
            path.replace(old)  # nothing is renamed over a folder that holds files
        temporary.replace(path)
    finally:
        if old.exists() and not path.exists():
            old.replace(path)
        for folder in (temporary, old):
            shutil.rmtree(folder, ignore_errors=True)


def is_remote(root: str | os.PathLike[str]) -> bool:
    """Whether a root is a URI, be it one that a Path has shortened.

    >>> is_remote("s3://bucket/prefix"), is_remote("data/remqa"), is_remote("C:/data"), is_remote("run:2")
    (True, False, False, False)
    """
    return SCHEME.match(os.fspath(root)) is not None


def uri_of(root: str | os.PathLike[str]) -> str:
    """The URI of a root that is one, with the slashes that a Path has joined into one; any other root as it is.

    >>> uri_of(Path("S3://bucket/prefix")), uri_of(Path("file:///data")), uri_of("data/remqa")
    ('s3://bucket/prefix', 'file:///data', 'data/remqa')
    """
    text = os.fspath(root)
    found = SCHEME.match(text)
    if found is None:
        return text
    scheme = found[1].lower()
    return f"{scheme}:{'///' if scheme == 'file' else '//'}{text[found.end() :]}"


def beside(root: Path, what: str) -> Path:
    """Where something made of a dataset goes if nobody says where.

    >>> beside(Path("out/tiny"), "coco").name
    'tiny-coco'

    Raises
    ------
    OutputError
        If the dataset lies in a bucket.
    """
    if is_remote(root):
        raise OutputError(f"{uri_of(root)} is not on this machine: say where to write with --out")
    named = root.resolve() if root.name in ("", "..") else root
    return named.with_name(f"{named.name}-{what}")


def local_path(path: Path) -> str:
    """A path as PyArrow takes it, which reads a relative one with a colon, such as `run:2/rows.parquet`, as an address."""
    return os.fspath(path.absolute())


def check_beside(out: str | os.PathLike[str], root: str | os.PathLike[str]) -> None:
    """Refuse to write into a dataset: its manifest lists all that belongs there.

    Raises
    ------
    OutputError
        If a place lies in the dataset's folder, or is it.
    """
    if Path(out).resolve().is_relative_to(Path(root).resolve()):
        raise OutputError(f"{out} is in the dataset {root}, which holds nothing else; give another place")


def check_folder(out: Path) -> None:
    """Say of a folder, which need not be there, that nothing can be written there, before long work is done for it.

    Raises
    ------
    OutputError
        If it is no folder, or it or the one that it would be made in takes no files.
    """
    there = next(place for place in (out, *out.absolute().parents) if place.exists())
    if not there.is_dir() or not os.access(there, os.W_OK):
        raise OutputError(
            f"{out}: nothing can be written there, as {there} is no folder that takes files; give another one"
        )


def check_empty(out: Path, option: str) -> None:
    """Refuse to write many files among others.

    Raises
    ------
    OutputError
        If a folder holds anything, or is none; names the option that gives another one.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise OutputError(f"{out} is not an empty folder; name a new one with {option}, or remove it")


def check_is_new(path: Path, kept: Iterable[Path], done: str, *, overwrite: bool, resume: bool) -> None:
    """Refuse to write over what a command has done, be it finished or not, unless that or going on with it was asked for.

    Parameters
    ----------
    path : Path
        What is told of.
    kept : iterable of Path
        What there is of it if anything has been done.
    done : str
        Such as "played".
    overwrite, resume : bool
        What was asked for.

    Raises
    ------
    ConfigError
        If there is any of it, and neither was asked for.
    """
    if not (overwrite or resume) and any(place.exists() for place in kept):
        raise ConfigError(
            f"{path} has been {done} already; use --resume to go on with it, --overwrite to replace it, or another folder"
        )


def name_of_leftover(name: str) -> str | None:
    """What a file was to be called that has a temporary name of `atomic_path`, as killed processes leave them; else None.

    >>> name_of_leftover(".manifest.0123456789ab.json"), name_of_leftover("manifest.json")
    ('manifest.json', None)
    """
    found = _LEFTOVER.fullmatch(name)
    return found and found[1] + (found[2] or "")


def walk(folder: Path) -> Iterator[tuple[Path, str]]:
    """What is in a folder and in the folders in it, each with its kind: "file", "empty folder", or "other".

    Symbolic links and mounted folders are not gone into: they are "other", as are devices, pipes and sockets. A folder that
    is not there is empty.
    """
    mounts = _mount_points()

    def inside(path: Path) -> Iterator[tuple[Path, str]]:
        entries = sorted(os.scandir(path), key=lambda entry: entry.name)
        for entry in entries:
            within = Path(entry.path)
            if entry.is_file(follow_symlinks=False):
                yield within, "file"
            elif not entry.is_dir(follow_symlinks=False) or os.path.realpath(within) in mounts or within.is_mount():
                yield within, "other"
            else:
                yield from inside(within)
        if not entries and path != folder:
            yield path, "empty folder"

    if folder.is_dir():
        yield from inside(folder)


def _mount_points() -> frozenset[str]:
    """Also those of folders that are mounted from the same disk, which Python does not tell; none where there is no /proc."""
    try:
        lines = Path("/proc/self/mountinfo").read_text(errors="surrogateescape").splitlines()
    except OSError:
        return frozenset()
    names = (line.split(" ")[4] for line in lines)
    return frozenset(re.sub(r"\\([0-7]{3})", lambda octal: chr(int(octal[1], 8)), name) for name in names)


def sha256_of(path: Path) -> str:
    """Checksum of a file, in hexadecimal."""
    with path.open("rb") as handle:
        return hashlib.file_digest(handle, "sha256").hexdigest()


def _temporary_name(path: Path) -> Path:
    return path.with_name(f".{path.stem}.{uuid4().hex[:12]}{path.suffix}")


def _refuse_what_is_no_file(path: Path) -> None:
    """Renaming would put a picture in the place of /dev/full, and cut a link off from what it leads to."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISREG(mode):
        kind = next((name for is_kind, name in _KINDS if is_kind(mode)), "no regular file")
        raise OutputError(f"{path} is {kind}; give the path of a file")


_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISLNK, "a symbolic link"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
)


def _flush(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY if os.name == "posix" else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
