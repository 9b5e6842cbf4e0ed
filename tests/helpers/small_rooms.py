"""A dataset of real rooms that take no time: a few square metres with a fridge and stools, and questions about the fridge."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from remqa_data.assets.core.model import AssetSpec
from remqa_data.scene import Scene, SceneObject
from remqa_data.sim.metadata import AgentState
from remqa_data.storage.card import write_card
from remqa_data.storage.manifest import Manifest, make_manifest
from remqa_data.storage.parts import Parts, assemble, count_questions, finish
from remqa_data.tables.rows import Row
from tests.helpers.dataset_rows import question_row, scene_row

FRIDGE = "Fridge|1"
ROOMS = {"Small1": "train", "Small2": "test"}
CONFIGURATIONS = 2
START, GOAL = AgentState((1.75, 0.25, 0.0), 180.0, 0.0), AgentState((0.5, 0.5, 0.0), 90.0, 30.0)
WALK = (*["MoveAhead"] * 5, "RotateRight", "MoveAhead", "LookDown")
"""From one to the other."""


def small_room(name: str, configuration: int) -> Scene:
    """2 x 1.25 m; in its second configuration the stool stands elsewhere, so that other cells can be reached."""
    stool_x = (1.0, 1.5)[configuration]
    things = (
        SceneObject("Floor|1", AssetSpec("Floor", (2.0, 1.25, 0.02)), (1.0, 0.625, -0.01)),
        SceneObject(FRIDGE, AssetSpec("Fridge", (0.6, 0.3, 1.2), seed=int(name[-1])), (0.4, 1.09, 0.6)),
        SceneObject("Stool|1", AssetSpec("Stool", (0.3, 0.3, 0.5)), (stool_x, 0.75, 0.25)),
    )
    return Scene(name, "kitchen", (0.0, 0.0, 2.0, 1.25), 0.0, 2.5, ((1.0, 0.6, 2.4),), (), things)


def small_rows(name: str, split: str) -> dict[str, list[Row]]:
    """Scenes and questions of one room."""
    scenes = [
        replace(scene_row(name, split, number), scene_json=small_room(name, number).to_json().decode())
        for number in range(CONFIGURATIONS)
    ]
    questions = [
        replace(
            question_row(name, split, number),
            configuration=number // 2,
            initial_pose=START,
            goal_poses=(GOAL,),
            target_id=FRIDGE,
            target_type="Fridge",
            manipulation_object_id=FRIDGE,
            path_length_m=1.5,
            actions=(*WALK, f"OpenObject {FRIDGE}", "Done"),
        )
        for number in range(2 * CONFIGURATIONS)
    ]
    return {"scenes": scenes, "questions": questions}  # type: ignore[dict-item]


def write_small_rooms(root: Path, seed: int = 0) -> Manifest:
    """A finished dataset; another seed makes another one of the same rooms."""
    parts = Parts(root, {"seed": seed})
    made = [parts.write(name, small_rows(name, split), {"refused": {}}) for name, split in ROOMS.items()]
    manifest = make_manifest(
        assemble(parts, made, 1), seed=seed, config={"seed": seed}, questions=count_questions(made), refused={}
    )
    write_card(root, manifest)
    finish(parts.storage, manifest)
    return manifest
