"""Small datasets: one of made-up questions that cannot be replayed, and one of two real rooms."""

from pathlib import Path

import pytest

from tests.helpers.dataset_rows import write_dataset


@pytest.fixture(scope="session")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """10 questions in the test split, none of which can be replayed."""
    root = tmp_path_factory.mktemp("data")
    write_dataset(root)
    return root


@pytest.fixture(scope="session")
def rooms(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """8 questions in the train split and 12 in the test split, in two rooms that can be replayed."""
    from remqa_data.generators.config import load_config
    from remqa_data.generators.pipeline import generate

    config = load_config(Path(__file__).parents[2] / "configs" / "tiny.yaml")
    few = config.questions.train.model_copy(update={"EXISTENCE": 4, "COUNTING": 0, "SPATIAL": 4})
    questions = config.questions.model_copy(update={"train": few})
    root = tmp_path_factory.mktemp("rooms")
    generate(root, config.model_copy(update={"scenes": ("FloorPlan212", "FloorPlan27"), "questions": questions}))
    return root
