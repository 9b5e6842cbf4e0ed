"""A walk through a real room as rows: complete, consistent with each other, and the same every time."""

import json

import numpy as np
import pytest

from remqa_data.errors import ArrangementError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.questions.expressions import Expressions
from remqa_data.generators.walks.scene_walk import ConfigurationInfo, SceneWalk, walk_through
from remqa_data.generators.walks.walk import WalkSettings
from remqa_data.language.referring import resolve
from remqa_data.scene import Scene
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from remqa_data.tables.images import decode_instances, decode_rgb
from remqa_data.tables.rows import ExpressionRow, FrameRow, SceneRow
from remqa_data.tables.schema import to_table

SETTINGS = WalkSettings(frames=6)


def make_walk(settings: WalkSettings = SETTINGS) -> SceneWalk:
    with World(load_scene("FloorPlan401")) as world:
        world.settle()
        view, grid = WorldView(world), reachable_grid(world)
        expressions = Expressions(SceneGraph.from_objects(object_metadata(world).values()))
        found = {object_id: expressions.of(object_id) for object_id in world.ids}
        place = ConfigurationInfo("FloorPlan401", "bathroom", 0, "train", 0)
        return walk_through(place, view, grid, grid.cells[0], found, settings, np.random.default_rng(5))


@pytest.fixture(scope="module")
def walked() -> SceneWalk:
    return make_walk()


def test_rows_fit_the_tables(walked: SceneWalk) -> None:
    assert to_table(SceneRow, [walked.scene]).num_rows == 1
    assert to_table(FrameRow, walked.frames).num_rows == len(walked.frames) >= 5
    assert to_table(ExpressionRow, walked.expressions).num_rows == len(walked.expressions) >= 5


def test_what_frames_add_is_the_graph_of_the_scene_row(walked: SceneWalk) -> None:
    nodes = [node for frame in walked.frames for node in frame.added_nodes]
    edges = sorted(edge for frame in walked.frames for edge in frame.added_edges)
    assert tuple(nodes) == walked.scene.graph_nodes
    assert tuple(edges) == walked.scene.graph_edges
    assert len(edges) > 10


def test_expressions_are_boxed_in_a_frame_that_shows_their_target(walked: SceneWalk) -> None:
    graph = SceneGraph.from_objects(walked.scene.objects)
    frames = {frame.frame_id: frame for frame in walked.frames}
    assert walked.expressions
    for said in walked.expressions:
        frame = frames[said.frame_id]
        index = [seen.id for seen in frame.objects].index(said.target_id)
        rows, columns = np.nonzero(decode_instances(frame.instances.bytes) == index + 1)
        assert said.box_2d == (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        assert resolve(said.text, graph) == [said.target_id]
        assert json.loads(said.program)
        assert said.anchor_id is None or said.anchor_id in [seen.id for seen in frame.objects]


def test_the_stored_room_draws_the_stored_frame(walked: SceneWalk) -> None:
    frame = walked.frames[0]
    with World(Scene.from_json(walked.scene.scene_json)) as world:
        grid = reachable_grid(world)
        assert [tuple(cell) for cell in walked.scene.navigation_cells] == list(grid.cells)
        from remqa_data.sim.render.camera import Camera

        x, y, z = frame.agent.position
        camera = Camera(
            (x, y, z + walked.scene.embodiment.camera_height_m), frame.agent.yaw_deg, frame.agent.horizon_deg
        )
        drawn = WorldView(world).render(camera)
    listed = [seen.id for seen in frame.objects]
    number = {world.ids.index(object_id): i + 1 for i, object_id in enumerate(listed)}
    expected = np.vectorize(lambda index: number.get(index, 0))(drawn.objects)
    assert np.array_equal(decode_instances(frame.instances.bytes), expected)
    assert np.abs(decode_rgb(frame.rgb.bytes).astype(int) - drawn.rgb).mean() < 4  # JPEG


@pytest.mark.slow
def test_the_same_seed_gives_the_same_rows(walked: SceneWalk) -> None:
    again = make_walk()
    assert again.scene == walked.scene
    assert again.frames == walked.frames
    assert again.expressions == walked.expressions


def test_a_walk_without_frames_says_what_its_poses_did_not_show() -> None:
    with pytest.raises(
        ArrangementError, match=r"^FloorPlan401: no pose .* shows 99 objects; give more cells_per_frame, "
    ):
        make_walk(WalkSettings(frames=1, cells_per_frame=1.0, min_objects=99))
