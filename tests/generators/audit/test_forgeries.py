"""Lies of every kind, told consistently, are found; and none ends in a traceback."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from remqa_data.errors import RemqaError
from remqa_data.generators.audit import remade, room_check
from remqa_data.generators.audit.verify import verify
from remqa_data.generators.config import stored_config
from remqa_data.generators.scene_plan import Job
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows
from remqa_data.tables.rows import Row
from remqa_data.tables.schema import TABLES
from tests.helpers.forgeries import Copy, Forgery, forgeries

FORGERIES = list(forgeries())


def test_there_are_lies_about_every_table_and_file() -> None:
    assert len({forgery.name for forgery in FORGERIES}) == len(FORGERIES) >= 150
    told = Counter(forgery.what for forgery in FORGERIES)
    assert all(told[what] >= 10 for what in (*TABLES, "manifest.json", "README.md", "croissant.json", "folder"))


@pytest.fixture(scope="module")
def made_once(one_room: Path) -> Callable[[Job], Any]:
    """`make_room`, which remembers what it made of the room of the dataset as it is."""
    manifest = load_manifest(one_room)
    config = stored_config(manifest.config)
    rows: dict[str, list[Row]] = {t: list(read_rows(one_room, spec.row_type, "test")) for t, spec in TABLES.items()}  # type: ignore[type-var]
    real = remade.make_room

    def make_room(job: Job) -> tuple[dict[str, list[Row]], dict[str, Any]]:
        return (rows, {"refused": manifest.refused}) if job.config == config else real(job)

    return make_room


@pytest.mark.slow
@pytest.mark.parametrize("forgery", FORGERIES, ids=[forgery.name for forgery in FORGERIES])
def test_a_forged_dataset_is_found(
    forgery: Forgery,
    one_room: Path,
    made_once: Callable[[Job], Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By what the dataset says of itself, or by comparing its rows with those that the configuration makes.

    That this makes the rows that are stored, and what replaying and drawing find, is tested in `test_verify`.
    """
    monkeypatch.setattr(remade, "make_room", made_once)
    monkeypatch.setattr(room_check, "_configurations", lambda check, rows: ())
    copy = Copy(one_room, tmp_path / "forged")
    forgery.tell(copy)
    assert is_found(copy.root)


def is_found(root: Path) -> bool:
    """Whether a check fails, or says in one line that this is no dataset; anything else is a traceback."""
    try:
        return bool(verify(root).failures)
    except RemqaError:
        return True
