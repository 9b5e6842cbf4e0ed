"""From a submission to one record for each question or expression, with all its measures.

Whatever is missing, a row or a prediction in it, counts as a failure. The order of the rows makes no difference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from remqa_data.errors import SubmissionError, nearest_names
from remqa_data.evaluation.scoring.ground_truth import GroundTruth
from remqa_data.evaluation.scoring.measures import Answers, measures_of
from remqa_data.evaluation.scoring.replay import Attempt, Replayed, RoomKey, replay_all
from remqa_data.evaluation.submission.reader import Batch, Submission
from remqa_data.evaluation.submission.tracks import TRACKS
from remqa_data.geometry.types import F64, I64, Flags
from remqa_data.metrics import distance_to_goal_m, path_lengths_m
from remqa_data.sim.agent.actions import parse_action, parse_actions
from remqa_data.sim.agent.outcome import Wanted

START_SLACK = 1e-3
"""Metres and degrees by which the first pose may differ from the initial pose."""
MOST_KNOWN_FOR_HINTS = 10_000
"""Finding the nearest of more ids takes too long."""

Columns = dict[str, npt.NDArray[np.generic]]


@dataclass(frozen=True, eq=False)
class Scores:
    """What every row of the truth has scored.

    Attributes
    ----------
    answered : (n,) bool
        Whether the submission has a row for it.
    measures : dict of (n,) array
        By name: bool, or float. Without those that only a replay knows, where there was none.
    details : dict of (n,) array
        What explains the measures, by name: steps, metres, what was seen and said. Means nothing where nothing was
        answered.
    refused : int
        Actions that the simulator refused, over all rows.
    replayed : bool or None
        Whether walks were replayed, and not believed; None where nobody walks.
    """

    answered: Flags
    measures: Columns
    details: Columns
    refused: int = 0
    replayed: bool | None = None


def score(
    submission: Submission,
    truth: GroundTruth,
    *,
    replay: bool = True,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
) -> Scores:
    """Score a submission to any track.

    Parameters
    ----------
    submission : Submission
    truth : GroundTruth
        Of the submission's track and split.
    replay : bool
        Whether actions are executed in the simulator; without it, poses and boxes are taken from the file. Makes no
        difference for the tracks `rec` and `qa`, in which nobody walks.
    workers : int
        Processes that replay.
    progress : callable, optional
        Called with the number of rows that were replayed since the last call.

    Raises
    ------
    SubmissionError
        For the first row that cannot be scored.
    DatasetError
        If the dataset cannot be read.
    """
    walks = TRACKS[truth.track].walks
    replay = replay or not walks
    filled = _Filled(len(truth.ids), points=truth.track in ("remqa", "rec"))
    attempts: dict[RoomKey, list[Attempt]] = {}
    for batch in submission.batches(replay=replay, max_rows=len(truth.ids)):
        places = places_of(submission, truth, batch, filled.answered)
        filled.add_predictions(places, batch.rows)
        if walks and replay:
            for place, row in zip(places.tolist(), batch.rows.to_pylist(), strict=True):
                attempt, room = attempt_of(truth, place, row["actions"], row.get("manipulation"))
                attempts.setdefault(room, []).append(attempt)
        elif walks:
            _fill_claimed(submission, truth, filled, places, batch)
    if attempts:
        for done in replay_all(truth.root, truth.split, attempts, workers, progress):
            filled.add_replayed(truth, done)
    answers = filled.answers(truth)
    measures = {m.name: m.of(answers) for m in measures_of(truth.track) if replay or not m.takes_replay}
    return Scores(filled.answered, measures, _details(answers), filled.refused, replay if walks else None)


def attempt_of(
    truth: GroundTruth, place: int, actions: Sequence[str], manipulation: str | None
) -> tuple[Attempt, RoomKey]:
    """What is to be replayed of a submitted row, and in which room; `place` is that of the question in the truth."""
    question = {name: truth.table[name][place].as_py() for name in _ASKED}
    x, y, yaw, horizon = truth.initial_poses[place].tolist()
    goal_x, goal_y = truth.goals[place, 0].tolist()
    attempt = Attempt(
        place=place,
        initial_pose=(x, y, yaw, horizon),
        target_id=question["target_id"],
        actions=parse_actions(actions),
        manipulation=None if manipulation is None else parse_action(manipulation),
        wanted=Wanted(question["manipulation"], question["manipulation_object_id"], (goal_x, goal_y)),
    )
    return attempt, (question["scene"], question["configuration"])


_ASKED = ("scene", "configuration", "target_id", "manipulation", "manipulation_object_id")


class _Filled:
    """Columns over the truth's rows, filled as the submission is read; what nobody fills is a failure."""

    def __init__(self, count: int, *, points: bool) -> None:
        self.answered = np.zeros(count, dtype=bool)
        self.boxes = np.full((count if points else 0, 4), np.nan)
        self.target_boxes = np.full((count, 4), np.nan)
        self.texts: list[str | None] = [None] * count
        self.steps = np.zeros(count, dtype=np.int64)
        self.walked_m = np.zeros(count)
        self.distance_m = np.full(count, np.inf)
        self.is_manipulated = np.zeros(count, dtype=bool)
        self.refused = 0

    def add_predictions(self, places: I64, rows: pa.RecordBatch) -> None:
        self.answered[places] = True
        if "box" in rows.schema.names:
            self.boxes[places] = _boxes(rows["box"])
        if "answer" in rows.schema.names:
            for place, answer in zip(places.tolist(), rows["answer"].to_pylist(), strict=True):
                self.texts[place] = answer

    def add_walks(self, truth: GroundTruth, places: I64, poses: F64, counts: I64) -> None:
        """(sum of counts, 4) poses of walks, one walk after the other."""
        self.steps[places] = counts - 1
        self.walked_m[places] = path_lengths_m(poses[:, :2], counts)
        self.distance_m[places] = distance_to_goal_m(poses[np.cumsum(counts) - 1, :2], truth.goals[places])

    def add_replayed(self, truth: GroundTruth, done: Replayed) -> None:
        place = np.array([done.place])
        self.add_walks(truth, place, np.array(done.poses), np.array([len(done.poses)]))
        if done.target_box is not None:
            self.target_boxes[done.place] = done.target_box
        self.is_manipulated[done.place] = done.is_manipulated
        self.refused += done.refused

    def answers(self, truth: GroundTruth) -> Answers:
        return Answers(
            truth=truth,
            answered=self.answered,
            boxes=self.boxes,
            target_boxes=self.target_boxes,
            texts=self.texts,
            steps=self.steps,
            walked_m=self.walked_m,
            distance_m=self.distance_m,
            is_manipulated=self.is_manipulated,
        )


