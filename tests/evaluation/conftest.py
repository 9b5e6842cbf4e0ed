"""A small dataset whose questions cannot be replayed."""

from pathlib import Path

import pytest

from remqa_data.storage.manifest import Manifest


@pytest.fixture(scope="session")
def data(finished: tuple[Path, Manifest]) -> Path:
    """10 questions in the test split, none of which can be replayed."""
    return finished[0]
