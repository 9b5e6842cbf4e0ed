"""results.json: what a submission has scored, with all that is needed to trust it, compare it and make it again.

`results.schema.json`, beside this file, is its JSON Schema.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from remqa_data.errors import ResultsError
from remqa_data.evaluation.scoring.ground_truth import GroundTruth, dataset_sha256
from remqa_data.evaluation.scoring.measures import IOU_THRESHOLDS, STEP_LIMITS, measures_of
from remqa_data.evaluation.scoring.scoring import Scores
from remqa_data.evaluation.scoring.statistics import LEVEL, RESAMPLES, IntervalKind, estimate, not_measured
from remqa_data.evaluation.submission.reader import Submission
from remqa_data.evaluation.submission.tracks import TRACKS, Track
from remqa_data.files import atomic_path, sha256_of
from remqa_data.geometry.types import F64
from remqa_data.metrics import LOCALISED_IOU, SUCCESS_DISTANCE_M
from remqa_data.sim.agent.outcome import OPEN_SHARE
from remqa_data.sim.navigation.viewpoints import FRAME_PX, MIN_PIXELS
from remqa_data.storage.manifest import versions_of
from remqa_data.tables.rows import KINDS

SAME_MEAN = 1e-9
"""Means of the same numbers differ by no more, in whatever order they are added up."""
FORMAT: Final = "remqa-results"
VERSION: Final = 1
VERSIONED = ("numpy", "scipy", "pyarrow", "pybullet", "numba")
NOT_REPLAYED = "NOT REPLAYED: poses, path lengths and true boxes are what the submission claims."
OVERALL = "overall"


class _Record(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Metric(_Record):
    """The mean of a measure over all rows, or over one group of them."""

    name: str
    breakdown: str = Field(description='"overall", or what the rows are grouped by, such as "kind".')
    group: str = Field(description='Such as "EXISTENCE"; "all" overall.')
    value: float | None = Field(description="null where it was not measured: only a replay knows it.")
    low: float | None = Field(description="Lower end of the 95 % interval.")
    high: float | None
    interval: IntervalKind
    questions: int = Field(description="Rows in the mean.")
    scenes: int
    higher_is_better: Literal[True] = True


class Counts(_Record):
    """How many rows the split has, the submission has, and the means are over."""

    asked: int
    answered: int
    missing: int = Field(description="Asked and not answered; they count as failures.")
    scored: int
    refused_actions: int = Field(description="Actions that the simulator refused.")


class DatasetInfo(_Record):
    """Which dataset."""

    sha256: str = Field(description="Of the list of its files' checksums, see docs/METRICS.md.")
    seed: int
    config_sha256: str


class SubmissionInfo(_Record):
    """Which submission."""

    file: str
    sha256: str
    agent: str


class Results(_Record):
    """A scored submission."""

    format: Literal["remqa-results"] = FORMAT
    version: Literal[1] = VERSION
    track: Track
    split: str
    replayed: bool | None = Field(description="null where nobody walks.")
    note: str
    submission: SubmissionInfo
    dataset: DatasetInfo
    versions: dict[str, str]
    config: dict[str, Any]
    counts: Counts
    metrics: list[Metric]
    samples: dict[str, list[str | bool | int | float | None]] = Field(
        description="Columns with one entry for each row of the split: id, scene, answered, the groups, the measures, null "
        "where they were not measured, and what explains them, null where nothing was submitted."
    )

    def metric(self, name: str, breakdown: str = OVERALL, group: str = "all") -> Metric:
        """One of the metrics.

        Raises
        ------
        KeyError
            If there is none such.
        """
        for metric in self.metrics:
            if (metric.name, metric.breakdown, metric.group) == (name, breakdown, group):
                return metric
        raise KeyError((name, breakdown, group))

    @property
    def measures(self) -> list[str]:
        """Names of the measures, in order."""
        return list(dict.fromkeys(metric.name for metric in self.metrics))

    @property
    def main_measure(self) -> str:
        """What says which rows are failures: the first main measure of the track that was measured."""
        measured = [metric.name for metric in self.metrics if metric.value is not None]
        return next(name for name in TRACKS[self.track].main_measures if name in measured)


def make_results(submission: Submission, truth: GroundTruth, scores: Scores, *, seed: int = 0) -> Results:
    """Means, intervals and breakdowns of what was scored; `seed` is that of the resampling."""
    asked, answered = len(truth.ids), int(scores.answered.sum())
    refused = scores.refused
    return Results(
        track=truth.track,
        split=truth.split,
        replayed=scores.replayed,
        note=NOT_REPLAYED if scores.replayed is False else "",
        submission=SubmissionInfo(
            file=submission.path.name, sha256=sha256_of(submission.path), agent=submission.header.agent
        ),
        dataset=DatasetInfo(
            sha256=dataset_sha256(truth.manifest),
            seed=truth.manifest.seed,
            config_sha256=truth.manifest.config_sha256,
        ),
        versions=versions_of(VERSIONED),
        config={
            "success_distance_m": SUCCESS_DISTANCE_M,
            "min_pixels": MIN_PIXELS,
            "frame_px": FRAME_PX,
            "localised_iou": LOCALISED_IOU,
            "open_share": OPEN_SHARE,
            "iou_thresholds": list(IOU_THRESHOLDS),
            "step_limits": list(STEP_LIMITS),
            "level": LEVEL,
            "resamples": RESAMPLES,
            "seed": seed,
        },
        counts=Counts(asked=asked, answered=answered, missing=asked - answered, scored=asked, refused_actions=refused),
        metrics=_metrics(truth, scores, seed),
        samples=_samples(truth, scores),
    )


def write_results(path: Path, results: Results) -> None:
    """Write results.json, whole or not at all."""
    with atomic_path(path) as temporary:
        temporary.write_text(results.model_dump_json(indent=1) + "\n", encoding="utf-8")


def load_results(path: Path) -> Results:
    """Read a results.json.

    Raises
    ------
    ResultsError
        If it is none.
    """
    try:
        results = Results.model_validate_json(path.read_bytes())
        if (wrong := _wrong_mean(results)) is not None:
            raise ResultsError(f"{path}: {wrong}: remqa-eval did not write that")
        return results
    except FileNotFoundError:
        raise ResultsError(f"{path}: no such file; remqa-eval writes it") from None
    except ValidationError as error:
        found = error.errors(include_url=False, include_input=False)[0]
        field = ".".join(str(part) for part in found["loc"])[:80] or "the whole text"
        raise ResultsError(f"{path}: {field}: {found['msg'][:200]}; expected a results.json of remqa-eval") from None


def _wrong_mean(results: Results) -> str | None:
    """The first value that is not what its samples come to, if there is one."""
    groups = {
        name: np.array(results.samples.get(name, [])) for name in {metric.breakdown for metric in results.metrics}
    }
    samples: dict[str, F64] = {}
    for name in results.measures:
        column = results.samples.get(name, [])
        try:
            samples[name] = np.array([] if None in column else column, dtype=np.float64)
        except (TypeError, ValueError):
            return f"a sample of {name} is no number"
    for metric in results.metrics:
        rows = samples[metric.name]
        if metric.breakdown != OVERALL and len(groups[metric.breakdown]) == len(rows):
            rows = rows[groups[metric.breakdown] == metric.group]
        if (metric.value is None) != (len(rows) == 0):
            return f"{metric.name} of {metric.group} is {metric.value}, with {len(rows)} samples"
        if metric.value is not None and not (
            0.0 <= rows.min() <= rows.max() <= 1.0 and abs(metric.value - rows.mean()) <= SAME_MEAN
        ):
            return f"{metric.name} of {metric.group} is {metric.value}, and the mean of its samples {rows.mean()}"
    return None


def schema_json() -> str:
    """The JSON Schema of results.json, as it is published."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **Results.model_json_schema()}
    return json.dumps(schema, indent=1) + "\n"


