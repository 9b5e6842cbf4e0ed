import json
from dataclasses import replace

import pytest

from remqa_data.errors import ProgramError
from remqa_data.language import referring
from remqa_data.language.referring import candidates, program_of, resolve
from remqa_data.language.rules import expression_rules, may_be_called, similar_words
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import relation_rules
from tests.helpers.room_records import kitchen, kitchen_graph, thing


def loose(graph: SceneGraph) -> SceneGraph:
    return SceneGraph.from_objects(graph.objects.values(), relation_rules().loosened())


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("the fridge", ["Fridge|1"]),
        ("the mug", ["Mug|1", "Mug|2"]),
        ("the red mug", ["Mug|1"]),
        ("the red mug on the countertop", ["Mug|1"]),
        ("the red mug in the sink", []),
        ("the cabinet below the sink", ["Cabinet|1"]),
        ("the cabinet above the sink", ["Cabinet|3"]),
        ("the drawer next to the fridge", ["Drawer|1", "Drawer|2", "Drawer|3"]),
        ("the top drawer next to the fridge", ["Drawer|3"]),
        ("the middle drawer", ["Drawer|2"]),
        ("the bottom drawer below the toaster", ["Drawer|1"]),
        ("the drawer next to the cabinet below the sink", ["Drawer|1", "Drawer|2", "Drawer|3"]),
        ("the cabinet closest to the fridge", ["Cabinet|1", "Cabinet|3"]),
        ("the top cabinet closest to the fridge", ["Cabinet|3"]),
        ("the left cabinet", []),  # there are three
        ("the bottom left cabinet", ["Cabinet|1"]),  # seen from -y, which they face, -x is on the left
        ("the bottom right cabinet", ["Cabinet|2"]),
        ("the credit card under the pillow", ["CreditCard|1"]),
    ],
)
def test_what_a_phrase_picks_out(text: str, ids: list[str]) -> None:
    graph = kitchen_graph()
    assert resolve(text, graph) == ids
    assert resolve(json.loads(json.dumps(program_of(text))), graph) == ids


def test_left_and_right_are_those_of_who_stands_in_front() -> None:
    turned = [replace(record, facing_deg=90.0) for record in kitchen() if record.id != "Cabinet|3"]
    assert resolve("the left cabinet", SceneGraph.from_objects(turned)) == ["Cabinet|2"]
    unknown = [replace(record, facing_deg=None) for record in kitchen() if record.id != "Cabinet|3"]
    assert resolve("the left cabinet", SceneGraph.from_objects(unknown)) == []


def test_the_middle_of_three_in_a_row() -> None:
    row = [thing(f"Cabinet|{i}", (0.5 * i, 0, 0), (0.5, 0.5, 0.8)) for i in range(3)]
    assert resolve("the middle cabinet", SceneGraph.from_objects(row)) == ["Cabinet|1"]
    assert resolve("the rightmost cabinet", SceneGraph.from_objects(row)) == ["Cabinet|2"]


def test_places_in_a_long_row_are_counted_from_its_ends() -> None:
    grid = [thing(f"Drawer|{i}{k}", (0.5 * i, 0, 0.4 * k), (0.5, 0.5, 0.35)) for i in range(4) for k in range(2)]
    graph = SceneGraph.from_objects(grid)
    assert resolve("the second top drawer from the left", graph) == ["Drawer|11"]
    assert resolve("the second bottom drawer from the right", graph) == ["Drawer|20"]
    assert resolve("the second drawer from the left", graph) == ["Drawer|10", "Drawer|11"]
    assert resolve("the third top drawer from the left", graph) == []  # nobody counts past the middle
    of_three = SceneGraph.from_objects(grid[:6])
    assert resolve("the second top drawer from the left", of_three) == []  # it is the middle one
    with pytest.raises(ProgramError, match="from the left"):
        program_of("the top drawer from the left")


