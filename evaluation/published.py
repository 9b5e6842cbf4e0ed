"""The published benchmark's figures, for tables beside one's own.

Only those of the dataset are here. The paper's agents saw other pictures of these rooms, AI2-THOR's, so their scores
are no yardstick for agents here without care; the paper has them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from remqa_data.evaluation.tables import Grid

SOURCE = "Sima, Tan and Liu, 2022, arXiv:2210.02709"
QUESTIONS: Mapping[str, Mapping[str, int]] = {
    "train": {"EXISTENCE": 1653, "COUNTING": 647, "SPATIAL": 1083},
    "test": {"EXISTENCE": 324, "COUNTING": 143, "SPATIAL": 222},
}
"""By split and kind."""
MEAN_WORDS: Mapping[str, float] = {"EXISTENCE": 9.5, "COUNTING": 11.8, "SPATIAL": 7.1}
"""Of a question, by kind."""


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
