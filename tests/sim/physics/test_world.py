import math
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import psutil
import pytest

from remqa_data.assets import build
from remqa_data.assets.core.model import AssetSpec
from remqa_data.errors import ActionError, UnknownNameError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.physics.world import World
from tests.helpers.bare_rooms import first_of, mug, room

DRAWER = SceneObject("Drawer|1", AssetSpec("Drawer", (0.5, 0.4, 0.2)), (0.0, 0.0, 0.5))


@pytest.fixture(scope="module")
def kitchen() -> Scene:
    return load_scene("FloorPlan1")


def test_a_mug_falls_to_the_floor_and_stands_on_it() -> None:
    with World(room(mug())) as world:
        world.settle()
        assert world.box("Mug|1")[0, 2] == pytest.approx(0.0, abs=0.003)
        assert np.allclose(world.state("Mug|1").position[:2], 0, atol=0.01)


def test_fixed_things_hang_where_they_are() -> None:
    with World(room(mug(is_fixed=True))) as world:
        world.settle(60)
        assert world.state("Mug|1").position == (0.0, 0.0, 0.3)


def test_a_drawer_carries_its_contents_without_slip() -> None:
    with World(room(DRAWER, mug(position=(0.0, 0.05, 0.49)))) as world:
        world.settle()
        start = np.array(world.state("Mug|1").position)
        assert world.contents("Drawer|1") == ["Mug|1"]
        assert world.open("Drawer|1") == ["Mug|1"]
        moved = np.array(world.state("Mug|1").position)
        link = world.assets["Drawer|1"].links[1].joint
        assert link is not None
        assert np.allclose(moved - start, [0, -link.upper, 0], atol=1e-12)
        world.close_object("Drawer|1")
        assert np.allclose(world.state("Mug|1").position, start, atol=1e-12)


def test_moving_a_container_takes_its_contents_along_and_turns_them() -> None:
    with World(room(DRAWER, mug(position=(0.1, 0.05, 0.49)))) as world:
        world.settle()
        inside = np.array(world.state("Mug|1").position) - DRAWER.position
        half = np.sqrt(0.5)
        world.move("Drawer|1", (1.0, 1.0, 0.5), (0.0, 0.0, half, half))
        expected = np.array([1.0 - inside[1], 1.0 + inside[0], 0.5 + inside[2]])
        assert np.allclose(world.state("Mug|1").position, expected, atol=1e-9)


def test_pick_up_and_put() -> None:
    with World(room(mug(), mug("Mug|2", (1.0, 0.0, 0.2)))) as world:
        world.settle()
        world.pick_up("Mug|1")
        with pytest.raises(ActionError, match=r"already holding Mug\|1"):
            world.pick_up("Mug|2")
        before = world.state("Mug|1")
        world.settle(60)
        assert world.state("Mug|1") == before
        world.put("Mug|1", (0.5, 0.5, 0.2))
        world.settle()
        assert world.box("Mug|1")[0, 2] == pytest.approx(0.0, abs=0.003)
        with pytest.raises(ActionError, match=r"Mug\|1 is not held"):
            world.put("Mug|1", (0, 0, 1))


def test_each_agent_has_a_hand(kitchen: Scene) -> None:
    with World(kitchen) as world:
        apple, egg, fork = (first_of(world, kind) for kind in ("Apple", "Egg", "Fork"))
        world.pick_up(apple, agent=1)
        with pytest.raises(ActionError, match=rf"cannot pick up {re.escape(apple)}: agent 1 holds it"):
            world.pick_up(apple)
        world.pick_up(egg)
        with pytest.raises(ActionError, match=rf"already holding {re.escape(apple)}"):
            world.pick_up(fork, agent=1)
        assert [world.held_by(agent) for agent in range(3)] == [egg, apple, None]
        both = world.save()
        out = {name: world.state(name) for name in (apple, egg)}
        world.settle(60)
        assert out == {name: world.state(name) for name in (apple, egg)}
        world.put(egg, world.state(fork).position)
        assert (world.held_by(0), world.held_by(1)) == (None, apple)
        assert fork in dict(world.overlapping(egg))
        assert apple not in dict(world.overlapping(egg, 10.0))
        world.restore(both)
        assert world.held == {apple: 1, egg: 0}
        assert egg not in dict(world.overlapping(fork, 10.0))


