"""Whether systems stand in the order that the paper found: Kendall's tau for each column, and who has changed places."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from scipy.stats import kendalltau

from remqa_data.agents.config import OF_SEED
from remqa_data.agents.paper import paper_results
from remqa_data.agents.table import STAGES, Scored
from remqa_data.evaluation.report.tables import Grid
from remqa_data.evaluation.scoring.results import Results

NAMESAKES: Mapping[str, Mapping[str, str]] = {
    "VSN": {
        "random walk, majority answer": "Random",
        "A3C, LAN, answerer": "A3C",
        "SAVN, LAN, answerer": "SAVN",
        "Scene Priors, LAN, answerer": "Scene Priors",
        "framework (semantic map, LAN, answerer)": "Ours (semantic map + Floyd)",
    },
    "REC": {
        "MCN": "MCN",
        "CGAN": "CGAN",
        "BiLSTM, no modules, two stages, detected boxes": "BiLSTM + detectron2",
        "LAN, detected boxes": "LAN + MaskRCNN",
        "LAN with anchors, two stages, detected boxes": "LAN + detectron2 (Ours)",
    },
    "REMQA": {
        "EQA (PACMAN), LAN": "EQA",
        "IQA (HIMN), LAN, answerer": "IQA",
        "framework (semantic map, LAN, answerer)": "Ours",
    },
}
"""Titles of systems, by table, and the rows of the paper that they stand for."""


@dataclass(frozen=True)
class Order:
    """One column of a table of the paper, and what is measured for the systems that are in both.

    Attributes
    ----------
    table, column : str
        Such as "VSN", "success@50".
    systems : int
        In both.
    tau : float
        Kendall's: 1 for the same order, -1 for the opposite one.
    inverted : tuple of (str, str)
        The paper's names of those that stand the other way round, the paper's better one first.
    """

    table: str
    column: str
    systems: int
    tau: float
    inverted: tuple[tuple[str, str], ...]


def orders(systems: Sequence[Scored], expressions: Sequence[Results]) -> list[Order]:
    """All columns of which at least two systems are measured; systems with several seeds count with their mean."""
    found = []
    for table, column, values in _columns(systems, expressions):
        theirs = {
            name: figures[column]
            for name, figures in paper_results()[table].items()
            if name in values and column in figures  # the paper has no column for rooms that were learnt in
        }
        if len(theirs) > 1:
            found.append(order(table, column, theirs, values))
    return found


def order(table: str, column: str, theirs: Mapping[str, float], ours: Mapping[str, float]) -> Order:
    """How two columns go together.

    >>> order("VSN", "SPL@50", {"A3C": 0.1, "SAVN": 0.2, "Random": 0.0}, {"A3C": 0.4, "SAVN": 0.3, "Random": 0.1}).inverted
    (('SAVN', 'A3C'),)
    """
    names = sorted(theirs, key=lambda name: -theirs[name])
    tau = float(kendalltau([theirs[name] for name in names], [ours[name] for name in names]).statistic)
    inverted = tuple((a, b) for a, b in combinations(names, 2) if (theirs[a] - theirs[b]) * (ours[a] - ours[b]) < 0)
    return Order(table, column, len(names), tau, inverted)


def orders_grid(found: Sequence[Order]) -> Grid:
    """The same as a table."""
    rows = tuple(
        (
            one.table,
            one.column,
            str(one.systems),
            f"{one.tau:+.2f}",
            "; ".join(f"{b} above {a}" for a, b in one.inverted),
        )
        for one in found
    )
    return Grid("Order of the systems", ("Table", "Column", "Systems", "Kendall's tau", "Not as in the paper"), rows)


def _columns(systems: Sequence[Scored], expressions: Sequence[Results]) -> Iterable[tuple[str, str, dict[str, float]]]:
    """Table, column, and values by the paper's names of systems."""
    values: dict[tuple[str, str], dict[str, list[float]]] = {}

    def add(table: str, column: str, title: str, value: float | None) -> None:
        name = NAMESAKES[table].get(title.partition(OF_SEED)[0])
        if name is not None and value is not None:
            values.setdefault((table, column), {}).setdefault(name, []).append(value)

    for system in systems:
        for metric in system.navigation:
            add("VSN", metric.name, system.title, metric.value)
        for metric in system.results.metrics:
            if metric.breakdown == "kind" and metric.name in STAGES:
                add("REMQA", f"{metric.group} {metric.name}", system.title, metric.value)
    for results in expressions:
        add("REC", f"prec@0.5 {results.split}", results.submission.agent, results.metric("prec@0.5").value)
    for (table, column), found in values.items():
        yield table, column, {name: sum(numbers) / len(numbers) for name, numbers in found.items()}
