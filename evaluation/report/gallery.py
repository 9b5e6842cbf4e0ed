"""Pictures of what failed and what succeeded: what the agent saw, what it pointed at, and which way it went."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from remqa_data.datasets.frames import Frames
from remqa_data.datasets.random_access import SplitReader
from remqa_data.evaluation.report.tables import failed_at, in_words, rounded
from remqa_data.evaluation.scoring.ground_truth import GroundTruth
from remqa_data.evaluation.scoring.replay import Attempt, RoomKey, does, load_room, place_of, replay_jobs, walk
from remqa_data.evaluation.scoring.results import Results
from remqa_data.evaluation.scoring.scoring import attempt_of
from remqa_data.evaluation.submission.reader import Submission
from remqa_data.evaluation.submission.tracks import TRACKS
from remqa_data.geometry.types import F64, I64, U8
from remqa_data.opencv import cv2
from remqa_data.sim.agent.replay import Replay
from remqa_data.sim.metadata import visible_box
from remqa_data.sim.navigation.viewpoints import Pose
from remqa_data.sim.render.camera import TopDownCamera
from remqa_data.storage.shards import read_table
from remqa_data.tables.images import decode_rgb

MAX_FAILURES, MAX_SUCCESSES = 24, 10
SHOWN_DETAILS = ("steps", "goal_distance_m", "target_visible", "iou", "manipulated")
TRUE_COLOR, PREDICTED_COLOR, PATH_COLOR, GOAL_COLOR = (40, 170, 70), (225, 60, 40), (30, 90, 220), (225, 60, 40)
TRUE_PX, PREDICTED_PX = 3, 1
"""Widths of the frames of boxes."""
JPEG = [cv2.IMWRITE_JPEG_QUALITY, 85, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]
"""Colours as sharp as all else, as a frame may be a pixel wide."""
MAP_PX, MAP_MARGIN, MAP_CUT_M = 300, 1.12, 2.0
"""Pixels along a map's sides, how much larger than the room it is, and the height above the floor at which the map is cut."""


@dataclass(frozen=True)
class Picture:
    """A picture of an attempt.

    Attributes
    ----------
    label : str
    uri : str
        The JPEG as a data: URI.
    """

    label: str
    uri: str


@dataclass(frozen=True)
class ShownAttempt:
    """A question, or an expression, and what became of it.

    Attributes
    ----------
    id, text : str
        The text is the question, or the expression.
    facts : tuple of (str, str)
        Names and values, such as ("true answer", "2").
    pictures : tuple of Picture
    """

    id: str
    text: str
    facts: tuple[tuple[str, str], ...]
    pictures: tuple[Picture, ...]


def find_attempts(
    results: Results, submission: Submission, truth: GroundTruth
) -> tuple[list[ShownAttempt], list[ShownAttempt]]:
    """Some failures of a submission and some successes, spread evenly over the split.

    Agents walk again in the simulator if their actions were replayed; otherwise only stored frames are shown.
    """
    succeeded = np.array(results.samples[results.main_measure], dtype=bool)
    failures = _spread(np.flatnonzero(~succeeded), MAX_FAILURES)
    places = [*failures, *_spread(np.flatnonzero(succeeded), MAX_SUCCESSES)]
    rows = _rows(submission, truth, places, replay=results.replayed is not False)
    shown = (_expressions if truth.track == "rec" else _questions)(results, truth, rows)
    return shown[: len(failures)], shown[len(failures) :]


def _spread(places: I64, most: int) -> list[int]:
    """So many of some places, or all."""
    chosen: list[int] = places[np.linspace(0, len(places) - 1, min(most, len(places))).round().astype(int)].tolist()
    return chosen


def _rows(
    submission: Submission, truth: GroundTruth, places: list[int], *, replay: bool
) -> dict[int, dict[str, object]]:
    """By place, what was submitted; {} for nothing."""
    found: dict[int, dict[str, object]] = {place: {} for place in places}
    for batch in submission.batches(replay=replay, max_rows=len(truth.ids)):
        for row, place in enumerate(truth.places(batch.rows[TRACKS[truth.track].id_column]).tolist()):
            if place in found:
                found[place] = batch.rows.slice(row, 1).to_pylist()[0]
    return found


def _expressions(results: Results, truth: GroundTruth, rows: dict[int, dict[str, object]]) -> list[ShownAttempt]:
    asked = read_table(truth.root, "expressions", truth.split, ["text", "frame_id"]).to_pylist()
    frames = Frames(truth.root)
    attempts = []
    for place, row in rows.items():
        image = decode_rgb(frames.picture(asked[place]["frame_id"])).copy()
        _draw_boxes(image, truth.boxes[place], row.get("box"))
        facts = (("IoU", _shown(results.samples["mean_iou"][place])), ("submitted box", _shown(row.get("box"))))
        pictures = (_picture("frame: true box green, submitted red", image),)
        attempts.append(ShownAttempt(str(truth.ids[place]), asked[place]["text"], facts, pictures))
    return attempts


def _questions(results: Results, truth: GroundTruth, rows: dict[int, dict[str, object]]) -> list[ShownAttempt]:
    stored = SplitReader(truth.root, "questions", truth.split)
    asked = stored.columns(["question", "start_target_box_2d"]).to_pylist()
    walked = _walked(truth, rows) if results.replayed else {}
    attempts = []
    for place, row in rows.items():
        before, after = (decode_rgb(memoryview(data)).copy() for data in stored.images(place, ["start_rgb", "end_rgb"]))
        _draw_boxes(before, asked[place]["start_target_box_2d"], None)
        pictures = [*walked.get(place, ()), _picture("stored view from the goal pose: target green", before)]
        pictures += [_picture("stored view after the manipulation", after)] if truth.track in ("remqa", "qa") else []
        facts = _facts(results, truth, place, row)
        attempts.append(ShownAttempt(str(truth.ids[place]), asked[place]["question"], facts, tuple(pictures)))
    return attempts


