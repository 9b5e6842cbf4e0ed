"""Films that cannot be written whole; that they can is in `test_env`."""

import os
import resource
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from remqa_data.env import video as play
from remqa_data.errors import OutputError
from remqa_data.generators.figures.asset_sheets import write_sheets

FRAMES, FILM_BYTES = 30, 40_000


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
    monkeypatch.setattr(play, "film", lambda *asked: iter(frames))


@pytest.mark.slow
@pytest.mark.usefixtures("noise")
def test_a_whole_film_gets_its_name(tmp_path: Path) -> None:
    assert play.write_film(tmp_path, "Q", tmp_path / "film.mp4") == FRAMES
    assert (tmp_path / "film.mp4").stat().st_size > FILM_BYTES


@pytest.mark.slow
@pytest.mark.usefixtures("noise")
@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_browsers_can_play_a_film(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"film{suffix}"
    play.write_film(tmp_path, "Q", path)
    reader = cv2.VideoCapture(str(path))
    assert int(reader.get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little") == b"VP90"
    _, first = reader.read()
    rng = np.random.default_rng(0)
    shown = rng.integers(0, 256, (64, 96, 3), dtype=np.uint8)[..., ::-1]
    assert np.corrcoef(first.ravel(), shown.ravel())[0, 1] > 0.5
    if suffix == ".mp4":
        # The record of https://www.webmproject.org/vp9/mp4: profile 0 (8 bits, 4:2:0) is what all browsers decode.
        record = path.read_bytes().partition(b"vpcC")[2]
        assert (record[4], record[6] >> 4, record[6] >> 1 & 7) in ((0, 8, 0), (0, 8, 1))


@pytest.mark.usefixtures("noise")
def test_another_kind_of_film_is_refused_before_anything_is_drawn(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"film\.avi: give a name that ends with \.mp4, \.webm or \.webp"):
        play.write_film(tmp_path, "Q", tmp_path / "film.avi")


@pytest.mark.slow
@pytest.mark.usefixtures("noise")
def test_a_film_in_large_letters_is_one_and_opencv_says_nothing(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for name in ("film.WEBM", "film.MP4", "film.WEBP"):
        assert play.write_film(tmp_path, "Q", tmp_path / name) == FRAMES
    assert capfd.readouterr().err == ""


def test_stderr_is_heard_again_whatever_happens(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(OSError, match="no film"), play._without_stderr():  # noqa: PT012
        os.write(2, b"tag")
        raise OSError("no film")
    os.write(2, b"heard")
    assert capfd.readouterr().err == "heard"


@pytest.mark.usefixtures("noise")
def test_a_film_can_be_a_picture_that_moves(tmp_path: Path) -> None:
    path = tmp_path / "film.webp"
    assert play.write_film(tmp_path, "Q", path) == FRAMES
    is_readable, shown = cv2.imreadanimation(str(path))
    assert is_readable
    assert shown.loop_count == 0  # for ever
    assert list(shown.durations) == [1000 // play.FRAMES_PER_S] * FRAMES
    first = np.random.default_rng(0).integers(0, 256, (64, 96, 3), dtype=np.uint8)[..., ::-1]
    assert np.corrcoef(shown.frames[0][..., :3].ravel(), first.ravel())[0, 1] > 0.5


@pytest.mark.slow
@pytest.mark.usefixtures("noise", "small_disk")
@pytest.mark.parametrize("suffix", [".mp4", ".webp"])
def test_a_film_on_a_full_disk_is_an_error_and_leaves_the_old_one(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"old")
    with pytest.raises(OutputError, match=rf"film\{suffix}: the film could not be written whole; is the disk full"):
        play.write_film(tmp_path, "Q", path)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("small_disk")
def test_a_sheet_on_a_full_disk_is_an_error_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="File too large"):
        write_sheets(tmp_path, ["Mug"], columns=4)
    assert list(tmp_path.iterdir()) == []
