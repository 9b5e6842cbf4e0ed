"""Lets the tests of this folder import its helpers, and share loaded rooms; nothing runs without the extra `thor`."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("ai2thor")

from remqa_data.thor import Controller

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def kitchen_controller() -> Iterator[Controller]:
    with Controller(scene="FloorPlan1") as controller:
        yield controller


@pytest.fixture
def kitchen(kitchen_controller: Controller) -> Controller:
    """FloorPlan1 as it was loaded, with all default settings."""
    kitchen_controller.initialization_parameters = {}
    kitchen_controller.reset("FloorPlan1", width=300, height=300)
    return kitchen_controller


@pytest.fixture
def armed(kitchen: Controller) -> Controller:
    """FloorPlan1 with an agent that has an arm."""
    kitchen.reset(agentMode="arm")
    return kitchen
