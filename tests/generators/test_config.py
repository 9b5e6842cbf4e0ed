from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.errors import ConfigError
from remqa_data.floorplans.splits import split_of
from remqa_data.generators.config import Config, load_config, presets
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.yaml_files import parsed

CONFIGS = Path(__file__).parents[2] / "configs"
PAPER = (CONFIGS / "paper.yaml").read_text(encoding="utf-8")


def test_the_published_numbers() -> None:
    config = load_config(CONFIGS / "paper.yaml")
    assert config.totals == {
        "train": {"EXISTENCE": 1653, "COUNTING": 647, "SPATIAL": 1083},
        "test": {"EXISTENCE": 324, "COUNTING": 143, "SPATIAL": 222},
    }
    assert len(config.scene_names) * config.configurations * config.walk.frames_per_configuration > 10_000
    assert sum(split_of(name) == "test" for name in config.scene_names) == 20


def test_a_preset_is_loaded_by_its_name_and_a_file_of_that_name_comes_first(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper").mkdir()  # a folder is no configuration
    assert presets() == ("paper", "tiny")
    for name in presets():
        assert load_config(name) == load_config(CONFIGS / f"{name}.yaml")
    (tmp_path / "tiny").write_text(PAPER, encoding="utf-8")
    assert load_config("tiny") == load_config("paper")
    with pytest.raises(
        ConfigError, match=r"^tny: No such file or directory; .* presets paper, tiny; did you mean 'tiny'"
    ):
        load_config("tny")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper.yaml", "tiny.yaml"])
def test_the_configurations_can_be_allotted(name) -> None:
    config = load_config(CONFIGS / name)
    quotas = allot(capacities(config.scene_names), config.totals)
    assert sum(q.total(kind) for q in quotas for kind in q.answers) == sum(
        sum(by_kind.values()) for by_kind in config.totals.values()
    )


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 12, 30, 60, 119])
def test_fewer_rooms_ask_in_proportion_and_can_be_allotted(count) -> None:
    whole = load_config(CONFIGS / "paper.yaml")
    config = whole.with_scenes(count)
    assert len(config.scene_names) == count
    for split, rooms in (("train", 100), ("test", 20)):
        here = sum(split_of(name) == split for name in config.scene_names)
        for kind, total in whole.totals[split].items():
            assert abs(config.totals[split][kind] - total * here / rooms) <= 0.5
    allot(capacities(config.scene_names), config.totals)


def test_a_list_of_rooms_is_cut_short() -> None:
    config = load_config(CONFIGS / "tiny.yaml").with_scenes(3)
    assert config.scene_names == ("FloorPlan4", "FloorPlan212", "FloorPlan308")
    assert config.totals["train"] == {"EXISTENCE": 12, "COUNTING": 8, "SPATIAL": 12}
    assert set(config.totals["test"].values()) == {0}


def test_a_list_of_rooms_is_not_made_longer() -> None:
    with pytest.raises(ConfigError, match=r"scenes: 7 is not between 1 and 4, the rooms that the configuration names$"):
        load_config(CONFIGS / "tiny.yaml").with_scenes(7)


@pytest.mark.slow
def test_more_questions_than_are_ever_asked_are_one_line() -> None:
    with pytest.raises(
        ConfigError, match=r"^scenes: 1,000,000 rooms would be asked 13,.* questions of a kind: EXISTENCE"
    ):
        load_config("paper").with_layouts("sampled").with_scenes(1_000_000)


