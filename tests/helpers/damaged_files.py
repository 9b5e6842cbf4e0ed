"""Breaking files, and telling whether any byte is another."""

from pathlib import Path

from remqa_data.files import sha256_of


def files_of(root: Path) -> dict[str, str]:
    """Checksum of every file of a dataset, hidden ones too."""
    paths = [path for path in sorted(root.rglob("*")) if path.is_file()]
    return {path.relative_to(root).as_posix(): sha256_of(path) for path in paths}


def flip(path: Path, place: int) -> None:
    """Turn a bit of the byte at a place."""
    data = bytearray(path.read_bytes())
    data[place] ^= 0x10
    path.write_bytes(data)


def damage(path: Path, how: str) -> None:
    """Leave a file "torn", "flipped" in the middle, or "missing"."""
    if how == "torn":
        path.write_bytes(path.read_bytes()[:-100])
    elif how == "flipped":
        flip(path, path.stat().st_size // 2)
    else:
        path.unlink()
