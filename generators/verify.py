"""Checking a dataset from its files alone: checksums, answers worked out anew, and the oracle's actions replayed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from remqa_data.answers import execute
from remqa_data.errors import ActionError
from remqa_data.generators.sample_picture import stored_pose
from remqa_data.images import decode_rgb, encode_depth, encode_instances, encode_rgb
from remqa_data.manifest import load_manifest
from remqa_data.metadata import object_metadata
from remqa_data.referring import resolve
from remqa_data.rows import QuestionRow, SceneRow
from remqa_data.scene import Scene
from remqa_data.scene_graph import SceneGraph
from remqa_data.shards import check_files, read_rows
from remqa_data.sim.replay import Replay


@dataclass(frozen=True)
class Failure:
    """A question that does not hold, and why."""

    question_id: str
    reason: str


@dataclass(frozen=True)
class Verification:
    """How many questions were checked, and which failed."""

    checked: int
    failures: tuple[Failure, ...]


def verify(
    root: Path, sample: int | None = None, seed: int = 0, progress: Callable[[int, int], None] | None = None
) -> Verification:
    """Check a finished dataset.

    Parameters
    ----------
    root : Path
        Folder of the dataset.
    sample : int, optional
        How many questions to replay, drawn at random; all by default. Checksums are always checked in full.
    seed : int
        Of the draw.
    progress : callable, optional
        Called with the numbers of questions checked and to check.

    Raises
    ------
    DatasetError
        If the folder is not a finished dataset, or a shard is damaged.
    """
    check_files(root)
    splits = load_manifest(root).splits("questions")
    questions = [row for split in splits for row in read_rows(root, QuestionRow, split)]
    if sample is not None and sample < len(questions):
        chosen = np.random.default_rng(seed).choice(len(questions), sample, replace=False)
        questions = [questions[i] for i in sorted(chosen)]
    asked: dict[tuple[str, int], list[QuestionRow]] = {}
    for question in questions:
        asked.setdefault((question.scene, question.configuration), []).append(question)
    failures: list[Failure] = []
    checked = 0
    for split in splits:
        for row in read_rows(root, SceneRow, split):
            for question in asked.get((row.scene, row.configuration), []):
                failures += [Failure(question.question_id, reason) for reason in _wrong(question, row)]
                checked += 1
                if progress is not None:
                    progress(checked, len(questions))
    return Verification(checked, tuple(failures))


def _wrong(question: QuestionRow, row: SceneRow) -> Iterator[str]:
    """What does not hold of one question, in a freshly loaded world."""
    scene = Scene.from_json(row.scene_json, f"{row.scene}, configuration {row.configuration}")
    replay = Replay(scene, stored_pose(question.start))
    try:
        graph = SceneGraph.from_objects(object_metadata(replay.world).values())
        answer = execute(json.loads(question.program), graph)
        if answer.text != question.answer or answer.ids != question.answer_ids:
            yield f"the answer is {answer.text}, not {question.answer}"
        if resolve(question.expression, graph) != [question.target_id]:
            yield f"{question.expression!r} does not pick out {question.target_id} alone"
        is_manipulated = False
        for action in question.actions:
            if " " in action and not is_manipulated:
                is_manipulated = True
                yield from _different(question, replay, "start")
            replay.step(action)
        yield from _different(question, replay, "end")
    except ActionError as error:
        yield str(error)
    finally:
        replay.close()


def _different(question: QuestionRow, replay: Replay, when: str) -> Iterator[str]:
    """Which stored images of the start or the end are not what is seen now, byte for byte."""
    stored_rgb = getattr(question, f"{when}_rgb")
    size_px = _width(stored_rgb.bytes)
    seen = replay.observe(size_px)
    ids = replay.world.ids
    form = "png" if stored_rgb.bytes.startswith(b"\x89PNG") else "jpeg"
    now = {
        "rgb": encode_rgb(seen.rgb, form=form),  # type: ignore[arg-type]
        "depth": encode_depth(seen.depth),
        "instances": encode_instances(seen.objects, ids, question.object_ids),
    }
    for name, image in now.items():
        if image.bytes != getattr(question, f"{when}_{name}").bytes:
            yield f"{when}_{name} is not what is seen"


def _width(data: bytes) -> int:
    return int(decode_rgb(data).shape[1])
