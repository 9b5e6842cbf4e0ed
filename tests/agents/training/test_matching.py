from pathlib import Path
from unittest.mock import sentinel

import numpy as np
import torch

from remqa_data.agents.networks.detection.regions import Regions
from remqa_data.agents.training.matching import Referred, choices_of, views_with_expressions
from remqa_data.storage.shards import read_table

NUMBERS = torch.zeros((2, 3), dtype=torch.int64)


def regions(*boxes: tuple[int, int, int, int]) -> Regions:
    """Objects of which only the boxes are asked for."""
    return Regions(np.array(boxes, dtype=np.float32), *[sentinel.unused] * 9)


THING, OTHER = (0, 0, 20, 20), (50, 50, 60, 60)
PICTURE = Referred(
    ("a", "b"),
    ("the thing", "the one that nobody sees"),
    np.array([THING, (200, 200, 210, 210)], dtype=np.float32),
    regions((2, 0, 22, 20), OTHER, (6, 0, 26, 20), (14, 0, 34, 20)),  # of the thing .82, 0, .54 and .18
    regions(THING, OTHER),
    np.array([0, -1]),
    np.array([0, 1]),
)


def test_only_what_fits_best_is_right() -> None:
    asked = choices_of(PICTURE, NUMBERS, None, is_true=False)
    assert asked.right.tolist() == [0, -1]
    assert asked.fits.tolist() == [[True, False, False, False], [False] * 4]
    assert asked.regions is PICTURE.found


def test_what_overlaps_what_is_meant_may_be_no_wrong_choice() -> None:
    asked = choices_of(PICTURE, NUMBERS, 0.5, is_true=False)
    assert asked.fits.tolist() == [[True, False, True, False], [False] * 4]
    assert choices_of(PICTURE, NUMBERS, 0.1, is_true=False).fits[0].tolist() == [True, False, True, True]


def test_of_what_is_there_one_is_right() -> None:
    asked = choices_of(PICTURE, NUMBERS, 0.01, is_true=True)
    assert asked.fits.tolist() == [[True, False], [False, True]]
    assert asked.regions is PICTURE.true


def test_questions_say_what_is_meant_in_the_view_before_the_manipulation(two_rooms: Path) -> None:
    rows = read_table(two_rooms, "questions", "train").to_pylist()
    views = list(views_with_expressions(two_rooms, "train"))
    assert len(views) == len(rows) > 0
    for view, row in zip(views, rows, strict=True):
        (said,) = view.rows
        assert said["text"] in row["question"]
        (target,) = (item for item in view.objects if item["id"] == row["target_id"])
        assert target["box_2d"] == said["box_2d"] == row["start_target_box_2d"]
        assert {item["id"] for item in view.objects} <= set(row["object_ids"])
        tilts = [{"LookDown": 30.0, "LookUp": -30.0}.get(action, 0.0) for action in row["actions"]]
        assert view.horizon_deg == row["initial_pose"]["horizon_deg"] + sum(tilts)
        colours, _ = view.reader.images(view.place, view.images)
        assert bytes(colours) == row["start_rgb"]["bytes"]
    assert not list(views_with_expressions(two_rooms, "train", frozenset({"FloorPlan999"})))
