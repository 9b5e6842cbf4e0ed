import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.detector_loss import (
    LEAST_PIXELS,
    NOTHING,
    batch_of,
    box_loss,
    detector_losses,
    heat_loss,
    wanted_of,
)
from remqa_data.agents.networks.detection.pyramid import STRIDE


def instances() -> np.ndarray:
    """A picture of 40 x 40 with a large object, a small one before it, and one of a few pixels."""
    found = np.zeros((40, 40), dtype=np.int32)
    found[8:32, 8:32] = 1
    found[16:24, 16:24] = 2
    found[0:2, 0:2] = 3
    return found


def test_each_object_has_one_middle_and_the_smaller_one_is_before_the_larger() -> None:
    wanted = wanted_of(instances(), np.array([4, 7, 5]))
    assert torch.nonzero(wanted.heat == 1).tolist() == [
        [5, 5]
    ]  # both have their middle at (20, 20); the third is too small
    assert wanted.types[5, 5] == 7
    assert wanted.boxes[:, 5, 5].tolist() == [16, 16, 24, 24]
    assert wanted.types[1, 1] == NOTHING
    assert wanted.cells[5, 5] == 8
    assert wanted.cells[3, 3] == 5
    assert wanted.cells[0, 0] == 0


def test_what_is_too_small_for_a_box_is_still_what_its_cell_shows() -> None:
    found = instances()
    found[1:4, 1:4] = 3
    middle = STRIDE // 2
    assert found[middle, middle] == 3
    assert (found == 3).sum() < LEAST_PIXELS
    wanted = wanted_of(found, np.array([4, 7, 5]))
    assert wanted.cells[0, 0] == 5 + 1
    assert wanted.types[0, 0] == NOTHING
    assert wanted.heat[0, 0] < 1


def test_what_is_not_looked_for_is_background() -> None:
    wanted = wanted_of(instances(), np.array([NOTHING, 7, NOTHING]))
    assert set(wanted.cells.unique().tolist()) == {0, 8}


def test_small_things_weigh_more_than_large_ones() -> None:
    weights = wanted_of(instances(), np.array([4, 7, 5])).weights
    assert weights[5, 5] > weights[3, 3]


def test_the_loss_of_boxes_is_that_of_the_publication() -> None:
    said = torch.tensor([[0.0, 0.0, 10.0, 10.0], [0.0, 0.0, 10.0, 10.0], [0.0, 0.0, 10.0, 10.0]])
    wanted = torch.tensor([[0.0, 0.0, 10.0, 10.0], [5.0, 0.0, 15.0, 10.0], [20.0, 0.0, 30.0, 10.0]])
    # GIoU = IoU - (hull - union) / hull: 1; 1/3 - 0; 0 - 100 / 300.
    assert box_loss(said, wanted).tolist() == pytest.approx([0, 2 / 3, 4 / 3], abs=1e-5)


def test_a_heatmap_that_is_right_costs_nothing_and_one_that_is_sure_and_wrong_much() -> None:
    heat = torch.zeros((1, 4, 4))
    heat[0, 1, 1] = 1
    sure = torch.where(heat == 1, 20.0, -20.0)
    assert float(heat_loss(sure, heat)) < 1e-6
    assert float(heat_loss(-sure, heat)) > 100


@pytest.mark.slow
def test_a_detector_learns_a_picture_by_heart() -> None:
    torch.manual_seed(0)
    detector = Detector(9)
    picture = torch.from_numpy(np.stack([instances() * 80] * 3)[None].astype(np.uint8))
    wanted = batch_of([wanted_of(instances(), np.array([4, 7, 5]))])
    optimizer = torch.optim.Adam(detector.parameters(), lr=3e-3)
    losses = []
    for _ in range(60):
        found = detector_losses(detector, detector(picture), wanted, (40, 40))["loss"]
        optimizer.zero_grad()
        found.backward()
        optimizer.step()
        losses.append(float(found.detach()))
    assert losses[-1] < losses[0] / 10
    seen = detector.read(detector(picture), (40, 40))[0]
    assert seen.types[0] == 7
    assert np.abs(seen.boxes[0] - [16, 16, 24, 24]).max() < 4
