"""The agent against the navigation grid, the simulator's own collision test, and a room in which it acts."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from remqa_data.errors import ActionError, UnknownNameError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import ACTIONS, WALKING, parse_action, perform
from remqa_data.sim.agent.agent import Agent, Hands
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import clearance_map, object_outlines, outline_distance, reachable_grid
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.sim.physics.world import Snapshot, World
from remqa_data.sim.render.view import WorldView
from tests.helpers.bare_rooms import first_of

AHEAD = {0: (1, 0), 90: (0, 1), 180: (-1, 0), 270: (0, -1)}


@pytest.fixture(scope="module")
def kitchen() -> Scene:
    return at_rest("FloorPlan1")


def at_rest(name: str) -> Scene:
    with World(load_scene(name)) as world:
        world.settle()
        return world.to_scene()


def agent_in(scene: Scene, hands: Hands = "near") -> Agent:
    world = World(scene)
    agent = Agent(world, WorldView(world), (0.0, 0.0), 0.0, hands=hands)
    agent.place(agent.grid.position(agent.grid.cells[0]), 0.0)
    return agent


@pytest.fixture(scope="module")
def loaded(kitchen: Scene) -> Iterator[tuple[Agent, Snapshot]]:
    made = agent_in(kitchen)
    yield made, made.world.save()
    made.world.close()


@pytest.fixture
def agent(loaded: tuple[Agent, Snapshot]) -> Agent:
    """An agent in the kitchen as it was at first."""
    made, first = loaded
    made.world.restore(first)
    made.place(made.grid.position(made.grid.cells[0]), 0.0)
    return made


def go_near(agent: Agent, object_id: str, distance_m: float = 0.9) -> None:
    """Stand on a cell about so far from an object, and face it as well as four headings and the horizons allow."""
    x, y, z = agent.world.state(object_id).position
    cell = min(agent.grid.cells, key=lambda c: abs(math.dist(agent.grid.position(c), (x, y)) - distance_m))
    px, py = agent.grid.position(cell)
    yaw = round(math.degrees(math.atan2(y - py, x - px)) / 90) * 90 % 360
    down = math.degrees(math.atan2(agent.camera().position[2] - z, math.dist((px, py), (x, y))))
    agent.place((px, py), yaw, min(max(round(down / 30) * 30, -30), 60))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["FloorPlan1", "FloorPlan406"])
def test_a_step_ahead_succeeds_where_the_grid_has_an_edge_and_nowhere_else(name: str) -> None:
    agent = agent_in(at_rest(name))
    grid = reachable_grid(agent.world)
    assert len(grid.cells) > 20
    for cell, (yaw, (dx, dy)) in product(grid.cells, AHEAD.items()):
        agent.place(grid.position(cell), yaw)
        there = (cell[0] + dx, cell[1] + dy)
        result = agent.move(0.25)
        assert result.success == grid.graph.has_edge(cell, there)
        assert (agent.x, agent.y) == grid.position(there if result.success else cell)
        assert result.success or result.error.endswith("is blocking Agent from moving")
    agent.world.close()


@pytest.mark.slow
@settings(max_examples=30)
@example(steps=[(0.0, 0.0, -1e-300)])
@given(steps=st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-180, 180)), max_size=12))
def test_no_walk_ends_nearer_to_anything_than_the_radius(steps: list[tuple[float, ...]]) -> None:
    agent = walker()
    clearance = clearance_map(agent.world)
    agent.place(agent.grid.position(agent.grid.cells[len(agent.grid.cells) // 2]), 0.0)
    assert clearance.at(agent.x, agent.y) > AGENT.radius_m
    for ahead, right, turn in steps:
        agent.rotate(turn)
        agent.move(ahead, right)
        assert clearance.at(agent.x, agent.y) > AGENT.radius_m
        assert 0.0 <= agent.yaw_deg < 360.0


@cache
def walker() -> Agent:
    return agent_in(load_scene("FloorPlan406"))


def test_what_blocks_a_step_is_named(agent: Agent) -> None:
    fridge = first_of(agent.world, "Fridge")
    go_near(agent, fridge, 0.0)
    errors = [agent.move(0.05).error for _ in range(30)]
    assert f"{fridge} is blocking Agent from moving" in errors


def test_the_camera_is_that_of_the_pose_on_the_grid(agent: Agent) -> None:
    cell = agent.grid.cells[5]
    agent.place(agent.grid.position(cell), 270.0, 30.0)
    assert agent.camera() == AgentPose(cell, 270, 30).camera(agent.grid)
    assert agent.crouch().success
    assert agent.camera() == AgentPose(cell, 270, 30, False).camera(agent.grid)
    assert not agent.crouch().success
    assert agent.stand().success


def test_the_camera_tilts_from_30_up_to_60_down(agent: Agent) -> None:
    assert [agent.look(30).success for _ in range(3)] == [True, True, False]
    assert agent.horizon_deg == 60
    assert [agent.look(-30).success for _ in range(4)] == [True, True, True, False]
    assert agent.horizon_deg == -30


def test_nobody_teleports_into_furniture(agent: Agent) -> None:
    before = (agent.x, agent.y, agent.yaw_deg)
    x, y, _ = agent.world.state(first_of(agent.world, "Fridge")).position
    assert "is blocking" in agent.teleport(x, y, 90.0).error
    assert (agent.x, agent.y, agent.yaw_deg) == before
    cell = agent.grid.cells[3]
    assert agent.teleport(*agent.grid.position(cell), 90.0, 30.0).success
    assert (agent.x, agent.y) == agent.grid.position(cell)
    assert (agent.yaw_deg, agent.horizon_deg) == (90.0, 30.0)


def test_the_object_at_an_image_point_is_the_one_that_the_picture_shows_there(agent: Agent) -> None:
    image = agent.view.instances(agent.camera())
    for row, column in ((10, 20), (150, 150), (299, 0)):
        index = image[row, column]
        expected = agent.world.ids[index] if index >= 0 else None
        assert agent.object_at((column + 0.5) / 300, (row + 0.5) / 300) == expected
    with pytest.raises(ActionError, match="not between"):
        agent.object_at(1.2, 0.5)


def test_a_door_opens_until_it_meets_the_agent_and_not_at_all_if_that_is_at_once(agent: Agent) -> None:
    fridge = first_of(agent.world, "Fridge")
    _, y, _ = agent.world.state(fridge).position  # it looks along +x, and its doors are half a metre wide
    face = agent.world.box(fridge)[1, 0]
    agent.place((face + 0.21, y), 180.0, 0.0)
    assert agent.open(fridge).error == f"Agent is blocking {fridge} from moving"
    assert agent.world.state(fridge).openness == 0.0
    reached = []
    for before_m in (0.35, 0.4, 1.0):
        agent.place((face + before_m, y), 180.0, 0.0)
        assert agent.open(fridge).success
        reached.append(agent.world.state(fridge).openness)
        distances = [outline_distance(object_outlines(agent.world, fridge, 1), (agent.x, agent.y))]
        assert min(distances) > agent.embodiment.radius_m
        assert agent.close(fridge).success
        assert agent.world.state(fridge).openness == 0.0
    assert 0.15 < reached[0] <= reached[1] < reached[2] == 1.0
    agent.open(fridge)
    assert agent.open(fridge).error == f"{fridge} is already open"


def test_an_open_door_is_in_the_way(agent: Agent) -> None:
    before = agent.grid
    agent.open(first_of(agent.world, "Fridge"), force=True)
    assert len(agent.grid.cells) < len(before.cells)
    agent.close(first_of(agent.world, "Fridge"), force=True)
    assert agent.grid.cells == before.cells


@pytest.mark.slow
def test_a_bowl_is_picked_up_put_on_the_table_and_dropped(agent: Agent) -> None:
    bowl, counter = first_of(agent.world, "Bowl"), first_of(agent.world, "CounterTop")
    assert agent.drop().error == "nothing is held"
    go_near(agent, bowl)
    assert agent.pick_up(bowl).success
    assert agent.held == bowl
    assert bowl not in agent.visible_objects()
    assert "already holding" in agent.pick_up(first_of(agent.world, "Apple")).error
    placed = agent.put(counter, force=True)
    assert placed.success, placed.error
    assert agent.held is None
    top = agent.world.box(counter)[1, 2]
    assert abs(agent.world.box(bowl)[0, 2] - top) < 0.05
    agent.pick_up(bowl, force=True)
    agent.place(agent.grid.position(agent.grid.cells[len(agent.grid.cells) // 2]), 0.0)
    dropped = agent.drop()
    assert dropped.success, dropped.error
    assert math.dist(agent.world.state(bowl).position[:2], (agent.x, agent.y)) < 1.5


def test_a_stool_slides_until_something_stops_it(agent: Agent) -> None:
    stool = first_of(agent.world, "Stool")
    go_near(agent, stool, 0.7)
    start = np.array(agent.world.state(stool).position)
    result = agent.pull(stool, 0.2)
    assert result.success, result.error
    moved = np.array(agent.world.state(stool).position) - start
    towards = np.array([agent.x, agent.y]) - start[:2]
    assert math.hypot(*moved[:2]) == pytest.approx(result.value, abs=0.02)
    assert moved[:2] @ towards > 0
    assert abs(moved[2]) < 0.02


@pytest.mark.parametrize(
    ("action", "error"),
    [
        ("OpenObject Bowl", "is not openable"),
        ("PickupObject Fridge", "is not pickupable"),
        ("PutObject Fridge", "nothing is held"),
        ("PushObject Fridge", "is not moveable"),
        ("MoveArm 0.0 0.0 9.0", "not within reach"),
    ],
)
def test_what_the_room_refuses_has_a_reason_and_changes_nothing(agent: Agent, action: str, error: str) -> None:
    word, _, rest = action.partition(" ")
    if rest in ("Bowl", "Fridge"):
        rest = first_of(agent.world, rest)
    before = agent.world.save()
    result = perform(agent, parse_action(f"{word} {rest}"))
    assert not result.success
    assert error in result.error
    assert agent.world.save() == before


@pytest.mark.parametrize("hands", ["near", "reach", "arm"])
def test_what_is_far_away_cannot_be_acted_on(kitchen: Scene, hands: Hands) -> None:
    agent = agent_in(kitchen, hands)
    fridge = first_of(agent.world, "Fridge")
    x, y, _ = agent.world.state(fridge).position
    agent.place(max(agent.grid.positions().tolist(), key=lambda p: math.dist(p, (x, y))), 0.0)
    agent.rotate(math.degrees(math.atan2(y - agent.y, x - agent.x)))
    assert "not within reach" in agent.open(fridge).error
    agent.world.close()


def test_an_arm_stays_folded_when_the_agent_itself_is_in_the_way_of_a_door(kitchen: Scene) -> None:
    agent = agent_in(kitchen, "arm")
    fridge = first_of(agent.world, "Fridge")
    agent.place((agent.world.box(fridge)[1, 0] + 0.21, agent.world.state(fridge).position[1]), 180.0)
    folded = agent.arm.state
    assert agent.open(fridge).error == f"Agent is blocking {fridge} from moving"
    assert agent.arm.state == folded
    agent.world.close()


def test_misuse_is_an_exception(agent: Agent) -> None:
    with pytest.raises(UnknownNameError, match="did you mean"):
        agent.open(first_of(agent.world, "Fridge")[:-1])
    with pytest.raises(ActionError, match="between 0 and 1"):
        agent.open(first_of(agent.world, "Fridge"), 2.0)
    with pytest.raises(ActionError, match="a push goes"):
        agent.push(first_of(agent.world, "Stool"), 5.0)


@pytest.mark.slow
def test_500_random_actions_lose_nothing_and_replay_bit_for_bit() -> None:
    scene = at_rest("FloorPlan415")
    rng = np.random.default_rng(0)
    first, done = agent_in(scene), list[str]()
    x0, y0, x1, y1 = scene.bounds
    while len(done) < 500:
        done += _random_actions(first, rng)
        for object_id in first.world.ids:
            state = first.world.state(object_id)
            assert np.isfinite([*state.position, *state.quaternion]).all()
            if not state.is_fixed:
                x, y, z = state.position
                assert x0 <= x <= x1
                assert y0 <= y <= y1
                assert z >= scene.floor_z
    second = agent_in(scene)
    for action in done:
        perform(second, parse_action(action))
    assert _digest(first) == _digest(second)


def _random_actions(agent: Agent, rng: np.random.Generator) -> list[str]:
    """Something done to some object from near it, or a walk."""
    if rng.random() < 0.5:
        actions = [str(rng.choice(WALKING))]
    else:
        object_id = str(rng.choice(agent.world.ids))
        before = (agent.x, agent.y), agent.yaw_deg, agent.horizon_deg, agent.is_standing
        go_near(agent, object_id)
        names = [name for name, spec in ACTIONS.items() if spec.has_target and name != "MoveObject"]
        pose = f"{agent.x} {agent.y} {agent.yaw_deg} {agent.horizon_deg}"
        agent.place(*before)
        actions = [f"Teleport {pose}", f"{rng.choice(names)} {object_id}", "DropHandObject"]
    for action in actions:
        perform(agent, parse_action(action))
    return actions


def _digest(agent: Agent) -> str:
    seen = agent.view.render(agent.camera())
    images = b"".join(image.tobytes() for image in (seen.rgb, seen.depth, seen.objects, seen.links))
    return hashlib.sha256(images + repr(agent.world.save()).encode()).hexdigest()


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_refused_and_the_agent_stays(agent: Agent, number: float) -> None:
    before = agent.position, agent.yaw_deg, agent.horizon_deg
    for act in (
        lambda: agent.move(number),
        lambda: agent.move(0.0, number),
        lambda: agent.rotate(number),
        lambda: agent.teleport(number, 0.0),
        lambda: agent.teleport(yaw_deg=number),
        lambda: agent.teleport(agent.x + 0.25, agent.y, number, force=True),
        lambda: agent.teleport(horizon_deg=number, force=True),
    ):
        with pytest.raises(ActionError, match="finite"):
            act()
    assert not agent.look(number).success
    assert (agent.position, agent.yaw_deg, agent.horizon_deg) == before


def test_an_action_without_an_amount_goes_as_far_as_the_agents_own_body_does(agent: Agent) -> None:
    body = replace(AGENT, step_m=0.5, rotate_deg=45.0, look_deg=10.0)
    other = Agent(agent.world, agent.view, (0.0, 0.0), 0.0, embodiment=body)
    has_edge = agent.grid.graph.has_edge
    start, end = next(
        ((i, j), (i + 2, j))
        for i, j in agent.grid.cells
        if has_edge((i, j), (i + 1, j)) and has_edge((i + 1, j), (i + 2, j))
    )
    other.place(agent.grid.position(start), 0.0)
    for text in ("MoveAhead", "RotateLeft", "LookDown"):
        assert perform(other, parse_action(text)).success
    assert (other.x, other.y) == agent.grid.position(end)
    assert (other.yaw_deg, other.horizon_deg) == (45.0, 10.0)
    assert str(parse_action("MoveAhead 0.5").in_short(body)) == "MoveAhead"
    assert str(parse_action("MoveAhead 0.25").in_short(body)) == "MoveAhead 0.25"
