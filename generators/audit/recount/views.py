"""What the stored views of each question show, measured in their pixels."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from remqa_data.generators.audit.recount.wording import naming, phrase_of, relation_of
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.geometry.types import F64
from remqa_data.language.referring import Program
from remqa_data.language.stored import stored_program
from remqa_data.opencv import cv2
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import open_shards, read_table
from remqa_data.tables.images import decode_depth, decode_instances, decode_rgb

PUBLISHED_PX = 300 * 300
"""Pixels are told as in a view of 300 x 300, whatever the size of the stored one."""
RING_PX = 4
"""Surroundings of evidence are the pixels so near to it."""
SEEN_PX = 10
"""Of fewer pixels nobody knows what they show."""
MOVED_M = 0.01
"""What is so much farther away than what a pixel showed before is something else."""


def measured_views(root: str | os.PathLike[str]) -> pd.DataFrame:
    """One row for each question of a dataset, in its order.

    Returns
    -------
    pandas.DataFrame
        `question_id`, `kind`, `split`, `scene`, `answer`, `manipulation`, `relation` (of the first step); what a guesser
        could go by: `revealed` (objects that only the end view shows), `revealed_px`, `start_bytes`, `end_bytes`,
        `end_depth_bytes`, `scene_objects`; how well things are seen: `evidence_px` (of the least visible counted object, as
        in 300 x 300), `evidence_de` (its distance to its surroundings in CIELAB, Delta E 1976), `target_px` (short side of
        the target's box), `landmark_seen`, `front_deg` (goal pose to the target's front, NaN without a front), `start_m`
        (to the nearest goal pose, straight); and what should not be: `moved` (ids of what moved though it is neither the
        target nor in or on it), `newly_seen` (objects of the asked type that only the end view shows).

    Raises
    ------
    DatasetError
        If there is no finished dataset, or a question names what is not there.
    """
    rooms = _rooms(root)
    measured = []
    for split in load_manifest(root).splits("questions"):
        for shard in open_shards(root, "questions", split):
            for group in range(shard.row_groups):
                for row in shard.read(group).to_pylist():
                    with naming(root, f"question {row['question_id']}"):
                        measured.append(_measured(row, rooms[row["scene"], row["configuration"]]))
    return pd.DataFrame(measured)


@dataclass(frozen=True)
class _Room:
    """What a configuration's row says of its objects."""

    objects: Mapping[str, Mapping[str, Any]]
    carried_by: Mapping[str, frozenset[str]]

    def type_of(self, object_id: str) -> str:
        return str(self.objects[object_id]["type"])


def _rooms(root: str | os.PathLike[str]) -> dict[tuple[str, int], _Room]:
    rooms = {}
    for split in load_manifest(root).splits("scenes"):
        for row in read_table(root, "scenes", split, ["scene", "configuration", "objects"]).to_pylist():
            objects = {record["id"]: record for record in row["objects"]}
            rooms[row["scene"], row["configuration"]] = _Room(objects, _carried(objects))
    return rooms


def _carried(objects: Mapping[str, Mapping[str, Any]]) -> dict[str, frozenset[str]]:
    """By object, what lies in it or on it, or in or on that."""
    held: dict[str, set[str]] = defaultdict(set)
    for object_id in objects:
        holder = objects[object_id]["support"]
        while holder is not None and object_id not in held[holder]:
            held[holder].add(object_id)
            holder = objects[holder]["support"] if holder in objects else None
    return {holder: frozenset(ids) for holder, ids in held.items()}