def test_words_for_places_in_a_row_are_those_of_the_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    """And what they mean does not depend on the order in which they stand there."""
    words = {
        "row_ordinals": {"3rd": "third", "2nd": "second"},
        "row_sides": {"counted from the right": "from the right"},
    }
    rules = expression_rules().model_copy(update=words)
    monkeypatch.setattr(referring, "expression_rules", lambda: rules)
    row = [thing(f"Drawer|{i}", (0.5 * i, 0, 0), (0.5, 0.5, 0.35)) for i in range(7)]
    graph = SceneGraph.from_objects(row)
    assert program_of("the 3rd drawer counted from the right")[-1] == ("row", "third from the right")
    assert resolve("the 3rd drawer counted from the right", graph) == ["Drawer|4"]
    assert resolve("the 2nd drawer counted from the right", graph) == ["Drawer|5"]
    with pytest.raises(ProgramError, match="is said of the 3rd or 2nd of a row"):
        program_of("the leftmost drawer counted from the right")


@pytest.mark.parametrize(
    ("text", "also"),
    [
        ("the red mug", []),
        ("the apple in the fridge", ["Apple|1"]),  # in a bowl that is in it
        ("the drawer next to the sink", ["Drawer|1", "Drawer|2", "Drawer|3"]),  # a stack is beside it as a whole
        ("the top drawer", []),
        ("the left cabinet", ["Cabinet|1", "Cabinet|3"]),  # the left end of the row below; alone in the row above
    ],
)
def test_candidates_are_what_a_person_might_take_it_for(text: str, also: list[str]) -> None:
    graph = kitchen_graph()
    assert candidates(text, loose(graph)) == sorted({*resolve(text, graph), *also})


def test_candidates_cover_other_words_and_colours_that_look_alike() -> None:
    room = [
        thing("Mug|1", (0, 0, 0), (0.1, 0.1, 0.1), color="red"),
        thing("Cup|1", (1, 0, 0), (0.1, 0.1, 0.1), color="orange"),
        thing("Mug|2", (2, 0, 0), (0.1, 0.1, 0.1), color="green"),
    ]
    graph = SceneGraph.from_objects(room)
    assert resolve("the red mug", graph) == ["Mug|1"]
    assert candidates("the red mug", loose(graph)) == ["Cup|1", "Mug|1"]
    assert candidates("the green mug", loose(graph)) == ["Mug|2"]


def test_columns_side_by_side_have_several_tops() -> None:
    columns = [thing(f"Drawer|{x}{z}", (0.5 * x, 0, z / 4), (0.5, 0.5, 0.24)) for x in range(2) for z in range(2)]
    graph = SceneGraph.from_objects([*columns, thing("Drawer|alone", (5, 0, 0.4), (0.5, 0.5, 0.24))])
    assert resolve("the top drawer", graph) == ["Drawer|alone"]
    assert candidates("the top drawer", loose(graph)) == ["Drawer|01", "Drawer|11", "Drawer|alone"]


def test_words_of_the_catalogue_decide_what_is_mistaken_for_what() -> None:
    assert may_be_called("Towel") == {"Towel", "HandTowel"}
    assert may_be_called("HandTowel") == {"HandTowel"}
    assert "TissueBox" in may_be_called("Box")
    assert similar_words("red") >= {"red", "orange"}
    assert "green" not in similar_words("red")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fridge", "expected a phrase that starts with 'the'"),
        ("the frigde", "no object type is called 'frigde'; did you mean 'fridge'"),
        ("the shiny fridge", "'shiny' is no colour, material or place"),
        ("the mug from the left", "'from the left' is said of the second or third of a row"),
        ("the mug behind the bowl", "'behind' is no relation that phrases say; they say in, on, .*, closest to"),
        ("the second cup inside the box on the desk", "'inside' is no relation"),
        ("the mug on the tabel", "no object type is called 'tabel'"),
        ("", "expected a phrase"),
    ],
)
def test_phrases_that_are_not_understood_are_explained(text: str, message: str) -> None:
    with pytest.raises(ProgramError, match=message):
        resolve(text, kitchen_graph())


@pytest.mark.parametrize(
    "step",
    [
        ["filter_type", "Frigde"],
        ["relate", "beside", []],
        ["relate", "on", "Fridge"],
        ["stack", "second"],
        ["sing"],
        [],
    ],
)
def test_steps_that_cannot_be_executed_are_named(step) -> None:
    with pytest.raises(ProgramError, match="cannot execute step"):
        resolve([step], kitchen_graph())
