"""Which rows and columns a comparison with a room made again names."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from remqa_data.generators.audit import remade
from remqa_data.generators.audit.failures import Failure
from remqa_data.generators.audit.remade import remade_failures
from remqa_data.generators.config import load_config
from remqa_data.generators.questions.allotment import SceneQuota
from remqa_data.generators.scene_plan import Job
from tests.helpers.dataset_rows import scene_rows


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[Any]]:
    rows = scene_rows("Kitchen3", "test")
    monkeypatch.setattr(remade, "make_room", lambda job: (rows, {"refused": {}}))
    return rows


def failures(stored: dict[str, Any]) -> list[Failure]:
    job = Job(SceneQuota("Kitchen3", "kitchen", "test", {}), load_config("paper"))
    return remade_failures(job, stored)[0]


def test_what_is_made_again_as_it_is_stored_has_no_failure(made) -> None:
    assert failures(made) == []


@pytest.mark.parametrize("place", [0, 10, 20])
def test_the_row_and_the_columns_that_differ_are_named(made, place: int) -> None:
    frames = list(made["frames"])
    frames[place] = replace(frames[place], index=77, split="train")
    (failure,) = failures(made | {"frames": frames})
    assert failure.where == frames[place].frame_id
    assert failure.reason.startswith("split, index:")


def test_all_rows_that_differ_are_named_in_their_order(made) -> None:
    wrong = [replace(row, path_length_m=float(np.nextafter(row.path_length_m, 9.0))) for row in made["questions"]]
    found = failures(made | {"questions": wrong})
    assert [failure.where for failure in found] == [row.question_id for row in wrong]
    assert {failure.reason.partition(":")[0] for failure in found} == {"path_length_m"}


def test_minus_zero_is_not_zero(made) -> None:
    state = made["scenes"][1]
    scenes = [made["scenes"][0], replace(state, semantic_map=replace(state.semantic_map, voxel_m=-0.0))]
    again = [made["scenes"][0], replace(state, semantic_map=replace(state.semantic_map, voxel_m=0.0))]
    made["scenes"][:] = again
    (failure,) = failures(made | {"scenes": scenes})
    assert failure.reason.startswith("semantic_map:")
