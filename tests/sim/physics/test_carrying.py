"""What goes along with what: by what it rests on, however near anything else is."""

from dataclasses import replace

import numpy as np
import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.assets.looks.materials import OAK
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene import Scene, SceneObject, StructureBox
from remqa_data.sim.physics.carrying import met_nothing
from remqa_data.sim.physics.support import supports
from remqa_data.sim.physics.world import World
from tests.helpers.bare_rooms import mug, room

LOWER = SceneObject("Drawer|low", AssetSpec("Drawer", (0.5, 0.4, 0.16)), (0.0, 0.0, 0.50))
UPPER = SceneObject("Drawer|high", AssetSpec("Drawer", (0.5, 0.4, 0.16)), (0.0, 0.0, 0.662))
TOP = StructureBox("fixture", (-0.25, -0.2, 0.743, 0.25, 0.2, 0.755), OAK)
"""A thin top of a chest of two drawers, 1 mm above the upper one."""


def thing(object_id: str, size: tuple[float, float, float], position: tuple[float, float, float]) -> SceneObject:
    return SceneObject(object_id, AssetSpec(object_id.split("|")[0], size), position, is_fixed=False)


def chest(*objects: SceneObject) -> Scene:
    scene = room(LOWER, UPPER, *objects)
    return replace(scene, structure=(*scene.structure, TOP))


def settled(scene: Scene) -> World:
    world = World(scene)
    world.settle()
    return world


def moved_by_opening(world: World, object_id: str) -> set[str]:
    before = world.save().states
    world.open(object_id)
    return {name for name, was in before.items() if world.state(name).position != was.position}


def card(object_id: str, position: tuple[float, float, float]) -> SceneObject:
    return thing(object_id, (0.085, 0.054, 0.002), position)


@pytest.mark.parametrize("level", ["low", "high"])
def test_a_drawer_takes_along_what_lies_in_it_and_nothing_from_the_drawer_or_the_top_above(level: str) -> None:
    low, high, top = (0.05, 0.05, 0.44), (0.05, 0.05, 0.602), (0.0, -0.15, 0.757)
    things = [card("CreditCard|low", low), card("CreditCard|high", high), card("CreditCard|top", top)]
    with settled(chest(*things)) as world:
        assert moved_by_opening(world, f"Drawer|{level}") == {f"CreditCard|{level}"}


def test_what_lies_in_a_box_in_a_drawer_goes_along() -> None:
    box = thing("Bowl|1", (0.2, 0.2, 0.09), (0.0, 0.04, 0.49))
    egg = thing("Egg|1", (0.05, 0.05, 0.06), (0.0, 0.04, 0.50))
    with settled(chest(box, egg)) as world:
        assert world.contents("Bowl|1") == ["Egg|1"]
        assert moved_by_opening(world, "Drawer|low") == {"Bowl|1", "Egg|1"}


def test_a_book_on_a_book_goes_along_with_the_lower_one_and_not_the_other_way_round() -> None:
    low = thing("Book|low", (0.16, 0.22, 0.03), (1.0, 1.0, 0.016))
    high = thing("Book|high", (0.14, 0.2, 0.03), (1.0, 1.0, 0.048))
    with settled(room(low, high)) as world:
        assert world.contents("Book|low") == ["Book|high"]
        assert world.contents("Book|high") == []
        x, y, z = world.state("Book|low").position
        gap = np.subtract(world.state("Book|high").position, (x, y, z))
        assert world.move("Book|low", (x + 0.3, y, z)) == ["Book|high"]
        assert np.allclose(np.subtract(world.state("Book|high").position, (x + 0.3, y, z)), gap, atol=1e-9)


def test_what_rests_partly_on_something_else_stays() -> None:
    low, beside = (thing(f"Book|{n}", (0.16, 0.22, 0.03), (1.0 + 0.17 * n, 1.0, 0.016)) for n in range(2))
    across = thing("Book|2", (0.2, 0.1, 0.02), (1.085, 1.0, 0.045))
    with settled(room(low, beside, across)) as world:
        assert world.contents("Book|0") == []
        assert world.borne("Book|0")


def test_what_stands_before_a_thing_or_under_it_stays() -> None:
    beside = mug("Mug|beside", (0.0, -0.26, 0.06))
    with settled(room(thing("Box|1", (0.4, 0.4, 0.3), (0.0, 0.0, 0.16)), beside)) as world:
        assert world.contents("Box|1") == []


def test_what_stands_on_a_cupboard_or_its_board_stays_when_its_door_opens() -> None:
    cupboard = SceneObject("Cabinet|1", AssetSpec("Cabinet", (0.5, 0.4, 0.8)), (0.0, 0.0, 0.4))
    things = [mug("Mug|top", (0.0, -0.1, 0.86)), mug("Mug|in", (0.0, 0.0, 0.1))]
    with settled(room(cupboard, *things)) as world:
        assert world.contents("Cabinet|1") == ["Mug|top", "Mug|in"]
        assert moved_by_opening(world, "Cabinet|1") == set()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count"), [("FloorPlan1", 3), ("FloorPlan12", 4), ("FloorPlan204", 0), ("FloorPlan411", 0)]
)
def test_in_recorded_rooms_drawers_take_along_what_metadata_says_is_in_them(name: str, count: int) -> None:
    """So many things are recorded to be in drawers of these rooms."""
    with settled(load_scene(name)) as world:
        drawers, found = [o for o in world.ids if world.type_of(o) == "Drawer"], 0
        assert drawers
        for drawer in drawers:
            held_by = supports(world, {o: world.box(o) for o in world.ids})
            inside = {o for o, support in held_by.items() if support.id == drawer}
            inside |= {o for o, support in held_by.items() if support.id in inside}
            assert set(world.contents(drawer)) == inside
            found += len(inside)
        assert found == count


@pytest.mark.slow
def test_what_nothing_comes_near_does_not_creep_when_something_is_put_down_elsewhere() -> None:
    """A knife in a drawer that is 1.5 cm elsewhere each time all come to rest: PyBullet lets nothing sleep there."""
    knife, plate = "Knife|+00.74|+00.76|-00.19", "Plate|-01.99|+00.85|-01.59"
    with World(load_scene("FloorPlan21")) as world:
        world.settle()
        before, x, y, z = world.save(), *world.state(plate).position
        world.settle()
        assert world.state(knife) != before.states[knife]
        world.restore(before)
        world.move_alone(plate, (x, y, z + 0.1))
        world.settle(awake=[plate])
        assert world.state(plate).position[2] == pytest.approx(z, abs=0.02)
        assert world.state(knife) == before.states[knife]
        # So that who asks PyBullet what is near is told the same as in a world that was never settled.
        lying = [world.client.getBasePositionAndOrientation(world._bodies._of[name])[0] for name in world.ids]
        assert np.array_equal(lying, [world.state(name).position for name in world.ids])


def test_who_is_near_what_moves_has_met_it_and_so_has_who_is_near_him() -> None:
    def path(x: float, moved_m: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        box = np.array([(x, 0.0, 0.0), (x + 0.1, 0.1, 0.1)])
        return box, box + np.array((moved_m, 0.0, 0.0))

    row = {"thrown": path(0.0, 0.5), "hit": path(0.605, 0.1), "pushed": path(0.81, 0.01), "far": path(1.0, 0.01)}
    assert met_nothing(row, ["thrown"]) == ["far"]
    assert met_nothing(row, []) == [*row]
    assert met_nothing({}, ["thrown"]) == []
