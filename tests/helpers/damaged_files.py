"""Breaking files, and telling whether any byte is another."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from remqa_data.errors import DamagedShardError, ForgedRowError
from remqa_data.files import sha256_of
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import Shard, find_damage


def files_of(root: Path) -> dict[str, str]:
    """Checksum of every file of a dataset, hidden ones too."""
    paths = [path for path in sorted(root.rglob("*")) if path.is_file()]
    return {path.relative_to(root).as_posix(): sha256_of(path) for path in paths}


def flip(path: Path, place: int) -> None:
    """Turn a bit of the byte at a place."""
    data = bytearray(path.read_bytes())
    data[place] ^= 0x10
    path.write_bytes(data)


def flip_bits_of_footer(path: Path, times: int) -> Iterator[None]:
    """Flip one bit after the other in the footer of a Parquet file."""
    data, rng = path.read_bytes(), np.random.default_rng(0)
    footer = int.from_bytes(data[-8:-4], "little")
    for _ in range(times):
        flipped = bytearray(data)
        flipped[len(data) - 8 - int(rng.integers(1, footer + 1))] ^= 1 << int(rng.integers(8))
        path.write_bytes(flipped)
        yield


def read_shard_with_flipped_footers(root: Path, table: str, times: int) -> None:
    """Each must be found, and is read or refused; for a process of its own, as pyarrow may end it."""
    file = load_manifest(root).files_of(table)[0]
    for _ in flip_bits_of_footer(root / file.path, times):
        assert find_damage(root, file) is not None
        with suppress(DamagedShardError, ForgedRowError):
            Shard(root / file.path, table).read()


def damage(path: Path, how: str) -> None:
    """Leave a file "torn", "flipped" in the middle, or "missing"."""
    if how == "torn":
        path.write_bytes(path.read_bytes()[:-100])
    elif how == "flipped":
        flip(path, path.stat().st_size // 2)
    else:
        path.unlink()
