import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.detector import Detector, Peaks, Voted, iou
from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.detection.refiner import (
    CLOSER,
    GRID,
    MARGIN,
    Refined,
    RefinedDetections,
    Refiner,
    TwoStageDetector,
    moved,
    with_margin,
)
from remqa_data.agents.training import detection
from remqa_data.agents.training.detection import (
    JITTER,
    MOST_BOXES,
    asked_again,
    objects_of,
    overlaps_of,
    refiner_losses,
    shown_of,
)
from remqa_data.agents.training.pictures import Picture

BOXES = torch.tensor([[10.0, 20.0, 30.0, 60.0], [50.0, 50.0, 52.0, 90.0]])
THING = (40, 30, 70, 90)
"""x1, y1, x2, y2 of a thing in the pictures here."""

PICTURE_PX = 96

ROUGH = np.array([[26, 26, 74, 74]], np.float32)


def test_a_margin_leaves_the_middle_where_it_is_and_thin_things_get_more() -> None:
    seen = with_margin(BOXES)
    assert torch.allclose((seen[:, :2] + seen[:, 2:]) / 2, (BOXES[:, :2] + BOXES[:, 2:]) / 2)
    assert (seen[:, 2:] - seen[:, :2]).flatten().tolist() == pytest.approx([32.0, 64.0, 8 * MARGIN, 64.0])


def test_sides_move_by_shares_of_the_box() -> None:
    shares = torch.tensor([[0.5, 0.0, 0.0, 0.25], [0.0, 0.0, 0.5, 0.0]])
    assert moved(BOXES, shares).tolist() == [[20.0, 20.0, 30.0, 70.0], [50.0, 50.0, 56.0, 90.0]]


def test_who_has_learnt_nothing_leaves_boxes_as_they_are() -> None:
    torch.manual_seed(0)
    rgb = torch.randint(0, 255, (1, 3, 96, 96), dtype=torch.uint8)
    refiner = Refiner(3).eval()
    features = refiner.see(rgb)
    assert features.shape == (1, CHANNELS, 36, 36)
    said = refiner(rgb, features, BOXES[None])
    assert torch.equal(said.boxes, BOXES)
    assert said.kinds.shape == (2, 4)
    assert said.shapes.shape == (2, GRID, GRID)


