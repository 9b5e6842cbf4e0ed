"""Doors and drawers stop at walls and fixtures."""

import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.floorplans.ithor.openings import opening_limits
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene import SceneObject
from remqa_data.sim.physics.bodies import STRUCTURE_NAME
from remqa_data.sim.physics.world import World
from tests.helpers.bare_rooms import room

DEEP_M = 0.03
"""Two and a half centimetres are allowed, and what lies between two of the opennesses that are tried."""


def limits_beside(wall: tuple[float, ...], type_: str = "Cabinet", variant: int = 0) -> dict[str, float]:
    thing = SceneObject("A|1", AssetSpec(type_, (0.4, 0.5, 0.8), variant), (0.0, 0.0, 0.4))
    with World(room(thing, walls=[wall])) as world:
        return opening_limits(world)


def test_a_door_beside_a_wall_on_its_hinge_side_opens_to_a_right_angle() -> None:
    """By hand: 105 degrees are all of it, and 90 of 105 are 0.857."""
    found = limits_beside((-0.3, -1.0, 0.0, -0.205, 0.25, 1.0))
    assert 0.78 < found["A|1"] < 0.92


def test_a_wall_on_the_other_side_is_not_in_the_way() -> None:
    assert limits_beside((0.215, -1.0, 0.0, 0.3, 0.25, 1.0)) == {}
    assert limits_beside((0.205, -1.0, 0.0, 0.3, 0.25, 1.0), variant=1)["A|1"] < 0.92


def test_a_drawer_opens_as_far_as_the_wall_before_it() -> None:
    """By hand: the drawer slides 0.41 m; the wall is 0.224 m before its front, of which a thin handle is not counted."""
    found = limits_beside((-1.0, -0.5, 0.0, 1.0, -0.45, 1.0), "Drawer")
    assert found["A|1"] == pytest.approx(0.224 / 0.41, abs=0.06)


def test_what_opens_less_far_says_so_and_opens_as_far_as_it_can() -> None:
    thing = SceneObject("Drawer|1", AssetSpec("Drawer", (0.4, 0.5, 0.2)), (0.0, 0.0, 0.4), most_open=0.5)
    with World(room(thing)) as world:
        world.open("Drawer|1")
        assert world.state("Drawer|1").openness == world.most_open("Drawer|1") == 0.5


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["FloorPlan405", "FloorPlan6", "FloorPlan408", "FloorPlan13", "FloorPlan428", "FloorPlan26"]
)
def test_no_door_or_drawer_of_a_room_passes_through_a_wall_or_fixture(name: str) -> None:
    with World(load_scene(name)) as world:
        checked = 0
        for object_id in world.ids:
            if world.assets[object_id].is_openable and world.state(object_id).openness == 0.0:
                if world.type_of(object_id) in ("Laptop", "Book", "Box", "Kettle"):
                    continue  # may be carried
                closed = world.depths_when_open(object_id, 0.0)
                for share in (0.31, 0.63, 0.87, 1.0):
                    depths = world.depths_when_open(object_id, share * world.most_open(object_id))
                    firm = {
                        n: d for n, d in depths.items() if n == STRUCTURE_NAME or n.startswith(("Cabinet", "Counter"))
                    }
                    checked += len(firm)
                    assert all(depth <= closed.get(n, 0.0) + DEEP_M for n, depth in firm.items()), (object_id, firm)
        assert checked > 0
