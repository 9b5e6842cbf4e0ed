"""Networks that ground expressions in one stage: what they see, and that words are what tells two things apart."""

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.agents.networks.grounding import (
    CELL_PX,
    SEEN,
    WIDTH,
    CollaborativeGrounder,
    Grounder,
    GroupedGrounder,
    Said,
    Sight,
    agreement_of,
    grounded,
    grouped_attention,
    sight_of,
)
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.training.grounding import Targets, grounding_losses, mask_loss, middles_of, shares_of

FORMS = (CollaborativeGrounder, GroupedGrounder)
SIZE = (6 * CELL_PX, 6 * CELL_PX)


def empty_sight(pictures: int = 1) -> Sight:
    boxes = torch.zeros(pictures, 4, 6, 6)
    down, along = torch.meshgrid(torch.arange(6), torch.arange(6), indexing="ij")
    boxes[:, 0], boxes[:, 1], boxes[:, 2:] = (along + 0.5) * CELL_PX, (down + 0.5) * CELL_PX, 1.25 * CELL_PX
    return Sight(torch.zeros(pictures, SEEN, 6, 6), boxes)


def grounder_of(form: type[Grounder]) -> Grounder:
    torch.manual_seed(0)
    return form(12)


def test_a_sight_has_the_likeliest_middle_of_each_four_cells() -> None:
    torch.manual_seed(0)
    detector, rgb = Detector(3).eval(), torch.randint(0, 255, (2, 3, 50, 42), dtype=torch.uint8)
    sight = sight_of(detector, rgb, torch.full((2, 50, 42), 2.0))
    assert sight.cells.shape == (2, SEEN, 7, 6)  # 13 x 11 cells of the detector
    raw = detector(rgb)
    quarter = raw.middles[1, 2:4, 4:6].flatten()
    best = int(quarter.argmax())
    row, column = 2 + best // 2, 4 + best % 2
    left, up, right, down = raw.sides[1, :, row, column].tolist()
    x, y = (column + 0.5) * STRIDE, (row + 0.5) * STRIDE
    wanted = [x + (right - left) / 2, y + (down - up) / 2, left + right, up + down]
    assert sight.boxes[1, :, 1, 2].tolist() == pytest.approx(wanted, rel=1e-4)
    assert torch.allclose(sight.cells[1, :64, 1, 2], raw.features[1, :, row, column])
    assert sight.cells[:, 129].numpy() == pytest.approx(np.log(2.0))  # how far


@pytest.mark.parametrize("form", FORMS)
def test_each_expression_is_about_its_own_picture_and_padding_is_not_read(form: type[Grounder]) -> None:
    network, sight = grounder_of(form).eval(), empty_sight(2)
    sight.cells.copy_(torch.randn(sight.cells.shape, generator=torch.Generator().manual_seed(1)))
    numbers = torch.tensor([[2, 3, 4], [2, 3, 4], [5, 6, 0]])
    said = network(numbers, sight, torch.tensor([0, 1, 1]))
    alone = network(torch.tensor([[5, 6]]), Sight(sight.cells[1:], sight.boxes[1:]), torch.tensor([0]))
    assert torch.allclose(said.places[2], alone.places[0], atol=1e-4)
    assert not torch.allclose(said.places[0], said.places[1], atol=1e-3)
    assert said.boxes.shape == (3, 4, 6, 6)


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_it_learns_that_words_tell_two_things_apart(form: type[Grounder]) -> None:
    sight = empty_sight()
    sight.cells[0, 0, 1, 1] = sight.cells[0, 1, 4, 3] = 3.0  # two things, which look differently
    numbers, which = torch.tensor([[2, 3], [2, 4]]), torch.zeros(2, dtype=torch.int64)
    boxes = torch.tensor([[5.0, 6, 20, 17], [23, 30, 33, 42]])
    pixels = np.zeros((2, *SIZE), dtype=bool)
    for shown, (x1, y1, x2, y2) in zip(pixels, boxes.int().tolist(), strict=True):
        shown[y1:y2, x1:x2] = True
    masks = torch.from_numpy(np.stack([shares_of(shown) for shown in pixels]))
    network = grounder_of(form)
    optimizer = torch.optim.AdamW(network.parameters(), lr=0.003)
    with one_thread():
        for _ in range(120):
            said = network(numbers, sight, which)
            losses = grounding_losses(said, Targets(boxes, masks), SIZE, is_looking_taught=form is GroupedGrounder)
            optimizer.zero_grad()
            losses["loss"].backward()
            optimizer.step()
        found = grounded(network.eval()(numbers, sight, which), SIZE)
    assert len(found) == 2
    for one, box, shown in zip(found, boxes.numpy(), masks.numpy(), strict=True):
        assert one.box == pytest.approx(box, abs=2)
        assert (one.mask == (shown > 0.5)).mean() > 0.9


