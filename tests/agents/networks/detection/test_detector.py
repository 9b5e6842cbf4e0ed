import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.agents.networks.detection.detector import Detections, Detector, Raw, boxes_at, iou
from remqa_data.agents.networks.detection.pyramid import CHANNELS

SIDES = st.tuples(*(st.floats(0, 100) for _ in range(4)))


def box(a: float, b: float, c: float, d: float) -> list[float]:
    return [min(a, c), min(b, d), max(a, c) + 1, max(b, d) + 1]


@given(SIDES, SIDES)
def test_overlap_is_a_share_and_whole_only_with_itself(first: tuple[float, ...], second: tuple[float, ...]) -> None:
    boxes = np.array([box(*first), box(*second)], dtype=np.float32)
    shares = iou(boxes, boxes)
    assert np.allclose(shares, shares.T)
    assert np.allclose(shares.diagonal(), 1, atol=1e-5)
    assert ((shares >= 0) & (shares <= 1 + 1e-5)).all()


def test_overlap_of_known_boxes() -> None:
    shares = iou(np.array([[0, 0, 10, 10]], np.float32), np.array([[5, 0, 15, 10], [20, 20, 30, 30]], np.float32))
    assert shares[0].tolist() == pytest.approx([1 / 3, 0])


def test_boxes_are_measured_from_the_middle_of_their_cell_and_end_with_the_picture() -> None:
    sides = torch.tensor([[2.0, 3.0, 4.0, 5.0], [90.0, 90.0, 90.0, 90.0]])
    found = boxes_at(sides, torch.tensor([1, 0]), torch.tensor([2, 0]), (40, 50))
    assert found.tolist() == [[8.0, 3.0, 14.0, 11.0], [0.0, 0.0, 50.0, 40.0]]


def said(detector: Detector, peaks: list[tuple[int, int]]) -> Raw:
    """What a detector could say: middles at some cells, boxes of 8 x 8 pixels."""
    middles = torch.full((1, 10, 10), -9.0)
    for row, column in peaks:
        middles[0, row, column] = 9.0
    features = torch.zeros((1, CHANNELS, 10, 10))
    return Raw(features, middles, torch.full((1, 4, 10, 10), 4.0), torch.zeros((1, 1 + detector.types, 10, 10)))


def test_each_peak_is_one_object() -> None:
    torch.manual_seed(0)
    detector = Detector(3).eval()
    found = detector.read(said(detector, [(2, 2), (7, 5)]), (40, 40))[0]
    middles = {
        tuple(((low + high) / 2).tolist()) for low, high in zip(found.boxes[:, :2], found.boxes[:, 2:], strict=True)
    }
    assert middles == {(10.0, 10.0), (22.0, 30.0)}
    assert (np.diff(found.scores) <= 0).all()


def test_where_nothing_is_nothing_is_found() -> None:
    detector = Detector(3).eval()
    assert len(detector.read(said(detector, []), (40, 40))[0].boxes) == 0


class Twice(Detector):
    """Sees an object of 90 x 90 pixels at the top left of whatever it is shown, and one of 24 x 24 farther down."""

    def __init__(self) -> None:
        super().__init__(1)
        self.rows: list[int] = []

    def forward(self, rgb: torch.Tensor) -> Raw:
        height, width = (-(-side // 4) for side in rgb.shape[-2:])
        self.rows.append(height)
        middles, sides = torch.full((1, height, width), -9.0), torch.full((1, 4, height, width), 45.0)
        middles[0, 8, 8] = middles[0, 20, 12] = 9.0
        sides[0, :, 20, 12] = 12.0
        features = torch.full((1, CHANNELS, height, width), float(height))
        return Raw(features, middles, sides, torch.zeros((1, 1 + self.types, height, width)))


def test_large_things_are_found_in_the_picture_and_small_ones_in_the_enlarged_one() -> None:
    detector = Twice().eval()
    seen, (found,) = detector.look(torch.zeros((1, 3, 100, 100), dtype=torch.uint8))
    assert seen.features.shape == (1, CHANNELS, 25, 25)
    assert (seen.features == 25).all()
    assert detector.rows == [25, 38]
    boxes = sorted(found.boxes.tolist())
    assert boxes[0] == [0.0, 0.0, 79.0, 79.0]  # so large a one is found in the picture itself
    whole_px, x, y = 24 / 1.5, (12 + 0.5) * 4 / 1.5, (20 + 0.5) * 4 / 1.5
    small = [(b[2] - b[0], (b[0] + b[2]) / 2, (b[1] + b[3]) / 2) for b in boxes if b[2] - b[0] < 34]
    assert np.allclose(small, [(whole_px, x, y)], atol=1e-4)


def test_a_mask_has_the_cells_of_its_type_within_its_box_or_else_all_of_it() -> None:
    cells = np.zeros((5, 5), dtype=np.int64)
    cells[1, 1] = cells[4, 4] = 3
    boxes = np.array([[2, 2, 12, 12]], dtype=np.float32)
    found = Detections(np.repeat(boxes, 2, 0), np.array([2, 1]), np.array([0.9, 0.8], np.float32), cells)
    expected = np.zeros((20, 20), dtype=bool)
    expected[4:8, 4:8] = True
    assert (found.mask(0, (20, 20)) == expected).all()
    expected[2:12, 2:12] = True
    assert (found.mask(1, (20, 20)) == expected).all()
