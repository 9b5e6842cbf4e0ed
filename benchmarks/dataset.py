"""How fast the PyTorch datasets yield, against cv2.imdecode alone on the same images; all on one core.

`python benchmarks/dataset.py [DIR]` measures a finished dataset; without one, two rooms are generated first.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
from measure import OUTPUT, Benchmark, Facts, Headline, Table

from remqa_data.datasets.torch_datasets import ExpressionDataset, FrameDataset, RemqaDataset
from remqa_data.storage.manifest import MANIFEST, load_manifest
from remqa_data.storage.shards import read_table

ROOMS, ROOMS_DATASET = ("FloorPlan1", "FloorPlan27"), OUTPUT / "two_rooms"
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


def measure(arguments: list[str]) -> Facts:
    """Time every dataset, in order and shuffled."""
    cv2.setNumThreads(1)
    torch.set_num_threads(1)
    root = Path(arguments[0]) if arguments else two_rooms(ROOMS_DATASET)
    split = load_manifest(root).splits("questions")[0]
    kinds: list[tuple[str, str, Callable[[], Any]]] = [
        ("questions, all images", "questions", lambda: RemqaDataset(root, split)),
        ("questions, RGB", "questions", lambda: RemqaDataset(root, split, images=("start_rgb", "end_rgb"))),
        ("frames, all images", "frames", lambda: FrameDataset(root, split)),
        ("frames, RGB", "frames", lambda: FrameDataset(root, split, images=("rgb",))),
    ]
    speeds = [
        time_dataset(name, make, encoded_images(root, table, split, make().images), shuffled)
        for name, table, make in kinds
        for shuffled in (False, True)
    ]
    return {"speeds": [asdict(speed) for speed in [*speeds, expressions(root, split)]]}


def table(facts: Facts) -> Table:
    """Milliseconds, and ratios to imdecode."""
    speeds = [Speed(**speed) for speed in facts["speeds"]]
    rows = [
        (
            f"{speed.dataset}, {speed.order}",
            str(speed.images),
            *(f"{figure:.2f}" for figure in (speed.imdecode_ms, speed.dataset_ms, speed.ratio, speed.first_ratio)),
        )
        for speed in speeds
    ]
    headings = ("dataset", "images", "imdecode, ms", "dataset, ms", "ratio", "ratio, first time")
    return Table("Samples on one core", headings, rows)


def headlines(facts: Facts) -> list[Headline]:
    """The dataset that is furthest from imdecode, and samples a second of the largest."""
    speeds = [Speed(**speed) for speed in facts["speeds"]]
    worst = min(speeds, key=lambda speed: speed.ratio)
    samples_per_s = [1e3 / speed.dataset_ms for speed in speeds if speed.dataset == "questions, all images"]
    return [
        Headline(f"Dataset ({worst.dataset}, {worst.order})", worst.ratio, "of imdecode's speed", at_least=0.7),
        Headline("Dataset, questions with 6 images", min(samples_per_s), "samples/s"),
    ]


def two_rooms(root: Path) -> Path:
    """A small dataset with pictures of the published size, generated once."""
    if not (root / MANIFEST).is_file():
        from remqa_data.generators.config import load_config
        from remqa_data.generators.pipeline import generate

        config = load_config("paper")
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
    return time_dataset(
        "expressions, RGB", lambda: ExpressionDataset(root, split), [[encoded[name]] for name in names], True
    )


def time_dataset(name: str, make: Callable[[], Any], encoded: Sequence[Sequence[bytes]], shuffled: bool) -> Speed:
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


BENCHMARK = Benchmark("dataset", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