def test_middles_are_the_inner_cells_or_the_nearest_one() -> None:
    shares = middles_of(torch.tensor([[0.0, 0, 48, 48], [17, 9, 20, 12]]), 6, 6)
    assert shares.sum((1, 2)).tolist() == pytest.approx([1, 1])
    assert torch.nonzero(shares[0]).tolist() == [[2, 2], [2, 3], [3, 2], [3, 3]]
    assert torch.nonzero(shares[1]).tolist() == [[1, 2]]


def test_shares_count_pixels() -> None:
    shown = np.zeros((10, 16), dtype=bool)
    shown[:4, :8] = shown[8:, 8:] = True
    assert shares_of(shown).tolist() == [[0.5, 0], [0, 0.25]]  # the last row of cells is cut off


def test_a_mask_that_is_right_costs_nothing_and_a_small_one_counts() -> None:
    wanted = torch.zeros(2, 6, 6)
    wanted[0, 2, 2] = 1
    wanted[1, :4] = 1
    right = (wanted * 2 - 1) * 30
    assert float(mask_loss(right, wanted)) == pytest.approx(0, abs=1e-6)
    missed = right.clone()
    missed[0, 2, 2] = -30
    assert float(mask_loss(missed, wanted)) > 0.25


def test_boxes_are_cut_at_the_edges_and_masks_count_less_outside_and_are_not_empty() -> None:
    places, masks = torch.zeros(1, 6, 6), torch.full((1, 6, 6), -3.0)
    places[0, 1, 5] = 5
    boxes = torch.zeros(1, 4, 6, 6)
    boxes[0, :, 1, 5] = torch.tensor([30.0, 5, 60, 25])
    said = Said(places, boxes, masks, places[:, None], torch.ones(1))
    (found,) = grounded(said, SIZE)
    assert found.box.tolist() == [30, 5, 48, 25]
    assert np.argwhere(found.mask).tolist() == [[1, 5]]
    masks[0, 2, 4], masks[0, 5, 0] = 1.0, 1.0
    (found,) = grounded(said, SIZE)
    assert np.argwhere(found.mask).tolist() == [[2, 4]]


def test_groups_attend_to_words_by_themselves() -> None:
    seen, words = torch.zeros(1, WIDTH, 1, 1), torch.zeros(1, 3, WIDTH)
    seen[0, 0] = seen[0, 16] = 100.0
    words[0, 0, 0], words[0, 1, 16] = 10.0, 10.0  # the first group knows the first word, the second one the second
    values = torch.arange(3.0)[None, :, None].expand(1, 3, WIDTH).clone()
    found = grouped_attention(seen, words, values, torch.tensor([[True, True, False]]))[0, :, 0, 0]
    assert found[:16].tolist() == pytest.approx([0.0] * 16, abs=1e-5)
    assert found[16:32].tolist() == pytest.approx([1.0] * 16, abs=1e-5)
    assert found[32:].tolist() == pytest.approx([0.5] * 32)  # no reason to prefer one; the third is padding


def test_branches_agree_that_look_at_the_same() -> None:
    here, there = torch.full((1, 4, 4), -20.0), torch.full((1, 4, 4), -20.0)
    here[0, 0, 0] = there[0, 3, 3] = 20.0
    seen = torch.zeros(1, 2, 4, 4)
    seen[0, 0, :2], seen[0, 1, 2:] = 1.0, 1.0
    assert float(agreement_of(here, here, seen, seen)) == pytest.approx(1.0, abs=1e-4)
    assert float(agreement_of(here, there, seen, seen)) == pytest.approx(0.5, abs=1e-4)
