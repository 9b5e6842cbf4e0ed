"""Golden values from trimesh with manifold3d, and the example of pytorch3d's documentation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from remqa_data.geometry import iou_3d
from remqa_data.oriented_boxes import OrientedBox, oriented_iou

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("manifold3d")

lengths = st.floats(0.2, 3.0)
places = st.floats(-1.5, 1.5)
angles = st.floats(-np.pi, np.pi)


def turned(about: list[float], angle: float) -> np.ndarray:
    return trimesh.transformations.rotation_matrix(angle, about)[:3, :3]


@st.composite
def boxes(draw: st.DrawFn) -> OrientedBox:
    axis = [draw(places), draw(places), draw(st.floats(0.1, 1.0))]
    centre, size = ([draw(x) for _ in range(3)] for x in (places, lengths))
    return OrientedBox(tuple(centre), tuple(size), turned(axis, draw(angles)))


def by_trimesh(a: OrientedBox, b: OrientedBox) -> float:
    def mesh(box: OrientedBox) -> trimesh.Trimesh:
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = box.rotation, box.centre
        return trimesh.creation.box(box.size, pose)

    shared = trimesh.boolean.intersection([mesh(a), mesh(b)], engine="manifold")
    volume = 0.0 if shared.is_empty else float(shared.volume)
    return volume / (a.volume + b.volume - volume)


@settings(max_examples=60, deadline=None)
@given(boxes(), boxes())
def test_turned_boxes_overlap_as_trimesh_and_manifold_say(a: OrientedBox, b: OrientedBox) -> None:
    assert oriented_iou(a, b) == pytest.approx(by_trimesh(a, b), abs=1e-5)  # manifold works in single precision


@settings(max_examples=60, deadline=None)
@given(boxes(), boxes())
def test_the_order_makes_no_difference_and_a_box_covers_itself(a: OrientedBox, b: OrientedBox) -> None:
    assert oriented_iou(a, b) == pytest.approx(oriented_iou(b, a), abs=1e-9)
    assert oriented_iou(a, a) == pytest.approx(1.0)


@given(st.lists(places, min_size=6, max_size=6), st.lists(lengths, min_size=6, max_size=6))
def test_boxes_that_are_not_turned_overlap_as_axis_aligned_ones(centres: list[float], sizes: list[float]) -> None:
    both = [OrientedBox(tuple(centres[i : i + 3]), tuple(sizes[i : i + 3]), np.eye(3)) for i in (0, 3)]
    corners = [
        [*(np.array(o.centre) - np.array(o.size) / 2), *(np.array(o.centre) + np.array(o.size) / 2)] for o in both
    ]
    assert oriented_iou(*both) == pytest.approx(float(iou_3d(corners[0], corners[1])[0, 0]), abs=1e-9)


def test_known_overlaps() -> None:
    unit = OrientedBox((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), np.eye(3))
    # By hand: two unit squares turned by 45 degrees share a regular octagon of area 2 (sqrt 2 - 1).
    octagon = 2 * (np.sqrt(2) - 1)
    assert oriented_iou(unit, OrientedBox((0, 0, 0), (1, 1, 1), turned([0, 0, 1], np.pi / 4))) == pytest.approx(
        octagon / (2 - octagon)
    )
    # By hand: a neighbour shares a face, and no volume; half a box; nothing.
    assert oriented_iou(unit, OrientedBox((1.0, 0.0, 0.0), (1.0, 1.0, 1.0), np.eye(3))) == pytest.approx(0.0, abs=1e-12)
    assert oriented_iou(unit, OrientedBox((0.5, 0.0, 0.0), (1.0, 1.0, 1.0), np.eye(3))) == pytest.approx(1 / 3)
    assert oriented_iou(unit, OrientedBox((9.0, 0.0, 0.0), (1.0, 1.0, 1.0), np.eye(3))) == 0.0
    assert oriented_iou(unit, OrientedBox((0.0, 0.0, 0.0), (1.0, 1.0, 0.0), np.eye(3))) == 0.0
