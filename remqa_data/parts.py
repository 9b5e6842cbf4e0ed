"""From scenes that are generated anywhere, in any order, to the shards of one dataset.

A finished scene is a folder in `.parts`, which appears when it is whole; `assemble` merges these folders in a fixed
order. So the shards are the same bytes whatever the workers, and a run that was cut off goes on where it stopped.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from uuid import uuid4

import pyarrow as pa
import pyarrow.parquet as pq

from remqa_data.errors import DatasetError
from remqa_data.files import atomic_path
from remqa_data.manifest import MANIFEST, FileInfo, Manifest, write_manifest
from remqa_data.rows import Row
from remqa_data.schema import TABLES
from remqa_data.shards import Shard, ShardWriter, file_info

PARTS = ".parts"
SPLITS = ("train", "val", "test")
_RUN, _REPORT = "run.json", "report.json"


def begin_parts(root: Path, run: Mapping[str, Any]) -> list[str]:
    """Make a folder ready for scenes of a run, or find those that an earlier start of the same run has finished.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    run : mapping
        What the scenes depend on, such as seed, configuration hash and versions; plain JSON.

    Returns
    -------
    list of str
        Scenes that are finished already, sorted.

    Raises
    ------
    DatasetError
        If the parts there belong to another run.
    """
    path = Path(root) / PARTS / _RUN
    text = json.dumps(run, sort_keys=True)
    if path.is_file() and path.read_text(encoding="utf-8") != text:
        msg = f"{path.parent} holds scenes of another run (other seed, configuration or version); "
        raise DatasetError(msg + "use --overwrite, or another folder")
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return finished_scenes(root)


def finished_scenes(root: Path) -> list[str]:
    """Names of the scenes whose parts are whole, sorted."""
    folder = Path(root) / PARTS
    return sorted(path.name for path in folder.glob("[!.]*") if path.is_dir()) if folder.is_dir() else []


def write_scene_part(
    root: Path, scene: str, rows_by_table: Mapping[str, Sequence[Row]], report: Mapping[str, Any] | None = None
) -> None:
    """Write all rows of one scene; they appear at once, when all is written, over an older part of this scene.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    scene : str
        Name of the scene.
    rows_by_table : mapping
        Rows of each table in their final order; each row's `split` says where it goes.
    report : mapping, optional
        What else to keep until the manifest is written, such as counts of refused candidates; plain JSON.

    Raises
    ------
    SchemaError
        Naming the table, row and field that do not fit.
    """
    final = Path(root) / PARTS / scene
    temporary = final.with_name(f".{scene}.{uuid4().hex[:12]}")
    try:
        for table, rows in rows_by_table.items():
            for split in dict.fromkeys(row.split for row in rows):
                with ShardWriter(temporary / f"{table}.{split}.parquet", table) as writer:
                    writer.write_rows([row for row in rows if row.split == split])
        with atomic_path(temporary / _REPORT) as path:
            path.write_text(json.dumps(report or {}), encoding="utf-8")
        if final.exists():
            shutil.rmtree(final)
        temporary.rename(final)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def read_report(root: Path, scene: str) -> dict[str, Any]:
    """The report that was written with a scene's part."""
    report: dict[str, Any] = json.loads((_part(Path(root), scene) / _REPORT).read_text(encoding="utf-8"))
    return report


def assemble(root: Path, order: Sequence[str], shards_per_split: int | Mapping[str, int]) -> tuple[FileInfo, ...]:
    """Merge the parts of all scenes into the final shards.

    The old manifest is removed first, so that the folder does not look finished meanwhile, and shards of an older
    dataset last. The parts stay until `finish`, so that whatever fails in between, nothing is generated twice.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    order : sequence of str
        Names of the scenes, in the order in which their rows shall lie.
    shards_per_split : int or mapping of str to int
        Number of files per table and split; a split with fewer rows has one for each row.

    Returns
    -------
    tuple of FileInfo
        All shards.

    Raises
    ------
    DatasetError
        If a scene has no part.
    """
    root = Path(root)
    parts = [_part(root, scene) for scene in order]
    (root / MANIFEST).unlink(missing_ok=True)
    files: list[FileInfo] = []
    for table in TABLES:
        for split in SPLITS:
            sources = [part / f"{table}.{split}.parquet" for part in parts]
            wanted = shards_per_split if isinstance(shards_per_split, int) else shards_per_split[split]
            files += _merge(root, table, split, [path for path in sources if path.exists()], wanted)
    kept = {root / file.path for file in files}
    for table in TABLES:
        for path in (root / table).glob("*.parquet"):
            if path not in kept:
                path.unlink()
    return tuple(files)


def finish(root: Path, manifest: Manifest) -> None:
    """Write the manifest, which makes the folder a finished dataset, then remove the parts."""
    write_manifest(Path(root), manifest)
    shutil.rmtree(Path(root) / PARTS, ignore_errors=True)


def count_questions(root: Path, files: Sequence[FileInfo]) -> dict[str, dict[str, int]]:
    """Number of questions by split and kind, for the manifest."""
    counts: dict[str, dict[str, int]] = {}
    for file in files:
        if file.table == "questions":
            for kind in pq.read_table(Path(root) / file.path, columns=["kind"])["kind"].to_pylist():
                of_split = counts.setdefault(file.split, {})
                of_split[kind] = of_split.get(kind, 0) + 1
    return counts


def _part(root: Path, scene: str) -> Path:
    part = root / PARTS / scene
    if not part.is_dir():
        raise DatasetError(f"{root}: scene {scene} is not finished; go on with remqa-gen --resume")
    return part


def _merge(root: Path, table: str, split: str, sources: Sequence[Path], wanted: int) -> list[FileInfo]:
    total = sum(pq.read_metadata(path).num_rows for path in sources)
    count = min(wanted, total)
    rows = _Stream(sources)
    files = []
    for number in range(count):
        path = root / table / f"{split}-{number:05d}-of-{count:05d}.parquet"
        with ShardWriter(path, table) as writer:
            for piece in rows.take((number + 1) * total // count - number * total // count):
                writer.write_table(piece)
        files.append(file_info(root, path, table, split))
    return files


class _Stream:
    """The rows of several files in order, a row group in memory at a time."""

    def __init__(self, paths: Sequence[Path]) -> None:
        self._pieces = (shard.read(group) for shard in map(Shard, paths) for group in range(shard.row_groups))
        self._rest: pa.Table | None = None

    def take(self, rows: int) -> Iterator[pa.Table]:
        """The next rows, in pieces."""
        while rows > 0:
            piece = next(self._pieces) if self._rest is None else self._rest
            yield piece.slice(0, rows)
            self._rest = piece.slice(rows) if piece.num_rows > rows else None
            rows -= min(rows, piece.num_rows)
