"""What is held is put where a household would put it: inside, in sight, turned so that it fits, out of the agent's way."""

from collections.abc import Iterator

import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.sim.agent.agent import LEAST_OPEN, Agent
from remqa_data.sim.agent.handling import sunk_into, support_of
from remqa_data.sim.agent.receptacles import lattice, open_spaces
from remqa_data.sim.physics.support import supports
from remqa_data.sim.physics.world import Snapshot, World
from remqa_data.sim.render.view import WorldView
from tests.helpers.bare_rooms import first_of

pytestmark = pytest.mark.slow

NARROW = "Drawer|-02.11|+00.75|-01.39"
CUTLERY = ("Fork", "Spoon", "ButterKnife", "Knife")


def rested(room: str) -> Iterator[tuple[Agent, Snapshot]]:
    with World(load_scene(room)) as world:
        world.settle()
        yield Agent(world, WorldView(world), (0.0, 0.0), 0.0, hands="near"), world.save()


@pytest.fixture(scope="module")
def kitchen() -> Iterator[tuple[Agent, Snapshot]]:
    yield from rested("FloorPlan8")


@pytest.fixture(scope="module")
def bathroom() -> Iterator[tuple[Agent, Snapshot]]:
    yield from rested("FloorPlan403")


def amid(loaded: tuple[Agent, Snapshot]) -> Agent:
    """An agent amid a room as it was at first."""
    made, first = loaded
    made.world.restore(first)
    cells = made.grid.cells
    made.place(made.grid.position(cells[len(cells) // 2]), 0.0)
    return made


@pytest.fixture
def agent(kitchen: tuple[Agent, Snapshot]) -> Agent:
    return amid(kitchen)


def on(world: World, holder: str) -> list[str]:
    held_by = supports(world, {name: world.box(name) for name in world.ids})
    return [name for name, support in held_by.items() if support.id == holder]


def hold(agent: Agent, type_name: str) -> str:
    thing = first_of(agent.world, type_name)
    assert agent.pick_up(thing, force=True).success
    return thing


@pytest.mark.parametrize("cutlery", CUTLERY)
@pytest.mark.parametrize("vessel", ["Cup", "Mug", "Bowl", "Plate", "Pan"])
def test_cutlery_stands_in_cups_and_lies_in_bowls(agent: Agent, cutlery: str, vessel: str) -> None:
    thing, into = hold(agent, cutlery), first_of(agent.world, vessel)
    put = agent.put(into, force=True)
    assert put.success, put.error
    assert support_of(agent.world, thing) == into
    assert not sunk_into(agent.world, thing)
    (x0, y0, z0), (x1, y1, _) = agent.world.box(into)
    low, high = agent.world.box(thing)
    x, y, _ = (low + high) / 2
    assert x0 < x < x1
    assert y0 < y < y1
    assert low[2] > z0 - 0.005


def test_cutlery_in_a_cup_is_steep(agent: Agent) -> None:
    fork = hold(agent, "Fork")
    lying = np.ptp(agent.world.box(fork), axis=0)[2]
    assert agent.put(first_of(agent.world, "Mug"), force=True).success
    assert np.ptp(agent.world.box(fork), axis=0)[2] > max(3 * lying, 0.08)


def test_a_microwave_takes_things_in_and_not_on_its_top(agent: Agent) -> None:
    apple, microwave = hold(agent, "Apple"), first_of(agent.world, "Microwave")
    refused = agent.put(microwave, force=True)
    assert refused.error == f"{microwave} is closed"
    assert agent.held == apple
    agent.world.open(microwave)
    assert agent.put(microwave, force=True).success
    (x0, y0, z0), (x1, y1, z1) = agent.world.box(microwave)
    low, high = agent.world.box(apple)
    assert (low > (x0, y0, z0)).all()
    assert (high < (x1, y1, z1)).all()


def test_what_is_put_on_a_counter_is_in_sight(agent: Agent) -> None:
    counter = max(
        (n for n in agent.world.ids if agent.world.type_of(n) == "CounterTop"), key=lambda n: top_area(agent, n)
    )
    tried = 0
    for cell in agent.grid.cells[::4]:
        for yaw in (0.0, 90.0, 180.0, 270.0):
            agent.place(agent.grid.position(cell), yaw, 30.0)
            if agent.view.pixels(agent.camera())[agent.world.ids.index(counter)] < 8000:
                continue
            mug = hold(agent, "Mug")
            assert agent.put(counter, force=True).success
            assert mug in agent.visible_objects(), (cell, yaw)
            tried += 1
    assert tried >= 5


def test_who_puts_a_thing_on_the_floor_can_walk_away(agent: Agent) -> None:
    hold(agent, "Pot")
    assert agent.put(first_of(agent.world, "Floor"), force=True).success
    away = 0
    for yaw in (0.0, 90.0, 180.0, 270.0):
        where = agent.position
        agent.place(where, yaw)
        away += agent.move(0.25).success
        agent.place(where, yaw)
    assert away >= 2


def test_what_does_not_fit_changes_nothing(agent: Agent) -> None:
    pot, cup = hold(agent, "Pot"), first_of(agent.world, "Cup")
    before = agent.world.save()
    assert agent.put(cup, force=True).error == f"no free place for {pot} in {cup}"
    assert agent.world.is_as(before)


def test_a_pot_that_is_too_large_for_a_basin_lies_across_its_rim(agent: Agent) -> None:
    world, basin = agent.world, first_of(agent.world, "SinkBasin")
    pot, boxes = hold(agent, "Pot"), {name: world.box(name) for name in world.ids}
    assert supports(world, boxes, by_agents=True) == supports(world, boxes)  # nothing that a room comes with
    put = agent.put(basin, force=True)
    assert put.success, put.error
    assert support_of(world, pot, by_agents=True) == basin
    assert support_of(world, pot) is None  # for datasets
    assert not sunk_into(world, pot)
    (low, high), rim = world.box(pot), world.box(basin)
    assert rim[1, 2] - 0.01 < low[2] < rim[1, 2] + 0.05
    assert (rim[0, :2] < (low + high)[:2] / 2).all()
    assert ((low + high)[:2] / 2 < rim[1, :2]).all()


@pytest.mark.parametrize("type_name", ["Bottle", "SaltShaker", "Plate"])
def test_what_is_too_tall_or_broad_for_a_drawer_lies_in_it_another_way(agent: Agent, type_name: str) -> None:
    world, thing = agent.world, hold(agent, type_name)
    world.open(NARROW)
    put = agent.put(NARROW, force=True)
    assert put.success, put.error
    assert support_of(world, thing) == NARROW
    assert not sunk_into(world, thing)
    (low, high), drawer = world.box(thing)[:, :2], world.box(NARROW)[:, :2]
    assert (low > drawer[0] - 0.01).all()
    assert (high < drawer[1] + 0.01).all()


def test_what_fits_only_just_between_others_is_fitted_in(agent: Agent) -> None:
    world, spatula = agent.world, hold(agent, "Spatula")
    flat = np.ptp(world.box(spatula), axis=0)[2]
    world.open(NARROW)
    assert agent.put(NARROW, force=True).success
    assert np.ptp(world.box(spatula), axis=0)[2] < 2 * flat
    assert not sunk_into(world, spatula)


def test_points_that_are_near_to_each_other_have_the_middle_among_them_and_reach_beyond_open_edges(
    agent: Agent,
) -> None:
    world = agent.world
    world.open(NARROW)
    drawer, counter = ((name, open_spaces(world, name)[0]) for name in (NARROW, first_of(agent.world, "CounterTop")))
    for (name, space), half in ((drawer, 0.02), (counter, 0.02), (counter, 2.0)):
        link, half_size = world.link_poses(name)[space.link], (half, half)
        coarse, fine = (np.array(list(lattice(link, space, half_size, is_fine))) for is_fine in (False, True))
        assert len(fine) > len(coarse)
        middle = (fine.min(axis=0) + fine.max(axis=0)) / 2
        assert np.abs(fine - middle).max(axis=1).min() < 1e-5


def test_a_drawer_takes_things_in_as_soon_as_an_agent_would_leave_it_open(agent: Agent) -> None:
    agent.world.open(NARROW, LEAST_OPEN)
    assert open_spaces(agent.world, NARROW)


def top_area(agent: Agent, name: str) -> float:
    width, depth, _ = np.ptp(agent.world.box(name), axis=0)
    return float(width * depth)


HUNG = {"HandTowel": "HandTowelHolder", "ToiletPaper": "ToiletPaperHanger", "Towel": "TowelHolder"}


@pytest.mark.parametrize("thing", HUNG)
def test_what_hung_on_a_holder_hangs_there_again(bathroom: tuple[Agent, Snapshot], thing: str) -> None:
    agent = amid(bathroom)
    world = agent.world
    holder = next(name for name in world.ids if world.type_of(name) == HUNG[thing] and on(world, name))
    (hung,) = on(world, holder)
    place, box = world.state(hung).position, world.box(hung)
    assert world.type_of(hung) == thing
    assert agent.pick_up(hung, force=True).success
    assert agent.drop().success
    assert np.abs(world.box(hung) - box).max() > 0.1
    assert agent.pick_up(hung, force=True).success
    assert agent.put(holder, force=True).success
    world.settle()
    assert on(world, holder) == [hung]
    assert world.state(hung).position == pytest.approx(place, abs=0.02)
    assert np.allclose(world.box(hung), box, atol=0.02)
    assert agent.pick_up(hung, force=True).success


def test_a_holder_takes_nothing_else_and_no_second_one(bathroom: tuple[Agent, Snapshot]) -> None:
    agent = amid(bathroom)
    world = agent.world
    holder = next(name for name in world.ids if world.type_of(name) == "TowelHolder" and on(world, name))
    soap = hold(agent, "SoapBar")
    assert agent.put(holder, force=True).error == f"no free place for {soap} in {holder}"
    assert agent.drop().success
    free = next(name for name in world.ids if world.type_of(name) == "TowelHolder" and not on(world, name))
    (towel,) = on(world, holder)
    agent.pick_up(towel, force=True)
    assert agent.put(free, force=True).success
    other = hold(agent, "HandTowel")
    assert agent.put(free, force=True).error == f"no free place for {other} in {free}"


def test_what_cannot_open_far_takes_things_in_when_it_is_open() -> None:
    with World(load_scene("FloorPlan17")) as world:
        narrow = next(
            name for name in world.ids if world.assets[name].is_openable and 0.0 < world.most_open(name) < 0.3
        )
        assert not open_spaces(world, narrow)
        world.open(narrow, world.most_open(narrow) / 2)
        assert not open_spaces(world, narrow)
        world.open(narrow)
        assert open_spaces(world, narrow)


def test_an_oval_table_holds_what_lies_near_its_edge() -> None:
    with World(load_scene("FloorPlan220")) as world:
        world.settle()
        boxes = {name: world.box(name) for name in world.ids}
        keys, table = first_of(world, "KeyChain"), first_of(world, "CoffeeTable")
        assert keys not in supports(world, boxes)  # in the dataset, whose version is final
        assert supports(world, boxes, by_agents=True)[keys].id == table
