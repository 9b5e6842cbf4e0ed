"""Writing submissions for tests."""

from pathlib import Path
from typing import Any

from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
from remqa_data.evaluation.scoring.results import Results, make_results
from remqa_data.evaluation.scoring.scoring import Scores, score
from remqa_data.evaluation.submission.reader import Header, open_submission, write_submission


def written(path: Path, track: str, rows: list[dict[str, Any]], split: str = "test", **header: Any) -> Path:
    write_submission(path, Header(track=track, split=split, **header), rows)
    return path


def scored(data: Path, path: Path, *, replay: bool = True, workers: int = 1) -> Scores:
    submission = open_submission(path)
    truth = load_ground_truth(data, submission.header.track, submission.header.split)
    return score(submission, truth, replay=replay, workers=workers)


def results_of(data: Path, path: Path, *, replay: bool = True) -> Results:
    submission = open_submission(path)
    truth = load_ground_truth(data, submission.header.track, submission.header.split)
    return make_results(submission, truth, score(submission, truth, replay=replay))
