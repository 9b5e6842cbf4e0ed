"""The arrays of a room in a cache, one .npy file each, as they are written and as they are mapped into memory.

`frames` (states, size, size, 3) has each state's view in the first configuration in which it can be reached. In another
configuration a view differs from it in few pixels if any: these are `pixels`, numbers from the top left, row by row, with
their `colors`; `configuration-K` says where those of each state begin.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from remqa_data.errors import DatasetError, one_line
from remqa_data.files import atomic_path

FRAMES, PIXELS, COLORS = "frames.npy", "pixels.npy", "colors.npy"


def table_name(configuration: int) -> str:
    """The file of what is small: transitions, questions, where patches begin."""
    return f"configuration-{configuration}.npz"


def features_name(configuration: int) -> str:
    """The file of a configuration's features."""
    return f"features-{configuration}.npy"


@contextmanager
def new_array(path: Path, shape: tuple[int, ...], dtype: npt.DTypeLike) -> Iterator[npt.NDArray[Any]]:
    """An array of zeros to fill, mapped to a file that gets its name when the block ends without an error."""
    with atomic_path(path) as temporary:
        if 0 in shape:  # nothing cannot be mapped
            np.save(temporary, np.empty(shape, dtype))
            yield np.empty(shape, dtype)
            return
        array = np.lib.format.open_memmap(temporary, mode="w+", dtype=dtype, shape=shape)
        yield array
        array.flush()


def save_table(path: Path, **columns: npt.NDArray[Any]) -> None:
    """Write small arrays; equal arrays give equal bytes."""
    with atomic_path(path) as temporary, temporary.open("wb") as handle:
        np.savez_compressed(handle, **columns)  # type: ignore[arg-type]


def mapped(path: Path) -> npt.NDArray[Any]:
    """An array, mapped into memory, read-only.

    Other than one that NumPy maps it keeps no file open, of which a process may have a thousand.

    Raises
    ------
    DatasetError
        If it is not there, or cannot be read.
    """
    with _readable(path):
        with path.open("rb") as handle:
            np.lib.format.read_magic(handle)
            shape, _, dtype = np.lib.format.read_array_header_1_0(handle)
            first = handle.tell()
        with pa.memory_map(str(path)) as file:
            content = file.read_buffer()
        return np.frombuffer(content, dtype, math.prod(shape), first).reshape(shape)


def load_table(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Small arrays by name; errors as in `mapped`."""
    with _readable(path), np.load(path, allow_pickle=False) as table:
        return dict(table)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise DatasetError(f"{path}: the file is missing; run remqa-data cache again") from None
    except (OSError, ValueError, EOFError, BadZipFile, NotImplementedError, zlib.error) as error:
        raise DatasetError(f"{path}: {one_line(error)}; run remqa-data cache again") from None
