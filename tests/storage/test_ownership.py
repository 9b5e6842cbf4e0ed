"""Nothing is removed or written over that is not a dataset of ours, whatever the options; it is named instead."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from remqa_data.errors import DatasetError
from remqa_data.generators.pipeline import check_place
from remqa_data.storage.backend import storage_at
from remqa_data.storage.manifest import MARKER
from remqa_data.storage.ownership import clear, look, mark, remove_parts
from tests.helpers.damaged_files import files_of

HASH = "0123456789abcdef"
HALF_MADE = [
    f".parts/{HASH}/FloorPlan1/frames.train.parquet",
    f".parts/{HASH}/FloorPlan1/part.json",
    f".parts/{HASH}/FloorPlan1/.part.0123456789ab.json",
    "scenes/train-00000-of-00005.parquet",
    "scenes/.train-00001-of-00005.0123456789ab.parquet",
    "scenes/..train-00001-of-00005.0123456789ab.ba9876543210.parquet",
    ".manifest.0123456789ab.json",
]
STRANGE = [
    "thesis.txt",
    "sub/notes.md",
    "README.md",
    "scenes/mine.txt",
    "scenes/train.parquet",
    ".parts/mine",
    "a/manifest.json",
]


def put(root: Path, *paths: str) -> None:
    for path in paths:
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(b"precious")


@pytest.fixture
def half_made(tmp_path: Path) -> Path:
    """What a killed run leaves."""
    root = tmp_path / "half-made"
    mark(storage_at(root))
    put(root, *HALF_MADE)
    return root


def refused(root: Path, name: str) -> None:
    """Neither option takes the place, and all is as it was."""
    before = files_of(root)
    for options in ({"overwrite": True}, {"resume": True}, {}):
        with pytest.raises(DatasetError, match=f"holds .*{name}.*give another folder"):
            check_place(root, **{"overwrite": False, "resume": False, **options})
    assert files_of(root) == before


def test_an_empty_place_and_one_with_a_lock_are_taken(tmp_path: Path) -> None:
    for root in (tmp_path / "none", tmp_path):
        assert look(storage_at(root)).is_empty
    (tmp_path / ".lock").touch()
    assert look(storage_at(tmp_path)).is_empty


@pytest.mark.parametrize("name", [*STRANGE, ".lock", "manifest.json", "frames/train-00000-of-00001.parquet", MARKER])
def test_a_folder_of_somebody_else_is_refused(tmp_path: Path, name: str) -> None:
    put(tmp_path, name)
    refused(tmp_path, name)


@pytest.mark.parametrize("name", STRANGE)
def test_a_finished_dataset_with_something_else_in_it_is_refused(dataset: Path, name: str) -> None:
    put(dataset, name)
    refused(dataset, name)


def test_a_shard_that_the_manifest_does_not_list_is_somebody_elses(dataset: Path) -> None:
    put(dataset, "scenes/train-00007-of-00009.parquet")
    refused(dataset, "scenes/train-00007-of-00009.parquet")


@pytest.mark.parametrize("name", STRANGE)
def test_an_unfinished_dataset_with_something_else_in_it_is_refused(half_made: Path, name: str) -> None:
    put(half_made, name)
    refused(half_made, name)


def linked_folder(root: Path, precious: Path) -> str:
    shutil.rmtree(root / "frames", ignore_errors=True)
    (root / "frames").symlink_to(precious)
    return "frames"


def linked_file(root: Path, precious: Path) -> str:
    (root / "croissant.json").unlink(missing_ok=True)
    (root / "croissant.json").symlink_to(precious / "thesis.txt")
    return "croissant.json"


def pipe(root: Path, precious: Path) -> str:
    os.mkfifo(root / "pipe")
    return "pipe"


def empty_folder(root: Path, precious: Path) -> str:
    (root / "mine" / "too").mkdir(parents=True)
    return "mine/too/"


@pytest.mark.parametrize("make", [linked_folder, linked_file, pipe, empty_folder])
@pytest.mark.parametrize("state", ["dataset", "half_made"])
def test_links_and_what_is_no_file_are_refused(
    request: pytest.FixtureRequest, tmp_path: Path, state: str, make: Callable[[Path, Path], str]
) -> None:
    root, precious = request.getfixturevalue(state), tmp_path / "precious"
    put(precious, "thesis.txt")
    name = make(root, precious)
    with pytest.raises(DatasetError, match=f"holds {name}: no part of a dataset of ours"):
        look(storage_at(root))
    clear(storage_at(root))  # even if somebody did not look
    assert (precious / "thesis.txt").read_bytes() == b"precious"
    assert os.path.lexists(root / name) or name == "croissant.json"


@pytest.mark.slow
@pytest.mark.skipif(
    shutil.which("unshare") is None or subprocess.run(["unshare", "-rm", "true"], check=False).returncode != 0,
    reason="needs a mount namespace of its own",
)
def test_mounted_folders_are_not_gone_into(half_made: Path, tmp_path: Path) -> None:
    precious, name = tmp_path / "precious", "train-00000-of-00001.parquet"
    put(precious, name)
    (half_made / "frames").mkdir()
    program = (
        "import sys; from remqa_data.storage.ownership import *; from remqa_data.storage.backend import storage_at; "
    )
    program += "place = storage_at(sys.argv[1]); clear(place); print(place.oddities()); look(place)"
    script = f'mount --bind {precious} {half_made}/frames && {sys.executable} -c "{program}" {half_made}'
    done = subprocess.run(["unshare", "-rm", "sh", "-c", script], text=True, capture_output=True, check=False)
    assert "['frames']" in done.stdout, done.stderr
    assert "holds frames: no part of a dataset of ours" in done.stderr
    assert (precious / name).read_bytes() == b"precious"


def test_a_dataset_of_ours_is_cleared_but_for_marker_and_what_came_meanwhile(dataset: Path, half_made: Path) -> None:
    for root in (dataset, half_made):
        storage = storage_at(root)
        assert not look(storage).is_empty
        mark(storage)
        put(root, "scenes/mine.txt", f".parts/{HASH}/mine.txt")
        clear(storage)
        assert sorted(files_of(root)) == [f".parts/{HASH}/mine.txt", MARKER, "scenes/mine.txt"]
        remove_parts(storage)
        assert sorted(files_of(root)) == [f".parts/{HASH}/mine.txt", "scenes/mine.txt"]


def test_an_edited_card_is_still_ours_and_another_is_not(dataset: Path) -> None:
    card = dataset / "README.md"
    card.write_text(card.read_text() + "\nWe changed nothing else.\n")
    assert look(storage_at(dataset)).is_finished
    card.write_text("# My notes\n")
    refused(dataset, "README.md")


def test_no_dataset_is_made_inside_another(finished, tmp_path: Path) -> None:
    root = tmp_path / "outer"
    shutil.copytree(finished[0], root)
    for inner in (root / "sub", root / "scenes" / "deep" / "er"):
        with pytest.raises(
            DatasetError, match=r"is in the dataset .*outer, which holds nothing else; give another folder"
        ):
            check_place(inner, overwrite=False, resume=False)
    put(tmp_path / "page", "manifest.json")  # as web pages have
    check_place(tmp_path / "page" / "data", overwrite=False, resume=False)
