"""What networks weigh and what their training took, as their files say; nothing of them is loaded."""

from __future__ import annotations

import json
from collections.abc import Iterable
from math import prod
from pathlib import Path
from typing import NamedTuple

from remqa_data.agents.runner import read_pace, read_told
from remqa_data.agents.training.config import DURATION, networks, no_network, weights_file
from remqa_data.evaluation.report.tables import Grid
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.extras import require

MINUTES = "minutes"
NOT_LEARNT = ("running_mean", "running_var", "num_batches_tracked", "near")
"""How names end of what is stored and no parameter: means of batch normalisation, and which types are seen together."""


class Cost(NamedTuple):
    """Of one network.

    Attributes
    ----------
    title : str
    parameters : int
    megabytes : float
        Of its file: numbers are stored in half precision.
    minutes : float or None
        That its training took, by the clock of the machine that did it, where that is known.
    score : dict
        What it scored in val rooms.
    """

    title: str
    parameters: int
    megabytes: float
    minutes: float | None
    score: dict[str, float]


def known_costs(folder: Path | None = None) -> list[Cost]:
    """Of the networks of the package that are trained; those in a folder come before those of the package."""
    return [cost_of(path) for name in networks() if (path := weights_file(name, folder)) is not None]


def cost_of(path: Path) -> Cost:
    """Of the network in a file.

    Raises
    ------
    ConfigError
        If the file is no network that remqa-agent has trained.
    """
    safetensors = require("safetensors", "agents")
    try:
        with safetensors.safe_open(path, framework="numpy") as file:
            about = json.loads(file.metadata()["remqa"])
            learnt = [name for name in file.keys() if name.rpartition(".")[2] not in NOT_LEARNT]  # noqa: SIM118 - no mapping
            sizes = [prod(file.get_slice(name).get_shape()) for name in learnt]
        score = dict(about["score"])
        minutes = score.pop(MINUTES, None) or _minutes_beside(path)
        return Cost(about["config"]["title"], sum(sizes), path.stat().st_size / 1e6, minutes, score)
    except (OSError, KeyError, TypeError, ValueError, safetensors.SafetensorError) as error:
        raise no_network(path, error) from None


def _minutes_beside(path: Path) -> float | None:
    """What the training of a network has written beside its weights."""
    minutes = read_told(path.with_suffix("") / DURATION).get(MINUTES)
    return minutes if isinstance(minutes, float) else None


def costs_grid(costs: Iterable[Cost]) -> Grid:
    """A row for each network."""
    rows = tuple(
        (
            cost.title,
            f"{cost.parameters:,}",
            f"{cost.megabytes:.2f}",
            "-" if cost.minutes is None else f"{cost.minutes:.1f}",
            ", ".join(f"{name.removeprefix('val_')} {value:.3f}" for name, value in cost.score.items()),
        )
        for cost in costs
    )
    return Grid("Networks", ("Network", "Parameters", "MB", "Minutes", "In val rooms"), rows)


def pace_grid(submissions: Iterable[Path]) -> Grid | None:
    """Actions a second of those whose playing was timed: drawing and thinking, not loading. None if there are none."""
    rows = []
    for path in submissions:
        pace = read_pace(path)
        if pace.get("seconds"):
            rate = pace["steps"] / pace["seconds"]
            rows.append(
                (open_submission(path).header.agent, f"{pace['steps']:,}", f"{pace['seconds']:,.0f}", f"{rate:.1f}")
            )
    headings = ("System", "Actions", "Seconds of a core", "Actions a second")
    return Grid("What playing takes", headings, tuple(rows)) if rows else None
