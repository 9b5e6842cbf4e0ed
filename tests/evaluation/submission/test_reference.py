"""What the reference submissions hold."""

from pathlib import Path

import numpy as np
import pytest

from remqa_data.evaluation.submission import reference
from remqa_data.evaluation.submission.reference import reference_rows
from tests.helpers.dataset_rows import HEIGHT, WIDTH


def random_boxes(data: Path) -> list[list[int]]:
    return [row["box"] for row in reference_rows("random", data, "rec", "test", np.random.default_rng(0))]


def test_random_boxes_lie_in_their_frames_and_are_of_all_sizes(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    boxes = np.array(random_boxes(data))
    assert (boxes <= [WIDTH, HEIGHT, WIDTH, HEIGHT]).all()
    assert boxes.max() > WIDTH / 2
    monkeypatch.setattr(reference, "image_size", lambda picture: (300, 300))
    drawn = np.random.default_rng(0).integers(0, 301, (len(boxes), 2, 2))
    assert random_boxes(data) == np.sort(drawn, axis=2).swapaxes(1, 2).reshape(-1, 4).tolist()