def _facts(results: Results, truth: GroundTruth, place: int, row: dict[str, object]) -> tuple[tuple[str, str], ...]:
    """Why it failed, if it did, and what was wanted beside what was submitted and happened."""
    failed = [] if results.samples[results.main_measure][place] else [("failed", failed_at(results, place))]
    facts = [*failed, ("target", truth.texts("target_id")[place])]
    if truth.track != "nav":
        facts.append(("true answer", truth.texts("answer")[place]))
    facts += [(name, _shown(row[name])) for name in ("answer", "manipulation") if name in row]
    samples = {name: column[place] for name, column in results.samples.items()}
    shown = (name for name in SHOWN_DETAILS if samples.get(name) is not None)
    return (*facts, *((in_words(name), _shown(samples[name])) for name in shown))


def _walked(truth: GroundTruth, rows: dict[int, dict[str, object]]) -> dict[int, tuple[Picture, ...]]:
    """By place, the agent's final view, its way on a map, and what its manipulation shows it."""
    by_room: dict[RoomKey, list[Attempt]] = {}
    for place, row in rows.items():
        if row:
            attempt, room = attempt_of(truth, place, row["actions"], row.get("manipulation"))  # type: ignore[arg-type]
            by_room.setdefault(room, []).append(attempt)
    pictures: dict[int, tuple[Picture, ...]] = {}
    for job in replay_jobs(truth.root, truth.split, by_room):
        with closing(load_room(job.scene_json, job.name, job.embodiment)) as replay:
            plan, first = _Map(replay), replay.world.save()
            for attempt in job.attempts:
                poses, _ = walk(replay, attempt)
                seen = replay.observe()
                view = seen.rgb.copy()
                true = visible_box(seen.objects, place_of(replay, attempt.target_id))
                _draw_boxes(view, true, rows[attempt.place].get("box"))
                way = plan.draw(poses, truth.goals[attempt.place])
                pictures[attempt.place] = (
                    _picture("agent's final view: true box green, submitted red", view),
                    _picture("way from above, dot to arrow; goal poses are rings", way),
                    *_after_manipulation(replay, attempt),
                )
                replay.world.restore(first)
    return pictures


def _after_manipulation(replay: Replay, attempt: Attempt) -> Iterator[Picture]:
    """What the agent sees next, where the room lets it manipulate something."""
    if attempt.manipulation is not None and does(replay, attempt.manipulation):
        yield _picture("agent's view after its manipulation", replay.observe().rgb)


class _Map:
    """The room from above."""

    def __init__(self, replay: Replay) -> None:
        x0, y0, x1, y1 = replay.world.scene.bounds
        extent = MAP_MARGIN * max(x1 - x0, y1 - y0)
        height = replay.world.scene.floor_z + MAP_CUT_M
        self.camera = TopDownCamera(((x0 + x1) / 2, (y0 + y1) / 2), height, extent, MAP_PX, MAP_PX)
        rendered = replay.view.render(self.camera, shadows=False).rgb
        (left, top), (right, bottom) = self._pixels(np.array([(x0, y1), (x1, y0)]))
        self.image = np.full_like(rendered, 255)  # what is out of the room is scenery
        self.image[top:bottom, left:right] = rendered[top:bottom, left:right]

    def draw(self, poses: list[Pose], goals: F64) -> U8:
        image = self.image.copy()
        for x, y in self._pixels(goals[~np.isnan(goals[:, 0])]):
            cv2.circle(image, (x, y), 6, GOAL_COLOR, 2, cv2.LINE_AA)
        points = self._pixels(np.array([pose[:2] for pose in poses]))
        cv2.polylines(image, [np.array(points, dtype=np.int32)], False, PATH_COLOR, 2, cv2.LINE_AA)
        cv2.circle(image, points[0], 5, PATH_COLOR, -1, cv2.LINE_AA)
        yaw = np.radians(poses[-1][2])
        tip = (points[-1][0] + round(16 * np.cos(yaw)), points[-1][1] - round(16 * np.sin(yaw)))
        cv2.arrowedLine(image, points[-1], tip, PATH_COLOR, 2, cv2.LINE_AA, tipLength=0.5)
        return image

    def _pixels(self, positions: F64) -> list[tuple[int, int]]:
        projected = self.camera.project(np.column_stack([positions, np.zeros(len(positions))]))
        return [(round(x), round(y)) for x, y, _ in projected.tolist()]


def _draw_boxes(image: U8, true: object, predicted: object) -> None:
    """Frames of two widths, so that both show where they are the same."""
    for box, color, width in ((true, TRUE_COLOR, TRUE_PX), (predicted, PREDICTED_COLOR, PREDICTED_PX)):
        if box is not None:
            x1, y1, x2, y2 = (round(float(v)) for v in box)  # type: ignore[attr-defined]
            cv2.rectangle(image, (x1, y1), (x2 - 1, y2 - 1), color, width)


def _picture(label: str, image: U8) -> Picture:
    data = cv2.imencode(".jpg", image[..., ::-1], JPEG)[1].tobytes()
    return Picture(label, "data:image/jpeg;base64," + base64.b64encode(data).decode())


def _shown(value: object) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return rounded(value)
    return str(value)
