"""Small but complete rows of every table, with real images, for the tests of tables, shards and datasets."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from remqa_data.scene_graph.relations import Edge
from remqa_data.sim.metadata import AgentState, ObjectMetadata, VisibleObject
from remqa_data.storage.card import write_card
from remqa_data.storage.manifest import Manifest, make_manifest
from remqa_data.storage.parts import Parts, assemble, count_questions, finish
from remqa_data.tables.images import StoredImage, encode_depth, encode_instances, encode_labels, encode_rgb
from remqa_data.tables.rows import (
    EmbodimentRow,
    ExpressionRow,
    FrameRow,
    GridCell,
    QuestionRow,
    Row,
    SceneRow,
    SemanticMap,
)

HEIGHT, WIDTH = 24, 32
IDS = ("Mug|1", "Table|1", "Floor|1")
MUG_BOX_2D = (8, 4, 20, 16)


def rgb_array(seed: int) -> np.ndarray:
    """A smooth picture, so that JPEG stays close to it."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    return np.stack([x * 4 + seed % 50, y * 5 + 10, (x + y) * 2 + 40], axis=-1).astype(np.uint8)


def depth_array(seed: int) -> np.ndarray:
    depth = np.random.default_rng(seed).uniform(0.1, 9.0, (HEIGHT, WIDTH)).astype(np.float32)
    depth[0, 0] = 0.0
    return depth


def objects_array() -> np.ndarray:
    """The mug (0) in its box, the table (1) below, nothing (-1) elsewhere."""
    objects = np.full((HEIGHT, WIDTH), -1, dtype=np.int32)
    objects[16:, :] = 1
    objects[MUG_BOX_2D[1] : MUG_BOX_2D[3], MUG_BOX_2D[0] : MUG_BOX_2D[2]] = 0
    return objects


@cache
def images(seed: int) -> tuple[StoredImage, StoredImage, StoredImage]:
    instances = encode_instances(objects_array(), IDS, IDS[:2])
    return encode_rgb(rgb_array(seed), f"frame-{seed}"), encode_depth(depth_array(seed)), instances


def agent(seed: int = 0) -> AgentState:
    return AgentState((0.25 * seed, -0.5, 0.0), 90.0 * (seed % 4), 30.0)


def thing(name: str, kind: str) -> ObjectMetadata:
    box = (0.1, 0.2, 0.7, 0.1 + 0.2, 0.5, 1 / 3 + 0.7)
    return ObjectMetadata(name, kind, "red", "ceramic", box, 0.25, False, "Table|1", "on", facing_deg=90.0)


def visible(name: str, kind: str) -> VisibleObject:
    return VisibleObject(**vars(thing(name, kind)), box_2d=MUG_BOX_2D, pixels=144, distance_m=1.25)


EDGE = Edge("Mug|1", "Table|1", "on", 0.5, 0.125)


def scene_row(scene: str, split: str, configuration: int = 0) -> SceneRow:
    voxels = np.array([[0, 1, 2, 0], [3, 4, 5, 1], [-1, 0, 32767, 1]], dtype=np.int16)
    return SceneRow(
        scene=scene,
        room_type="kitchen",
        split=split,
        configuration=configuration,
        seed=2**40,
        scene_json='{"name": "é"}',
        objects=(thing("Mug|1", "Mug"), thing("Table|1", "Table")),
        graph_nodes=("Mug|1", "Table|1"),
        graph_edges=(EDGE,),
        semantic_map=SemanticMap((0.0, 0.0, -0.1), 0.05, (-3, 4), ("structure", "Mug"), voxels),
        map_2d=encode_labels(np.arange(12, dtype=np.uint16).reshape(3, 4)),
        navigation_cells=(GridCell(0, 1), GridCell(-2, 3)),
        walk_start_cell=GridCell(0, 1),
        embodiment=EmbodimentRow(1.576, 90.0, 0.25, 0.63),
    )


