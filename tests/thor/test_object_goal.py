"""An agent that was written for AI2-THOR, unchanged."""

import pytest

from tests.helpers.object_goal import ObjectGoalAgent


@pytest.mark.slow
@pytest.mark.parametrize("object_type", ["Apple", "Mug"])
def test_fetches_what_lies_in_sight(kitchen, object_type) -> None:
    fetched = ObjectGoalAgent(kitchen).fetch(object_type)
    assert fetched["objectType"] == object_type
    assert fetched["isPickedUp"]


@pytest.mark.slow
def test_fetches_what_lies_in_a_drawer(kitchen) -> None:
    kitchen.reset(width=150, height=150)
    (fork,) = kitchen.last_event.objects_by_type("Fork")
    assert fork["parentReceptacles"][0].startswith("Drawer|")
    fetched = ObjectGoalAgent(kitchen).fetch("Fork")
    assert fetched["isPickedUp"]
    assert kitchen.last_event.metadata["inventoryObjects"][0]["objectId"] == fork["objectId"]
