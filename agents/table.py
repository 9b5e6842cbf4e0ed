"""The tables of the systems: what their submissions score by replay, beside the figures of the paper."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from remqa_data.agents.config import OF_SEED
from remqa_data.agents.paper import PAPER, paper_results
from remqa_data.errors import ResultsError, SubmissionError
from remqa_data.evaluation.report.html import write_tables_page
from remqa_data.evaluation.report.tables import FAILS_AT, Grid, cell, failed_at, markdown_lines, notes, rounded
from remqa_data.evaluation.scoring.ground_truth import GroundTruth, truth_of
from remqa_data.evaluation.scoring.kept_results import score_once
from remqa_data.evaluation.scoring.measures import STEP_LIMITS
from remqa_data.evaluation.scoring.results import OVERALL, Metric, Results
from remqa_data.evaluation.scoring.statistics import Estimate, estimate, estimate_over_runs
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.files import atomic_path
from remqa_data.geometry.types import F64
from remqa_data.metrics import spl

STAGES = ("S_N", "S_L", "S_QA")
BESIDE = ("S_M", "S_MQA", "answer_accuracy")
"""What the paper does not tell."""
SUCCEEDED = "succeeded"
PAGE_TITLE = "REMQA: what agents score beside the paper"
SEED = 0
"""Of the resampling."""


@dataclass(frozen=True, eq=False)
class Scored:
    """A submission that was replayed.

    Attributes
    ----------
    results : Results
        Of the track `remqa`.
    walks : dict of (n,) array
        Success and SPL of each question within the limits of steps, by names such as "SPL@50".
    scenes : (n,) int
        Which scene each question is of.
    """

    results: Results
    walks: Mapping[str, F64]
    scenes: npt.NDArray[np.int64]

    @cached_property
    def navigation(self) -> tuple[Metric, ...]:
        """The means of the walks."""
        return tuple(_overall(name, estimate(values, self.scenes, _rng())) for name, values in self.walks.items())

    @property
    def title(self) -> str:
        """The system's name."""
        return self.results.submission.agent


def score_systems(
    folder: Path,
    root: Path,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
    *,
    partial: bool = False,
) -> list[Scored]:
    """Replay the submissions in a folder, in the order of their names; what was replayed before is read again.

    Parameters
    ----------
    folder : path
        With submissions to the track `remqa`, all to one split; beside each its results are written.
    root : path
        The dataset.
    workers : int
        Processes.
    progress : callable, optional
        Called with the number of rows that were replayed since the last call.
    partial : bool
        Of each submission only the questions count that it has rows for; otherwise what is missing has failed.

    Raises
    ------
    SubmissionError
        If the folder has no submission, or one is none, is to another track, of another split or about another dataset.
    """
    paths = submissions_in(folder)
    first = open_submission(paths[0])
    first.check(track="remqa")
    truth = truth_of(first, root)
    return [_scored(path, _played_of(path, truth) if partial else truth, workers, progress) for path in paths]


def submissions_in(folder: Path) -> list[Path]:
    """The submissions in a folder, by name.

    Raises
    ------
    SubmissionError
        If there is none.
    """
    paths = found_submissions(folder)
    if not paths:
        raise SubmissionError(folder, "", "there is no submission; remqa-agent run writes them")
    return paths


def found_submissions(folder: Path) -> list[Path]:
    """The submissions in a folder, by name; none if it is not there, or what is in it is not finished."""
    return sorted(path for path in folder.glob("[!.]*") if path.suffix in (".jsonl", ".parquet"))


def write_tables(folder: Path, systems: Sequence[Scored], grids: Sequence[Grid]) -> None:
    """Write table.md, table.json and, where the extra `report` is installed, table.html."""
    lines: list[str] = []
    for grid in grids:
        lines += [*markdown_lines(grid), ""]
    remarks = [f"{system.title}: {' '.join(notes(system.results))}" for system in systems]
    for remark in remarks:
        lines += [remark, ""]
    with atomic_path(folder / "table.md") as temporary:
        temporary.write_text("\n".join(lines), encoding="utf-8")
    if find_spec("jinja2"):
        write_tables_page(folder / "table.html", PAGE_TITLE, grids, remarks)
    with atomic_path(folder / "table.json") as temporary:
        temporary.write_text(json.dumps(as_json(systems), indent=1) + "\n", encoding="utf-8")


def as_json(systems: Sequence[Scored]) -> dict[str, Any]:
    """The tables for programs: figures of the paper, and metrics of the systems with their intervals."""
    return {
        "paper": {name: paper_results()[name] for name in ("VSN", "REMQA")},
        "systems": [
            {
                "title": system.title,
                "split": system.results.split,
                "dataset": system.results.dataset.sha256,
                "metrics": [metric.model_dump(mode="json") for metric in (*system.navigation, *_remqa(system))],
            }
            for system in systems
        ],
    }


def navigation_grid(systems: Sequence[Scored]) -> Grid:
    """Success and SPL within the limits of steps."""
    columns = [f"{measure}@{limit}" for limit in STEP_LIMITS for measure in ("success", "SPL")]
    rows = [
        (name + PAPER, *(rounded(figures[column]) for column in columns))
        for name, figures in paper_results()["VSN"].items()
    ]
    for system in systems:
        by_name = {metric.name: cell(metric) for metric in system.navigation}
        rows.append((system.title, *(by_name[column] for column in columns)))
    return Grid(f"Navigation, split {_split(systems)}", ("System", *columns), tuple(rows))


