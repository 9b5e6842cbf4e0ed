"""Objects from single views, in a world whose numbers are worked out on paper."""

import numpy as np
import pytest

from remqa_data.agents.knowledge.detected import Seen, Things, box_around, seen_in, sides_of
from remqa_data.assets.core.sizes import typical_size
from remqa_data.sim.render.camera import Camera

EAST = Camera((0.0, 0.0, 1.0), 0.0, width=60, height=60)  # of 90 degrees: focal length 30 px
TYPES = ("Fridge", "Mug", "Drawer")
DEEP = typical_size("Drawer")[1]


def votes(**shares: float) -> np.ndarray:
    return np.array([shares.get(name, 0.0) for name in TYPES], dtype=np.float32)


def screen(depth_m: float) -> np.ndarray:
    return np.full((60, 60), depth_m, dtype=np.float32)


def seen(box: tuple[float, ...], vote: np.ndarray, heading: int = 2) -> Seen:
    """Points on a grid of some box, which show one side."""
    low, high = np.array(box[:3]), np.array(box[3:])
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, 5)] * 3, indexing="ij"), -1).reshape(-1, 3)
    return Seen(vote, low + grid * (high - low), np.eye(4, dtype=np.float32)[heading])


def test_the_outermost_points_are_not_believed() -> None:
    points = np.zeros((100, 3))
    points[:, 0] = np.linspace(0, 1, 100)
    points[0], points[-1] = (-9, -9, -9), (9, 9, 9)
    assert box_around(points).tolist() == pytest.approx([2 / 99, 0, 0, 97 / 99, 0, 0])


def test_a_wall_looks_back_at_the_camera() -> None:
    assert set(sides_of(screen(2.0), EAST)[1:-1, 1:-1].ravel().tolist()) == {2}  # towards 180 degrees
    north = Camera((0.0, 0.0, 1.0), 90.0, width=60, height=60)
    assert set(sides_of(screen(2.0), north)[1:-1, 1:-1].ravel().tolist()) == {3}
    down = Camera((0.0, 0.0, 1.0), 0.0, 90.0, width=60, height=60)
    assert set(sides_of(screen(1.0), down)[1:-1, 1:-1].ravel().tolist()) == {-1}  # the floor


def test_what_a_box_shows_is_put_into_the_room() -> None:
    depth = screen(4.0)
    depth[20:40, 20:40] = 2.0  # 20 px at 2 m and a focal length of 30 px: 1.33 m wide
    cells = np.zeros((15, 15), dtype=np.int64)
    cells[5:10, 5:10] = 1
    boxes = np.array([[16, 16, 44, 44]], dtype=np.float32)  # too large: the wall behind is seen in it
    (found,) = seen_in(boxes, votes(Fridge=0.9)[None], cells, 4, depth, EAST)
    assert box_around(found.points) == pytest.approx([2.0, -0.6, 0.4, 2.0, 0.65, 1.65], abs=0.1)
    assert found.sides.argmax() == 2


def test_where_no_cell_is_of_its_type_the_middle_of_a_box_is_taken() -> None:
    cells = np.zeros((15, 15), dtype=np.int64)
    (found,) = seen_in(
        np.array([[20, 20, 40, 40]], dtype=np.float32), votes(Mug=0.9)[None], cells, 4, screen(2.0), EAST
    )
    box = box_around(found.points)
    assert box[4] - box[1] == pytest.approx(0.6 * 20 * 2 / 30, abs=0.15)


def test_nothing_is_made_of_what_has_no_depth() -> None:
    cells = np.ones((15, 15), dtype=np.int64)
    assert not seen_in(np.array([[20, 20, 40, 40]], dtype=np.float32), votes(Mug=1)[None], cells, 4, screen(0.0), EAST)


def test_views_of_one_thing_vote_for_its_type_and_things_apart_are_two() -> None:
    things = Things(TYPES)
    things.add(
        [seen((0, 0, 0, 0.6, 0.6, 1.6), votes(Fridge=0.6, Drawer=0.3)), seen((2, 0, 0, 2.1, 0.1, 0.1), votes(Mug=0.4))]
    )
    things.add([seen((0, 0.02, 0, 0.6, 0.6, 1.6), votes(Fridge=0.2, Drawer=0.4))])
    assert len(things.all) == 2
    records = things.records(0.5)
    assert [(record.type, record.id) for record in records] == [("Fridge", "Fridge|0000")]  # the mug got too few votes
    assert list(records.values()) == pytest.approx([0.8])
    assert [record.type for record in things.records(0.0)] == ["Fridge", "Mug"]


def test_a_mug_on_a_fridge_is_no_part_of_it() -> None:
    things = Things(TYPES)
    things.add(
        [seen((0, 0, 0, 0.6, 0.6, 1.6), votes(Fridge=0.9)), seen((0.2, 0.2, 1.58, 0.3, 0.3, 1.7), votes(Mug=0.9))]
    )
    assert len(things.all) == 2


@pytest.mark.parametrize(("heading", "wanted"), [(2, (2.0, 2.0 + DEEP)), (0, (2.02 - DEEP, 2.02))])
def test_a_drawer_of_which_the_front_is_seen_is_as_deep_as_drawers_are(
    heading: int, wanted: tuple[float, float]
) -> None:
    things = Things(TYPES)
    things.add([seen((2.0, 0.0, 0.5, 2.02, 0.4, 0.7), votes(Drawer=0.9), heading)])
    (record,) = things.records(0.5)
    assert record.facing_deg == (180.0 if heading == 2 else 0.0)
    assert (record.box[0], record.box[3]) == pytest.approx(wanted)
