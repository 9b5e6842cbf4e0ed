"""The figures of a dataset beside those that were asked of version 1.0, as one table for people."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from typing import NamedTuple

import pandas as pd

from remqa_data.generators.audit.recount.chance import cue_scores
from remqa_data.generators.audit.recount.moves import misplaced
from remqa_data.generators.audit.recount.views import measured_views
from remqa_data.generators.audit.recount.wording import (
    BETWEEN_THINGS,
    asked,
    expressions_in_frames,
    largest_share,
    percentile,
)
from remqa_data.published import MEAN_WORDS

FULL = 4000
"""Some figures mean something only for so many questions."""


class Figure(NamedTuple):
    """One thing that was counted: what, what was asked of it, what it is, and whether that holds."""

    what: str
    asked: str
    measured: float
    holds: bool


def recount(root: str | os.PathLike[str]) -> pd.DataFrame:
    """Count a finished dataset from its files and pictures, and compare with what its makers aim at.

    Returns
    -------
    pandas.DataFrame
        One row for each figure: `what`, `asked`, `measured`, `holds`. The aims are those of the full dataset; a small one
        does not hold all of them, and has no rows for what there is nothing of.

    Raises
    ------
    DatasetError
        If there is no finished dataset.
    MissingExtraError
        If scikit-learn is not installed, see the extra `report`.
    """
    views, questions = measured_views(root), asked(root)
    figures = [*_truths(views), _most("targets moved to where they cannot go or stand", len(misplaced(root)), 0)]
    figures += [*_sight(views), *_variety(questions), *_phrases(questions, expressions_in_frames(root))]
    for score in cue_scores(views):
        figures.append(_most(f"{score.kind}: right by {score.cue}", score.accuracy, score.luck))
    return pd.DataFrame([one for one in figures if not math.isnan(one.measured)], columns=list(Figure._fields))


def _most(what: str, measured: float, limit: float) -> Figure:
    return Figure(what, f"<= {limit:.4g}", measured, measured <= limit)


def _least(what: str, measured: float, limit: float) -> Figure:
    return Figure(what, f">= {limit:.4g}", measured, measured >= limit)


def _truths(views: pd.DataFrame) -> Iterator[Figure]:
    yield _most("questions after which something else has moved", int(views["moved"].map(bool).sum()), 0)
    yields = views["newly_seen"]
    said = views["answer"].map({"yes": 1, "no": 0}).fillna(pd.to_numeric(views["answer"], errors="coerce"))
    said = said.mask(views["relation"].isin(BETWEEN_THINGS), 1)  # there is one, whatever the answer
    is_wrong = (yields.clip(upper=1) != said).where(views["answer"].isin(["yes", "no"]), yields != said)
    yield _most("end views that show another number than the answer", int(is_wrong.sum()), 0)


def _sight(views: pd.DataFrame) -> Iterator[Figure]:
    yield _least("pixels of evidence, median", percentile(views["evidence_px"], 50), 300)
    yield _least("pixels of evidence, 5th percentile", percentile(views["evidence_px"], 5), 120)
    yield _most("evidence within 8 dE of its surroundings", int((views["evidence_de"] < 8).sum()), 0)
    yield _most("targets under 14 pixels in the start view", int((views["target_px"] < 14).sum()), 0)
    yield _most("goal poses beyond 60 degrees of the front", int((views["front_deg"] > 60).sum()), 0)
    has_landmark = views["landmark_seen"].dropna()
    yield _least("share of start views that show the landmark", float(has_landmark.astype(bool).mean()), 1.0)
    yield _most("starts within 1 m of a goal pose", int((views["start_m"] <= 1.0).sum()), 0)


def _variety(questions: pd.DataFrame) -> Iterator[Figure]:
    spatial = questions[questions["kind"] == "SPATIAL"]
    yield _least("distinct questions", questions["question"].nunique(), 1200)
    yield _least("distinct SPATIAL questions", spatial["question"].nunique(), 350)
    yield _most("largest share of one question", largest_share(questions["question"]), 0.01)
    yield _most("largest share of one type asked for", largest_share(questions["answer_type"]), 0.08)
    yield _least("types asked for or acted on", len({*questions["answer_type"], *questions["target_type"]}), 60)
    yield _least("relations of SPATIAL questions", spatial["relation"].nunique(), 6)
    for manipulation, share in {"Open": 0.6, "Move": 0.2, "Pickup": 0.2}.items():
        measured = float((questions["manipulation"] == manipulation).mean())
        compare: Callable[[str, float, float], Figure] = _most if manipulation == "Open" else _least
        yield compare(f"share of {manipulation}", measured, share)
    by_room = questions.groupby("scene").size()
    yield _least("questions of the room with fewest", int(by_room.min()), 16)
    yield _most("questions of the room with most", int(by_room.max()), 60)
    for kind, words in MEAN_WORDS.items():
        measured = float(questions.loc[questions["kind"] == kind, "words"].mean())
        yield Figure(f"{kind}: words of a question", f"{words} +- 0.3", measured, abs(measured - words) <= 0.3)


def _phrases(questions: pd.DataFrame, expressions: pd.DataFrame) -> Iterator[Figure]:
    needless = questions["has_landmark"] & (questions["called_so"] == 1)
    yield _most("landmarks for the only thing called so", int(needless.sum()), 0)
    bare = questions["expression"].str.count(" ") == 1
    yield _most("bare phrases where there are several", int((bare & (questions["same_type"] > 1)).sum()), 0)
    yield _most("expressions whose target has no rival in the frame", float((expressions["rivals"] == 0).mean()), 0.4)
    anchors = expressions["shows_anchor"].dropna()
    yield _least("expressions whose frame shows the landmark", float(anchors.astype(bool).mean()), 1.0)
