import numpy as np
import pytest

from remqa_data.errors import ActionError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import CLOSE, Action, move_action, open_action, parse_action, pick_up_action
from remqa_data.sim.agent.replay import Replay
from remqa_data.sim.navigation.grid import cells_in_reach
from remqa_data.sim.navigation.paths import shortest_actions
from remqa_data.sim.navigation.viewpoints import AgentPose, facing_poses, front_points
from remqa_data.sim.physics.world import World
from tests.helpers.poses import pose_that_sees_and_reaches


@pytest.fixture(scope="module")
def kitchen() -> Scene:
    with World(load_scene("FloorPlan1")) as world:
        world.settle()
        return world.to_scene()


def first_of(scene: Scene, type_: str) -> str:
    return next(o.id for o in scene.objects if o.type == type_)


@pytest.mark.slow
def test_the_oracles_way_to_the_fridge_ends_in_the_same_picture_every_time(kitchen: Scene) -> None:
    fridge = first_of(kitchen, "Fridge")
    replay = Replay(kitchen, AgentPose((0, 4), 0, 0))
    grid = replay.grid
    near = cells_in_reach(grid, front_points(replay.view, fridge))
    for goal in facing_poses(
        grid, near, np.array(replay.world.state(fridge).position)
    ):  # the nearest are before the door
        replay.pose = goal
        if replay.attempt(open_action(fridge)).success:
            if replay.world.state(fridge).openness == 1.0:
                break
            replay.step(Action(CLOSE, fridge))
    replay.close()
    start = AgentPose(grid.cells[-1], 0, 0)
    actions = [*map(Action, shortest_actions(grid, start, goal)), open_action(fridge), Action("Done")]
    pictures = []
    for scene in (kitchen, Scene.from_json(kitchen.to_json())):
        replay = Replay(scene, start)
        for action in actions:
            replay.step(action)
        assert replay.pose == goal
        assert replay.world.state(fridge).openness == 1.0
        pictures.append(replay.observe())
        replay.close()
    assert np.array_equal(pictures[0].rgb, pictures[1].rgb)
    assert np.array_equal(pictures[0].depth, pictures[1].depth)
    assert np.array_equal(pictures[0].objects, pictures[1].objects)


def test_what_is_picked_up_is_gone_from_the_picture_and_what_is_moved_is_elsewhere(kitchen: Scene) -> None:
    bowl, stool = first_of(kitchen, "Bowl"), first_of(kitchen, "Stool")
    replay = Replay(kitchen, AgentPose((0, 4), 0, 0))
    before = np.array(replay.world.state(stool).position)
    aside = (float(before[0]) + 0.125, float(before[1]) - 0.125, float(before[2]))
    for object_id, action in ((bowl, pick_up_action(bowl)), (stool, move_action(stool, aside))):
        start = pose_that_sees_and_reaches(
            replay.view, replay.grid, object_id, np.array([replay.world.state(object_id).position])
        )
        assert start is not None
        replay.pose = start
        replay.step(action)
    assert replay.world.held == {bowl: 0}
    assert replay.world.state(stool).position == aside
    index = replay.world.ids.index(bowl)
    for yaw in (0, 90, 180, 270):
        replay.pose = AgentPose(start.cell, yaw, 30)
        assert not (replay.observe().objects == index).any()
    replay.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("action", "message"),
    [
        ("OpenObject", "takes an object id"),
        ("MoveObject Stool|1 0.2", "takes .* x, y, z"),
        ("MoveObject Stool|1 0.2 x 1", "takes .* x, y, z"),
        ("OpenObject Bowl|+00.27|+01.10|-00.75", "not openable"),
        ("Jump", "Jump"),
        ("Teleport 1 1 90", "without Teleport"),
        ("PutObject Bowl|+00.27|+01.10|-00.75", "nothing is held"),
    ],
)
def test_what_cannot_be_done_is_refused(kitchen: Scene, action: str, message: str) -> None:
    replay = Replay(kitchen, AgentPose((0, 4), 0, 0))
    with pytest.raises(ActionError, match=message):
        replay.step(parse_action(action))
    replay.close()
