"""Where machine code is kept, so that only the first run on a machine waits for the compiler."""

from __future__ import annotations

import logging
import multiprocessing
import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

from remqa_data.files import cache_folder

logger = logging.getLogger(__name__)


@cache
def kernel_cache(wanted: str, beside: Path) -> Path:
    """The first of some folders that can be written: the one that the user wants, then one that lasts, then a temporary one.

    Machine code is run as it is found, so the temporary folder is this user's alone.

    Parameters
    ----------
    wanted : str
        $NUMBA_CACHE_DIR, or "".
    beside : path
        Where the installed package would keep it.
    """
    for folder in _lasting(wanted, beside):
        if _can_write(folder):
            return folder
    folder = _private_temporary()
    if multiprocessing.parent_process() is None:
        logger.warning("compiled kernels are kept in %s for now; set NUMBA_CACHE_DIR to a folder that stays", folder)
    return folder


def _lasting(wanted: str, beside: Path) -> Iterator[Path]:
    if wanted:
        yield Path(wanted)
    yield beside
    try:
        yield cache_folder()
    except RuntimeError:  # a user without a home
        return


def _can_write(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _private_temporary() -> Path:
    """The same folder for all processes of this user, unless somebody else has taken its name."""
    if not hasattr(os, "getuid"):
        return Path(tempfile.mkdtemp(prefix="remqa-data-"))
    folder = Path(tempfile.gettempdir()) / f"remqa-data-{os.getuid()}"
    with suppress(FileExistsError):  # by whatever there is, a link that leads nowhere included
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077:
        return folder
    return Path(tempfile.mkdtemp(prefix="remqa-data-"))
