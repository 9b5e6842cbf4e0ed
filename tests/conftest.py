"""Gives tests small datasets, each made once for all processes of a run, and hypothesis its profile."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:
    # Several processes share the cores. Threads of torch that wait for each other by spinning take them from all: a network
    # that learns in 10 seconds alone took 100. Before anything is imported that reads this.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from typer import testing

from remqa_data.evaluation.scoring import kept_results
from remqa_data.storage.manifest import Manifest, load_manifest
from tests.helpers.dataset_rows import write_dataset
from tests.helpers.real_datasets import made_once, one_room_config, two_rooms_config
from tests.helpers.small_rooms import write_small_rooms

# How long an example takes says something about what else the machine does, and nothing about the code.
settings.register_profile("own", deadline=None)
# In CI the same examples every time: a red run says something about the change, and is repeated at will.
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "own")


@pytest.fixture(scope="session", autouse=True)
def no_power_cut() -> Iterator[None]:
    """No test waits for what only a power cut would take away: 4 ms for a file that is written, and 3 when it goes again."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(os, "fsync", os.fstat)  # which fails, too, where there is no such file
        yield


@pytest.fixture(scope="session", autouse=True)
def scores_of_this_run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What was scored before a run is not known to it, and what it scores is forgotten."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        folder = tmp_path_factory.mktemp("kept")
        monkeypatch.setattr(kept_results, "cache_folder", lambda: folder)
        yield


@pytest.fixture(scope="session", autouse=True)
def commands_put_together_once() -> Iterator[None]:
    """A command line is put together once for all tests that call it, as it is in a program: 25 ms each time."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(testing, "_get_command", cache(testing._get_command))
        yield


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Manifest]:
    """A small dataset of made-up rows, and its manifest. Not to be changed."""
    root = made_once(tmp_path_factory, "made-up", write_dataset)
    return root, load_manifest(root)


@pytest.fixture
def dataset(finished: tuple[Path, Manifest], tmp_path: Path) -> Path:
    """The same, for a test to damage."""
    return Path(shutil.copytree(finished[0], tmp_path / "copy"))


@pytest.fixture(scope="session")
def one_room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A real dataset of one room: 4 configurations, 16 frames, 12 questions. Not to be changed."""
    from remqa_data.generators.pipeline import generate

    return made_once(tmp_path_factory, "one-room", lambda out: generate(out, one_room_config()))


@pytest.fixture(scope="session")
def two_rooms(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """8 questions in the train split and 12 in the test split, in two real rooms. Not to be changed."""
    from remqa_data.generators.pipeline import generate

    return made_once(tmp_path_factory, "two-rooms", lambda out: generate(out, two_rooms_config()))


@pytest.fixture(scope="session")
def small_rooms(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two rooms of a few square metres with questions about a fridge. Not to be changed."""
    return made_once(tmp_path_factory, "small-rooms", write_small_rooms)


@pytest.fixture(scope="session")
def small_views(small_rooms: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Their cached views, 24 x 24. Not to be changed."""
    from remqa_data.views.build import Wanted, cache_views

    return made_once(tmp_path_factory, "small-views", lambda out: cache_views(small_rooms, out, Wanted(size_px=24)))


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """A browser, one for all tests of a process: Playwright allows no second one beside it."""
    playwright = pytest.importorskip("playwright.sync_api")
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no Chromium")
    with playwright.sync_playwright() as started:
        arguments = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]  # 3D without a GPU
        browser = started.chromium.launch(executable_path=path, args=arguments)
        yield browser
        browser.close()
