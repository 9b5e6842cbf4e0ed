"""A row that no generation writes is an error on purpose, in whatever reads it, and takes little time and memory."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from remqa_data.errors import ForgedRowError, RemqaError
from remqa_data.storage.manifest import Manifest
from remqa_data.storage.shards import read_rows
from remqa_data.tables.images import ImageFormatError, decode_rgb, encode_rgb, image_size
from remqa_data.tables.rows import QuestionRow
from tests.helpers import hostile_reading
from tests.helpers.forged_rows import IMAGES, Forgery, forge, image_forgeries, schema_forgeries
from tests.helpers.hostile_reading import QUICK, READERS, ReadingProcess, read_rows_of

pytestmark = pytest.mark.slow

pytest.importorskip("remqa_data.datasets.torch_datasets")  # before the forks, which would each import it

CASES = {forgery.name: forgery for forgery in (*schema_forgeries(), *image_forgeries())}


@pytest.fixture(scope="module")
def reading() -> Iterator[ReadingProcess]:
    made = ReadingProcess()
    yield made
    made.close()


def read_forged(root: Path, out: Path, forgery: Forgery, reading: ReadingProcess) -> None:
    """By everything that reads, but for the rows of other tables, which are those of the dataset as it was."""
    forged = forge(root, out, forgery)
    for name, reader in (QUICK | {"rows": partial(read_rows_of, forgery.table)}).items():
        outcome = reading.attempt(reader, forged)
        assert outcome.held, f"{name}: {outcome}"
        assert "\n" not in outcome.said
        assert len(outcome.said) < 1000


def test_what_nobody_forged_is_read_to_the_end(finished: tuple[Path, Manifest], reading: ReadingProcess) -> None:
    assert QUICK
    for name, reader in QUICK.items():
        assert reading.attempt(reader, finished[0]).kind == "whole", name


def test_there_are_enough_cases() -> None:
    assert len(CASES) > 400
    assert len(READERS) >= 9


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_forged_row_is_refused_or_harmless(
    name: str, finished: tuple[Path, Manifest], tmp_path: Path, reading: ReadingProcess
) -> None:
    read_forged(finished[0], tmp_path / "forged", CASES[name], reading)


def test_the_error_names_the_file_the_row_and_the_field(finished: tuple[Path, Manifest], tmp_path: Path) -> None:
    root = forge(finished[0], tmp_path / "forged", CASES["questions.initial_pose.yaw_deg: nan"])
    with pytest.raises(ForgedRowError) as caught:
        list(read_rows(root, QuestionRow, "test"))
    assert (caught.value.row, caught.value.field) == (0, "initial_pose.yaw_deg")
    assert str(caught.value).startswith(f"{root}/questions/test-00000")
    assert "nan; expected -720 to 720" in str(caught.value)


@pytest.mark.parametrize(("what", "image"), IMAGES)
def test_an_image_that_is_none_or_too_large_is_refused_before_it_is_decoded(what: str, image) -> None:
    data = image()
    if what == "a PNG of one bit":  # which is fine as a picture
        assert decode_rgb(data).shape == (300, 300, 3)
        return
    if what != "a PNG cut off":  # of a size that may be
        size = image_size(data)
        assert size is None or min(size) == 0 or max(size) > 4096
    with pytest.raises(ImageFormatError):
        decode_rgb(data)


@pytest.mark.parametrize("form", ["jpeg", "png"])
def test_the_size_of_an_image_is_read_from_its_first_bytes(form) -> None:
    assert image_size(encode_rgb(np.zeros((7, 12, 3), np.uint8), form=form).bytes) == (12, 7)


def test_a_missing_row_is_no_stack_trace(finished: tuple[Path, Manifest]) -> None:
    with pytest.raises(RemqaError):
        list(read_rows(finished[0], QuestionRow, "nobody"))


@pytest.mark.slow
def test_what_reads_is_measured_stopped_and_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hostile_reading, "WALL_S", 3)
    reading = ReadingProcess()
    try:
        for reader in (hostile_reading.read_for_ever, hostile_reading.read_to_death):
            outcome = reading.attempt(reader, tmp_path)
            assert (outcome.kind, outcome.held) == ("killed", False)
        wrong = reading.attempt(hostile_reading.read_wrongly, tmp_path)
        assert (wrong.kind, wrong.held) == ("raw", False)
        refused = reading.attempt(hostile_reading.read_rows_, tmp_path)
        assert (refused.kind, refused.held) == ("refused", True)
    finally:
        reading.close()
