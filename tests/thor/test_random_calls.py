"""Calls of all actions with arguments that fit and that do not: what comes of them is an event or a clear ValueError."""

import random

import pytest

from remqa_data.thor import Controller
from tests.helpers.random_calls import call_at_random

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("mode", ["default", "arm"])
def test_any_call_gives_an_event_or_a_clear_error(mode) -> None:
    with Controller(scene="FloorPlan401", agentMode=mode, width=64, height=64) as controller:
        outcomes = call_at_random(controller, random.Random(1), 150)
    assert min(outcomes.values()) > 10
