import math
from itertools import pairwise

import pytest
from ai2thor.util import metrics

from tests.helpers.thor_clients import stands_at

pytestmark = pytest.mark.slow

START = {
    "position": {"x": 1.5, "y": 0.9, "z": 0.0},
    "rotation": {"x": 0, "y": 0, "z": 0},
    "horizon": 0,
    "standing": True,
}


@pytest.fixture
def at_start(kitchen):
    """The middle of the way on one side of the kitchen's island, looking along +z."""
    assert kitchen.step("TeleportFull", **START)
    return kitchen


@pytest.mark.parametrize(
    ("action", "rotation", "to"),
    [
        ("MoveAhead", 0, (1.5, 0.25)),
        ("MoveBack", 0, (1.5, -0.25)),
        ("MoveRight", 0, (1.75, 0.0)),
        ("MoveLeft", 180, (1.75, 0.0)),
        ("MoveAhead", 90, (1.75, 0.0)),
        ("MoveLeft", 90, (1.5, 0.25)),
    ],
)
def test_moves(at_start, action, rotation, to) -> None:
    at_start.step("Teleport", rotation={"x": 0, "y": rotation, "z": 0})
    assert at_start.step(action)
    assert stands_at(at_start.last_event) == to


def test_moves_by_a_magnitude(at_start) -> None:
    assert at_start.step("MoveAhead", moveMagnitude=0.5)
    assert stands_at(at_start.last_event) == (1.5, 0.5)
    event = at_start.step("MoveAhead", moveMagnitude=5.0)
    assert not event
    assert "is blocking Agent" in event.metadata["errorMessage"]
    assert event.metadata["collided"]
    assert event.metadata["collidedObjects"]
    assert stands_at(at_start.last_event) == (1.5, 0.5)
    assert not at_start.step("MoveAhead", moveMagnitude=-0.25)


def test_grid_size(kitchen) -> None:
    kitchen.reset(gridSize=0.5)
    kitchen.step("TeleportFull", **START)
    kitchen.step("MoveAhead")
    assert stands_at(kitchen.last_event) == (1.5, 0.5)


def test_turns(at_start) -> None:
    rotations = [at_start.step(action).metadata["agent"]["rotation"]["y"] for action in ["RotateRight"] * 5]
    assert rotations == [90.0, 180.0, 270.0, 0.0, 90.0]
    assert at_start.step("RotateLeft", degrees=30).metadata["agent"]["rotation"]["y"] == pytest.approx(60.0)
    at_start.reset(rotateStepDegrees=45)
    before = at_start.last_event.metadata["agent"]["rotation"]["y"]
    after = at_start.step("RotateLeft").metadata["agent"]["rotation"]["y"]
    assert (before - after) % 360 == pytest.approx(45)


def test_looks_no_farther_than_the_neck_bends(at_start) -> None:
    assert [at_start.step("LookDown").metadata["agent"]["cameraHorizon"] for _ in range(3)] == [30.0, 60.0, 60.0]
    assert not at_start.last_event
    horizons = [at_start.step("LookUp").metadata["agent"]["cameraHorizon"] for _ in range(4)]
    assert horizons == [30.0, 0.0, -30.0, -30.0]


def test_crouches(at_start) -> None:
    standing = at_start.last_event.metadata
    crouching = at_start.step("Crouch").metadata
    assert crouching["agent"]["isStanding"] is False
    assert standing["cameraPosition"]["y"] - crouching["cameraPosition"]["y"] == pytest.approx(0.675)
    assert crouching["agent"]["position"] == standing["agent"]["position"]
    assert not at_start.step("Crouch")
    assert at_start.step("Stand").metadata["agent"]["isStanding"] is True


def test_teleports(at_start) -> None:
    agent = at_start.step("Teleport", x=1.25, y=0.95, z=0.25).metadata["agent"]
    assert agent["position"] == {"x": 1.25, "y": 0.900999, "z": 0.25}
    agent = at_start.step("Teleport", rotation=25.0, horizon=10).metadata["agent"]
    assert (agent["rotation"]["y"], agent["cameraHorizon"]) == (25.0, 10.0)
    assert agent["position"] == {"x": 1.25, "y": 0.900999, "z": 0.25}
    for wrong in (
        {"position": {"x": 1.25, "y": 1.1, "z": 0.25}},
        {"position": {"x": 0.0, "y": 0.9, "z": 0.0}},  # into the island
        {"position": {"x": 2000, "y": 0.9, "z": 9000}},
        {"horizon": 80},
    ):
        assert not at_start.step("Teleport", **wrong)
        assert at_start.last_event.metadata["agent"] == agent
    assert at_start.step("Teleport", position={"x": 0.0, "y": 0.9, "z": 0.0}, forceAction=True)


