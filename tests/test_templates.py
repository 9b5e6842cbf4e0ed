"""Files of rules that somebody has edited: each mistake is one line that names the file, the key and what is wrong."""

import pytest
from pydantic import BaseModel

from remqa_data import yaml_files
from remqa_data.assets.core import sizes
from remqa_data.catalog import read_catalog
from remqa_data.errors import CatalogError, ConfigError
from remqa_data.generators.arrangement.hiding_rules import HidingRules
from remqa_data.generators.arrangement.plausible import PlausibleTypes
from remqa_data.language.question_rules import QuestionRules
from remqa_data.language.rules import ExpressionRules
from remqa_data.scene_graph.relations import RelationRules
from remqa_data.sim.physics.support import SupportRules
from remqa_data.yaml_files import parsed, template_rules, template_text

KINDS: dict[str, type[BaseModel]] = {
    "relations.yaml": RelationRules,
    "expressions.yaml": ExpressionRules,
    "questions.yaml": QuestionRules,
    "plausible.yaml": PlausibleTypes,
    "hiding.yaml": HidingRules,
    "support.yaml": SupportRules,
    "sizes.yaml": sizes._Measured,
}
MISTAKES = [
    ("relations.yaml", "next_to:", "foo: 1\nnext_to:", "foo: there is no such key"),
    ("relations.yaml", "next_to:", "nextto:", "nextto: there is no such key; did you mean 'next_to'"),
    (
        "relations.yaml",
        "next_to:",
        "near_miss_factor: 2\nnext_to:",
        "line [0-9]+: the key 'near_miss_factor' is there twice",
    ),
    ("relations.yaml", "legs: [ArmChair", "legs: [Armchair", r"under.legs.0: .*'Armchair'; did you mean 'ArmChair'"),
    ("relations.yaml", "  next to: next to\nsounds", "sounds", "words: there is no entry for 'next to'"),
    ("relations.yaml", "  below: above", "  below: null", "inverses: that of 'above' is 'below', so that of 'below'"),
    ("relations.yaml", "max_gap_m: 0.05", "max_gap_m: .nan", "floor.max_gap_m: .*finite"),
    ("expressions.yaml", "[Fridge, Bed", "[Frigde, Bed", r"landmarks.0.0: .*'Frigde'; did you mean 'Fridge'"),
    ("expressions.yaml", "  CounterTop:", "  Countertop:", "only_for.Countertop: .*did you mean 'CounterTop'"),
    ("expressions.yaml", "  Cup: [Mug]", "  Cup: [Mugg]", "may_mean.Cup.0: .*did you mean 'Mug'"),
    ("relations.yaml", "  under: under", "  under: below", "words: 'below' is said for two relations"),
    ("relations.yaml", "behind: behind", "behind: under", "words: 'under' is said for two relations"),
    (
        "relations.yaml",
        "  next to: next to\nsounds",
        '  next to: ""\nsounds',
        "words.next to: expected words of letters",
    ),
    ("relations.yaml", '  "on": "on"', '  on: "on"', 'line [0-9]+: YAML reads on as true or false; write "on"'),
    ("relations.yaml", "  under: under", "  under: of", "words: 'of' is said in 'roll of aluminum foil', too"),
    (
        "expressions.yaml",
        "closest_word: closest to",
        "closest_word: next to",
        "closest_word: 'next to' is what relations.yaml",
    ),
    ("expressions.yaml", "{top: highest,", "{left: highest,", "'left' is said for two things"),
    ("expressions.yaml", "third: third", "third: fourth", "row_ordinals.third: .*'second' or 'third'"),
    (
        "expressions.yaml",
        "from the right: from the right",
        "from the right: right",
        "row_sides.from the right: .*'from the left'",
    ),
    (
        "questions.yaml",
        "spatial_words: {in: inside}",
        "spatial_words: {}",
        "spatial_words: SPATIAL and EXISTENCE both ask 'Is there",
    ),
    (
        "questions.yaml",
        "spatial_words: {in: inside}",
        "spatial_words: {in: under}",
        "spatial_words: 'under' is said for two",
    ),
    ("questions.yaml", "many {objs}", "many {a_obj}", "templates: how many is asked of {objs}, not of {a_obj}"),
    (
        "questions.yaml",
        '{"on": 1.0, next to: 1.0, behind: 1.5, between: 1.0}',
        '{"on": 0, next to: 0, behind: 0, between: 0}',
        "inner_relations: one of them must be likelier than 0",
    ),
    ("expressions.yaml", "column_min_share: 0.5", "column_min_share: 5", "column_min_share: .*less than or equal to 1"),
    ("questions.yaml", "many {objs}", "many {objects}", "templates: expected the placeholders {re}, .*{objects}"),
    ("questions.yaml", "{relation} {re}", "{relation}", "templates: .* found .*; of these it needs {re}"),
    (
        "questions.yaml",
        "there {relation} {re}",
        "in {re}",
        "templates: .* found 'How many .*; of these it needs .*{relation}",
    ),
    (
        "questions.yaml",
        "How many {objs}",
        "What",
        "templates: expected the placeholder {a_obj} or {objs}, found 'What are",
    ),
    ("questions.yaml", "the {obj2} in", "the {obj3} in", "inner_template: expected the placeholders {obj}, "),
    ("questions.yaml", "in {re}", "in {re", "templates: expected the placeholders"),
    (
        "questions.yaml",
        '  EXISTENCE: "Is there {a_obj} in {re}?"\n',
        "",
        "templates: there is no entry for 'EXISTENCE'",
    ),
    ("questions.yaml", "behind: 1.5, ", "", "inner_relations: there is no entry for 'behind'"),
    ("questions.yaml", "{CD: 0.03", "{CDD: 0.03", "type_weights.CDD: .*did you mean 'CD'"),
    ("questions.yaml", "COUNTING: 0.25", "COUNTING: 7.5", "bare_share.COUNTING: .*less than or equal to 1"),
    ("questions.yaml", "[0, 1, 2, 3]", "[0, -1, 2, 3]", r"counts: expected \[0, 1\] or \[0, 1, 2, 3\]"),
    ("questions.yaml", "[0, 1, 2, 3]", "[0, 0, 7]", r"counts: expected \[0, 1\] or \[0, 1, 2, 3\]"),
    ("hiding.yaml", "  Towel: ", "  Towl: ", "folded_m.Towl: .*did you mean 'Towel'"),
    ("support.yaml", "[HandTowel]", "[HandTowl]", r"hangs.HandTowelHolder.0: .*did you mean 'HandTowel'"),
    ("sizes.yaml", "Apple: ", "Aple: ", "Aple: .*did you mean 'Apple'"),
    ("plausible.yaml", "[Apple, Bowl", "[Aple, Bowl", "unknown object type 'Aple'; did you mean 'Apple'"),
]