def test_a_hanging_thing_becomes_loose_when_it_is_picked_up() -> None:
    with World(room(mug(is_fixed=True))) as world:
        world.pick_up("Mug|1")
        world.put("Mug|1", (0.0, 0.0, 0.5))
        world.settle()
        assert world.box("Mug|1")[0, 2] == pytest.approx(0.0, abs=0.003)


def test_a_hanging_thing_is_in_the_way_again_when_it_is_restored() -> None:
    with World(room(mug(is_fixed=True), mug("Mug|2", (1.0, 0.0, 0.2)))) as world:
        first = world.save()
        x, y, z = world.state("Mug|1").position
        world.pick_up("Mug|1")
        assert world.first_hit((x - 0.3, y, z), (x + 0.3, y, z)) is None
        world.restore(first)
        hit = world.first_hit((x - 0.3, y, z), (x + 0.3, y, z))
        assert hit is not None
        assert hit[0] == "Mug|1"
        world.move_alone("Mug|2", (x, y, z))
        assert "Mug|1" in dict(world.overlapping("Mug|2"))


def test_refusals_say_why() -> None:
    with World(room(DRAWER, mug())) as world:
        with pytest.raises(ActionError, match=r"Mug\|1 is not openable"):
            world.open("Mug|1")
        with pytest.raises(ActionError, match="not between 0 and 1"):
            world.open("Drawer|1", 1.5)
        with pytest.raises(ActionError, match=r"Drawer\|1 is not pickupable"):
            world.pick_up("Drawer|1")
        with pytest.raises(UnknownNameError, match=r"did you mean 'Mug\|1'"):
            world.state("Mug|11")


def test_overlapping_measures_distance_and_depth() -> None:
    with World(room(mug(position=(0, 0, 0.06)), mug("Mug|2", (0.5, 0.0, 0.06)))) as world:
        near = dict(world.overlapping("Mug|1", 0.02))
        assert set(near) == {"structure"}
        assert near["structure"] == pytest.approx(0.01, abs=2e-3)
        world.move_alone("Mug|2", (0.05, 0.0, 0.06))
        assert dict(world.overlapping("Mug|1"))["Mug|2"] < 0


def states(world: World) -> dict[str, object]:
    return world.save().states


@pytest.mark.slow
def test_save_and_restore_are_exact_and_so_is_what_follows(kitchen: Scene) -> None:
    with World(kitchen) as world:
        world.settle(60)
        saved = world.save()
        drawer = first_of(world, "Drawer")
        apple = first_of(world, "Apple")
        world.open(drawer)
        world.pick_up(apple)
        world.settle(30)
        world.restore(saved)
        assert world.save() == saved
        world.settle(60)
        first = states(world)
        world.restore(saved)
        world.settle(60)
        assert states(world) == first


@pytest.mark.slow
def test_a_world_begun_again_is_for_pybullet_as_one_just_loaded(kitchen: Scene) -> None:
    with World(kitchen) as world:
        bodies = list(world._bodies._of.values())

        def joints() -> list[object]:
            count = world.client.getNumJoints
            return [world.client.getJointState(body, number)[:2] for body in bodies for number in range(count(body))]

        first, loaded = world.save(), joints()
        world.settle()
        world.restore(first)
        assert joints() != loaded  # a drawer is elsewhere by a micrometre
        world.restart(first)
        assert joints() == loaded
        revision = world.revision
        world.restart(first)
        assert world.revision == revision


@pytest.mark.slow
def test_a_stored_scene_gives_the_same_world_bit_for_bit(kitchen: Scene) -> None:
    with World(kitchen) as world, World(Scene.from_json(kitchen.to_json())) as again:
        world.settle(40)
        again.settle(40)
        assert states(world) == states(again)
        stored = Scene.from_json(world.to_scene().to_json())
        world.settle(40)
        with World(stored) as later:
            later.settle(40)
            assert states(later) == states(world)


@pytest.mark.slow
def test_another_process_gets_the_same_bits() -> None:
    code = (
        "import hashlib\n"
        "from remqa_data.floorplans.ithor.scenes import load_scene\n"
        "from remqa_data.sim.physics.world import World\n"
        "world = World(load_scene('FloorPlan401')); world.settle(60)\n"
        "print(hashlib.sha256(world.to_scene().to_json()).hexdigest())"
    )
    run = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True) for _ in range(2)]
    digests = {result.stdout.split()[-1] for result in run}
    assert len(digests) == 1
    assert len(digests.pop()) == 64


