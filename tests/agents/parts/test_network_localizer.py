"""Where the hand goes, by what a network has found."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from remqa_data.agents.parts.network_localizer import middle_of_both

SIZE = (240, 320)

boxes = arrays(np.float32, (2, 2), elements=st.integers(0, 240).map(float)).map(
    lambda corners: np.sort(corners, 0).ravel()
)


@given(boxes, boxes)
def test_what_is_opened_is_taken_hold_of_between_both_boxes(found, moved):
    across, down = middle_of_both(found, moved, SIZE) * np.array([320, 240])
    point = np.array([across, down])
    low, high = np.minimum(found[:2], moved[:2]), np.maximum(found[2:], moved[2:])
    assert (low - 1e-3 <= point).all()
    assert (point <= high + 1e-3).all()
    both_low, both_high = np.maximum(found[:2], moved[:2]), np.minimum(found[2:], moved[2:])
    overlap = both_low <= both_high
    assert ((both_low - 1e-3 <= point) & (point <= both_high + 1e-3))[overlap].all()
    assert middle_of_both(moved, found, SIZE) == middle_of_both(found, moved, SIZE)


def test_a_box_that_was_not_moved_is_taken_hold_of_in_its_middle():
    box = np.array([32, 24, 96, 72], dtype=np.float32)
    assert middle_of_both(box, box, SIZE) == (0.2, 0.2)
