"""Where each type of thing is kept: from the recorded rooms, by kind of room; the numbers are in `templates/placements.csv`."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from functools import lru_cache

from remqa_data.yaml_files import template_text

SOURCE = "placements.csv"


def probability(type_: str, receptacle_type: str, room_type: str) -> float:
    """Share of a type's things in a kind of room that were recorded in or on a type of receptacle; 0 if none was."""
    return _priors().get((type_, receptacle_type, room_type), 0.0)


def receptacle_weights(type_: str, room_type: str, present: Iterable[str]) -> dict[str, float]:
    """How likely a type's thing is on each of some types of receptacles, those with none left out."""
    weights = {name: probability(type_, name, room_type) for name in present}
    return {name: weight for name, weight in weights.items() if weight > 0}


@lru_cache(maxsize=1)
def _priors() -> dict[tuple[str, str, str], float]:
    rows = csv.DictReader(template_text(SOURCE).splitlines())
    return {(row["object_type"], row["receptacle_type"], row["room"]): float(row["probability"]) for row in rows}
