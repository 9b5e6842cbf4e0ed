"""Where questions' targets are moved to: whether they could stand there, asked of the room and not of who moved them."""

from __future__ import annotations

import os
from collections import defaultdict

from remqa_data.geometry.types import Vec3
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import MOVE, parse_actions
from remqa_data.sim.agent.handling import OVERLAP_M, is_in_room, support_of
from remqa_data.sim.physics.world import World
from remqa_data.storage.manifest import load_manifest, question_splits
from remqa_data.storage.shards import read_table

_Moves = dict[str, tuple[str, Vec3]]
"""What is moved where, by question."""


def misplaced(root: str | os.PathLike[str]) -> dict[str, str]:
    """What is wrong with where a dataset's questions move their targets to, by `question_id`.

    A target is to stay in the room, in nothing, and some object, the floor at least, is to bear it.

    Raises
    ------
    DatasetError
        If there is no finished dataset.
    """
    wanted, found = _moves(root), dict[str, str]()
    for split in load_manifest(root).splits("scenes"):
        for row in read_table(root, "scenes", split, ["scene", "configuration", "scene_json"]).to_pylist():
            moves = wanted.get((row["scene"], row["configuration"]))
            if moves:
                with World(Scene.from_json(row["scene_json"], row["scene"])) as world:
                    found |= _problems(world, moves)
    return found


def _moves(root: str | os.PathLike[str]) -> dict[tuple[str, int], _Moves]:
    """By configuration."""
    found: dict[tuple[str, int], _Moves] = defaultdict(dict)
    names = ["question_id", "scene", "configuration", "actions"]
    for split in question_splits(root):
        for row in read_table(root, "questions", split, names).to_pylist():
            for action in parse_actions(row["actions"]):
                if action.name == MOVE:
                    x, y, z = action.numbers
                    found[row["scene"], row["configuration"]][row["question_id"]] = str(action.target), (x, y, z)
    return found


def _problems(world: World, moves: _Moves) -> dict[str, str]:
    first, known = world.save(), dict[tuple[str, Vec3], str | None]()
    for move in moves.values():
        if move not in known:
            known[move] = _problem(world, *move)
            world.restore(first)
    return {question: problem for question, move in moves.items() if (problem := known[move]) is not None}


def _problem(world: World, object_id: str, position: Vec3) -> str | None:
    carried = world.move(object_id, position)
    if not is_in_room(world, object_id):
        return "out of the room"
    touched = [(other, gap) for other, gap in world.overlapping(object_id, OVERLAP_M) if other not in carried]
    for other, gap in touched:
        if gap < -OVERLAP_M:
            return f"in {other}"
    return None if touched and support_of(world, object_id) else "borne by nothing"
