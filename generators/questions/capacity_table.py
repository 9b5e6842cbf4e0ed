"""How many questions each room can take, from the tables that `capacities` counted."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from remqa_data.errors import UnknownNameError
from remqa_data.floorplans.sampled.naming import PREFIX, is_sampled, room_type_of, sampled_index
from remqa_data.tables.rows import KINDS, QuestionKind
from remqa_data.yaml_files import template_text

TABLE, SAMPLED_TABLE = "capacities.csv", "sampled_capacities.csv"


@dataclass(frozen=True)
class SceneCapacity:
    """How many lots of questions of each kind a room can take.

    Attributes
    ----------
    scene, room_type : str
        The room.
    lots : mapping
        By kind, how many it takes easily.
    most : mapping
        By kind, how many it takes at all: with more questions about one place, and longer ones, than there should be.
    """

    scene: str
    room_type: str
    lots: Mapping[QuestionKind, int]
    most: Mapping[QuestionKind, int]


def capacities(scenes: Sequence[str]) -> list[SceneCapacity]:
    """What some rooms can take, from `templates/capacities.csv`; what sampled rooms must take, by their type.

    Raises
    ------
    UnknownNameError
        If a room is not in the table.
    """
    return [_sampled_capacity(scene) if is_sampled(scene) else _recorded_capacity(scene) for scene in scenes]


def recorded_capacities() -> Mapping[str, SceneCapacity]:
    """By room, what those that were recorded can take."""
    return _read(TABLE)


def _recorded_capacity(scene: str) -> SceneCapacity:
    known = recorded_capacities()
    if scene not in known:
        raise UnknownNameError("scene", scene, known)
    return known[scene]


def _sampled_capacity(scene: str) -> SceneCapacity:
    of_type = _read(SAMPLED_TABLE)[PREFIX + room_type_of(sampled_index(scene))]
    return replace(of_type, scene=scene)


@lru_cache(maxsize=2)
def _read(source: str) -> Mapping[str, SceneCapacity]:
    lines = template_text(source).splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    return {row["scene"]: _capacity(row) for row in rows}


def _capacity(row: Mapping[str, str]) -> SceneCapacity:
    easy = {kind: int(row[kind]) for kind in KINDS}
    return SceneCapacity(row["scene"], row["room_type"], easy, {kind: int(row[f"{kind}_most"]) for kind in KINDS})
