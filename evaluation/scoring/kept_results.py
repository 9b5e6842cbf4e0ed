"""What a submission scores, written beside it and read again as long as nothing has changed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from remqa_data.errors import ResultsError
from remqa_data.evaluation.scoring.ground_truth import GroundTruth, dataset_sha256
from remqa_data.evaluation.scoring.results import Results, load_results, make_results, write_results
from remqa_data.evaluation.scoring.scoring import score
from remqa_data.evaluation.submission.reader import Submission
from remqa_data.files import sha256_of
from remqa_data.version import __version__


def score_once(
    submission: Submission,
    truth: GroundTruth,
    *,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
) -> Results:
    """Score a submission, unless the same file was scored on the same data by the same version before.

    Parameters
    ----------
    submission : Submission
        Beside it are its results, `<stem>.results.json`.
    truth : GroundTruth
        Of the submission's track and split.
    workers, progress
        As of `score`.

    Raises
    ------
    SubmissionError
        If it is to another track, of another split or about another dataset.
    """
    sha256 = dataset_sha256(truth.manifest)
    submission.check(track=truth.track, split=truth.split, dataset=sha256)
    path = submission.path.with_suffix(".results.json")
    results = _known(path, submission, sha256)
    if results is None:
        results = make_results(submission, truth, score(submission, truth, workers=workers, progress=progress))
        write_results(path, results)
    return results


def _known(path: Path, submission: Submission, dataset: str) -> Results | None:
    """Results of an earlier time, of the same file on the same data by the same version, if walks were replayed."""
    try:
        results = load_results(path)
    except ResultsError:
        return None
    key = results.submission.sha256, results.dataset.sha256, results.versions["remqa-data"]
    same = key == (sha256_of(submission.path), dataset, __version__)
    return results if same and results.replayed is not False else None
