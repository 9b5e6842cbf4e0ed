"""A target that is moved to where it cannot go or stand is counted."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.generators.audit.recount.moves import _problem, misplaced
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.agent.actions import MOVE
from remqa_data.sim.physics.world import World
from tests.helpers.forgeries import Copy


@pytest.fixture
def world() -> Iterator[World]:
    """A bin with an apple in it and a toaster, on a floor that goes on behind the walls."""
    things = (
        SceneObject("Floor|1", AssetSpec("Floor", (6.0, 6.0, 0.02)), (0.0, 0.0, -0.01)),
        SceneObject("GarbageCan|1", AssetSpec("GarbageCan", (0.3, 0.3, 0.4)), (0.0, 0.0, 0.2)),
        SceneObject("Apple|1", AssetSpec("Apple", (0.08, 0.08, 0.08)), (0.0, 0.0, 0.1), is_fixed=False),
        SceneObject("Toaster|1", AssetSpec("Toaster", (0.3, 0.2, 0.2)), (1.0, 0.0, 0.1), is_fixed=False),
    )
    with World(Scene("Test", "kitchen", (-1.5, -1.5, 1.5, 1.5), 0.0, 2.5, ((0, 0, 2.4),), (), things)) as made:
        made.settle()
        yield made


@pytest.mark.parametrize(
    ("position", "problem"),
    [
        ((0.5, 0.5, 0.2), None),
        ((2.0, 0.0, 0.2), "out of the room"),
        ((0.9, 0.0, 0.2), "in Toaster|1"),
        ((0.0, 0.5, 0.25), "borne by nothing"),
    ],
)
def test_a_target_stays_in_the_room_in_nothing_and_is_borne(world: World, position, problem: str | None) -> None:
    assert _problem(world, "GarbageCan|1", position) == problem


@pytest.mark.slow
def test_the_questions_of_a_dataset_are_found_by_their_ids(one_room: Path, tmp_path: Path) -> None:
    assert misplaced(one_room) == {}
    copy = Copy(one_room, tmp_path / "copy")
    rows = copy.rows("questions")
    for row in rows[1:3]:
        row["actions"] = [f"{MOVE} {row['target_id']} 100.0 100.0 1.0", "Done"]
    copy.store("questions", rows)
    assert misplaced(copy.root) == {row["question_id"]: "out of the room" for row in rows[1:3]}
