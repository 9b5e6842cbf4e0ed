"""Verification that need not make a room again which a test has made: it is compared with what is remembered of it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from remqa_data.generators import scene_plan
from remqa_data.generators.audit import remade
from remqa_data.generators.config import stored_config
from remqa_data.generators.scene_plan import Job
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows
from remqa_data.tables.rows import Row
from remqa_data.tables.schema import TABLES

Rows = dict[str, list[Row]]


class RememberedRooms:
    """What is needed to make the rooms of a dataset again: its rows, for the configuration that it was made from.

    For any other configuration a room is made, but for its hiding places, which are found once.

    Parameters
    ----------
    root : path
        The dataset as it was made.
    """

    def __init__(self, root: Path) -> None:
        manifest = load_manifest(root)
        self._config = stored_config(manifest.config)
        self._rows: defaultdict[str, Rows] = defaultdict(lambda: {table: [] for table in TABLES})
        for table, spec in TABLES.items():
            for split in manifest.splits(table):
                for row in read_rows(root, spec.row_type, split):  # type: ignore[type-var]
                    self._rows[row.scene][table].append(row)
        first, *others = self._rows
        self._refused: dict[str, dict[str, int]] = {first: dict(manifest.refused)} | {scene: {} for scene in others}
        self._stored = {id(row) for rows in self._rows.values() for own in rows.values() for row in own}
        self._bytes: dict[tuple[int, ...], dict[str, bytes]] = {}
        self._make, self._as_bytes, self._find = remade.make_room, remade._as_bytes, cache(scene_plan.hiding_places)

    def use(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Let verification make rooms so from now on."""
        monkeypatch.setattr(remade, "make_room", self._made)
        monkeypatch.setattr(remade, "_as_bytes", self._known_bytes)
        monkeypatch.setattr(scene_plan, "hiding_places", self._find)

    def _made(self, job: Job) -> tuple[Rows, dict[str, Any]]:
        if job.config != self._config:
            return self._make(job)
        return self._rows[job.scene], {"refused": self._refused[job.scene]}

    def _known_bytes(self, table: str, rows: Sequence[Row]) -> dict[str, bytes]:
        """Those of remembered rows are worked out once; they live as long as this does, so no other row has their id."""
        ids = tuple(map(id, rows))
        if not self._stored.issuperset(ids):
            return self._as_bytes(table, rows)
        if ids not in self._bytes:
            self._bytes[ids] = self._as_bytes(table, rows)
        return self._bytes[ids]
