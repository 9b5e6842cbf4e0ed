"""How networks became better while they learnt: the curves that training has written, one panel for each network."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from remqa_data.agents.training.config import CURVES
from remqa_data.errors import ConfigError
from remqa_data.extras import require
from remqa_data.files import atomic_path
from remqa_data.opencv import check_png

COLUMNS = 3
PANEL_INCHES = (3.6, 2.7)
SCORE = "val_"
"""What is measured in val rooms begins so; shares are drawn, counts are not."""


def write_curves_picture(folder: Path, path: Path, networks: Sequence[str] = ()) -> int:
    """Draw the scores in val rooms after each epoch, as PNG; several seeds of a network are lines in one panel.

    Parameters
    ----------
    folder : path
        Where weights are written: the curves of a network lie in a folder of its name.
    path : path
        The picture.
    networks : sequence of str
        Names without seeds; by default all that have curves.

    Returns
    -------
    How many curves files it shows.

    Raises
    ------
    ConfigError
        If a network has no curves there.
    OutputError
        If the path is no .png.
    """
    pyplot = require("matplotlib.pyplot", "agents")
    check_png(path)
    found: dict[str, dict[str, list[dict[str, float]]]] = {}
    for curves in sorted(folder.glob(f"*/{CURVES}")):
        found.setdefault(_without_seed(curves.parent.name), {})[curves.parent.name] = _read(curves)
    shown = {name: found.get(name, {}) for name in networks or found}
    missing = [name for name, runs in shown.items() if not runs] if shown else ["any network"]
    if missing:
        raise ConfigError(f"{folder} has no curves of {', '.join(missing)}; remqa-agent train writes them")
    columns = min(COLUMNS, len(shown))
    rows = math.ceil(len(shown) / columns)
    size = (PANEL_INCHES[0] * columns, PANEL_INCHES[1] * rows)
    figure, panels = pyplot.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    for panel in panels.flat[len(shown) :]:
        panel.set_axis_off()
    for panel, (name, runs) in zip(panels.flat, shown.items(), strict=False):
        _draw(panel, name, runs)
    with atomic_path(path) as temporary:
        figure.savefig(temporary, format="png", dpi=130)
    pyplot.close(figure)
    return sum(map(len, shown.values()))


def _draw(panel: Any, name: str, runs: Mapping[str, list[dict[str, float]]]) -> None:
    measures = sorted(
        {measure for curve in runs.values() for row in curve for measure in row if _is_share(measure, curve)}
    )
    for number, measure in enumerate(measures):
        for place, curve in enumerate(runs.values()):
            points = [(row["epoch"], row[measure]) for row in curve if measure in row]
            label = measure.removeprefix(SCORE).replace("_", " ") if place == 0 else None
            panel.plot(*zip(*points, strict=True), color=f"C{number}", linewidth=1.2, label=label)
    panel.set_title(f"{name}, {len(runs)} seeds" if len(runs) > 1 else name, fontsize=9)
    panel.set_xlabel("epoch", fontsize=8)
    panel.set_ylabel("in val rooms", fontsize=8)
    panel.set_ylim(bottom=0)
    panel.locator_params(axis="x", integer=True)
    panel.tick_params(labelsize=7)
    panel.grid(alpha=0.3)
    if measures:
        panel.legend(fontsize=7)


def _is_share(measure: str, curve: Sequence[Mapping[str, float]]) -> bool:
    return measure.startswith(SCORE) and all(0.0 <= row.get(measure, 0.0) <= 1.0 for row in curve)


def _read(path: Path) -> list[dict[str, float]]:
    with path.open(encoding="utf-8", newline="") as file:
        return [{name: float(value) for name, value in row.items() if value} for row in csv.DictReader(file)]


def _without_seed(name: str) -> str:
    return re.sub(r"-\d+$", "", name)
