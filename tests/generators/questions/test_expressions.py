import json
from collections.abc import Iterator

import pytest

from remqa_data.errors import UnknownNameError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.questions.expressions import Expression, Expressions
from remqa_data.language.referring import program_of, resolve
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import ObjectMetadata, object_metadata
from remqa_data.sim.physics.world import World
from tests.helpers.room_records import kitchen, kitchen_graph, thing


def all_expressions(graph: SceneGraph) -> list[Expression]:
    """The expressions of all objects, in the order of the graph's nodes."""
    room = Expressions(graph)
    return [expression for object_id in graph.objects for expression in room.of(object_id)]


@pytest.fixture(scope="module", params=["FloorPlan1", "FloorPlan219", "FloorPlan303", "FloorPlan408"])
def room(request) -> Iterator[SceneGraph]:
    with World(load_scene(request.param)) as world:
        yield SceneGraph.from_objects(object_metadata(world).values())


def texts(graph: SceneGraph, target: str, *kinds: str) -> list[str]:
    return [e.text for e in Expressions(graph).of(target) if not kinds or e.kind in kinds]


def test_the_bare_noun_comes_first_where_it_is_enough() -> None:
    assert texts(kitchen_graph(), "Fridge|1")[0] == "the fridge"
    assert not texts(kitchen_graph(), "Fridge|1", "superlative", "attribute")


def test_relations_tell_apart_what_the_noun_does_not() -> None:
    graph = kitchen_graph()
    assert texts(graph, "Cabinet|1", "bare", "relation")[0] == "the cabinet below the sink"
    assert texts(graph, "Cabinet|3", "bare", "relation") == ["the cabinet above the sink"]
    first = Expressions(graph).of("Cabinet|3")[0]
    assert (first.target_id, first.target_type, first.relation, first.anchor_id) == (
        "Cabinet|3",
        "Cabinet",
        "above",
        "Sink|1",
    )


def test_superlatives_and_attributes_are_marked_as_the_extension() -> None:
    graph = kitchen_graph()
    assert "the middle drawer next to the fridge" in texts(graph, "Drawer|2", "superlative")
    assert texts(graph, "Drawer|2", "bare", "relation", "attribute") == []
    assert texts(graph, "Mug|1") == ["the red mug", "the red mug on the countertop"]
    assert {e.kind for e in Expressions(graph).of("Mug|1")} == {"attribute"}


def test_no_landmark_of_the_same_type_nor_tiny_nor_inside_something_closed() -> None:
    assert any(expression.anchor_id is not None for expression in all_expressions(kitchen_graph()))
    for expression in all_expressions(kitchen_graph()):
        assert expression.anchor_id not in {"Apple|1", "CreditCard|1", "Bowl|1"}
        if expression.anchor_id is not None:
            assert expression.anchor_id.split("|")[0] != expression.target_type


def test_furniture_is_not_pointed_out_by_what_can_be_carried_away() -> None:
    table = [
        thing("SideTable|1", (0, 0, 0), (0.5, 0.5, 0.5), "Floor|1"),
        thing("SideTable|2", (3, 0, 0), (0.5, 0.5, 0.5), "Floor|1"),
        thing("Box|1", (0.5, 0, 0), (0.4, 0.4, 0.4), "Floor|1"),
        thing("Desk|1", (1.1, 0, 0), (0.5, 0.5, 0.9), "Floor|1"),
        thing("Floor|1", (0, 0, -0.1), (9, 9, 0.1)),
    ]
    graph = SceneGraph.from_objects(table)
    assert "the box next to the desk" in texts(graph, "Box|1")
    assert "Box|1" not in {e.anchor_id for e in Expressions(graph).of("SideTable|1")}


