"""leaderboard.json: what submissions have scored by replay, with the hashes that tell which file and which data that was."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from remqa_data.agents.table import Scored
from remqa_data.evaluation.scoring.results import OVERALL
from remqa_data.evaluation.submission.tracks import TRACKS

MEASURES = ("S_N", "S_L", "S_QA", "S_M", "S_MQA")


def leaderboard(systems: Sequence[Scored]) -> dict[str, Any]:
    """Entries, the best first: by what the track ranks by, of equal ones by S_QA, then by title."""
    ranked_by = TRACKS["remqa"].ranked_by
    entries = [_entry(system) for system in systems]
    entries.sort(key=lambda entry: (-entry["overall"][ranked_by], -entry["overall"]["S_QA"], entry["title"]))
    return {"ranked_by": ranked_by, "entries": entries}


def _entry(system: Scored) -> dict[str, Any]:
    results = system.results
    figures: dict[str, dict[str, float | None]] = {}
    for metric in results.metrics:
        if metric.name in MEASURES and metric.breakdown in (OVERALL, "kind"):
            group = OVERALL if metric.breakdown == OVERALL else metric.group
            figures.setdefault(group, {})[metric.name] = metric.value
    return {
        "title": system.title,
        "submission_sha256": results.submission.sha256,
        "dataset_sha256": results.dataset.sha256,
        "split": results.split,
        "version": results.versions["remqa-data"],
        **figures,
        "within": {metric.name: metric.value for metric in system.navigation},
    }