@pytest.mark.parametrize(("name", "old", "new", "message"), MISTAKES)
def test_a_mistake_in_a_file_of_rules_is_one_line(name: str, old: str, new: str, message: str) -> None:
    text = template_text(name)
    assert old in text
    with pytest.raises(ConfigError, match=f"^{name}: {message}") as caught:
        parsed(KINDS[name], text.replace(old, new, 1), name)
    assert str(caught.value).isprintable()


def test_a_file_of_rules_is_told_with_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(yaml_files, "template_text", lambda name: "foo: 1")
    with pytest.raises(ConfigError, match=r"^relations\.yaml: foo: there is no such key"):
        template_rules(RelationRules, "relations.yaml")


def test_an_object_type_is_there_once() -> None:
    rows = "Cup: {words: [cup, cups], can: [], manipulation: null, rooms: [kitchen]}\n"
    with pytest.raises(CatalogError, match=r"^objects\.yaml: line 2: the key 'Cup' is there twice"):
        read_catalog(rows + rows)


def test_no_two_object_types_are_called_the_same() -> None:
    rows = "Cup: {words: [cup, cups], can: [], manipulation: null, rooms: [kitchen]}\n"
    with pytest.raises(CatalogError, match=r"^objects\.yaml: Mug\.words: Cup is called 'cup', too"):
        read_catalog(rows + rows.replace("Cup", "Mug"))
