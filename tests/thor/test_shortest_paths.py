"""Shortest ways are shortest, against all ways there are, and the expert knows when there is none."""

import math
import random
from itertools import combinations, pairwise

import networkx as nx
import pytest

from remqa_data.sim.navigation import ground
from remqa_data.sim.navigation.ground import Ground
from remqa_data.sim.navigation.straight_ways import StraightWays
from remqa_data.thor import Controller
from tests.thor.test_expert import away, follow

pytestmark = pytest.mark.slow

Place = tuple[float, float]
STOOL = "Stool|+00.74|+00.00|+00.56"


def agent_of(controller):
    return controller.server.session._simulator.agent


def corners_between(controller, start: Place, goal: Place) -> list[Place]:
    """The corners of GetShortestPathToPoint, x and z."""
    vectors = [{"x": x, "y": 0.0, "z": z} for x, z in (start, goal)]
    event = controller.step("GetShortestPathToPoint", position=vectors[0], target=vectors[1], renderImage=False)
    assert event, event.metadata["errorMessage"]
    return [(corner["x"], corner["z"]) for corner in event.metadata["actionReturn"]["corners"]]


def length(corners: list[Place]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(corners))


def all_straight_ways(agent, places: list[Place]) -> nx.Graph:
    """Those that the agent's ground calls clear, asked one by one."""
    graph = nx.Graph()
    graph.add_nodes_from(places)
    for a, b in combinations(places, 2):
        if agent.ground.is_clear(a, b):
            graph.add_edge(a, b, metres=math.dist(a, b))
    return graph


def check_all_ways(controller, seed: int) -> None:
    """Some ways between cells, and between places beside them, are as long as the shortest of all, and clear."""
    agent, rng = agent_of(controller), random.Random(seed)
    cells = [agent.grid.position(cell) for cell in agent.grid.cells]
    beside = [(x + rng.uniform(-0.1, 0.1), y + rng.uniform(-0.1, 0.1)) for x, y in rng.sample(cells, 24)]
    free = [place for place in beside if agent.ground.blocker_at(*place) is None]
    assert len(free) > 8
    graph = all_straight_ways(agent, cells)
    bent = 0
    for start, goal in [*(rng.sample(cells, 2) for _ in range(30)), *pairwise(free)]:
        ways = graph.copy()
        ends = [place for place in (start, goal) if place not in graph]
        ways.add_edges_from(
            (a, b, {"metres": math.dist(a, b)})
            for a in ends
            for b in [*cells, start, goal]
            if agent.ground.is_clear(a, b)
        )
        shortest = nx.dijkstra_path_length(ways, start, goal, weight="metres")
        there, back = corners_between(controller, start, goal), corners_between(controller, goal, start)
        assert (there[0], there[-1], back[0], back[-1]) == (start, goal, goal, start)
        assert length(there) == pytest.approx(shortest, abs=1e-9)
        assert length(back) == pytest.approx(shortest, abs=1e-9)
        assert all(agent.ground.is_clear(a, b) for way in (there, back) for a, b in pairwise(way))
        bent += len(there) > 2
    assert bent > 10


def test_ways_are_the_shortest_there_are_and_the_same_both_ways(kitchen) -> None:
    check_all_ways(kitchen, seed=0)
    cells = len(agent_of(kitchen).grid.cells)
    assert kitchen.step("RemoveFromScene", objectId=STOOL)
    assert len(agent_of(kitchen).grid.cells) > cells
    check_all_ways(kitchen, seed=1)  # of the room as it is now


def test_straight_ways_are_those_of_the_ground(kitchen) -> None:
    agent = agent_of(kitchen)
    ways, places = agent.ground.straight_ways(), [agent.grid.position(cell) for cell in agent.grid.cells]
    assert ways.places.tolist() == [list(place) for place in places]
    for index in range(0, len(places), 5):
        metres = ways.metres(index).tolist()
        assert [math.isfinite(m) for m in metres] == [agent.ground.is_clear(places[index], place) for place in places]


def test_the_floor_is_drawn_once_until_something_moves(kitchen, monkeypatch) -> None:
    drawn = []
    monkeypatch.setattr(ground, "StraightWays", lambda *given: drawn.append(given) or StraightWays(*given))
    for _ in range(3):
        assert len(corners_between(kitchen, (1.5, 0.0), (-1.0, 1.0))) > 2
    assert len(drawn) <= 1
    before = len(drawn)
    assert kitchen.step("RemoveFromScene", objectId=STOOL)
    corners_between(kitchen, (1.5, 0.0), (-1.0, 1.0))
    assert len(drawn) == before + 1


def test_no_way_leads_to_where_nobody_can_stand(kitchen) -> None:
    for x, z in ((50.0, 50.0), (1e9, 0.0), (0.0, 0.0)):  # outside, far outside, in the island
        assert "no path" in kitchen.step("GetShortestPathToPoint", x=x, y=0, z=z).metadata["errorMessage"]
        vector = {"x": x, "y": 0, "z": z}
        assert not kitchen.step("GetShortestPathToPoint", position=vector, target={"x": 1.5, "y": 0, "z": 0})


def test_who_is_boxed_in_is_told_so(kitchen) -> None:
    goal = kitchen.last_event.metadata["agent"]["position"]
    assert kitchen.step("Teleport", position={"x": 0.0, "y": 0.9, "z": 0.0}, forceAction=True)  # into the island
    for where in ({"position": goal}, {"objectType": "GarbageCan"}):
        event = kitchen.step("ObjectNavExpertAction", **where)
        assert not event
        assert "no path from (0, 0) to" in event.metadata["errorMessage"]
        assert event.metadata["actionReturn"] is None


def test_who_stands_behind_another_agent_is_told_so() -> None:
    with Controller(scene="FloorPlan1", agentCount=2, width=64, height=64) as controller:
        places = controller.step("GetReachablePositions", agentId=0).metadata["actionReturn"]
        assert follow(controller, position=places[0]) == []
        event = controller.step("ObjectNavExpertAction", agentId=0, position=places[-1])
        assert "no path" in event.metadata["errorMessage"]
        assert follow(controller, agent=1, position=places[-1])  # and goes out of the way
        assert follow(controller, agent=0, position=places[len(places) // 2])


def test_fine_turns_lead_there_and_little_is_looked_at_twice(kitchen, monkeypatch) -> None:
    asked = []
    is_clear = Ground.is_clear
    monkeypatch.setattr(Ground, "is_clear", lambda ground, *way: asked.append(way) or is_clear(ground, *way))
    positions = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    assert len(positions) > 100
    kitchen.reset(rotateStepDegrees=20)
    goal = positions[-1]
    asked.clear()
    first = kitchen.step("ObjectNavExpertAction", position=goal).metadata["actionReturn"]
    assert 0 < len(asked) < 7000  # 11,781 when places were looked at again and again
    asked.clear()
    assert kitchen.step("ObjectNavExpertAction", position=goal).metadata["actionReturn"] == first
    assert asked == []
    done = follow(kitchen, position=goal)
    assert len(done) <= 27
    assert len(asked) < 12_000  # for all of them together
    assert away(kitchen.last_event, goal) <= 0.125 + 1e-6
