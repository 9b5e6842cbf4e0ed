import math
from collections.abc import Iterator

import numpy as np
import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.assets.looks.materials import OAK
from remqa_data.errors import UnknownNameError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.geometry.arithmetic import arctan2
from remqa_data.scene import Scene, SceneObject, StructureBox
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.agent.third_person import RobotView
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera, Windows
from remqa_data.sim.render.view import WorldView
from tests.helpers.bare_rooms import first_of

FROM_ABOVE = Camera.look_at((0.0, -0.6, 0.8), (0.1, 0.2, 0.05), width=80, height=80)


@pytest.fixture
def world() -> Iterator[World]:
    """A mug on a floor."""
    mug = AssetSpec("Mug", (0.1, 0.09, 0.1), 1, 5, levels=(0.01,))
    floor = StructureBox("floor", (-1, -1, -0.1, 1, 1, 0), OAK)
    scene = Scene(
        "Test",
        "kitchen",
        (-1.0, -1.0, 1.0, 1.0),
        0.0,
        2.5,
        ((0.0, 0.0, 2.4),),
        (floor,),
        (SceneObject("Mug|1", mug, (0.1, 0.2, 0.05), is_fixed=False),),
    )
    with World(scene) as made:
        yield made


def sees_mug(view: WorldView) -> bool:
    return bool((view.instances(FROM_ABOVE) == 0).any())


def test_what_is_held_is_in_no_picture_however_it_came_into_the_hand_or_left_it(world: World) -> None:
    view, first = WorldView(world), world.save()
    assert sees_mug(view)
    world.pick_up("Mug|1")
    in_hand = world.save()
    assert not sees_mug(view)
    assert not sees_mug(WorldView(world))
    world.restore(first)
    assert sees_mug(view)
    world.restore(in_hand)
    assert not sees_mug(view)
    world.put("Mug|1", (0.1, 0.1, 0.05))
    assert sees_mug(view)


def test_what_was_hidden_stays_hidden_when_it_is_put_back(world: World) -> None:
    view = WorldView(world)
    view.hide("Mug|1")
    world.pick_up("Mug|1")
    world.put("Mug|1", (0.1, 0.2, 0.05))
    assert not sees_mug(view)
    view.hide("Mug|1", False)
    assert sees_mug(view)


def test_to_show_what_is_held_takes_putting_it_back(world: World) -> None:
    view = WorldView(world)
    world.pick_up("Mug|1")
    view.hide("Mug|1", False)
    assert not sees_mug(view)


def test_from_outside_the_held_object_is_in_the_hand_and_back_in_its_place_after_a_restore(world: World) -> None:
    agent = Agent(world, WorldView(world), (-0.5, -0.5), 0.0)
    view, first = RobotView(agent), world.save()
    at_rest = view.depth_and_instances(FROM_ABOVE)
    assert (at_rest[1] == 0).any()
    world.pick_up("Mug|1")
    view.sync()
    hand = np.array(agent.arm.hand(agent.base))
    near = Camera.look_at(tuple(hand + 0.5), tuple(hand), width=80, height=80)
    assert (view.instances(near) == 0).any()
    for camera in (near, FROM_ABOVE):  # the robot's own parts are no object
        depth, objects = view.depth_and_instances(camera)
        assert np.array_equal(view.instances(camera), objects)
        assert np.array_equal(view.depth(camera), depth)
        assert view.pixels(camera).tolist() == [(objects == 0).sum()]
    world.restore(first)
    for now, before in zip(view.depth_and_instances(FROM_ABOVE), at_rest, strict=True):
        assert np.array_equal(now, before)


def test_some_parts_alone_are_drawn_as_if_there_were_nothing_else(world: World) -> None:
    view = WorldView(world)
    before = view.depth_and_instances(FROM_ABOVE)
    alone = view.instances(FROM_ABOVE, view.parts_of(["Mug|1"]))
    assert set(np.unique(alone)) == {-1, world.ids.index("Mug|1")}
    assert np.count_nonzero(alone >= 0) >= np.count_nonzero(before[1] == world.ids.index("Mug|1")) > 0
    for now, then in zip(view.depth_and_instances(FROM_ABOVE), before, strict=True):
        assert np.array_equal(now, then)


