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


@pytest.mark.parametrize("name", ["FloorPlan3", "FloorPlan16", "FloorPlan403"])
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


@pytest.mark.parametrize("name", ["FloorPlan25", "FloorPlan29", "FloorPlan30"])
def test_burners_are_on_worktops(name: str) -> None:
    assert "CounterTop" in seen_from_above(load_scene(name), "StoveBurner")
    above = seen_from_above(uncovered(load_scene(name)), "StoveBurner")
    assert "CounterTop" not in above
    assert "StoveBurner" in above
