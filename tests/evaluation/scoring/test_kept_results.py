from pathlib import Path

import pytest

from remqa_data.evaluation.scoring import kept_results
from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
from remqa_data.evaluation.scoring.kept_results import score_once
from remqa_data.evaluation.scoring.results import load_results, write_results
from remqa_data.evaluation.submission.reader import open_submission
from tests.helpers.submissions import results_of, written


def answers(path: Path, answer: str) -> Path:
    return written(path, "qa", [{"question_id": f"Kitchen3-q{i}", "answer": answer} for i in range(10)])


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


@pytest.mark.parametrize("change", [{"replayed": False}, {"versions": {"remqa-data": "0.0.1"}}])
def test_what_was_believed_or_found_by_another_version_is_found_again(
    data: Path, tmp_path: Path, scorings: list[str], change: dict[str, object]
) -> None:
    path = answers(tmp_path / "a.jsonl", "yes")
    kept = results_of(data, path).model_copy(update=change)
    write_results(tmp_path / "a.results.json", kept)
    assert score_once(open_submission(path), load_ground_truth(data, "qa", "test")) != kept
    assert len(scorings) == 1
