import json
from collections.abc import Iterator
from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from remqa_data.errors import SceneGraphError, UnknownNameError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene_graph.graph import GraphUpdate, SceneGraph
from remqa_data.scene_graph.relations import relation_rules
from remqa_data.sim.metadata import AgentState, FrameMetadata, ObjectMetadata, VisibleObject, object_metadata
from remqa_data.sim.physics.world import World
from tests.helpers.room_records import kitchen, kitchen_graph, thing

FLOOR = "Floor|1"


@pytest.fixture(scope="module", params=["FloorPlan1", "FloorPlan303", "FloorPlan408"])
def room(request) -> Iterator[list[ObjectMetadata]]:
    with World(load_scene(request.param)) as world:
        yield list(object_metadata(world).values())


def relation(*objects: ObjectMetadata, source: int = 0, target: int = 1) -> str | None:
    return SceneGraph.from_objects(objects).relation(objects[source].id, objects[target].id)


# ---- what a person would say (worked out on paper, see room_records)


@pytest.mark.parametrize(
    ("source", "expected", "target"),
    [
        ("Mug|1", "on", "CounterTop|1"),
        ("Bowl|1", "in", "Fridge|1"),
        ("Apple|1", "in", "Bowl|1"),
        ("Apple|1", None, "Fridge|1"),  # the bowl is what holds it
        ("CreditCard|1", "under", "Pillow|1"),
        ("Pillow|1", None, "CreditCard|1"),
        ("Sink|1", "above", "Cabinet|1"),  # the basin hangs in it
        ("Cabinet|1", "below", "Sink|1"),
        ("Cabinet|3", "above", "Sink|1"),
        ("Cabinet|3", None, "Cabinet|2"),  # not over it
        ("Drawer|2", "above", "Drawer|1"),
        ("Drawer|2", "below", "Drawer|3"),
        ("Drawer|3", "next to", "Fridge|1"),
        ("Fridge|1", "next to", "Drawer|3"),
        ("Cabinet|1", None, "Fridge|1"),  # the drawers are between, 0.5 m wide
        ("Cabinet|1", "next to", "Cabinet|2"),
        ("Mug|1", None, "Mug|2"),  # 0.1 m apart, and only 0.1 m wide
    ],
)
def test_relations_in_a_kitchen(source: str, expected: str | None, target: str) -> None:
    assert kitchen_graph().relation(source, target) == expected


def test_an_edge_carries_distance_and_iou() -> None:
    low, high = thing("Cabinet|1", (0, 0, 0), (1, 1, 1)), thing("Cabinet|2", (0, 0, 0.95), (1, 1, 1))
    edges = {(e.source, e.relation): e for e in SceneGraph.from_objects([low, high]).edges}
    assert set(edges) == {("Cabinet|1", "below"), ("Cabinet|2", "above")}
    for edge in edges.values():
        assert edge.distance_m == pytest.approx(0.95)
        assert edge.iou == pytest.approx(0.05 / 1.95)  # 0.05 shared of 2 - 0.05


@pytest.mark.parametrize(
    ("gap_m", "expected"), [(0.0, "next to"), (0.3, "next to"), (0.34, "next to"), (0.36, None), (1.0, None)]
)
def test_next_to_ends_at_a_gap(gap_m: float, expected: str | None) -> None:
    side, other = thing("Sofa|1", (0, 0, 0), (2, 1, 0.8), FLOOR), thing("Desk|1", (2 + gap_m, 0, 0), (2, 1, 0.8), FLOOR)
    assert relation(side, other) == relation(side, other, source=1, target=0) == expected


def test_small_things_are_next_to_what_is_really_close() -> None:
    mug = thing("Mug|1", (0, 0, 1), (0.1, 0.1, 0.1), "Desk|1")
    assert relation(mug, thing("Bowl|1", (0.14, 0, 1), (0.1, 0.1, 0.1), "Desk|1")) == "next to"
    assert relation(mug, thing("Bowl|1", (0.35, 0, 1), (0.1, 0.1, 0.1), "Desk|1")) is None


def test_things_at_different_heights_are_not_next_to_each_other() -> None:
    shelf_plant = thing("HousePlant|1", (0.4, 0, 2), (0.3, 0.3, 0.3))
    assert relation(shelf_plant, thing("GarbageCan|1", (0, 0, 0), (0.3, 0.3, 0.5), FLOOR)) is None


def test_what_lies_on_a_table_is_not_next_to_the_chair_at_it() -> None:
    pencil = thing("Pencil|1", (0, 0, 0.75), (0.15, 0.01, 0.01), "DiningTable|1")
    assert relation(pencil, thing("Chair|1", (0.3, 0, 0), (0.4, 0.4, 1.0), FLOOR)) is None


