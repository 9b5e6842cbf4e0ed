"""Whatever breaks while a dataset is written: it ends in the dataset that it should be, or in an error that says why.

All runs are `remqa-gen` with rooms that are made up (see `crash_run`): in processes of their own where processes are killed,
else in this one.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import psutil
import pytest

from remqa_data.errors import DatasetError
from remqa_data.storage import manifest
from remqa_data.storage.manifest import MANIFEST, load_manifest
from tests.helpers import kill_runs
from tests.helpers.crash_run import SCENES, parts_in, run_here
from tests.helpers.damaged_files import damage, files_of
from tests.helpers.forked_runs import ForkedRun

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
PROGRAM = "tests.helpers.crash_run"
PATIENCE_S = 120.0


def start(out: Path, *options: str, **environment: str) -> subprocess.Popen[str]:
    """A program of its own, with two workers that are started as they always are."""
    arguments = [sys.executable, "-m", PROGRAM, "--scenes", str(SCENES), "--out", str(out), "--workers", "2"]
    return subprocess.Popen(
        [*arguments, *options],
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        cwd=ROOT,
        env={**os.environ, **environment},
    )


def fork(out: Path, *options: str, **environment: str) -> ForkedRun:
    """The same without imports."""
    arguments = ["--scenes", str(SCENES), "--out", str(out), "--workers", "2", *options]
    return ForkedRun(*arguments, output=out.with_suffix(".log"), **environment)


def last_line(text: str) -> str:
    return text.strip().splitlines()[-1]


def wait_until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.01)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset that nothing happened to."""
    out = tmp_path_factory.mktemp("whole") / "out"
    code, text = run_here(out)
    assert code == 0, text
    return out


