import json
from importlib import resources
from pathlib import Path

import pandas as pd
import pytest
import yaml

from remqa_data.assets.registry import TYPES
from remqa_data.catalog import (
    ObjectType,
    catalog,
    object_type,
    plural,
    question_types,
    read_catalog,
    traits,
    types_with,
    with_article,
)
from remqa_data.errors import CatalogError, RemqaError, UnknownNameError

OPENABLE = {  # as the iTHOR documentation lists them
    "Blinds", "Book", "Box", "Cabinet", "Drawer", "Fridge", "Kettle", "Laptop", "LaundryHamper", "Microwave", "Safe",
    "ShowerCurtain", "ShowerDoor", "Toilet",
}  # fmt: skip
ROOT = Path(__file__).parents[1]
CODE = [
    *(ROOT / "remqa_data" / room for room in ("floorplans", "language", "sim", "thor")),
    ROOT / "generators",
    ROOT / "agents",
]
A_MUG = {
    "words": ["mug", "mugs"],
    "can": ["pickupable", "receptacle"],
    "manipulation": "Pickup",
    "mass_kg": 1.0,
    "materials": ["Ceramic"],
    "rooms": ["kitchen"],
}


@pytest.fixture(scope="module")
def floor_plans() -> pd.DataFrame:
    with resources.as_file(resources.files("remqa_data.templates") / "ithor_floorplans.parquet") as path:
        return pd.read_parquet(path)


@pytest.fixture(scope="module")
def recorded_types(floor_plans):
    """The types that a floor plan has; the others say themselves how large they are."""
    recorded = set(floor_plans["objectType"])
    return {name: kind for name, kind in catalog().items() if name in recorded}


def test_every_type_is_drawn():
    assert set(TYPES) == set(catalog())


def test_the_types_are_those_of_the_floor_plans_and_such_as_say_how_large_they_are(floor_plans, recorded_types):
    assert set(recorded_types) == set(floor_plans["objectType"])
    assert len(recorded_types) == 118
    assert list(catalog()) == sorted(catalog())
    for name, kind in catalog().items():
        assert (kind.size_m is None) == (name in recorded_types), name


@pytest.mark.parametrize("flag", ["openable", "pickupable", "moveable", "receptacle", "toggleable", "breakable"])
def test_a_flag_is_what_the_majority_of_recorded_objects_says(floor_plans, recorded_types, flag):
    share = floor_plans.groupby("objectType")[flag].mean()
    assert {name for name, kind in recorded_types.items() if getattr(kind, flag)} == set(share.index[share >= 0.5])


def test_the_openable_types_are_the_documented_fourteen(floor_plans, recorded_types):
    assert {name for name, kind in recorded_types.items() if kind.openable} == OPENABLE


def test_masses_are_the_recorded_ones(floor_plans, recorded_types):
    share = floor_plans[floor_plans["pickupable"] | floor_plans["moveable"]]
    recorded = share.groupby("objectType")["mass"].median()
    given = {name: kind.mass_kg for name, kind in recorded_types.items() if kind.mass_kg is not None}
    assert set(given) == set(recorded.index)
    assert {name: round(mass, 3) for name, mass in given.items()} == {
        name: pytest.approx(mass, rel=0.02, abs=1e-3) for name, mass in recorded.items()
    }


def test_rooms_are_those_in_which_the_type_occurs(floor_plans, recorded_types):
    recorded = floor_plans.groupby("objectType")["room"].agg(set)
    assert {name: set(kind.rooms) for name, kind in recorded_types.items()} == recorded.to_dict()


def test_materials_are_among_the_recorded_ones(floor_plans, recorded_types):
    recorded = floor_plans.groupby("objectType")["salientMaterials"].agg(
        lambda lists: {m for one in lists for m in one}
    )
    assert any(kind.materials for kind in recorded_types.values())
    for name, kind in recorded_types.items():
        assert set(kind.materials) <= recorded[name], name


def test_questions_use_sixty_types_each_in_a_quarter_of_the_floor_plans(floor_plans, recorded_types):
    scenes = floor_plans.groupby("objectType")["scene"].nunique()
    handled = {name for name, kind in recorded_types.items() if kind.manipulation is not None}
    frequent = {name for name in handled if scenes[name] >= 30}
    assert len(frequent) == 62
    assert len(question_types()) == 60
    assert frequent - set(question_types()) == {"Blinds", "FloorLamp"}


def test_the_two_types_left_out_hold_nothing_and_lie_in_nothing(floor_plans):
    type_of = dict(zip(floor_plans["scene"] + floor_plans["objectId"], floor_plans["objectType"], strict=True))
    assert {"Blinds", "FloorLamp"} <= set(floor_plans["objectType"])
    for row in floor_plans.itertuples():
        parents = {type_of.get(row.scene + parent) for parent in row.parentReceptacles}
        assert not parents & {"Blinds", "FloorLamp"}
        if row.objectType in ("Blinds", "FloorLamp"):
            assert parents <= {"Floor"}


@pytest.mark.parametrize(
    ("name", "manipulation"),
    [("Drawer", "Open"), ("Box", "Open"), ("Microwave", "Open"), ("Book", "Pickup"), ("Laptop", "Pickup"),
     ("Chair", "Move"), ("Floor", None)],
)  # fmt: skip
def test_the_manipulation_is_the_one_that_reveals_something(name, manipulation):
    assert object_type(name).manipulation == manipulation


def test_every_type_that_can_be_handled_has_a_manipulation_mass_and_material():
    assert len(catalog()) >= 118
    for name, kind in catalog().items():
        assert (kind.manipulation is None) != (kind.openable or kind.pickupable or kind.moveable), name
        assert (kind.mass_kg is not None) == bool(kind.materials) == (kind.pickupable or kind.moveable), name


