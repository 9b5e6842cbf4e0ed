import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.geometry import boxes as g
from remqa_data.metrics import box_iou

UNIT = (0, 0, 0, 1, 1, 1)


@pytest.mark.parametrize(
    ("a", "b", "iou"),
    [
        # A quarter of the larger box; RefCOCO-style half-open boxes (worked by hand).
        ((0, 0, 100, 100), (0, 0, 50, 50), 0.25),
        # A quarter shared, 1 + 1 - 0.25 in all.
        ((0, 0, 1, 1), (0.5, 0.5, 1.5, 1.5), 0.25 / 1.75),
        # They share an edge, no pixel.
        ((0, 0, 10, 10), (10, 0, 20, 10), 0.0),
        ((3, 4, 9, 8), (3, 4, 9, 8), 1.0),
        # One pixel of two 2 x 2 squares: 1 / 7.
        ((0, 0, 2, 2), (1, 1, 3, 3), 1 / 7),
    ],
)
def test_iou_of_boxes_of_one_height_golden(a, b, iou: float) -> None:
    one, other = ((*box[:2], 0, *box[2:], 1) for box in (a, b))
    assert g.iou_3d(one, other).shape == (1, 1)
    assert g.iou_3d(one, other)[0, 0] == pytest.approx(iou, abs=1e-15)
    assert box_iou(a, b) == pytest.approx(iou, abs=1e-15)


@pytest.mark.parametrize(
    ("b", "iou", "gap", "distance"),
    [
        (UNIT, 1.0, 0.0, 0.0),
        ((0, 0, 0, 1, 1, 0.5), 0.5, 0.0, 0.25),
        # 1/8 of each, 2 - 1/8 in all: 1/15.
        ((0.5, 0.5, 0.5, 1.5, 1.5, 1.5), 1 / 15, 0.0, 0.75**0.5),
        ((1, 0, 0, 2, 1, 1), 0.0, 0.0, 1.0),
        # 3-4-5 triangles between nearest corners.
        ((4, 5, 0, 5, 6, 1), 0.0, 5.0, (16 + 25) ** 0.5),
        ((1, 4, 5, 2, 5, 6), 0.0, 5.0, (1 + 16 + 25) ** 0.5),
    ],
)
def test_boxes_in_space_golden(b, iou: float, gap: float, distance: float) -> None:
    assert g.iou_3d(UNIT, b)[0, 0] == pytest.approx(iou, abs=1e-15)
    assert g.gap(UNIT, b)[0, 0] == pytest.approx(gap)
    assert g.centre_distance(UNIT, b)[0, 0] == pytest.approx(distance)


@pytest.mark.parametrize("flat", [(0, 0, 0, 1, 1, 0), (0.5, 0.5, 0.5, 0.5, 0.5, 0.5), (1, 1, 1, 0, 0, 0)])
def test_boxes_without_volume_have_iou_0_even_with_themselves(flat) -> None:
    assert g.volume(flat)[0] == 0.0
    assert g.iou_3d(flat, flat)[0, 0] == 0.0
    assert g.iou_3d(flat, UNIT)[0, 0] == 0.0
    assert box_iou(flat[1:5], flat[1:5]) in (0.0, 1.0)  # never nan


def test_pixel_box_without_area_has_iou_0() -> None:
    assert box_iou((5, 5, 5, 9), (5, 5, 5, 9)) == 0.0


def test_heights_and_plans() -> None:
    table, mug, lamp = (0, 0, 0, 2, 1, 0.7), (1.9, 0.4, 0.72, 2.1, 0.6, 0.8), (0.5, 0.2, 0.7, 0.9, 0.4, 1.2)
    assert g.vertical_gap(mug, table)[0, 0] == pytest.approx(0.02)
    assert g.vertical_gap(table, mug)[0, 0] == pytest.approx(-0.8)
    assert g.overlap_share(mug, table)[0, 0] == pytest.approx(0.5)  # half of the mug sticks out
    assert g.overlap_share([mug, lamp], [table, lamp]) == pytest.approx(np.array([[0.5, 0.0], [1.0, 1.0]]))
    assert g.overlap_share(mug, lamp, axes=(2,))[0, 0] == pytest.approx(1.0)
    assert g.horizontal_gap(mug, table)[0, 0] == 0.0
    assert g.horizontal_gap(mug, lamp)[0, 0] == pytest.approx(1.0)


