from pathlib import Path

import pytest

from remqa_data.evaluation.scoring import kept_results
from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
from remqa_data.evaluation.scoring.kept_results import score_once
from remqa_data.evaluation.scoring.results import load_results, write_results
from remqa_data.evaluation.submission.reader import open_submission
from tests.helpers.submissions import results_of, written


def answers(path: Path, answer: str, count: int = 10) -> Path:
    return written(path, "qa", [{"question_id": f"Kitchen3-q{i}", "answer": answer} for i in range(count)])


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(kept_results, "cache_folder", lambda: tmp_path / "cache")


@pytest.fixture
def scorings(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is appended to whenever something is scored."""
    done: list[str] = []
    score = kept_results.score
    monkeypatch.setattr(
        kept_results, "score", lambda *given, **named: (done.append("scored"), score(*given, **named))[1]
    )
    return done


def test_a_submission_is_scored_once_until_it_changes(data: Path, tmp_path: Path, scorings: list[str]) -> None:
    truth = load_ground_truth(data, "qa", "test")
    path = answers(tmp_path / "a.jsonl", "yes")
    first = score_once(open_submission(path), truth)
    assert first == results_of(data, path) == load_results(tmp_path / "a.results.json")
    assert score_once(open_submission(path), truth) == first
    assert len(scorings) == 1
    changed = score_once(open_submission(answers(path, "no")), truth)
    assert changed.metric("answer_accuracy") != first.metric("answer_accuracy")
    assert len(scorings) == 2


def test_what_lies_beside_a_submission_is_not_believed(data: Path, tmp_path: Path, scorings: list[str]) -> None:
    """Who submits may write it: a perfect score of the same file, dataset and version."""
    path = answers(tmp_path / "a.jsonl", "no")
    honest = results_of(data, path)
    perfect = results_of(data, answers(tmp_path / "b.jsonl", "yes")).model_copy(
        update={"submission": honest.submission}
    )
    assert perfect.metric("answer_accuracy") != honest.metric("answer_accuracy")
    beside = tmp_path / "a.results.json"
    write_results(beside, perfect)
    assert score_once(open_submission(path), load_ground_truth(data, "qa", "test")) == honest == load_results(beside)
    assert len(scorings) == 1


def test_other_questions_another_version_or_a_damaged_file_is_scored_again(
    data: Path, tmp_path: Path, scorings: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, truth = answers(tmp_path / "a.jsonl", "yes", count=4), load_ground_truth(data, "qa", "test")
    whole = score_once(open_submission(path), truth)
    part = score_once(open_submission(path), truth.only(truth.ids.to_pylist()[:4]))
    assert (whole.counts.asked, part.counts.asked, len(scorings)) == (len(truth.ids), 4, 2)
    for kept in (tmp_path / "cache" / "scores").iterdir():
        kept.write_text("{")
    assert score_once(open_submission(path), truth) == whole
    assert len(scorings) == 3
    monkeypatch.setattr(kept_results, "__version__", "0.0.1")
    score_once(open_submission(path), truth)
    assert len(scorings) == 4
