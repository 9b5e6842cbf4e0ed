import csv
from importlib import resources

import pytest

from remqa_data.catalog import catalog, object_type, question_types
from remqa_data.generators.arrangement.plausible import plausible_types, types_beside

ROOMS = ("kitchen", "living_room", "bedroom", "bathroom")


def recorded() -> list[tuple[str, str, str]]:
    """What was recorded in containers more than once: type, container, kind of room."""
    with (resources.files("remqa_data.templates") / "placements.csv").open(encoding="utf-8") as file:
        rows = [r for r in csv.DictReader(file) if r["room"] in ROOMS and int(r["count"]) > 1]
    inside = [r for r in rows if object_type(r["receptacle_type"]).is_container]
    found = [
        (r["object_type"], r["receptacle_type"], r["room"]) for r in inside if r["object_type"] in question_types()
    ]
    # on the cistern of a toilet things stand
    return [row for row in found if object_type(row[0]).pickupable and row[1] != "Toilet"]


@pytest.mark.parametrize(("thing", "container", "room"), recorded())
def test_what_was_recorded_in_a_container_is_plausible_there(thing, container, room) -> None:
    assert thing in plausible_types(container, "in", room)


@pytest.mark.parametrize(
    ("thing", "container", "room"),
    [("Book", "Fridge", "kitchen"), ("CD", "Toilet", "bathroom"), ("CellPhone", "Microwave", "kitchen")],
)
def test_what_nobody_would_look_for_is_not(thing, container, room) -> None:
    assert thing not in plausible_types(container, "in", room)


def test_every_small_question_type_is_plausible_somewhere() -> None:
    found = {
        name
        for place in catalog()
        for relation in ("in", "under")
        for room in ROOMS
        for name in plausible_types(place, relation, room)
    }
    assert {name for name in question_types() if object_type(name).pickupable} - found == {"Box"}


@pytest.mark.parametrize(
    ("container", "room"), [("Fridge", "kitchen"), ("Microwave", "kitchen"), ("Toilet", "bathroom")]
)
def test_where_nobody_would_put_it_nothing_unusual_comes_to_light_either(container, room) -> None:
    assert types_beside(container, "in", room) == plausible_types(container, "in", room)
    assert types_beside("Drawer", "in", room) > plausible_types("Drawer", "in", room)