def drawers_beside_a_fridge(gap_m: float) -> SceneGraph:
    """A drawer that touches a fridge, and one on its other side at a distance."""
    return SceneGraph.from_objects(
        [
            thing("Fridge|1", (0, 0, 0), (0.8, 0.7, 1.8), "Floor|1"),
            thing("Drawer|1", (-0.65, 0, 0.6), (0.5, 0.5, 0.2)),
            thing("Drawer|2", (0.65 + gap_m, 0, 0.6), (0.5, 0.5, 0.2)),
        ]
    )


def test_a_near_miss_makes_a_phrase_ambiguous() -> None:
    # Drawers and a fridge are next to each other up to 0.35 m; either of two within 0.6 m may be called so.
    assert "the drawer next to the fridge" not in texts(drawers_beside_a_fridge(0.3), "Drawer|1")
    assert "the drawer next to the fridge" not in texts(drawers_beside_a_fridge(0.45), "Drawer|1")
    assert "the drawer next to the fridge" not in texts(drawers_beside_a_fridge(0.59), "Drawer|1")
    assert "the drawer next to the fridge" in texts(drawers_beside_a_fridge(0.61), "Drawer|1")


def test_the_nearer_of_two_is_not_next_to_it_even_if_one_is_below() -> None:
    # As in FloorPlan5: one cabinet below the sink, one beside it; and FloorPlan427: two columns of drawers by a bathtub.
    cabinets = [
        thing("Sink|1", (0, 0, 0.72), (0.7, 0.45, 0.2)),
        thing("Cabinet|1", (0, 0, 0.1), (0.8, 0.5, 0.6)),
        thing("Cabinet|2", (0.9, 0, 0.1), (0.5, 0.5, 0.78)),
    ]
    assert "the cabinet below the sink" in texts(SceneGraph.from_objects(cabinets), "Cabinet|1")
    assert "the cabinet next to the sink" not in texts(SceneGraph.from_objects(cabinets), "Cabinet|2")
    drawers = [
        thing("Bathtub|1", (0, 0, 0), (1.0, 0.7, 0.6), "Floor|1"),
        *(
            thing(f"Drawer|{i}{j}", (0.8 + 0.45 * i, 0, 0.1 + 0.26 * j), (0.4, 0.4, 0.25))
            for i in (0, 1)
            for j in (0, 1)
        ),
    ]
    assert "the bottom drawer next to the bathtub" not in texts(SceneGraph.from_objects(drawers), "Drawer|00")


def test_what_hangs_beside_a_thing_is_not_above_it() -> None:
    toilet = thing("Toilet|1", (0, 0, 0), (0.5, 0.7, 1.0), "Floor|1")
    hanger = thing("ToiletPaperHanger|1", (0.25, 0.3, 0.7), (0.15, 0.1, 0.15))
    assert SceneGraph.from_objects([toilet, hanger]).relation(hanger.id, toilet.id) != "above"
    higher = thing("ToiletPaperHanger|1", (0.25, 0.3, 1.1), (0.15, 0.1, 0.15))
    assert SceneGraph.from_objects([toilet, higher]).relation(higher.id, toilet.id) == "above"


def test_what_lies_on_a_low_shelf_is_not_on_the_floor() -> None:
    floor = thing("Floor|1", (0, 0, -0.1), (9, 9, 0.1))
    vases = [
        thing("Vase|1", (0, 0, 0.17), (0.2, 0.2, 0.3), "Floor|1"),
        thing("Vase|2", (2, 0, 0.0), (0.2, 0.2, 0.3), "Floor|1"),
    ]
    graph = SceneGraph.from_objects([floor, *vases])
    assert graph.relation("Vase|1", "Floor|1") is None
    assert graph.relation("Vase|2", "Floor|1") == "on"


def test_a_thing_of_no_one_colour_is_not_pointed_out_by_one() -> None:
    vases = [
        thing("Vase|1", (0, 0, 0), (0.2, 0.2, 0.3), color="mixed"),
        thing("Vase|2", (2, 0, 0), (0.2, 0.2, 0.3), color="red"),
    ]
    graph = SceneGraph.from_objects(vases)
    assert texts(graph, "Vase|1") == []
    assert texts(graph, "Vase|2") == ["the red vase"]