def test_reachable_positions_are_those_that_moves_lead_to(at_start) -> None:
    event = at_start.step("GetReachablePositions")
    positions = event.metadata["actionReturn"]
    with pytest.warns(UserWarning, match="deprecated"):
        assert event.metadata["reachablePositions"] == positions
    assert {"x": 1.5, "y": 0.900999, "z": 0.0} in positions
    assert len(positions) > 100
    for position in positions[::10]:
        assert at_start.step("Teleport", position=position)
    cells = {(position["x"], position["z"]) for position in positions}
    walked = 0
    for x, z in sorted(cells)[::12]:
        for rotation, (dx, dz) in ((0, (0, 0.25)), (90, (0.25, 0)), (180, (0, -0.25)), (270, (-0.25, 0))):
            assert at_start.step("Teleport", x=x, y=0.9, z=z, rotation={"x": 0, "y": rotation, "z": 0})
            if at_start.step("MoveAhead"):
                assert (x + dx, z + dz) in cells
                walked += 1
    assert walked > 25


def test_reachable_positions_with_other_steps(at_start) -> None:
    coarse = at_start.step("GetReachablePositions", gridSize=0.5).metadata["actionReturn"]
    fine = at_start.step("GetReachablePositions").metadata["actionReturn"]
    assert 0 < len(coarse) < len(fine)
    at_start.step("RotateRight", degrees=45)
    turned = at_start.step("GetReachablePositions", directionsRelativeAgent=True).metadata["actionReturn"]
    assert any(abs(position["x"] - (1.5 + 0.25 * math.sqrt(0.5))) < 1e-9 for position in turned)
    assert not at_start.step("GetReachablePositions", maxStepCount=5)


def test_interactable_poses_are_where_it_is_visible(kitchen) -> None:
    fridge = "Fridge|-02.10|+00.00|+01.07"
    poses = kitchen.step("GetInteractablePoses", objectId=fridge, horizons=[0, 30], standings=[True]).metadata[
        "actionReturn"
    ]
    assert len(poses) > 20
    for pose in poses[::8]:
        assert set(pose) == {"x", "y", "z", "rotation", "standing", "horizon"}
        event = kitchen.step("TeleportFull", **pose)
        assert event.get_object(fridge)["visible"]
        assert event.get_object(fridge)["isInteractable"]
        assert event.metadata["agent"]["rotation"]["y"] == pose["rotation"]
    assert (
        kitchen.step("GetInteractablePoses", objectId=fridge, rotations=[90], horizons=[0]).metadata["actionReturn"]
        == []
    )
    few = kitchen.step("GetInteractablePoses", objectId=fridge, maxPoses=5).metadata["actionReturn"]
    assert len(few) == 5


def test_what_is_shut_in_has_no_interactable_poses(kitchen) -> None:
    before = kitchen.last_event.metadata["agent"]
    event = kitchen.step("GetInteractablePoses", objectId="Egg|-02.04|+00.81|+01.24", standings=[True], horizons=[30])
    assert event.metadata["actionReturn"] == []
    assert event
    assert event.metadata["agent"] == before


def test_shortest_paths_can_be_walked(at_start) -> None:
    event = at_start.step("GetShortestPath", objectType="Fridge")
    corners = event.metadata["actionReturn"]["corners"]
    assert (corners[0]["x"], corners[0]["z"]) == (1.5, 0.0)
    length = sum(math.dist((a["x"], a["z"]), (b["x"], b["z"])) for a, b in pairwise(corners))
    assert math.dist((1.5, 0.0), (corners[-1]["x"], corners[-1]["z"])) < length < 8.0
    assert math.dist((-2.0, 1.07), (corners[-1]["x"], corners[-1]["z"])) < 1.5
    for a, b in pairwise(corners):
        rotation = math.degrees(math.atan2(b["x"] - a["x"], b["z"] - a["z"]))
        assert at_start.step("Teleport", x=a["x"], y=0.9, z=a["z"], rotation={"x": 0, "y": rotation, "z": 0})
        assert at_start.step("MoveAhead", moveMagnitude=math.dist((a["x"], a["z"]), (b["x"], b["z"])))


