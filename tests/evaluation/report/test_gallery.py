"""What the pictures of the report show."""

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from remqa_data.evaluation.report.gallery import PREDICTED_COLOR, TRUE_COLOR, _draw_boxes, _Map
from remqa_data.evaluation.scoring.replay import load_room
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import EmbodimentRow


def test_a_perfect_box_does_not_hide_the_true_one() -> None:
    image = np.zeros((60, 60, 3), dtype=np.uint8)
    _draw_boxes(image, (20, 20, 40, 40), [20.0, 20.0, 40.0, 40.0])
    for color in (TRUE_COLOR, PREDICTED_COLOR):
        assert (image[30] == color).all(axis=1).any()


@pytest.mark.slow
def test_the_map_is_blank_around_the_room(two_rooms: Path) -> None:
    (row, *_) = read_table(two_rooms, "scenes", "test", ["scene_json", "embodiment"]).to_pylist()
    with closing(load_room(row["scene_json"], "room", EmbodimentRow(**row["embodiment"]))) as replay:
        image = _Map(replay).image
    assert (image[[0, -1]] == 255).all()
    assert (image[:, [0, -1]] == 255).all()
    assert (image[100:200, 100:200] < 250).any(axis=2).mean() > 0.5