def test_around_an_object_is_all_that_is_seen_of_it(world: World) -> None:
    view = WorldView(world)
    whole, around = FROM_ABOVE.view(), view.scissor_around(FROM_ABOVE, ["Mug|1"])
    assert whole.is_whole
    assert not whole._replace(scissor=around).is_whole
    assert view.pixels(FROM_ABOVE, scissor=around) == view.pixels(FROM_ABOVE) > 0
    rows, columns = np.nonzero(view.instances(FROM_ABOVE) == 0)
    assert 0 < rows.min() - around.top < 8
    assert 0 < around.right - columns.max() < 8


def test_pixels_are_counted_as_the_picture_shows_them(world) -> None:
    view, scene = WorldView(world), world.scene
    (shown,) = view.pixels(FROM_ABOVE)
    assert shown == (view.instances(FROM_ABOVE) == 0).sum() > 0
    eyes = np.array([(0.0, -0.6, 0.8), (0.9, 0.9, 1.5), (0.1, 0.2, 0.9)])
    targets, side = np.tile(scene.objects[0].position, (3, 1)), np.array([80, 30, 2])
    windows = Windows.looking_at(eyes, targets, side, 40.0)
    counts = view.pixels_in_windows(windows)
    assert counts.shape == (3, 1)
    assert (counts > 0).all()
    for eye, target, pixels, count in zip(eyes.tolist(), targets.tolist(), side.tolist(), counts, strict=True):
        fov_deg = 2 * math.degrees(arctan2(pixels / 2, 40.0))
        camera = Camera.look_at(tuple(eye), tuple(target), fov_deg=fov_deg, width=pixels, height=pixels)
        assert count == (view.instances(camera) == 0).sum()
    assert not view.pixels_in_windows(windows, ~view.parts_of(["Mug|1"])).any()


@pytest.mark.slow
def test_of_some_objects_as_many_pixels_are_counted_as_of_all() -> None:
    """From anywhere: also of what is behind the camera in part, hidden, or out of the picture."""
    rng = np.random.default_rng(0)
    with World(load_scene("FloorPlan1")) as room:
        fridge = first_of(room, "Fridge")
        room.open(fridge, 1.0)
        view = WorldView(room)
        x0, y0, x1, y1 = room.scene.bounds
        some_seen = 0
        for _ in range(12):
            eye = (*rng.uniform((x0 + 0.3, y0 + 0.3), (x1 - 0.3, y1 - 0.3)).tolist(), 1.5)
            camera = Camera(eye, float(rng.uniform(0, 360)), float(rng.choice([-30, 0, 30, 60])), 90.0, 150, 150)
            every = view.pixels(camera)
            for index, name in enumerate(room.ids):
                assert view.pixels_of(camera, [name])[index] == every[index], (name, camera)
            pair = [int(i) for i in rng.choice(len(room.ids), 2, replace=False)]
            found = view.pixels_of(camera, [room.ids[i] for i in pair])
            assert found[pair].tolist() == every[pair].tolist()
            some_seen += np.count_nonzero(every)
        assert some_seen > 100


def test_only_what_there_is_can_be_hidden(world: World) -> None:
    with pytest.raises(UnknownNameError, match="Cup"):
        WorldView(world).hide("Cup|1")
    with pytest.raises(UnknownNameError, match="Cup"):
        WorldView(world).parts_of(["Cup|1"])


@pytest.mark.parametrize("brightness", [[], [1.0] * 9, [-1.0], [np.nan]])
def test_lamps_shine_as_bright_as_numbers_can_say(world: World, brightness: list[float]) -> None:
    with pytest.raises(ValueError, match=r"give \d numbers, none negative"):
        WorldView(world).set_brightness(brightness)
