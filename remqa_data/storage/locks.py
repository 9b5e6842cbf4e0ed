"""One run at a time writes a dataset. A lock is gone when its run is, however that ended.

In a folder, the operating system holds a lock on a file and gives it back when the process dies. A bucket knows no locks.
There, a run puts a wish, waits for those of others who begin at the same time, and gives up if there is a claim, or a
wish whose name comes before its own; else it puts a claim, looks once more, and writes its claim again and again to show
that it lives. Whoever writes a claim and then finds no other is alone: of two, the later one finds the earlier. All ages
are told by the bucket's clock.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Protocol
from uuid import uuid4

import filelock

from remqa_data.errors import BusyDatasetError
from remqa_data.storage.folder import Folder
from remqa_data.storage.protocol import Storage, StoredFile

LOCK = ".lock"
WISH = ".wish"
SETTLE_S = 1.0
"""Longer than it takes to put a claim: whoever begins meanwhile is seen, and sees."""
BEAT_S = 20.0
"""A run shows so often that it is alive."""
LIFE_S = 120.0
"""A claim that is so much older than the newest is dead."""


def is_lock(file: StoredFile) -> bool:
    """Whether a file is no data, but a run's lock or claim, which it may have left behind when it was killed."""
    return file.bytes == 0 and file.path.partition("/")[0] == LOCK


class Lock(Protocol):
    """What a run holds while it writes."""

    def confirm(self) -> None:
        """Make sure that it is still held; BusyDatasetError if not."""


@contextmanager
def exclusive(storage: Storage) -> Iterator[Lock]:
    """Hold the lock of a dataset for a block.

    Raises
    ------
    BusyDatasetError
        At once, if another run holds it.
    """
    if isinstance(storage, Folder):
        with _locked_folder(storage.path) as lock:
            yield lock
    else:
        with _Claim(storage) as claim:
            yield claim


class _HeldByTheSystem:
    def confirm(self) -> None:
        """Nobody else can have it."""


@contextmanager
def _locked_folder(path: Path) -> Iterator[Lock]:
    path.mkdir(parents=True, exist_ok=True)
    lock = filelock.FileLock(path / LOCK, blocking=False, fallback_to_soft=False)
    try:
        lock.acquire()
    except filelock.Timeout:
        raise _busy(str(path)) from None
    try:
        yield _HeldByTheSystem()
    finally:
        with suppress(OSError):
            (path / LOCK).unlink()  # while it is held: whoever has it open sees that it has no name any more
        lock.release()


class _Claim:
    """A claim to a bucket's prefix, kept alive by a thread."""

    def __init__(self, storage: Storage) -> None:
        self._storage = storage
        self._path = f"{LOCK}/{uuid4().hex}"
        self._wish = self._path + WISH
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._beat, daemon=True)

    def __enter__(self) -> Lock:
        self._write(self._wish)
        try:
            self._give_way(to_wishes=False)
            time.sleep(SETTLE_S)
            self._give_way(to_wishes=True)
            self._write(self._path)
            self._give_way(to_wishes=False)
        except BaseException:
            self._withdraw()
            raise
        alive = {claim.path for claim in self._others()}  # wishes that will give way
        gone = [claim.path for claim in self._storage.files(LOCK) if claim.path not in alive | {self._path}]
        self._storage.delete(gone)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop.set()
        self._thread.join()
        self._withdraw()

    def confirm(self) -> None:
        """Claim it once more, and look whether it has passed to another run, as when this one was stopped for long."""
        self._write(self._path)
        self._give_way(to_wishes=False)

    def _give_way(self, *, to_wishes: bool) -> None:
        """Give up if another run has a claim, or a wish that comes before this one's."""
        for other in self._others():
            if not other.path.endswith(WISH) or (to_wishes and other.path < self._wish):
                raise _busy(self._storage.where())

    def _others(self) -> list[StoredFile]:
        """Claims and wishes of other runs that are alive."""
        claims = self._storage.files(LOCK)
        newest = max((claim.modified_s for claim in claims), default=0.0)
        mine = (self._path, self._wish)
        return [claim for claim in claims if claim.path not in mine and newest - claim.modified_s < LIFE_S]

    def _withdraw(self) -> None:
        with suppress(OSError):  # it dies by itself
            self._storage.delete([self._wish, self._path])

    def _beat(self) -> None:
        while not self._stop.wait(BEAT_S):
            with suppress(OSError):  # the next beat may get through
                self._write(self._path)

    def _write(self, path: str) -> None:
        with self._storage.publish(path) as temporary:
            temporary.touch()


def _busy(where: str) -> BusyDatasetError:
    return BusyDatasetError(
        f"{where}: another run is writing here; wait for its end (in a bucket, up to {LIFE_S / 60:.0f} minutes after it "
        "was killed), or use another place"
    )
