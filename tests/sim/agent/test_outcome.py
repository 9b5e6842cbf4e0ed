"""When a thing is manipulated, in rooms that are changed by hand."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.sim.agent.agent import Agent
from remqa_data.sim.agent.outcome import Before, Wanted, is_manipulated, look_before
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from tests.helpers.bare_rooms import first_of

FAR = (50.0, 50.0)
"""A goal from which nobody is in the way."""


@pytest.fixture(scope="module")
def loaded() -> Iterator[Agent]:
    with World(load_scene("FloorPlan1")) as world:
        yield Agent(world, WorldView(world), (0.0, 0.0), 0.0)


@pytest.fixture
def agent(loaded: Agent) -> Iterator[Agent]:
    first = loaded.world.save()
    yield loaded
    loaded.world.restore(first)


@pytest.fixture
def world(agent: Agent) -> World:
    return agent.world


def test_a_thing_is_open_from_four_fifths_of_what_the_room_allows(agent: Agent, world: World) -> None:
    name = first_of(world, "Fridge")
    most, before = world.most_open(name), look_before(agent, Wanted("Open", name, FAR))
    assert most > 0
    found = []
    for share in (0.0, 0.5, 0.799, 0.8, 1.0):
        world.open(name, share * most)
        found.append(is_manipulated(world, before))
    assert found == [False, False, False, True, True]
    world.open(name, 0.0)
    assert not is_manipulated(world, before)  # opened and closed again


def test_where_a_viewer_of_the_end_frame_stops_a_drawer_no_more_is_asked(agent: Agent, world: World) -> None:
    name = next(i for i in world.ids if world.type_of(i) == "Drawer" and world.state(i).position[2] < 1.0)
    closed = world.box(name)[:, :2]
    world.open(name, 1.0)
    out = world.box(name)[:, :2] - closed  # it slides out to one side
    world.open(name, 0.0)
    row, column = np.unravel_index(np.abs(out).argmax(), (2, 2))
    length, place = float(out[row, column]), closed.mean(axis=0)
    assert abs(length) > 0.2
    # Half its way out it touches an agent whose middle is half of that and the agent's radius before its front.
    place[column] = closed[row, column] + length / 2 + np.sign(length) * agent.embodiment.radius_m
    goal = (float(place[0]), float(place[1]))
    stopped, free = (look_before(agent, Wanted("Open", name, at)) for at in (goal, FAR))
    assert (stopped.opens_to, free.opens_to) == (pytest.approx(0.5, abs=0.1), 1.0)
    found = []
    for openness in (0.3, 0.5, 0.75, 0.85):
        world.open(name, openness)
        found.append((is_manipulated(world, stopped), is_manipulated(world, free)))
    assert found == [(False, False), (True, False), (True, False), (True, True)]


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, 45.0, 90.0])
def test_a_thing_is_moved_when_nothing_is_under_it_that_was(agent: Agent, world: World, yaw_deg: float) -> None:
    # Two equal rectangles that are shifted against each other share no area once the shift along one side is that side.
    name = first_of(world, "Toaster")
    half = np.radians(yaw_deg) / 2
    world.move(name, world.state(name).position, (0.0, 0.0, float(np.sin(half)), float(np.cos(half))))
    before = look_before(agent, Wanted("Move", name, FAR))
    width, depth, _ = world.assets[name].spec.size
    along = np.array([np.cos(2 * half), np.sin(2 * half), 0.0])
    across = np.array([-along[1], along[0], 0.0])

    def moved_by(shift: np.ndarray) -> bool:
        x, y, z = (np.array(before.state.position) + shift).tolist()
        world.move(name, (x, y, z))
        return is_manipulated(world, before)

    assert [moved_by(share * width * along) for share in (0.0, 0.5, 0.99, 1.01, -1.01)] == [False] * 3 + [True] * 2
    assert [moved_by(share * depth * across) for share in (0.99, 1.01, -1.01)] == [False, True, True]
    assert not moved_by(0.99 * (width * along + depth * across))  # a corner still covers a corner
    assert not moved_by(np.array([0.0, 0.0, 0.5]))  # it hangs over what it hid


def test_a_thing_is_picked_up_when_it_is_held_and_then_it_is_not_moved(agent: Agent, world: World) -> None:
    name = first_of(world, "Book")
    before = look_before(agent, Wanted("Pickup", name, FAR))
    position = before.state.position
    assert not is_manipulated(world, before)
    world.pick_up(name)
    assert is_manipulated(world, before)
    far = replace(before.state, position=(position[0] + 9.0, *position[1:]))
    assert not is_manipulated(world, Before(Wanted("Move", name, FAR), far, 0.0))
    world.put(name, position)
    assert not is_manipulated(world, before)
