"""Submissions that come with the package: the oracle, which knows everything, and two agents that know nothing.

`oracle` walks the stored way and gives the stored answers, and must score 1 in every measure that it has the steps for.
`random` walks, points, acts and answers at random. `blind` stands still and answers from the words of the question alone,
by a classifier that has seen the train split; on a dataset without bias it is at chance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from remqa_data.datasets.frames import Frames
from remqa_data.evaluation.submission.tracks import TRACKS, WORDS, Track
from remqa_data.extras import require
from remqa_data.sim.agent.actions import DONE, MANIPULATION, open_action, parse_actions, walk_and_rest
from remqa_data.sim.navigation.viewpoints import FRAME_PX
from remqa_data.storage.shards import read_table
from remqa_data.tables.images import image_size

Agent = Literal["oracle", "random", "blind"]
MAX_RANDOM_STEPS = 50
Row = dict[str, Any]


def reference_rows(agent: Agent, root: Path, track: Track, split: str, rng: np.random.Generator) -> list[Row]:
    """The rows that an agent submits to a track.

    Parameters
    ----------
    agent : str
        "oracle", "random" or "blind".
    root, track, split : path, str, str
        What to answer.
    rng : numpy.random.Generator
        For `random`; the others do not use it.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, or has no such split.
    MissingExtraError
        If `blind` needs scikit-learn and it is not installed.
    """
    names = TRACKS[track].columns(replay=True)
    if track == "rec":
        asked = read_table(root, "expressions", split, ["expression_id", "box_2d", "frame_id"]).to_pylist()
    else:
        asked = read_table(root, "questions", split, list(_QUESTION_COLUMNS)).to_pylist()
    complete = _AGENTS[agent](root, asked, rng, "answer" in names)
    return [{name: row[name] for name in names} for row in complete]


_QUESTION_COLUMNS = ("question_id", "kind", "question", "answer", "actions", "start_target_box_2d", "object_ids")


def _oracle(root: Path, asked: Sequence[Row], rng: np.random.Generator, answers: bool) -> Iterator[Row]:
    for row in asked:
        if "expression_id" in row:
            yield {"expression_id": row["expression_id"], "box": row["box_2d"]}
            continue
        walk, rest = walk_and_rest(parse_actions(row["actions"]))
        yield {
            "question_id": row["question_id"],
            "actions": [*map(str, walk), DONE],
            "box": row["start_target_box_2d"],
            "manipulation": next((str(action) for action in rest if action.name in MANIPULATION), None),
            "answer": row["answer"],
        }


def _random(root: Path, asked: Sequence[Row], rng: np.random.Generator, answers: bool) -> Iterator[Row]:
    if asked and "expression_id" in asked[0]:
        yield from _random_boxes(root, asked, rng)
        return
    moves = [word for word in WORDS if word != DONE]
    possible: dict[str, list[str]] = {}
    for row in asked:
        if "answer" in row:
            possible.setdefault(row["kind"], []).append(row["answer"])
    choices = {kind: sorted(set(found)) for kind, found in possible.items()}
    for row in asked:
        box, steps = _random_box(rng), int(rng.integers(0, MAX_RANDOM_STEPS + 1))
        yield {
            "question_id": row["question_id"],
            "box": box,
            "actions": [*rng.choice(moves, steps).tolist(), DONE],
            "manipulation": str(open_action(str(rng.choice(row["object_ids"])))),
            "answer": str(rng.choice(choices[row["kind"]])),
        }


def _random_boxes(root: Path, asked: Sequence[Row], rng: np.random.Generator) -> Iterator[Row]:
    """A box for each expression, anywhere in its frame."""
    frames = Frames(root)
    for row in asked:
        size = image_size(frames.picture(row["frame_id"])) or (FRAME_PX, FRAME_PX)
        box = [round(edge * pixels / FRAME_PX) for edge, pixels in zip(_random_box(rng), (*size, *size), strict=True)]
        yield {"expression_id": row["expression_id"], "box": box}


def _random_box(rng: np.random.Generator) -> list[int]:
    """A box in a view of `FRAME_PX`."""
    (x1, x2), (y1, y2) = np.sort(rng.integers(0, FRAME_PX + 1, (2, 2)), axis=1).tolist()
    return [x1, y1, x2, y2]


def _blind(root: Path, asked: Sequence[Row], rng: np.random.Generator, answers: bool) -> Iterator[Row]:
    guesses = _guesses(root, asked) if answers else {}
    for row in asked:
        if "expression_id" in row:
            yield {"expression_id": row["expression_id"], "box": None}
            continue
        name = row["question_id"]
        yield {"question_id": name, "actions": [DONE], "box": None, "manipulation": None, "answer": guesses.get(name)}


def _guesses(root: Path, asked: Sequence[Row]) -> Mapping[str, str]:
    """By question, the answer that a logistic regression on word counts, learnt from the train split, gives."""
    train = read_table(root, "questions", "train", ["kind", "question", "answer"]).to_pylist()
    guesses: dict[str, str] = {}
    for kind in sorted({row["kind"] for row in asked}):
        known = [row for row in train if row["kind"] == kind]
        wanted = [row for row in asked if row["kind"] == kind]
        if len({row["answer"] for row in known}) < 2:
            continue
        words = require("sklearn.feature_extraction.text", "report").CountVectorizer()
        classifier = require("sklearn.linear_model", "report").LogisticRegression(max_iter=1000)
        classifier.fit(words.fit_transform([row["question"] for row in known]), [row["answer"] for row in known])
        found = classifier.predict(words.transform([row["question"] for row in wanted]))
        guesses |= {row["question_id"]: str(answer) for row, answer in zip(wanted, found, strict=True)}
    return guesses


_AGENTS: dict[Agent, Callable[[Path, Sequence[Row], np.random.Generator, bool], Iterator[Row]]] = {
    "oracle": _oracle,
    "random": _random,
    "blind": _blind,
}
