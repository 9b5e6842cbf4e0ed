"""Whether every table holds the rows that the configuration asks for, in their order: told from names, without pictures."""

from __future__ import annotations

import os
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import groupby
from typing import Any

from remqa_data.floorplans.splits import expression_split
from remqa_data.generators.audit.failures import Failure
from remqa_data.generators.config import Config
from remqa_data.generators.questions.allotment import SceneQuota
from remqa_data.generators.questions.shortfalls import asked_in_the_end
from remqa_data.generators.walks.scene_walk import EMBODIMENT
from remqa_data.storage.manifest import Manifest
from remqa_data.storage.ownership import SPLITS
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import configuration_name

Key = dict[str, Any]
"""Columns of a row that tell which one it is."""
_COLUMNS = {
    "scenes": ("scene", "room_type", "split", "configuration", "seed", "embodiment"),
    "frames": ("frame_id", "scene", "configuration", "split", "index"),
    "expressions": ("expression_id", "scene", "configuration", "split", "frame_id", "target_id"),
    "questions": ("question_id", "scene", "room_type", "configuration", "split", "group", "kind", "answer"),
}


def row_failures(root: str | os.PathLike[str], manifest: Manifest, config: Config) -> Iterator[Failure]:
    """Rows that are missing, too many, out of order, or named otherwise than their place says.

    Parameters
    ----------
    root : path
        Folder of the dataset.
    manifest : Manifest
        Its manifest.
    config : Config
        What the manifest says it was made from.
    """
    # Counted first: a configuration of a million rooms is not worth a closer look.
    wanted = len(config.scene_names) * config.configurations
    if manifest.rows("scenes") != wanted:
        yield Failure("scenes", "complete", f"{manifest.rows('scenes')} rows; the configuration asks for {wanted}")
        return
    quotas = asked_in_the_end(config.scene_names, config.totals, manifest.asked_anew)
    keys = {table: _keys(root, manifest, table) for table in _COLUMNS}
    yield from _scene_rows(keys["scenes"], quotas, config)
    yield from _frame_rows(keys["frames"], quotas, config)
    yield from _expression_rows(keys["expressions"], keys["frames"], config)
    yield from _question_rows(keys["questions"], quotas, may_fall_short=bool(manifest.asked_anew))


def short_walks(root: str | os.PathLike[str], manifest: Manifest, config: Config) -> set[str]:
    """Rooms with fewer frames than were asked for: there may be no more to see in them, or rows may be missing."""
    counts = Counter((key["scene"], key["configuration"]) for key in _keys(root, manifest, "frames"))
    wanted = config.walk.frames_per_configuration
    numbers = range(config.configurations)
    return {name for name in config.scene_names if any(counts[name, number] < wanted for number in numbers)}


def _keys(root: str | os.PathLike[str], manifest: Manifest, table: str) -> list[Key]:
    """Those of all rows of a table, by split in the dataset's order."""
    columns = list(_COLUMNS[table])
    return [
        key for split in manifest.splits(table) for key in _said_split(read_table(root, table, split, columns), split)
    ]


def _said_split(rows: Any, split: str) -> Iterator[Key]:
    """Keys with the split in whose files they lie, which their own column may contradict."""
    for key in rows.to_pylist():
        yield {**key, "file_split": split}


def _scene_rows(found: Sequence[Key], quotas: Sequence[SceneQuota], config: Config) -> Iterator[Failure]:
    expected = [
        {
            **{"scene": quota.scene, "room_type": quota.room_type, "split": split, "configuration": number},
            **{"seed": config.seed, "embodiment": asdict(EMBODIMENT), "file_split": split},
        }
        for split in SPLITS
        for quota in quotas
        if quota.split == split
        for number in range(config.configurations)
    ]
    yield from _different("scenes", found, expected)


def _frame_rows(found: Sequence[Key], quotas: Sequence[SceneQuota], config: Config) -> Iterator[Failure]:
    counts = Counter((key["scene"], key["configuration"]) for key in found)
    most = config.walk.frames_per_configuration
    expected = []
    for split in SPLITS:
        for quota in quotas:
            if quota.split != split:
                continue
            for number in range(config.configurations):
                count = counts[quota.scene, number]
                if not 1 <= count <= most:
                    name = configuration_name(quota.scene, number)
                    yield Failure(name, "complete", f"{count} frames; the configuration asks for {most}")
                for index in range(min(count, most)):
                    name = f"{quota.scene}-c{number}-f{index:02d}"
                    key = {"frame_id": name, "scene": quota.scene, "configuration": number, "split": split}
                    expected.append({**key, "index": index, "file_split": split})
    yield from _different("frames", found, expected)


def _expression_rows(found: Sequence[Key], frames: Sequence[Key], config: Config) -> Iterator[Failure]:
    frames_of = {key["frame_id"]: (key["scene"], key["configuration"]) for key in frames}
    for key in found:
        where, name = f"{key['expression_id']}", (key["scene"], key["configuration"])
        if not key["split"] == key["file_split"] == _split_or_none(key["scene"], config):
            yield Failure(where, "consistent", f"split {key['split']} is not that of the expressions of {key['scene']}")
        if frames_of.get(key["frame_id"]) != name:
            yield Failure(where, "consistent", f"{key['frame_id']} is no frame of {configuration_name(*name)}")
    order = {
        (name, number): (place, number)
        for place, name in enumerate(config.scene_names)
        for number in range(config.configurations)
    }
    for split in SPLITS:
        own = (key for key in found if key["file_split"] == split)
        places = [order.get((key["scene"], key["configuration"]), (-1, 0)) for key in own]
        if places != sorted(places):
            yield Failure("expressions", "complete", f"the rows of {split} are not in the order of rooms")
    for (scene, number), rows in groupby(found, lambda key: (key["scene"], key["configuration"])):
        targets = [str(target) for target, _ in groupby(rows, lambda key: key["target_id"])]
        if targets != sorted(targets):
            where = configuration_name(scene, number)
            yield Failure(where, "complete", "its expressions are not in the order of their targets")
    for (scene, number, target), rows in groupby(found, lambda k: (k["scene"], k["configuration"], k["target_id"])):
        names = [key["expression_id"] for key in rows]
        expected = [f"{scene}-c{number}-{target}-e{place}" for place in range(len(names))]
        if names != expected:
            yield Failure(f"{names[0]}", "complete", f"the expressions of {target} are not numbered from 0 in order")
    yield from _twice("expressions", [key["expression_id"] for key in found])


