"""What rooms can take, lowered to what they gave in a dataset: `python -m remqa_data.generators.lowered_capacities DATASET`.

`questions/capacities` measures what finds room; what lies in a place also hides a part of it, which only arranging tells. So a
dataset is made of what the table promises, and where a room had less than it was asked for, the table promises no more.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from remqa_data.floorplans.ithor.scenes import scene_names
from remqa_data.floorplans.splits import QUESTION_SPLITS
from remqa_data.generators.config import stored_config
from remqa_data.generators.questions.allotment import LOT_SIZE, SceneQuota, allot
from remqa_data.generators.questions.capacities import table_path, write_capacities
from remqa_data.generators.questions.capacity_table import SceneCapacity, capacities
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import KINDS


def lowered(
    rooms: Iterable[SceneCapacity], asked: Iterable[SceneQuota], had: Mapping[tuple[str, str], int]
) -> list[SceneCapacity]:
    """Capacities of rooms, no larger than what they had where that is less than they were asked for.

    Parameters
    ----------
    rooms : iterable of SceneCapacity
        What was thought.
    asked : iterable of SceneQuota
        What some of them were asked for.
    had : mapping
        Samples by room and kind.
    """
    quotas, found = {quota.scene: quota for quota in asked}, []
    for room in rooms:
        lots, most = dict(room.lots), dict(room.most)
        for kind in KINDS if room.scene in quotas else ():
            samples = had.get((room.scene, kind), 0)
            if samples < quotas[room.scene].total(kind):
                most[kind] = samples // LOT_SIZE
                lots[kind] = min(lots[kind], most[kind])
        found.append(replace(room, lots=lots, most=most))
    return found


def lowered_by(dataset: Path) -> list[SceneCapacity]:
    """The table's capacities, no larger than what the rooms of a dataset had that was made with them."""
    config = stored_config(load_manifest(dataset).config)
    tables = [read_table(dataset, "questions", split, ["scene", "kind"]) for split in QUESTION_SPLITS]
    had = Counter((row["scene"], row["kind"]) for table in tables for row in table.to_pylist())
    return lowered(capacities(scene_names()), allot(capacities(config.scene_names), config.totals), had)


if __name__ == "__main__":
    write_capacities(lowered_by(Path(sys.argv[1])), table_path())