@pytest.mark.slow
@given(st.integers().filter(lambda n: not 1 <= n <= 120))
def test_numbers_of_rooms_that_there_are_not(count) -> None:
    with pytest.raises(ConfigError, match="between 1 and 120"):
        load_config(CONFIGS / "paper.yaml").with_scenes(count)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seed: 0", "seed: -1", "seed: .*greater than or equal to 0"),
        ("seed: 0", "", "seed: Field required"),
        ("seed: 0", "seed: [", "not YAML"),
        ("scenes: 120", "scenes: 0", "scenes: .*greater than or equal to 1"),
        ("scenes: 120", "scenes: 121", "scenes: 121 is more than the 120 rooms"),
        ("scenes: 120", "scenes: [FloorPlan31]", "scenes: there is no room 'FloorPlan31'"),
        ("scenes: 120", "scenes: [FloorPlan1, FloorPlan1]", "scenes: 'FloorPlan1' is named twice"),
        ("scenes: 120", "scenes: []", "scenes: expected a number of rooms, or a list of their names .*, found \\[\\]"),
        ("scenes: 120", "scenes: [1, 2]", "scenes: expected a number of rooms, or a list of their names"),
        ("scenes: 120", "scenes: FloorPlan1", "scenes: expected a number of rooms, or a list .*, found 'FloorPlan1'"),
        ("scenes: 120", "scenes: '3'", "scenes: expected a number of rooms, or a list .*, found '3'"),
        ("configurations: 4", "configurations: 3", "configurations: .*greater than or equal to 4"),
        ("SPATIAL: 222", "SPATIAL: many", "questions.test.SPATIAL: .*integer"),
        ("rgb_format: jpeg", "rgb_format: gif", "image.rgb_format: .*'jpeg' or 'png'"),
        ("walk:", "wlk:", "wlk: there is no such key; did you mean 'walk'"),
        ("image:", "images:", "images: there is no such key; did you mean 'image'"),
        ("configurations: 4", "configuration: 4", "configuration: there is no such key; did you mean 'configurations'"),
        ("rgb_format: jpeg", "rgb_format: jpeg\n  lihgt: flat", "image.lihgt: .*; did you mean 'light'"),
        ("cells_per_frame: 1.0", "cells_per_frame: 1.0\n  speed: 1", "walk.speed: there is no such key$"),
        ("horizons_deg: [0, 30]", "horizons_deg: []", "walk.horizons_deg: .*at least 1"),
        ("horizons_deg: [0, 30]", "horizons_deg: [0, 30, 0]", "walk.horizons_deg: 0 is there twice"),
        ("horizons_deg: [0, 30]", "horizons_deg: [0, 30]\n  headings_deg: [0]", ".*'headings_deg' is there twice"),
        ("seed: 0", "seed: !!python/object:os.system x", r"line 2, column 7: tags \(!\) are not read$"),
        ("seed: 0", "seed: 0\n---\nseed: 1", "line 3, column 1: a second document, where one is read$"),
        ("seed: 0", "seed: 0\nseed: 1", "line 3: the key 'seed' is there twice"),
    ],
)
def test_mistakes_are_told_in_one_line_with_file_and_key(old, new, message) -> None:
    assert old in PAPER
    with pytest.raises(ConfigError, match=f"^my.yaml: {message}") as caught:
        parsed(Config, PAPER.replace(old, new, 1), "my.yaml")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "# nothing\n", "---\n"])
def test_a_file_that_says_nothing(text) -> None:
    with pytest.raises(ConfigError, match=r"^my\.yaml: says nothing; expected keys such as 'seed'$"):
        parsed(Config, text, "my.yaml")


def test_a_missing_file_and_a_file_of_something_else(tmp_path) -> None:
    with pytest.raises(ConfigError, match=r"none\.yaml: No such file"):
        load_config(tmp_path / "none.yaml")
    (tmp_path / "list.yaml").write_text("[1, 2]")
    with pytest.raises(ConfigError, match=r"list\.yaml: expected keys"):
        load_config(tmp_path / "list.yaml")


def test_a_file_may_begin_with_a_byte_order_mark(tmp_path) -> None:
    (tmp_path / "my.yaml").write_text(PAPER, encoding="utf-8-sig")
    assert load_config(tmp_path / "my.yaml") == load_config("paper")


def test_the_hash_follows_what_is_said_not_how() -> None:
    config = parsed(Config, PAPER, "paper.yaml")
    commented = "# a comment\n" + PAPER.replace("[0, 30]", "[ 0, 30 ]")
    assert parsed(Config, commented, "paper.yaml").sha256 == config.sha256
    assert config.with_seed(1).sha256 != config.sha256
    assert config.with_scenes(120).sha256 == config.sha256


def test_headings_are_kept_as_they_are_stored() -> None:
    given = PAPER.replace("headings_deg: [0, 90, 180, 270]", "headings_deg: [360, -90, 45, -360]")
    assert given != PAPER
    with pytest.raises(ConfigError, match="-360 is there twice"):
        parsed(Config, given, "my.yaml")
    assert parsed(Config, given.replace(", -360", ""), "my.yaml").walk.headings_deg == (0, 270, 45)


def test_a_configuration_that_names_its_rooms_says_how_to_take_others() -> None:
    with pytest.raises(ConfigError, match=r"let its file say how many instead, such as scenes: 4$"):
        load_config("tiny").with_layouts("sampled")