def test_a_landmark_is_the_only_thing_that_is_called_so() -> None:
    chairs = [thing(f"Chair|{i}", (2.0 * i, 0, 0), (0.5, 0.5, 0.9), "Floor|1") for i in range(3)]
    cans = [thing(f"GarbageCan|{i}", (5.0 * i, 0.55, 0), (0.3, 0.3, 0.5), "Floor|1") for i in range(2)]
    assert "the garbage can next to the chair" in texts(SceneGraph.from_objects([chairs[0], *cans]), "GarbageCan|0")
    assert "the garbage can next to the chair" not in texts(SceneGraph.from_objects([*chairs, *cans]), "GarbageCan|0")
    stool = thing("Stool|1", (3.0, 3.0, 0), (0.4, 0.4, 0.5), "Floor|1")
    assert "the garbage can next to the chair" not in texts(
        SceneGraph.from_objects([chairs[0], *cans, stool]), "GarbageCan|0"
    )


def test_left_and_right_in_a_real_kitchen() -> None:
    # FloorPlan1: the microwave hangs between two cabinets on the wall at -y; who looks at it has +x on the left.
    with World(load_scene("FloorPlan1")) as world:
        graph = SceneGraph.from_objects(object_metadata(world).values())
    (left,) = resolve("the left cabinet next to the microwave", graph)
    (right,) = resolve("the right cabinet next to the microwave", graph)
    (microwave,) = resolve("the microwave", graph)
    assert graph.node(left).box[0] > graph.node(microwave).box[0] > graph.node(right).box[0]
    assert "the left cabinet next to the microwave" in texts(graph, left)


def by_hand(graph: SceneGraph, kind: str, relation: str, anchor_type: str) -> set[str]:
    """Sources of all edges of a kind: what a relation expression must have been counted over, without programs."""
    typed = {name: record.type for name, record in graph.objects.items()}
    return {
        e.source
        for e in graph.edges
        if typed[e.source] == kind and typed[e.target] == anchor_type and e.relation == relation
    }


@pytest.mark.slow
def test_every_expression_of_a_room_picks_out_its_target(room: SceneGraph) -> None:
    everything = all_expressions(room)
    assert {"bare", "relation", "superlative"} <= {e.kind for e in everything}
    for e in everything:
        assert resolve(e.program, room) == [e.target_id]
        assert resolve(json.loads(json.dumps(e.program)), room) == [e.target_id]
        assert program_of(e.text) == e.program
        if e.kind == "relation":
            assert e.anchor_id is not None
            assert e.relation is not None
            anchor = room.node(e.anchor_id)
            assert by_hand(room, e.target_type, e.relation, anchor.type) == {e.target_id}
            assert room.relation(e.target_id, e.anchor_id) == e.relation
        if e.kind == "bare":
            assert [r.type for r in room.objects.values()].count(e.target_type) == 1
    assert len({(e.target_id, e.text) for e in everything}) == len(everything)
    assert len({e.text: e.target_id for e in everything}) == len({e.text for e in everything})


@pytest.mark.slow
def test_expressions_do_not_depend_on_the_order_of_the_nodes(room: SceneGraph) -> None:
    backwards = SceneGraph.from_objects(reversed(room.objects.values()))
    one, two = Expressions(room), Expressions(backwards)
    assert any(one.of(target) for target in room.objects)
    for target in room.objects:
        assert one.of(target) == two.of(target)


def test_floors_have_none_and_unknown_objects_are_named() -> None:
    assert Expressions(kitchen_graph()).of("Floor|1") == []
    with pytest.raises(UnknownNameError, match="unknown object"):
        Expressions(kitchen_graph()).of("Fridge|9")


def test_one_phrase_never_names_two_objects() -> None:
    everything: list[ObjectMetadata] = kitchen()
    found = all_expressions(SceneGraph.from_objects(everything))
    assert len(found) == len({e.text for e in found})