@pytest.fixture
def dataset(whole: Path, tmp_path: Path) -> Path:
    """A copy of it, to be broken."""
    return Path(shutil.copytree(whole, tmp_path / "out"))


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What is left of a run of which the driver was killed; not to be changed."""
    out = tmp_path_factory.mktemp("left") / "out"
    process = fork(out, CRASH_ROOM_S="0.1")
    wait_until(lambda: len(parts_in(out)) >= 5)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    psutil.wait_procs(workers, timeout=PATIENCE_S)
    return out


@pytest.fixture
def killed(left: Path, tmp_path: Path) -> Path:
    """A copy of it, to go on with."""
    return Path(shutil.copytree(left, tmp_path / "out"))


# ---- killed


def test_a_killed_worker_is_replaced(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = start(out, CRASH_ROOM_S="0.1")
    wait_until(lambda: len(parts_in(out)) >= 3)
    workers = [child for child in psutil.Process(process.pid).children() if "spawn_main" in " ".join(child.cmdline())]
    assert len(workers) == 2
    workers[0].kill()
    text, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, text
    assert files_of(out) == files_of(whole)


def test_workers_that_always_die_end_the_run_with_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRASH_ALWAYS", "1")
    code, text = run_here(tmp_path / "out", workers=2)
    assert code == 2
    assert f"worker processes died 3 times with {SCENES} jobs to do" in last_line(text)
    assert "Traceback" not in text


def test_workers_end_when_the_driver_is_killed(tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = start(out, CRASH_ROOM_S="0.5")
    wait_until(lambda: len(parts_in(out)) >= 1)
    children = psutil.Process(process.pid).children(recursive=True)
    assert len(children) >= 2
    process.kill()
    process.communicate()
    _, alive = psutil.wait_procs(children, timeout=PATIENCE_S)
    assert not alive


def test_a_killed_run_does_not_look_finished_and_goes_on_where_it_was(whole: Path, killed: Path) -> None:
    with pytest.raises(DatasetError, match=r"not a finished dataset.*--resume"):
        load_manifest(killed)
    done = {path: path.stat().st_mtime_ns for path in parts_in(killed)}
    process = fork(killed, "--resume", CRASH_ROOM_S="0.2")
    wait_until(lambda: len(parts_in(killed)) > len(done))
    assert {path: path.stat().st_mtime_ns for path in done} == done
    process.wait(PATIENCE_S)
    assert files_of(killed) == files_of(whole)


def test_a_killed_run_is_not_gone_on_with_unasked(killed: Path) -> None:
    code, text = run_here(killed)
    assert code == 2
    assert "is not empty; use --resume" in last_line(text)
    code, text = run_here(killed, "--resume", "--overwrite")
    assert code == 2
    assert "give one of them" in text
    code, text = run_here(killed, "--resume", "--seed", "1")
    assert code == 2
    assert "scenes of another run" in last_line(text)


def test_rooms_of_other_versions_of_a_package_are_not_mixed(killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(manifest, "_version_of", lambda package: "9.9.9")
    code, text = run_here(killed, "--resume")
    assert code == 2
    assert "scenes of another run (other seed, configuration, templates, or version of Python" in last_line(text)


def test_rooms_of_other_templates_are_not_mixed(killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(manifest, "templates_sha256", lambda: "of other words")
    code, text = run_here(killed, "--resume")
    assert code == 2
    assert "scenes of another run (other seed, configuration, templates, " in last_line(text)


def test_a_dataset_of_other_templates_is_not_taken_for_the_one_that_is_asked_for(
    dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run_here(dataset, "--resume")[0] == 0
    monkeypatch.setattr(manifest, "templates_sha256", lambda: "of other words")
    code, text = run_here(dataset, "--resume")
    assert code == 2
    assert "a finished dataset of another configuration, seed, version or templates" in last_line(text)


def test_a_run_that_was_killed_after_the_manifest_is_tidied(dataset: Path, whole: Path) -> None:
    left = dataset / ".parts" / "0123456789abcdef" / "FloorPlan1" / "part.json"
    left.parent.mkdir(parents=True)
    left.touch()
    assert run_here(dataset, "--resume")[0] == 0
    assert files_of(dataset) == files_of(whole)


@pytest.mark.parametrize("seed", range(4))
def test_whenever_it_is_killed_the_bytes_are_the_same(whole: Path, tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    out = tmp_path / "out"
    for _ in range(2):
        process = fork(out, "--resume")
        kill_runs.kill_once(process, rng.uniform(0.1, 0.9), rng)
        process.wait()
    assert fork(out, "--resume").wait() == 0
    assert files_of(out) == files_of(whole)


# ---- broken


@pytest.mark.parametrize("how", ["torn", "flipped", "missing"])
def test_a_damaged_shard_is_told_and_replaced_on_request(dataset: Path, whole: Path, how: str) -> None:
    path = dataset / "frames" / "train-00002-of-00005.parquet"
    damage(path, how)
    code, text = run_here(dataset, "--resume")
    assert code == 2
    assert f"damaged shard: {path}" in last_line(text)
    assert "--overwrite" in last_line(text)
    assert run_here(dataset, "--overwrite")[0] == 0
    assert files_of(dataset) == files_of(whole)


@pytest.mark.parametrize("missing", [["README.md"], ["croissant.json"], ["README.md", "croissant.json"]])
def test_a_card_that_is_missing_is_written_again(dataset: Path, whole: Path, missing: list[str]) -> None:
    for name in missing:
        (dataset / name).unlink()
    assert run_here(dataset, "--resume")[0] == 0
    assert files_of(dataset) == files_of(whole)


def test_a_card_that_somebody_has_added_to_stays(dataset: Path) -> None:
    (dataset / "croissant.json").unlink()
    (dataset / "README.md").write_text((dataset / "README.md").read_text() + "Mine.")
    assert run_here(dataset, "--resume")[0] == 0
    assert (dataset / "README.md").read_text().endswith("Mine.")


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("versions", {"numpy": "2.0.0"}, "a finished dataset of another configuration, seed, version or templates"),
        ("questions", {"train": {"FOO": 3}}, "manifest.json: questions.train.FOO: the configuration asks for none"),
        (
            "questions",
            {"later": {"SPATIAL": 3}},
            "manifest.json: questions.later.SPATIAL: the configuration asks for none",
        ),
    ],
)
def test_a_manifest_that_was_changed_by_hand_is_told(dataset: Path, key: str, value: object, said: str) -> None:
    path = dataset / MANIFEST
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))
    code, text = run_here(dataset, "--resume")
    assert code == 2
    assert said in last_line(text)


@pytest.mark.parametrize("how", ["torn", "flipped", "missing"])
def test_a_damaged_part_is_told_and_made_again(killed: Path, whole: Path, how: str) -> None:
    path = parts_in(killed)[0].with_name("frames.train.parquet")
    damage(path, how)
    code, text = run_here(killed, "--resume")
    assert code == 2
    assert f"{path} is not as it was written; go on with remqa-gen --resume" in last_line(text)
    assert not (killed / MANIFEST).exists()
    assert run_here(killed, "--resume")[0] == 0
    assert files_of(killed) == files_of(whole)


# ---- two at once


@pytest.mark.parametrize("option", ["--resume", "--overwrite"])
def test_two_runs_into_one_folder(whole: Path, tmp_path: Path, option: str) -> None:
    out = tmp_path / "out"
    first = fork(out, CRASH_ROOM_S="0.2")
    wait_until(lambda: len(parts_in(out)) >= 1)
    code, text = run_here(out, option)
    assert code == 2
    assert "another run is writing here" in last_line(text)
    text, _ = first.communicate(timeout=PATIENCE_S)
    assert first.returncode == 0, text
    assert files_of(out) == files_of(whole)


# ---- no room, no right

in_a_namespace = pytest.mark.skipif(
    shutil.which("unshare") is None or subprocess.run(["unshare", "-rm", "true"], check=False).returncode != 0,
    reason="needs a mount namespace of its own",
)


def run_in_namespace(code: str) -> None:
    """Run Python code in a process that may mount what it likes."""
    imports = (
        "import os, shutil, subprocess; from pathlib import Path; from tests.helpers.crash_run import run_here\n"
        "def mount(*words): subprocess.run(['mount', *map(str, words)], check=True)\n"
    )
    command = ["unshare", "-rm", sys.executable, "-c", imports + code]
    done = subprocess.run(command, text=True, capture_output=True, cwd=ROOT, timeout=PATIENCE_S, check=False)
    assert done.returncode == 0, done.stderr


@in_a_namespace
def test_a_full_disk_is_told_and_the_run_goes_on_when_there_is_room(whole: Path, tmp_path: Path) -> None:
    """While rooms are made, and while they are merged."""
    run_in_namespace(f"""
