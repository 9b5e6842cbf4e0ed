"""Sinks and burners are under worktops in some rooms as the dataset has them, and in none of those that clients are given."""

import pytest

from remqa_data.floorplans.ithor.uncovered import uncovered
from remqa_data.floorplans.load import load_scene
from remqa_data.geometry.types import Box, Vec3
from remqa_data.scene import Scene
from remqa_data.sim.physics.world import World

pytestmark = pytest.mark.slow


def seen_from_above(scene: Scene, *types: str) -> list[str]:
    """What is met by rays that go straight down at the middles of all objects of some types."""
    with World(scene) as world:
        met = []
        for object_id in (name for name in world.ids if world.type_of(name) in types):
            (x, y, z), above = world.box(object_id).mean(axis=0), world.box(object_id)[1, 2] + 0.3
            hit = world.first_hit((x, y, above), (x, y, z - 0.5))
            met.append("nothing" if hit is None else world.type_of(hit[0]) if hit[0] in world.ids else hit[0])
        assert met
        return met


def walls_over(place: Vec3, scene: Scene) -> list[Box]:
    """The walls that are less than 15 cm beside something, and above it."""
    x, y, z = place
    return [
        (x0, y0, z0, x1, y1, z1)
        for x0, y0, z0, x1, y1, z1 in (part.box for part in scene.structure if part.kind == "wall")
        if x0 < x + 0.15 and x1 > x - 0.15 and y0 < y < y1 and z0 > z
    ]


@pytest.mark.parametrize("name", ["FloorPlan1", "FloorPlan301", "FloorPlan405"])
def test_a_room_in_which_nothing_is_covered_stays_as_it_is(name: str) -> None:
    assert uncovered(load_scene(name)) == load_scene(name)


@pytest.mark.parametrize("name", ["FloorPlan19", "FloorPlan25", "FloorPlan30"])
def test_sinks_are_open(name: str) -> None:
    assert seen_from_above(load_scene(name), "SinkBasin") == ["CounterTop"]
    assert {*seen_from_above(uncovered(load_scene(name)), "SinkBasin")} <= {"SinkBasin", "Fork"}


def test_no_wall_stands_in_a_sink() -> None:
    recorded = load_scene("FloorPlan6")
    middle = next(o for o in recorded.objects if o.type == "SinkBasin").position
    scene = uncovered(recorded)
    assert [len(walls_over(middle, room)) for room in (recorded, scene)] == [2, 0]
    was, window = (next(o for o in room.objects if o.id.startswith("Window|+01.51")) for room in (recorded, scene))
    assert window.position == pytest.approx((scene.bounds[2] - 0.075, *was.position[1:]))
    assert [o for o in scene.objects if o != window] == [o for o in recorded.objects if o != was]


def seen_before(scene: Scene, window: str) -> str:
    """What is met on the way to a window's middle from the room before it."""
    with World(scene) as world:
        (low, high), (x0, y0, x1, y1) = world.box(window), scene.bounds
        axis = int((high - low)[1] < (high - low)[0])
        middle = (low + high) / 2
        start = middle.copy()
        start[axis] += 0.9 if middle[axis] < (x0 + x1, y0 + y1)[axis] / 2 else -0.9
        hit = world.first_hit(tuple(start.tolist()), tuple(middle.tolist()))
        assert hit is not None
        return world.type_of(hit[0]) if hit[0] in world.ids else "wall"


@pytest.mark.parametrize(
    ("name", "window"),
    [
        ("FloorPlan13", "Window|-04.87|+01.63|+03.31"),
        ("FloorPlan23", "Window|-02.50|+01.78|-04.19"),
        ("FloorPlan217", "Window|-01.72|+01.55|+00.01"),
    ],
)
def test_no_wall_hides_a_window(name: str, window: str) -> None:
    scene = load_scene(name)
    assert [seen_before(room, window) for room in (scene, uncovered(scene))] == ["wall", "Window"]


def test_a_wall_that_bears_a_switch_stays() -> None:
    scene = load_scene("FloorPlan204")
    assert seen_before(uncovered(scene), "Window|-02.83|+01.70|-00.16") == "wall"


@pytest.mark.parametrize("name", ["FloorPlan25", "FloorPlan29", "FloorPlan30"])
def test_burners_are_on_worktops(name: str) -> None:
    assert "CounterTop" in seen_from_above(load_scene(name), "StoveBurner")
    above = seen_from_above(uncovered(load_scene(name)), "StoveBurner")
    assert "CounterTop" not in above
    assert "StoveBurner" in above
