import pytest

from remqa_data.agents.knowledge.instance import choose_instance
from remqa_data.language.referring import program_of
from tests.helpers.room_records import kitchen
from tests.helpers.walked_rooms import memory_of

BOUNDS = (-1.0, -3.5, 4.0, 0.5)


def chosen(text: str, *, without: tuple[str, ...] = (), unseen: tuple[str, ...] = ()):
    """The instance that a phrase means in the kitchen; some things are not in the graph, others not even on the map."""
    seen = [record for record in kitchen() if record.id not in unseen]
    memory = memory_of(seen, BOUNDS)
    known = memory_of([record for record in seen if record.id not in without], BOUNDS)
    return choose_instance(program_of(text), type(memory)(known.graph, memory.labels, memory.plan, memory.body))


@pytest.mark.slow
def test_the_anchor_of_the_expression_chooses_the_instance() -> None:
    boxes = {record.id: record.box for record in kitchen()}
    for text, name in (
        ("the cabinet above the sink", "Cabinet|3"),
        ("the bottom drawer below the toaster", "Drawer|1"),
        ("the red mug on the countertop", "Mug|1"),
    ):
        found = chosen(text)
        assert (found.box, found.found_by) == (boxes[name], "graph"), text


def test_where_the_anchor_was_not_seen_an_object_of_the_type_is_taken() -> None:
    found = chosen("the pillow next to the toaster", unseen=("Toaster|1",))
    assert (found.type, found.found_by) == ("Pillow", "type")


def test_where_several_fit_the_first_is_taken() -> None:
    found = chosen("the mug")
    assert found.box == next(record.box for record in kitchen() if record.id == "Mug|1")
    assert found.found_by == "graph, roughly"


@pytest.mark.slow
def test_what_the_graph_lacks_is_found_by_its_label_on_the_map() -> None:
    found = chosen("the toaster", without=("Toaster|1",))
    assert found.found_by == "map"
    x0, y0, z0, x1, y1, z1 = found.box
    assert (round(x0, 2), round(y0, 2), round(x1, 2), round(y1, 2)) == (0.9, -0.1, 1.2, 0.1)
    assert 0.85 < z0 < z1 < 1.15
    assert found.facing_deg is None


@pytest.mark.slow
def test_what_nobody_has_seen_is_nowhere() -> None:
    assert chosen("the toaster", unseen=("Toaster|1",)) is None
