"""Lies of every kind, told consistently, are found; and none ends in a traceback."""

from collections import Counter
from pathlib import Path

import pytest

from remqa_data.errors import RemqaError
from remqa_data.generators.audit import room_check
from remqa_data.generators.audit.verify import verify
from remqa_data.tables.schema import TABLES
from tests.helpers.forgeries import Copy, Forgery, forgeries
from tests.helpers.remade_rooms import RememberedRooms

FORGERIES = list(forgeries())


def test_there_are_lies_about_every_table_and_file() -> None:
    assert len({forgery.name for forgery in FORGERIES}) == len(FORGERIES) >= 150
    told = Counter(forgery.what for forgery in FORGERIES)
    assert all(told[what] >= 10 for what in (*TABLES, "manifest.json", "README.md", "croissant.json", "folder"))


@pytest.fixture(scope="module")
def remembered(one_room: Path) -> RememberedRooms:
    return RememberedRooms(one_room)


@pytest.mark.slow
@pytest.mark.parametrize("forgery", FORGERIES, ids=[forgery.name for forgery in FORGERIES])
def test_a_forged_dataset_is_found(
    forgery: Forgery, one_room: Path, remembered: RememberedRooms, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By what the dataset says of itself, or by comparing its rows with those that the configuration makes.

    That this makes the rows that are stored, and what replaying and drawing find, is tested in `test_verify`.
    """
    remembered.use(monkeypatch)
    monkeypatch.setattr(room_check, "_configurations", lambda check, rows: ())
    copy = Copy(one_room, tmp_path / "forged")
    forgery.tell(copy)
    assert is_found(copy.root)


@pytest.mark.slow
def test_what_nobody_forged_is_whole(
    one_room: Path, remembered: RememberedRooms, monkeypatch: pytest.MonkeyPatch
) -> None:
    remembered.use(monkeypatch)
    monkeypatch.setattr(room_check, "_configurations", lambda check, rows: ())
    assert not verify(one_room).failures


def is_found(root: Path) -> bool:
    """Whether a check fails, or says in one line that this is no dataset; anything else is a traceback."""
    try:
        return bool(verify(root).failures)
    except RemqaError:
        return True