def _metrics(truth: GroundTruth, scores: Scores, seed: int) -> list[Metric]:
    scenes = np.unique(truth.texts("scene"), return_inverse=True)[1]
    everything = {OVERALL: ["all"] * len(truth.ids)} | truth.groups
    metrics = []
    for measure in measures_of(truth.track):
        values = scores.measures.get(measure.name)
        rng = np.random.default_rng(seed)  # so that a metric does not depend on those before it
        for breakdown, labels in everything.items():
            column = np.array(labels)
            for group in sorted(set(labels), key=_order):
                rows = column == group
                found = not_measured(scenes[rows]) if values is None else estimate(values[rows], scenes[rows], rng)
                metrics.append(Metric(name=measure.name, breakdown=breakdown, group=group, **vars(found)))
    return metrics


def _order(group: str) -> tuple[int, str]:
    """Kinds of questions come as the paper has them, all else by its name."""
    return KINDS.index(group) if group in KINDS else len(KINDS), group


def _samples(truth: GroundTruth, scores: Scores) -> dict[str, list[Any]]:
    columns: dict[str, list[Any]] = {"id": truth.ids.to_pylist(), "scene": truth.texts("scene")}
    columns |= {"answered": scores.answered.tolist(), **truth.groups}
    for measure in measures_of(truth.track):
        values = scores.measures.get(measure.name)
        columns[measure.name] = [None] * len(truth.ids) if values is None else values.tolist()
    for name, details in scores.details.items():
        columns[name] = [
            value if said else None for value, said in zip(details.tolist(), columns["answered"], strict=True)
        ]
    return columns
