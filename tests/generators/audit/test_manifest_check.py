"""What may lie in a dataset's folder besides what its manifest lists."""

from pathlib import Path

import pytest

from remqa_data.generators.audit.manifest_check import folder_failures
from remqa_data.storage.manifest import load_manifest


@pytest.mark.slow
@pytest.mark.parametrize(
    "path",
    [
        *(".lock", ".lock/0b5e6d1c", ".gitattributes", ".git/HEAD", ".cache/huggingface/x", "questions/.gitignore"),
        *(".DS_Store", "questions/.DS_Store", "Thumbs.db"),
    ],
)
@pytest.mark.parametrize("content", ["", "import os"])
def test_only_what_other_programs_leave_is_no_failure(dataset: Path, path: str, content: str) -> None:
    stray = dataset / path
    stray.parent.mkdir(exist_ok=True, parents=True)
    stray.write_text(content)
    is_fine = not content if path.startswith(".lock") else path != "questions/.gitignore"
    assert [failure.where for failure in folder_failures(dataset, load_manifest(dataset))] == [path] * (not is_fine)
