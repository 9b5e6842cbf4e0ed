import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.agents.networks.windows import AROUND, LEAST_PX, SIDE_PX, cut, window


@given(st.tuples(*(st.floats(0, 300) for _ in range(4))))
def test_a_window_holds_the_middle_of_its_box_and_lies_in_the_picture(sides: tuple[float, ...]) -> None:
    x1, x2 = sorted(sides[:2])
    y1, y2 = sorted(sides[2:])
    x, y, side = window((x1, y1, x2, y2), (300, 300))
    assert LEAST_PX <= side <= 300
    assert side / 2 - 1e-6 <= x <= 300 - side / 2 + 1e-6
    assert abs(x - (x1 + x2) / 2) <= side / 2 + 1e-6
    assert abs(y - (y1 + y2) / 2) <= side / 2 + 1e-6


def test_a_window_is_larger_than_its_box_by_half_and_the_whole_picture_without_one() -> None:
    assert window((100, 120, 200, 140), (300, 300)) == (150, 130, AROUND * 100)
    assert window(None, (300, 300)) == (150, 150, 300)


def test_what_is_cut_out_is_enlarged_and_perhaps_mirrored() -> None:
    picture = np.zeros((300, 300), dtype=np.float32)
    picture[:, 150:] = 7
    place = (150.0, 150.0, SIDE_PX / 2)
    seen = cut(picture, place)
    assert seen.shape == (SIDE_PX, SIDE_PX)
    assert set(np.unique(seen)) == {0, 7}
    assert (seen[:, : SIDE_PX // 2 - 1] == 0).all()
    assert (cut(picture, place, mirrored=True)[:, : SIDE_PX // 2 - 1] == 7).all()
    assert cut(np.zeros((300, 300, 3), np.uint8), place).shape == (SIDE_PX, SIDE_PX, 3)