for size_kb, rooms in ((400, range(1, {SCENES})), (3500, [{SCENES}])):
    disk, copy = Path({str(tmp_path)!r}, "disk"), Path({str(tmp_path)!r}, str(size_kb))
    disk.mkdir(exist_ok=True)
    mount("-t", "tmpfs", "-o", f"size={{size_kb}}k", "none", disk)
    code, text = run_here(disk / "out")
    assert code == 2 and "No space left on device" in text, text
    assert "manifest.json" not in os.listdir(disk / "out")
    assert len([*(disk / "out").glob(".parts/*/*/part.json")]) in rooms
    mount("-o", "remount,size=100m", disk)
    assert run_here(disk / "out", "--resume")[0] == 0
    shutil.copytree(disk / "out", copy)
""")
    assert files_of(tmp_path / "400") == files_of(tmp_path / "3500") == files_of(whole)


@in_a_namespace
def test_a_read_only_folder_is_told(dataset: Path, tmp_path: Path) -> None:
    run_in_namespace(f"""
empty, dataset = Path({str(tmp_path)!r}, "empty"), Path({str(dataset)!r})
empty.mkdir()
for folder in (empty, dataset):
    mount("--bind", folder, folder)
    mount("-o", "remount,ro,bind", folder)
for out, *options in ((empty,), (dataset, "--overwrite")):
    code, text = run_here(out, *options)
    assert code == 2 and "Read-only file system" in text, text
assert run_here(dataset, "--resume")[0] == 0  # it is finished already
""")