def _measured(row: Mapping[str, Any], room: _Room) -> dict[str, Any]:
    program = stored_program(row["program"])
    start, end = (decode_instances(row[f"{when}_instances"]["bytes"]) for when in ("start", "end"))
    ids = list(row["object_ids"])
    scale = PUBLISHED_PX / end.size
    new = np.setdiff1d(end, start)
    revealed = [ids[number - 1] for number in new if number and np.count_nonzero(end == number) * scale >= SEEN_PX]
    pixels = [float(np.count_nonzero(end == ids.index(a) + 1) * scale) if a in ids else 0.0 for a in row["answer_ids"]]
    return {
        **{name: row[name] for name in ("question_id", "kind", "split", "scene", "answer", "manipulation")},
        "relation": relation_of(program),
        "revealed": len(revealed),
        "revealed_px": float(np.isin(end, new[new > 0]).sum() * scale),
        "start_bytes": len(row["start_rgb"]["bytes"]),
        "end_bytes": len(row["end_rgb"]["bytes"]),
        "end_depth_bytes": len(row["end_depth"]["bytes"]),
        "scene_objects": len(room.objects),
        "evidence_px": min(pixels, default=np.nan),
        "evidence_de": _least_contrast(row, end, [ids.index(a) + 1 for a in row["answer_ids"] if a in ids]),
        "target_px": _short_side(row["start_target_box_2d"]) * np.sqrt(scale),
        "landmark_seen": _sees_landmark(row, program, start, room),
        "front_deg": _from_front_deg(row, room),
        "start_m": _start_distance_m(row),
        "moved": tuple(_moved(row, start, end, room)),
        "newly_seen": sum(room.type_of(object_id) == row["answer_type"] for object_id in revealed),
    }


def _least_contrast(row: Mapping[str, Any], end: npt.NDArray[np.uint16], numbers: list[int]) -> float:
    """Of several objects, the smallest difference between its mean colour and that of what surrounds it."""
    if not numbers:
        return float("nan")
    rgb = decode_rgb(row["end_rgb"]["bytes"]).astype(np.float32) / np.float32(255)
    lab = cv2.cvtColor(rgb, cv2.COLOR_RGB2LAB)
    kernel = np.ones((2 * RING_PX + 1, 2 * RING_PX + 1), dtype=np.uint8)
    found = []
    for number in numbers:
        mask = end == number
        ring = cv2.dilate(mask.astype(np.uint8), kernel).astype(bool) & ~mask
        if mask.any() and ring.any():
            found.append(float(arithmetic.length(lab[mask].mean(axis=0) - lab[ring].mean(axis=0))))
    return min(found, default=0.0)


def _short_side(box: list[int] | None) -> float:
    return 0.0 if box is None else float(min(box[2] - box[0], box[3] - box[1]))


def _sees_landmark(row: Mapping[str, Any], program: Program, start: npt.NDArray[np.uint16], room: _Room) -> bool | None:
    """Whether the start view shows a thing of each type that the referring expression leans on; None if it leans on none."""
    types = {inner[0][1] for inner in _landmarks(phrase_of(program))}
    if not types:
        return None
    seen = {room.type_of(row["object_ids"][number - 1]) for number in np.unique(start) if number}
    return types <= seen


def _landmarks(program: Program) -> Iterator[Program]:
    """Programs of the things that a phrase leans on."""
    return (step[-1] for step in program if step[0] in ("relate", "closest"))


def _from_front_deg(row: Mapping[str, Any], room: _Room) -> float:
    target = room.objects[row["target_id"]]
    if target["facing_deg"] is None:
        return float("nan")
    goal, box = row["goal_poses"][0]["position"], target["box"]
    to_goal = np.degrees(arithmetic.arctan2(goal[1] - (box[1] + box[4]) / 2, goal[0] - (box[0] + box[3]) / 2))
    return degrees_apart(float(to_goal), target["facing_deg"])


def _start_distance_m(row: Mapping[str, Any]) -> float:
    goals: F64 = np.array([goal["position"][:2] for goal in row["goal_poses"]])
    return float(arithmetic.length(goals - row["initial_pose"]["position"][:2]).min())


def _moved(
    row: Mapping[str, Any], start: npt.NDArray[np.uint16], end: npt.NDArray[np.uint16], room: _Room
) -> Iterator[str]:
    """Ids of what changed its place in the pictures and neither is the target nor lies in or on it.

    The camera stands still. Where a thing was seen, and something farther away is seen now, it has gone; where it is
    seen, and something farther away was seen before, it has come.
    """
    before, after = (decode_depth(row[f"{when}_depth"]["bytes"]) for when in ("start", "end"))
    target = row["target_id"]
    goes_along = room.carried_by.get(target, frozenset()) | {target}
    for number in np.union1d(start, end):
        if number and row["object_ids"][number - 1] not in goes_along:
            gone = (start == number) & (after > before + MOVED_M)
            come = (end == number) & (before > after + MOVED_M)
            if np.count_nonzero(gone | come) * PUBLISHED_PX / end.size >= SEEN_PX:
                yield row["object_ids"][number - 1]
