import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.box_head import TRUST, Fit
from remqa_data.agents.networks.detection.detector import Detections, Detector, FeatureMaps
from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.detection.regions import (
    GRID,
    Regions,
    candidates,
    colors_of,
    compared,
    nearest,
    places_of,
    regions_of,
)
from remqa_data.agents.networks.matcher import (
    VOTING_SHARPNESS,
    AnchoredMatcher,
    LanguageAttentionMatcher,
    Match,
    Matcher,
    PlainMatcher,
    ranking_loss,
)

MATCHERS = (LanguageAttentionMatcher, AnchoredMatcher, PlainMatcher)
TYPES, WORDS = 5, 12
BOXES = np.array([[10, 10, 40, 40], [50, 10, 90, 60], [5, 60, 45, 95], [60, 70, 80, 90]], dtype=np.float32)


def picture(*reds: int) -> torch.Tensor:
    """One in which the first boxes are more or less red, and all else is black."""
    rgb = torch.zeros((1, 3, 100, 100), dtype=torch.uint8)
    for red, (x1, y1, x2, y2) in zip(reds, BOXES.astype(int).tolist(), strict=False):
        rgb[0, 0, y1:y2, x1:x2] = red
    return rgb


def regions(boxes: np.ndarray = BOXES, scores: np.ndarray | None = None, rgb: torch.Tensor | None = None) -> Regions:
    """By their scores they are found, without any they are known."""
    torch.manual_seed(0)
    detector, features = Detector(TYPES).eval(), torch.randn((1, CHANNELS, 25, 25))
    seen = FeatureMaps(picture() if rgb is None else rgb, features)
    return regions_of(detector, seen, boxes, np.full((100, 100), 2.0, dtype=np.float32), 0.0, scores)


def matcher_of(kind: type[Matcher]) -> Matcher:
    torch.manual_seed(1)
    return kind(WORDS, TYPES).eval()


@pytest.mark.slow
@pytest.mark.parametrize("kind", MATCHERS)
def test_the_order_of_the_objects_does_not_matter(kind: type[Matcher]) -> None:
    matcher, numbers = matcher_of(kind), torch.tensor([[2, 3, 4], [5, 6, 0]])
    scores = matcher(numbers, regions()).scores
    turned = matcher(numbers, regions(BOXES[::-1].copy())).scores
    assert torch.allclose(scores, turned.flip(1), atol=1e-4)
    assert scores.shape == (2, len(BOXES))
    assert scores.std(1).min() > 1e-4  # and it does see them


@pytest.mark.parametrize("kind", MATCHERS)
def test_colours_are_seen_by_who_is_to_see_them(kind: type[Matcher]) -> None:
    numbers = torch.tensor([[2, 3, 4]])
    for colors in (True, False):
        torch.manual_seed(1)
        matcher = kind(WORDS, TYPES, False, colors).eval()
        black, red = (matcher(numbers, regions(rgb=picture(*reds))).scores[0] for reds in ((), (250,)))
        changed = (black - red).abs() > 1e-3
        assert changed.tolist() == [colors, False, False, False]


def test_colours_are_means_of_the_ninths_of_a_box() -> None:
    rgb = picture()
    rgb[0, 2, :, :30] = 255  # blue to the left
    boxes = torch.tensor([[0.0, 0.0, 60.0, 90.0], [40.0, 40.0, 70.0, 70.0]])
    left, right = colors_of(rgb, boxes)
    assert left[2].tolist() == [[2.0, 0.0, -2.0]] * GRID  # the column in the middle is half blue
    assert left[:2].unique().tolist() == right.unique().tolist() == [-2.0]


@pytest.mark.parametrize("kind", MATCHERS)
def test_padding_is_not_read(kind: type[Matcher]) -> None:
    matcher, seen = matcher_of(kind), regions()
    short = matcher(torch.tensor([[2, 3]]), seen)
    long = matcher(torch.tensor([[2, 3, 0, 0]]), seen)
    assert torch.allclose(short.scores, long.scores, atol=1e-5)
    parts = 4 if kind is AnchoredMatcher else 3
    assert torch.allclose(long.attention[0, :, 2:], torch.zeros(parts, 2))
    assert torch.allclose(long.attention.sum(2), torch.ones(1, parts))


@pytest.mark.parametrize("kind", MATCHERS)
def test_a_single_object_can_be_meant(kind: type[Matcher]) -> None:
    scores = matcher_of(kind)(torch.tensor([[2, 3]]), regions(BOXES[:1])).scores
    assert scores.shape == (1, 1)
    assert scores.isfinite().all()


def test_the_loss_is_nothing_beyond_the_margin_and_most_for_the_worst() -> None:
    scores = torch.tensor([3.0, 1.0, 2.5])
    assert float(ranking_loss(scores[0], scores[1:])) == pytest.approx(0.25 + 0.5)  # mean and worst of 0 and 0.5
    assert float(ranking_loss(scores[0], torch.cat([scores[1:], torch.tensor([4.0])]))) == pytest.approx(
        (0 + 0.5 + 2) / 3 + 2
    )
    assert float(ranking_loss(torch.tensor(3.0), torch.zeros(0))) == 0


