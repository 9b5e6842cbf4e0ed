"""Baked light on this machine's disk, under a checksum of all that it follows from: another process need not bake it again."""

from __future__ import annotations

import hashlib
import os
import zipfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

from remqa_data.errors import OutputError
from remqa_data.files import atomic_path, cache_folder
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.light.bake import Lamps, bake
from remqa_data.sim.light.volume import Volume
from remqa_data.sim.light.voxels import Faces

MOST_BYTES = 512 << 20
"""What was used longest ago goes when there is more: some 150 rooms."""


def bake_once(faces: Faces, lamps: Lamps, low: Vec3, high: Vec3, level: float) -> Volume:
    """What `bake` gives, the caller's own; baked only if no process of this machine has done it with the same code."""
    told = hashlib.sha256(_code())
    told.update(repr((low, high, lamps.reach_m, level)).encode())
    for array in (lamps.positions, lamps.strength, *faces):
        told.update(repr((array.shape, array.dtype.str)).encode())
        told.update(np.ascontiguousarray(array).data)
    return cached(told.hexdigest()[:32], lambda: bake(faces, lamps, low, high, level))


def cached(key: str, make: Callable[[], Volume]) -> Volume:
    """The volume under a key, made if it is not there; where nothing can be written, each process makes its own."""
    try:
        path = cache_folder() / "light" / f"{key}.npz"
    except RuntimeError:  # a user without a home
        return make()
    found = _read(path)
    if found is not None:
        return found
    made = make()
    with suppress(OSError, OutputError):
        with atomic_path(path) as temporary:
            np.savez(temporary, **made._asdict())
        _forget_oldest(path.parent)
    return made


def _read(path: Path) -> Volume | None:
    """What a file holds; None if there is none, or if it is damaged, which its checksums tell."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            origin: F64 = stored["origin"]
            light, is_valid = stored["light"], stored["is_valid"]
            volume = Volume(origin, light, float(stored["spacing_m"]), is_valid, float(stored["least"]))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    with suppress(OSError):  # it may be another's
        os.utime(path)
    return volume


def _forget_oldest(folder: Path) -> None:
    """Remove what was used longest ago; other processes may do the same."""
    files = []
    for path in folder.glob("*.npz"):
        with suppress(OSError):
            about = path.stat()
            files.append((about.st_mtime_ns, about.st_size, path))
    total = sum(size for _, size, _ in files)
    for _, size, path in sorted(files):
        if total <= MOST_BYTES:
            return
        path.unlink(missing_ok=True)
        total -= size


@cache
def _code() -> bytes:
    """The text of all that baking computes with."""
    modules = [*sorted(Path(__file__).parent.glob("*.py")), Path(arithmetic.__file__)]
    return b"".join(path.read_bytes() for path in modules)