def test_what_is_inside_is_not_next_to_what_is_outside() -> None:
    egg = thing("Egg|1", (0.35, 0, 1), (0.05, 0.05, 0.05), "Fridge|1", "in")
    assert relation(egg, thing("Bowl|1", (0.45, 0, 1), (0.1, 0.1, 0.1), "CounterTop|1")) is None
    assert relation(egg, thing("Bowl|1", (0.45, 0, 1), (0.1, 0.1, 0.1), "Fridge|1", "in")) == "next to"


def test_under_furniture_on_legs_but_not_under_a_dresser() -> None:
    box = thing("Box|1", (0, 0, 0), (0.3, 0.3, 0.3), FLOOR)
    assert relation(box, thing("Desk|1", (0, 0, 0), (1.2, 0.6, 0.75), FLOOR)) == "under"
    assert relation(box, thing("Dresser|1", (0, 0, 0), (1.2, 0.6, 0.75), FLOOR)) is None


def test_a_drawer_is_in_the_dresser_that_surrounds_it() -> None:
    drawer, dresser = thing("Drawer|1", (0, 0, 0.1), (0.5, 0.4, 0.2)), thing("Dresser|1", (0, 0, 0), (1, 0.5, 1), FLOOR)
    assert relation(drawer, dresser) == "in"
    assert relation(drawer, dresser, source=1, target=0) is None


def test_a_window_is_above_what_stands_at_its_wall() -> None:
    window = thing("Window|1", (0, 0.4, 1.0), (1.2, 0.1, 1.0))
    assert relation(window, thing("Desk|1", (0, 0.05, 0), (1.2, 0.6, 0.75), FLOOR)) == "above"
    assert relation(window, thing("Desk|1", (0, -1, 0), (1.2, 0.6, 0.75), FLOOR)) is None


def test_loosened_rules_relate_all_that_strict_rules_relate(room: list[ObjectMetadata]) -> None:
    strict = SceneGraph.from_objects(room)
    loose = SceneGraph.from_objects(room, relation_rules().loosened())
    kept = [edge for edge in strict.edges if loose.relation(edge.source, edge.target) is not None]
    assert len(kept) == len(strict.edges)
    assert len(loose.edges) > len(strict.edges)


# ---- the shape of every graph


def test_inverses_and_exclusions_hold_in_real_rooms(room: list[ObjectMetadata]) -> None:
    graph = SceneGraph.from_objects(room)
    inverses = relation_rules().inverses
    assert {edge.relation for edge in graph.edges} >= {"in", "on", "above", "below", "next to"}
    for edge in graph.edges:
        assert edge.source != edge.target
        assert graph.relation(edge.target, edge.source) == inverses[edge.relation]
        assert edge.distance_m > 0
        assert 0 <= edge.iou <= 1
    holding = nx.DiGraph([(e.source, e.target) for e in graph.edges if e.relation in ("in", "on", "under")])
    assert nx.is_directed_acyclic_graph(holding)
    above = nx.DiGraph([(e.source, e.target) for e in graph.edges if e.relation == "above"])
    assert nx.is_directed_acyclic_graph(above)


# ---- growing


@pytest.mark.slow
@given(st.randoms(use_true_random=False), st.integers(1, 20))
@settings(max_examples=15)
def test_the_order_of_seeing_does_not_matter(random, batch: int) -> None:
    objects = kitchen()
    whole = SceneGraph.from_objects(objects)
    random.shuffle(objects)
    grown = SceneGraph()
    for start in range(0, len(objects), batch):
        grown.add_objects(objects[: start + batch])  # what was seen before is seen again
    assert grown == whole


def test_a_real_room_grown_in_random_order_is_the_whole_room_to_the_last_bit(room: list[ObjectMetadata]) -> None:
    order = np.random.default_rng(5).permutation(len(room))
    grown, updates = SceneGraph(), []
    for part in np.array_split(order, 9):
        updates.append(grown.add_objects([room[i] for i in part]))
    assert grown == SceneGraph.from_objects(room)
    read = [GraphUpdate.from_json(update.to_json()) for update in updates]
    assert read == updates
    assert SceneGraph.replay(read) == grown


def frame_of(*objects: ObjectMetadata) -> FrameMetadata:
    seen = tuple(VisibleObject(**vars(o), box_2d=(0, 0, 9, 9), pixels=81, distance_m=2.0) for o in objects)
    return FrameMetadata(AgentState((0, 0, 0), 0, 0), seen)


