"""What the weights that come with the package say to a slice of the test split of data version 1.0.

`python -m tests.helpers.weights_slice DATASET` writes the slice anew, with what they say now: when weights have changed.
"""

import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import torch

from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.networks.committee import alone
from remqa_data.agents.networks.detection.regions import AnyDetector
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.agents.parts.network_answerer import NetworkAnswerer
from remqa_data.agents.parts.network_localizer import NetworkLocalizer
from remqa_data.agents.training.config import MatcherConfig, is_committee
from remqa_data.agents.training.weights import load_committee, load_network, trained_detector, weights_path
from remqa_data.datasets.random_access import SplitReader
from remqa_data.tables.images import decode_depth, decode_rgb

HERE = Path(__file__).resolve().parents[1] / "agents" / "data"
QUESTIONS, EXPRESSIONS = HERE / "questions.parquet", HERE / "expressions.parquet"
QUESTION_COLUMNS = ("question", "answer", "start_target_box_2d")
EXPRESSION_COLUMNS = ("text", "box_2d", "frame_id")
EVERY_QUESTION, EVERY_EXPRESSION = 15, 110
MATCHERS = ("language_attention", "anchored_matcher", "three_matchers")
SIZE_PX = 300

Row = dict[str, Any]


@cache
def answerer() -> NetworkAnswerer:
    network, about = load_network(weights_path("answerer"))
    return NetworkAnswerer(network, about.vocabulary)


@cache
def seen_through(network: MatcherConfig) -> AnyDetector:
    """What a matcher sees through; it looks at a picture only once if it is asked about it again and again."""
    detector = trained_detector(network, None, None, force=True)
    look, last = detector.look, {}

    def remembered(rgb: torch.Tensor) -> Any:
        picture = rgb.numpy().tobytes()
        if picture not in last:
            last.clear()
            last[picture] = look(rgb)
        return last[picture]

    detector.look = remembered
    return detector


@cache
def localizer(name: str) -> NetworkLocalizer:
    """A matcher or a committee of a name, and what it sees through."""
    if is_committee(name):
        committee, about = load_committee(name)
    else:
        matcher, about = load_network(weights_path(name))
        committee = alone(matcher, about.vocabulary)
    return NetworkLocalizer(seen_through(about.network.network), committee)


def said_answer(row: Row) -> str | None:
    """The answer to a stored question, from its stored views."""
    depth = np.zeros((SIZE_PX, SIZE_PX), dtype=np.float32)
    before, after = (SimpleNamespace(rgb=decode_rgb(row[name]), depth=depth) for name in ("start_rgb", "end_rgb"))
    box = None if row["start_target_box_2d"] is None else tuple(np.array(row["start_target_box_2d"]) / SIZE_PX)
    sighting = None if box is None else Sighting(box, (0.5, 0.5))
    return answerer().answer(read_question(row["question"]), before, after, sighting)


def said_box(row: Row, name: str) -> list[float] | None:
    """The box of what a stored expression means to a matcher of a name, pixels."""
    pose = SimpleNamespace(horizon_deg=row["horizon_deg"])
    percept = SimpleNamespace(rgb=decode_rgb(row["rgb"]), depth=decode_depth(row["depth"]), pose=pose)
    sighting = localizer(name).locate(
        SimpleNamespace(expression=row["text"], manipulation=None), None, percept, np.random.default_rng(0)
    )
    return None if sighting is None else [round(SIZE_PX * share, 2) for share in sighting.box]


def rows_of(path: Path) -> list[Row]:
    return pq.read_table(path).to_pylist()


def said_boxes(row: Row) -> dict[str, list[float] | None]:
    """The same for all matchers and committees of the slice."""
    return {name: said_box(row, name) for name in MATCHERS}


def main(root: Path) -> None:
    questions, expressions, frames = (
        SplitReader(root, table, "test") for table in ("questions", "expressions", "frames")
    )
    rows = questions.columns(QUESTION_COLUMNS).to_pylist()
    found = []
    for place in range(0, len(rows), EVERY_QUESTION):
        images = questions.images(place, ("start_rgb", "end_rgb"))
        row = rows[place] | dict(zip(("start_rgb", "end_rgb"), map(bytes, images), strict=True))
        found.append(row | {"said": said_answer(row)})
    pq.write_table(pa.Table.from_pylist(found), QUESTIONS)
    rows = expressions.columns(EXPRESSION_COLUMNS).to_pylist()
    shown = frames.columns(["frame_id", "agent"])
    places = {name: place for place, name in enumerate(shown["frame_id"].to_pylist())}
    found = []
    for place in range(0, len(rows), EVERY_EXPRESSION):
        frame = places[rows[place]["frame_id"]]
        images = frames.images(frame, ("rgb", "depth"))
        row = rows[place] | dict(zip(("rgb", "depth"), map(bytes, images), strict=True))
        row["horizon_deg"] = shown["agent"][frame].as_py()["horizon_deg"]
        found.append(row | {f"{name}_said": box for name, box in said_boxes(row).items()})
    pq.write_table(pa.Table.from_pylist(found), EXPRESSIONS)


if __name__ == "__main__":
    HERE.mkdir(exist_ok=True)
    main(Path(sys.argv[1]))