def remqa_grid(systems: Sequence[Scored]) -> Grid:
    """The stages of each kind of question."""
    kinds = list(dict.fromkeys(metric.group for system in systems for metric in _remqa(system)))
    rows = [
        (name + PAPER, kind, *(rounded(figures[f"{kind} {stage}"]) for stage in STAGES), *("" for _ in BESIDE))
        for name, figures in paper_results()["REMQA"].items()
        for kind in kinds
    ]
    for system in systems:
        by_key = {(metric.group, metric.name): cell(metric) for metric in _remqa(system)}
        rows += [(system.title, kind, *(by_key[kind, name] for name in (*STAGES, *BESIDE))) for kind in kinds]
    headings = ("System", "Kind", *STAGES, *(name.replace("_", " ") for name in BESIDE))
    return Grid(f"REMQA, split {_split(systems)}", headings, tuple(rows))


def failures_grid(systems: Sequence[Scored]) -> Grid:
    """Of the questions the share that failed first at each stage, and that succeeded, by S_MQA."""
    outcomes = ("nothing was submitted", *dict.fromkeys(FAILS_AT.values()), SUCCEEDED)
    rows = []
    for system in systems:
        results = system.results
        done = results.samples[results.main_measure]
        found = [SUCCEEDED if ok else failed_at(results, place) for place, ok in enumerate(done)]
        rows.append((system.title, *(rounded(found.count(outcome) / len(found)) for outcome in outcomes)))
    return Grid(f"Where they fail first, split {_split(systems)}", ("System", *outcomes), tuple(rows))


def seeds_grid(systems: Sequence[Scored]) -> Grid | None:
    """Success and SPL of systems that have several seeds: means with intervals over seeds and rooms. None if there are none."""
    columns = tuple(systems[0].walks)
    rows = []
    for title, runs in by_system(systems).items():
        if len(runs) > 1:
            found = means(runs)
            rows.append((title, str(len(runs)), *(cell(found[name]) for name in columns)))
    headings = ("System", "Seeds", *columns)
    return Grid(f"Means over seeds, split {_split(systems)}", headings, tuple(rows)) if rows else None


def by_system(systems: Sequence[Scored]) -> dict[str, list[Scored]]:
    """Those that differ in their seeds alone, by the title that they share."""
    found: dict[str, list[Scored]] = {}
    for system in systems:
        found.setdefault(system.title.partition(OF_SEED)[0], []).append(system)
    return found


def means(runs: Sequence[Scored]) -> dict[str, Metric]:
    """What the paper's tables tell of a system, by names such as "SPL@50" and "COUNTING S_L"; of several seeds, over them."""
    first = runs[0]
    found = {metric.name: metric for metric in first.navigation}
    found |= {f"{metric.group} {metric.name}": metric for metric in _remqa(first) if metric.name in STAGES}
    if len(runs) == 1:
        return found
    for run in runs[1:]:
        if run.results.samples["id"] != first.results.samples["id"]:
            raise ResultsError(
                f"{first.title} and {run.title} have played other questions: let both play the same ones"
            )
    kinds = np.array(first.results.samples["kind"])
    for name, metric in found.items():
        if name in first.walks:
            rows, values = np.ones(len(kinds), dtype=np.bool_), [run.walks[name] for run in runs]
        else:
            rows, values = kinds == metric.group, [np.array(run.results.samples[metric.name]) for run in runs]
        over = estimate_over_runs(np.stack(values)[:, rows].astype(np.float64), first.scenes[rows], _rng())
        found[name] = metric.model_copy(update=vars(over))
    return found


def walks_within(results: Results, truth: GroundTruth) -> dict[str, F64]:
    """Success and SPL of each question within the limits of steps, of a submission to the track `remqa`."""
    samples = results.samples
    navigated = np.array(samples["S_N"], dtype=bool)
    # Rows that are missing have neither steps nor a path, and have failed.
    steps = np.array([np.inf if count is None else count for count in samples["steps"]], dtype=np.float64)
    walked_m = np.array([0.0 if metres is None else metres for metres in samples["path_m"]], dtype=np.float64)
    found: dict[str, F64] = {}
    for limit in STEP_LIMITS:
        success = navigated & (steps <= limit)
        found[f"success@{limit}"] = success.astype(np.float64)
        found[f"SPL@{limit}"] = spl(success, truth.path_lengths_m, walked_m)
    return found


def _overall(name: str, known: Estimate) -> Metric:
    return Metric(name=name, breakdown=OVERALL, group="all", **vars(known))


def _rng() -> np.random.Generator:
    return np.random.default_rng(SEED)


def _remqa(system: Scored) -> list[Metric]:
    wanted = (*STAGES, *BESIDE)
    return [metric for metric in system.results.metrics if metric.breakdown == "kind" and metric.name in wanted]


def _split(systems: Sequence[Scored]) -> str:
    return systems[0].results.split


def _scored(path: Path, truth: GroundTruth, workers: int, progress: Callable[[int], None] | None) -> Scored:
    results = score_once(open_submission(path), truth, workers=workers, progress=progress)
    scenes = np.unique(np.array(results.samples["scene"]), return_inverse=True)[1]
    return Scored(results, walks_within(results, truth), scenes)


def _played_of(path: Path, truth: GroundTruth) -> GroundTruth:
    batches = open_submission(path).batches(replay=True, max_rows=len(truth.ids))
    return truth.only([question_id for batch in batches for question_id in batch.rows["question_id"].to_pylist()])