def test_a_frame_adds_only_what_is_new() -> None:
    mug, desk = (
        thing("Mug|1", (0, 0, 0.75), (0.1, 0.1, 0.1), "Desk|1"),
        thing("Desk|1", (0, 0, 0), (1, 0.6, 0.75), FLOOR),
    )
    graph = SceneGraph()
    first = graph.add_frame(frame_of(mug))
    assert first == GraphUpdate((mug,), ())
    second = graph.add_frame(frame_of(mug, desk))
    assert second.nodes == (desk,)
    assert [(e.source, e.relation, e.target) for e in second.edges] == [("Mug|1", "on", "Desk|1")]
    assert graph.add_frame(frame_of(replace(mug, openness=1.0))) == GraphUpdate((), ())
    assert graph.node("Mug|1") == mug
    assert graph.graph.nodes["Mug|1"]["type"] == "Mug"
    assert graph.graph.edges["Mug|1", "Desk|1"]["relation"] == "on"


def test_what_the_agent_holds_is_left_out() -> None:
    held = replace(thing("Mug|1", (0, 0, 0.75), (0.1, 0.1, 0.1)), is_picked_up=True)
    assert SceneGraph.from_objects([held]).objects == {}


# ---- reading


def test_holders_and_contents_follow_the_chain() -> None:
    graph = kitchen_graph()
    assert graph.holders("Apple|1") == ["Bowl|1", "Fridge|1", "Floor|1"]
    assert graph.contents("Fridge|1") == ["Bowl|1", "Apple|1"]
    assert graph.related("Drawer|2", "below") == ["Drawer|3", "Toaster|1"]


def test_unknown_objects_are_named_with_the_nearest_known_ones() -> None:
    with pytest.raises(UnknownNameError, match=r"unknown object 'Fridge\|2'; did you mean 'Fridge\|1'"):
        kitchen_graph().node("Fridge|2")


# ---- damage


def test_updates_that_do_not_fit_together_are_refused() -> None:
    graph = SceneGraph()
    first, second = graph.add_objects(kitchen()[:10]), graph.add_objects(kitchen())
    with pytest.raises(SceneGraphError, match="was never added"):
        SceneGraph.replay([second])
    with pytest.raises(SceneGraphError, match="added twice"):
        SceneGraph.replay([first, first])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["nodes"][0].pop("box"), "nodes.0.box: Field required"),
        (lambda d: d["edges"][0].update(relation="beside"), "edges.0.relation"),
        (lambda d: d["edges"][0].update(weight=1.0), "edges.0.weight: "),
        (lambda d: d["nodes"][0].update(colour="red"), "nodes.0.colour: "),
        (lambda d: d.update(node=[]), "node: "),
        (lambda d: d["nodes"][0]["box"].__setitem__(0, float("nan")), "nodes.0.box.0: "),
    ],
)
def test_damage_is_named(change, message: str) -> None:
    data = json.loads(SceneGraph().add_objects(kitchen()).to_json())
    change(data)
    with pytest.raises(SceneGraphError) as caught:
        GraphUpdate.from_json(json.dumps(data), "row 7")
    assert str(caught.value).startswith("row 7: " + message)


def test_names_that_are_not_known_are_told_by_each_way_of_reading() -> None:
    graph = kitchen_graph()
    for source, target in (("Fridge|2", "Sink|1"), ("Sink|1", "Fridge|2")):
        with pytest.raises(UnknownNameError, match=r"unknown object 'Fridge\|2'; did you mean 'Fridge\|1'"):
            graph.relation(source, target)
    with pytest.raises(UnknownNameError, match="unknown relation 'beside'"):
        graph.related("Sink|1", "beside")  # type: ignore[arg-type]


def test_a_box_is_six_finite_numbers_however_they_are_given() -> None:
    mug = thing("Mug|1", (0, 0, 0), (0.1, 0.1, 0.1))
    listed = replace(mug, box=list(mug.box))  # type: ignore[arg-type]
    assert SceneGraph.from_objects([listed]) == SceneGraph.from_objects([mug])
    for box in ((float("nan"), *mug.box[1:]), mug.box[:4]):
        with pytest.raises(SceneGraphError, match=r"node 'Mug\|1': its box is .*; expected six finite numbers"):
            SceneGraph.from_objects([replace(mug, box=box)])


def test_the_rules_say_which_edge_goes_back() -> None:
    rules = relation_rules()
    one_way = rules.model_copy(update={"inverses": {**rules.inverses, "above": None, "below": None}})
    kept = {edge for edge in kitchen_graph().edges if edge.relation != "below"}
    assert set(SceneGraph.from_objects(kitchen(), one_way).edges) == kept


def test_what_is_no_node_is_related_to_nothing_and_that_is_told() -> None:
    with pytest.raises(UnknownNameError, match="Mug"):
        SceneGraph.from_objects([]).related("Mug|1", "in")