@pytest.mark.parametrize(("iou", "threshold", "hit"), [(0.5, 0.5, True), (0.5 - 1e-12, 0.5, True), (0.49, 0.5, False)])
def test_prec_at_x_counts_the_threshold_itself(iou: float, threshold: float, hit: bool) -> None:
    assert bool(g.is_hit(iou, threshold)) is hit


def test_wrong_shape_is_named() -> None:
    with pytest.raises(ValueError, match=r"shape \(n, 6\), found \(1, 4\)"):
        g.iou_3d([[0, 0, 1, 1]], UNIT)


def test_no_boxes_give_an_empty_table() -> None:
    assert g.iou_3d(np.empty((0, 6)), [UNIT, UNIT]).shape == (0, 2)


# ---- an oracle that shares no formula with the code: count the cells of a lattice

SIDE = 6
lattice_box = st.tuples(*[st.integers(0, SIDE)] * 6).map(
    lambda v: tuple(min(v[i], v[i + 3]) for i in range(3)) + tuple(max(v[i], v[i + 3]) for i in range(3))
)


def cells(box) -> np.ndarray:
    grid = np.zeros((SIDE, SIDE, SIDE), dtype=bool)
    grid[box[0] : box[3], box[1] : box[4], box[2] : box[5]] = True
    return grid


@given(lattice_box, lattice_box)
def test_iou_3d_counts_voxels(a, b) -> None:
    one, two = cells(a), cells(b)
    both, either = int((one & two).sum()), int((one | two).sum())
    assert g.volume(a)[0] == one.sum()
    assert g.intersection_volume(a, b)[0, 0] == both
    assert g.iou_3d(a, b)[0, 0] == pytest.approx(both / either if either else 0.0)


@given(lattice_box, lattice_box)
def test_gap_is_the_least_distance_between_lattice_points(a, b) -> None:
    def points(box) -> np.ndarray:
        axes = [np.arange(box[i], box[i + 3] + 1) for i in range(3)]
        return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)

    least = np.linalg.norm(points(a)[:, None] - points(b)[None], axis=2).min()
    assert g.gap(a, b)[0, 0] == pytest.approx(least)


number = st.floats(-5, 5, allow_nan=False)
size = st.floats(0.01, 3)
box = st.tuples(number, number, number, size, size, size).map(
    lambda v: (v[0], v[1], v[2], v[0] + v[3], v[1] + v[4], v[2] + v[5])
)


@pytest.mark.slow
@given(st.lists(box, min_size=1, max_size=4), st.lists(box, min_size=1, max_size=4), st.tuples(number, number, number))
def test_measures_are_symmetric_and_do_not_depend_on_where_the_room_is(a, b, shift) -> None:
    moved = np.tile(np.array(shift), 2)
    for measure in (g.iou_3d, g.gap, g.centre_distance, g.overlap_share, g.horizontal_gap):
        table = measure(a, b)
        assert table.shape == (len(a), len(b))
        assert np.all(table >= 0)
        np.testing.assert_allclose(measure(b, a).T, table, atol=1e-12)
        np.testing.assert_allclose(measure(a + moved, b + moved), table, atol=1e-9)
    iou = g.iou_3d(a, b)
    assert np.all(iou <= 1)
    assert np.all(iou <= g.overlap_share(a, b) + 1e-12)
    assert np.all(iou[g.gap(a, b) > 0] == 0)
    np.testing.assert_allclose(np.diag(g.iou_3d(a, a)), 1.0)


@given(box, box, st.sampled_from([0, 1, 2]))
def test_the_share_of_one_pair_along_an_axis_is_that_of_the_table(a, b, axis: int) -> None:
    flat = (*a[:3], *a[:3])
    for one, two in ((a, b), (a, a), (flat, b)):
        assert g.side_share(one, two, axis) == g.overlap_share(one, two, axes=(axis,))[0, 0]
