"""How fast the PyTorch datasets yield, against cv2.imdecode alone on the same images; all on one core.

`python benchmarks/dataset.py [DIR]` measures a finished dataset; without one, two rooms are generated first. The figures
are printed and stored in out/benchmarks/dataset.json. The aim is a ratio of at least 0.70.
"""

from __future__ import annotations

import json
import platform
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
from rich.console import Console
from rich.table import Table

from remqa_data.dataset import ExpressionDataset, FrameDataset, RemqaDataset
from remqa_data.manifest import MANIFEST, load_manifest
from remqa_data.shards import read_table

OUTPUT = Path("out/benchmarks/dataset.json")
ROOMS, ROOMS_DATASET = ("FloorPlan1", "FloorPlan27"), Path("out/benchmarks/two_rooms")
ROUNDS, SAMPLES = 9, 96


@dataclass(frozen=True)
class Speed:
    """Milliseconds per sample, the best of several rounds."""

    dataset: str
    images: int
    order: str
    imdecode_ms: float
    first_ms: float
    """The first time that a process reads the samples, when it checks their checksums."""
    dataset_ms: float

    @property
    def ratio(self) -> float:
        """Share of imdecode's speed that is left."""
        return self.imdecode_ms / self.dataset_ms

    @property
    def first_ratio(self) -> float:
        """The same for the first time."""
        return self.imdecode_ms / self.first_ms


def main() -> None:
    """Measure, print a table and store the figures."""
    cv2.setNumThreads(1)
    torch.set_num_threads(1)
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else two_rooms(ROOMS_DATASET)
    split = load_manifest(root).splits("questions")[0]
    kinds: list[tuple[str, str, Callable[[], Any]]] = [
        ("questions, all images", "questions", lambda: RemqaDataset(root, split)),
        ("questions, RGB", "questions", lambda: RemqaDataset(root, split, images=("start_rgb", "end_rgb"))),
        ("frames, all images", "frames", lambda: FrameDataset(root, split)),
        ("frames, RGB", "frames", lambda: FrameDataset(root, split, images=("rgb",))),
    ]
    speeds = [
        measure(name, make, encoded_images(root, table, split, make().images), shuffled)
        for name, table, make in kinds
        for shuffled in (False, True)
    ]
    speeds.append(expressions(root, split))
    table = Table(title=f"{root}: ms per sample on one core; ratio to imdecode")
    for heading in ("dataset", "images", "order", "imdecode", "dataset", "ratio", "ratio, first time"):
        table.add_column(heading, justify="right")
    for speed in speeds:
        figures = (speed.imdecode_ms, speed.dataset_ms, speed.ratio, speed.first_ratio)
        table.add_row(speed.dataset, str(speed.images), speed.order, *(f"{figure:.2f}" for figure in figures))
    Console().print(table)
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    facts = {"cpu": platform.processor(), "opencv": cv2.__version__, "torch": torch.__version__}
    OUTPUT.write_text(
        json.dumps(
            {**facts, "speeds": [asdict(s) | {"ratio": s.ratio, "first_ratio": s.first_ratio} for s in speeds]},
            indent=2,
        )
        + "\n"
    )


def two_rooms(root: Path) -> Path:
    """A small dataset with pictures of the published size, generated once."""
    if not (root / MANIFEST).is_file():
        from remqa_data.generators.config import paper_config
        from remqa_data.generators.pipeline import generate

        config = paper_config()
        few = {"EXISTENCE": 16, "COUNTING": 8, "SPATIAL": 8}
        totals = {split: config.questions.train.model_copy(update=few) for split in ("train", "test")}
        questions = config.questions.model_copy(update=totals)
        generate(root, config.model_copy(update={"scenes": ROOMS, "questions": questions}))
    return root


def encoded_images(root: Path, table: str, split: str, images: Sequence[str]) -> list[list[bytes]]:
    """The encoded images of every row, in memory."""
    columns = read_table(root, table, split, list(images))
    return [[row[name]["bytes"] for name in images] for row in columns.to_pylist()]


def expressions(root: Path, split: str) -> Speed:
    """Expressions are read with the image of their frame."""
    frames = read_table(root, "frames", split, ["frame_id", "rgb"]).to_pylist()
    encoded = {frame["frame_id"]: frame["rgb"]["bytes"] for frame in frames}
    names = read_table(root, "expressions", split, ["frame_id"])["frame_id"].to_pylist()
    return measure(
        "expressions, RGB", lambda: ExpressionDataset(root, split), [[encoded[name]] for name in names], True
    )


def measure(name: str, make: Callable[[], Any], encoded: Sequence[Sequence[bytes]], shuffled: bool) -> Speed:
    """Time imdecode and the dataset in turns, so that what else the machine does falls on both alike."""
    rows = np.random.default_rng(0).permutation(len(encoded)) if shuffled else np.arange(len(encoded))
    chosen = rows[:SAMPLES].tolist()
    times = []
    for _ in range(ROUNDS):
        dataset = make()
        assert len(dataset) == len(encoded)
        dataset[int(rows[-1])]  # opens the files
        works = (partial(decode, encoded, chosen), *[partial(yield_all, dataset, chosen)] * 2)
        times.append([1e3 * seconds(work) / len(chosen) for work in works])
    imdecode, first, later = (min(column) for column in zip(*times, strict=True))
    return Speed(name, len(encoded[0]), "shuffled" if shuffled else "in order", imdecode, first, later)


def decode(encoded: Sequence[Sequence[bytes]], rows: Sequence[int]) -> None:
    """What any reader must do at least."""
    for row in rows:
        for data in encoded[row]:
            cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)


def yield_all(dataset: Any, rows: Sequence[int]) -> None:
    """What the dataset does."""
    for row in rows:
        dataset[row]


def seconds(work: Callable[[], None]) -> float:
    """Time that the processor spends on one call, whatever else it does meanwhile."""
    start = time.process_time()
    work()
    return time.process_time() - start


if __name__ == "__main__":
    main()
