"""Films that cannot be written whole; that they can is in `test_env`."""

import resource
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from remqa_data.env import video as play
from remqa_data.errors import OutputError
from remqa_data.generators.figures.asset_sheets import write_sheets

FRAMES, FILM_BYTES = 30, 50_000


@pytest.fixture
def small_disk() -> Iterator[None]:
    """No file can grow beyond a quarter of the film: to the writer, that is as if the disk were full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (FILM_BYTES // 4, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def noise(monkeypatch: pytest.MonkeyPatch) -> None:
    """Instead of an episode."""
    rng = np.random.default_rng(0)
    frames = [rng.integers(0, 256, (64, 96, 3), dtype=np.uint8) for _ in range(FRAMES)]
    monkeypatch.setattr(play, "film", lambda root, question_id: iter(frames))


@pytest.mark.usefixtures("noise")
def test_a_whole_film_gets_its_name(tmp_path: Path) -> None:
    assert play.write_film(tmp_path, "Q", tmp_path / "film.mp4") == FRAMES
    assert (tmp_path / "film.mp4").stat().st_size > FILM_BYTES


@pytest.mark.usefixtures("noise", "small_disk")
def test_a_film_on_a_full_disk_is_an_error_and_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    path.write_bytes(b"old")
    with pytest.raises(OutputError, match=r"film\.mp4: the film could not be written whole; is the disk full"):
        play.write_film(tmp_path, "Q", path)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("small_disk")
def test_a_sheet_on_a_full_disk_is_an_error_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="File too large"):
        write_sheets(tmp_path, ["Mug"], columns=4)
    assert list(tmp_path.iterdir()) == []
