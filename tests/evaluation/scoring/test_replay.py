"""Replays in real rooms: what the simulator says counts, not what the file says."""

from pathlib import Path

import numpy as np
import pytest

from remqa_data.evaluation.submission.reference import reference_rows
from remqa_data.storage.shards import read_table
from tests.helpers.submissions import results_of, scored, written

pytestmark = pytest.mark.slow


def rows_of(agent: str, rooms: Path, track: str, split: str = "test") -> list[dict]:
    return reference_rows(agent, rooms, track, split, np.random.default_rng(0))


@pytest.mark.parametrize("split", ["train", "test"])
@pytest.mark.parametrize("suffix", [".jsonl", ".parquet"])
def test_the_oracle_scores_one_in_everything(two_rooms: Path, tmp_path: Path, split: str, suffix: str) -> None:
    for track, measures in {
        "remqa": ("S_N", "S_L", "S_QA", "S_M", "S_MQA", "answer_accuracy", "manipulated"),
        "nav": ("success", "SPL"),
        "rec": ("prec@0.5", "prec@0.9", "mean_iou"),
        "qa": ("answer_accuracy",),
    }.items():
        path = written(tmp_path / f"{track}{suffix}", track, rows_of("oracle", two_rooms, track, split), split)
        scores = scored(two_rooms, path)
        assert {name: scores.measures[name].min() for name in measures} == dict.fromkeys(measures, 1)
        assert scores.refused == 0
        assert scores.answered.all()


def test_within_25_steps_the_oracle_succeeds_where_its_way_is_no_longer(two_rooms: Path, tmp_path: Path) -> None:
    path = written(tmp_path / "a.jsonl", "nav", rows_of("oracle", two_rooms, "nav", "train"), "train")
    steps = read_table(two_rooms, "questions", "train", ["path_steps"])["path_steps"].to_numpy()
    assert scored(two_rooms, path).measures["success@25"].tolist() == (steps <= 25).tolist()


def test_scores_do_not_depend_on_workers_or_row_order(two_rooms: Path, tmp_path: Path) -> None:
    rows = rows_of("random", two_rooms, "remqa")
    one = scored(two_rooms, written(tmp_path / "a.jsonl", "remqa", rows))
    two = scored(two_rooms, written(tmp_path / "b.jsonl", "remqa", rows[::-1]), workers=2)
    assert one.refused == two.refused > 0
    assert one.measures.keys() >= {"S_N", "S_QA", "S_MQA"}
    for name, values in one.measures.items():
        assert values.tolist() == two.measures[name].tolist()


def test_who_knows_nothing_scores_little(two_rooms: Path, tmp_path: Path) -> None:
    for agent in ("random", "blind"):
        results = results_of(
            two_rooms, written(tmp_path / f"{agent}.jsonl", "remqa", rows_of(agent, two_rooms, "remqa"))
        )
        assert results.metric("S_QA").value < 0.2
        assert results.metric("answer_accuracy").value < 0.9


def test_an_agent_cannot_talk_itself_to_the_goal(two_rooms: Path, tmp_path: Path) -> None:
    rows = rows_of("oracle", two_rooms, "remqa")
    still = [row | {"actions": []} for row in rows]
    scores = scored(two_rooms, written(tmp_path / "still.jsonl", "remqa", still))
    assert scores.measures["S_N"].mean() < 0.5
    assert scores.measures["answer_accuracy"].all()
    assert (scores.measures["S_QA"] <= scores.measures["S_N"]).all()
    turned = [row | {"actions": [*row["actions"][:-1], "RotateLeft", "RotateLeft"]} for row in rows]
    assert not scored(two_rooms, written(tmp_path / "turned.jsonl", "remqa", turned)).measures["S_N"].any()
    elsewhere = [row | {"box": [0, 0, 1, 1]} for row in rows]
    scores = scored(two_rooms, written(tmp_path / "box.jsonl", "remqa", elsewhere))
    assert scores.measures["S_N"].all()
    assert not scores.measures["S_L"].any()


def test_manipulations_that_the_room_refuses_or_of_other_things_do_not_count(two_rooms: Path, tmp_path: Path) -> None:
    rows = rows_of("oracle", two_rooms, "remqa")
    assert rows
    for manipulation in (
        "OpenObject Nothing|1",
        "PickupObject Floor|1",
        "MoveObject Wall 0 0 0",
        "CloseObject @0.5,0.5",
        None,
    ):
        changed = [row | {"manipulation": manipulation} for row in rows]
        scores = scored(two_rooms, written(tmp_path / "a.jsonl", "remqa", changed))
        for name in ("manipulated", "S_M", "S_MQA"):
            assert not scores.measures[name].any()
        assert scores.measures["S_QA"].all()  # as published: navigated, localised, answered
        assert scores.refused == (0 if manipulation is None else len(rows))


def test_what_one_question_changes_in_a_room_is_undone_for_the_next(two_rooms: Path, tmp_path: Path) -> None:
    rows = rows_of("oracle", two_rooms, "remqa", "train")
    alone = [
        scored(two_rooms, written(tmp_path / "a.jsonl", "remqa", [row], "train")).measures["S_QA"].sum() for row in rows
    ]
    assert alone == [1] * len(rows)


def test_walking_into_walls_counts_as_steps_but_not_as_way(two_rooms: Path, tmp_path: Path) -> None:
    rows = rows_of("oracle", two_rooms, "nav")
    bumping = [row | {"actions": ["MoveAhead"] * 40} for row in rows]
    scores = scored(two_rooms, written(tmp_path / "a.jsonl", "nav", bumping))
    assert scores.refused > 12 * 20  # no room is 5 m long in every direction
    assert not scores.measures["success@25"].any()
