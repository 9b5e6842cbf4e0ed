from pathlib import Path

import numpy as np
import pytest

from remqa_data.agents.knowledge.memory import FRAME_COLUMNS, SCENE_COLUMNS, WalkMemories, WalkMemory
from remqa_data.errors import DatasetError
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.storage.shards import read_rows
from remqa_data.tables.map_columns import plan_labels
from remqa_data.tables.rows import SceneRow, SemanticMap
from tests.helpers.room_records import thing
from tests.helpers.walked_rooms import memory_of

TRUTH = {"objects", "scene_json", "navigation_cells", "walk_start_cell"}
"""What the simulator alone knows of a room."""


def test_nothing_is_read_of_a_scene_but_the_map_and_the_body() -> None:
    assert set(SCENE_COLUMNS) == {"scene", "configuration", "semantic_map", "embodiment"}
    assert not TRUTH & set(SCENE_COLUMNS)
    assert set(FRAME_COLUMNS) == {"scene", "configuration", "index", "objects", "added_nodes", "added_edges"}


@pytest.mark.slow
def test_the_memory_is_the_stored_graph_and_map(one_room: Path) -> None:
    memories, rows = WalkMemories(one_room, "test"), list(read_rows(one_room, SceneRow, "test"))
    assert rows
    for row in rows:
        memory = memories.memory(row.scene, row.configuration)
        assert row.graph_nodes
        assert tuple(memory.graph.objects) == row.graph_nodes
        assert memory.graph.edges == row.graph_edges
        known = {record.id: record for record in row.objects}
        assert all(memory.graph.node(name) == known[name] for name in row.graph_nodes)
        stored = plan_labels(row.map_2d)
        seen = np.argwhere(stored >= 0) + np.array(row.semantic_map.corner)
        mine = np.argwhere(memory.plan.labels >= 0) + np.array(memory.plan.corner)
        assert len(seen) > 0
        assert seen.tolist() == mine.tolist()
        assert memory.plan.labels[memory.plan.labels >= 0].tolist() == stored[stored >= 0].tolist()


@pytest.mark.slow
def test_a_walk_that_there_is_not_is_an_error(one_room: Path) -> None:
    with pytest.raises(DatasetError, match="FloorPlan27, configuration 9: there is no walk"):
        WalkMemories(one_room, "test").memory("FloorPlan27", 9)


def test_a_walk_that_has_seen_nothing_is_an_error() -> None:
    nothing = SemanticMap((0.0, 0.0, 0.0), 0.05, (0, 0), ("structure",), np.empty((0, 4), dtype=np.int16))
    with pytest.raises(DatasetError, match="here: the walk has seen nothing"):
        WalkMemory.of_walk(SceneGraph(), nothing, AGENT, "here")


def test_flags_of_voxels_are_looked_up_at_points_of_the_room() -> None:
    memory = memory_of([thing("Mug|1", (0.5, 0.5, 0.5), (0.1, 0.1, 0.1))], (0.0, 0.0, 1.0, 1.0))
    is_mug = memory.labels == memory.plan.names.index("Mug")
    points = np.array([[0.5, 0.5, 0.55], [0.5, 0.5, 0.7], [-9.0, 0.5, 0.55], [0.5, 0.5, 99.0]])
    assert memory.at(is_mug, points).tolist() == [True, False, False, False]
    corner = memory.corner_of(np.argwhere(is_mug).min(axis=0))
    assert corner == pytest.approx([0.45, 0.45, 0.5 - 0.002])  # layers begin 2 mm below the floor