def test_ai2thors_own_functions_for_paths(at_start) -> None:
    start, fridge = {"x": 1.5, "y": 0.9, "z": 0.0}, "Fridge|-02.10|+00.00|+01.07"
    way = metrics.get_shortest_path_to_object(at_start, fridge, start, {"x": 0, "y": 0, "z": 0})
    assert way == metrics.get_shortest_path_to_object_type(at_start, "Fridge", start, allowed_error=0.05)
    assert way == metrics.get_shortest_path_to_point(at_start, start, way[-1])
    assert metrics.compute_single_spl(way, way, True) == 1.0
    with pytest.raises(ValueError, match="Unable to find shortest path"):
        metrics.get_shortest_path_to_point(at_start, start, {"x": 50, "y": 0, "z": 50})


def test_shortest_path_to_a_point(at_start) -> None:
    target = {"x": -1.0, "y": 0.9, "z": 1.0}
    way = at_start.step("GetShortestPathToPoint", position={"x": 1.5, "y": 0, "z": 0}, target=target).metadata[
        "actionReturn"
    ]
    corners = way["corners"]
    assert (corners[-1]["x"], corners[-1]["z"]) == (-1.0, 1.0)
    assert not at_start.step("GetShortestPathToPoint", x=50.0, y=0, z=50.0)
    assert not at_start.step("GetShortestPath", objectType="Cabinet")  # there are several


def test_looks_somewhere_whatever_it_looked_at_before(kitchen) -> None:
    kitchen.step("RotateRight", degrees=30)
    for _ in range(2):
        agent = kitchen.step("RotateLook", rotation=45, horizon=30).metadata["agent"]
        assert (agent["rotation"]["y"], agent["cameraHorizon"]) == (pytest.approx(45.0), 30.0)
    assert not kitchen.step("RotateLook", rotation=90, horizon=80)
    assert kitchen.last_event.metadata["agent"] == agent


def test_positions_are_found_breadth_first(kitchen) -> None:
    event = kitchen.step("Teleport", position={"x": 1.5, "y": 0.9, "z": 0.0}, rotation=90)
    found = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    assert found[0] == event.metadata["agent"]["position"]
    steps = [round(abs(p["x"] - 1.5) / 0.25) + round(abs(p["z"]) / 0.25) for p in found]
    assert len(steps) > 100
    assert steps[:5] == [0, 1, 1, 1, 1]
    assert (found[1]["x"], found[2]["z"]) == (1.75, 0.25)  # right, then ahead of who looks along z
    turned = kitchen.step("GetReachablePositions", directionsRelativeAgent=True).metadata["actionReturn"]
    assert turned[1]["z"] == pytest.approx(-0.25)  # the right of who looks along x
    assert {(round(p["x"], 6), round(p["z"], 6)) for p in turned} == {(p["x"], p["z"]) for p in found}
    few = len(found) * 0.25**2
    assert kitchen.step("GetReachablePositions", maxStepCount=int(few) + 1)
    assert not kitchen.step("GetReachablePositions", maxStepCount=int(few) - 1)


def test_nobody_goes_farther_from_an_object_than_is_said(kitchen) -> None:
    kitchen.step("Teleport", position={"x": 1.0, "y": 0.9, "z": 0.0}, rotation=90)
    near = {"objectId": "Stool|+00.74|+00.00|+00.56"}
    event = kitchen.step("MoveAhead", **near, maxAgentsDistance=1.0)
    assert (
        event.metadata["errorMessage"] == f"Agent movement would bring it beyond the max distance of {near['objectId']}"
    )
    assert kitchen.step("MoveAhead", **near)
    assert kitchen.step("MoveAhead", **near, maxAgentsDistance=3.0)
    assert (
        kitchen.step("MoveBack", objectId="Stool|1", maxAgentsDistance=3.0).metadata["errorMessage"]
        == "No object with ID Stool|1"
    )


def test_a_type_that_there_is_not_has_no_way_to_it(kitchen) -> None:
    assert "Nonsense" in kitchen.step("GetShortestPath", objectType="Nonsense").metadata["errorMessage"]
    assert "unknown object type" in kitchen.last_event.metadata["errorMessage"]