def frame_row(scene: str, split: str, index: int) -> FrameRow:
    rgb, depth, instances = images(index)
    seen = (visible("Mug|1", "Mug"), visible("Table|1", "Table"))
    return FrameRow(
        frame_id=f"{scene}-0-{index}",
        scene=scene,
        configuration=0,
        split=split,
        index=index,
        rgb=rgb,
        depth=depth,
        instances=instances,
        agent=agent(index),
        objects=seen if index % 3 else (),  # some frames show no object
        added_nodes=("Mug|1",) if index == 1 else (),
        added_edges=(EDGE,) if index == 1 else (),
    )


def expression_row(scene: str, split: str, index: int) -> ExpressionRow:
    bare = index % 2 == 0
    return ExpressionRow(
        expression_id=f"{scene}-e{index}",
        scene=scene,
        configuration=0,
        split=split,
        frame_id=f"{scene}-0-1",
        text="the mug" if bare else "the mug on the table",
        kind="bare" if bare else "relation",
        target_id="Mug|1",
        target_type="Mug",
        anchor_id=None if bare else "Table|1",
        relation=None if bare else "on",
        box_2d=MUG_BOX_2D,
        program='[["find", "Mug"]]',
    )


def question_row(scene: str, split: str, index: int) -> QuestionRow:
    kind = ("EXISTENCE", "COUNTING", "SPATIAL")[index % 3]
    answer = ("yes", "2", "no")[index % 3]
    start, end = images(index), images(index + 1)
    return QuestionRow(
        question_id=f"{scene}-q{index}",
        kind=kind,
        question=f"Is there a mug in the drawer {'next to' if split == 'train' else 'beneath'} the toaster?",
        expression="the drawer next to the toaster",
        answer=answer,
        program='[["exists", "Mug"]]',
        scene=scene,
        room_type="kitchen",
        configuration=index,
        split=split,
        group=f"{scene}-g{index // 2}",
        initial_pose=agent(),
        goal_poses=(agent(1), agent(2)),
        target_id="Drawer|1",
        target_type="Drawer",
        start_target_box_2d=MUG_BOX_2D if index % 2 else None,
        answer_type="Mug",
        answer_ids=("Mug|1",) if answer != "no" else (),
        manipulation="Open",
        manipulation_object_id="Drawer|1",
        path_length_m=1.75,
        path_steps=9,
        actions=("MoveAhead", "RotateLeft", "OpenObject"),
        start_rgb=start[0],
        start_depth=start[1],
        start_instances=start[2],
        end_rgb=end[0],
        end_depth=end[1],
        end_instances=end[2],
        object_ids=("Mug|1", "Table|1"),
    )


def scene_rows(scene: str, split: str, frames: int = 21, questions: int = 10) -> dict[str, list[Row]]:
    """All rows of one scene, more than one row group of frames and questions."""
    return {
        "scenes": [scene_row(scene, split, c) for c in range(2)],
        "frames": [frame_row(scene, split, i) for i in range(frames)],
        "expressions": [expression_row(scene, "val" if scene == "Kitchen2" else split, i) for i in range(5)],
        "questions": [question_row(scene, split, i) for i in range(questions)],
    }


SCENES = {"Kitchen1": "train", "Kitchen2": "train", "Kitchen3": "test"}


def write_dataset(root: Path | str, order: tuple[str, ...] = tuple(SCENES), shards: int = 2) -> Manifest:
    """A finished dataset of three scenes; `order` is the order in which their parts get finished."""
    parts = Parts(root, {"seed": 0})
    made = {
        scene: parts.write(scene, scene_rows(scene, SCENES[scene]), {"refused": {"not unique": 1}}) for scene in order
    }
    in_order = [made[scene] for scene in SCENES]
    files = assemble(parts, in_order, shards)
    config = {"scenes": 3, "frame_px": WIDTH}
    manifest = make_manifest(
        files, seed=0, config=config, questions=count_questions(in_order), refused={"not unique": 3}
    )
    write_card(root, manifest)
    finish(parts.storage, manifest)
    return manifest
