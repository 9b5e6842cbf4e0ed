"""The tables, from submissions whose scores are known."""

import json
from pathlib import Path

import numpy as np
import pytest

from remqa_data.agents import picture_tables
from remqa_data.agents.leaderboard import leaderboard
from remqa_data.agents.paper import paper_results
from remqa_data.agents.table import failures_grid, navigation_grid, remqa_grid, score_systems, write_tables
from remqa_data.errors import SubmissionError
from remqa_data.evaluation.scoring import kept_results
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256, load_ground_truth
from remqa_data.evaluation.scoring.results import make_results
from remqa_data.evaluation.scoring.scoring import score
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.evaluation.submission.reference import reference_rows
from remqa_data.files import sha256_of
from remqa_data.storage.shards import read_table
from tests.helpers.submissions import written


def test_the_figures_of_the_paper_are_those_that_were_published() -> None:
    assert paper_results()["VSN"]["Ours (semantic map + Floyd)"] == {
        "success@25": 0.566,
        "SPL@25": 0.461,
        "success@50": 0.729,
        "SPL@50": 0.595,
    }
    assert paper_results()["REMQA"]["Ours"]["SPATIAL S_QA"] == 0.284
    assert [len(paper_results()[name]) for name in ("VSN", "REC", "REMQA")] == [5, 5, 3]


def test_of_a_split_that_the_paper_has_not_it_has_no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_tables, "SPLITS", ("val", "own"))
    rows = picture_tables.rec_grid([]).rows
    assert len(rows) == 5
    assert all(float(known) > 0 and unknown == "" for _, known, unknown in rows)


def test_a_folder_without_submissions_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SubmissionError, match="there is no submission; remqa-agent run writes them"):
        score_systems(tmp_path, tmp_path)


def oracle(root: Path, path: Path, split: str = "test") -> Path:
    rows = reference_rows("oracle", root, "remqa", split, np.random.default_rng(0))
    return written(path, "remqa", rows, split, agent="oracle")


@pytest.mark.slow
def test_the_oracle_stands_beside_the_paper_with_what_its_steps_allow(two_rooms: Path, tmp_path: Path) -> None:
    oracle(two_rooms, tmp_path / "oracle.jsonl")
    (system,) = score_systems(tmp_path, two_rooms)
    steps = read_table(two_rooms, "questions", "test", ["path_steps"])["path_steps"].to_numpy()
    found = {metric.name: metric.value for metric in system.navigation}
    assert found["success@25"] == found["SPL@25"] == pytest.approx(np.mean(steps <= 25))
    assert found["success@50"] == found["SPL@50"] == pytest.approx(np.mean(steps <= 50))
    assert [row[0] for row in navigation_grid([system]).rows][-2:] == ["Ours (semantic map + Floyd) (paper)", "oracle"]
    kinds = [row[1:5] for row in remqa_grid([system]).rows if row[0] == "oracle"]
    assert [kind[0] for kind in kinds] == ["EXISTENCE", "COUNTING", "SPATIAL"]
    assert all(text.startswith("1.000") for kind in kinds for text in kind[1:])
    assert failures_grid([system]).rows == (("oracle", *5 * ["0.000"], "1.000"),)
    write_tables(tmp_path, [system], [navigation_grid([system]), remqa_grid([system])])
    told = json.loads((tmp_path / "table.json").read_text())
    assert told["systems"][0]["title"] == "oracle"
    assert "| oracle |" in (tmp_path / "table.md").read_text()
    assert "<td>oracle</td>" in (tmp_path / "table.html").read_text()


@pytest.mark.slow
def test_what_was_replayed_is_not_replayed_again_unless_it_has_changed(
    two_rooms: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = oracle(two_rooms, tmp_path / "oracle.jsonl")
    score_systems(tmp_path, two_rooms)
    replays: list[str] = []
    score = kept_results.score
    monkeypatch.setattr(
        kept_results, "score", lambda *given, **named: (replays.append("again"), score(*given, **named))[1]
    )
    score_systems(tmp_path, two_rooms)
    assert replays == []
    path.write_text(path.read_text().replace("MoveAhead", "MoveBack"))
    (changed,) = score_systems(tmp_path, two_rooms)
    assert replays == ["again"]
    assert changed.results.metric("S_N").value < 1
    nothing, navigation, localisation, manipulation, answer, succeeded = map(
        float, failures_grid([changed]).rows[0][1:]
    )
    assert navigation == pytest.approx(1 - changed.results.metric("S_N").value, abs=0.001)
    assert nothing == answer == 0
    assert navigation + localisation + manipulation + succeeded == pytest.approx(1, abs=0.002)


@pytest.mark.slow
def test_what_the_leaderboard_says_is_what_scoring_again_gives(two_rooms: Path, tmp_path: Path) -> None:
    oracle(two_rooms, tmp_path / "oracle.jsonl")
    rows = reference_rows("blind", two_rooms, "remqa", "test", np.random.default_rng(0))
    written(tmp_path / "blind.jsonl", "remqa", rows, "test", agent="blind")
    board = leaderboard(score_systems(tmp_path, two_rooms))
    assert [entry["title"] for entry in board["entries"]] == ["oracle", "blind"]
    truth = load_ground_truth(two_rooms, "remqa", "test")
    for entry in board["entries"]:
        submission = open_submission(tmp_path / f"{entry['title']}.jsonl")
        assert entry["submission_sha256"] == sha256_of(submission.path)
        assert entry["dataset_sha256"] == dataset_sha256(truth.manifest)
        again = make_results(submission, truth, score(submission, truth))
        for name in ("S_N", "S_L", "S_QA", "S_M", "S_MQA"):
            assert entry["overall"][name] == again.metric(name).value
            assert entry["COUNTING"][name] == again.metric(name, "kind", "COUNTING").value


@pytest.mark.slow
def test_submissions_to_different_splits_are_not_put_into_one_table(two_rooms: Path, tmp_path: Path) -> None:
    oracle(two_rooms, tmp_path / "a.jsonl", "test")
    oracle(two_rooms, tmp_path / "b.jsonl", "train")
    with pytest.raises(SubmissionError, match=r"b\.jsonl.*for split 'train', not 'test'"):
        score_systems(tmp_path, two_rooms)


@pytest.mark.slow
def test_a_split_that_the_dataset_has_not_is_told_of_the_submission(two_rooms: Path, tmp_path: Path) -> None:
    said = r"a\.jsonl: line 1, field split: the dataset has no split 'nowhere'"
    written(tmp_path / "a.jsonl", "remqa", [], "nowhere")
    with pytest.raises(SubmissionError, match=said):
        score_systems(tmp_path, two_rooms)
    (tmp_path / "qa").mkdir()
    written(tmp_path / "qa" / "a.jsonl", "qa", [], "nowhere")
    with pytest.raises(SubmissionError, match=said):
        picture_tables.score_pictures(tmp_path, two_rooms, "qa")
