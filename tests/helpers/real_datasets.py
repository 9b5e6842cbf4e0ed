"""Configurations of small real datasets, and how all processes of one run of pytest share what is made of them."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock

from remqa_data.generators.config import Config, load_config

CONFIGS = Path(__file__).parents[2] / "configs"
NONE = dict.fromkeys(("EXISTENCE", "COUNTING", "SPATIAL"), 0)


def one_room_config() -> Config:
    """Only the test room of configs/tiny.yaml."""
    return _tiny(("FloorPlan27",), **NONE)


def two_rooms_config() -> Config:
    """Its living room with fewer questions, and its test room."""
    return _tiny(("FloorPlan212", "FloorPlan27"), EXISTENCE=4, COUNTING=0, SPATIAL=4)


def _tiny(scenes: tuple[str, ...], **train: int) -> Config:
    config = load_config(CONFIGS / "tiny.yaml")
    questions = config.questions.model_copy(update={"train": config.questions.train.model_copy(update=train)})
    return config.model_copy(update={"scenes": scenes, "questions": questions})


def made_once(folders: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder for all processes of this run of pytest: the first that asks for it makes it, the others wait."""
    base = folders.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder, half_made = shared / name, shared / f"{name}-half-made"
    with FileLock(shared / f"{name}.lock"):
        if not folder.exists():
            shutil.rmtree(half_made, ignore_errors=True)  # of a process that failed
            make(half_made)
            half_made.rename(folder)
    return folder
