"""Gives tests a small dataset."""

import shutil
from pathlib import Path

import pytest

from remqa_data.storage.manifest import Manifest
from tests.helpers.dataset_rows import write_dataset


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Manifest]:
    """A small dataset of made-up rows, and its manifest."""
    root = tmp_path_factory.mktemp("finished")
    return root, write_dataset(root)


@pytest.fixture
def dataset(finished: tuple[Path, Manifest], tmp_path: Path) -> Path:
    """The same, for a test to damage."""
    return Path(shutil.copytree(finished[0], tmp_path / "copy"))