def test_a_mask_is_the_part_of_the_box_that_was_said_to_be_the_object() -> None:
    left = np.zeros((2, 1, GRID, GRID), dtype=np.float32)
    left[..., : GRID // 2] = 1
    looked_at = np.array([[[0, 0, 24, 24]]] * 2, dtype=np.float32)
    boxes = np.array([[4, 4, 20, 20]], dtype=np.float32)
    none = np.zeros((1, 1), dtype=np.int64)
    found = RefinedDetections(boxes, np.zeros(1, np.int64), np.ones(1, np.float32), none, looked_at, left)
    expected = np.zeros((30, 40), dtype=bool)
    expected[4:20, 4:12] = True
    assert (found.mask(0, (30, 40)) == expected).all()
    nothing = RefinedDetections(boxes, found.types, found.scores, none, looked_at, 0 * left)
    other = left.copy()
    other[1] = 0.3
    unsure = RefinedDetections(boxes, found.types, found.scores, none, looked_at, other)
    assert (unsure.mask(0, (30, 40)) == expected).all()  # one look is surer than the other
    expected[4:20, 4:20] = True
    assert (nothing.mask(0, (30, 40)) == expected).all()


def picture(x1: int, y1: int, x2: int, y2: int) -> Picture:
    """A red thing of type 2 on grey, and a speck that is too small to be asked for."""
    rgb, instances = np.full((96, 96, 3), 90, dtype=np.uint8), np.zeros((96, 96), dtype=np.int32)
    rgb[y1:y2, x1:x2] = (220, 40, 40)
    instances[y1:y2, x1:x2] = 1
    instances[0, 0] = 2
    return Picture(rgb, instances, np.array([2, 1]))


def test_what_is_looked_at_again_has_the_truth_beside_it() -> None:
    asked = picture(*THING)
    assert objects_of(asked).boxes.tolist() == [list(THING)]
    two = [asked, picture(10, 10, 50, 30)]
    shown = shown_of(two, [np.random.default_rng(number) for number in range(2)])
    seen = torch.tensor([[38.0, 28.0, 72.0, 92.0], [0.0, 0.0, 20.0, 20.0]]).repeat(2, 1, 1)
    made = asked_again(seen, shown)
    assert made.kinds.sort(1).values.tolist() == [[0, 3, 3], [0, 0, 3]]  # as it was seen, and moved a little
    of_thing = made.kinds == 3
    assert (made.true[0][of_thing[0]] == torch.tensor(THING)).all()
    assert (made.true[1][of_thing[1]] == torch.tensor([10, 10, 50, 30])).all()
    shares = (made.boxes[0][of_thing[0]] - torch.tensor(THING)) / torch.tensor([30, 60, 30, 60])
    assert shares.abs().max() < 5 * JITTER
    as_seen = made.shapes[0][made.boxes[0, :, 0] == 38][0].numpy()
    steps = (np.arange(GRID) + 0.5) / GRID
    across, down = 55 + (steps - 0.5) * 34 * MARGIN, 60 + (steps - 0.5) * 64 * MARGIN
    inside = ((down >= 30) & (down < 90))[:, None] & ((across >= 40) & (across < 70))
    assert (as_seen == inside).all()
    assert 0 < inside.mean() < 1


def test_objects_and_none_are_looked_at_alike_often() -> None:
    shown = shown_of([picture(*THING)], [np.random.default_rng(0)])
    of_it = torch.tensor(THING) + torch.arange(30.0)[:, None] / 10
    nowhere = torch.tensor([0.0, 0.0, 20.0, 20.0]).repeat(40, 1)
    made = asked_again(torch.cat([of_it, nowhere])[None], shown)
    assert made.boxes.shape == (1, MOST_BOXES, 4)
    assert int((made.kinds > 0).sum()) == MOST_BOXES // 2
    chosen = made.boxes[0][made.kinds[0] > 0]
    assert len({tuple(box) for box in chosen.tolist()}) == MOST_BOXES // 2


def test_in_an_empty_picture_nothing_is_taken_for_an_object() -> None:
    empty = Picture(np.zeros((50, 50, 3), np.uint8), np.zeros((50, 50), np.int32), np.zeros(0, np.int64))
    shown = shown_of([empty], [np.random.default_rng(0)])
    made = asked_again(torch.tensor([[0.0, 0.0, 20.0, 20.0]]).repeat(1, 40, 1), shown)
    assert made.boxes[0].tolist() == [[0.0, 0.0, 20.0, 20.0]] * MOST_BOXES
    assert not made.kinds.any()
    assert not made.shapes.any()


def test_overlaps_are_those_of_arrays() -> None:
    rng = np.random.default_rng(0)
    low = rng.uniform(0, 40, (2, 6, 2))
    boxes = np.concatenate([low, low + rng.uniform(0, 30, low.shape)], 2).astype(np.float32)
    found = overlaps_of(torch.from_numpy(boxes), torch.from_numpy(boxes[:, :3]))
    assert found.shape == (2, 6, 3)
    for each, one in zip(found.numpy(), boxes, strict=True):
        assert np.allclose(each, iou(one, one[:3]), atol=1e-6)


class Rough(Detector):
    """Sees one thing in the middle of each picture, and not where it ends."""

    def vote(self, rgb: torch.Tensor, least_votes: float = 0.0) -> Voted:
        rough = Peaks(ROUGH, np.ones((1, self.types), np.float32) / self.types)
        return Voted([rough] * len(rgb), np.zeros((len(rgb), 1, 1), np.int64))


class Thin(Rough):
    """Sees a line."""

    def vote(self, rgb: torch.Tensor, least_votes: float = 0.0) -> Voted:
        line = np.array([[50, 10, 52, 90]], np.float32)
        return super().vote(rgb)._replace(peaks=[Peaks(line, np.ones((1, self.types), np.float32))] * len(rgb))


class Biased(Refiner):
    """Sees type 0 in pictures as they are and type 1 in larger ones, and left sides moved by as many pixels."""

    def forward(self, rgb: torch.Tensor, features: torch.Tensor, boxes: torch.Tensor) -> Refined:
        is_closer = rgb.shape[-1] > PICTURE_PX
        kinds = torch.full((boxes.shape[1], 1 + self.types), -9.0)
        kinds[:, 2 if is_closer else 1] = 9.0
        shapes = torch.full((boxes.shape[1], GRID, GRID), 9.0 if is_closer else -4.0)
        return Refined(boxes[0] + torch.tensor([4.0, 0, 0, 0]), kinds, shapes)


def test_what_is_said_is_the_mean_of_a_look_at_the_picture_and_one_from_closer_by() -> None:
    rgb = torch.zeros((2, 3, PICTURE_PX, PICTURE_PX), dtype=torch.uint8)
    detector = TwoStageDetector(Rough(3), Biased(3))
    seen, found = detector.look(rgb)
    assert len(found) == 2
    assert seen.closely is not None
    assert seen.closely.rgb.shape[-1] == PICTURE_PX * CLOSER
    types = detector.types_of(seen.of(1), torch.from_numpy(ROUGH))
    assert types.numpy() == pytest.approx(np.array([[0.5, 0.5, 0]]), abs=1e-6)
    moved_by = (4 + 4 / CLOSER) / 2
    for one in found:
        of_it = iou(ROUGH, one.boxes)[0] > 0.8
        assert set(one.types[of_it]) == {0, 1}
        assert one.boxes[of_it][0].tolist() == pytest.approx([26 + moved_by, 26, 74, 74])
        assert one.mask(int(of_it.argmax()), (PICTURE_PX, PICTURE_PX)).sum() == (74 - 29) * (74 - 26)


def test_thin_things_get_less_margin_from_closer_by() -> None:
    rgb = torch.zeros((1, 3, PICTURE_PX, PICTURE_PX), dtype=torch.uint8)
    (found,) = TwoStageDetector(Thin(3), Biased(3)).detect(rgb)
    width, closer = (found.looked_at[:, 0, 2] - found.looked_at[:, 0, 0]).tolist()
    assert width == pytest.approx(8 * MARGIN)
    assert closer == pytest.approx(8 * MARGIN / CLOSER)


@pytest.mark.slow
def test_a_second_stage_learns_where_things_end_and_what_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(detection, "MOST_BOXES", 8)  # of pictures with one thing; more make it slower, and no better
    torch.manual_seed(0)
    first, second, rng = Rough(3), Refiner(3), np.random.default_rng(0)
    optimizer = torch.optim.AdamW(second.parameters(), lr=3e-3)
    steps = 60
    falling = torch.optim.lr_scheduler.LinearLR(optimizer, 1.0, 0.0, steps)

    def near_the_rough_box() -> Picture:
        low, size = rng.integers(26, 34, 2), rng.integers(32, 41, 2)
        return picture(*low, *(low + size))

    def anywhere() -> Picture:
        size = rng.integers(32, 72, 2)  # as large as it is from closer by, too
        low = rng.integers(0, PICTURE_PX - size)
        return picture(*low, *(low + size))

    for _ in range(steps):
        pictures = [anywhere() for _ in range(8)]
        loss = refiner_losses(second, shown_of(pictures, [rng] * 8))["loss"]
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        falling.step()

    pictures = [near_the_rough_box() for _ in range(20)]
    rgb = torch.stack([torch.from_numpy(one.rgb).permute(2, 0, 1) for one in pictures])
    seen, found = TwoStageDetector(first, second).look(rgb)
    true = np.concatenate([objects_of(one).boxes for one in pictures])
    rough = iou(true, ROUGH)[:, 0]
    better = np.array([iou(true[i : i + 1], one.boxes[:1])[0, 0] for i, one in enumerate(found)])
    assert better.mean() > rough.mean() + 0.2
    assert np.mean([one.types[0] == 2 for one in found]) > 0.9
    assert (seen.rgb == rgb).all()
