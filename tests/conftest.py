"""Gives tests a small dataset, and hypothesis its profile."""

import os
import shutil
from pathlib import Path

import pytest
from hypothesis import settings

from remqa_data.storage.manifest import Manifest
from tests.helpers.dataset_rows import write_dataset

# In CI the same examples every time: a red run says something about the change, and is repeated at will.
settings.register_profile("ci", derandomize=True, print_blob=True)
if os.environ.get("CI"):
    settings.load_profile("ci")


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Manifest]:
    """A small dataset of made-up rows, and its manifest."""
    root = tmp_path_factory.mktemp("finished")
    return root, write_dataset(root)


@pytest.fixture
def dataset(finished: tuple[Path, Manifest], tmp_path: Path) -> Path:
    """The same, for a test to damage."""
    return Path(shutil.copytree(finished[0], tmp_path / "copy"))
