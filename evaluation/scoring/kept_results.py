"""What a submission scores, kept on this machine as long as nothing has changed, and written beside the submission."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from remqa_data.errors import OutputError, ResultsError
from remqa_data.evaluation.scoring.ground_truth import GroundTruth, dataset_sha256
from remqa_data.evaluation.scoring.results import Results, load_results, make_results, write_results
from remqa_data.evaluation.scoring.scoring import score
from remqa_data.evaluation.submission.reader import Submission
from remqa_data.files import cache_folder, sha256_of
from remqa_data.version import __version__


def score_once(
    submission: Submission,
    truth: GroundTruth,
    *,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
) -> Results:
    """Score a submission, unless the same file was scored on the same data by the same version on this machine before.

    What was found before is read from the user's cache alone: a file beside a submission may come from whoever submits.

    Parameters
    ----------
    submission : Submission
        Its results are written beside it, to `<stem>.results.json`.
    truth : GroundTruth
        Of the submission's track and split.
    workers, progress
        As of `score`.

    Raises
    ------
    SubmissionError
        If it is to another track, of another split or about another dataset.
    """
    dataset = dataset_sha256(truth.manifest)
    submission.check(track=truth.track, split=truth.split, dataset=dataset)
    kept = _kept_at(submission, truth, dataset)
    results = _read(kept)
    if results is None:
        results = make_results(submission, truth, score(submission, truth, workers=workers, progress=progress))
        if kept is not None:
            with suppress(OSError, OutputError):
                write_results(kept, results)
    info = results.submission.model_copy(update={"file": submission.path.name})
    results = results.model_copy(update={"submission": info})
    write_results(submission.path.with_suffix(".results.json"), results)
    return results


def _kept_at(submission: Submission, truth: GroundTruth, dataset: str) -> Path | None:
    """Where this machine keeps what a file scores on these questions; None for a user without a home."""
    told = "\n".join((sha256_of(submission.path), dataset, __version__, *truth.ids.to_pylist()))
    try:
        return cache_folder() / "scores" / f"{hashlib.sha256(told.encode()).hexdigest()[:32]}.json"
    except RuntimeError:
        return None


def _read(path: Path | None) -> Results | None:
    """Results of an earlier time, if there are any that can be read."""
    try:
        return None if path is None else load_results(path)
    except (ResultsError, OSError):
        return None