def test_places_are_shares_of_the_picture_and_metres_of_the_room() -> None:
    (place,) = places_of(np.array([[50, 0, 100, 50]], np.float32), np.full((100, 100), 2.0, np.float32)).tolist()
    assert place == pytest.approx(
        [0.5, 0, 1, 0.5, 0.25, 1.0, -1.0, 2.0]
    )  # 90 degrees: at 2 m one sees 2 m to each side


def test_offsets_are_those_of_the_second_as_seen_from_the_first() -> None:
    places = places_of(BOXES[:2], np.full((100, 100), 2.0, np.float32))
    offsets = compared(places)
    assert offsets[0, 1, 5] == pytest.approx(2 * 2 * (70 - 25) / 100)  # metres to the right
    assert offsets[0, 1, 5] == -offsets[1, 0, 5]
    assert offsets[0, 0, 5:].tolist() == [0, 0, 0]


def test_the_nearest_are_those_that_are_allowed_and_no_more_than_there_are() -> None:
    places = places_of(BOXES, np.full((100, 100), 2.0, np.float32))
    allowed = ~torch.eye(4, dtype=torch.bool)
    allowed[0, 1] = False
    found, is_there = nearest(places, allowed, 5)
    assert set(found[0, is_there[0]].tolist()) == {2, 3}
    assert is_there.sum(1).tolist() == [2, 3, 3, 3]


def test_a_box_is_chosen_from_once() -> None:
    boxes = np.repeat(BOXES[:2], 2, axis=0)
    found = Detections(boxes, np.array([0, 1, 0, 1]), np.array([0.9, 0.8, 0.7, 0.6], np.float32), np.zeros((25, 25)))
    assert candidates(found, 60) == [0, 2]
    assert candidates(found, 1) == [0]


@pytest.mark.slow
def test_boxes_that_overlap_the_chosen_one_say_where_it_ends_the_better_they_fit() -> None:
    boxes = np.array([[10, 10, 40, 40], [10, 10, 50, 40], [60, 60, 90, 90], [70, 10, 80, 20]], dtype=np.float32)
    unlike = -math.log(3) / VOTING_SHARPNESS  # weighs a third
    scores = torch.tensor([[0.0, unlike, -0.01, -0.02], [-9.0, -9.0, 0.0, 0.5]])
    found = replace(regions(boxes, np.ones(4, dtype=np.float32)), boxes=boxes - 5)
    match = Match(scores, torch.ones((2, 3)), torch.ones((2, 3, 1)))
    assert np.array_equal(match.meant_in(found), found.boxes[[0, 3]])  # they are not judged
    judged = match._replace(fit=Fit(torch.from_numpy(boxes), torch.zeros(4), torch.zeros(4)))
    assert judged.meant_in(found).tolist() == [pytest.approx([10, 10, 42.5, 40]), boxes[3].tolist()]
    edge = boxes + np.array([0, 0, 300 - 40, 0], dtype=np.float32)  # all end at the same side, or beyond it
    edge[:, 2] = 300
    for count in (2, 10, 17, 33, 58, 77):  # in most of these the mean alone would be beyond
        many = np.repeat(edge[:1], count, axis=0)
        among = Match(torch.linspace(0, 0.3, count)[None], torch.ones((1, 3)), torch.ones((1, 3, 1)))
        seen = regions(many, np.ones(count, dtype=np.float32))
        among = among._replace(fit=Fit(torch.from_numpy(many), torch.zeros(count), torch.zeros(count)))
        assert among.meant_in(seen)[0, 2] <= 300
    empty = judged._replace(fit=Fit(torch.full((4, 4), 7.0), torch.zeros(4), torch.zeros(4)))
    assert empty.meant_in(found).tolist() == [[7.0] * 4] * 2


@pytest.mark.parametrize("kind", MATCHERS)
def test_what_fits_better_is_chosen_where_boxes_are_judged_and_objects_that_are_known_are_not(
    kind: type[Matcher],
) -> None:
    torch.manual_seed(1)
    matcher, numbers = kind(WORDS, TYPES, True).eval(), torch.tensor([[2, 3, 4]])
    found = regions(scores=np.array([0.9, 0.2, 0.5, 0.4], dtype=np.float32))
    before = matcher(numbers, found)
    assert torch.equal(before.scores, matcher.match(numbers, found).scores)  # it has learnt nothing, so all fit alike
    assert np.array_equal(before.boxes_of(found), BOXES)
    sides = np.tile(1 / (BOXES[:, 2:] - BOXES[:, :2]), 2)  # all are moved by a pixel
    said = torch.from_numpy(np.column_stack([[0.0, 0.0, 100.0, 0.0], sides]).astype(np.float32))
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(matcher.box_head.said, "forward", lambda known: said)
        after = matcher(numbers, found)
        known = matcher(numbers, regions())
    assert (after.scores - before.scores)[0].tolist() == pytest.approx([0, 0, 100 * TRUST, 0], abs=1e-4)
    assert after.chosen.tolist() == [2]
    assert np.allclose(after.boxes_of(found), BOXES + 1, atol=1e-4)
    assert torch.equal(known.scores, matcher.match(numbers, regions()).scores)
    assert np.array_equal(known.boxes_of(regions()), BOXES)
