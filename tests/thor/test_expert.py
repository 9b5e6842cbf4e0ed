"""What somebody who knows the room would do next: followed to the end, as clients do."""

import math

import pytest

from remqa_data.thor import Controller
from tests.thor.test_objects import FRIDGE, ISLAND

pytestmark = pytest.mark.slow


def follow(controller, most: int = 150, agent: int = 0, **goal) -> list[str]:
    """The actions that the expert names, each done."""
    done: list[str] = []
    while len(done) < most:
        event = controller.step("ObjectNavExpertAction", agentId=agent, renderImage=False, **goal)
        assert event, event.metadata["errorMessage"]
        action = event.metadata["actionReturn"]
        if action is None:
            return done
        event = controller.step(action, agentId=agent, renderImage=False)
        assert event, event.metadata["errorMessage"]
        done.append(action)
    raise AssertionError(f"no end after {most} actions")


def away(event, place) -> float:
    at = event.metadata["agent"]["position"]
    return math.hypot(at["x"] - place["x"], at["z"] - place["z"])


def test_every_reachable_position_is_reached_exactly_and_by_a_shortest_way(kitchen) -> None:
    positions = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    assert len(positions) > 100
    for place in positions[::17]:
        kitchen.reset()
        start = kitchen.last_event.metadata["agent"]["position"]
        done = follow(kitchen, position=place)
        assert away(kitchen.last_event, place) < 1e-6
        assert done.count("MoveAhead") >= round((abs(start["x"] - place["x"]) + abs(start["z"] - place["z"])) / 0.25)
        assert follow(kitchen, position=place) == []


def test_an_object_is_seen_in_the_end(kitchen) -> None:
    for object_id in (FRIDGE, ISLAND, "Toaster|-01.84|+00.90|+00.13", "GarbageCan|-01.94|00.00|+02.03"):
        kitchen.reset()
        assert follow(kitchen, objectId=object_id)
        assert kitchen.last_event.get_object(object_id)["visible"]
    kitchen.reset()
    follow(kitchen, objectType="Fridge")
    assert kitchen.last_event.get_object(FRIDGE)["visible"]


def test_it_gets_there_with_steps_that_fit_no_grid(kitchen) -> None:
    positions = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    assert len(positions) > 100
    kitchen.reset(gridSize=0.5, rotateStepDegrees=20)
    for place in positions[::37]:
        follow(kitchen, position=place)
        assert away(kitchen.last_event, place) <= 0.25 + 1e-6


def test_agents_go_round_each_other_where_there_is_room() -> None:
    with Controller(scene="FloorPlan1", agentCount=2, width=64, height=64) as controller:
        places = controller.step("GetReachablePositions").metadata["actionReturn"]
        assert follow(controller, position=places[0]) == []  # it stands in a niche, and the other one before it
        for agent, index in ((1, -1), (0, len(places) // 2), (1, len(places) // 3), (0, 0)):
            assert follow(controller, agent=agent, position=places[index])
            assert away(controller.last_event.events[agent], places[index]) < 1e-6


def test_what_is_no_goal_is_said(kitchen) -> None:
    with pytest.raises(ValueError, match="missing the following arguments: objectId"):
        kitchen.step("ObjectNavExpertAction")
    assert "give an objectId" in kitchen.step("ObjectNavExpertAction", objectType="Cabinet").metadata["errorMessage"]
    assert (
        "is not the objectId on any object"
        in kitchen.step("ObjectNavExpertAction", objectId="Fridge|9").metadata["errorMessage"]
    )
