"""The questions of a split beside those of the published benchmark."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.evaluation.report.tables import Grid
from remqa_data.published import MEAN_WORDS, QUESTIONS


def questions_beside_published(split: str, kinds: Sequence[str], questions: Sequence[str]) -> Grid | None:
    """Number and mean length of a split's questions beside the published ones; None for a split that the paper has not.

    Parameters
    ----------
    split : str
    kinds, questions : (n,) str
        Of all questions of the split.
    """
    if split not in QUESTIONS:
        return None
    rows = []
    for kind, count in QUESTIONS[split].items():
        words = [len(text.split()) for text, its in zip(questions, kinds, strict=True) if its == kind]
        mean = f"{np.mean(words):.1f}" if words else "–"
        rows.append((kind, str(len(words)), str(count), mean, f"{MEAN_WORDS[kind]:.1f}"))
    published = sum(QUESTIONS[split].values())
    rows.append(("all", str(len(questions)), str(published), "", ""))
    headings = ("Kind", "questions", "published", "mean words", "published")
    return Grid(f"Questions of split {split}", headings, tuple(rows))
