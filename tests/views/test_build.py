"""Caches of views: what is in them, what happens when they are interrupted, damaged, or of something else."""

import json
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from typer.testing import CliRunner, Result

from remqa_data.cli import app
from remqa_data.errors import BusyDatasetError, ConfigError, DatasetError, UnknownNameError
from remqa_data.processes.executors import LocalExecutor
from remqa_data.storage.folder import Folder
from remqa_data.storage.locks import exclusive
from remqa_data.views import build
from remqa_data.views.build import Wanted, cache_views
from remqa_data.views.manifest import MANIFEST, NOTE, load_views_manifest
from remqa_data.views.reader import Views
from tests.helpers.damaged_files import files_of
from tests.helpers.small_network import brightness, features
from tests.helpers.small_rooms import write_small_rooms

pytestmark = pytest.mark.slow

SIZE = 24
NETWORK = "tests.helpers.small_network"


class StopsAfter:
    """An executor that is interrupted when so many jobs are done."""

    def __init__(self, count: int) -> None:
        self.count = count

    def run(self, work: Callable[[Any], Any], jobs: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
        for number, job in enumerate(jobs):
            if number == self.count:
                raise KeyboardInterrupt
            yield job, work(job)


def command(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["cache", *map(str, arguments)])


@pytest.fixture
def copy(small_views: Path, tmp_path: Path) -> Path:
    """A cache to change."""
    return Path(shutil.copytree(small_views, tmp_path / "copy"))


@pytest.mark.parametrize("scene", ["../Small1", "/tmp/Small1", "", ".", "a/b", "Small1\n"])
def test_a_room_that_is_called_like_another_place_is_refused(
    small_rooms: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scene: str
) -> None:
    real = build.read_table

    def renamed(root: Path, table: str, split: str, columns: list[str]) -> pa.Table:
        rows = real(root, table, split, columns)
        return rows.set_column(0, "scene", pa.array([scene] * len(rows)))

    monkeypatch.setattr(build, "read_table", renamed)
    with pytest.raises(DatasetError, match="is no name of a room"):
        cache_views(small_rooms, tmp_path / "views", Wanted(size_px=32))
    assert not list(tmp_path.rglob("*.np*"))


def when_written(folder: Path) -> dict[str, int]:
    return {str(path.relative_to(folder)): path.stat().st_mtime_ns for path in folder.rglob("*.np*")}


def test_a_cache_has_every_configuration_that_is_asked_about(small_rooms: Path, small_views: Path) -> None:
    views = Views(small_views, small_rooms)
    rooms = {room.scene: room for room in views.manifest.rooms}
    assert sorted(rooms) == ["Small1", "Small2"]
    assert all(room.configurations == (0, 1) for room in rooms.values())
    first, second = (views.room("Small1", number) for number in (0, 1))
    assert first.states == second.states
    assert first.is_reachable.sum() + second.is_reachable.sum() == rooms["Small1"].frames
    assert not np.array_equal(first.is_reachable, second.is_reachable)
    assert first.frames.shape == (rooms["Small1"].states, SIZE, SIZE, 3)
    assert first.is_reachable.any()
    assert first.frames[first.is_reachable].any(axis=(1, 2, 3)).all()


def test_the_manifest_names_the_dataset_and_every_file_with_its_checksum(small_rooms: Path, small_views: Path) -> None:
    from remqa_data.storage.manifest import load_manifest

    manifest = load_views_manifest(small_views)
    assert manifest is not None
    assert manifest.is_finished
    assert manifest.origin.config_sha256 == load_manifest(small_rooms).config_sha256
    named = {file.path for room in manifest.rooms for file in room.files}
    found = {str(path.relative_to(small_views)) for path in small_views.rglob("*") if path.is_file()}
    assert named == found - {MANIFEST, *(f"{room.scene}/{NOTE}" for room in manifest.rooms)}
    assert manifest.rooms
    assert all(room.is_whole(small_views) for room in manifest.rooms)


def test_what_is_finished_is_kept_when_a_run_goes_on(small_rooms: Path, small_views: Path, tmp_path: Path) -> None:
    out = tmp_path / "views"
    with pytest.raises(KeyboardInterrupt):
        cache_views(small_rooms, out, Wanted(size_px=SIZE), StopsAfter(1))
    with pytest.raises(DatasetError, match="is not finished; run remqa-data cache again"):
        Views(out)
    before = when_written(out)
    assert {Path(name).parent.name for name in before} == {"Small1"}
    (out / "Small2").mkdir()
    (out / "Small2" / ".frames.0123456789ab.npy").write_bytes(b"half a file, as a killed run leaves it")
    cache_views(small_rooms, out, Wanted(size_px=SIZE))
    assert before.items() <= when_written(out).items()
    assert files_of(out) == files_of(small_views)


def test_a_run_that_is_killed_in_a_room_goes_on_to_the_same_bytes(
    small_rooms: Path, small_views: Path, tmp_path: Path
) -> None:
    out = tmp_path / "views"
    arguments = [str(small_rooms), "-o", str(out), "--size", str(SIZE), "--workers", "1"]
    line = [sys.executable, "-c", "from remqa_data.cli import main; main()", "cache", *arguments]
    for place in ("Small1/.frames.*", "Small2/.frames.*"):
        process = subprocess.Popen(line, stderr=subprocess.DEVNULL)
        while not list(out.glob(place)):
            assert process.poll() is None
            time.sleep(0.005)
        process.kill()
        assert process.wait() == -signal.SIGKILL
    before = when_written(out / "Small1")
    subprocess.run(line, check=True, stderr=subprocess.DEVNULL)
    assert before.items() <= when_written(out / "Small1").items()
    assert files_of(out) == files_of(small_views)


def test_the_bytes_do_not_depend_on_workers(small_rooms: Path, small_views: Path, tmp_path: Path) -> None:
    cache_views(small_rooms, tmp_path / "views", Wanted(size_px=SIZE), LocalExecutor(2))
    assert files_of(tmp_path / "views") == files_of(small_views)


@pytest.mark.parametrize("name", ["frames.npy", "configuration-1.npz"])
def test_a_damaged_room_is_made_again_and_no_other(small_rooms: Path, small_views: Path, copy: Path, name: str) -> None:
    path = copy / "Small2" / name
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    before = when_written(copy / "Small1")
    result = command(small_rooms, "-o", copy, "--size", SIZE, "--workers", 1)
    assert result.exit_code == 0, result.output
    assert when_written(copy / "Small1") == before
    assert files_of(copy) == files_of(small_views)


def test_rooms_and_configurations_are_added_to_a_cache(small_rooms: Path, small_views: Path, tmp_path: Path) -> None:
    out = tmp_path / "views"
    cache_views(small_rooms, out, Wanted(split="test", configurations=(1,), size_px=SIZE))
    alone = Views(out)
    assert [(room.scene, room.configurations) for room in alone.manifest.rooms] == [("Small2", (1,))]
    assert not alone.has("Small2", 0)
    with pytest.raises(DatasetError, match=r"Small2 has configurations \(1,\), not 0"):
        alone.room("Small2", 0)
    together = Views(small_views).room("Small2", 1)
    assert together.is_reachable.any()
    for state in np.flatnonzero(together.is_reachable).tolist():
        other = alone.room("Small2", 1).states.number(*together.states.pose(state))
        assert np.array_equal(alone.room("Small2", 1).frame(other), together.frame(state))  # type: ignore[arg-type]
    cache_views(small_rooms, out, Wanted(scenes=("Small2",), configurations=(0,), size_px=SIZE))
    cache_views(small_rooms, out, Wanted(split="train", size_px=SIZE))
    assert files_of(out) == files_of(small_views)


def test_a_view_is_not_copied_unless_its_configuration_shows_another(small_views: Path) -> None:
    views = Views(small_views)
    first, second = (views.room("Small1", number) for number in (0, 1))
    state = int(np.flatnonzero(first.is_reachable)[0])
    assert np.shares_memory(first.frame(state), first.frames)
    assert not first.frame(state).flags.writeable
    both = first.is_reachable & second.is_reachable
    other = [state for state in np.flatnonzero(both).tolist() if second.frame(state).flags.owndata]
    assert 0 < len(other) < both.sum()
    onto = np.zeros((SIZE, SIZE, 3), np.uint8)
    for state in other:
        assert not np.array_equal(first.frame(state), second.frame(state))
        second.draw(state, onto)
        assert np.array_equal(onto, second.frame(state))


def test_rooms_that_are_open_keep_no_file_open(small_views: Path) -> None:
    descriptors = Path("/dev/fd")
    before = len(list(descriptors.iterdir()))
    views = Views(small_views)
    rooms = [views.room(scene, number) for scene in ("Small1", "Small2") for number in (0, 1)]
    assert len(list(descriptors.iterdir())) == before
    assert all(room.frame(int(np.flatnonzero(room.is_reachable)[0])).any() for room in rooms)


# ---- what is refused


def test_a_cache_of_another_dataset_is_refused_in_one_line(copy: Path, tmp_path: Path) -> None:
    write_small_rooms(tmp_path / "other", seed=1)
    before = files_of(copy)
    result = command(tmp_path / "other", "-o", copy, "--size", SIZE)
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "is a cache of another dataset: its configuration is another" in result.stderr
    assert files_of(copy) == before
    with pytest.raises(DatasetError, match="another dataset"):
        Views(copy, tmp_path / "other")


@pytest.mark.parametrize(
    ("field", "value", "error"),
    [
        ("tables_sha256", "0" * 64, "its rooms or questions are others"),
        ("version", "0.0.1", "another version of remqa-data"),
        ("format_version", 0, "another format"),
        ("size_px", 32, "frames of another size"),
    ],
)
def test_a_cache_that_is_made_from_something_else_says_what(
    small_rooms: Path, copy: Path, field: str, value: object, error: str
) -> None:
    content = json.loads((copy / MANIFEST).read_text())
    content["origin"][field] = value
    (copy / MANIFEST).write_text(json.dumps(content))
    with pytest.raises(DatasetError, match=error):
        cache_views(small_rooms, copy, Wanted(size_px=SIZE))


def test_another_folder_is_left_as_it_is(small_rooms: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(DatasetError, match="is not empty and no cache of views"):
        cache_views(small_rooms, tmp_path)
    with pytest.raises(DatasetError, match="is a file"):
        cache_views(small_rooms, tmp_path / "mine.txt")
    with pytest.raises(DatasetError, match="is no cache of views; make one"):
        Views(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_two_runs_do_not_write_the_same_cache(small_rooms: Path, copy: Path) -> None:
    with exclusive(Folder(copy)), pytest.raises(BusyDatasetError):
        cache_views(small_rooms, copy, Wanted(size_px=SIZE))


@pytest.mark.parametrize(
    ("wanted", "error", "match"),
    [
        (Wanted(scenes=("Smal1",)), UnknownNameError, "did you mean 'Small1'"),
        (Wanted(split="val"), ConfigError, "no split 'val'; it has: train, test"),
        (Wanted(configurations=(7,)), ConfigError, "nothing is asked"),
        (Wanted(size_px=8), ConfigError, "from 16 to 256"),
        (Wanted(features="nobody.home:features"), ConfigError, "nobody"),
        (Wanted(features="features"), ConfigError, "module:function"),
        (Wanted(features=f"{NETWORK}:NO_FUNCTION"), ConfigError, "this is a int, no function"),
    ],
)
def test_what_cannot_be_cached_is_told_before_anything_is_drawn(
    small_rooms: Path, tmp_path: Path, wanted: Wanted, error: type[Exception], match: str
) -> None:
    with pytest.raises(error, match=match):
        cache_views(small_rooms, tmp_path / "views", wanted)
    assert not list((tmp_path / "views").rglob("*.np*"))


@pytest.mark.parametrize("path", ["../outside.npy", "Small2/frames.npy", "/etc/passwd", "Small1/../x", "Small1/.x"])
def test_a_manifest_that_names_other_places_is_refused(copy: Path, path: str) -> None:
    content = json.loads((copy / MANIFEST).read_text())
    content["rooms"][0]["files"][0]["path"] = path
    (copy / MANIFEST).write_text(json.dumps(content))
    with pytest.raises(DatasetError, match="is no file of room 'Small1'"):
        Views(copy)


@pytest.mark.parametrize("name", ["frames.npy", "configuration-0.npz", "pixels.npy"])
def test_a_file_that_cannot_be_read_is_named(copy: Path, name: str) -> None:
    path = copy / "Small1" / name
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(DatasetError, match=rf"{name}: .*; run remqa-data cache again"):
        Views(copy).room("Small1", 0)
    path.unlink()
    with pytest.raises(DatasetError, match=rf"{name}: the file is missing; run remqa-data cache again"):
        Views(copy).room("Small1", 0)


# ---- features


def test_features_of_a_network_are_kept_beside_the_frames(small_rooms: Path, small_views: Path, copy: Path) -> None:
    pytest.importorskip("torch")
    before = when_written(copy)
    result = command(small_rooms, "-o", copy, "--size", SIZE, "--features", f"{NETWORK}:features", "--workers", 1)
    assert result.exit_code == 0, result.output
    assert before.items() <= when_written(copy).items()
    for number in (0, 1):
        room = Views(copy, small_rooms).room("Small1", number)
        assert room.features is not None
        assert room.features.dtype == np.float16
        states = np.flatnonzero(room.is_reachable).tolist()
        frames = np.stack([room.frame(state) for state in states])
        assert room.features[states].astype(np.float64) == pytest.approx(features(frames), abs=1e-3)
        assert room.features[states].astype(np.float64).std(axis=0).max() > 1e-3
        assert not room.is_reachable.all()
        assert not room.features[~room.is_reachable].any()
    again = when_written(copy)
    cache_views(small_rooms, copy, Wanted(size_px=SIZE))
    assert when_written(copy) == again


def test_a_function_that_fails_is_one_line(small_rooms: Path, tmp_path: Path) -> None:
    wanted = Wanted(size_px=16, split="test", features="os:getcwd")
    with pytest.raises(ConfigError, match=r"^--features os:getcwd: TypeError: "):
        cache_views(small_rooms, tmp_path / "views", wanted)


def test_a_cache_has_the_features_of_one_function(small_rooms: Path, copy: Path) -> None:
    cache_views(small_rooms, copy, Wanted(scenes=("Small1",), size_px=SIZE, features=f"{NETWORK}:brightness"))
    views = Views(copy)
    assert views.room("Small2", 0).features is None
    with pytest.raises(DatasetError, match=r"has features of .*:brightness, not of .*:features"):
        cache_views(small_rooms, copy, Wanted(size_px=SIZE, features=f"{NETWORK}:features"))
    cache_views(small_rooms, copy, Wanted(size_px=SIZE))
    room = Views(copy).room("Small2", 1)
    assert room.features is not None
    state = int(np.flatnonzero(room.is_reachable)[-1])
    assert room.features[state] == pytest.approx(brightness(room.frame(state)[None])[0], rel=1e-3)


@pytest.mark.parametrize(
    ("name", "match"), [("too_large", "float16 does not hold"), ("one_for_all", r"\(1, 2\) for 64")]
)
def test_a_function_that_gives_something_else_is_named(small_rooms: Path, copy: Path, name: str, match: str) -> None:
    with pytest.raises(ConfigError, match=rf"{name}: gave .*{match}"):
        cache_views(small_rooms, copy, Wanted(size_px=SIZE, features=f"{NETWORK}:{name}"))
    assert not list(copy.rglob("features-*"))
    cache_views(small_rooms, copy, Wanted(size_px=SIZE))
    assert Views(copy).manifest.is_finished
