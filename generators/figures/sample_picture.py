"""A sample as a picture: the question, the view before and after the manipulation, and the way there on a map."""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np

from remqa_data.errors import DatasetError, UnknownNameError
from remqa_data.generators.figures.preview import map_pixel, room_map
from remqa_data.geometry.types import U8
from remqa_data.opencv import check_png, cv2, write_png
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import parse_actions, walk_and_rest
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.navigation.paths import poses_along
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows, read_table
from remqa_data.tables.images import decode_rgb
from remqa_data.tables.rows import QuestionRow, SceneRow, configuration_name

TILE_PX, LINE_PX = 300, 21
BOX_COLOR, PATH_COLOR, START_COLOR, GOAL_COLOR = (230, 30, 30), (30, 90, 220), (30, 90, 220), (230, 30, 30)


def write_sample_picture(root: Path, question_id: str, path: Path) -> None:
    """Draw one question of a dataset as PNG.

    Raises
    ------
    UnknownNameError
        If the dataset has no such question; names the nearest.
    DatasetError
        If the dataset has not the room that the question is about.
    OutputError
        If the name of the picture does not end with .png.
    """
    check_png(path)
    write_png(path, sample_picture(*find_question(root, question_id)))


def find_question(root: Path, question_id: str) -> tuple[QuestionRow, SceneRow]:
    """A question and the configuration that it is about."""
    splits = load_manifest(root).splits("questions")
    for split in splits:
        for question in read_rows(root, QuestionRow, split, question_id=question_id):
            scene, configuration = question.scene, question.configuration
            for room in read_rows(root, SceneRow, split, scene=scene, configuration=configuration):
                return question, room
            place = configuration_name(scene, configuration)
            raise DatasetError(f"{root}: {question_id} is about {place}, which is not there")
    ids = (read_table(root, "questions", split, ["question_id"])["question_id"] for split in splits)
    raise UnknownNameError("question", question_id, [name for column in ids for name in column.to_pylist()])


def sample_picture(question: QuestionRow, scene: SceneRow) -> U8:
    """The question above I_start with the target's box, I_end and the map, (h, w, 3) RGB."""
    before, after = decode_rgb(question.start_rgb.bytes).copy(), decode_rgb(question.end_rgb.bytes)
    if question.start_target_box_2d is not None:
        x1, y1, x2, y2 = question.start_target_box_2d
        cv2.rectangle(before, (x1, y1), (x2 - 1, y2 - 1), BOX_COLOR, 2)
    body = np.hstack([before, after, _way_map(question, scene)])
    facts = f"{question.question_id}   {question.manipulation} {question.target_type}   {question.path_steps} steps"
    asked = textwrap.wrap(question.question, 70)
    lines = [*asked, f"answer: {question.answer}", facts]
    header = np.full((LINE_PX * (len(lines) + 1), body.shape[1], 3), 255, np.uint8)
    for number, line in enumerate(lines):
        scale, width = (0.62, 2) if number < len(asked) else (0.5, 1)
        place = (8, LINE_PX * (number + 1))
        cv2.putText(header, line, place, cv2.FONT_HERSHEY_SIMPLEX, scale, (20, 20, 20), width, cv2.LINE_AA)
    return np.vstack([header, body])


def _way_map(question: QuestionRow, row: SceneRow) -> U8:
    scene = Scene.from_json(row.scene_json, row.scene)
    with World(scene) as world:
        grid = reachable_grid(world)
        plan = room_map(scene, WorldView(world), grid, TILE_PX)
    walk, _ = walk_and_rest(parse_actions(question.actions))
    poses = poses_along(grid, question.initial_pose.pose(), (step.name for step in walk))
    points = np.array([map_pixel(scene, TILE_PX, *grid.position(pose.cell)) for pose in poses], dtype=np.int32)
    cv2.polylines(plan, [points], False, PATH_COLOR, 2, cv2.LINE_AA)
    for point, color in ((points[0], START_COLOR), (points[-1], GOAL_COLOR)):
        cv2.circle(plan, (int(point[0]), int(point[1])), 5, color, -1, cv2.LINE_AA)
    target = scene.object(question.target_id)
    cv2.drawMarker(plan, map_pixel(scene, TILE_PX, *target.position[:2]), BOX_COLOR, cv2.MARKER_TILTED_CROSS, 12, 2)
    return plan