def test_unknown_asset_type_is_an_error_before_anything_loads() -> None:
    broken = replace(mug(), asset=AssetSpec("Mugg", (0.1, 0.1, 0.1)))
    with pytest.raises(UnknownNameError, match="did you mean 'Mug'"):
        World(room(broken))


@pytest.mark.slow
def test_100_loads_keep_memory_flat(kitchen: Scene) -> None:
    process = psutil.Process()
    for _ in range(10):
        World(kitchen).close()
    before = process.memory_info().rss
    for _ in range(100):
        World(kitchen).close()
    grown = process.memory_info().rss - before
    print(f"{grown / 1e6:.1f} MB more")
    assert grown < 20e6


@pytest.mark.slow
@pytest.mark.parametrize("variant", range(4))
def test_each_door_of_a_wide_fridge_opens_and_leaves_what_stands_on_the_shelves(variant: int) -> None:
    """Its doors and its body have more boxes than one of PyBullet's links takes."""
    fridge = SceneObject("Fridge|1", AssetSpec("Fridge", (1.1, 0.8, 1.9), variant=variant, seed=1), (0.0, 0.0, 0.95))
    spaces = [space for space in build(fridge.asset).spaces if space.enclosed and space.link == 0]
    things = [
        mug(f"Mug|{n}|{side}", (side * 0.2, (space.box[1] + space.box[4]) / 2, 0.95 + space.box[2] + 0.06))
        for n, space in enumerate(spaces)
        for side in (-1, 1)
    ]
    assert things
    with World(room(fridge, *things)) as world:
        world.settle()
        links = world.assets["Fridge|1"].links
        assert len(links) >= 3
        assert max(len(link.boxes) for link in links) > 16
        before, closed = world.save(), world.link_poses("Fridge|1")
        assert set(world.open("Fridge|1")).isdisjoint(thing.id for thing in things)
        for thing in things:
            assert world.state(thing.id).position == before.states[thing.id].position
        opened = world.link_poses("Fridge|1")
        for number, link in enumerate(links[1:], 1):
            size, middle = np.array(link.boxes[0].size), np.array(link.boxes[0].centre)
            ends = [
                [pose[:3, :3] @ (middle + np.array([0, y, 0])) + pose[:3, 3] for y in (-1.5 * size[1], 1.5 * size[1])]
                for pose in (closed[number], opened[number])
            ]
            hits = [world.client.rayTest(start, end)[0][0] for start, end in ends]
            assert hits[0] == -1, f"{link.name} is still where it was"
            assert hits[1] >= 0, f"{link.name} is not where it went"


def test_a_load_goes_along_in_the_hand_and_back() -> None:
    scene = load_scene("FloorPlan1")
    plate, egg = (next(o.id for o in scene.objects if o.type == name) for name in ("Plate", "Egg"))
    with World(scene) as world:
        x, y, z = world.state(plate).position
        world.move_alone(egg, (x, y, z + 0.06))
        world.settle()
        before = world.save()
        assert egg in world.contents(plate)
        between = np.subtract(world.state(egg).position, world.state(plate).position)
        world.pick_up(plate, 1, [egg])
        assert (world.held_by(1), world.load_of(plate), world.load_of(egg)) == (plate, [egg], [])
        revision = world.revision
        quarter = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
        world.move_alone(plate, (x, y, z), (0.0, 0.0, 0.0, 1.0))
        world.move_alone(plate, (x, y, z), quarter)
        assert world.revision == revision  # what is in a hand is nowhere in the room
        with pytest.raises(ActionError, match="is not held"):
            world.put(egg, (x, y, z))
        held = world.save()
        world.put(plate, (x + 0.1, y, z + 0.5))
        assert not world.held
        assert np.linalg.norm(np.subtract(world.state(egg).position, world.state(plate).position)) == pytest.approx(
            np.linalg.norm(between)
        )
        world.restore(held)
        assert world.is_as(held)
        world.put_away(plate)
        assert not world.held
        world.restore(before)
        assert world.is_as(before)


