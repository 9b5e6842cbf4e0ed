"""Promises about sampled rooms: the same in any process, walkable, everything reachable, nothing in anything else."""

import subprocess
import sys
import zlib
from collections import Counter
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from remqa_data.catalog import object_type
from remqa_data.errors import UnknownNameError
from remqa_data.floorplans.ithor.plan import RoomShell
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.floorplans.load import load_scene
from remqa_data.floorplans.sampled.canvas import Canvas
from remqa_data.floorplans.sampled.naming import ROOM_TYPES, room_type_of, sampled_index, sampled_name, sampled_split
from remqa_data.floorplans.sampled.scenes import model_of, out_of_reach, sampled_rows, sampled_scene
from remqa_data.floorplans.sampled.statistics import recorded_rooms
from remqa_data.scene import Scene
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.physics.world import World

pytestmark = pytest.mark.slow

SEED = 3
BUILT_IN = {"Drawer", "Cabinet", "Shelf", "CounterTop", "Sink", "SinkBasin", "Faucet", "Desk", "Dresser", "SideTable"}


@cache
def rows_of(index: int, seed: int = SEED) -> tuple[list[RecordedObject], RoomShell]:
    """The first floor plan of an index that can be furnished."""
    for attempt in range(20):
        model = model_of(index, seed, attempt // 10)
        made = sampled_rows(index, np.random.default_rng([seed, index, attempt]), model)
        if made is not None:
            return made
    raise AssertionError(f"no floor plan for {index}")


@pytest.fixture(scope="module", params=range(4))
def scene(request: pytest.FixtureRequest) -> Scene:
    return sampled_scene(request.param, SEED)


def test_names_and_indices_are_one_to_one() -> None:
    assert [sampled_index(sampled_name(index)) for index in (0, 23, 123_456)] == [0, 23, 123_456]
    assert sampled_name(123) == "Sampled-bathroom-000123"


@pytest.mark.parametrize("name", ["Sampled-kitchen-000001", "Sampled-attic-000000", "Sampled-kitchen-0", "FloorPlan1"])
def test_a_wrong_name_is_refused(name: str) -> None:
    with pytest.raises(UnknownNameError):
        sampled_index(name)


def test_one_room_in_six_is_for_testing_and_each_type_gets_its_share() -> None:
    of_24 = [sampled_split(sampled_name(index)) for index in range(24)]
    for six in (of_24[i : i + 6] for i in range(0, 24, 6)):
        assert Counter(six) == {"train": 4, "val": 1, "test": 1}
    for split in ("val", "test"):
        assert {room_type_of(i) for i, own in enumerate(of_24) if own == split} == set(ROOM_TYPES)


@pytest.mark.parametrize("room_type", range(4))
def test_in_thirty_rooms_of_a_type_each_recorded_room_is_a_model_once(room_type: int) -> None:
    orders = [[model_of(4 * i + room_type, seed) for i in range(60)] for seed in (0, 1)]
    for order in orders:
        assert sorted(order[:30]) == sorted(order[30:]) == list(range(30))
        assert order[:30] != order[30:]
    assert orders[0] != orders[1]
    assert len({model_of(room_type, 0, turn) for turn in range(30)}) == 30, "one that does not do is not tried again"


def test_every_room_has_what_makes_it_one(scene: Scene) -> None:
    needed = {
        "kitchen": {"Fridge", "Sink", "StoveBurner", "CounterTop", "Cabinet"},
        "living_room": {"Sofa"},
        "bedroom": {"Bed"},
        "bathroom": {"Toilet", "Sink"},
    }
    assert needed[scene.room_type] <= {o.type for o in scene.objects}
    assert len({o.id for o in scene.objects}) == len(scene.objects)


def test_everything_that_opens_is_in_reach(scene: Scene) -> None:
    assert any(object_type(o.type).is_container for o in scene.objects)
    assert out_of_reach(scene) == []


def test_the_floor_hangs_together(scene: Scene) -> None:
    with World(scene) as world:
        world.settle()
        grid = reachable_grid(world)
    assert len(grid.cells) > 12
    assert sum(grid.other_parts) < 0.2 * len(grid.cells)


def test_loose_things_stay_where_they_are_put(scene: Scene) -> None:
    with World(scene) as world:
        before = {o.id: world.box(o.id).mean(axis=0) for o in scene.objects if not o.is_fixed}
        assert before
        world.settle()
        fallen = [name for name, at in before.items() if np.linalg.norm(world.box(name).mean(axis=0) - at) > 0.15]
    assert len(fallen) <= 0.1 * len(before)


def test_the_same_room_in_another_process() -> None:
    code = "import sys, zlib; from remqa_data.floorplans.sampled.scenes import sampled_scene\n"
    code += f"print(zlib.crc32(repr(sampled_scene(3, {SEED})).encode()))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(told.stdout) == zlib.crc32(repr(sampled_scene(3, SEED)).encode())


def test_other_seeds_draws_and_indices_are_other_rooms() -> None:
    rooms = [sampled_scene(*key) for key in ((3, 0), (3, 1), (3, 0, 1), (7, 0))]
    assert len({room.objects for room in rooms}) == 4


def test_a_room_loads_by_its_name() -> None:
    assert load_scene("Sampled-bathroom-000003", "direct") == sampled_scene(3, 0)
    assert load_scene("Sampled-bathroom-000003").light == "baked"


@pytest.mark.parametrize("index", range(8))
def test_pieces_meet_neither_walls_nor_each_other(index: int) -> None:
    rows, shell = rows_of(index)
    x0, y0, x1, y1 = shell.bounds
    for row in rows:
        slack = 0.35 if row.type in ("Window", "Curtains", "Blinds", "Floor") else 0.011
        assert np.all(row.low[:2] > np.array([x0, y0]) - slack), row.id
        assert np.all(row.high[:2] < np.array([x1, y1]) + slack), row.id
    large = [row for row in rows if not row.pickupable and row.type != "Floor" and row.type not in BUILT_IN]
    parts = {"Bathtub", "BathtubBasin", "ShowerHead", "ShowerDoor", "ShowerGlass", "ShowerCurtain"}
    assert len(large) > 1
    for i, a in enumerate(large):
        for b in large[:i]:
            if {a.type, b.type} <= parts or {a.type, b.type} <= {"Window", "Curtains", "Blinds"}:
                continue
            deep = np.minimum(a.high, b.high) - np.maximum(a.low, b.low)
            assert deep.min() < 0.02, (a.id, b.id)


@pytest.mark.parametrize("index", range(8))
def test_everything_is_on_something_that_is_there(index: int) -> None:
    rows, _ = rows_of(index)
    by_id = {row.id: row for row in rows}
    assert len(by_id) == len(rows)
    assert any(row.parents for row in rows)
    for row in rows:
        assert all(parent in by_id for parent in row.parents), row.id
        for holder in (by_id[parent] for parent in row.parents):
            assert np.all(row.centre[:2] > holder.low[:2] - 0.15), (row.id, holder.id)
            assert np.all(row.centre[:2] < holder.high[:2] + 0.15), (row.id, holder.id)


def test_some_rooms_are_l_shaped_and_nothing_is_in_the_corner_that_is_missing() -> None:
    shapes = [rows_of(index) for index in range(2, 42, 4)]
    notched = [(rows, shell.notches[0]) for rows, shell in shapes if shell.notches]
    assert 0 < len(notched) < len(shapes)
    for rows, notch in notched:
        low, high = np.array(notch[:2]), np.array(notch[2:])
        inside = [r.id for r in rows if r.type != "Floor" and np.all(r.high[:2] > low) and np.all(r.low[:2] < high)]
        assert inside == []


@pytest.mark.parametrize("kind", ["Washstand", "Cupboard"])
def test_a_washstand_has_all_that_is_under_it_and_nothing_else_gets_there(kind: str) -> None:
    pieces = recorded_rooms("bathroom").patterns[kind]
    assert pieces
    assert all(piece.low[2] < 0.3 for piece in pieces)
    assert all(("Sink" in {row.type for row in piece.rows}) == (kind == "Washstand") for piece in pieces)
    of_402 = next(
        piece for piece in recorded_rooms("bathroom").patterns["Washstand"] if piece.rows[0].scene == "FloorPlan402"
    )
    assert Counter(row.type for row in of_402.rows)["Cabinet"] == 4


def test_seats_in_kitchens_are_at_tables() -> None:
    found = 0
    for index in range(0, 48, 4):
        rows, _ = rows_of(index)
        tables = [row for row in rows if row.type in ("DiningTable", "CounterTop", "Desk")]
        seats = [row for row in rows if row.type in ("Chair", "Stool")]
        found += len(seats)
        for seat in seats:
            gaps = [np.linalg.norm(np.maximum(0, np.maximum(t.low - seat.high, seat.low - t.high))[:2]) for t in tables]
            assert min(gaps) < 0.15, seat.id
    assert found > 0


def test_no_television_stands_amid_the_room() -> None:
    hosts = Counter()
    for index in range(1, 41, 4):
        rows, _ = rows_of(index)
        types = {row.id: row.type for row in rows}
        hosts.update(types[parent] for row in rows if row.type == "Television" for parent in row.parents)
    assert hosts
    assert not hosts.keys() & {"CoffeeTable", "DiningTable"}


@settings(max_examples=40)
@given(st.sampled_from(ROOM_TYPES[1:]), st.integers(0, 10_000), st.integers(1, 3))
def test_a_turned_piece_is_the_same_piece(room_type: str, number: int, quarters: int) -> None:
    patterns = [piece for pieces in recorded_rooms(room_type).patterns.values() for piece in pieces]
    piece = patterns[number % len(patterns)]
    turned = piece.turned(quarters)
    swapped = (turned.high - turned.low)[[1, 0, 2]] if quarters % 2 else turned.high - turned.low
    assert np.allclose(swapped, piece.high - piece.low)
    back = turned.turned(4 - quarters)
    for a, b in zip(piece.rows, back.rows, strict=True):
        assert np.allclose(a.low, b.low)
        assert np.allclose(a.rotation, b.rotation)
        assert np.linalg.det(b.rotation) > 0.99, "never mirrored"


def test_a_canvas_notices_what_cuts_the_floor_in_two() -> None:
    canvas = Canvas("Sampled-kitchen-000000", (-2.0, -2.0, 2.0, 2.0), 2.5)
    assert canvas.is_walkable()
    assert canvas.is_walkable([(np.array([-2.0, -0.1, 0.0]), np.array([0.5, 0.1, 1.0]))])
    assert not canvas.is_walkable([(np.array([-2.0, -0.1, 0.0]), np.array([1.8, 0.1, 1.0]))])
    assert canvas.is_walkable([(np.array([-2.0, -0.1, 1.9]), np.array([1.8, 0.1, 2.4]))]), "it is over one's head"


def test_a_canvas_knows_that_the_agent_steps_from_cell_to_cell() -> None:
    """A gap in a wall, wide enough for the agent, that is between two rows of cells."""
    for middle, is_gap in ((0.0, True), (0.125, False)):
        canvas = Canvas("Sampled-kitchen-000000", (-2.0, -2.0, 2.0, 2.0), 2.5)
        ends = ((-2.0, middle - 0.28), (middle + 0.28, 2.0))
        assert canvas.is_walkable([(np.array([-0.1, a, 0.0]), np.array([0.1, b, 1.0])) for a, b in ends]) is is_gap


def test_a_canvas_keeps_the_missing_corner_free() -> None:
    canvas = Canvas("Sampled-kitchen-000000", (-2.0, -2.0, 2.0, 2.0), 2.5, (0.5, 1.0, 2.0, 2.0))
    assert sum(wall.length for wall in canvas.walls()) == pytest.approx(16.0), "an L is as long around as its box"
    assert canvas.fits(np.array([-1.0, 1.2, 0.0]), np.array([0.4, 1.8, 1.0]))
    assert not canvas.fits(np.array([-1.0, 1.2, 0.0]), np.array([0.6, 1.8, 1.0]))
