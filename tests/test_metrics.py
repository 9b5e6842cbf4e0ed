"""Golden values from outside: torchvision's, detectron2's and the SPL paper's conventions, pycocotools, by hand."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from remqa_data.geometry.boxes import iou_3d, is_hit
from remqa_data.metrics import (
    CHAIN,
    box_iou,
    chained,
    distance_to_goal_m,
    is_localised,
    is_right_answer,
    navigation_success,
    path_lengths_m,
    spl,
)

coordinates = st.floats(0, 300, allow_nan=False)
box_pairs = arrays(np.float64, (2, 4), elements=coordinates)
metres = st.floats(0, 100)


def random_boxes(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    corner = rng.uniform(0, 300, (count, 2))
    return np.hstack([corner, corner + rng.uniform(0, 150, (count, 2))])


def test_iou_of_the_examples_of_torchvision_and_detectron2() -> None:
    assert box_iou([0, 0, 100, 100], [0, 0, 50, 50]) == 0.25  # torchvision.ops.box_iou
    assert box_iou([0, 0, 1, 1], [0.5, 0.5, 1.5, 1.5]) == pytest.approx(0.25 / 1.75)  # detectron2 tests/structures
    # detectron2 tests/structures/test_boxes.py: one box with itself and parts of it
    whole = [0.0, 0.0, 1.0, 1.0]
    parts = [[0, 0, 1, 1], [0, 0, 0.5, 1], [0, 0, 1, 0.5], [0, 0, 0.5, 0.5], [0.5, 0.5, 1, 1], [0.5, 0.5, 1.5, 1.5]]
    assert box_iou(whole, parts) == pytest.approx([1.0, 0.5, 0.5, 0.25, 0.25, 0.25 / (2 - 0.25)])


def test_iou_of_ten_thousand_boxes_is_that_of_pycocotools() -> None:
    mask = pytest.importorskip("pycocotools.mask")
    a, b = random_boxes(100, 1), random_boxes(100, 2)
    as_width = [np.hstack([boxes[:, :2], boxes[:, 2:] - boxes[:, :2]]) for boxes in (a, b)]
    expected = mask.iou(*as_width, [0] * 100)
    assert (expected > 0).mean() > 0.1
    assert np.abs(box_iou(a[:, None], b) - expected).max() < 1e-12


def test_boxes_without_area_or_with_nan_overlap_nothing() -> None:
    assert box_iou([5, 5, 5, 9], [0, 0, 10, 10]) == 0
    assert box_iou([9, 9, 5, 5], [0, 0, 10, 10]) == 0
    assert box_iou([5, 5, 5, 5], [5, 5, 5, 5]) == 0
    assert box_iou([np.nan] * 4, [0, 0, 10, 10]) == 0
    with pytest.raises(ValueError, match="shape"):
        box_iou([1, 2, 3], [0, 0, 1, 1])


@pytest.mark.slow
@given(box_pairs, st.floats(0.1, 10), st.floats(-50, 50))
def test_iou_is_bounded_symmetric_and_does_not_depend_on_scale_or_place(
    pair: np.ndarray, scale: float, by: float
) -> None:
    a, b = pair
    iou = box_iou(a, b)
    assert 0 <= iou <= 1
    assert iou == box_iou(b, a)
    assert iou == pytest.approx(float(iou_3d([*a[:2], 0, *a[2:], 1], [*b[:2], 0, *b[2:], 1])[0, 0]), abs=1e-12)
    if min(np.ptp(pair[:, 0::2], axis=1).min(), np.ptp(pair[:, 1::2], axis=1).min()) > 1e-3:  # else rounding rules
        assert box_iou(a * scale + by, b * scale + by) == pytest.approx(float(iou), abs=1e-6)


@given(st.floats(0.1, 100), st.floats(0, 1), st.floats(0, 1))
def test_the_farther_a_box_is_moved_the_less_it_overlaps(size: float, first: float, second: float) -> None:
    near, far = sorted((first * size, second * size))
    box = np.array([0, 0, size, size])
    moved = [box_iou(box, box + np.array([shift, 0, shift, 0])) for shift in (near, far)]
    assert moved[0] >= moved[1] - 1e-12


@pytest.mark.parametrize(
    ("success", "shortest", "walked", "expected"),
    [(1, 5, 10, 0.5), (1, 10, 8, 1), (1, 0, 0, 1), (0, 0, 0, 0), (1, 0, 2, 0), (0, 5, 5, 0), (1, 5, 5, 1)],
)
def test_spl_by_hand(success: int, shortest: float, walked: float, expected: float) -> None:
    assert spl([success], [shortest], [walked]) == pytest.approx([expected])


@given(st.booleans(), metres, metres, metres)
def test_spl_is_bounded_and_falls_with_the_way(success: bool, shortest: float, walked: float, more: float) -> None:
    short, long = spl([success] * 2, [shortest] * 2, [walked, walked + more])
    assert 0 <= long <= short <= success


@pytest.mark.slow
@given(st.lists(st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=5), min_size=1, max_size=6))
def test_paths_joined_have_the_lengths_of_each(paths: list[list[tuple[float, float]]]) -> None:
    found = path_lengths_m([p for path in paths for p in path], [len(path) for path in paths])
    assert len(found) == len(paths) > 0
    for length, path in zip(found, paths, strict=True):
        by_hand = sum(np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(path))
        assert length == pytest.approx(by_hand)


def test_navigation_succeeds_up_to_a_metre_if_the_target_is_seen() -> None:
    # Four steps of 0.25 m in a row are 1 m, whatever their rounding; a fifth is too far.
    walked = np.cumsum([0.0, *[0.1] * 10])
    assert navigation_success([walked[-1], 1.25, 1.0, np.nan], [True, True, False, True]).tolist() == [
        True,
        False,
        False,
        False,
    ]
    assert distance_to_goal_m([0.0, 0.0], np.empty((0, 2))) == np.inf
    assert not navigation_success(distance_to_goal_m([0.0, 0.0], np.full((1, 2), np.nan)), True)


def test_hits_at_the_threshold_count() -> None:
    # By hand: [0, 0, 2, 1] and [0, 0, 1, 1] share exactly half of the union.
    iou = box_iou([0, 0, 2, 1], [0, 0, 1, 1])
    assert is_hit(iou, 0.5)
    assert not is_hit(iou, 0.6)
    assert is_localised([0.5 - 1e-12, 0.4999, np.nan]).tolist() == [True, False, False]


def test_chained_successes_by_hand() -> None:
    found = chained(
        {
            "navigated": [True, True, True, True, False],
            "localised": [True, True, True, False, True],
            "manipulated": [True, True, False, True, True],
            "answered": [True, False, True, True, True],
        }
    )
    assert {name: column.tolist() for name, column in found.items()} == {
        "S_N": [True, True, True, True, False],
        "S_L": [True, True, True, False, False],
        "S_QA": [True, False, True, False, False],
        "S_M": [True, True, False, False, False],
        "S_MQA": [True, False, False, False, False],
    }


@pytest.mark.slow
@given(*[arrays(bool, 20)] * 4)
def test_who_fulfils_more_conditions_succeeds_in_fewer_episodes(
    went: np.ndarray, found: np.ndarray, did: np.ndarray, right: np.ndarray
) -> None:
    successes = chained({"navigated": went, "localised": found, "manipulated": did, "answered": right})
    pairs = [(a, b) for a in CHAIN for b in CHAIN if set(a.conditions) < set(b.conditions)]
    assert len(pairs) == 9
    for fewer, more in pairs:
        assert (successes[fewer.name] >= successes[more.name]).all()
    assert (successes["S_MQA"] == successes["S_M"] & successes["S_QA"]).all()


def test_answers_are_compared_without_case_and_spaces() -> None:
    given_, truths = ["YES", " no\n", "2", "02", "two", "", None], ["yes", "no", "2", "2", "2", "no", "no"]
    assert is_right_answer(given_, truths).tolist() == [True, True, True, False, False, False, False]