@pytest.mark.parametrize(
    ("position", "quaternion"),
    [
        ((math.nan, 0.0, 0.1), None),
        ((0.0, math.inf, 0.1), None),
        ((0.0, 0.0, 0.1), (0.0, 0.0, 1.0, 1.0)),
        ((0.0, 0.0, 0.1), (0.0, 0.0, 0.0, 0.0)),
        ((0.0, 0.0, 0.1), (0.0, 0.0, math.nan, 1.0)),
    ],
)
def test_what_is_no_pose_is_refused_and_nothing_moves(position, quaternion) -> None:
    with World(room(mug())) as world:
        before = world.save()
        for put in (world.move, world.move_alone):
            with pytest.raises(ActionError, match="give finite numbers and a unit quaternion"):
                put("Mug|1", position, quaternion)
        assert world.is_as(before)


def test_names_of_nothing_are_told_so() -> None:
    with World(room(mug())) as world:
        for ask in (
            lambda: world.settle(5, {"Cup|1": (0.0, 0.0, 1.0)}),
            lambda: world.settle(5, awake=["Cup|1"]),
            lambda: world.without_collisions("Cup|1").__enter__(),
        ):
            with pytest.raises(UnknownNameError, match=re.escape("Cup|1")):
                ask()


def test_what_was_held_while_others_settled_is_back_in_its_place_for_physics_too() -> None:
    with World(room(DRAWER, mug(position=(0.0, 0.05, 0.49)))) as world:
        world.settle()
        first = world.save()
        x, y, z = world.state("Mug|1").position
        world.pick_up("Mug|1")
        world.settle()
        world.restore(first)
        assert world.is_as(first)
        found = world.first_hit((x, y, z + 0.09), (x, y, z - 0.3))
        assert found is not None
        assert found[0] == "Mug|1"
        assert world.contents("Drawer|1") == ["Mug|1"]
        assert world.open("Drawer|1") == ["Mug|1"]


def test_what_is_away_is_not_taken_or_moved_and_not_stored() -> None:
    with World(room(mug(), mug("Mug|2", position=(1.0, 0.0, 0.1)))) as world:
        world.settle()
        world.put_away("Mug|1")
        for act in (lambda: world.pick_up("Mug|1"), lambda: world.move("Mug|1", (0.0, 0.0, 1.0))):
            with pytest.raises(ActionError, match=r"Mug\|1 is away: put it back first"):
                act()
        assert (world.held, list(world.away)) == ({}, ["Mug|1"])
        stored = Scene.from_json(world.to_scene().to_json())
        assert [thing.id for thing in stored.objects] == ["Mug|2"]


@pytest.mark.parametrize("load", [["x"], ["Mug|1"], ["Mug|2", "Mug|3"]])
def test_a_load_that_cannot_be_taken_leaves_all_as_it_was(load: list[str]) -> None:
    things = [mug(f"Mug|{number}", position=(0.5 * number, 0.0, 0.1)) for number in (1, 2, 3)]
    with World(room(*things)) as world:
        world.settle()
        world.pick_up("Mug|3", agent=1)
        first = world.save()
        with pytest.raises((ActionError, UnknownNameError)):
            world.pick_up("Mug|1", load=load)
        assert world.is_as(first)


def test_what_is_in_a_hand_is_not_fixed() -> None:
    with World(room(mug())) as world:
        world.pick_up("Mug|1")
        with pytest.raises(ActionError, match="is in a hand: put it down before it is fixed"):
            world.set_fixed("Mug|1", True)
        world.put("Mug|1", (0.0, 0.0, 0.3))
        assert not world.state("Mug|1").is_fixed


def test_a_thing_goes_along_with_itself_once() -> None:
    with World(room(mug())) as world:
        x, y, z = world.state("Mug|1").position
        assert world.move("Mug|1", (x, y, z + 1.0), along=["Mug|1"]) == []
        assert world.state("Mug|1").position == (x, y, z + 1.0)


@pytest.mark.parametrize("velocity", [(math.nan, 0.0, 0.0), (1.0, 0.0), (0.0, 0.0, math.inf)])
def test_what_is_no_velocity_is_refused(velocity: tuple[float, ...]) -> None:
    with World(room(mug())) as world:
        first = world.save()
        with pytest.raises(ActionError, match=r"velocity of Mug\|1 is .*: give three finite numbers"):
            world.settle(velocities={"Mug|1": velocity})  # type: ignore[dict-item]
        assert world.is_as(first)
