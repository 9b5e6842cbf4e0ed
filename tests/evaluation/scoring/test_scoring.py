"""Scores without a simulator: on a dataset whose true answers and boxes are known by hand."""

import codecs
import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from remqa_data.limits import MAX_ACTIONS
from remqa_data.sim.agent.actions import ACTIONS
from tests.helpers.dataset_rows import MUG_BOX_2D
from tests.helpers.submissions import results_of, scored, written

ANSWERS = ["yes", "2", "no"] * 3 + ["yes"]  # of dataset_rows.question_row
START, NEAR, GOAL = [0.0, -0.5, 0.0, 30.0], [0.0, -0.25, 90.0, 30.0], [0.25, -0.5, 90.0, 30.0]


def question(index: int) -> str:
    return f"Kitchen3-q{index}"


def test_answers_are_counted_and_missing_ones_fail(data: Path, tmp_path: Path) -> None:
    rows = [{"question_id": question(i), "answer": ANSWERS[i]} for i in range(6)]
    rows += [{"question_id": question(6), "answer": None}, {"question_id": question(7), "answer": "no"}]
    results = results_of(data, written(tmp_path / "a.jsonl", "qa", rows))
    assert results.metric("answer_accuracy").value == 6 / 10
    assert results.metric("answer_accuracy", "kind", "COUNTING").value == 2 / 3  # q1 and q4, not q7
    counts = results.counts
    assert (counts.asked, counts.answered, counts.missing, counts.scored) == (10, 8, 2, 10)
    assert results.replayed is None
    assert results.samples["submitted_answer"] == [*ANSWERS[:6], None, "no", None, None]


@pytest.mark.parametrize("name", ["none.jsonl", "none.parquet"])
def test_a_submission_may_answer_nothing(data: Path, tmp_path: Path, name: str) -> None:
    counts = results_of(data, written(tmp_path / name, "qa", [])).counts
    assert (counts.asked, counts.answered, counts.missing) == (10, 0, 10)


def test_a_submission_may_begin_with_a_byte_order_mark(data: Path, tmp_path: Path) -> None:
    path = written(tmp_path / "a.jsonl", "qa", [{"question_id": question(0), "answer": ANSWERS[0]}])
    path.write_bytes(codecs.BOM_UTF8 + path.read_bytes())
    assert results_of(data, path).metric("answer_accuracy").value == 1 / 10


def test_boxes_of_expressions(data: Path, tmp_path: Path) -> None:
    x1, y1, x2, y2 = MUG_BOX_2D
    half = [x1, y1, (x1 + x2) / 2, y2]  # IoU 1/2 by hand
    boxes = [list(MUG_BOX_2D), half, None, [x1, y1, x1, y2], [0, 0, 1, 1]]
    rows = [{"expression_id": f"Kitchen3-e{i}", "box": box} for i, box in enumerate(boxes)]
    scores = scored(data, written(tmp_path / "a.parquet", "rec", rows))
    assert scores.measures["prec@0.5"].tolist() == [True, True, False, False, False]
    assert scores.measures["prec@0.6"].tolist() == [True, False, False, False, False]
    assert scores.measures["mean_iou"] == pytest.approx([1, 0.5, 0, 0, 0])


def test_expressions_have_a_val_split(data: Path, tmp_path: Path) -> None:
    rows = [{"expression_id": "Kitchen2-e0", "box": list(MUG_BOX_2D)}]
    assert scored(data, written(tmp_path / "a.jsonl", "rec", rows, "val")).measures["prec@0.9"].sum() == 1


def test_navigation_from_claimed_poses_by_hand(data: Path, tmp_path: Path) -> None:
    # Goal poses are at (0.25, -0.5) and (0.5, -0.5); the shortest path is said to be 1.75 m.
    box = [0, 0, 10, 10]
    ways = [
        ([START], box),  # stands 0.25 m from a goal, sees the target: success, nothing walked
        ([START, NEAR, GOAL], None),  # does not see it
        ([START, [0.0, 3.0, 0, 0], NEAR], box),  # walks 3.5 + 3.25 m
        ([START, [-2.0, -0.5, 0, 0]], box),  # stops 2.25 m away
        ([START, [-0.75, -0.5, 0, 0]], box),  # stops 1 m away
        ([START] * 27, box),  # 26 steps
        ([START] * 52, box),  # 51 steps
    ]
    rows = [{"question_id": question(i), "poses": p, "target_box": b} for i, (p, b) in enumerate(ways)]
    results = results_of(data, written_poses(tmp_path / "a.jsonl", rows), replay=False)
    assert results.samples["success@25"] == [True, False, True, False, True, False, False, False, False, False]
    assert results.samples["success@50"][5:7] == [True, False]
    assert results.samples["SPL@25"][:5] == pytest.approx([1, 0, 1.75 / 6.75, 0, 1])
    assert results.samples["steps"][:6] == [0, 2, 2, 1, 1, 26]
    assert results.samples["path_m"][:5] == pytest.approx([0, 0.25 + 0.125**0.5, 6.75, 2, 0.75])
    assert results.samples["goal_distance_m"][:5] == pytest.approx([0.25, 0, 0.125**0.5, 2.25, 1])
    assert results.samples["target_visible"][:3] == [True, False, True]
    assert results.samples["steps"][7:] == [None] * 3  # nothing was submitted
    assert results.replayed is False
    assert "NOT REPLAYED" in results.note


def written_poses(path: Path, rows: list[dict[str, object]]) -> Path:
    header = {"format": "remqa-submission", "version": 1, "track": "nav", "split": "test"}
    path.write_text("\n".join(json.dumps(row) for row in (header, *rows)))
    return path


def test_json_lines_and_parquet_of_any_width_and_order_score_alike(data: Path, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    rows = [{"expression_id": f"Kitchen3-e{i}", "box": [*rng.integers(0, 30, 2).tolist(), 30, 30]} for i in range(5)]
    first = scored(data, written(tmp_path / "a.jsonl", "rec", rows))
    second = scored(data, written(tmp_path / "b.parquet", "rec", rows[::-1]))
    header = {
        b"remqa-submission": json.dumps({"format": "remqa-submission", "version": 1, "track": "rec", "split": "test"})
    }
    schema = pa.schema([("box", pa.list_(pa.float32(), 4)), ("expression_id", pa.large_string())], metadata=header)
    pq.write_table(pa.Table.from_pylist(rows, schema), tmp_path / "c.parquet")
    third = scored(data, tmp_path / "c.parquet")
    for name, values in first.measures.items():
        assert values.tolist() == second.measures[name].tolist() == third.measures[name].tolist()
    assert first.measures["mean_iou"].any()


def test_every_word_of_an_action_list_is_an_action_of_the_simulator() -> None:
    from remqa_data.evaluation.submission.tracks import WORDS

    assert set(WORDS) <= set(ACTIONS)
    assert "Teleport" not in WORDS
    assert MAX_ACTIONS >= 50
