"""The questions of a dataset in numbers, as a pandas table: for people, beside what the paper has published."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import pandas as pd

from remqa_data.published import MEAN_WORDS, QUESTIONS
from remqa_data.storage.manifest import question_splits
from remqa_data.storage.shards import read_table

COLUMNS = ["split", "kind", "question", "answer", "path_length_m", "path_steps"]


def question_statistics(root: str | os.PathLike[str]) -> pd.DataFrame:
    """Count and measure the questions of a finished dataset.

    Parameters
    ----------
    root : str or path
        The dataset.

    Returns
    -------
    One row for each split and kind, indexed by them: questions, how many the paper has, words of a question (mean, and
    the paper's), metres and steps of the shortest path (medians), and one column for each answer with its count.

    Raises
    ------
    DatasetError
        If there is no finished dataset, or it has no questions.
    DamagedShardError
        If a file cannot be read.
    """
    splits = question_splits(root)
    return statistics_of(
        pd.concat([read_table(root, "questions", split, COLUMNS).to_pandas() for split in splits]), splits
    )


def statistics_of(rows: pd.DataFrame, splits: Sequence[str]) -> pd.DataFrame:
    """The same of rows that were read already, with `COLUMNS`; splits in the order of the table."""
    rows = rows.assign(words=rows["question"].map(lambda text: len(text.split())))
    order: list[Any] = list(splits)  # the stubs of pandas know categories of numbers only
    by = [pd.Categorical(rows["split"], order), rows["kind"]]
    groups = rows.groupby(by, observed=True)
    table = pd.DataFrame(
        {
            "questions": groups.size(),
            "words": groups["words"].mean().round(1),
            "path_m": groups["path_length_m"].median().round(2),
            "path_steps": groups["path_steps"].median(),
        }
    ).rename_axis(index=["split", "kind"])
    published = [QUESTIONS.get(split, {}).get(kind) for split, kind in table.index]
    table.insert(1, "published", pd.Series(published, table.index, dtype="Int64"))
    table.insert(3, "published_words", [MEAN_WORDS[kind] for _, kind in table.index])
    answers = pd.crosstab(by, rows["answer"]).rename_axis(index=["split", "kind"])
    return table.join(answers[sorted(answers.columns, key=lambda answer: (str(answer).isdigit(), answer))])