def _question_rows(found: Sequence[Key], quotas: Sequence[SceneQuota], *, may_fall_short: bool) -> Iterator[Failure]:
    yield from _twice("questions", [key["question_id"] for key in found])
    yield from _question_names(found, quotas)
    yield from _question_order(found, quotas)
    yield from _question_counts(found, quotas, may_fall_short=may_fall_short)


def _question_names(found: Sequence[Key], quotas: Sequence[SceneQuota]) -> Iterator[Failure]:
    """Questions that are called otherwise than what they are, or lie elsewhere."""
    asked = {quota.scene: quota for quota in quotas}
    for key in found:
        where, quota = f"{key['question_id']}", asked.get(key["scene"])
        if quota is None or (key["room_type"], key["split"]) != (quota.room_type, quota.split):
            yield Failure(where, "consistent", f"split and room type are not those of {key['scene']}")
        elif key["file_split"] != key["split"]:
            yield Failure(where, "consistent", f"it lies in the files of {key['file_split']}")
        if not re.fullmatch(rf"{re.escape(str(key['scene']))}-{key['kind']}-\d\d", str(key["group"]), re.ASCII):
            yield Failure(where, "consistent", f"group {key['group']} is not named after its room and kind")
        if key["question_id"] != f"{key['group']}-c{key['configuration']}":
            yield Failure(where, "consistent", "it is not named after its group and configuration")


def _question_order(found: Sequence[Key], quotas: Sequence[SceneQuota]) -> Iterator[Failure]:
    """Rooms, their groups and the configurations of each come one after the other."""
    for split in SPLITS:
        own = [key for key in found if key["file_split"] == split]
        rooms = [scene for scene, _ in groupby(own, lambda key: key["scene"])]
        asking = [quota.scene for quota in quotas if quota.split == split and any(map(quota.total, quota.answers))]
        if rooms != [scene for scene in asking if scene in rooms]:
            yield Failure("questions", "complete", f"the rows of {split} are not those of its rooms in their order")
    for (scene, kind), groups_of in _in_rooms(found).items():
        if groups_of != sorted(groups_of):
            yield Failure(f"{scene}", "complete", f"the groups of {kind} are not in the order of their numbers")
    for group, rows in groupby(found, lambda key: key["group"]):
        numbers = [str(key["configuration"]) for key in rows]
        if numbers != sorted(numbers, key=lambda number: (len(number), number)):
            yield Failure(f"{group}", "complete", "its questions are not in the order of configurations")
    groups = [group for group, _ in groupby(found, lambda key: key["group"])]
    yield from _twice("questions", groups, what="group")


def _question_counts(found: Sequence[Key], quotas: Sequence[SceneQuota], *, may_fall_short: bool) -> Iterator[Failure]:
    """Each room has as many questions of each kind and answer as it was asked for."""
    given = Counter((key["scene"], key["kind"], key["answer"]) for key in found)
    owed = Counter({(q.scene, kind, a): n for q in quotas for kind, n_of in q.answers.items() for a, n in n_of.items()})
    for name in sorted(given.keys() | owed.keys(), key=str):
        # Where rooms were asked anew, some had fewer than they were asked for; the sums are looked at elsewhere.
        if given[name] > owed[name] or (given[name] < owed[name] and not may_fall_short):
            reason = f"{given[name]} questions are answered {name[2]}; it is asked for {owed[name]}"
            yield Failure(f"{name[0]} {name[1]}", "unbiased", reason)


def _in_rooms(found: Sequence[Key]) -> dict[tuple[Any, Any], list[str]]:
    """The groups of questions of each kind in each room, as they come."""
    groups: defaultdict[tuple[Any, Any], list[str]] = defaultdict(list)
    for key in found:
        groups[key["scene"], key["kind"]].append(str(key["group"]))
    return dict(groups)


def _split_or_none(scene: Any, config: Config) -> str | None:
    return expression_split(scene) if scene in config.scene_names else None


def _twice(table: str, names: Sequence[Any], what: str = "row") -> Iterator[Failure]:
    for name, count in Counter(names).items():
        if count > 1:
            yield Failure(f"{name}", "complete", f"{table} have this {what} {count} times")


def _different(table: str, found: Sequence[Key], expected: Sequence[Key]) -> Iterator[Failure]:
    """The first row that is not the one that belongs there."""
    if len(found) != len(expected):
        yield Failure(table, "complete", f"{len(found)} rows; the configuration makes it {len(expected)}")
    for number, (is_, should) in enumerate(zip(found, expected, strict=False)):
        wrong = [column for column in should if is_[column] != should[column]]
        if wrong:
            told, right = ({column: key[column] for column in wrong} for key in (is_, should))
            yield Failure(f"{table}, row {number}", "complete", f"{told!r:.200} should be {right!r:.200}")
            return
