"""Behind and between, and what lies on something in a closed thing; every number is worked out on paper."""

import pytest

from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.order import is_ordered
from remqa_data.scene_graph.relations import relation_rules
from tests.helpers.room_records import kitchen, thing


def shelf(*things, rules=None) -> SceneGraph:
    """Things in the fridge, which is 0.8 wide, and 0.7 deep around y = 0; its front looks towards -y."""
    return SceneGraph.from_objects([*kitchen(), *things], rules)


def mug(number: int, x: float, y: float, inside: str = "Fridge|1", z: float = 0.5):
    return thing(f"Mug|{number}", (x, y, z), (0.1, 0.1, 0.1), inside, "in")


def egg(x: float, y: float, inside: str = "Fridge|1", z: float = 0.5):
    return thing("Egg|9", (x, y, z), (0.06, 0.06, 0.06), inside, "in")


@pytest.mark.parametrize(
    ("at", "expected"),
    [
        ((0.3, 0.0), True),  # 2 cm behind
        ((0.34, 0.0), True),  # half of it
        ((0.37, 0.0), False),  # a sixth of it
        ((0.3, -0.25), False),  # before it
        ((0.42, -0.1), False),  # beside it
        ((0.3, 0.09), True),  # 11 cm
        ((0.3, 0.12), False),  # 14 cm
    ],
)
def test_behind_is_farther_from_the_front_and_near(at, expected) -> None:
    graph = shelf(mug(9, 0.3, -0.1), egg(*at))
    assert is_ordered(graph, "Egg|9", "behind", {"Mug|9"}) is expected
    assert not is_ordered(graph, "Mug|9", "behind", {"Egg|9"}) or at[1] < -0.2


def test_behind_follows_the_front_of_what_holds_them() -> None:
    turned = [thing("Safe|1", (5, 0, 0), (0.6, 0.6, 0.6), "Floor|1", facing_deg=0.0)]  # its front looks towards +x
    things = [mug(9, 5.1, 0, "Safe|1"), egg(4.99, 0, "Safe|1")]
    assert is_ordered(SceneGraph.from_objects([*kitchen(), *turned, *things]), "Egg|9", "behind", {"Mug|9"})


@pytest.mark.parametrize("other", [egg(0.3, 0.05, "Cabinet|1"), egg(0.3, 0.05, z=0.8)])
def test_nothing_is_behind_what_is_in_another_thing_or_on_another_level(other) -> None:
    assert not is_ordered(shelf(mug(9, 0.3, -0.1), other), "Egg|9", "behind", {"Mug|9"})


@pytest.mark.parametrize(
    ("at", "expected"),
    [
        ((0.4, 0.0), True),
        ((0.4, 0.05), True),  # 5 of 26 cm aside
        ((0.4, 0.1), False),  # 10 of 26
        ((0.32, 0.0), False),  # a fifth of the way
        ((0.7, 0.0), False),  # beyond
    ],
)
def test_between_is_on_the_way_from_one_to_the_other(at, expected) -> None:
    graph = shelf(mug(8, 0.27, 0), mug(9, 0.53, 0), egg(*at))
    assert is_ordered(graph, "Egg|9", "between", {"Mug|8", "Mug|9"}) is expected
    assert not is_ordered(graph, "Egg|9", "between", {"Mug|8"})


def test_nothing_is_between_things_that_are_far_apart() -> None:
    far = shelf(mug(8, 0.06, 0), mug(9, 0.72, 0), egg(0.39, 0))
    assert not is_ordered(far, "Egg|9", "between", {"Mug|8", "Mug|9"})


def test_what_lies_on_a_thing_in_a_drawer_is_on_it_and_elsewhere_not() -> None:
    book = thing("Book|9", (1.05, 0, 0.4), (0.2, 0.3, 0.03), "Drawer|2", "in")
    pen = thing("Pen|9", (1.05, 0, 0.431), (0.01, 0.18, 0.01), "Drawer|2", "in")
    beside = thing("Pencil|9", (1.25, 0, 0.4), (0.01, 0.18, 0.01), "Drawer|2", "in")
    graph = shelf(book, pen, beside)
    assert graph.relation("Pen|9", "Book|9") == "on"
    assert graph.relation("Book|9", "Pen|9") is None
    assert graph.relation("Pencil|9", "Book|9") == "next to"
    assert graph.relation("Pen|9", "Drawer|2") == "in"


def test_tightened_rules_relate_fewer_and_loosened_ones_more() -> None:
    near, far = egg(0.3, 0.08), egg(0.3, 0.13)  # 10 and 15 cm behind the mug, where 12 is the limit
    for rules, expected in (
        (relation_rules().tightened(), (False, False)),
        (relation_rules().loosened(), (True, True)),
    ):
        graphs = [shelf(mug(9, 0.3, -0.1), thing_, rules=rules) for thing_ in (near, far)]
        assert tuple(is_ordered(graph, "Egg|9", "behind", {"Mug|9"}) for graph in graphs) == expected