def _details(answers: Answers) -> Columns:
    track = answers.truth.track
    found: Columns = {}
    if TRACKS[track].walks:
        found["steps"], found["path_m"] = answers.steps, answers.walked_m
        found["goal_distance_m"], found["target_visible"] = answers.distance_m, answers.is_visible
    if track == "remqa":
        found["iou"] = answers.iou
    if "answer" in TRACKS[track].predictions:
        found["submitted_answer"] = np.array(answers.texts, dtype=np.object_)
    return found


def places_of(submission: Submission, truth: GroundTruth, batch: Batch, answered: Flags) -> I64:
    """Where in the truth the rows of a batch belong; `answered` says which of its rows earlier batches had.

    Raises
    ------
    SubmissionError
        For an unknown id, or one that was there before.
    """
    name = TRACKS[truth.track].id_column
    places = truth.places(batch.rows[name])
    seen = answered[places]
    seen |= ~np.isin(np.arange(len(places)), np.unique(places, return_index=True)[1])
    wrong = np.flatnonzero((places < 0) | seen)
    if not len(wrong):
        return places
    row = int(wrong[0])
    shown = str(batch.rows[name][row].as_py())
    if places[row] < 0:
        known = truth.ids.to_pylist() if len(truth.ids) <= MOST_KNOWN_FOR_HINTS else []
        near = nearest_names(shown, known, count=1)
        reason = f"{shown!r} is not in split {truth.split!r} of {truth.root}"
        reason += f"; did you mean {near[0]!r}?" if near else ""
    else:
        reason = f"{shown!r} is there twice; give one row for each"
    raise SubmissionError(submission.path, f"{submission.place(batch.first + row)}, field {name}", reason)


def _fill_claimed(submission: Submission, truth: GroundTruth, filled: _Filled, places: I64, batch: Batch) -> None:
    """Take poses and true boxes as the file claims them; only the initial pose is known, and checked."""
    lists = batch.rows["poses"]
    counts = np.asarray(lists.value_lengths().to_numpy(zero_copy_only=False), dtype=np.int64)
    poses = np.asarray(lists.flatten().flatten().to_numpy(), dtype=np.float64).reshape(-1, 4)
    off = np.abs(poses[np.cumsum(counts) - counts] - truth.initial_poses[places]).max(axis=1) > START_SLACK
    if off.any():
        row = int(off.argmax())
        initial = truth.initial_poses[places[row]].tolist()
        where = f"{submission.place(batch.first + row)}, field poses[0]"
        raise SubmissionError(submission.path, where, f"not the question's initial pose, which is {initial}")
    filled.add_walks(truth, places, poses, counts)
    filled.target_boxes[places] = _boxes(batch.rows["target_box"])


def _boxes(lists: pa.Array) -> F64:
    """(n, 4) boxes, NaN where there is none."""
    boxes = np.full((len(lists), 4), np.nan)
    boxes[lists.is_valid().to_numpy(zero_copy_only=False)] = lists.flatten().to_numpy().reshape(-1, 4)
    return boxes