def test_singular_and_plural_differ():
    assert catalog()
    assert [name for name, kind in catalog().items() if kind.singular == kind.plural] == []


def test_no_word_stands_for_two_types():
    words = [word for kind in catalog().values() for word in {*kind.words, *kind.synonyms}]
    assert len(words) == len(set(words))


def test_words_are_plain_lower_case_except_abbreviations():
    assert len(catalog()) >= 118
    for kind in catalog().values():
        for word in (*kind.words, *kind.synonyms):
            letters = word.replace("TV", "").replace("CDs", "").replace("CD", "").replace(" ", "")
            assert letters == "" or (letters.isalpha() and letters.islower()), word


@pytest.mark.parametrize(
    ("name", "several"),
    [("GarbageCan", "garbage cans"), ("Knife", "knives"), ("Shelf", "shelves"), ("Tomato", "tomatoes"),
     ("Watch", "watches"), ("Bread", "loaves of bread"), ("CD", "CDs")],
)  # fmt: skip
def test_plurals(name, several):
    assert plural(name) == several


@pytest.mark.parametrize(
    ("name", "one"), [("Egg", "an egg"), ("Mug", "a mug"), ("AlarmClock", "an alarm clock"), ("TVStand", "a TV stand")]
)
def test_articles(name, one):
    assert with_article(name) == one


def test_an_unknown_type_is_answered_with_the_nearest_names():
    with pytest.raises(UnknownNameError, match=r"unknown object type 'garbagecan'; did you mean 'GarbageCan'"):
        object_type("garbagecan")
    with pytest.raises(UnknownNameError, match=r"^unknown object type 'xyzzy'; known are 'AlarmClock', .*, \.\.\.$"):
        plural("xyzzy")


def test_a_name_as_long_as_a_page_is_named_in_one_line() -> None:
    assert len(str(UnknownNameError("frame", "[" * 4000, ["FloorPlan1-000"]))) < 200


def test_an_object_type_survives_json_and_yaml():
    assert len(catalog()) >= 118
    for name, kind in catalog().items():
        assert ObjectType.model_validate_json(kind.model_dump_json()) == kind
        row = json.loads(kind.model_dump_json(exclude={"name"}))
        assert read_catalog(yaml.safe_dump({name: row}))[name] == kind


def test_the_catalog_cannot_be_changed():
    with pytest.raises(TypeError):
        catalog()["Mug"] = None  # type: ignore[index]
    with pytest.raises(ValueError, match="frozen"):
        object_type("Mug").mass_kg = 2.0
    assert catalog() is catalog()


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"words": None}, "Mug.words"),
        ({"words": ["mug"]}, "Mug.words"),
        ({"words": [1, 2]}, "Mug.words.0"),
        ({"mass_kg": "heavy"}, "Mug.mass_kg"),
        ({"mass_kg": -1.0}, "Mug.mass_kg"),
        ({"can": ["pickupable", "edible"]}, "Mug.can"),
        ({"can": "pickupable"}, "Mug.can"),
        ({"manipulation": "Push"}, "Mug.manipulation"),
        ({"manipulation": "Open"}, "Mug: .*manipulation Open"),
        ({"rooms": []}, "Mug.rooms"),
        ({"rooms": ["garage"]}, "Mug.rooms"),
        ({"question_type": "perhaps"}, "Mug.question_type"),
        ({"colour": "red"}, "Mug.colour"),
        ({"size_m": [0.1, 0.1]}, "Mug.size_m"),
        ({"size_m": [0.1, 0.1, 0]}, "Mug.size_m"),
        ({"name": "Cup"}, "Mug.name"),
    ],
)
def test_a_damaged_entry_is_refused_with_its_type_and_field(change, field):
    with pytest.raises(CatalogError, match=field) as caught:
        read_catalog(yaml.safe_dump({"Mug": {**A_MUG, **change}}))
    assert isinstance(caught.value, RemqaError)


@pytest.mark.parametrize("field", ["words", "can", "manipulation", "rooms"])
def test_a_missing_field_is_named(field):
    row = {key: value for key, value in A_MUG.items() if key != field}
    with pytest.raises(CatalogError, match=rf"Mug\.{field}: .*required"):
        read_catalog(yaml.safe_dump({"Mug": row}))


@pytest.mark.parametrize("text", ["Mug: {words: [mug", "- Mug", "Mug: mug", "12: {words: [mug, mugs]}", ""])
def test_what_is_not_a_catalog_is_refused(text):
    with pytest.raises(CatalogError, match=r"objects\.yaml"):
        read_catalog(text)


def test_a_trait_that_is_not_documented_is_refused() -> None:
    text = "Mug: {words: [mug, mugs], can: [pickupable], manipulation: Pickup, rooms: [kitchen], traits: [magic]}"
    with pytest.raises(CatalogError, match=r"Mug\.traits: .*'magic' is not among the traits of traits\.yaml"):
        read_catalog(text)


def test_every_trait_is_somebodys_and_is_asked_for() -> None:
    code = "\n".join(path.read_text(encoding="utf-8") for top in CODE for path in top.rglob("*.py"))
    assert len(traits()) > 20
    for trait in traits():
        assert types_with(trait), trait
        assert f'types_with("{trait}")' in code, trait


def test_an_unknown_trait_is_an_error() -> None:
    with pytest.raises(UnknownNameError, match=r"unknown trait 'on_wal'.*on_wall"):
        types_with("on_wal")
