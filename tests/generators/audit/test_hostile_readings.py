"""What simulates rooms, given a real one that somebody forged: it refuses it in one line, or is unharmed, and soon done.

The cases for all readers that only read are in `tests/storage/test_forged_rows.py`.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from remqa_data.env.video import film
from remqa_data.storage.shards import read_table
from tests.helpers.forged_rows import forge, forgeries
from tests.helpers.hostile_reading import SLOW, ReadingProcess

pytestmark = pytest.mark.slow

CASES = {forgery.name: forgery for forgery in forgeries()}
READERS = ("env", "eval", "show", "verify")
SHOWN = ("recount", "browse", "coco", "rerun")


@pytest.fixture(scope="module")
def reading() -> Iterator[ReadingProcess]:
    made = ReadingProcess()
    yield made
    made.close()


@pytest.mark.parametrize("reader", ["env", "eval", "show", *SHOWN])
def test_an_honest_dataset_is_read_to_the_end(
    reader: str, one_room: Path, tmp_path: Path, reading: ReadingProcess
) -> None:
    """Else a refusal below would show nothing; that it is verified is tested in `test_verify`."""
    outcome = reading.attempt(SLOW[reader], Path(shutil.copytree(one_room, tmp_path / "copy")))
    assert outcome.kind == "whole", outcome


@pytest.mark.parametrize(
    "name",
    [
        "scenes.scene_json: bounds of 10 km",
        "scenes.scene_json: 3,000 objects",
        "scenes.scene_json: a size of nan",
        "scenes.scene_json: an object turned by nothing",
        "scenes.embodiment.reach_m: nan",
        "questions.initial_pose.yaw_deg: nan",
    ],
)
def test_a_forged_room_is_refused_or_harmless(
    name: str, one_room: Path, tmp_path: Path, reading: ReadingProcess
) -> None:
    forged = forge(one_room, tmp_path / "forged", CASES[name])
    outcomes = {reader: reading.attempt(SLOW[reader], forged) for reader in READERS}
    assert all(outcome.held for outcome in outcomes.values()), outcomes
    assert outcomes["env"].kind == "refused"
    assert all("\n" not in outcome.said for outcome in outcomes.values())


@pytest.mark.parametrize(
    ("name", "refusing"),
    [
        ("questions.program: unknown", {"recount"}),  # its page shows no steps
        ("questions.object_ids: empty", {"recount"}),
        ("questions.target_id: unknown", {"recount"}),
        ("questions.scene: unknown", {"recount"}),
        ("questions.path_steps: the most", set()),
        ("frames.objects: empty", {"coco", "rerun"}),
        ("frames.added_nodes: empty", {"rerun"}),
        ("expressions.frame_id: unknown", {"recount", "coco"}),
    ],
)
def test_what_counts_shows_and_exports_refuses_a_row_that_does_not_fit_or_is_unharmed(
    name: str, refusing: set[str], one_room: Path, tmp_path: Path, reading: ReadingProcess
) -> None:
    forged = forge(one_room, tmp_path / "forged", CASES[name])
    outcomes = {reader: reading.attempt(SLOW[reader], forged) for reader in SHOWN}
    assert all(outcome.held for outcome in outcomes.values()), outcomes
    assert {reader for reader, outcome in outcomes.items() if outcome.kind == "refused"} == refusing, outcomes
    assert all("\n" not in outcome.said for outcome in outcomes.values())


def test_a_dataset_without_a_train_split_has_films(one_room: Path) -> None:
    question_id = read_table(one_room, "questions", "test", ["question_id"])["question_id"][0].as_py()
    frames = film(one_room, question_id)
    assert next(frames).ndim == 3
    frames.close()
