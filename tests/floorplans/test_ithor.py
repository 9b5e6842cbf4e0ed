"""The promises about the 120 rooms."""

from dataclasses import dataclass

import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene, scene_names
from remqa_data.floorplans.ithor.table import recorded_objects
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.navigation.viewpoints import front_points
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from tests.helpers.poses import pose_that_sees_and_reaches

SOME = ("FloorPlan1", "FloorPlan210", "FloorPlan316", "FloorPlan415")
OPENABLE_RECEPTACLES = ("Cabinet", "Drawer", "Fridge", "Microwave", "Safe", "LaundryHamper", "Box", "Toilet")


@dataclass
class Tally:
    """What is counted over rooms."""

    objects: int = 0
    fitting: int = 0
    loose: int = 0
    at_rest: int = 0
    pairs: int = 0
    openable: int = 0
    usable: int = 0


def survey(names: tuple[str, ...]) -> tuple[Tally, list[str]]:
    """Measure some rooms; also what is plainly wrong, which must be nothing."""
    tally, wrong = Tally(), []
    for name in names:
        scene = load_scene(name)
        rows = {row.id: row for row in recorded_objects(name)}
        if {o.id for o in scene.objects} != set(rows):
            wrong.append(f"{name}: objects are missing")
        with World(scene) as world:
            count_fit(world, rows, tally)
            count_settling(world, rows, tally, wrong)
            count_depths(world, rows, tally, wrong)
            grid = reachable_grid(world)
            if len(grid.cells) < 30:
                wrong.append(f"{name}: only {len(grid.cells)} reachable cells")
            count_usable(world, grid, tally)
    return tally, wrong


def count_fit(world, rows, tally: Tally) -> None:
    for object_id in world.ids:
        box, row = world.box(object_id), rows[object_id]
        off = np.linalg.norm(box.mean(axis=0) - (row.low + row.high) / 2)
        grown = np.abs((box[1] - box[0]) / (row.high - row.low) - 1).max()
        tally.objects += 1
        tally.fitting += bool(off < 0.05 and grown < 0.10)


def count_settling(world, rows, tally: Tally, wrong: list[str]) -> None:
    before = world.save().states
    world.settle(240)
    for object_id in world.ids:
        if not rows[object_id].pickupable:
            continue
        position = np.array(world.state(object_id).position)
        moved = np.linalg.norm(position - before[object_id].position)
        tally.loose += 1
        tally.at_rest += bool(moved < 0.05)
        if position[2] < world.scene.floor_z - 0.02 or moved > 2.5:
            wrong.append(f"{world.scene.name}: {object_id} fell through or flew off to {position.round(2)}")


def count_depths(world, rows, tally: Tally, wrong: list[str]) -> None:
    for object_id in world.ids:
        for other, distance in world.overlapping(object_id):
            if other == "structure" or other < object_id:
                continue
            tally.pairs += 1
            if -distance > recorded_depth(rows[object_id], rows[other]) + 0.01:
                wrong.append(f"{world.scene.name}: {object_id} is {-distance:.3f} m deep in {other}")


def recorded_depth(a, b) -> float:
    """How far the recorded boxes of two objects have to be moved to come apart: what PyBullet calls the distance."""
    return max(0.0, float(np.min(np.minimum(a.high - b.low, b.high - a.low))))


def count_usable(world, grid, tally: Tally) -> None:
    view = WorldView(world)
    for object_id in world.ids:
        if world.type_of(object_id) in OPENABLE_RECEPTACLES:
            tally.openable += 1
            pose = pose_that_sees_and_reaches(view, grid, object_id, front_points(view, object_id))
            tally.usable += pose is not None


def check(tally: Tally, wrong: list[str]) -> None:
    print(tally)
    assert not wrong
    assert tally.fitting / tally.objects >= 0.97
    assert tally.at_rest / tally.loose >= 0.95
    assert tally.usable / tally.openable >= 0.95
    assert tally.pairs > 0


@pytest.mark.slow
def test_all_rooms_are_as_recorded() -> None:
    check(*survey(scene_names()))


@pytest.mark.slow
def test_the_same_room_every_time() -> None:
    name = "FloorPlan2"
    first = load_scene(name).to_json()
    load_scene.cache_clear()
    assert load_scene(name).to_json() == first


@pytest.mark.slow
def test_floors_carry_what_stands_on_them() -> None:
    """The bottoms of most furniture are at floor level, whatever the floor's own recorded box says."""
    for name in SOME:
        scene = load_scene(name)
        bottoms = [
            o.position[2] - o.asset.size[2] / 2 for o in scene.objects if o.type in ("Fridge", "Sofa", "Bed", "Toilet")
        ]
        assert bottoms, name
        assert np.all(np.abs(np.array(bottoms) - scene.floor_z) < 0.06), name


def test_worktops_of_a_kitchen_are_of_one_material() -> None:
    looks = {(o.asset.variant, o.asset.seed) for o in load_scene("FloorPlan1").objects if o.type == "CounterTop"}
    assert len(looks) == 1
