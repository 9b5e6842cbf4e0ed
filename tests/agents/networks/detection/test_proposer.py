import numpy as np
import pytest
import torch
from torch import Tensor

from remqa_data.agents.networks.detection.detector import (
    ENLARGED,
    MOST_PEAKS,
    Detector,
    Peaks,
    Voted,
    apart,
    iou,
    kept_objects,
)
from remqa_data.agents.networks.detection.detector_loss import batch_of, middle_losses, wanted_of
from remqa_data.agents.networks.detection.proposer import Middles, Proposer
from remqa_data.agents.networks.detection.pyramid import CHANNELS, STRIDE
from remqa_data.agents.networks.detection.refiner import CLOSER, LEAST_VOTES, Refiner, TwoStageDetector

NOTHING_SEEN = Peaks(np.zeros((0, 4), np.float32), np.zeros((0, 3), np.float32))
CELLS = 30
FEATURES = torch.zeros(1, CHANNELS, CELLS, CELLS)
AS_IT_IS = FEATURES, 1.0


class Sure(Proposer):
    """Says that one object's middle is in the cell of the row 10 and the column 20, and that it is 24 by 12 pixels large."""

    def forward(self, features: Tensor) -> Middles:
        middles = torch.full((1, CELLS, CELLS), -9.0)
        middles[0, 10, 20] = 3.0
        half = torch.tensor([12.0, 6.0, 12.0, 6.0])
        return Middles(middles, half[None, :, None, None].expand(1, 4, CELLS, CELLS))


def test_boxes_are_in_pixels_of_the_picture_that_was_not_enlarged() -> None:
    x, y = (20 + 0.5) * STRIDE, (10 + 0.5) * STRIDE
    (box,) = Sure().propose([AS_IT_IS], NOTHING_SEEN, LEAST_VOTES)
    assert box.tolist() == pytest.approx(
        [(x - 12) / ENLARGED, (y - 6) / ENLARGED, (x + 12) / ENLARGED, (y + 6) / ENLARGED]
    )


def test_what_both_see_is_proposed_once_by_the_one_that_is_surer() -> None:
    (own,) = Sure().propose([AS_IT_IS], NOTHING_SEEN, LEAST_VOTES)
    seen = np.stack([own + np.float32(0.5), own + np.float32(40)])
    for votes, likelier in ((0.9, own), (0.99, seen[0])):  # its own is as likely as .95
        both = Peaks(seen, np.array([[votes], [0.3]], np.float32))
        boxes = Sure().propose([AS_IT_IS], both, LEAST_VOTES)
        assert boxes.tolist() == [likelier.tolist(), seen[1].tolist()]
    assert len(Sure().propose([AS_IT_IS], NOTHING_SEEN, 0.96)) == 0


def test_what_is_seen_in_a_picture_from_closer_by_is_smaller() -> None:
    (own,) = Sure().propose([AS_IT_IS], NOTHING_SEEN, LEAST_VOTES)
    both = Sure().propose([AS_IT_IS, (FEATURES, 2.0)], NOTHING_SEEN, LEAST_VOTES)
    assert both.tolist() == [own.tolist(), (own / 2).tolist()]
    again = Sure().propose([AS_IT_IS, (FEATURES, 1.01)], NOTHING_SEEN, LEAST_VOTES)
    assert again.tolist() == [own.tolist()]


def test_who_has_learnt_nothing_thinks_objects_rare() -> None:
    torch.manual_seed(0)
    said = Proposer().eval()(torch.randn(2, CHANNELS, CELLS, CELLS))
    assert said.middles.shape == (2, CELLS, CELLS)
    assert said.sides.shape == (2, 4, CELLS, CELLS)
    assert said.middles.sigmoid().mean() < 0.1
    assert 10 < said.sides.median() < 40


def test_boxes_of_one_object_are_told_apart_from_others_by_how_much_they_overlap() -> None:
    boxes = np.array([[0, 0, 10, 10], [0, 0, 10, 8], [0, 0, 10, 4], [30, 30, 40, 40]], dtype=np.float32)
    scores = np.array([0.5, 0.9, 0.4, 0.1], np.float32)
    assert apart(boxes, scores, 0.2) == [1, 2]
    assert apart(boxes, scores, 0.2, 0.85) == [1, 0, 2]
    types = np.array([0, 0, 0, 1])
    assert kept_objects(boxes, types, scores) == [1, 2, 3]
    assert kept_objects(boxes, types, scores, 0.85) == [1, 0, 2, 3]


class Blind(Detector):
    """Sees nothing."""

    def vote(self, rgb: Tensor, least_votes: float = 0.0) -> Voted:
        return Voted([NOTHING_SEEN] * len(rgb), np.zeros((len(rgb), 1, 1), np.int64))


def test_a_second_stage_looks_at_what_is_proposed_too() -> None:
    torch.manual_seed(0)
    first, second = Blind(3), Refiner(3)
    rgb = torch.randint(0, 255, (2, 3, 80, 80), dtype=torch.uint8)
    assert [len(found.boxes) for found in TwoStageDetector(first, second).detect(rgb)] == [0, 0]
    second.proposer = Sure()
    looked = TwoStageDetector(first, second).detect(rgb)
    proposed = Sure().propose([AS_IT_IS, (FEATURES, CLOSER)], NOTHING_SEEN, LEAST_VOTES)
    assert len(proposed) == len(looked) == 2
    for found in looked:
        seen = np.unique(found.boxes, axis=0)
        assert np.allclose(seen, np.unique(proposed, axis=0))  # a stage that has learnt nothing moves none


@pytest.mark.slow
def test_it_learns_where_things_are_by_features_that_tell() -> None:
    torch.manual_seed(0)
    proposer, rng = Proposer(), np.random.default_rng(0)
    optimizer = torch.optim.AdamW(proposer.parameters(), lr=3e-3)
    side = CELLS * STRIDE

    def shown(count: int) -> tuple[Tensor, list[np.ndarray]]:
        features, instances = torch.randn(count, CHANNELS, CELLS, CELLS) / 10, []
        for one in features:
            x, y = rng.integers(10, 60, 2)
            wide, high = rng.integers(24, 56, 2)
            drawn = np.zeros((side, side), np.int32)
            drawn[y : y + high, x : x + wide] = 1
            is_inside = torch.from_numpy(drawn[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE] > 0)
            along = torch.arange(CELLS) * STRIDE + STRIDE / 2
            sides = torch.stack([along - x, x + wide - along, along - y, y + high - along])
            sides = torch.stack(
                [*(sides[:2, None].expand(2, CELLS, CELLS)), *sides[2:, :, None].expand(2, CELLS, CELLS)]
            )
            one[:4] += torch.where(is_inside, sides / 30, 0.0)  # as a backbone would know
            one[4] += is_inside
            instances.append(drawn)
        return features, instances

    for _ in range(60):
        features, instances = shown(8)
        wanted = batch_of([wanted_of(drawn, np.zeros(1, np.int64)) for drawn in instances])
        said = proposer(features)
        loss = sum(middle_losses(said.middles, said.sides, wanted, (side, side)).values(), torch.zeros(()))
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()

    proposer.eval()
    features, instances = shown(20)
    overlaps = []
    for one, drawn in zip(features, instances, strict=True):
        rows, columns = np.nonzero(drawn)
        true = np.array([[columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]], np.float32) / ENLARGED
        boxes = proposer.propose([(one[None], 1.0)], NOTHING_SEEN, 0.0)
        assert len(boxes) <= MOST_PEAKS
        overlaps.append(iou(true, boxes[:1])[0, 0])
    assert np.mean(overlaps) > 0.6
