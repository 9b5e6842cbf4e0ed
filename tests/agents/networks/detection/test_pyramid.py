import pytest
import torch

from remqa_data.agents.networks.detection.pyramid import CHANNELS, STRIDE, Pyramid, features_in


@pytest.mark.parametrize(("height", "width"), [(300, 300), (64, 96), (65, 33)])
def test_a_cell_of_the_features_is_four_pixels_wide(height: int, width: int) -> None:
    pictures = torch.zeros((2, 3, height, width), dtype=torch.uint8)
    assert Pyramid().eval()(pictures).shape == (2, CHANNELS, -(-height // STRIDE), -(-width // STRIDE))


def test_features_in_a_box_are_those_that_lie_there() -> None:
    column = torch.arange(10.0).view(1, 1, 1, 10).expand(2, 1, 10, 10)  # feature k is at x = 4 k + 2
    features = torch.stack([column[0], column[1] + 100])
    boxes = torch.tensor([[2.0, 2.0, 38.0, 38.0], [4.0, 4.0, 8.0, 8.0]])
    found = features_in(features, torch.stack([boxes, boxes.flip(0)]), 3)
    assert found.shape == (2, 2, 1, 3, 3)
    assert torch.allclose(found[0, 0, 0], torch.tensor([1.5, 4.5, 7.5]).expand(3, 3))  # x = 8, 20 and 32
    assert torch.allclose(found[0, 1, 0, 1, 1], torch.tensor(1.0))
    assert torch.allclose(found[1], found[0].flip(0) + 100)
