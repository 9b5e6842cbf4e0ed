from dataclasses import replace
from pathlib import Path
from unittest.mock import sentinel

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.box_head import BoxHead
from remqa_data.agents.networks.detection.detector import iou
from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.detection.regions import GRID, PLACE, Regions
from remqa_data.agents.networks.matcher import Match
from remqa_data.agents.training.matching import (
    Choices,
    MatchingTask,
    Referred,
    fitting_loss,
    rights_of,
    views_with_expressions,
)
from remqa_data.storage.shards import read_table


def regions(*boxes: tuple[int, int, int, int], are_known: bool = False) -> Regions:
    """Objects of which only the boxes are asked for."""
    return Regions(np.array(boxes, dtype=np.float32), *[sentinel.unused] * 10, (300, 300), are_known)


THING, OTHER = (0, 0, 20, 20), (50, 50, 60, 60)
FOUND = regions((2, 0, 22, 20), OTHER, (6, 0, 26, 20), (14, 0, 34, 20))  # of the thing .82, 0, .54 and .18
PICTURE = Referred(
    ("a", "b"),
    ("the thing", "the one that nobody sees"),
    np.array([THING, (200, 200, 210, 210)], dtype=np.float32),
    FOUND,
    regions(THING, OTHER, are_known=True),
    np.array([0, 1]),
)


def test_only_what_fits_best_is_right() -> None:
    right, spared = rights_of(PICTURE, FOUND, FOUND.boxes, None)
    assert right.tolist() == [0, -1]
    assert spared.tolist() == [[True, False, False, False], [False] * 4]


def test_what_overlaps_what_is_meant_may_be_no_wrong_choice() -> None:
    right, spared = rights_of(PICTURE, FOUND, FOUND.boxes, 0.5)
    assert right.tolist() == [0, -1]
    assert spared.tolist() == [[True, False, True, False], [False] * 4]
    assert rights_of(PICTURE, FOUND, FOUND.boxes, 0.1)[1][0].tolist() == [True, False, True, True]


def test_what_is_right_follows_from_where_boxes_are_moved_to() -> None:
    moved = FOUND.boxes.copy()
    moved[3] = THING
    right, spared = rights_of(PICTURE, FOUND, moved, 0.5)
    assert right.tolist() == [3, -1]
    assert spared[0].tolist() == [True, False, True, True]


def test_of_what_is_there_one_is_right() -> None:
    right, spared = rights_of(PICTURE, PICTURE.true, PICTURE.true.boxes, 0.01)
    assert right.tolist() == [0, 1]
    assert spared.tolist() == [[True, False], [False, True]]


class Weighed(torch.nn.Module):
    """Says that all regions fit as well."""

    box_head = None

    def __init__(self) -> None:
        super().__init__()
        self.weight = torch.nn.Parameter(torch.ones(()))

    def match(self, numbers: torch.Tensor, regions: Regions) -> Match:
        return Match(self.weight.expand(len(numbers), len(regions.boxes)), torch.empty(0), torch.empty(0))


def test_pictures_without_what_is_meant_teach_nothing_and_stop_nobody() -> None:
    task = MatchingTask.__new__(MatchingTask)
    task.model, task.device, task.spared_iou = Weighed(), "cpu", None  # type: ignore[assignment]
    elsewhere = regions(OTHER)
    batch = [Choices(torch.zeros((2, 3), dtype=torch.int64), elsewhere, replace(PICTURE, found=elsewhere))]
    losses = task.losses(batch)
    losses["loss"].backward()
    assert float(losses["loss"].detach()) == float(task.model.weight.grad) == 0.0
    assert float(losses["right"]) == 0.0


@pytest.mark.slow
def test_boxes_learn_to_end_where_their_objects_do_and_how_well_they_fit() -> None:
    """Four boxes of one thing that are off by a half to each side, and one of nothing, told apart by what is seen in them."""
    torch.manual_seed(0)
    thing = np.array([[100, 100, 140, 140]], dtype=np.float32)
    shifts = np.array([[10, 0], [-10, 0], [0, 10], [0, -10]], dtype=np.float32)
    boxes = np.concatenate([thing + np.tile(shifts, 2), [[200, 10, 240, 50]]]).astype(np.float32)
    looks = torch.zeros((5, CHANNELS, GRID, GRID))
    looks[range(5), range(5)] = 4.0
    colors, *unseen = [sentinel.unused] * 5
    places = torch.zeros((5, PLACE))
    found = Regions(boxes, looks, colors, torch.ones((5, 1)), places, *unseen, places, torch.ones(5), (300, 300), False)
    head = BoxHead(1)
    optimizer = torch.optim.Adam(head.parameters(), 0.01)
    for _ in range(150):
        (fit,) = head([found])
        loss = fitting_loss(fit, boxes, thing)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    (fit,) = head.eval()([found])
    overlaps = iou(fit.boxes.numpy(force=True), thing)[:, 0]
    assert iou(boxes, thing)[:4].max() == pytest.approx(0.6)
    assert overlaps[:4].min() > 0.8
    assert fit.quality.sigmoid().tolist() == pytest.approx(overlaps.tolist(), abs=0.1)
    nothing = fitting_loss(fit, boxes, np.zeros((0, 4), dtype=np.float32))
    assert float(nothing.detach()) > 1  # all that is found is wrong then


@pytest.mark.slow
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
