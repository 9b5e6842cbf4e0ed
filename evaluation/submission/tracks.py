"""The tracks, and the columns of what is submitted to each; docs/SUBMISSIONS.md tells people.

Every column is described once, here: what JSON it is, what Arrow type, and what is expected in words. What a value must
be besides its type is in `remqa_data.evaluation.submission.checks`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal

import pyarrow as pa
from pydantic import Field

from remqa_data.limits import MAX_ACTIONS, MAX_PX, MAX_TEXT
from remqa_data.sim.agent.actions import DONE, MANIPULATION, WALKING

Track = Literal["remqa", "nav", "rec", "qa"]

FORMAT: Final = "remqa-submission"
VERSION: Final = 1
WORDS = (*WALKING, DONE)
"""What an action list may hold: no amounts, so that a step is a step for everyone."""


@dataclass(frozen=True)
class SubmissionColumn:
    """A column of a submission.

    Attributes
    ----------
    json : type
        For pydantic, in strict mode.
    arrow : pyarrow.DataType
        What it is read as; Parquet files may hold the same with other widths.
    expected : str
        For error messages.
    """

    json: Any
    arrow: pa.DataType
    expected: str


NUMBERS = pa.list_(pa.float64())
COLUMNS: dict[str, SubmissionColumn] = {
    "question_id": SubmissionColumn(str, pa.string(), "the id of a question of the split"),
    "expression_id": SubmissionColumn(str, pa.string(), "the id of a referring expression of the split"),
    "actions": SubmissionColumn(
        Annotated[list[str], Field(max_length=MAX_ACTIONS)],
        pa.list_(pa.string()),
        f"at most {MAX_ACTIONS} of {', '.join(WORDS)}, with {DONE} only at the end",
    ),
    "poses": SubmissionColumn(
        Annotated[list[Annotated[list[float], Field(max_length=4)]], Field(max_length=MAX_ACTIONS + 1)],
        pa.list_(NUMBERS),
        f"1 to {MAX_ACTIONS + 1} poses [x, y, yaw_deg, horizon_deg], the initial pose first",
    ),
    "target_box": SubmissionColumn(
        Annotated[list[float], Field(max_length=4)] | None,
        NUMBERS,
        "[x1, y1, x2, y2] of the target in the final view, or null where it is not visible",
    ),
    "box": SubmissionColumn(
        Annotated[list[float], Field(max_length=4)] | None,
        NUMBERS,
        f"[x1, y1, x2, y2] in pixels with 0 <= x1 <= x2 <= {MAX_PX} and the same for y, or null for no prediction",
    ),
    "manipulation": SubmissionColumn(
        str | None,
        pa.string(),
        f'one of {", ".join(MANIPULATION)} with its target and numbers, such as "OpenObject ID" or "OpenObject @0.5,0.4" '
        "(a point of the view), or null for none",
    ),
    "answer": SubmissionColumn(str | None, pa.string(), f"at most {MAX_TEXT} characters, or null for no prediction"),
}
"""By name."""


@dataclass(frozen=True)
class TrackSpec:
    """A track.

    Attributes
    ----------
    title : str
        For people.
    asks : str
        What a row is about: "question" or "expression".
    walks : bool
        Whether agents walk in it, so that there is something to replay.
    predictions : tuple of str
        Columns of a submission beside the id and the walk.
    main_measures : tuple of str
        Whose failures the report shows: the first of these that was measured. Submissions are `ranked_by` the first alone.
    """

    title: str
    asks: Literal["question", "expression"]
    walks: bool
    predictions: tuple[str, ...]
    main_measures: tuple[str, ...]

    @property
    def id_column(self) -> str:
        """Name of the column that says what a row is about."""
        return f"{self.asks}_id"

    @property
    def table(self) -> str:
        """Name of the dataset's table that has what rows are about."""
        return f"{self.asks}s"

    @property
    def ranked_by(self) -> str:
        """The measure that submissions are ranked by; where it was not measured there is no rank."""
        return self.main_measures[0]

    def columns(self, *, replay: bool) -> tuple[str, ...]:
        """Names of the columns of a submission, in order; without replay, poses and true boxes stand for the actions."""
        walk = () if not self.walks else ("actions",) if replay else ("poses", "target_box")
        return self.id_column, *walk, *self.predictions


TRACKS: dict[Track, TrackSpec] = {
    "remqa": TrackSpec(
        "REMQA: every measure over all questions",
        "question",
        walks=True,
        predictions=("box", "manipulation", "answer"),
        main_measures=("S_MQA", "S_QA"),
    ),
    "nav": TrackSpec(
        "Object-goal navigation",
        "question",
        walks=True,
        predictions=(),
        main_measures=("success@50",),
    ),
    "rec": TrackSpec(
        "Referring expression comprehension",
        "expression",
        walks=False,
        predictions=("box",),
        main_measures=("prec@0.5",),
    ),
    "qa": TrackSpec(
        "Question answering on the stored frames",
        "question",
        walks=False,
        predictions=("answer",),
        main_measures=("answer_accuracy",),
    ),
}
"""By name. What is measured in each is in `remqa_data.evaluation.scoring.measures`."""


def arrow_schema(names: tuple[str, ...]) -> pa.Schema:
    """What some columns are read as."""
    return pa.schema([(name, COLUMNS[name].arrow) for name in names])
