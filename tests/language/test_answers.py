import json

import pytest

from remqa_data.errors import ProgramError
from remqa_data.language.answers import execute, is_clear
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import relation_rules
from remqa_data.sim.metadata import ObjectMetadata
from tests.helpers.room_records import kitchen, thing

FRIDGE = (("filter_type", "Fridge"),)
SINK_CABINET = (("filter_type", "Cabinet"), ("relate", "below", (("filter_type", "Sink"),)))


def with_things(*things: ObjectMetadata) -> SceneGraph:
    return SceneGraph.from_objects([*kitchen(), *things])


def mug(number: int, x: float, inside: str) -> ObjectMetadata:
    return thing(f"Mug|{number}", (x, 0, 0.2), (0.08, 0.08, 0.1), inside, "in")


def test_counts_and_existence_in_a_place_that_a_relation_picks_out() -> None:
    graph = with_things(mug(10, 1.5, "Cabinet|1"), mug(11, 1.7, "Cabinet|1"), mug(12, 2.3, "Cabinet|2"))
    inside = (("filter_type", "Mug"), ("relate", "in", SINK_CABINET))
    assert execute((*inside, ("count",)), graph).text == "2"
    assert execute((*inside, ("count",)), graph).ids == ("Mug|10", "Mug|11")
    assert execute((*inside, ("exist",)), graph).text == "yes"


def test_nothing_there_is_no_and_0() -> None:
    in_fridge = (("filter_type", "Mug"), ("relate", "in", FRIDGE))
    graph = with_things()
    assert (execute((*in_fridge, ("exist",)), graph).text, execute((*in_fridge, ("count",)), graph).text) == ("no", "0")
    assert execute((*in_fridge, ("count",)), graph).ids == ()


def test_under_what_can_be_lifted() -> None:
    under = (("filter_type", "CreditCard"), ("relate", "under", (("filter_type", "Pillow"),)), ("exist",))
    assert execute(under, with_things()).ids == ("CreditCard|1",)


def test_programs_survive_json() -> None:
    program = (("filter_type", "Apple"), ("relate", "in", (("filter_type", "Bowl"),)), ("count",))
    assert execute(json.loads(json.dumps(program)), with_things()) == execute(program, with_things())


def test_a_look_alike_makes_a_question_unclear() -> None:
    asks_for_cup = (("filter_type", "Cup"), ("relate", "in", SINK_CABINET), ("exist",))
    for graph, clear in ((with_things(), True), (with_things(mug(10, 1.5, "Cabinet|1")), False)):
        loose = SceneGraph.from_objects(graph.objects.values(), relation_rules().loosened())
        assert execute(asks_for_cup, graph).text == "no"
        assert is_clear(asks_for_cup, graph, loose) == clear


@pytest.mark.parametrize("program", [(), (("exist",),), FRIDGE, (*FRIDGE, ("count", 1)), (*FRIDGE, ("sum",))])
def test_what_is_no_question_is_refused(program) -> None:
    with pytest.raises(ProgramError, match="exist or count"):
        execute(program, with_things())
