"""Configurations that ask for sampled rooms: any number of them, dealt out like recorded ones."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from remqa_data.errors import ConfigError
from remqa_data.floorplans.sampled.naming import ROOM_TYPES, sampled_name
from remqa_data.floorplans.splits import expression_split, split_of
from remqa_data.generators.config import Config, load_config
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.yaml_files import parsed

PAPER = Path(__file__).parents[2] / "configs" / "paper.yaml"


@pytest.fixture(scope="module")
def sampled() -> Config:
    return load_config(PAPER).with_layouts("sampled")


def test_other_layouts_make_another_dataset(sampled: Config) -> None:
    assert sampled.scene_names[:2] == ("Sampled-kitchen-000000", "Sampled-living_room-000001")
    assert sampled.sha256 != load_config(PAPER).sha256
    assert sampled.with_layouts("ithor").sha256 == load_config(PAPER).sha256


def test_120_sampled_rooms_are_split_like_the_published_ones(sampled: Config) -> None:
    splits = [split_of(name) for name in sampled.scene_names]
    assert (splits.count("train"), splits.count("test")) == (100, 20)


def test_rooms_that_test_questions_are_about_also_test_expressions() -> None:
    names = [sampled_name(index) for index in range(48)]
    assert [split_of(name) == "test" for name in names] == [expression_split(name) == "test" for name in names]


def test_every_type_of_sampled_room_has_its_row_in_the_table_of_what_such_rooms_owe() -> None:
    rooms = capacities([sampled_name(index) for index in range(len(ROOM_TYPES))])
    assert [room.room_type for room in rooms] == [*ROOM_TYPES]


@pytest.mark.slow
@settings(max_examples=30)
@given(count=st.integers(1, 600))
def test_any_number_of_rooms_can_be_allotted(sampled: Config, count: int) -> None:
    config = sampled.with_scenes(count)
    quotas = allot(capacities(config.scene_names), config.totals)
    assert len(quotas) == count
    assert any(config.totals.values())
    for split, by_kind in config.totals.items():
        for kind, total in by_kind.items():
            assert sum(quota.total(kind) for quota in quotas if quota.split == split) == total


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("scenes: 120", "scenes: 1000001", "more than the 1000000 rooms"),
        ("scenes: 120", "scenes: [FloorPlan1]", "no room 'FloorPlan1'; name rooms such as Sampled-kitchen-000000"),
        (
            "scenes: 120",
            "scenes: [Sampled-kitchen-000001]",
            "no room 'Sampled-kitchen-000001', as number 1 is Sampled-living",
        ),
    ],
)
def test_rooms_that_are_not_there_are_refused(old: str, new: str, message: str) -> None:
    text = PAPER.read_text(encoding="utf-8").replace("layouts: ithor", "layouts: sampled").replace(old, new)
    with pytest.raises(ConfigError, match=message):
        parsed(Config, text, "my.yaml")


def test_a_configuration_that_names_rooms_cannot_change_layouts() -> None:
    text = PAPER.read_text(encoding="utf-8").replace("scenes: 120", "scenes: [FloorPlan1]")
    config = parsed(Config, text, "my.yaml")
    with pytest.raises(ConfigError, match="names rooms of the layouts ithor"):
        config.with_layouts("sampled")


def test_recorded_rooms_are_not_as_many_as_sampled_ones(sampled: Config) -> None:
    with pytest.raises(
        ConfigError, match=r"^layouts ithor: scenes: 500 is more than the 120 rooms of the layouts ithor"
    ):
        sampled.with_scenes(500).with_layouts("ithor")
