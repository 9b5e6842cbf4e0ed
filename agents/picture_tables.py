"""The tables of networks on stored pictures: referring expressions and answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from remqa_data.agents.paper import PAPER, paper_results
from remqa_data.agents.seen import SEEN_SPLIT
from remqa_data.evaluation.report.tables import Grid, cell, rounded
from remqa_data.evaluation.scoring.ground_truth import truth_of
from remqa_data.evaluation.scoring.kept_results import score_once
from remqa_data.evaluation.scoring.results import Results
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.evaluation.submission.tracks import Track

PRECISION = "prec@0.5"
SPLITS = ("val", "test")
ACCURACY = "answer_accuracy"
PERCENT = 100
"""The paper's precision is in percent."""


def score_pictures(folder: Path, root: Path, track: Track) -> list[Results]:
    """Score the submissions to a track without walks that are in `<folder>/<track>`; beside each its results are written.

    Raises
    ------
    SubmissionError
        If one is none, is to another track, or is about another dataset or a split that this one has not.
    """
    found = []
    for path in sorted((folder / track).glob("*.jsonl")):
        submission = open_submission(path)
        submission.check(track=track)
        found.append(score_once(submission, truth_of(submission, root)))
    return found


def rec_grid(results: Sequence[Results]) -> Grid:
    """prec@0.5 on both splits of the paper, and where it was measured on rooms that networks have learnt in."""
    seen = tuple({SEEN_SPLIT for found in results if found.split == SEEN_SPLIT})
    rows = [
        (name + PAPER, *(_published(figures, split) for split in SPLITS), *("" for _ in seen))
        for name, figures in paper_results()["REC"].items()
    ]
    by_key = {(found.submission.agent, found.split): cell(found.metric(PRECISION)) for found in results}
    for title in dict.fromkeys(title for title, _ in by_key):
        rows.append((title, *(by_key.get((title, split), "") for split in (*SPLITS, *seen))))
    headings = ("System", *(f"{PRECISION} {split}" for split in SPLITS), *(f"{PRECISION} seen rooms" for _ in seen))
    return Grid("Referring expressions", headings, tuple(rows))


def _published(figures: Mapping[str, float], split: str) -> str:
    """A row's figure in the paper; nothing for a split that it has not."""
    figure = figures.get(f"{PRECISION} {split}")
    return "" if figure is None else rounded(figure / PERCENT)


def qa_grid(results: Sequence[Results]) -> Grid:
    """Share of right answers from stored views, by kind of question."""
    kinds = list(
        dict.fromkeys(metric.group for found in results for metric in found.metrics if metric.breakdown == "kind")
    )
    rows = tuple(
        (found.submission.agent, found.split, *(cell(found.metric(ACCURACY, "kind", kind)) for kind in kinds))
        for found in results
    )
    return Grid("Answers from stored views", ("System", "Split", *kinds), rows)
