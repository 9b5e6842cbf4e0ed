"""Rooms that the tests of this folder share; nothing runs without the extra `thor`."""

from collections.abc import Iterator

import pytest

pytest.importorskip("ai2thor")

from remqa_data.thor import Controller
from tests.helpers.thor_arm import BEFORE_APPLE


@pytest.fixture(scope="session")
def kitchen_controller() -> Iterator[Controller]:
    with Controller(scene="FloorPlan1") as controller:
        yield controller


@pytest.fixture
def kitchen(kitchen_controller: Controller) -> Controller:
    """FloorPlan1 as it was loaded, with all default settings."""
    kitchen_controller.initialization_parameters = {}
    kitchen_controller.step("ChangeQuality", quality="Ultra", renderImage=False)  # it stays over resets
    kitchen_controller.reset("FloorPlan1", width=300, height=300)
    return kitchen_controller


@pytest.fixture
def armed(kitchen: Controller) -> Controller:
    """FloorPlan1 with an agent that has an arm."""
    kitchen.reset(agentMode="arm")
    return kitchen


@pytest.fixture
def before_apple(armed: Controller) -> Controller:
    """The same, before an apple."""
    assert armed.step("TeleportFull", **BEFORE_APPLE)
    return armed
