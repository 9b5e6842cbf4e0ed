import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.errors import FloorPlanError, UnknownNameError
from remqa_data.floorplans.ithor.table import _by_scene, axes_facing, parse_row, recorded_objects, scene_names


def row(**changes):
    base = dict(_by_scene()["FloorPlan1"][1][1])
    return base | changes


@pytest.mark.slow
def test_120_scenes_and_all_objects() -> None:
    names = scene_names()
    assert len(names) == 120
    assert sum(len(recorded_objects(name)) for name in names) == 5670
    assert {name: len(recorded_objects(name)) for name in ("FloorPlan1", "FloorPlan201")} == {
        "FloorPlan1": 77,
        "FloorPlan201": 47,
    }


def test_frame_swaps_y_and_z() -> None:
    drawer = parse_row(row(), "row 1")
    assert drawer.type == "Drawer"
    assert np.allclose(drawer.centre, (0.95, -2.3692, 0.8146), atol=1e-4)
    assert np.allclose(drawer.high - drawer.low, (0.4795, 0.3901, 0.1123), atol=1e-4)


@pytest.mark.parametrize(
    ("yaw", "front"), [(0, (0, 1, 0)), (90, (1, 0, 0)), (180, (0, -1, 0)), (270, (-1, 0, 0)), (359.9, (0, 1, 0))]
)
def test_yaw_is_clockwise_from_what_is_our_y(yaw: float, front: tuple[float, float, float]) -> None:
    assert np.allclose(parse_row(row(rot_y=yaw), "row").front, front, atol=1e-9)


def test_quarter_turns_swap_width_and_depth() -> None:
    straight, turned = parse_row(row(rot_y=0.0), "row"), parse_row(row(rot_y=90.0), "row")
    assert np.allclose(straight.size, (0.4795, 0.3901, 0.1123), atol=1e-4)
    assert np.allclose(turned.size, (0.3901, 0.4795, 0.1123), atol=1e-4)


@given(st.floats(0, 360), st.floats(0.05, 1), st.floats(0.05, 1))
def test_oblique_boxes_span_what_was_recorded(yaw: float, width: float, depth: float) -> None:
    c, s = abs(np.cos(np.radians(yaw))), abs(np.sin(np.radians(yaw)))
    span = (width * c + depth * s, width * s + depth * c)
    o = parse_row(row(rot_y=yaw, aabb_sx=span[0], aabb_sz=span[1]), "row")
    spanned = np.abs(o.rotation) @ o.size
    assert np.isfinite(spanned).all()
    off = abs(yaw - 90 * round(yaw / 90))
    if off > 2 and abs(c * c - s * s) > 0.1:
        assert np.allclose(spanned[:2], span, rtol=1e-6) or np.allclose(o.rotation[2], (0, 0, 1))


def test_oriented_boxes_are_rotations_that_hold_the_recorded_box() -> None:
    for scene in ("FloorPlan1", "FloorPlan210", "FloorPlan320", "FloorPlan420"):
        assert any(o.is_oriented for o in recorded_objects(scene))
        for o in recorded_objects(scene):
            assert np.allclose(o.rotation.T @ o.rotation, np.eye(3), atol=1e-4)
            assert np.linalg.det(o.rotation) == pytest.approx(1, abs=1e-4)
            if o.is_oriented:
                spanned = np.abs(o.rotation) @ o.size
                assert np.all(spanned >= (o.high - o.low) - 0.03), o.id


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"aabb_sx": float("nan")}, "aabb_sx"),
        ({"aabb_cy": None}, "aabb_cy"),
        ({"aabb_sz": -0.2}, "aabb_sz"),
        ({"aabb_sy": 500.0}, "larger than any room"),
        ({"objectType": ""}, "objectType"),
        ({"openness": 3.0}, "openness"),
        ({"oobb": np.zeros(7)}, "oobb"),
        ({"oobb": np.zeros(24)}, "oobb"),
        ({"rot_y": "north"}, "rot_y"),
    ],
)
def test_a_damaged_row_is_named_with_its_field(changes, field: str) -> None:
    with pytest.raises(FloorPlanError) as caught:
        parse_row(row(**changes), "ithor_floorplans.parquet row 17")
    message = str(caught.value)
    assert "ithor_floorplans.parquet row 17" in message
    assert "FloorPlan1" in message
    assert field in message


def test_unknown_scene_names_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="FloorPlan31"):
        recorded_objects("FloorPlan31")
    with pytest.raises(UnknownNameError, match="did you mean"):
        recorded_objects("floorplan_1")


def test_axes_facing_is_a_rotation_with_its_front_there() -> None:
    axes = axes_facing(np.array([0.6, 0.8, 0.0]))
    assert np.allclose(-axes[:, 1], (0.6, 0.8, 0))
    assert np.linalg.det(axes) == pytest.approx(1)
