"""The figures of the paper's tables, to stand beside one's own; `templates/paper_results.csv` holds them.

The paper's agents saw other pictures of these rooms, AI2-THOR's, and other questions about them: where a system here does as
well as its namesake there, that says that it works, not that it is the better one.
"""

from __future__ import annotations

import csv
from functools import lru_cache

from remqa_data.yaml_files import template_text

SOURCE = "paper_results.csv"
PAPER = " (paper)"
"""After the name of a system of the paper, in tables."""


@lru_cache(maxsize=1)
def paper_results() -> dict[str, dict[str, dict[str, float]]]:
    """By table ("VSN", "REC", "REMQA") and system, the figures by column, such as "success@25" or "COUNTING S_QA"."""
    found: dict[str, dict[str, dict[str, float]]] = {}
    for row in csv.DictReader(template_text(SOURCE).splitlines()):
        figures = found.setdefault(row["table"], {}).setdefault(row["system"], {})
        figures[row["column"]] = float(row["value"])
    return found
