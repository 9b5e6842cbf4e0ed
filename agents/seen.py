"""Rooms that networks have learnt in, beside rooms that they have never seen: the paper's systems had seen all of theirs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from remqa_data.agents.paper import paper_results
from remqa_data.agents.ranking import NAMESAKES
from remqa_data.agents.table import Scored, by_system, means
from remqa_data.agents.training.rooms import learning_rooms
from remqa_data.errors import ConfigError
from remqa_data.evaluation.report.tables import Grid, cell, rounded
from remqa_data.storage.shards import read_table

SEEN = "seen"
"""Folder of the submissions about seen rooms, beside those about a split."""
SEEN_SPLIT = "train"


def seen_questions(root: Path, count: int) -> list[str]:
    """Ids of train questions about the first configuration of rooms that are learnt from, spread evenly over all of them.

    Who walks has learnt from views of that configuration, and a room is loaded but once.

    Parameters
    ----------
    root : path
        The dataset.
    count : int
        How many; fewer if there are not so many.

    Raises
    ------
    DatasetError
        If the dataset has no room to learn from.
    ConfigError
        If nothing is asked about them.
    """
    rooms = learning_rooms([root])
    rows = read_table(root, "questions", SEEN_SPLIT, ["question_id", "scene", "configuration"]).to_pylist()
    ids = [str(row["question_id"]) for row in rows if row["scene"] in rooms and row["configuration"] == 0]
    if not ids:
        raise ConfigError(f"{root}: nothing is asked about the rooms that networks learn from")
    return [ids[place] for place in np.unique(np.linspace(0, len(ids) - 1, count).astype(int))]


def seen_grid(unseen: Sequence[Scored], seen: Sequence[Scored]) -> Grid:
    """A row for each measure of the systems that have played in seen rooms; of several seeds, means over them."""
    elsewhere = {title: means(runs) for title, runs in by_system(unseen).items()}
    rows = []
    for title, runs in by_system(seen).items():
        for name, metric in means(runs).items():
            paper, beside = _papers(title, name), elsewhere.get(title, {}).get(name)
            shown = ("" if paper is None else rounded(paper), cell(metric), "" if beside is None else cell(beside))
            rows.append((title, str(len(runs)), name, *shown))
    headings = ("System", "Seeds", "Measure", "Paper", "Seen rooms", "Unseen rooms")
    asked = {system.results.counts.asked for system in seen}
    return Grid(f"Seen and unseen rooms, {' or '.join(map(str, sorted(asked)))} train questions", headings, tuple(rows))


def _papers(title: str, measure: str) -> float | None:
    for table in ("VSN", "REMQA"):
        name = NAMESAKES[table].get(title)
        if name is not None and measure in paper_results()[table][name]:
            return paper_results()[table][name][measure]
    return None
