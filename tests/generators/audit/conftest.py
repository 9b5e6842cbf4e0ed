"""One real dataset for all tests that check datasets; making it takes longer than most of them."""

from pathlib import Path

import pytest

from remqa_data.generators.config import Config, load_config
from remqa_data.generators.pipeline import generate


def one_room_config() -> Config:
    """Only the test room of configs/tiny.yaml."""
    config = load_config(Path(__file__).parents[3] / "configs" / "tiny.yaml")
    none = config.questions.train.model_copy(update=dict.fromkeys(("EXISTENCE", "COUNTING", "SPATIAL"), 0))
    questions = config.questions.model_copy(update={"train": none})
    return config.model_copy(update={"scenes": ("FloorPlan27",), "questions": questions})


@pytest.fixture(scope="session")
def real_dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished dataset of one room: 4 configurations, 16 frames, 12 questions. Not to be changed."""
    folder = tmp_path_factory.mktemp("real") / "dataset"
    generate(folder, one_room_config())
    return folder
