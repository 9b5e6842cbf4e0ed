"""S_M and S_MQA in real rooms: what counts is how the room is after what was submitted has been done in it.

Of the 8 questions of the train split 2 take a bin that is to be moved aside, 2 a pillow that is to be picked up, and 4 a
drawer that is to be opened. Of the test split 2 that take a microwave to be moved, and 2 that take a drawer, are used.
"""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
from remqa_data.evaluation.scoring.replay import does, load_room, walk
from remqa_data.evaluation.scoring.scoring import Scores, attempt_of
from remqa_data.evaluation.submission.reference import reference_rows
from remqa_data.sim.agent.actions import move_action, open_action, parse_action
from remqa_data.sim.agent.replay import Replay
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import EmbodimentRow
from tests.helpers.submissions import results_of, scored, written

pytestmark = pytest.mark.slow

Rows = list[dict[str, Any]]
CHAIN = ("S_N", "S_L", "S_QA", "S_M", "S_MQA")


@pytest.fixture(scope="module")
def oracle(two_rooms: Path) -> Rows:
    """What the oracle submits to the train split, with the kind and the target of what it does."""
    asked = read_table(two_rooms, "questions", "train", ["manipulation", "target_id"]).to_pylist()
    rows = reference_rows("oracle", two_rooms, "remqa", "train", np.random.default_rng(0))
    assert [row["manipulation"] for row in asked] == ["Move"] * 2 + ["Pickup"] * 2 + ["Open"] * 4
    return [row | {"about": about} for row, about in zip(rows, asked, strict=True)]


def scores_of(data: Path, tmp_path: Path, rows: Rows, split: str = "train") -> Scores:
    own = [{name: value for name, value in row.items() if name != "about"} for row in rows]
    return scored(data, written(tmp_path / "a.jsonl", "remqa", own, split))


def doing(rows: Rows, change: Callable[[str, str], str | None]) -> Rows:
    """The same but for the manipulation, made from the id of the target and the oracle's manipulation."""
    return [row | {"manipulation": change(row["about"]["target_id"], row["manipulation"])} for row in rows]


@contextmanager
def after_the_walk(data: Path, split: str, row: dict[str, Any]) -> Iterator[Replay]:
    """The room of a question, and the agent in it as it stands before its manipulation."""
    truth = load_ground_truth(data, "remqa", split)
    attempt, room = attempt_of(truth, truth.ids.to_pylist().index(row["question_id"]), row["actions"], None)
    columns = ["scene", "configuration", "scene_json", "embodiment"]
    for stored in read_table(data, "scenes", split, columns).to_pylist():
        if (stored["scene"], stored["configuration"]) == room:
            with closing(load_room(stored["scene_json"], "room", EmbodimentRow(**stored["embodiment"]))) as replay:
                walk(replay, attempt)
                yield replay


def put_at(object_id: str, position: np.ndarray) -> str:
    x, y, z = position.tolist()
    return str(move_action(object_id, (x, y, z)))


def means(scores: Scores) -> list[float]:
    return [float(scores.measures[name].mean()) for name in CHAIN]


def test_who_knows_all_answers_and_opens_nothing_has_manipulated_nothing(
    two_rooms: Path, tmp_path: Path, oracle: Rows
) -> None:
    rows = [{**row, "manipulation": None} for row in oracle]
    for row in rows:
        del row["about"]
    results = results_of(two_rooms, written(tmp_path / "a.jsonl", "remqa", rows, "train"))
    assert [results.metric(name).value for name in CHAIN] == [1, 1, 1, 0, 0]
    # Wilson's interval for 0 of 8, by hand: 0 to z^2 / (n + z^2), z = 1.959964.
    metric = results.metric("S_MQA")
    assert (metric.low, metric.high) == pytest.approx((0, 3.841459 / 11.841459), abs=1e-6)
    assert results.main_measure == "S_MQA"


def test_each_link_asks_all_before_it(two_rooms: Path, tmp_path: Path, oracle: Rows) -> None:
    wrong = {"yes": "no", "no": "yes"}
    changes: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
        "as the oracle": lambda row: {},
        "other answers": lambda row: {"answer": wrong[row["answer"]]},
        "other boxes": lambda row: {"box": [0, 0, 1, 1]},
        "stays away": lambda row: {"actions": []},
        "only drawers opened": lambda row: {} if row["about"]["manipulation"] == "Open" else {"manipulation": None},
    }
    found = {
        name: means(scores_of(two_rooms, tmp_path, [row | change(row) for row in oracle]))
        for name, change in changes.items()
    }
    assert found == {
        "as the oracle": [1, 1, 1, 1, 1],
        "other answers": [1, 1, 0, 1, 0],
        "other boxes": [1, 0, 0, 0, 0],
        "stays away": [0, 0, 0, 0, 0],
        "only drawers opened": [1, 1, 1, 0.5, 0.5],
    }


