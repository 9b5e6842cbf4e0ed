from pathlib import Path

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.training.detection import RefinementTask
from remqa_data.agents.training.pictures import detector_types, shown_in


@pytest.mark.slow
def test_the_second_stage_begins_with_the_first_ones_backbone_and_leaves_that_as_it_is(two_rooms: Path) -> None:
    torch.manual_seed(0)
    detector = Detector(len(detector_types()))
    task = RefinementTask([two_rooms], 96, detector, scored=1)
    before = {name: value.clone() for name, value in detector.state_dict().items()}
    of_first, of_second = detector.backbone.state_dict(), task.model.backbone.state_dict()
    assert len(of_first) > 20
    assert all(torch.equal(of_second[name], value) for name, value in of_first.items())
    optimizer = torch.optim.AdamW(task.model.train().parameters(), lr=1e-3)
    losses = task.losses(task.batch(np.arange(2), [np.random.default_rng(number) for number in range(2)]))
    losses["loss"].backward()
    optimizer.step()
    assert all(torch.equal(detector.state_dict()[name], value) for name, value in before.items())
    learnt = dict(task.model.backbone.named_parameters())
    assert not any(torch.equal(value, of_first[name]) for name, value in learnt.items())


def test_of_what_a_picture_does_not_show_there_are_no_pixels() -> None:
    instances = np.zeros((6, 8), dtype=np.int32)
    instances[1:3, 2:7], instances[2, 4] = 1, 3
    pixels, boxes = shown_in(instances, 4)
    assert pixels.tolist() == [9, 0, 1, 0]
    assert boxes.tolist() == [[2, 1, 7, 3], [0, 0, 0, 0], [4, 2, 5, 3], [0, 0, 0, 0]]