def test_a_drawer_that_is_opened_a_little_is_not_open(two_rooms: Path, tmp_path: Path, oracle: Rows) -> None:
    rows = [row for row in oracle if row["about"]["manipulation"] == "Open"]
    for openness, counts in ((0.0, False), (0.2, False), (0.79, False), (0.8, True), (0.95, True)):
        scores = scores_of(two_rooms, tmp_path, doing(rows, lambda name, _, o=openness: f"OpenObject {name} {o}"))
        assert scores.measures["S_M"].sum() == (4 if counts else 0)
        assert scores.measures["S_QA"].sum() == 4
        assert scores.refused == (4 if openness == 0 else 0)  # it is closed already


def test_a_bin_that_still_stands_over_what_it_hid_is_not_moved(two_rooms: Path, tmp_path: Path, oracle: Rows) -> None:
    rows = [row for row in oracle if row["about"]["manipulation"] == "Move"]
    target = parse_action(rows[0]["manipulation"])
    assert target.target == "GarbageCan|+03.83|-00.03|-00.50"
    with after_the_walk(two_rooms, "train", rows[0]) as replay:
        start = np.array(replay.world.state(target.target).position)
        own_m = float(np.ptp(replay.world.box(target.target)[:, 0]))
    way = np.array(target.numbers) - start  # the oracle's: its own width and a bit more, along x
    assert own_m < abs(way[0]) < own_m + 0.1
    own = own_m / abs(way[0])
    for share, counts in ((0.3, False), (own - 0.02, False), (own + 0.02, True)):
        scores = scores_of(two_rooms, tmp_path, doing(rows, lambda name, _, s=share: put_at(name, start + s * way)))
        assert scores.refused == 0
        assert scores.measures["S_M"].sum() == (2 if counts else 0)
    lifted = doing(rows, lambda name, _: put_at(name, start + np.array([0, 0, 0.5])))
    scores = scores_of(two_rooms, tmp_path, lifted)
    assert (scores.refused, scores.measures["S_M"].sum()) == (0, 0)  # it hangs over what it hid


@pytest.mark.parametrize("word", ["PullObject", "PickupObject", "CloseObject"])
def test_what_a_drawer_refuses_does_not_open_it(two_rooms: Path, tmp_path: Path, oracle: Rows, word: str) -> None:
    rows = [row for row in oracle if row["about"]["manipulation"] == "Open"]
    scores = scores_of(two_rooms, tmp_path, doing(rows, lambda name, _: f"{word} {name}"))
    assert scores.refused == scores.measures["S_QA"].sum() == 4
    assert scores.measures["S_M"].sum() == 0


def test_moving_a_pillow_that_is_to_be_picked_up_does_not_count(two_rooms: Path, tmp_path: Path, oracle: Rows) -> None:
    moved = []
    for row in (row for row in oracle if row["about"]["manipulation"] == "Pickup"):
        name = row["about"]["target_id"]
        with after_the_walk(two_rooms, "train", row) as replay:
            moved.append(
                row | {"manipulation": put_at(name, replay.world.state(name).position + np.array([0, 0, 0.5]))}
            )
    scores = scores_of(two_rooms, tmp_path, moved)
    assert scores.refused == 0
    assert scores.measures["S_QA"].sum() == len(moved) == 2
    assert scores.measures["S_M"].sum() == 0


def test_opening_a_microwave_that_is_to_be_moved_does_not_count(two_rooms: Path, tmp_path: Path) -> None:
    rows = reference_rows("oracle", two_rooms, "remqa", "test", np.random.default_rng(0))
    ovens = [row for row in rows if row["manipulation"].startswith("MoveObject Microwave")]
    assert scores_of(two_rooms, tmp_path, ovens, "test").measures["S_M"].sum() == len(ovens) == 2
    opened = [row | {"manipulation": f"OpenObject {parse_action(row['manipulation']).target}"} for row in ovens]
    scores = scores_of(two_rooms, tmp_path, opened, "test")
    assert scores.refused == 0
    assert (scores.measures["S_QA"].sum(), scores.measures["S_M"].sum()) == (2, 0)


def test_opening_another_thing_does_not_count(two_rooms: Path, tmp_path: Path) -> None:
    rows = reference_rows("oracle", two_rooms, "remqa", "test", np.random.default_rng(0))
    wrong = []
    for row in (row for row in rows if row["manipulation"].startswith("OpenObject Drawer")):
        with after_the_walk(two_rooms, "test", row) as replay:
            others = [name for name in replay.world.ids if str(open_action(name)) != row["manipulation"]]
            opened = next(name for name in others if does(replay, open_action(name)))
        wrong.append(row | {"manipulation": str(open_action(opened))})
    scores = scores_of(two_rooms, tmp_path, wrong, "test")
    assert scores.refused == 0
    assert scores.measures["S_QA"].sum() == len(wrong) == 2
    assert scores.measures["S_M"].sum() == scores.measures["S_MQA"].sum() == 0


def test_a_point_of_the_view_is_as_good_as_an_id(two_rooms: Path, tmp_path: Path, oracle: Rows) -> None:
    rows = [row for row in oracle if row["about"]["manipulation"] == "Open"]
    x, y = ((rows[0]["box"][i] + rows[0]["box"][i + 2]) / 600 for i in (0, 1))
    scores = scores_of(two_rooms, tmp_path, [rows[0] | {"manipulation": f"OpenObject @{x},{y}"}])
    assert scores.measures["S_MQA"].sum() == 1
